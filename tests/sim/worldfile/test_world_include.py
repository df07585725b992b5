"""Files that include others: what is merged, what is replaced, and where their mistakes are."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from world_texts import HEAD, mistakes_of

from sim.build import load


def write(folder: Path, **texts: str) -> Path:
    """Writes files NAME.yaml; returns `world.yaml`."""
    for name, text in texts.items():
        path = folder / f"{name.replace('__', '/')}.yaml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return folder / "world.yaml"


def test_mappings_merge_and_lists_and_scalars_are_replaced(tmp_path: Path) -> None:
    world = load(
        write(
            tmp_path,
            base=HEAD
            + "    drive: {max_speed: 1, max_turn_rate: 10}\n    sensors: [{type: laser}]\n"
            "duration: 5\nrobots: [{model: rover, placement: random, count: 3}]\n",
            world="include: [base.yaml]\nduration: 7\nrobots: []\n"
            "models: {rover: {drive: {max_speed: 2}}, other: {body: {shape: circle, radius: 1}}}\n",
        )
    ).world
    assert world.duration == 7
    assert world.robots == ()
    assert list(world.models) == ["rover", "other"]
    drive = world.models["rover"].drive
    assert drive is not None
    assert (drive.max_speed, drive.max_turn_rate) == (2, 10)
    assert len(world.models["rover"].sensors) == 1


def test_later_files_stand_above_earlier_ones_and_the_world_above_all(tmp_path: Path) -> None:
    world = load(
        write(
            tmp_path,
            a="size: [1, 1]\nseed: 1\nduration: 1\nname: a",
            b="include: c.yaml\nseed: 2\nduration: 2",
            c="seed: 3\nuntil: duration\nduration: 3",
            world="include: [a.yaml, b.yaml]\nduration: 4",
        )
    ).world
    assert (world.name, world.seed, world.until, world.duration) == ("a", 2, "duration", 4)


def test_a_null_replaces_a_mapping(tmp_path: Path) -> None:
    path = write(
        tmp_path, a="size: [1, 1]\nboundary: {color: blue}", world="include: a.yaml\nboundary: null"
    )
    assert load(path).world.boundary is None


def test_a_mistake_points_into_the_file_that_has_it(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        sub__base="size: [1, 1]\nclock: {interval: 0}\nseed: x\n",
        world="include: [sub/base.yaml]\nseed: 3\nclock: {physics_stp: 1}\n",
    )
    assert mistakes_of(path) == [
        "3:9: clock.physics_stp: unknown key; did you mean physics_step? "
        "(allowed: interval, physics_step)",
        f"{tmp_path}/sub/base.yaml:2:19: clock.interval: is out of range "
        "(given: 0; allowed: above 0)",
    ]


@pytest.mark.parametrize(
    ("texts", "names"),
    [
        ({"world": "include: [world.yaml]"}, "world.yaml -> world.yaml"),
        (
            {"world": "include: [a.yaml]", "a": "include: b.yaml", "b": "include: [world.yaml]"},
            "world.yaml -> a.yaml -> b.yaml -> world.yaml",
        ),
        ({"world": "include: a.yaml", "a": "include: [./a.yaml]"}, "a.yaml -> a.yaml"),
    ],
)
def test_a_loop_is_told_by_its_names(tmp_path: Path, texts: dict[str, str], names: str) -> None:
    (found,) = mistakes_of(write(tmp_path, **texts))
    assert f"files include each other in a loop: {names} (given: " in found


def test_a_file_may_be_included_twice_on_different_ways(tmp_path: Path) -> None:
    path = write(
        tmp_path, a="size: [1, 1]", b="include: a.yaml", c="include: a.yaml",
        world="include: [b.yaml, c.yaml]",
    )  # fmt: skip
    assert load(path).world.size == (1, 1)


def test_includes_that_double_at_every_step_are_refused(tmp_path: Path) -> None:
    texts = {f"f{n}": f"include: [f{n + 1}.yaml, f{n + 1}.yaml]" for n in range(40)}
    path = write(tmp_path, **texts, f40="size: [1, 1]", world="include: f0.yaml")
    assert any("more than 200 files are included" in one for one in mistakes_of(path))


@pytest.mark.parametrize(
    ("include", "told"),
    [
        ("bse.yaml", "1:10: include: no such file; did you mean base.yaml? (given: bse.yaml)"),
        ("[base.yaml, zzz.yaml]", "1:22: include.1: no such file"),
        ("[no/base.yaml]", "1:11: include.0: no such file; there is no folder"),
        ("[3]", "1:11: include.0: must be a file's name"),
        ("{a: 1}", "1:10: include: must be a file's name"),
        ('"a\\0b"', "1:10: include: must be a file's name"),
        ("[.]", "1:11: include.0: is a folder, not a world file"),
    ],
)
def test_what_cannot_be_included(tmp_path: Path, include: str, told: str) -> None:
    path = write(tmp_path, base="size: [1, 1]", world=f"include: {include}\nsize: [1, 1]")
    (found,) = mistakes_of(path)
    assert found.startswith(told)


def test_beside_a_missing_include_what_stands_in_the_file_is_checked_all_the_same(
    tmp_path: Path,
) -> None:
    path = write(
        tmp_path,
        world="include: [gone.yaml]\nduraton: 3\nrobots: [{model: rover, pose: [1, x, 0]}]\n",
    )
    assert [one.split(": ")[1] for one in mistakes_of(path)] == [
        "include.0", "duraton", "robots.0.pose.1",
    ]  # fmt: skip


def test_names_of_files_start_at_the_file_that_they_are_written_in(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        lib__base="map: {file: m.txt, cell: 1}\ncontrollers: {a: {program: ./a.py}}\n",
        world="include: lib/base.yaml\ncontrollers: {b: {program: ./b.py}}\n",
    )
    (tmp_path / "lib" / "m.txt").write_text("#..#\n")
    (tmp_path / "lib" / "a.py").write_text("")
    (tmp_path / "b.py").write_text("")
    loaded = load(path)
    assert loaded.layout.size == (4, 1)
    programs = {name: one.program for name, one in loaded.world.controllers.items()}
    assert {name: (loaded.folder / str(one)).is_file() for name, one in programs.items()} == {
        "a": True,
        "b": True,
    }
    assert programs["b"] == "./b.py"


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "world.yaml:1:1: the file is empty"),
        (b"# nothing\n", "world.yaml:1:1: the file is empty"),
        (b"- 1\n", "world.yaml:1:1: a world file is a mapping (given: a list"),
        (b"hello\n", "world.yaml:1:1: a world file is a mapping (given: a single value"),
        (b"\x89PNG\r\n\x1a\n\0\0", "world.yaml: is a binary file, not a world file in YAML"),
        ("size: [1, 1]\nname: caf\xe9\n".encode("latin-1"), "world.yaml:2:10: is not UTF-8 text"),
        ("size: [1, 1]\n".encode("utf-16"), "world.yaml: is "),
    ],
)
def test_what_is_no_world_file_is_told_as_what_it_is(
    tmp_path: Path, content: bytes, told: str
) -> None:
    path = tmp_path / "world.yaml"
    path.write_bytes(content)
    found = [one.removeprefix(f"{tmp_path}/") for one in mistakes_of(path)]
    assert len(found) == 1
    assert (found[0] if "world.yaml" in found[0] else f"world.yaml:{found[0]}").startswith(told)


def test_a_file_with_a_byte_order_mark_and_windows_lines_is_read(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_bytes("\ufeffsize: [1, 1]\r\nname: ä\r\n".encode())
    assert load(path).world.name == "ä"


def test_a_missing_file_a_folder_and_an_endless_file_are_told(tmp_path: Path) -> None:
    assert mistakes_of(tmp_path / "world.yaml") == [" no such file"]
    assert "is a folder" in mistakes_of(tmp_path)[0]
    assert "is larger than" in mistakes_of(Path("/dev/zero"))[0]


def test_an_unreadable_file_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path, world="size: [1, 1]")

    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)  # root may read everything, so no mode will do
    assert mistakes_of(path) == [" cannot be read: Permission denied"]
