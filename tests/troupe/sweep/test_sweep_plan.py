"""The name of a run follows from all that its result depends on, and from nothing else."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from sim.worldfile import WorldError
from troupe.sweep.plan import Plan, load_point, make_plan, plan_of_json
from troupe.sweep.spec import Combination
from troupe.usage import UsageError

PROGRAM = "import helper\nfrom player import PlayerClient\nPlayerClient()\n"


@pytest.fixture
def world(world_with: Callable[..., Path], tmp_path: Path) -> Path:
    (tmp_path / "helper.py").write_text("speed = 1\n")
    return world_with(PROGRAM)


def hash_of(world: Path, *settings: str, duration: float | None = None) -> str:
    return load_point(world, settings, duration)[1].hash


def test_another_place_is_the_same_world(
    world: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    there = tmp_path_factory.mktemp("there")
    for path in world.parent.iterdir():
        shutil.copy(path, there)
    assert hash_of(there / "world.yaml") == hash_of(world)


def test_what_is_written_around_values_does_not_matter(world: Path) -> None:
    before = hash_of(world)
    world.write_text("# a remark\n" + world.read_text() + "seed: 12\nname: another\n")
    assert hash_of(world) == before


@pytest.mark.parametrize("name", ["mine.py", "helper.py"])
def test_another_program_or_module_of_it_makes_other_runs(world: Path, name: str) -> None:
    before = hash_of(world)
    with (world.parent / name).open("a") as file:
        file.write("speed = 2\n")
    assert hash_of(world) != before


def test_a_program_that_drives_nobody_does_not_matter(world: Path) -> None:
    (world.parent / "third.py").write_text("speed = 1\n")
    before = hash_of(world)
    both = ("controllers.third.program=./third.py",)
    assert hash_of(world, *both) == before
    other = hash_of(world, *both, "robots.0.controller=third")
    (world.parent / "third.py").write_text("speed = 2\n")
    assert hash_of(world, *both) == before
    assert hash_of(world, *both, "robots.0.controller=third") != other


def test_settings_and_duration_make_other_runs(world: Path) -> None:
    hashes = [hash_of(world), hash_of(world, "clock.interval=0.05"), hash_of(world, duration=1.0)]
    assert len(set(hashes)) == 3
    assert hash_of(world, "duration=1") == hash_of(world, duration=1.0)


def test_an_included_file_and_a_map_are_part_of_a_world(tmp_path: Path) -> None:
    (tmp_path / "map.txt").write_text("####\n#..#\n####\n")
    (tmp_path / "below.yaml").write_text("map: {file: map.txt, cell: 1}\n")
    (tmp_path / "world.yaml").write_text("include: [below.yaml]\n")
    _, first, _ = load_point(tmp_path / "world.yaml", (), None)
    assert first.holds()
    (tmp_path / "map.txt").write_text("#####\n#...#\n#####\n")
    assert not first.holds()
    second = hash_of(tmp_path / "world.yaml")
    (tmp_path / "below.yaml").write_text("map: {file: map.txt, cell: 2}\n")
    assert len({first.hash, second, hash_of(tmp_path / "world.yaml")}) == 3


def plan_of(*asked: Combination) -> Plan:
    return make_plan(asked, None, {})


def test_all_mistakes_of_all_combinations_are_told_once(world: Path) -> None:
    key = "models.rover.body.size"
    asked = [
        Combination(str(world), {key: value, "foo": foo}, (1,))
        for value in ([1, 1], [-1, 1], "x")
        for foo in (1, 2)
    ]
    with pytest.raises(UsageError) as found:
        plan_of(*asked, Combination("wandr", {}, (1,)))
    lines = str(found.value).splitlines()
    assert len(lines) == len({line.partition(" [in ")[0] for line in lines})
    assert sum("foo: unknown key" in line for line in lines) == 1
    assert any("[in 6 of 7 combinations" in line for line in lines)
    assert any("did you mean wander?" in line for line in lines)
    assert any("given: -1" in line for line in lines)


def test_nobody_connects_by_hand_to_a_sweep(world: Path) -> None:
    with pytest.raises(WorldError, match="by hand"):
        load_point(world, ["controllers.mine={external: true}"], None)


def test_combinations_of_one_effect_are_one(world: Path) -> None:
    plan = plan_of(
        Combination(str(world), {}, (1, 2)), Combination(str(world), {"name": "x"}, (2, 3))
    )
    assert [run.seed for run in plan.runs()] == [1, 2, 3]


def test_shards_are_all_runs_each_once(world: Path) -> None:
    plan = plan_of(Combination(str(world), {}, tuple(range(10))))
    parts = [[run.name for run in plan.runs((i, 3))] for i in (1, 2, 3)]
    assert sorted(name for part in parts for name in part) == sorted(
        run.name for run in plan.runs()
    )
    assert {len(part) for part in parts} == {3, 4}


def test_a_plan_is_kept_as_it_is(world: Path) -> None:
    plan = plan_of(Combination(str(world), {"clock.interval": 0.05}, (1, 2, 9)))
    kept = plan_of_json(plan.as_json())
    assert (kept, kept.name) == (plan, plan.name)
