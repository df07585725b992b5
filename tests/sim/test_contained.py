"""A controller that fails in whatever way is named, and harms nobody else."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import psutil
import pytest

import troupe
from sim.build import load
from sim.engine import Engine, Settings
from sim.fleet.driver import Driver
from sim.fleet.patience import Patience
from sim.run import run_world
from tests.processes import environment

World = Callable[..., Path]

READS = """
from player import LaserProxy, PlayerClient, Position2dProxy
"""


def test_an_exception_is_reported_with_its_traceback_and_the_others_go_on(
    world_with: World,
) -> None:
    path = world_with(
        READS
        + """
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        base.set_speed(0.3)
        if robot.time > 0.95:
            raise RuntimeError("the wheel came off")
"""
    )
    result = troupe.run(path)
    one, two = result.robot("one"), result.robot("two")
    assert result.outcome == "controller_failed"
    assert result.exit_code == 1
    assert (one.state, one.exit_code) == ("failed", 1)
    assert one.error is not None
    assert "RuntimeError: the wheel came off" in one.error
    assert 'mine.py", line' in one.error
    assert "sim/fleet" not in one.error
    assert two.state == "running"
    assert result.sim_time == pytest.approx(3.0)
    assert one.distance < 0.6  # it stopped when nobody drove it any more
    assert two.distance > 0.5


@pytest.mark.parametrize(
    ("program", "code", "says"),
    [
        ("import os; os._exit(7)", 7, "exit code 7"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", -11, "signal 11"),
        ("import sys; sys.exit('no map')", 1, "no map"),
        ("import not_there", 1, "No module named 'not_there'"),
        ("exec('def broken(:')", 1, "SyntaxError"),
    ],
)
def test_a_program_that_dies_before_its_first_request_has_failed(
    world_with: World, program: str, code: int, says: str
) -> None:
    result = troupe.run(world_with(program, duration=0.5))
    one = result.robot("one")
    assert (one.state, one.exit_code) == ("failed", code)
    assert says in (one.error or "")
    assert result.robot("two").state == "running"


def test_an_early_end_with_exit_code_0_is_a_finished_controller(world_with: World) -> None:
    path = world_with(
        READS
        + """
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    for _ in range(5):
        robot.read()
        base.set_speed(0.3)
"""
    )
    result = troupe.run(path)
    one = result.robot("one")
    assert (one.state, one.exit_code, one.error) == ("finished", 0, None)
    assert result.outcome == "completed"


@dataclass(frozen=True)
class PatienceWithOne(Patience):
    """Patience that ends with the robot `one` alone: on a busy machine the other is slow too."""

    def limit(self, driver: Driver) -> float:
        return super().limit(driver) if driver.record.name == "one" else math.inf


def test_an_endless_loop_is_a_hung_controller(world_with: World) -> None:
    path = world_with(
        READS
        + """
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        if robot.time > 0.5:
            while True:
                pass
"""
    )
    lines: list[str] = []

    def lose_patience(engine: Engine) -> None:
        engine.crew.patience = PatienceWithOne(0.5)

    loaded = load(path)
    result = run_world(
        loaded,
        Settings(loaded.world.seed, loaded.world.duration),
        each_tick=lose_patience,
        say=lines.append,
    )
    assert result.robot("one").state == "hung"
    assert result.robot("two").state == "running"
    assert result.outcome == "controller_failed"
    assert result.sim_time == pytest.approx(3.0)
    assert any(line.startswith("one: hung") for line in lines)


def test_a_child_that_a_controller_forks_does_not_outlive_it(
    world_with: World, tmp_path: Path
) -> None:
    path = world_with(
        READS
        + f"""
import os, time
robot = PlayerClient()
if os.fork() == 0:
    if os.fork() == 0:
        os.setsid()
    open({str(tmp_path)!r} + f"/pid{{os.getpid()}}", "w").close()
    while True:
        time.sleep(1)
while len([n for n in os.listdir({str(tmp_path)!r}) if n.startswith("pid")]) < 2:
    time.sleep(0.01)
base = Position2dProxy(robot)
robot.read()
"""
    )
    result = troupe.run(path, duration=1.0)
    assert result.robot("one").state == "finished"
    pids = [int(file.name[3:]) for file in tmp_path.glob("pid*")]
    assert len(pids) == 2
    alive = [p for p in pids if psutil.pid_exists(p)]
    assert [p for p in alive if psutil.Process(p).status() != psutil.STATUS_ZOMBIE] == []


def test_a_flood_of_output_is_read_cut_and_kept_at_its_end(world_with: World) -> None:
    path = world_with(
        READS
        + """
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        for i in range(20000):
            print("x" * 50, i)
        print("z" * 100_000)
        if robot.time > 0.25:
            raise SystemExit("drowned")
"""
    )
    lines: list[str] = []
    result = troupe.run(path, duration=1.0, say=lines.append)
    one = result.robot("one")
    assert one.state == "failed"
    assert (one.error or "").endswith("drowned")
    assert len(one.error or "") < 200_000
    shown = [line for line in lines if line.startswith("[one]")]
    assert 1000 < len(shown) < 5000
    assert "not shown" in shown[-1]


def test_output_appears_under_the_robots_name(world_with: World) -> None:
    path = world_with("print('hello'); import sys; print('world', file=sys.stderr)")
    lines: list[str] = []
    troupe.run(path, duration=0.2, say=lines.append)
    assert "[one] hello" in lines
    assert "[one] world" in lines


def test_a_controller_killed_from_outside_has_failed(world_with: World) -> None:
    path = world_with(
        READS
        + """
import os, signal
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        if robot.time > 0.5:
            os.kill(os.getpid(), signal.SIGKILL)
"""
    )
    result = troupe.run(path)
    assert (result.robot("one").state, result.robot("one").exit_code) == ("failed", -9)


def test_a_folder_with_names_like_ours_gets_in_nobodys_way(
    world_with: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sensors.py").write_text("WHOSE = 'theirs'")
    (tmp_path / "controllers").mkdir()
    (tmp_path / "controllers" / "__init__.py").write_text("")
    (tmp_path / "controllers" / "tools.py").write_text("SPEED = 0.25")
    path = world_with(
        READS
        + """
import sensors
from controllers.tools import SPEED
assert sensors.WHOSE == "theirs"
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        base.set_speed(SPEED)
"""
    )
    monkeypatch.chdir(tmp_path)
    result = troupe.run(path, duration=2.0)
    assert result.outcome == "completed"
    assert result.robot("one").distance > 0.3
    assert result.robot("two").distance > 0.3


def test_a_controller_that_floods_requests_is_answered_and_holds_nobody_up(
    world_with: World,
) -> None:
    path = world_with(
        READS
        + """
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    laser = LaserProxy(robot)
    while robot.read():
        for _ in range(200):
            assert base.request_geometry().size[0] == 1.0
"""
    )
    result = troupe.run(path, duration=1.0)
    assert result.outcome == "completed", result.robot("one").error


def test_a_notebook_beside_names_like_ours_still_gets_ours(tmp_path: Path) -> None:
    (tmp_path / "sensors.py").write_text("raise RuntimeError('not Troupe')")
    (tmp_path / "controllers").mkdir()
    (tmp_path / "controllers" / "__init__.py").write_text("raise RuntimeError('not Troupe')")
    (tmp_path / "notebook.py").write_text(
        "import troupe\nprint(troupe.run('wander', duration=0.5).outcome)\n"
    )
    done = subprocess.run(
        [sys.executable, "notebook.py"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "completed\n", done.stderr
