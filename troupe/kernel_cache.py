"""numba's cache on disk: where it is, and that nothing damaged comes out of it."""

from __future__ import annotations

import contextlib
import hashlib
import pickle
import sys
from pathlib import Path
from typing import Any

SEAL = b"sealed by sha256:"
"""Stands before the digest at the end of a file; readers of pickles do not look behind these."""


PLAIN = ("sensors", "sim")
"""Packages whose kernels need nothing of numba but its runtime: arrays and numbers go in and out.
Others may hand over functions, or call what numba itself adds for numpy."""


def cache_folder() -> Path | None:
    """Where numba keeps the machine code of the sensors; None if nothing can be kept."""
    from sensors.rays import cast_fans  # noqa: PLC0415 - loads numba

    path = getattr(getattr(cast_fans, "_cache", None), "cache_path", None)
    return None if path is None else Path(path)


def sealed(data: bytes) -> bytes:
    """Bytes with their digest behind them."""
    return data + SEAL + hashlib.sha256(data).digest()


def is_whole(data: bytes) -> bool:
    """Whether bytes are what was written, as far as that can be told: old ones have no seal."""
    size = len(SEAL) + hashlib.sha256().digest_size
    body, seal = memoryview(data)[:-size], data[-size:]
    return not seal.startswith(SEAL) or seal == SEAL + hashlib.sha256(body).digest()


def distrust_cache() -> None:
    """From now on what cannot be read is compiled anew, and what cannot be written is not kept.

    numba itself gives up where a file of its cache is empty, cut or damaged, as after a crash or on
    a full disk. And a kernel of arrays and numbers takes no more than numba's runtime to be read:
    numba itself would first make ready to compile anything, a fifth of a second; whoever compiles
    does that anyway. Nor does it take the modules of numba in which functions stand that have been
    compiled into the kernel.
    Changes numba in this process; a second call changes nothing.
    """
    from numba.core import caching, environment  # noqa: PLC0415 - slow to load
    from numba.core.runtime.nrt import rtsys  # noqa: PLC0415

    file: Any = caching.IndexDataCacheFile
    cache: Any = caching.Cache
    surroundings: Any = environment
    if hasattr(file, "_troupe"):
        return
    file._troupe = True
    load_index, dump = file._load_index, file._dump
    load_overload, save_overload = cache._load_overload, cache._save_overload
    load_prepared = cache.load_overload

    def index_or_none(self: Any) -> dict[Any, str]:
        try:
            return dict(load_index(self))
        except Exception:  # a damaged pickle raises anything
            return {}

    def whole_data(self: Any, name: str) -> Any:
        data = Path(self._data_path(name)).read_bytes()
        if not is_whole(data):
            raise OSError(f"{name} is damaged")
        return pickle.loads(data)

    def loaded(self: Any, sig: Any, target_context: Any) -> Any:
        try:
            return load_overload(self, sig, target_context)
        except Exception:
            return None

    def saved(self: Any, sig: Any, data: Any) -> None:
        with contextlib.suppress(OSError):
            save_overload(self, sig, data)

    file._load_index = index_or_none
    file._load_data = whole_data

    def load_unprepared(self: Any, sig: Any, target_context: Any) -> Any:
        if not is_plain(self._py_func.__module__):
            return load_prepared(self, sig, target_context)
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    rebuild = surroundings._rebuild_env

    def environment_of(module: str, constants: Any, name: str) -> Any:
        known = surroundings.lookup_environment(name)
        if known is not None or module in sys.modules or not module.startswith("numba."):
            return rebuild(module, constants, name)
        made: Any = surroundings.Environment({"__name__": module})  # for Python code
        made.consts[:] = constants
        made.env_name = name
        surroundings.Environment._memo[name] = made
        return made

    surroundings._rebuild_env = environment_of
    file._dump = lambda self, data: sealed(dump(self, data))
    cache.load_overload = load_unprepared
    cache._load_overload = loaded
    cache._save_overload = saved
    read_code_alone()


def read_code_alone() -> None:
    """From now on one of our kernels that comes out of the cache is its machine code, and no more.

    Beside it stands its bitcode, of which kernels are made that call it. numba itself reads that as
    well, which takes longer than the code; here it is read when another kernel is compiled with it.
    """
    from llvmlite import binding  # noqa: PLC0415
    from numba.core import codegen, compiler  # noqa: PLC0415 - slow to load

    library: Any = codegen.CPUCodeLibrary
    result: Any = compiler.CompileResult
    unserialize, for_linking = library._unserialize, library._get_module_for_linking
    rebuild = result._rebuild

    def rebuilt(kind: Any, context: Any, kept: Any, described: Any, *rest: Any) -> Any:
        if kept[1] == "object" and is_plain(described.modname):
            kept = kept[0], "code", kept[2]
            known = context.codegen()._engine._defined_symbols
            known.add(described.llvm_cpython_wrapper_name)  # by which Python calls it
        return rebuild(context, kept, described, *rest)

    def code_alone(kind: Any, codegen: Any, kept: Any) -> Any:
        name, form, data = kept
        if form != "code":
            return unserialize(codegen, kept)
        made = codegen.create_library(name)
        code, made._bitcode = data
        made.enable_object_caching()
        made._set_compiled_object(code)
        made._finalize_final_module()
        return made

    def with_bitcode(self: Any) -> Any:
        bitcode = self.__dict__.pop("_bitcode", None)
        if bitcode is not None:
            self._shared_module = binding.parse_bitcode(bitcode)
            self._codegen._engine._load_defined_symbols(self._shared_module)
        return for_linking(self)

    result._rebuild = classmethod(rebuilt)
    library._unserialize = classmethod(code_alone)
    library._get_module_for_linking = with_bitcode


def is_plain(module: str) -> bool:
    """Whether the kernels of a module are of those that need nothing of numba."""
    return module.partition(".")[0] in PLAIN
