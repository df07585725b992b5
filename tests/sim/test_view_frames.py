"""Frames: what the simulator writes, its own decoder and the page's read back, bit for bit."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.video.snapshot import Backdrop
from sim.view import frames
from sim.view.frames import (
    COLORS,
    CONES,
    DRAWN,
    FANS,
    MARKS,
    PAINT,
    POSES,
    ROBOTS,
    SAID,
    SIGHTS,
    SOLIDS,
    STATUS,
    SWITCHES,
    THINGS,
    Frame,
    Message,
    decode,
    decode_robots,
    encode_moment,
    encode_scene,
)
from sim.view.moment import Cones, Fan, Marks, Moment, Robot, Scene, Sight, Switches
from tests.patience import PATIENCE

PAGE = Path(__file__).resolve().parents[2] / "troupe" / "live" / "page"
POSE = (1.5, -2.25, 0.5)  # numbers that float32 holds as they are

READ = """
import { decode } from "./frames.js";
import { readFileSync } from "node:fs";
const [message] = process.argv.slice(-1);
const bytes = readFileSync(message);
const found = decode(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
console.log(JSON.stringify(found, (key, value) =>
  ArrayBuffer.isView(value) ? Array.from(value) : value));
"""


def moment(**changes: Any) -> Moment:
    """A moment that has something of everything."""
    parts: dict[str, Any] = {
        "time": 12.5,
        "tick": 125,
        "poses": np.array([[1, 2, 0.5], [3, 4, -0.5]], np.float32),
        "colors": np.array([0xFF0000, 0x00FF00], np.uint32),
        "states": np.array([1, 6], np.uint8),
        "robots": [Robot("r1", "rover"), Robot("ärger", "rover")],
        "things": np.array([[7, 8, 0.25]], np.float32),
        "fans": [Fan(1, 0, POSE, 3.0, np.array([1, 2, 2.5], np.float32))],
        "cones": [Cones(0, 1, 0.25, np.array([[1, 2, 0.5, 4]], np.float32))],
        "sights": [Sight(0, 2, POSE, 1.5, 160, 120, np.array([[255, 3, 9, 40, 80, 1500]], "u4"))],
        "marks": [Marks(1, 3, POSE, np.array([[7, 1, 2, 0.5]], np.float32))],
        "switches": [Switches(1, 4, POSE, np.array([[1, 0, 0.5], [0, 0.5, 1]], np.float32))],
        "said": [(1, 12.5, "hello")],
        "drawn": [{"robot": 0, "kind": "points", "points": [[1, 2]], "color": 255, "fill": None}],
        "ways": np.array([[[1, 2, 0.5], [3, 4, 0.5]], [[2, 2, 0.5], [3, 5, 0.5]]], np.float32),
        "jumps": 1,
        "status": {"paused": False, "pace": None},
        "cards": {0: {"name": "r1"}, 1: {"name": "ärger"}},
    }
    return Moment(**{**parts, **changes})


def read_by_the_page(message: bytes, folder: Path) -> dict[str, Any]:
    """What the page's decoder finds in a message."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("no node here to run the page's decoder; the browser's tests do")
    (folder / "message").write_bytes(message)
    shutil.copy(PAGE / "frames.js", folder / "frames.js")
    (folder / "package.json").write_text('{"type": "module"}')
    (folder / "read.js").write_text(READ)
    done = subprocess.run(
        [node, str(folder / "read.js"), str(folder / "message")],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_a_moment_is_read_back_a_moment_as_it_was() -> None:
    found = decode(encode_moment(Frame(moment()), None, [1]))
    assert (found.time, found.tick, found.robots) == (12.5, 125, 2)
    assert np.array_equal(found.poses, moment().poses)
    assert decode_robots(found) == moment().robots
    (fan,) = found.fans
    assert fan[:4] == (1, 0, POSE, 3.0)
    assert fan.ranges.tolist() == [1, 2, 2.5]


def test_the_page_reads_a_moment_as_it_was(tmp_path: Path) -> None:
    layer = np.zeros((3, 4), np.int16)
    layer[0, 1:3], layer[2, 3] = 2, 1
    found = read_by_the_page(encode_moment(Frame(moment(paint=layer)), None, [1]), tmp_path)
    assert found["kind"] == "moment"
    assert (found["time"], found["tick"], found["robots"]) == (12.5, 125, 2)
    assert found["poses"] == [1, 2, 0.5, 3, 4, -0.5]
    assert found["colors"] == [0xFF0000, 0x00FF00]
    assert found["states"] == [1, 6]
    assert found["things"] == [7, 8, 0.25]
    x, y, yaw = POSE
    at = {"x": x, "y": y, "yaw": yaw}
    assert found["fans"] == [{"robot": 1, "sensor": 0, **at, "fov": 3.0, "ranges": [1, 2, 2.5]}]
    assert found["cones"] == [{"robot": 0, "sensor": 1, "fov": 0.25, "elements": [1, 2, 0.5, 4]}]
    assert found["sights"] == [
        {"robot": 0, "sensor": 2, **at, "fov": 1.5, "width": 160, "height": 120}
        | {"blobs": [255, 3, 9, 40, 80, 1500]}
    ]
    assert found["marks"] == [{"robot": 1, "sensor": 3, **at, "seen": [7, 1, 2, 0.5]}]
    assert found["switches"] == [{"robot": 1, "sensor": 4, **at, "parts": [1, 0, 0.5, 0, 0.5, 1]}]
    assert found["paint"] == {"firsts": [1, 11], "lengths": [2, 1], "owners": [2, 1]}
    assert found["entered"] == {"from": 0, "robots": [["r1", "rover"], ["ärger", "rover"]]}
    assert found["said"] == [[1, 12.5, "hello"]]
    assert found["drawn"] == moment().drawn
    assert found["ways"] == [[1, 2, 0.5, 3, 4, 0.5], [2, 2, 0.5, 3, 5, 0.5]]
    assert found["status"] == {"paused": False, "pace": None}
    assert found["cards"] == {"1": {"name": "ärger"}}


def test_the_page_reads_a_scene_as_it_was(tmp_path: Path) -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    scene = Scene({"title": "Wände"}, [(square, 0xFF0000), (square[:3] + 2, 0x808080)])
    found = read_by_the_page(encode_scene(scene), tmp_path)
    assert found["kind"] == "scene"
    assert found["about"] == {"title": "Wände"}
    assert found["solids"] == [
        {"points": [0, 0, 1, 0, 1, 1, 0, 1], "color": 0xFF0000},
        {"points": [2, 2, 3, 2, 3, 3], "color": 0x808080},
    ]


def sent(now: Moment, before: Moment | None) -> Message:
    """The message of a moment to a viewer that got another one last."""
    return decode(encode_moment(Frame(now), before and Frame(before)))


def test_every_section_that_is_described_is_written() -> None:
    described = {int(n) for n in re.findall(r"^ +(\d+)  [a-z]+ ", frames.__doc__, re.MULTILINE)}
    square = np.array([[0, 0], [1, 0], [1, 1]], float)
    scene = decode(encode_scene(Scene({"title": "one"}, [(square, 0)])))
    layer = np.ones((3, 4), np.int16)
    whole = decode(encode_moment(Frame(moment(paint=layer)), None, [1]))
    assert len(described) == 18
    assert set(scene.sections) | set(whole.sections) == described


def test_what_has_not_changed_is_not_sent_again() -> None:
    first = moment()
    assert {COLORS, ROBOTS, SAID, STATUS, FANS, SIGHTS} < set(sent(first, None).sections)
    assert set(sent(moment(), first).sections) == {POSES, THINGS}
    newcomer = moment(
        poses=np.zeros((3, 3), np.float32), robots=[*first.robots, Robot("r3", "rover")]
    )
    assert decode_robots(sent(newcomer, first)) == [Robot("r3", "rover")]


def test_nothing_is_said_of_what_is_not_there() -> None:
    kinds = ("fans", "cones", "sights", "marks", "switches", "said", "drawn")
    bare = dict.fromkeys(kinds, ())
    found = sent(moment(**bare), None).sections
    assert not {FANS, CONES, SIGHTS, MARKS, SWITCHES, SAID, DRAWN} & set(found)


def test_what_is_no_more_is_told(tmp_path: Path) -> None:
    gone = encode_moment(Frame(moment(fans=(), said=())), Frame(moment()))
    assert decode(gone).sections[FANS] == b""
    found = read_by_the_page(gone, tmp_path)
    assert found["fans"] == []
    assert found["said"] == [[1, 0.0, ""]]
    assert "sights" not in found


def test_what_stands_is_sent_again_only_where_a_hand_has_moved_it() -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    here, there = (Backdrop((9.0, 9.0), solids=[(square + x, 0xFF)]) for x in (2.0, 5.0))
    found, before = [], None
    for backdrop in (None, there, there, here):
        now = moment(backdrop=backdrop)
        sections = sent(now, before).sections
        found.append(np.frombuffer(sections.get(SOLIDS, b"")[-32:], "<f4"))
        before = now
    assert [len(one) for one in found] == [0, 8, 0, 8]
    assert found[1].reshape(4, 2) == pytest.approx(square + 5.0)
    assert found[3].reshape(4, 2) == pytest.approx(square + 2.0)


def test_paint_arrives_whole_however_many_moments_are_dropped() -> None:
    rng = np.random.default_rng(1)
    layer, shown, last = np.zeros((40, 30), np.int16), np.zeros((40, 30), np.int16), None
    for turn in range(20):
        layer = layer.copy()
        row, column = rng.integers(0, 20, 2)
        layer[row : row + 9, column : column + 9] = rng.integers(1, 5)
        if rng.random() < 0.5 and turn < 19:
            continue  # dropped
        now = moment(paint=layer)
        sent(now, last).paint(shown)
        assert np.array_equal(shown, layer)
        last = now
    assert PAINT not in sent(moment(paint=layer), last).sections


def test_numbers_that_are_none_are_json_all_the_same() -> None:
    told = sent(moment(status={"speed": float("nan")}), None)
    assert isinstance(told.json(STATUS), dict)


@pytest.mark.parametrize("data", [b"", b"short", bytes(24)])
def test_what_is_no_message_is_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match="message"):
        decode(data)
