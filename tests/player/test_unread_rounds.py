"""Rounds whose data are read when somebody looks: they say what they would have said at once."""

import contextlib
import pickle
import socket
import struct
import threading
from contextlib import contextmanager
from itertools import chain, repeat

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scripted_server import Talk, scripted
from wire_talk import LASER, POSITION2D, say

from player import (
    BlobfinderProxy,
    LaserProxy,
    NoReading,
    PlayerClient,
    PlayerTimeout,
    Position2dProxy,
    XdrError,
)
from player.proxies.blobfinder import Blob
from tests.patience import PATIENCE

BLOBFINDER = 7


def state(x):
    return struct.pack(">6dI", x, 2 * x, 0, 0, 0, 0, 0)


def scan(*ranges, far=8.0, marks=b""):
    head = struct.pack(">4f2I", -1.0, 1.0, 0.5, far, len(ranges), len(ranges))
    tail = struct.pack(">2I", len(marks), len(marks)) + marks + bytes(-len(marks) % 4)
    return head + struct.pack(f">{len(ranges)}f", *ranges) + tail + struct.pack(">I", 5)


def blobs(*ranges, width=160):
    rows = [struct.pack(">9If", 0, 0xFF, 4, 5, 6, 70, 8, 9, 10, far) for far in ranges]
    return struct.pack(">4I", width, 120, len(rows), len(rows)) + b"".join(rows)


NUMBER = st.sampled_from([0.5, 1.0, 3.0])
DATA = st.one_of(
    st.builds(lambda x: (POSITION2D, 1, state(x)), NUMBER),
    st.builds(
        lambda n, far, marks: (LASER, 1, scan(n, 2 * n, far=far, marks=marks)),
        NUMBER,
        st.sampled_from([8.0, 9.0]),
        st.sampled_from([b"", b"\1\0"]),
    ),
    st.builds(
        lambda ranges, width: (BLOBFINDER, 1, blobs(*ranges, width=width)),
        st.lists(NUMBER, max_size=2),
        st.sampled_from([160, 80]),
    ),
    st.just((LASER, 99, b"a later Player's")),
    st.just((POSITION2D, 1, b"lies")),
)
USUAL = st.builds(
    lambda x, y, z: [(POSITION2D, 1, state(x)), (LASER, 1, scan(y)), (BLOBFINDER, 1, blobs(z))],
    NUMBER,
    NUMBER,
    NUMBER,
)
ROUNDS = st.lists(st.one_of(st.lists(DATA, max_size=3), USUAL, USUAL), max_size=12)


class OwnBase(Position2dProxy):
    """Such as a program's own: it wants to see all data as they come."""

    def decode(self, subtype, payload):
        super().decode(subtype, payload)


class OwnLaser(LaserProxy):
    def decode(self, subtype, payload):
        super().decode(subtype, payload)


class OwnCamera(BlobfinderProxy):
    def decode(self, subtype, payload):
        super().decode(subtype, payload)


def value(proxy, name):
    """What a program sees that looks."""
    try:
        found = getattr(proxy, name)
    except NoReading:
        return None
    if isinstance(found, np.ndarray):
        return found.tolist()
    return [(*blob, blob.image.width) for blob in found] if name == "blobs" else found


def seen(rounds, looks, kinds):
    """What a program sees in each reading: all of them, or what `looks` says."""

    def script(talk):
        talk.greet()
        for _ in kinds:
            talk.subscribe()
        for number, data in enumerate(rounds):
            talk.whole_round(*data, time=float(number))

    found = []
    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        proxies = [kind(robot) for kind in kinds]
        goes_on = True
        for look in chain(looks, repeat(NAMES)):
            if not goes_on:
                break
            try:
                goes_on = robot.read()
            except XdrError as error:  # what comes behind it is the next reading
                found.append(str(error))
            found += [goes_on, robot.time]
            found += [(proxy.fresh, proxy.valid, proxy.time) for proxy in proxies]
            found += [(name, value(proxies[at], name)) for at, name in look]
    return found


NAMES = (
    [(0, name) for name in ("x", "y", "stall", "pose")]
    + [(1, name) for name in ("ranges", "max_range", "intensity", "hits")]
    + [(2, name) for name in ("blobs", "width", "height")]
)


@settings(max_examples=60, deadline=None)
@given(ROUNDS, st.lists(st.lists(st.sampled_from(NAMES), max_size=4), min_size=14, max_size=14))
def test_whoever_looks_late_sees_what_others_are_handed(rounds, looks):
    late = seen(rounds, looks, (Position2dProxy, LaserProxy, BlobfinderProxy))
    assert late == seen(rounds, looks, (OwnBase, OwnLaser, OwnCamera))


