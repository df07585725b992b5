"""Whose a TCP connection is: which of the processes that we have started holds its other end.

A robot's clock is the connection of its controller. Over a socket pair that is plain; over TCP
an onlooker may connect to the same port before the program does. Where the system tells which
process holds a socket (Linux), the program is known by the environment that it was given.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from ipaddress import ip_address
from pathlib import Path

from player.server import Connection

PROC = Path("/proc")


UNKNOWN = -1
"""In place of a process's number where nobody can tell."""


def origin(connection: Connection, environment: dict[str, str]) -> int:
    """The process that a connection comes from, if it was started with these variables, else 0.

    UNKNOWN where nobody can tell: on systems without /proc, and for a process of another user or
    machine (a container, a login elsewhere).
    """
    host, _, peer_port = connection.peer.rpartition(":")
    if not PROC.joinpath("net/tcp").exists() or not peer_port.isdecimal():
        return UNKNOWN
    inode = socket_inode(int(peer_port), connection.port)
    if inode is None and not ip_address(host).is_loopback:
        return UNKNOWN
    if not inode:
        return 0  # the process has closed it: it is nobody's clock any more
    marks = {f"{key}={value}".encode() for key, value in environment.items()}
    others = []
    for process in processes():
        if marks <= variables(process):
            if holds(process, inode):
                return int(process.name)
        else:
            others.append(process)
    if any(holds(process, inode) for process in others):
        return 0
    # nobody is seen to hold it: a process that we may not look into, unless it was closed just now
    return UNKNOWN if socket_inode(int(peer_port), connection.port) == inode else 0


def socket_inode(local: int, remote: int) -> int | None:
    """The inode of this machine's socket from port `local` to port `remote`.

    None: there is no such socket; 0: there is one, but no process holds it any more.
    """
    for name in ("tcp", "tcp6"):
        try:
            rows = PROC.joinpath("net", name).read_text(encoding="ascii").splitlines()[1:]
        except OSError:
            continue
        for row in rows:
            words = row.split()
            if (port_of(words[1]), port_of(words[2])) == (local, remote):
                return int(words[9])
    return None


def port_of(address: str) -> int:
    """The port in an address as /proc/net/tcp writes it, `0100007F:1A09`."""
    return int(address.rpartition(":")[2], 16)


def processes() -> Iterator[Path]:
    """The folders of all processes."""
    return (PROC / name for name in os.listdir(PROC) if name.isdecimal())


def variables(process: Path) -> set[bytes]:
    """The environment that a process was started with; empty if we may not know."""
    try:
        return set(process.joinpath("environ").read_bytes().split(b"\0"))
    except OSError:
        return set()


def holds(process: Path, inode: int) -> bool:
    """Whether a process has a socket open; no if we may not know."""
    wanted = f"socket:[{inode}]"
    try:
        for name in os.listdir(process / "fd"):
            try:
                if os.readlink(process / "fd" / name) == wanted:
                    return True
            except OSError:
                continue  # closed meanwhile
    except OSError:
        pass
    return False
