"""A world that holds is loaded whole; whatever a file says, nothing but a WorldError comes out."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from world_texts import HEAD

from sim.build import load
from sim.worldfile import Mistake, World, WorldError

EVERYTHING = """\
name: Paint, case I
size: [16, 21]
seed: 1
duration: 900
until: controllers
clock: {interval: 0.1, physics_step: 0.02}
boundary: {color: red, thickness: 0.2, height: 1.0, shape: region}
region: [[2, 1], [14, 1], [16, 12], [8, 20]]
floor: {resolution: 0.05}
obstacles:
  - {shape: box, size: [1, 1], pose: [6, 9, 0], color: red, height: 1, movable: false, mass: 5}
models:
  painter:
    body: {shape: box, size: [1, 1], height: 1.0, color: green, mass: 10, friction: 0.5}
    drive: {kind: differential, max_speed: 0.5, max_turn_rate: 90, max_acceleration: 2,
            max_turn_acceleration: 360, max_force: 100, max_torque: 20}
    localization: odometry
    odometry_noise: {slip: 0.02, turn: 0.02}
    simulation: report
    fiducial: 7
    sensors:
      - {type: laser, pose: [0, 0, 0], range: 20, fov: 180, samples: 180, noise: 0.01}
      - {type: blobfinder, range: 20, fov: 180, image: [160, 120], colors: [red, green]}
    actuators:
      - {type: sprayer, size: [1.0, 1.0], offset: [0, 0]}
robots:
  - {name: r1, model: painter, pose: [4, 4, 0], controller: mine}
  - {model: painter, count: 3, placement: random, headings: [0, 180], controller: wander}
  - {model: painter, count: 2, placement: {same_y: true, margin: 1}, controller: null}
doors:
  - {name: s, at: [12, 4], model: painter, heading: 90, period: 4.0, controller: mine}
controllers:
  mine: {program: wander, args: {speed: 0.4}}
  cpp: {command: [sh, "-c", "{port}"]}
  hand: {external: true}
player: {host: 127.0.0.1, port: 6665, layout: per_robot, clock: all}
"""

ALLOWED = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "world.yaml"


def test_every_key_has_its_value(path: Path) -> None:
    path.write_text(EVERYTHING)
    loaded = load(path)
    world = loaded.world
    assert (world.name, world.size, world.duration) == ("Paint, case I", (16, 21), 900)
    assert world.boundary is not None
    assert (world.boundary.color, world.boundary.shape) == (0xFF0000, "region")
    painter = world.models["painter"]
    assert painter.body.color == 0x00FF00
    assert painter.odometry_noise is not None
    assert painter.odometry_noise.turn == 0.02
    assert [sensor.range for sensor in painter.sensors] == [20, 20]
    assert world.doors[0].at == (12, 4)
    assert world.controllers["mine"].args == {"speed": 0.4}
    assert world.player.port == 6665
    assert len(loaded.robots) == 6
    assert loaded.start.shape == (6, 3)
    assert loaded.folder == path.parent


def test_what_is_not_said_has_its_default(path: Path) -> None:
    path.write_text("size: [16, 21]\n")
    world = load(path).world
    assert world == World(size=(16.0, 21.0))
    assert (world.seed, world.duration, world.until) == (1, 600, "controllers")
    assert (world.clock.interval, world.clock.physics_step) == (0.1, 0.02)
    assert world.boundary is not None
    assert (world.boundary.color, world.boundary.thickness) == (0xFF0000, 0.2)
    assert world.player.port is None


def test_values_never_change(path: Path) -> None:
    path.write_text("size: [16, 21]\n")
    world = load(path).world
    with pytest.raises(ValueError, match="frozen"):
        world.seed = 2  # type: ignore[misc]


@pytest.mark.parametrize(
    ("interval", "step"), [(0.1, 0.02), (0.05, 0.05 / 3), (0.01, 0.01), (1, 0.02), (0.02, 0.02)]
)
def test_the_step_of_physics_divides_the_interval_unless_told(
    path: Path, interval: float, step: float
) -> None:
    path.write_text(f"size: [16, 21]\nclock: {{interval: {interval}}}\n")
    assert load(path).world.clock.physics_step == pytest.approx(step, rel=1e-12)


def test_a_world_of_a_map_has_its_size(path: Path) -> None:
    (path.parent / "maze.txt").write_text("#####\n#...#\n#S#.#\n#####\n")
    path.write_text(
        "map: {file: maze.txt, cell: 1.5}\nmodels: {a: {body: {shape: circle, radius: 0.5}}}\n"
        "doors: [{name: s, at: S, model: a, period: 4}]\n"
    )
    loaded = load(path)
    assert loaded.layout.size == (7.5, 6)
    assert loaded.layout.doors[0].centre == (2.25, 2.25)


def test_a_sensor_file_of_ones_own_is_checked_with_its_settings(path: Path) -> None:
    (path.parent / "mine.py").write_text(
        "from sensors.readings import Scans\n"
        "from sensors.registry import sensor\n"
        "from sensors.settings import SensorSettings, setting, Number\n"
        "class Settings(SensorSettings):\n"
        "    depth: Number = setting(1.0, gt=0, unit='m', description='how deep')\n"
        "@sensor('mine', kind='scan', settings=Settings,\n"
        "        readings=lambda s, n: Scans.empty(n, 2, 1, 1))\n"
        "def sense(settings, view, readings):\n    '''Nothing.'''\n"
    )
    path.write_text(HEAD + "    sensors: [{type: ./mine.py, depth: 2}]\n")
    assert load(path).world.models["rover"].sensors[0].depth == 2
    path.write_text(HEAD + "    sensors: [{type: ./mine.py, depht: 2, depth: -1}]\n")
    with pytest.raises(WorldError) as raised:
        load(path)
    assert [str(one).removeprefix(f"{path}:")[:60] for one in raised.value.mistakes] == [
        "5:33: models.rover.sensors.0.depht: unknown key; did you mea",
        "5:50: models.rover.sensors.0.depth: is out of range (given: ",
    ]


def places(data: Any, where: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Every path in plain data."""
    if not isinstance(data, dict | list):
        return [where]
    keys = list(data) if isinstance(data, dict) else range(len(data))
    return [where, *(path for key in keys for path in places(data[key], (*where, key)))]


