"""A sweep's folder holds whole records or none, whatever has happened to it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from troupe.sweep import folder as rooms
from troupe.sweep.lines import line_of, read_line
from troupe.usage import UsageError


def record(seed: int, outcome: str = "completed", tries: int = 1) -> dict[str, Any]:
    return {"name": f"0123456789abcdef-s{seed}", "outcome": outcome, "tries": tries, "text": "ä\n"}


def test_a_line_is_read_as_it_was_written() -> None:
    line = read_line(line_of(record(3)))
    assert line is not None
    assert line.record == record(3)


@given(st.data())
def test_a_line_that_was_cut_or_changed_is_none(data: st.DataObject) -> None:
    whole = line_of(record(3))
    assert read_line(whole[: data.draw(st.integers(0, len(whole) - 1))]) is None
    place = data.draw(st.integers(10, len(whole) - 1))
    other = data.draw(st.integers(0, 255).filter(lambda byte: byte != whole[place]))
    changed = whole[:place] + bytes([other]) + whole[place + 1 :]
    assert read_line(changed) is None


@pytest.mark.parametrize("batches", [False, True])
def test_what_was_put_is_there(tmp_path: Path, batches: bool) -> None:
    rooms.open_folder(tmp_path)
    keeper = rooms.Keeper(tmp_path, batches=batches)
    for seed in range(5):
        keeper.put(record(seed))
    keeper.close()
    assert set(rooms.done(tmp_path)) == {record(seed)["name"] for seed in range(5)}
    assert not list(tmp_path.rglob("*.tmp"))
    assert not list(tmp_path.rglob("*.part"))


def test_a_long_run_in_a_batch_does_not_wait_for_the_next_one(tmp_path: Path) -> None:
    rooms.open_folder(tmp_path)
    keeper = rooms.Keeper(tmp_path, batches=True)
    keeper.sync()
    keeper.put({**record(0), "seconds": 2.5})
    assert record(0)["name"] in rooms.done(tmp_path)
    keeper.close()


@given(cut=st.integers(0, 2000))
def test_of_a_batch_that_was_cut_every_whole_line_counts(
    tmp_path_factory: pytest.TempPathFactory, cut: int
) -> None:
    place = tmp_path_factory.mktemp("cut")
    rooms.open_folder(place)
    keeper = rooms.Keeper(place, batches=True)
    for seed in range(5):
        keeper.put(record(seed))
    keeper.sync()
    data = keeper.path.read_bytes()[:cut]
    keeper.path.write_bytes(data)
    assert len(rooms.done(place)) == data.count(b"\n")


def test_a_batch_is_sealed_when_it_is_long(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rooms, "SEALED_AFTER", 2)
    rooms.open_folder(tmp_path)
    keeper = rooms.Keeper(tmp_path, batches=True)
    for seed in range(5):
        keeper.put(record(seed))
    assert len(list(tmp_path.glob("batches/*.jsonl"))) == 2
    assert len(list(tmp_path.glob("batches/*.part"))) == 1


def test_a_run_that_was_completed_counts_before_one_that_failed(tmp_path: Path) -> None:
    rooms.open_folder(tmp_path)
    keeper = rooms.Keeper(tmp_path, batches=True)
    for outcome, tries in (("crashed", 1), ("completed", 2), ("timeout", 3)):
        keeper.put(record(1, outcome, tries))
    keeper.close()
    name = record(1)["name"]
    assert rooms.done(tmp_path)[name] == ("completed", 2)
    assert rooms.records([tmp_path])[name].outcome == "completed"


def test_a_record_under_another_name_is_none(tmp_path: Path) -> None:
    rooms.open_folder(tmp_path)
    place = tmp_path / "runs" / record(2)["name"]
    place.mkdir(parents=True)
    (place / "result.json").write_bytes(line_of(record(1)))
    assert rooms.done(tmp_path) == {}


def test_a_folder_with_something_else_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("")
    with pytest.raises(UsageError, match="something else"):
        rooms.open_folder(tmp_path)
    for one in (tmp_path, tmp_path / "thesis.tex"):
        with pytest.raises(UsageError, match="not the folder of a sweep"):
            rooms.check_folder(one)


def test_what_a_dead_process_left_is_swept_up(tmp_path: Path) -> None:
    rooms.open_folder(tmp_path)
    node = rooms.platform.node()
    dead = tmp_path / f"manifest.json.{node}-{2**22 + 1}.tmp"
    ours = tmp_path / f"manifest.json.{node}-{rooms.os.getpid()}.tmp"
    for path in (dead, ours):
        path.write_text("half")
    rooms.sweep_up(tmp_path)
    assert (dead.exists(), ours.exists()) == (False, True)
