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
import importlib.util
import json
import os
import select
import signal
import socket
import struct
import sys
from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn


def neighbour(name: str) -> ModuleType:
    """A module of this folder, by no name that a program could have for one of its own."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), f"{name}.py")
    spec = importlib.util.spec_from_file_location(f"_troupe_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


if TYPE_CHECKING:
    from sim.fleet import processes
else:
    processes = neighbour("processes")

STACK = signal.SIGUSR1
"""Has a Python program print its stack."""


class ForkServer:
    """The children, by the simulator's numbers and by process id.

    `run(message)` runs what a start asks for, in the child, and gives the exit code.
    """

    def __init__(self, control: socket.socket, run: Callable[[dict[str, Any]], int]) -> None:
        self.control = control
        self.run = run
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
            messages, self.pending = unframed(self.pending)
            for message in messages:
                self.obey(message)

    def obey(self, message: dict[str, Any]) -> None:
        if message["op"] == "start":
            count = message["descriptors"]
            passed, self.descriptors = self.descriptors[:count], self.descriptors[count:]
            self.start(message, passed)
        elif message["op"] == "kill" and message["id"] in self.pid_of:
            processes.kill_group(self.pid_of[message["id"]])
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
            processes.prctl(processes.PR_SET_PDEATHSIG, signal.SIGKILL)
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
            code = self.run(message)
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
            processes.kill_group(pid)
        processes.end_children()


def framed(message: dict[str, Any]) -> bytes:
    """A message as it goes over the socket."""
    text = json.dumps(message).encode()
    return struct.pack(">I", len(text)) + text


def unframed(data: bytes) -> tuple[list[dict[str, Any]], bytes]:
    """The messages that are whole, and the bytes behind them."""
    messages = []
    while len(data) >= 4:
        (length,) = struct.unpack_from(">I", data)
        if len(data) < 4 + length:
            break
        messages.append(json.loads(data[4 : 4 + length]))
        data = data[4 + length :]
    return messages, data


def main() -> None:
    """Serve on the socket whose descriptor is the first argument."""
    processes.hold_standard_descriptors()
    control = socket.socket(fileno=int(sys.argv[1]))
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # the simulator decides, by closing the socket
    processes.keep(control)
    processes.prctl(processes.PR_SET_CHILD_SUBREAPER, 1)
    if hasattr(os, "SCHED_BATCH"):
        # a controller that wakes must not interrupt the simulator, which has others to wake
        with contextlib.suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    sys.path.insert(0, sys.argv[2])
    import numpy.random  # noqa: F401, PLC0415

    import player  # noqa: PLC0415

    for name in player.__all__:  # all of it, once for all children
        getattr(player, name)
    program = neighbour("program")
    sys.path.pop(0)
    gc.collect()
    gc.freeze()  # the children share these pages for as long as nobody touches them
    server = ForkServer(control, program.run)
    try:
        server.serve()
    finally:
        server.end_all()
    os._exit(0)  # at once: the simulator waits for it, and nothing is to be taken apart


if __name__ == "__main__":
    main()