def mistakes_if_any(path: Path, *given: str) -> list[Mistake]:
    try:
        load(path, settings=given)
    except WorldError as error:
        return error.mistakes or [Mistake((), "an error without a mistake")]
    return []


def changed(data: Any, where: tuple[Any, ...], odd: Any, removed: bool) -> None:
    """Puts something odd at a place, or takes away what is there, if there is such a place."""
    for key in where[:-1]:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            return
    key = where[-1]
    if isinstance(data, dict) and removed:
        data.pop(key, None)
    elif isinstance(data, dict) or (isinstance(data, list) and key in range(len(data))):
        data[key] = odd


DATA = yaml.safe_load(EVERYTHING)
ODD: st.SearchStrategy[Any] = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.sampled_from(
        ["box", "polygon", "laser", "car", "random", "S", "red", "painter", "a.py", ""]
    )
    | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(
                ["shape", "size", "type", "body", "box", "args", "pose", "zzz", "[key]"]
            ),
            inner,
            max_size=4,
        )
    ),
    max_leaves=8,
)


@settings(
    max_examples=60,
    suppress_health_check=ALLOWED,
)
@given(
    st.lists(
        st.tuples(st.sampled_from(places(DATA)[1:]), ODD, st.booleans()), min_size=1, max_size=3
    )
)
def test_whatever_stands_where_it_should_not_every_mistake_has_its_place(
    path: Path, changes: list[tuple[tuple[Any, ...], Any, bool]]
) -> None:
    data = copy.deepcopy(DATA)
    for where, odd, removed in changes:
        changed(data, where, odd, removed)
    path.write_text(yaml.safe_dump(data, allow_unicode=True), encoding="utf-8")
    for mistake in mistakes_if_any(path):
        assert str(mistake).startswith(f"{path}:"), mistake
        assert mistake.line is not None or "not YAML" in mistake.what


@settings(
    max_examples=50,
    suppress_health_check=ALLOWED,
)
@given(
    st.binary(max_size=60)
    | st.text(alphabet="[]{}:,-&*!|>'\"%@#\n\t ab1?<~", max_size=60).map(str.encode)
)
def test_whatever_bytes_a_file_holds_only_a_world_error_comes_out(
    path: Path, content: bytes
) -> None:
    path.write_bytes(content)
    with pytest.raises(WorldError):
        load(path)  # no such short file has a size


@settings(
    max_examples=50,
    suppress_health_check=ALLOWED,
)
@given(st.text(alphabet="abmodels.=0123456789[]{}: \n-", max_size=30))
def test_whatever_a_setting_says_only_a_world_error_comes_out(path: Path, setting: str) -> None:
    path.write_text(EVERYTHING)
    for mistake in mistakes_if_any(path, setting):
        assert str(mistake).startswith((f"{path}:", "--set")), mistake
