"""The end of the command's process: at once, for to take apart what is loaded takes longer."""

from __future__ import annotations

import atexit
import contextlib
import os
import sys
import threading
from typing import NoReturn

from troupe.interrupts import is_the_command


def nobody_waits() -> bool:
    """Whether the command is all that this process is for: no profiler, tracer or prompt is left
    to have its turn when the command is done.
    """
    words = sys.orig_argv
    module = words[words.index("-m") + 1 :][:1] if "-m" in words else ["troupe"]
    watched = sys.gettrace() is not None or sys.getprofile() is not None
    return is_the_command() and module == ["troupe"] and not (watched or sys.flags.inspect)


def end_process(code: int) -> NoReturn:
    """Do what Python does at an exit, but for taking its memory apart: the system has it in one."""
    with contextlib.suppress(Exception):
        threading._shutdown()  # type: ignore[attr-defined]  # waits for threads
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):
            stream.flush()
    os._exit(code)
