"""The fork server: a process of one thread that forks one process per controller.

It is run as a script by exec, so it never shares a thread or a lock with the simulator. It loads
numpy and `player` once, and nothing of the simulator; a child that it forks therefore starts within
milliseconds. Its two arguments are the number of the socket that the simulator asks through, and
the folder that holds our packages. Each message on the socket, either way, is a length (4 bytes,
big-endian) and JSON; with a start come the child's output pipe and socket as file descriptors.

    start  {"op": "start", "id": 3, "kind": "module"|"script"|"exec", "target": ..., "argv": [...],
            "env": {...}, "root": ..., "folder": ..., "descriptors": 1|2}
           + [output] or [output, connection]
    kill   {"op": "kill", "id": 3}
    stack  {"op": "stack", "id": 3}     a module or script prints its Python stack, and ends

It answers, for every start,

    started  {"op": "started", "id": 3, "pid": 4711}   the child is there, as process 4711
    ended    {"op": "ended", "id": 3, "code": 0}       its process has ended; a negative code is
                                                       a signal's number

or `ended` alone where no process could be made. When the simulator goes away, however it dies, the
socket reaches its end, and the fork server kills every child and all that the children started,
and ends.

What is run is two processes: the fork server, and its parent, the keeper, which does nothing but
wait for its end. A child may kill the fork server after it has left a daemon behind; on Linux the
daemon then becomes the keeper's, which has no children but those of the run, and kills them. The
simulator could not do that: it may be part of a program that has children of its own.
"""

from __future__ import annotations

import contextlib
import faulthandler
import gc
import importlib.abc
import importlib.machinery
import json
import os
import select
import signal
import socket
import struct
import sys
from typing import Any, NoReturn

STACK = signal.SIGUSR1
"""Has a Python program print its stack."""

PR_SET_PDEATHSIG = 1
PR_SET_CHILD_SUBREAPER = 36


def prctl(option: int, value: int) -> None:
    """Linux's prctl(2); does nothing elsewhere."""
    if sys.platform == "linux":
        import ctypes  # noqa: PLC0415 - the simulator imports this module, and needs it not

        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)


