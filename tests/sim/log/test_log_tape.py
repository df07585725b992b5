"""A tape holds of each tick what the arrays held then."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sensors.readings import BLOB
from sim.log import commands
from sim.log.tape import (
    BLOB_SIZE,
    BLOBS,
    COVERAGE,
    LENGTH,
    NARROW,
    TELLING,
    TICK,
    TIME,
    TOLD,
    TOLD_AT,
    WATCH,
    Sheet,
    Source,
    Tape,
)
from sim.stage.records import HEADING, MOVER, POSITION


def nobody() -> tuple[NDArray[Any], NDArray[np.float64]]:
    return np.zeros(0, MOVER), commands.fresh(0)


def tape_of(sources: list[Source], rows: int = 3) -> Tape:
    sheet = Sheet([], sources, *nobody())
    room = rows * Tape(sheet, np.empty(0, np.uint8)).need()
    return Tape(sheet, np.zeros(room, np.uint8))


def rows_of(tape: Tape) -> list[NDArray[np.uint8]]:
    """The bytes of each row."""
    found, at = [], 0
    while at < tape.end:
        length = int(tape.memory[at : at + 8].view(np.int64)[0])
        found.append(tape.memory[at : at + length])
        at += length
    return found


def number(row: NDArray[np.uint8], at: int, dtype: Any = np.int64) -> Any:
    return row[at : at + np.dtype(dtype).itemsize].view(dtype)[0].item()


def test_rows_are_what_arrays_were_when_they_were_noted() -> None:
    poses, flags = np.arange(6.0).reshape(2, 3), np.array([True, False, True])
    tape = tape_of([Source("poses", poses), Source("flags", flags), Source("none", np.zeros(0))])
    tape.note(1, 0.1, np.nan, False)
    poses += 1.0
    flags[0] = False
    tape.note(2, 0.2, 0.5, False)
    one, two = rows_of(tape)
    at = tape.sheet.at
    assert one[at["poses"] :][:48].view(float).tolist() == list(range(6))
    assert two[at["poses"] :][:48].view(float).tolist() == list(range(1, 7))
    assert one[at["flags"] :][:3].tolist() == [1, 0, 1]
    assert two[at["flags"] :][:3].tolist() == [0, 0, 1]
    assert [number(row, TICK) for row in (one, two)] == [1, 2]
    assert [number(row, TIME) for row in (one, two)] == [100_000_000, 200_000_000]
    assert number(two, COVERAGE, float) == 0.5
    assert np.isnan(number(one, COVERAGE, float))
    assert number(one, LENGTH) == len(one)


def test_a_row_for_which_there_is_no_room_is_not_noted() -> None:
    poses = np.zeros((2, 3))
    tape = tape_of([Source("poses", poses)], rows=1)
    assert tape.note(1, 0.1, 0.0, False) == 0
    end = tape.end
    assert tape.note(2, 0.2, 0.0, False) == -1
    assert tape.end == end
    assert [number(row, TICK) for row in rows_of(tape)] == [1]


def test_ranges_of_those_that_are_read_are_singles() -> None:
    ranges = np.random.default_rng(1).random((3, 4))
    some = np.array([0, 2])
    tape = tape_of([Source("some", ranges, NARROW, some), Source("all", ranges, NARROW)])
    tape.note(1, 0.1, 0.0, False)
    (row,) = rows_of(tape)
    at = tape.sheet.at
    assert row[at["some"] :][:32].tobytes() == ranges[some].astype(np.float32).tobytes()
    assert row[at["all"] :][:48].tobytes() == ranges.astype(np.float32).tobytes()


def test_of_blobs_there_are_as_many_as_each_camera_sees() -> None:
    blobs = np.zeros((3, 4), BLOB)
    blobs["id"] = np.arange(12).reshape(3, 4)
    counts = np.array([2, 4, 1])
    rows = np.array([0, 2])
    tape = tape_of([Source("blobs", np.ascontiguousarray(blobs.T), BLOBS, rows, counts)])
    tape.note(1, 0.1, 0.0, False)
    counts[:] = 0
    tape.note(2, 0.2, 0.0, False)
    one, two = rows_of(tape)
    at = tape.sheet.at["blobs"]
    assert one[at : at + 16].view(np.int64).tolist() == [2, 1]
    first = number(one, at + 16)
    assert one[first : first + 3 * BLOB_SIZE].view(BLOB)["id"].tolist() == [0, 1, 8]
    assert two[at : at + 16].view(np.int64).tolist() == [0, 0]


def test_what_is_watched_is_told_once_when_it_has_changed() -> None:
    one, two = np.zeros(3, np.int64), np.zeros(2, np.uint32)
    tape = tape_of(
        [Source("one", one, WATCH, other=one.copy()), Source("two", two, WATCH, other=two.copy())],
        rows=9,
    )
    found = [tape.note(1, 0.1, 0.0, False)]
    one[2] = 7
    found.append(tape.note(2, 0.2, 0.0, False))
    two[0] = 1
    found.append(tape.note(3, 0.3, 0.0, False))
    one[0] = two[1] = 5
    found += [tape.note(4, 0.4, 0.0, False), tape.note(5, 0.5, 0.0, False)]
    assert found == [0, 2, 1, 3, 0]


def told_by(*steps: dict[str, float]) -> list[list[tuple[int, float, float]]]:
    """For each step, in which two robots' records are changed, the commands: robot, mode, vx."""
    movers = np.zeros(2, MOVER)
    movers["motors"] = True
    sheet = Sheet(["a", "b"], [], movers, commands.fresh(2))
    tape = Tape(sheet, np.zeros(10_000, np.uint8))
    for tick, step in enumerate(steps, 1):
        for name, value in step.items():
            movers[name][1] = value
        tape.note(tick, 0.1 * tick, 0.0, True)
    found = []
    for row in rows_of(tape):
        place, told = number(row, TOLD_AT), []
        for k in range(number(row, TOLD)):
            one = row[place + k * TELLING :][:TELLING]
            values = one[8:].view(float)
            told.append((number(one, 0), values[commands.MODE], values[0]))
        found.append(told)
    return found


def test_commands_are_told_where_they_change() -> None:
    assert told_by({}, {"vx": 0.5}, {}, {"motors": False}) == [[], [(1, 0, 0.5)], [], [(1, 0, 0.5)]]


def test_a_robot_that_comes_to_its_goal_was_told_nothing() -> None:
    sent = {"mode": POSITION, "goal_x": 1.0, "speed_limit": 0.3, "vx": 0.2}
    came = {"mode": HEADING, "vx": 0.0}
    assert told_by(sent, came, {}) == [[(1, POSITION, 0.2)], [], []]


def test_a_robot_that_is_sent_and_comes_in_one_tick_was_sent() -> None:
    assert told_by({"mode": HEADING, "goal_x": 1.0}) == [[(1, POSITION, 0.0)]]
