"""What Player's own clients once sent to Player, sent to a run of ours: reply by reply."""

from __future__ import annotations

import math
import struct
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.player.captured_conversations import Captured, client_messages, server_messages
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    BLOBFINDER,
    BUMPER,
    CMD,
    DATA,
    FIDUCIAL,
    LASER,
    LOG,
    NACK,
    PLAYER,
    POSITION2D,
    RANGER,
    REQ,
    SIMULATION,
    SONAR,
    SYNCH,
    Got,
    RawClient,
)

WORLD = """\
size: [20, 20]
models:
  first:
    body: {{shape: box, size: [1, 1]}}
    simulation: full
    fiducial: 5
    sensors:
      - &scan {{type: ranger, samples: 180, fov: 180, range: 20}}
      - *scan
      - {{type: ranger, elements: [[0.5, 0, 0], [0, 0.5, 90], [-0.5, 0, 180], [0, -0.5, -90]]}}
      - {{type: laser, samples: 180, fov: 180, range: 20}}
      - {{type: blobfinder, fov: 180, range: 20, colors: [red, green]}}
      - {{type: fiducial, range: 15, fov: 180}}
      - {{type: bumper, count: 2}}
  second:
    body: {{shape: box, size: [1, 1], color: red}}
    simulation: full
    fiducial: 6
    sensors:
      - *scan
      - {{type: blobfinder, fov: 180, range: 20, colors: [red, green]}}
robots:
  - {{name: r0, model: first, pose: [5, 5, 0]{r0}}}
  - {{name: r1, model: second, pose: [12, 8, 180]{r1}}}
controllers: {{client: {{external: true}}}}
clock: {{interval: 0.05}}
player: {{layout: {layout}}}
"""

DRIVEN = ", controller: client"

# What this server answers where Player (with Stage) answers otherwise: docs/player.md says why.
SAYS_YES = {
    (LASER, 5),  # get_id
    (RANGER, 2),  # power
    (RANGER, 3),  # intensities
    (BLOBFINDER, 1),  # set_color
    (FIDUCIAL, 2),  # get_fov
    (POSITION2D, 255),  # capabilities: the command that is asked about is obeyed
}


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[object]:
    runs = []

    def start(driven: str, layout: str = "shared") -> Serving:
        world = WORLD.format(
            r0=DRIVEN * (driven == "r0"), r1=DRIVEN * (driven == "r1"), layout=layout
        )
        runs.append(Serving(write_world(tmp_path, world)))
        return runs[-1]

    yield start
    for run in runs:
        run.stop()


class Talk:
    """A captured client, line by line, and what our server says to it."""

    def __init__(self, port: int, name: str) -> None:
        self.client = RawClient(port)
        self.sent = client_messages(name)
        self.theirs = replies_of(name)
        self.pushed = name.startswith("push")
        self.data: list[Got] = []
        self.pairs: list[tuple[Captured, Got, Captured | None]] = []

    def run(self) -> None:
        for sent in self.sent:
            if sent.type == CMD and self.pushed:  # as the program: a reading, then a command
                self.data.append(self.client.receive())
            self.client.send(sent.raw)
            if sent.type != REQ:
                continue
            reply = self.reply()
            expected = self.theirs.pop(0)
            assert (reply.interf, reply.index, reply.subtype) == (*sent[2:4], sent.subtype)
            assert reply.seq == sent.seq
            self.pairs.append((sent, reply, expected))
            if (sent.interf, sent.subtype) == (PLAYER, 4):
                while (got := self.client.receive()).type != SYNCH:
                    assert got.type == DATA
                    self.data.append(got)
                assert got.subtype == 1  # nothing was lost
        self.client.close()

    def reply(self) -> Got:
        """The next reply; data that was there before it comes first, and SYNCH never does."""
        while (got := self.client.receive()).type == DATA:
            self.data.append(got)
        assert got.type in (ACK, NACK)
        return got


def replies_of(name: str) -> list[Captured | None]:
    """What Player answered to each request in turn; None where it kept silent."""
    replies = [m for m in server_messages(name) if m.type in (ACK, NACK)]
    found: list[Captured | None] = []
    for sent in client_messages(name):
        if sent.type != REQ:
            continue
        key = (sent.interf, sent.index, sent.subtype)
        answered = bool(replies) and (*replies[0][2:4], replies[0].subtype) == key
        found.append(replies.pop(0) if answered else None)
        while replies and (replies[0].interf, replies[0].subtype) == (LASER, 2) == key[::2]:
            replies.pop(0)  # the second reply to one request
    assert not replies
    return found


def check_replies(talk: Talk) -> None:
    """Yes and no as Player says them, and payloads of the same layout."""
    for sent, reply, expected in talk.pairs:
        key = (sent.interf, sent.subtype)
        if key in SAYS_YES:
            assert reply.type == ACK, sent
        elif expected is None or asks_for(sent, LOG):
            assert reply.type == NACK, sent  # Player keeps silent, or writes a log
        elif asks_for(sent, SONAR):
            assert (reply.type, expected.type) == (ACK, NACK)  # a ring of rangers is one here
        elif key == (SIMULATION, 2) and reply.type == NACK:
            x, y = struct.unpack(">2d", sent.payload[-24:-8])
            assert min(x, y) < 1  # our worlds begin at their corner
        else:
            assert reply.type == expected.type, sent
            check_layout(sent, reply, expected)


def asks_for(sent: Captured, interface: int) -> bool:
    """Whether a request is one to a device of that interface, or to have it."""
    if sent.interf == PLAYER and sent.subtype in (2, 3):
        return struct.unpack(">I", sent.payload[8:12]) == (interface,)
    return sent.interf == interface