class ForkServer:
    """The children, by the simulator's numbers and by process id."""

    def __init__(self, control: socket.socket) -> None:
        self.control = control
        self.pending = b""
        self.descriptors: list[int] = []
        self.outbox = b""
        self.pid_of: dict[int, int] = {}
        self.id_of: dict[int, int] = {}
        self.wake_read, self.wake_write = os.pipe()
        for end in (self.wake_read, self.wake_write):
            os.set_blocking(end, False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(self.wake_write, warn_on_full_buffer=False)

    def serve(self) -> None:
        """Obey the simulator until it goes away."""
        self.control.setblocking(False)
        poll = select.poll()  # not select(): a descriptor may be larger than 1023
        poll.register(self.wake_read, select.POLLIN)
        while True:
            poll.register(self.control, select.POLLIN | (select.POLLOUT if self.outbox else 0))
            ready = dict(poll.poll())
            if self.wake_read in ready:
                with contextlib.suppress(BlockingIOError):
                    os.read(self.wake_read, 4096)
                self.reap()
            if ready.get(self.control.fileno(), 0) & ~select.POLLOUT and not self.read():
                return
            self.write()

    def read(self) -> bool:
        """Take what the simulator says; False when it has gone away."""
        while True:
            try:
                data, descriptors, _, _ = socket.recv_fds(self.control, 65536, 64)
            except BlockingIOError:
                return True
            except ConnectionError:
                return False
            if not data:
                return False
            self.pending += data
            self.descriptors += descriptors
            while len(self.pending) >= 4:
                (length,) = struct.unpack(">I", self.pending[:4])
                if len(self.pending) < 4 + length:
                    break
                message = json.loads(self.pending[4 : 4 + length])
                self.pending = self.pending[4 + length :]
                self.obey(message)

    def obey(self, message: dict[str, Any]) -> None:
        if message["op"] == "start":
            count = message["descriptors"]
            passed, self.descriptors = self.descriptors[:count], self.descriptors[count:]
            self.start(message, passed)
        elif message["op"] == "kill" and message["id"] in self.pid_of:
            kill_group(self.pid_of[message["id"]])
        elif message["op"] == "stack" and message["id"] in self.pid_of:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(self.pid_of[message["id"]], STACK)

    def start(self, message: dict[str, Any], passed: list[int]) -> None:
        try:
            pid = os.fork()
        except OSError as error:
            os.write(passed[0], f"cannot start a process: {error}\n".encode())
            self.say({"op": "ended", "id": message["id"], "code": 1})
        else:
            if pid == 0:
                self.become(message, passed)
            self.pid_of[message["id"]] = pid
            self.id_of[pid] = message["id"]
            self.say({"op": "started", "id": message["id"], "pid": pid})
        for descriptor in passed:
            os.close(descriptor)

    def become(self, message: dict[str, Any], passed: list[int]) -> NoReturn:
        """In the child: shed the server, then run the program."""
        code = 1
        try:
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
            signal.signal(signal.SIGHUP, signal.SIG_DFL)
            server = os.getppid()
            prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
            if os.getppid() != server:
                os._exit(1)
            os.setsid()
            self.control.close()
            os.close(self.wake_read)
            os.close(self.wake_write)
            silence = os.open(os.devnull, os.O_RDONLY)
            os.dup2(silence, 0)
            os.dup2(passed[0], 1)
            os.dup2(passed[0], 2)
            for descriptor in (silence, passed[0]):
                if descriptor > 2:
                    os.close(descriptor)
            signal.signal(signal.SIGINT, signal.default_int_handler)
            os.environ.update(message["env"])
            if len(passed) > 1:
                os.set_inheritable(passed[1], True)
                os.environ["PLAYER_FD"] = str(passed[1])
            if message["kind"] != "exec":
                # chained: what the signal has always done to a program, to end it, it still does
                faulthandler.register(STACK, file=os.dup(2), all_threads=True, chain=True)
            code = run_program(message)
        except BaseException:
            import traceback  # noqa: PLC0415

            traceback.print_exc()
        finally:
            with contextlib.suppress(BaseException):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(code)

    def reap(self) -> None:
        """Tell the simulator which children have ended."""
        while True:
            try:
                pid, status = os.waitpid(-1, os.WNOHANG)
            except ChildProcessError:
                return
            if pid == 0:
                return
            number = self.id_of.pop(pid, None)
            if number is not None:  # else: an orphan of a controller's, adopted
                del self.pid_of[number]
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.killpg(pid, signal.SIGKILL)  # what it started and left behind
                self.say({"op": "ended", "id": number, "code": os.waitstatus_to_exitcode(status)})

    def say(self, message: dict[str, Any]) -> None:
        self.outbox += framed(message)
        self.write()

    def write(self) -> None:
        while self.outbox:
            try:
                sent = self.control.send(self.outbox)
            except BlockingIOError:
                return
            except OSError:
                self.outbox = b""
                return
            self.outbox = self.outbox[sent:]

    def end_all(self) -> None:
        """Kill every child and, where the system tells, all that the children started."""
        for pid in list(self.id_of):
            kill_group(pid)
        end_children()


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


def framed(message: dict[str, Any]) -> bytes:
    """A message as it goes over the socket."""
    text = json.dumps(message).encode()
    return struct.pack(">I", len(text)) + text


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


def run_program(message: dict[str, Any]) -> int:
    """Run what was asked for, in this process; the exit code."""
    import atexit  # noqa: PLC0415
    import runpy  # noqa: PLC0415
    import threading  # noqa: PLC0415

    from player import PlayerDisconnected  # noqa: PLC0415

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
    import runpy  # noqa: PLC0415
    import traceback  # noqa: PLC0415

    runners = {run_program.__code__.co_filename, runpy.run_path.__code__.co_filename}
    told = traceback.TracebackException.from_exception(error)
    ours = 0  # those at the top only: a program may use runpy itself
    while ours < len(told.stack) and told.stack[ours].filename in runners:
        ours += 1
    del told.stack[:ours]
    return "".join(told.format())


def main() -> None:
    """Serve on the socket whose descriptor is the first argument."""
    hold_standard_descriptors()
    control = socket.socket(fileno=int(sys.argv[1]))
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # the simulator decides, by closing the socket
    keep(control)
    prctl(PR_SET_CHILD_SUBREAPER, 1)
    if hasattr(os, "SCHED_BATCH"):
        # a controller that wakes must not interrupt the simulator, which has others to wake
        with contextlib.suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    sys.path.insert(0, sys.argv[2])
    import numpy.random  # noqa: F401, PLC0415

    import player  # noqa: PLC0415

    for name in player.__all__:  # all of it, once for all children
        getattr(player, name)
    sys.path.pop(0)
    gc.collect()
    gc.freeze()  # the children share these pages for as long as nobody touches them
    server = ForkServer(control)
    try:
        server.serve()
    finally:
        server.end_all()


if __name__ == "__main__":
    main()
