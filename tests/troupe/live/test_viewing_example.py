"""docs/viewing.md finds a fault in a controller: what it says of the robot's card is there."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from watching import Message, Viewer, watched

import troupe
from sim.view.frames import CARDS
from tests.processes import ROOT

PAGE = (ROOT / "docs" / "viewing.md").read_text()


def copied(folder: Path) -> Path:
    """The example's files in a folder of one's own; the world."""
    return Path(shutil.copytree(ROOT / "docs" / "viewing", folder / "viewing")) / "hall.yaml"


def printed(moment: Message) -> str:
    """What the controller has printed last, as the page quotes it."""
    output = moment.json(CARDS)["0"]["output"]
    found = re.search(r"left .* m, right .* m", output[-1] if output else "")
    return f"`{found[0]}`" if found else "nothing yet"


def test_the_card_shows_what_the_page_says(tmp_path: Path) -> None:
    with watched(copied(tmp_path), paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="select", robots=[0])
        viewer.ask(do="step", ticks=76)
        found = viewer.until(lambda m: m.tick == 76 and CARDS in m.sections)
        if printed(found) not in PAGE:  # it prints after it has told what to do: it may still come
            viewer.until(lambda m: CARDS in m.sections and printed(m) in PAGE)
    card, (fan,) = found.json(CARDS)["0"], found.fans
    nearest = int(fan.ranges.argmin())
    bearing = -90 + nearest  # a ray for each degree, from the right
    assert f"nearest {fan.ranges[nearest]:.2f} m at {bearing:.1f}°" in PAGE
    assert bearing < 0  # the pillar is on the right
    kind, twist = card["command"]
    assert f"`{kind} {', '.join(f'{part:.2f}' for part in twist)}`" in PAGE
    assert twist[2] < 0  # and there it turns


def test_the_robot_keeps_clear_once_the_fault_is_mended(tmp_path: Path) -> None:
    world = copied(tmp_path)
    assert troupe.run(world, duration=20.0).robot("anna").stalls > 0
    program = world.with_name("keep_clear.py")
    left, right = "laser.ranges[:90].min()", "laser.ranges[91:].min()"
    text = program.read_text()
    assert f"{left}, {right}" in text
    program.write_text(text.replace(f"{left}, {right}", f"{right}, {left}"))
    mended = troupe.run(world, duration=60.0).robot("anna")
    assert (mended.stalls, mended.contacts) == (0, 0)
    assert mended.distance > 15.0
