"""Compiles a kernel with numba and keeps the machine code on disk where that is possible."""

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba

P = ParamSpec("P")
R = TypeVar("R")


MARK = "kernels.sha256"
"""The file, beside the compiled kernels of a folder, that says of which sources they are."""


def state_of(package: Path) -> str:
    """A digest of what a package folder's sources are, by their names, sizes and times."""
    stats = [(source.name, source.stat()) for source in sorted(package.glob("*.py"))]
    text = repr([(name, stat.st_mtime_ns, stat.st_size) for name, stat in stats])
    return hashlib.sha256(text.encode()).hexdigest()


def forget_stale_code(package: Path, *others: Path) -> None:
    """Remove the compiled kernels of a package folder if one of its sources has changed.

    Or one of the `others`, folders from which its kernels take what becomes part of them.

    numba compiles a kernel anew when the kernel's own file has changed, but not when the file of
    a kernel that it calls has: that one would go on living inside of it. The mark is written
    before there is anything to forget, also where Python itself keeps no compiled code.
    """
    cache = package / "__pycache__"
    digest = "\n".join(map(state_of, (package, *others)))
    mark = cache / MARK
    with suppress(OSError):  # a folder that we may not write: nothing is kept in it
        if mark.exists() and mark.read_text() == digest:
            return
        cache.mkdir(exist_ok=True)
        for index in cache.glob("*.nbi"):
            index.unlink(missing_ok=True)
        draft = cache / f"kernels.{os.getpid()}"
        draft.write_text(digest)
        draft.replace(mark)


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Return `function` compiled by numba, on its first call, for the types of that call.

    The machine code is cached beside the source or, where that folder cannot be written, in the
    user's cache folder; where neither can be written it is compiled anew in each process. No
    kernel uses `fastmath` or threads: a result never depends on the number of cores.
    """
    return _compiled(function)


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """The same for a small function that kernels call: it becomes part of each of its callers."""
    return _compiled(function, forceinline=True)


def quick(function: Callable[P, R]) -> Callable[P, R]:
    """The same for a kernel of a microsecond: it does not let go of the interpreter's lock.

    To let go of it costs less than to wait for it: another thread that takes it may keep it for
    milliseconds.
    """
    return _compiled(function, nogil=False)


def _compiled(function: Callable[P, R], **more: Any) -> Callable[P, R]:
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", **more}
    try:
        return cast("Callable[P, R]", numba.njit(cache=True, **options)(function))
    except RuntimeError:  # numba: "no locator available": nowhere to write a cache
        return cast("Callable[P, R]", numba.njit(**options)(function))


forget_stale_code(Path(__file__).parent)
