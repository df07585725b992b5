"""What a child of the fork server becomes: a module, a script, or any executable.

The fork server has loaded this before it forks; in its children it is no module of `sim`, so that
programs may have modules of their own by that name.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib.abc
import importlib.machinery
import os
import runpy
import sys
import threading
import traceback
from typing import Any, NoReturn

from player import PlayerDisconnected


def run(message: dict[str, Any]) -> int:
    """Run what was asked for, in this process; the exit code."""
    sys.stdin = os.fdopen(0, encoding="utf-8", closefd=False)
    sys.stdout = os.fdopen(1, "w", 1, encoding="utf-8", errors="replace", closefd=False)
    sys.stderr = os.fdopen(2, "w", 1, encoding="utf-8", errors="replace", closefd=False)
    if not os.environ.get("PYTHONBREAKPOINT"):
        sys.breakpointhook = no_terminal
    target, argv = message["target"], message["argv"]
    if message["kind"] == "exec":
        try:
            os.execvp(target, [target, *argv])
        except OSError as error:
            print(f"cannot run {target}: {error.strerror or error}", file=sys.stderr)
            return 127
    code = 0
    try:
        if message["kind"] == "module":
            sys.path.insert(0, message["root"])
            sys.argv = [target, *argv]
            runpy.run_module(target, run_name="__main__", alter_sys=True)
        else:
            sys.path.insert(0, os.path.dirname(target))
            sys.path.append(message["folder"])  # the world's: its modules, if nobody else has them
            sys.meta_path.insert(0, OwnFirst(message["root"]))
            sys.argv = [target, *argv]
            runpy.run_path(target, run_name="__main__")
    except SystemExit as end:
        if isinstance(end.code, int) or end.code is None:
            code = end.code or 0
        else:
            print(end.code, file=sys.stderr)
            code = 1
    except PlayerDisconnected:
        # The simulator has ended the run, or this program's part in it, and has told why; the
        # program was busy with something else than `read`.
        code = 1
    except BaseException as error:
        print(own_traceback(error), end="", file=sys.stderr)
        code = 1
    with contextlib.suppress(BaseException):
        threading._shutdown()  # type: ignore[attr-defined]  # waits for threads, as an exit does
        atexit._run_exitfuncs()
    return code


def no_terminal(*words: Any, **more: Any) -> NoReturn:
    """What `breakpoint()` does in a program whose input is empty."""
    raise RuntimeError(
        "breakpoint(): a program of a world file has no terminal. Let its robot's controller be "
        "`external: true`, run the world with --patience 0, and start the program by hand"
    )


class OwnFirst(importlib.abc.MetaPathFinder):
    """Finds a program's own modules that have the names of our packages, wherever ours lie.

    Where Troupe is installed our `controllers` can be imported like any other package. It must not
    come before a folder `controllers` of the program's own, not even before one that has no
    `__init__.py`, which to Python is no match for a package that has.
    """

    names = ("controllers", "sensors", "sim", "troupe")

    def __init__(self, root: str) -> None:
        self.root = os.path.realpath(root)

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        """The module's spec; None if there is none but ours."""
        if name not in self.names:
            return None
        places = [at for at in sys.path if os.path.realpath(at or os.curdir) != self.root]
        return importlib.machinery.PathFinder.find_spec(name, places, target)


def own_traceback(error: BaseException) -> str:
    """A program's traceback with its causes, without the frames of those that have run it."""
    runners = {run.__code__.co_filename, runpy.run_path.__code__.co_filename}
    told = traceback.TracebackException.from_exception(error)
    ours = 0  # those at the top only: a program may use runpy itself
    while ours < len(told.stack) and told.stack[ours].filename in runners:
        ours += 1
    del told.stack[:ours]
    return "".join(told.format())
