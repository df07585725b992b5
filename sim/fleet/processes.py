"""Processes as the system has them: groups that are killed whole, orphans, and who keeps whom.

The fork server loads this by its path: it imports nothing of ours.
"""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import sys

PR_SET_PDEATHSIG = 1
PR_SET_CHILD_SUBREAPER = 36


def prctl(option: int, value: int) -> None:
    """Linux's prctl(2); does nothing elsewhere."""
    if sys.platform == "linux":
        import ctypes  # noqa: PLC0415 - the simulator imports this module, and needs it not

        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)


def hold_standard_descriptors() -> None:
    """Open /dev/null in place of whichever of the descriptors 0, 1 and 2 is closed.

    Otherwise the next file or socket would become somebody's standard output.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            opened = os.open(os.devnull, os.O_RDWR)  # the lowest number that is free
            os.set_inheritable(opened, True)


def kill_group(pid: int) -> None:
    """Kill a process and its group."""
    for kill in (os.killpg, os.kill):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            kill(pid, signal.SIGKILL)


def children_of(pid: int) -> list[int]:
    """The processes that `pid` is the parent of (Linux; elsewhere none are known)."""
    try:
        with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
            return [int(word) for word in file.read().split()]
    except OSError:
        return []


def end_children() -> None:
    """Kill all that this process is the parent of, until nothing is left (Linux)."""
    for _ in range(100):  # an orphan may fork while it is looked for
        orphans = children_of(os.getpid())
        for pid in orphans:
            kill_group(pid)
        if not orphans:
            return
        with contextlib.suppress(ChildProcessError):
            os.waitpid(-1, 0)


def keep(control: socket.socket) -> None:
    """Go on as the child of a keeper: it ends what the fork server, if it is killed, leaves."""
    prctl(PR_SET_CHILD_SUBREAPER, 1)
    keeper = os.getpid()
    server = os.fork()
    if server == 0:
        prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != keeper:
            os._exit(1)
        return
    control.close()  # its end is the fork server's end
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, 0)[0] != server:
            pass
    end_children()
    os._exit(0)
