"""Runs a command in a process that the server has forked: `client.py SOCKET WORDS...`.

It passes on its folder, environment and standard files, and the signals that it gets, and ends as
the command has. It needs nothing but Python, so that it starts at once.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import struct
import sys
from collections.abc import Mapping, Sequence
from typing import Any


class Started:
    """A command that has been started."""

    def __init__(
        self,
        path: str,
        words: Sequence[str],
        folder: str,
        environment: Mapping[str, str],
        files: Sequence[int],
        program: str | None = None,
    ) -> None:
        request: dict[str, Any] = {
            "words": list(words),
            "program": program,
            "folder": folder,
            "environment": dict(environment),
        }
        text = json.dumps(request).encode()
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(path)
        socket.send_fds(self.socket, [struct.pack(">I", len(text))], list(files))
        self.socket.sendall(text)
        self._lines = self.socket.makefile("r")
        self.pid = int(self._lines.readline())

    def wait(self, most: float | None = None) -> int:
        """The exit code, once it has ended; negative for a signal's number.

        After `most` seconds it is killed, and TimeoutError raised.
        """
        self.socket.settimeout(most)
        try:
            return int(self._lines.readline())
        except TimeoutError:
            os.kill(self.pid, signal.SIGKILL)
            raise
        finally:
            self._lines.close()
            self.socket.close()


def main() -> None:
    """Be the command."""
    environment = {os.fsdecode(k): os.fsdecode(v) for k, v in os.environb.items()}
    started = Started(sys.argv[1], sys.argv[2:], os.getcwd(), environment, (0, 1, 2))
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: os.kill(started.pid, number))
    code = started.wait()
    if code < 0:
        signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    sys.exit(code)


if __name__ == "__main__":
    main()
