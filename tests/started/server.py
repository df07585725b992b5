"""The process that commands are forked from: it has loaded all that `troupe run` needs.

`python -m tests.started.server SOCKET` listens at the path SOCKET, says so, and ends at the end of
its standard input. A request is a length (4 bytes, big-endian) and JSON, with the file descriptors
0, 1 and 2 of the command that is to run:

    {"words": [...], "program": null or a path, "folder": ..., "environment": {...}}

It forks a process that becomes `troupe WORDS`, or the Python program with these words, in that
folder and environment, and answers with two lines: the process's number, and when it has ended its
exit code, which is negative for a signal's number.
"""

from __future__ import annotations

import atexit
import contextlib
import gc
import json
import os
import runpy
import selectors
import signal
import socket
import struct
import sys
import threading
from typing import Any, NoReturn

SIGNALS = (signal.SIGTERM, signal.SIGHUP)


def load() -> None:
    """Load what commands load, and have the kernels of a run at hand."""
    import troupe  # noqa: PLC0415
    import troupe.__main__  # noqa: PLC0415
    from troupe.app import MODULES, load  # noqa: PLC0415

    for name in MODULES:
        load(name)
    import troupe.sweep.session  # noqa: PLC0415

    with troupe.Simulation("wander", controllers=False) as simulation:
        simulation.step(2)


class Server:
    """The commands that run, by their process ids."""

    def __init__(self, path: str) -> None:
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(path)
        self.listener.listen(32)
        self.waiting: dict[int, socket.socket] = {}
        self.woken, self.wake = os.pipe()
        for end in (self.woken, self.wake):
            os.set_blocking(end, False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(self.wake, warn_on_full_buffer=False)

    def serve(self) -> None:
        """Fork what is asked for, until standard input ends."""
        poll = selectors.DefaultSelector()
        for source in (0, self.woken, self.listener):
            poll.register(source, selectors.EVENT_READ)
        while True:
            ready = {key.fd for key, _ in poll.select()}
            if 0 in ready:
                return
            if self.woken in ready:
                with contextlib.suppress(BlockingIOError):
                    os.read(self.woken, 4096)
                self.reap()
            if self.listener.fileno() in ready:
                self.start(self.listener.accept()[0])

    def start(self, client: socket.socket) -> None:
        data, descriptors, _, _ = socket.recv_fds(client, 4, 3)
        (size,) = struct.unpack(">I", data)
        text = b""
        while len(text) < size:
            text += client.recv(size - len(text))
        pid = os.fork()
        if pid == 0:
            become(json.loads(text), descriptors, [self.listener, client, *self.waiting.values()])
        for descriptor in descriptors:
            os.close(descriptor)
        self.waiting[pid] = client
        with contextlib.suppress(OSError):
            client.sendall(b"%d\n" % pid)

    def reap(self) -> None:
        """Tell those who wait for it how a command has ended."""
        for pid in list(self.waiting):
            ended, status = os.waitpid(pid, os.WNOHANG)
            if ended:
                with self.waiting.pop(pid) as client, contextlib.suppress(OSError):
                    client.sendall(b"%d\n" % os.waitstatus_to_exitcode(status))

    def end(self) -> None:
        """Nothing that has been started stays, nor the socket's folder."""
        for pid in self.waiting:
            os.kill(pid, signal.SIGKILL)
        path = self.listener.getsockname()
        os.unlink(path)
        os.rmdir(os.path.dirname(path))


def become(request: dict[str, Any], passed: list[int], others: list[socket.socket]) -> NoReturn:
    """In the child: become the command."""
    code = 1
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        for number in SIGNALS:
            signal.signal(number, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        for other in others:
            other.close()
        for number, descriptor in enumerate(passed):
            os.dup2(descriptor, number)
        for descriptor in passed:
            os.close(descriptor)
        os.chdir(request["folder"])
        os.environ.clear()
        os.environ.update(request["environment"])
        sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115 - to the end
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", 1, encoding="utf-8", errors="backslashreplace", closefd=False)  # noqa: SIM115
        code = run(request["program"], request["words"])
    except BaseException:
        sys.excepthook(*sys.exc_info())  # type: ignore[arg-type]
    finally:
        with contextlib.suppress(BaseException):
            threading._shutdown()  # type: ignore[attr-defined]  # as at an exit
            atexit._run_exitfuncs()
            sys.stdout.flush()
        os._exit(code)


def run(program: str | None, words: list[str]) -> int:
    """Run the command line or a program; the exit code."""
    from troupe.__main__ import main  # noqa: PLC0415
    from troupe.interrupts import heed_interrupts  # noqa: PLC0415

    heed_interrupts()
    sys.argv = [program or "troupe", *words]
    try:
        if program is None:
            main()
        else:
            sys.path.insert(0, os.path.dirname(program))
            runpy.run_path(program, run_name="__main__")
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    load()
    assert threading.active_count() == 1, "a process with threads is not to be forked"
    server = Server(sys.argv[1])
    gc.collect()
    gc.freeze()
    print("ready", flush=True)
    try:
        server.serve()
    finally:
        server.end()