def talk_of(*numbers, subscribed=2):
    def script(talk):
        talk.greet()
        for _ in range(subscribed):
            talk.subscribe()
        for number in numbers:
            talk.whole_round((POSITION2D, 1, state(number)), (LASER, 1, scan(number)), time=number)

    return script


def test_what_nobody_has_looked_at_is_read_by_nobody(monkeypatch):
    decoded = []
    plain = LaserProxy.decode
    monkeypatch.setattr(LaserProxy, "decode", lambda *args: decoded.append(1) or plain(*args))
    with scripted(talk_of(1.0, 2.0, 3.0, 4.0, 5.0)) as sock, PlayerClient(sock=sock) as robot:
        base, laser = Position2dProxy(robot), LaserProxy(robot)
        while robot.read():
            assert base.x == base.time == laser.time == robot.time
        assert len(decoded) < 3
        assert laser.ranges.tolist() == [5.0]


def test_what_a_program_has_kept_or_changed_stays_as_it_is():
    with scripted(talk_of(1.0, 2.0, 3.0)) as sock, PlayerClient(sock=sock) as robot:
        base, laser = Position2dProxy(robot), LaserProxy(robot)
        assert robot.read()
        assert robot.read()
        kept = laser.ranges
        kept[:] = 7.0
        base.close_calls = 3  # a program may keep its own things there
        assert laser.ranges is kept
        assert robot.read()
        assert kept.tolist() == [7.0]
        assert laser.ranges.tolist() == [3.0]
        assert base.close_calls == 3
        assert not robot.read()
        assert (laser.fresh, laser.ranges.tolist()) == (False, [3.0])


def test_a_proxy_keeps_its_last_data_when_another_is_made_or_it_is_closed():
    def script(talk):
        talk_of(1.0, 2.0, subscribed=2)(talk)
        talk.subscribe()  # the laser's end
        talk.whole_round((POSITION2D, 1, state(3.0)), time=3.0)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base, laser = Position2dProxy(robot), LaserProxy(robot)
        robot.read()
        robot.read()
        other = Position2dProxy(robot)
        assert (base.x, base.time) == (2.0, 2.0)
        with pytest.raises(NoReading):
            _ = other.x
        laser.close()
        robot.read()
        assert (base.x, other.x, laser.ranges.tolist(), laser.time) == (3.0, 3.0, [2.0], 2.0)


def test_blobs_can_be_kept_and_sent_elsewhere():
    def script(talk):
        talk.greet()
        talk.subscribe()
        for number in (1.0, 2.0, 3.0):
            talk.whole_round((BLOBFINDER, 1, blobs(number, number)), time=number)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        camera = BlobfinderProxy(robot)
        kept = []
        while robot.read():
            kept.append(camera.blobs)
        assert [blob.range for pair in kept for blob in pair] == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]
        copies = pickle.loads(pickle.dumps(kept))
        assert copies == kept
        assert all(type(blob) is Blob and blob.image is None for pair in copies for blob in pair)


@pytest.mark.parametrize("tcp", [False, True])
def test_a_server_that_falls_silent_after_many_rounds_is_too_late_as_at_first(tcp):
    with silent_after(3, tcp) as (options, says), PlayerClient(timeout=0.2, **options) as robot:
        base = Position2dProxy(robot)
        for number in (0.0, 1.0, 2.0):
            assert robot.read()
            assert base.x == number
        with pytest.raises(PlayerTimeout, match=r"within 0\.2 s \(data\)"):
            robot.read()
        assert (base.x, base.fresh) == (2.0, False)
        says.set()
        robot.timeout = None
        assert robot.read()
        assert base.x == 3.0


@contextmanager
def silent_after(number, tcp):
    """A server that answers so many requests for data, and the next when it is told to."""
    says = threading.Event()

    def serve(talk):
        talk.greet()
        talk.subscribe()
        for step in range(number + 1):
            talk.expect(1, 3, 4)
            if step == number:
                assert says.wait(PATIENCE)
            said = say(1, 0, 4, 4) + say(POSITION2D, 0, 1, 1, state(step), float(step))
            talk.sock.sendall(said + say(1, 0, 5, 1))
        with contextlib.suppress(EOFError):
            talk.exactly(1)

    if not tcp:
        with scripted(serve) as sock:
            yield {"sock": sock}, says
        return
    with socket.create_server(("127.0.0.1", 0)) as listener:
        failures = []
        thread = threading.Thread(target=accepted, args=(listener, serve, failures))
        thread.start()
        try:
            host, port = listener.getsockname()
            yield {"host": host, "port": port}, says
        finally:
            says.set()
            thread.join(PATIENCE)
        assert failures == []


def accepted(listener, serve, failures):
    try:
        with listener.accept()[0] as sock:
            serve(Talk(sock))
    except Exception as error:
        failures.append(error)
