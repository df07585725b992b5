"""Settings from the command line are laid upon the file and checked like it."""

from __future__ import annotations

from pathlib import Path

import pytest
from world_texts import HEAD

from sim.build import load
from sim.worldfile import World, WorldError

WORLD = HEAD + "robots:\n  - {model: rover, pose: [5, 4, 0]}\n  - {model: rover, pose: [2, 4, 0]}\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "world.yaml"
    path.write_text(WORLD)
    return path


def with_settings(path: Path, *settings: str) -> World:
    return load(path, settings=settings).world


def test_a_dotted_path_leads_to_a_value_and_an_index_into_a_list(path: Path) -> None:
    world = with_settings(path, "models.rover.body.radius=0.5", "robots.1.pose.2=90", "size.0=20")
    assert world.models["rover"].body.radius == 0.5  # type: ignore[union-attr]
    assert [one.pose for one in world.robots] == [(5, 4, 0), (2, 4, 90)]
    assert world.size == (20, 8)


def test_what_is_not_there_yet_is_made(path: Path) -> None:
    world = with_settings(path, "models.rover.drive.max_speed=0.3", "clock.interval=0.05")
    drive = world.models["rover"].drive
    assert drive is not None
    assert drive.max_speed == 0.3
    assert world.clock.interval == 0.05
    assert world.clock.physics_step == pytest.approx(0.05 / 3)


def test_the_value_is_yaml(path: Path) -> None:
    world = with_settings(path, "size=[30, 20]", "boundary=null", "name='5'", "duration=1e3",
                          "clock={interval: 0.2}")  # fmt: skip
    assert (world.size, world.boundary, world.name) == ((30, 20), None, "5")
    assert (world.duration, world.clock.interval) == (1000, 0.2)


def test_an_equals_sign_in_the_value_stays(path: Path) -> None:
    assert with_settings(path, "name=a=b").name == "a=b"


def test_later_settings_stand_above_earlier_ones(path: Path) -> None:
    assert with_settings(path, "seed=3", "seed=4").seed == 4


def test_a_null_on_the_way_becomes_a_mapping(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text("size: [1, 1]\nboundary: null\n")
    world = with_settings(path, "boundary.color=blue")
    assert world.boundary is not None
    assert world.boundary.color == 0x0000FF


def test_a_value_that_an_alias_shares_changes_in_the_named_place_alone(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(
        "size: [9, 9]\nmodels:\n  a: {body: &b {shape: circle, radius: 1}}\n  c: {body: *b}\n"
    )
    world = with_settings(path, "models.c.body.radius=2")
    assert [model.body.radius for model in world.models.values()] == [1, 2]  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        ("duration", "--set: is no setting (given: duration; allowed: KEY=VALUE, such as"),
        ("=3", "--set: is no setting (given: =3;"),
        ("a..b=3", "--set: is no setting (given: a..b=3;"),
        (
            "robots.2.pose=[1, 1, 0]",
            "--set robots.2.pose=[1, 1, 0]: robots: has no such place (giv",
        ),
        (
            "robots.x=1",
            "--set robots.x=1: robots: has no such place (given: x; allowed: a number fr",
        ),
        ("robots.-1.count=1", "--set robots.-1.count=1: robots: has no such place (given: -1; al"),
        ("size.0.x=1", "--set size.0.x=1: size.0: is a single value, so it has no `x`"),
        ("obstacles.0.pose=1", "--set obstacles.0.pose=1: obstacles: is no list in the file"),
        ("include=a.yaml", "--set include=a.yaml: include: cannot be set; write it into a file"),
        ("name=[1", "--set name=[1: not YAML: "),
        ("name=!!int 3", "--set name=!!int 3: tags have no meaning here"),
        ("duraton=3", "--set duraton=3: duraton: unknown key; did you mean duration?"),
        ("duration=x", "--set duration=x: duration: must be a number (given: x)"),
        ("clock={interval: x}", "--set clock={interval: x}: clock.interval: must be a number (gi"),
        ("robots.0.model=rver", "--set robots.0.model=rver: robots.0.model: there is no such mode"),
        ("robots.1.pose.0=5", "--set robots.1.pose.0=5: "),
    ],
)
def test_a_mistake_in_a_setting_names_the_setting(path: Path, setting: str, told: str) -> None:
    with pytest.raises(WorldError) as raised:
        load(path, settings=[setting])
    (found,) = raised.value.mistakes
    if setting.startswith("robots.1"):  # the pose as a whole still stands in the file
        assert "the robot starts in robot rover1" in str(found)
    else:
        assert str(found).startswith(told)


def test_all_mistakes_of_file_and_settings_are_told_at_once(path: Path) -> None:
    path.write_text(WORLD + "duraton: 3\n")
    with pytest.raises(WorldError) as raised:
        load(path, settings=["seed=x", "zzz", "clock.interval=0"])
    assert [str(one).split(": ")[0] for one in raised.value.mistakes] == [
        f"{path}:8:1", "--set", "--set seed=x", "--set clock.interval=0",
    ]  # fmt: skip


def test_a_file_from_the_command_line_is_looked_for_beside_the_world_then_here(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path.write_text("map: {file: gone.txt, cell: 1}\n")
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    (here / "m.txt").write_text("....\n")
    (here / "n.txt").write_text(".....\n")
    (tmp_path / "n.txt").write_text("......\n")
    assert load(path, settings=["map.file=m.txt"]).layout.size == (4, 1)
    assert load(path, settings=["map.file=n.txt"]).layout.size == (6, 1)
    assert load(path, settings=[f"map.file={here / 'n.txt'}"]).layout.size == (5, 1)