def check_layout(sent: Captured, reply: Got, expected: Captured) -> None:
    if reply.type == NACK:
        return
    key = (sent.interf, sent.subtype)
    mine, theirs = reply.payload, expected.payload
    if key == (PLAYER, 1):  # the device list: as many rows as are announced
        count, again = struct.unpack(">II", mine[:8])
        assert count == again == (len(mine) - 8) / 16
        listed = {struct.unpack(">II", mine[k + 8 : k + 16]) for k in range(8, len(mine), 16)}
        assert {(POSITION2D, 0), (POSITION2D, 1), (RANGER, 2), (SIMULATION, 0)} <= listed
    elif key in ((PLAYER, 2), (PLAYER, 3)):  # the device asked for, and the driver's name
        start = 16 if key[1] == 2 else 20
        assert mine[8:start] == theirs[8:start] == sent.payload[8:start]
        count, again = struct.unpack(">II", mine[start : start + 8])
        assert count == again
        assert mine[start + 8 :] == b"troupe\0\0"
    else:
        assert len(mine) == len(theirs), sent


def state(got: Got) -> tuple[float, ...]:
    return got.unpack("6dI")


def check_data(data: list[Got]) -> None:
    """Every reading is whole and can be what a sensor sees."""
    for got in data:
        kind = (got.interf, got.subtype)
        if kind == (POSITION2D, 1):
            assert all(map(math.isfinite, state(got)[:6]))
        elif kind == (RANGER, 1):
            rays = 4 if got.index == 2 else 180
            count, again, *ranges = got.unpack(f"II{rays}d")
            assert count == again == rays
            assert all(0 <= value <= 20 for value in ranges)
        elif kind == (RANGER, 3):
            assert set(got.unpack("II180d")[2:]) <= {0.0, 1.0}
        elif kind == (LASER, 1):
            least, most, step, reach, count, again = struct.unpack(">4f2I", got.payload[:24])
            assert count == again
            assert least + (count - 1) * step == pytest.approx(most, abs=1e-5)  # float32
            ranges = struct.unpack(f">{count}f", got.payload[24 : 24 + 4 * count])
            assert all(0 <= value <= reach for value in ranges)
        elif kind == (BLOBFINDER, 1):
            width, height, count, again = struct.unpack(">4I", got.payload[:16])
            assert count == again == (len(got.payload) - 16) / 40
            for k in range(count):
                row = struct.unpack(">9If", got.payload[16 + 40 * k : 56 + 40 * k])
                assert 0 <= row[5] <= row[3] <= row[6] < width
                assert 0 <= row[7] <= row[4] <= row[8] < height
        elif kind == (FIDUCIAL, 1):
            count, again = struct.unpack(">II", got.payload[:8])
            assert count == again == (len(got.payload) - 8) / 100
        elif kind == (SONAR, 1):
            assert len(got.payload) == 8 + 4 * 4
        else:
            assert kind == (BUMPER, 1)
            assert len(got.payload) == 12
        assert got.time >= 0


@pytest.mark.parametrize(
    ("name", "driven", "layout"),
    [("pull_r0", "r0", "shared"), ("pull_r2_6666", "r0", "per_robot")],
)
def test_a_pull_client_gets_every_round_and_its_robot_drives(
    serve, name: str, driven: str, layout: str
) -> None:
    run = serve(driven, layout)
    talk = Talk(run.shared_port if layout == "shared" else run.port(driven), name)
    talk.run()
    check_replies(talk)
    check_data(talk.data)
    rounds = sum((s.interf, s.subtype) == (PLAYER, 4) for s, *_ in talk.pairs)
    kinds = Counter((got.interf, got.index, got.subtype) for got in talk.data)
    theirs = {(m.interf, m.index, m.subtype) for m in server_messages(name) if m.type == DATA} - {
        (RANGER, 0, 3)
    }  # intensities are off until they are asked for
    assert set(kinds) == theirs
    assert all(count >= rounds for count in kinds.values())
    told = [struct.unpack(">3dI", m.payload)[0] for m in talk.sent if m.type == CMD]
    driven_for = [state(got) for got in talk.data if got.interf == POSITION2D]
    assert max(told) == 0.5
    assert max(row[3] for row in driven_for) == pytest.approx(0.5)
    assert driven_for[-1][0] > 0.2  # it has gone ahead: 1 s or more at 0.5 m/s, from a stand


def test_a_push_client_is_sent_its_robots_data(serve) -> None:
    run = serve("r1")
    talk = Talk(run.shared_port, "push_r1")
    talk.run()
    check_replies(talk)
    check_data(talk.data)
    kinds = {(got.interf, got.index) for got in talk.data}
    assert {(POSITION2D, 1), (RANGER, 1)} <= kinds
    assert {got.index for got in talk.data} == {1}


def test_every_request_of_the_c_client_is_answered_once(serve) -> None:
    """Refused ones, unknown ones, and one without its payload; a pause ends with its client."""
    run = serve("r0")
    talk = Talk(run.shared_port, "misc_c_client")
    talk.run()
    check_replies(talk)
    check_data(talk.data)
    assert {SIMULATION, LASER, BLOBFINDER, FIDUCIAL, BUMPER, LOG} <= {
        s.interf for s, *_ in talk.pairs
    }
    fiducial = [r for s, r, _ in talk.pairs if (s.interf, s.subtype) == (FIDUCIAL, 7)]
    assert fiducial[0].payload == struct.pack(">I", 77)  # as it has just been set
