"""Who is let in: the address has a secret in it, and no page of another site gets through.

Whoever can read the address may watch. Against pages of other sites in the same browser: `Host`
must be an address of this machine (a name that somebody else's server gives out is none), and the
`Origin` of a WebSocket the very host that it came to.
"""

from __future__ import annotations

import hmac
import ipaddress
import socket
from collections.abc import Mapping
from functools import cache
from http import HTTPStatus
from importlib.resources import files
from typing import NamedTuple
from urllib.parse import urlsplit

from sim.ports import is_loopback

KINDS = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
SOCKET = "socket"
"""The path of the WebSocket, below the token."""


class Answer(NamedTuple):
    """What an HTTP request gets."""

    status: HTTPStatus
    body: bytes
    kind: str = "text/plain; charset=utf-8"
    policy: str = ""


def answer(token: str, bound: str, path: str, headers: Mapping[str, str]) -> Answer | None:
    """The answer to a GET of `path`; None: a WebSocket may be opened there."""
    if not known_host(headers.get("Host", ""), bound):
        return Answer(HTTPStatus.MISDIRECTED_REQUEST, b"This is not the address of a view.\n")
    given, _, name = path.partition("?")[0].removeprefix("/").partition("/")
    if not hmac.compare_digest(given.encode(), token.encode()):
        return Answer(HTTPStatus.NOT_FOUND, b"The address is not complete: it has a token in it.\n")
    if name == SOCKET:
        origin = headers.get("Origin")
        if origin is not None and origin not in origins(headers["Host"]):
            return Answer(HTTPStatus.FORBIDDEN, b"No page of another site gets in here.\n")
        return None
    page = page_files()
    if (name or "index.html") not in page:
        return Answer(HTTPStatus.NOT_FOUND, b"There is no such file.\n")
    name = name or "index.html"
    kind = KINDS[name[name.rindex(".") :]]
    return Answer(HTTPStatus.OK, page[name], kind, policy(headers["Host"]))


def origins(host: str) -> tuple[str, str]:
    """The origins of our own pages, as a browser names them that came to this host."""
    return f"http://{host}", f"https://{host}"


def policy(host: str) -> str:
    """What the page may load: its own files and its own WebSocket."""
    return (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
        f"connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'"
    )


def known_host(header: str, bound: str) -> bool:
    """Whether a Host header names this machine: by number, as localhost, or as it is called.

    The port may be another one: `ssh -L` has its own.
    """
    name = urlsplit(f"//{header}").hostname if header else None
    if name is None:
        return False
    if name in ("localhost", bound, *own_names()):
        return True
    try:
        address = ipaddress.ip_address(name)
    except ValueError:
        return False
    return address.is_loopback or not is_loopback(bound)


@cache
def own_names() -> tuple[str, ...]:
    """What this machine is called."""
    return (socket.gethostname().lower(),)


@cache
def page_files() -> dict[str, bytes]:
    """The page's files, by name."""
    folder = files("troupe.live").joinpath("page")
    names = [entry.name for entry in folder.iterdir() if entry.is_file()]
    return {
        name: folder.joinpath(name).read_bytes()
        for name in names
        if name[name.rfind(".") :] in KINDS
    }
