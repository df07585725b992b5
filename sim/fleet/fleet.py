"""The controllers' processes as the simulator sees them: start, output, end."""

from __future__ import annotations

import contextlib
import os
import resource
import select
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from sim.fleet.forkserver import framed, unframed
from sim.fleet.output import Output
from sim.fleet.processes import hold_standard_descriptors, kill_group

Watch = Callable[[Any, Callable[[], None]], None]
Unwatch = Callable[[Any], None]

ROOT = Path(__file__).resolve().parent.parent.parent
"""The folder that holds our packages: a checkout's, or site-packages."""


@dataclass(frozen=True)
class Launch:
    """What to run: one of our modules, a Python file, or any executable."""

    kind: Literal["module", "script", "exec"]
    target: str
    argv: tuple[str, ...] = ()
    folder: str = ""  # the world's, where a script's own modules may lie too


class Fleet:
    """The fork server and its children.

    `watch(fileobj, callback)` and `unwatch(fileobj)` hook the fleet's pipes into the loop that the
    simulator waits in; `show(line)` is given every line that a controller prints. The fork server
    is started at once, so that it gets ready while the simulator does, unless it `waits` for the
    first controller: a world without any then has no process made for it.
    """

    def __init__(self, show: Callable[[str], None] | None = None, *, waits: bool = False) -> None:
        raise_descriptor_limit()
        hold_standard_descriptors()
        self.show = show
        self.ended: dict[int, int] = {}
        self.pids: dict[int, int] = {}
        self.outputs: dict[int, Output] = {}
        self.starting: set[int] = set()
        self.lost = False
        self.pending = b""
        self.watch: Watch | None = None
        self.unwatch: Unwatch | None = None
        self.control, self.theirs = socket.socketpair()
        self.process: subprocess.Popen[bytes] | None = None
        if not waits:
            self.begin()

    def begin(self) -> None:
        """Start the fork server."""
        environment = dict(
            os.environ,
            PYTHONHASHSEED="0",
            OPENBLAS_NUM_THREADS="1",  # one thread: a fork copies no other
            OMP_NUM_THREADS="1",
            MKL_NUM_THREADS="1",
        )
        script = Path(__file__).with_name("forkserver.py")
        # -P: the folder of the script must not become a place to import from
        self.process = subprocess.Popen(
            [sys.executable, "-P", str(script), str(self.theirs.fileno()), str(ROOT)],
            pass_fds=[self.theirs.fileno()],
            stdin=subprocess.DEVNULL,
            env=environment,
            start_new_session=True,  # a Ctrl-C at the terminal is for the simulator alone
        )
        self.theirs.close()

    def attach(self, watch: Watch, unwatch: Unwatch) -> None:
        """From now on the fleet's news arrive through the simulator's loop."""
        self.watch, self.unwatch = watch, unwatch
        self.control.setblocking(False)
        watch(self.control, self.read)

    def start(
        self,
        key: int,
        name: str,
        launch: Launch,
        environment: Mapping[str, str],
        connection: socket.socket | None,
    ) -> None:
        """Start the process of controller `key`; `connection` becomes its PLAYER_FD.

        Where the fork server has died, the controller counts as killed at once.
        """
        if self.process is None:
            self.begin()
        read_end, write_end = os.pipe()
        output = Output(read_end, name, self.show)
        self.outputs[key] = output
        if self.watch is not None:
            self.watch(read_end, lambda: self.read_output(output))
        descriptors = [write_end] + ([connection.fileno()] if connection else [])
        message = {
            "op": "start",
            "id": key,
            "kind": launch.kind,
            "target": launch.target,
            "argv": list(launch.argv),
            "env": dict(environment),
            "root": str(ROOT),
            "folder": launch.folder,
            "descriptors": len(descriptors),
        }
        self.starting.add(key)
        try:
            self.send(message, descriptors)
        finally:
            os.close(write_end)
            if connection is not None:
                connection.close()
        if self.lost and key in self.starting:
            self.end(key, -signal.SIGKILL)

    def send(self, message: dict[str, Any], descriptors: list[int]) -> None:
        """Ask the fork server for something, unless it has died."""
        if self.lost:
            return
        data = framed(message)
        try:
            self.control.setblocking(True)
            sent = socket.send_fds(self.control, [data], descriptors) if descriptors else 0
            self.control.sendall(data[sent:])
            self.control.setblocking(False)
        except OSError:
            self.lose()

    def read(self) -> None:
        """Take the fork server's news."""
        while not self.lost:
            try:
                data = self.control.recv(65536)
            except BlockingIOError:
                break
            except ConnectionError:
                data = b""
            if not data:
                self.lose()
                break
            self.pending += data
        messages, self.pending = unframed(self.pending)
        for message in messages:
            key = message["id"]
            self.starting.discard(key)
            if message["op"] == "started":
                self.pids[key] = message["pid"]
            else:
                self.end(key, message["code"])

    def read_output(self, output: Output) -> None:
        if output.is_open and self.unwatch is not None:
            descriptor = output.descriptor
            if not output.read():
                self.unwatch(descriptor)

    def end(self, key: int, code: int) -> None:
        """Controller `key`'s process has ended."""
        self.pids.pop(key, None)
        self.starting.discard(key)
        output = self.outputs[key]
        if output.is_open:
            if self.unwatch is not None:
                self.unwatch(output.descriptor)
            output.drain()
            output.finish()
        self.ended[key] = code

    def lose(self) -> None:
        """The fork server has died: its children are dead or are killed now."""
        if self.lost:
            return
        self.lost = True
        if self.unwatch is not None:
            self.unwatch(self.control)
        for key, pid in list(self.pids.items()):
            kill_group(pid)
            self.end(key, -signal.SIGKILL)
        for key in list(self.starting):
            self.end(key, -signal.SIGKILL)

    def take_ended(self) -> dict[int, int]:
        """Exit codes of the processes that ended since the last call."""
        ended, self.ended = self.ended, {}
        return ended

    def kill(self, key: int) -> None:
        """End controller `key` and what it has started."""
        self.send({"op": "kill", "id": key}, [])

    def ask_stack(self, key: int) -> None:
        """Have controller `key`, one of Python's, print its stack and end."""
        self.send({"op": "stack", "id": key}, [])

    def close(self) -> None:
        """End whatever still runs; afterwards no process of the fleet is left."""
        if not self.lost and self.unwatch is not None:
            self.unwatch(self.control)
        self.control.close()  # the fork server kills all its children when it sees this
        for output in self.outputs.values():
            if output.is_open:
                if self.unwatch is not None:
                    self.unwatch(output.descriptor)
                output.drain()
                output.finish()
        if self.process is None:
            self.theirs.close()
            return
        try:
            wait_for(self.process, 2.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            for pid in self.pids.values():
                kill_group(pid)
        self.pids.clear()


def wait_for(process: subprocess.Popen[bytes], seconds: float) -> None:
    """Wait for the end of a process; raises TimeoutExpired.

    Where the system tells of it (Linux), at once: Python itself looks, and sleeps ever longer.
    """
    with contextlib.suppress(AttributeError, OSError):
        told = os.pidfd_open(process.pid)
        try:
            poll = select.poll()
            poll.register(told, select.POLLIN)
            poll.poll(1000 * seconds)
        finally:
            os.close(told)
    process.wait(timeout=seconds)


def raise_descriptor_limit() -> None:
    """Each controller needs two descriptors; the usual soft limit of 1024 is too few for 1000."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = 65536 if hard == resource.RLIM_INFINITY else min(hard, 65536)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
