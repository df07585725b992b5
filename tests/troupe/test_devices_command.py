"""`troupe devices`: what it lists, and what it says where there is no Player server."""

from __future__ import annotations

import socket

import pytest
import typer
from typer.testing import CliRunner, Result

from player import DeviceAddr, Interface
from tests.troupe.stub_server import rude_server, stub_server
from troupe.commands.devices import devices, parse_server

app = typer.Typer()
app.command()(devices)


def run(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def test_every_device_is_listed_with_its_driver_in_the_servers_order() -> None:
    addrs = [DeviceAddr(Interface.LASER, 3), DeviceAddr(Interface.POSITION2D, 0)]
    with stub_server({addr: [] for addr in addrs}) as stub:
        done = run(stub.name)
    assert done.exit_code == 0, done.stderr
    banner, *rows = done.stdout.splitlines()
    assert banner == f"{stub.name}: Player v.3.1.1-dev"
    assert [row.split() for row in rows] == [["laser:3", "stub_3"], ["position2d:0", "stub_0"]]


def test_what_a_server_says_of_itself_commands_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not even a line of its own: one line per device, and every control character is written."""
    evil = "\x1b]0;title\x07\x1b[2J\n  fake:0  line\r\u202e\x9b31m"
    banner = b"Player v.\x1b[31m\x1b]0;B\x07\x9b\n\x7f".ljust(32, b"\0")
    monkeypatch.setattr("player.outbox.BANNER", banner)
    with stub_server({DeviceAddr(Interface.LASER, 0): []}, driver=evil) as stub:
        done = run(stub.name)
    assert done.exit_code == 0, done.stderr
    first, second = done.stdout.removesuffix("\n").split("\n")
    assert first == f"{stub.name}: Player v.\\x1b[31m\\x1b]0;B\\x07\\x9b\\n\\x7f"
    assert second.split(maxsplit=1)[0] == "laser:0"
    assert second.endswith("\\x1b]0;title\\x07\\x1b[2J\\n  fake:0  line\\r\\u202e\\x9b31m")
    assert (first + second).isprintable()


def test_a_port_without_devices_says_so() -> None:
    with stub_server({}) as stub:
        assert "no devices" in run(stub.name).stdout


def test_an_interface_that_has_no_name_is_listed_by_its_number() -> None:
    with stub_server({DeviceAddr(200, 1): []}) as stub:
        assert "interface200:1" in run(stub.name).stdout


def test_where_nobody_listens_the_message_says_so_and_the_code_is_2() -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        server = f"127.0.0.1:{free.getsockname()[1]}"
    done = run(server)
    assert done.exit_code == 2
    assert server in done.stderr
    assert "refused" in done.stderr
    assert not done.stdout


@pytest.mark.parametrize(
    "greeting",
    [
        b"SSH-2.0-OpenSSH_9.6\r\n",
        b"HTTP/1.0 400 Bad Request\r\n\r\n",
        b"\x1b[2J\x1b]0;title\x07\x9b31mgone\r\n".rjust(40),
    ],
)
def test_another_kind_of_server_is_named_with_what_it_said(greeting: bytes) -> None:
    with rude_server(greeting) as server:
        done = run(server)
    assert done.exit_code == 2
    assert "no Player server" in done.stderr
    assert greeting[:7].decode() in done.stderr
    assert done.stderr.removesuffix("\n").isprintable()


def test_a_server_that_says_nothing_is_given_up_after_the_timeout() -> None:
    with rude_server(b"") as server:
        done = run(server, "--timeout", "0.2")
    assert done.exit_code == 2
    assert "0.2 s" in done.stderr


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("robot.local:7000", ("robot.local", 7000)),
        ("robot.local", ("robot.local", 6665)),
        (":7000", ("127.0.0.1", 7000)),
        ("[::1]:7000", ("::1", 7000)),
    ],
)
def test_a_server_is_a_host_and_a_port(text: str, place: tuple[str, int]) -> None:
    assert parse_server(text) == place


@pytest.mark.parametrize("text", ["host:", "host:0", "host:65536", "host:http", "a b:1"])
def test_what_is_no_address_is_refused_with_an_example(text: str) -> None:
    done = run(text)
    assert done.exit_code == 2
    assert "127.0.0.1:6665" in done.stderr
