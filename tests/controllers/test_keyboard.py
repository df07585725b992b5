"""The keyboard: what keys do to the speeds, and the program in a terminal of its own."""

from __future__ import annotations

import os
import pty
import select
import signal
import subprocess
import sys
import termios
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.keyboard import Keys, Throttle, key_by_key, place_of
from player import DeviceAddr, Interface
from tests.patience import PATIENCE
from tests.processes import ROOT, environment
from tests.troupe.stub_server import Stub, stub_server

BASE = DeviceAddr(Interface.POSITION2D, 0)
STATE = (1, bytes(52))


def pressed(keys: str) -> Throttle:
    throttle = Throttle(top=0.5, top_turn=1.0)
    assert all(map(throttle.press, keys))
    return throttle


def test_each_key_changes_one_speed_by_one_step() -> None:
    for key, speeds in {
        "w": (0.1, 0.0, 0.0),
        "s": (-0.1, 0.0, 0.0),
        ",": (0.0, 0.1, 0.0),
        ".": (0.0, -0.1, 0.0),
        "a": (0.0, 0.0, 0.1),
        "d": (0.0, 0.0, -0.1),
        "x": (0.0, 0.0, 0.0),
    }.items():
        throttle = pressed(key)
        assert (throttle.vx, throttle.vy, throttle.vyaw) == speeds


@given(st.text("wasd,. +-xyz\t", max_size=60))
def test_no_keys_lead_beyond_the_limits(keys: str) -> None:
    throttle = pressed(keys)
    assert max(abs(throttle.vx), abs(throttle.vy)) <= 0.5
    assert abs(throttle.vyaw) <= 1.0
    assert 0.01 <= throttle.step <= 1.0


@given(st.text("wasd,.+-", max_size=60))
def test_space_stops_whatever_was_pressed(keys: str) -> None:
    throttle = pressed(keys + " ")
    assert (throttle.vx, throttle.vy, throttle.vyaw) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("key", ["q", "\x03", "\x04"])
def test_q_and_the_control_keys_quit(key: str) -> None:
    assert not Throttle(1.0, 1.0).press(key)


ARROW_BYTES = {b"\x1b[A": "w", b"\x1bOB": "s", b"\x1b[C": "d", b"\x1b[1;2D": "a"}


@given(st.lists(st.sampled_from([*ARROW_BYTES, b"W", b" ", b"\x1b[3~", b"a"])), st.data())
def test_arrows_are_understood_however_their_bytes_are_cut(
    parts: list[bytes], data: st.DataObject
) -> None:
    meant = [ARROW_BYTES.get(part, part.decode().lower()) for part in parts if part[-1:] != b"~"]
    whole = b"".join(parts)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(whole)), max_size=5)))
    keys, found = Keys(), []
    for begin, end in zip([0, *cuts], [*cuts, len(whole)], strict=True):
        found += keys.feed(whole[begin:end])
    assert found == meant


@given(st.binary(max_size=40))
def test_no_bytes_break_the_keys(data: bytes) -> None:
    assert all(len(key) >= 1 for key in Keys().feed(data))


def test_the_terminal_is_as_before_after_an_error() -> None:
    master, slave = pty.openpty()
    before = termios.tcgetattr(slave)
    handler = signal.getsignal(signal.SIGTERM)

    def fail_within() -> None:
        with key_by_key(slave):
            assert not termios.tcgetattr(slave)[3] & (termios.ECHO | termios.ICANON)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail_within()
    assert termios.tcgetattr(slave) == before
    assert signal.getsignal(signal.SIGTERM) is handler
    os.close(master)
    os.close(slave)


@pytest.mark.parametrize(
    ("text", "place"),
    [(None, (None, None)), ("h:7", ("h", 7)), ("h", ("h", 6665)), (":7", ("127.0.0.1", 7))],
)
def test_a_server_is_a_host_and_a_port(text: str | None, place: tuple[object, object]) -> None:
    assert place_of(text) == place


class Terminal:
    """The program on a pseudo-terminal."""

    def __init__(self, *words: str) -> None:
        self.master, self.slave = pty.openpty()
        self.before = termios.tcgetattr(self.slave)
        self.process = subprocess.Popen(
            [sys.executable, "-m", "controllers.keyboard", *words],
            cwd=ROOT,
            env=environment(),
            stdin=self.slave,
            stdout=self.slave,
            stderr=self.slave,
            start_new_session=True,
        )
        self.screen = ""

    def see(self, text: str) -> None:
        """Wait until the screen shows a text."""
        while text not in self.screen:
            ready, _, _ = select.select([self.master], [], [], PATIENCE)
            assert ready, self.screen
            self.screen += os.read(self.master, 4096).decode()

    def press(self, keys: str) -> None:
        os.write(self.master, keys.encode())

    def end(self) -> int:
        """The exit code; the terminal must be as it was."""
        code = self.process.wait(PATIENCE)
        assert termios.tcgetattr(self.slave) == self.before
        return code


@contextmanager
def keyboard_at(stub: Stub) -> Iterator[Terminal]:
    terminal = Terminal(stub.name)
    try:
        terminal.see("forward +0.00")
        yield terminal
    finally:
        terminal.process.kill()
        terminal.process.wait(PATIENCE)
        os.close(terminal.master)
        os.close(terminal.slave)


def test_keys_become_commands_and_q_stops_the_robot() -> None:
    with stub_server({BASE: [STATE]}) as stub, keyboard_at(stub) as terminal:
        terminal.press("w")
        terminal.see("forward +0.10")
        terminal.press("\x1b[D")
        terminal.see("turn +0.10")
        terminal.press("q")
        assert terminal.end() == 0
        commands = [command.message["vel"] for command in stub.wait_for(3)]
    assert commands[0] == (0.1, 0.0, 0.0)
    assert commands[1] == (0.1, 0.0, 0.1)
    assert commands[-1] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_stops_the_robot_and_leaves_the_terminal_as_it_was(number: signal.Signals) -> None:
    with stub_server({BASE: [STATE]}) as stub, keyboard_at(stub) as terminal:
        terminal.press("w")
        terminal.see("forward +0.10")
        terminal.process.send_signal(number)
        terminal.end()
        assert stub.wait_for(2)[-1].message["vel"] == (0.0, 0.0, 0.0)


def test_the_end_of_the_run_is_told_and_the_terminal_is_as_before() -> None:
    with stub_server({BASE: [STATE]}, rounds=20) as stub, keyboard_at(stub) as terminal:
        terminal.see("closed the connection")
        assert terminal.end() == 0


def test_without_a_terminal_it_says_what_to_do() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "controllers.keyboard"],
        cwd=ROOT,
        env=environment(),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert done.returncode == 2
    assert "external: true" in done.stderr
    assert "python -m controllers.keyboard HOST:PORT" in done.stderr
