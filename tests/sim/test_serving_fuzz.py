"""No sequence of messages whatever ends a run."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.sim.attacks import ONE_DRIVES
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    CMD,
    LASER,
    PLAYER,
    POSITION2D,
    REQ,
    SIMULATION,
    RawClient,
    message,
    pulling,
    text,
)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_world(tmp_path_factory.mktemp("robust"), ONE_DRIVES)


SIZES = {
    (POSITION2D, CMD): {1: 28, 2: 52, 3: 16, 4: 16},
    (POSITION2D, REQ): {1: 0, 2: 4, 3: 4, 4: 4, 5: 24, 6: 0, 7: 12, 8: 12, 9: 8},
    (LASER, REQ): {1: 0, 2: 28, 3: 0, 4: 4, 5: 0},
    (62, REQ): {1: 0, 2: 4, 3: 4, 4: 56, 5: 0},
    (7, REQ): {1: 28, 2: 16, 3: 0},
    (10, REQ): {1: 0, 2: 0, 3: 12, 7: 0, 8: 4},
    (20, CMD): {1: 8},
    (SIMULATION, CMD): {1: 0, 2: 0, 3: 0},
    (PLAYER, REQ): {1: 0, 2: 24, 3: 28, 4: 0, 5: 4, 10: 20},
}
"""Bytes of payloads of fixed size, by interface and type, and subtype."""

KNOWN = [(i, t, s, n) for (i, t), row in SIZES.items() for s, n in row.items()]

numbers = st.one_of(
    st.floats(width=64).map(lambda x: struct.pack(">d", x)),
    st.floats(width=32).map(lambda x: struct.pack(">f", x)),
    st.sampled_from([0, 1, 2, 3, 255, 1 << 31, 0xFFFFFFFF]).map(lambda x: struct.pack(">I", x)),
    st.binary(min_size=4, max_size=4),
)


@st.composite
def known_messages(draw: st.DrawFn) -> bytes:
    """A message of the protocol, of the right size, that holds any numbers whatever."""
    interf, type_, subtype, size = draw(st.sampled_from(KNOWN))
    payload = b"".join(draw(st.lists(numbers, min_size=size // 4, max_size=size // 4)))[:size]
    return message(interf, draw(st.sampled_from([0, 0, 0, 1])), type_, subtype, payload)


@st.composite
def poses(draw: st.DrawFn) -> bytes:
    """A robot put anywhere."""
    values = draw(st.lists(st.floats(width=64), min_size=3, max_size=3))
    name = draw(st.sampled_from(["one", "two", "", "three"]))
    return message(SIMULATION, 0, REQ, 2, text(name) + struct.pack(">3d", *values))


@st.composite
def loose_messages(draw: st.DrawFn) -> bytes:
    """A header of any kind with any payload."""
    interf = draw(st.sampled_from([1, 4, 5, 6, 7, 10, 12, 14, 20, 31, 45, 55, 62, 99, 70_000]))
    type_ = draw(st.integers(0, 8))
    subtype = draw(st.integers(0, 256))
    return message(interf, draw(st.integers(0, 3)), type_, subtype, draw(st.binary(max_size=80)))


@pytest.fixture(scope="module")
def fuzzed(path: Path) -> Iterator[Serving]:
    with Serving(path) as serving:
        yield serving


@pytest.fixture(scope="module")
def driver(fuzzed: Serving) -> Iterator[RawClient]:
    with pulling(fuzzed.port("one"), (POSITION2D, 0), (LASER, 0)) as client:
        yield client


@settings(
    max_examples=150,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    data=st.lists(
        st.one_of(known_messages(), known_messages(), poses(), loose_messages()), max_size=12
    ),
    cut=st.integers(0, 100),
)
def test_no_sequence_of_messages_ends_the_run(
    fuzzed: Serving, driver: RawClient, data: list[bytes], cut: int
) -> None:
    stream = b"".join(data)
    with RawClient(fuzzed.port("one")) as client:
        client.send(stream[: len(stream) - cut] if cut < 20 else stream)
    driver.mode(2)
    driver.round()
    assert fuzzed.running
    assert not [line for line in fuzzed.lines if "Traceback" in line]
    x, y, _ = fuzzed.pose()
    assert 0 <= x <= 10
    assert 0 <= y <= 10
