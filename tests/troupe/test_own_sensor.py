"""From a sensor's own file to a controller that reads it, as docs/sensors.md shows it."""

from __future__ import annotations

import json
import math
import re
import subprocess
from pathlib import Path

import pytest

import troupe
from player import PlayerClient, Position2dProxy
from tests.processes import environment, troupe_command
from tests.troupe.own_sensor import example

BOX = (9.0, 4.0)  # where the obstacle that smells stands, in the page's world
REACH = 2.0  # and how far its smell goes there
FLOAT32 = 1e-6  # relative: half of the last bit of a float32 is 6e-8


@pytest.fixture
def world(tmp_path: Path) -> Path:
    for name in ("nose.py", "hound.yaml", "follow.py"):
        (tmp_path / name).write_text(example(name))
    return tmp_path / "hound.yaml"


def test_the_pages_controller_reads_the_pages_sensor(world: Path) -> None:
    result = troupe.run(world)
    hound = result.robot("hound")
    assert result.outcome == "completed", hound.error
    smell = hound.properties["smell"]
    step = 0.5 * 0.1  # metres between two readings: the first above the threshold is told
    assert 0.3 <= smell < 0.3 * math.exp(step / REACH) * (1 + FLOAT32)


def test_what_the_controller_reads_is_what_the_sensor_has_measured(world: Path) -> None:
    (world.parent / "follow.py").write_text(
        "from player import AioProxy, PlayerClient, SimulationProxy\n"
        "with PlayerClient() as robot:\n"
        "    nose, simulation = AioProxy(robot), SimulationProxy(robot)\n"
        "    assert robot.read()\n"
        "    assert nose.count == 1\n"
        "    simulation.report('smell', nose.values[0])\n"
    )
    hound = troupe.run(world).robot("hound")
    assert hound.error is None
    truth = math.exp(-math.dist((2, 4), BOX) / REACH)
    assert hound.properties["smell"] == pytest.approx(truth, rel=FLOAT32)


def test_a_terminal_shows_it_too(world: Path) -> None:
    world.write_text(world.read_text().replace("{program: ./follow.py}", "{external: true}"))
    run = subprocess.Popen(
        troupe_command("run", str(world), "--listen", "127.0.0.1:0", "--duration", "100000"),
        env=environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert run.stderr is not None
        port = next(m[1] for li in run.stderr if (m := re.search(r"127\.0\.0\.1:(\d+)", li)))
        with PlayerClient("127.0.0.1", int(port), mode="push", timeout=None, environ={}) as hand:
            Position2dProxy(hand)  # in push mode: it keeps the run going, and nobody waiting
            done = subprocess.run(
                troupe_command("print", f"127.0.0.1:{port}", "aio:0", "--count", "1", "--json"),
                env=environment(), capture_output=True, text=True, timeout=600, check=False,
            )  # fmt: skip
    finally:
        run.kill()
        run.communicate()
    assert done.returncode == 0, done.stderr
    entry = json.loads(done.stdout)
    assert (entry["device"], entry["message"]) == ("aio:0", "state")
    truth = math.exp(-math.dist((2, 4), BOX) / REACH)
    assert entry["voltages"] == [pytest.approx(truth, rel=FLOAT32)]
