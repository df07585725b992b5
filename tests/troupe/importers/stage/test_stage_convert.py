"""Worlds in Stage's format become worlds of ours: everything stands where Stage puts it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from troupe.commands.import_ import report
from troupe.importers.stage import StageError

FLOOR = "model ( size [20 10 1] boundary 1 )\n"


# -- places -------------------------------------------------------------------------------------


def test_robots_stand_where_stage_puts_them_in_stages_coordinates(world) -> None:
    got = world("yard.world")
    # The floorplan's middle is at (2, -1) and it is 12 x 8 m: its corner is at (-4, -5).
    assert got.loaded.layout.size == (12, 8)
    assert got.loaded.layout.low == (-4, -5)
    assert got.data["origin"] == [4, 5]
    poses = {robot.name: robot.pose for robot in got.loaded.robots}
    for name, (x, y, heading) in {"r0": (-3, -4, 90), "r1": (7, 2, -135)}.items():
        assert poses[name] == pytest.approx((x, y, math.radians(heading)), abs=1e-9)


def test_walls_of_a_bitmap_stand_where_stage_puts_them(world) -> None:
    got = world("yard.world")
    inside = got.loaded.layout.inside

    def free(x: float, y: float) -> bool:
        return bool(inside([(x, y)])[0])

    # 120 x 80 pixels of 0.1 m; rows 30 to 33 (from the top, y = 3) and columns 20 to 69 are wall.
    assert not free(-4 + 2.05, 3 - 3.05)
    assert not free(-4 + 6.95, 3 - 3.35)
    assert free(-4 + 1.95, 3 - 3.05)
    assert free(-4 + 2.05, 3 - 2.95)
    assert free(-4 + 2.05, 3 - 3.45)
    assert not free(-4 + 6.65, 3 - 5.95)
    assert free(-4 + 6.55, 3 - 5.95)


def test_a_bitmap_that_serves_as_it_is_is_named_from_the_outputs_folder(world) -> None:
    got = world("yard.world")
    assert got.data["map"] == {
        "file": "../yard.png", "resolution": 0.1, "color": "gray30", "height": 0.8,
    }  # fmt: skip
    assert not list(got.path.parent.glob("*.png"))


def test_a_white_margin_is_cut_off_and_the_rest_stretched_as_stage_does(world) -> None:
    got = world("hall.world")
    assert got.data["map"]["file"] == "world_map.png"
    assert got.loaded.layout.size == (14, 6)

    def inside(places):  # counted from the hall's lower left corner
        return got.loaded.layout.inside(np.array(places) - (7, 3))

    # Dark pixels: columns 10 to 79, rows 10 to 39 of 90 x 50, on 14 x 6 m: 0.2 m per pixel.
    edge = [(0.1, 3), (13.9, 3), (7, 0.1), (7, 5.9)]
    assert not inside(edge).any()
    # The blue block (first channel 0, so solid) at columns 50 to 53, rows 20 to 29; the red one
    # (first channel 255) beside it is none.
    assert not inside([((50 - 10 + 0.5) * 0.2, 6 - (20 - 10 + 0.5) * 0.2)])[0]
    assert inside([((30 - 10 + 0.5) * 0.2, 6 - (20 - 10 + 0.5) * 0.2)])[0]
    assert any("drawn anew" in what for what in got.noted("differs", "hall.world:6"))


@pytest.mark.parametrize("heading", [0, 90, 180, 30])
def test_a_turned_and_stretched_bitmap_keeps_its_walls_within_a_cell(world, heading: int) -> None:
    got = world(
        f'model ( bitmap "yard.png" size [24 8 1] pose [3 2 0 {heading}] )\n'
        "model ( size [80 80 1] boundary 1 )\n"
    )
    rng = np.random.default_rng(3)
    local = np.column_stack([rng.uniform(-12, 12, 4000), rng.uniform(-4, 4, 4000)])
    column, row = np.floor((local[:, 0] + 12) / 0.2), np.floor((4 - local[:, 1]) / 0.1)
    wall = (row >= 30) & (row < 34) & (column >= 20) & (column < 70)
    wall |= (row >= 34) & (row < 60) & (column >= 66) & (column < 70)
    wall |= (row == 0) | (row == 79) | (column == 0) | (column == 119)
    angle = math.radians(heading)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    places = local @ turn.T + (3, 2)
    agree = ~got.loaded.layout.inside(places) == wall
    # Cells are half the smallest pixel, 0.05 m: a point is in a cell whose centre, which decides,
    # lies at most half a diagonal, 0.0354 m, away.
    sure = ~near_an_edge(local, 0.036)
    assert sure.mean() > 0.8
    assert agree[sure].all()


def near_an_edge(local: np.ndarray, reach: float) -> np.ndarray:
    """Whether points come within `reach` metres of an edge of yard.png's pixels on 24 x 8 m."""
    xs = np.array([0.0, 0.2, 4.0, 13.2, 14.0, 23.8, 24.0]) - 12
    ys = 4 - np.array([0.0, 0.1, 3.0, 3.4, 6.0, 7.9, 8.0])
    near_x = (abs(local[:, :1] - xs) < reach).any(axis=1)
    near_y = (abs(local[:, 1:] - ys) < reach).any(axis=1)
    return near_x | near_y


def test_two_floorplans_become_one_map(world) -> None:
    got = world(
        'model ( bitmap "yard.png" size [12 8 1] pose [0 0 0 0] )\n'
        'model ( bitmap "yard.png" size [12 8 1] pose [12 0 0 0] color "blue" )\n'
        "model ( size [30 10 1] boundary 1 pose [6 0 0 0] )\n"
    )
    inside = got.loaded.layout.inside
    for middle in (0, 12):
        assert not inside([(middle - 6 + 2.05, 4 - 3.05)])[0]
    assert got.data["map"]["color"] == "red"
    assert any(one["color"] == "blue" for one in got.data["obstacles"])


def test_a_world_without_a_floorplan_has_room_around_everything_and_no_boundary(world) -> None:
    got = world("open.world")
    assert got.data["boundary"] is None
    poses = {robot.name: robot.pose for robot in got.loaded.robots}
    assert poses["position_0"] == pytest.approx((10, 10, math.radians(20)))
    assert poses["position_1"] == pytest.approx((-3, 2, math.radians(-170)))
    low, size = np.array(got.loaded.layout.low), np.array(got.loaded.layout.size)
    assert all((low < pose[:2]).all() and (pose[:2] < low + size).all() for pose in poses.values())


def test_a_model_with_a_robot_inside_is_walls_as_stage_sees_it(world) -> None:
    mark, *walls = world("open.world").data["obstacles"][::-1]
    assert (mark["color"], mark["solid"]) == ("orange", False)
    assert len(walls) == 4
    assert all(wall["size"] == [4, 0.01] and wall["color"] == "brown" for wall in walls)


def test_a_boundary_of_the_outermost_model_is_the_worlds(world) -> None:
    got = world('model ( size [20 10 0.7] boundary 1 color "green" pose [5 5 0 90] )\n')
    assert got.data["size"] == [10, 20]
    assert got.data["boundary"] == {"color": "green", "height": 0.7}


def test_lengths_and_angles_are_in_the_files_units(world) -> None:
    got = world("hall.world")
    assert got.robot("cart_1")["pose"] == pytest.approx([-4, 1, 90])
    laser = next(s for s in got.model("cart_1")["sensors"] if s["type"] == "laser")
    assert laser == {
        "type": "laser", "pose": [0.1, 0, -90], "z": 0.5, "range": 10, "fov": 180, "samples": 91,
    }  # fmt: skip


def test_a_child_stands_in_its_parents_frame(world) -> None:
    got = world(FLOOR + "model ( pose [2 1 0 90] model ( pose [1 0 0 45] size [0.2 0.2 1] ) )\n")
    child = got.data["obstacles"][1]
    assert child["pose"] == pytest.approx([2, 1 + 1, 135])


# -- time, and what is left out -----------------------------------------------------------------


def test_interval_and_end_are_carried_over(world) -> None:
    got = world("yard.world")
    assert got.data["clock"] == {"interval": 0.2}
    assert (got.data["duration"], got.data["until"]) == (45, "duration")


def test_comments_say_from_which_line_a_thing_comes(world) -> None:
    lines = world("yard.world").text.splitlines()
    for begin, end in {
        "size:": "# yard.world:13",
        "clock:": "# yard.world:4",
        "map:": "# yard.world:18",
        "  - {name: r0,": "# yard.world:21",
        "      - {type: laser,": "# rover.inc:5",
        "    drive: {kind: differential": "# rover.inc:25",
    }.items():
        assert any(line.startswith(begin) and line.endswith(end) for line in lines), begin


LEFT_OUT = {
    "gripper ( autosnatch 1 )": "autosnatch",
    "camera ( )": "camera",
    "actuator ( )": "actuator",
    'ctrl "lasernoise 3"': "controllers: {lasernoise: {program: ./lasernoise.py}}",
    "ranger ( )": "measures nothing",
    "nosuch 3": "nosuch",
    "velocity [1 0 0 0]": "velocity",
    "update_interval 500": "update_interval",
}


@pytest.mark.parametrize(("inside", "words"), LEFT_OUT.items())
def test_what_is_not_carried_over_is_listed_with_file_and_line(
    world, inside: str, words: str
) -> None:
    got = world(FLOOR + f"position (\n{inside} )\n")
    assert any(words in what for what in got.noted("lost", "text.world:3"))


def test_every_property_is_used_or_listed(world) -> None:
    names = [f"unheard_of_{n}" for n in range(3)]
    got = world(
        f"{names[0]} 1\nmodel ( size [20 10 1] boundary 1 {names[1]} 2 )\n"
        f"position ( ranger ( sensor ( {names[2]} 3 samples 9 ) ) )\n"
    )
    lost = " ".join(note.what for note in got.notes if note.kind == "lost")
    assert all(name in lost for name in names)


def test_what_concerns_stages_window_is_listed_apart(world) -> None:
    got = world("yard.world")
    assert got.noted("unneeded", "yard.world:8") == ["window: concerns Stage's window"]
    assert got.noted("unneeded", "rover.inc:26")
    lines = report(got.notes)
    (lost,) = [n for n, line in enumerate(lines) if line.startswith("not carried over, and robots")]
    assert lost < lines.index("of no use here:")


def test_how_fast_stage_tried_to_run_is_no_loss(world) -> None:
    got = world(
        "interval_real 10\nmodel ( size [9 9 1] boundary 1 )\nposition ( pose [1 1 0 0] )\n"
    )
    assert got.noted("unneeded", "text.world:1")
    assert not [note for note in got.notes if note.kind == "lost"]


def test_a_hundred_robots_that_lack_the_same_are_one_line(world) -> None:
    robots = "".join(f"position ( pose [{n % 10} {n // 10} 0 0] gripper ( ) )\n" for n in range(30))
    got = world(FLOOR + robots.replace("gripper ( )", "mass 3 friction 2"))
    lines = [line for line in report(got.notes) if "friction" in line]
    assert len(lines) == 1
    assert "and in 29 more places" in lines[0]


# -- mistakes -----------------------------------------------------------------------------------

BAD = {
    "position ( pose [0 0] )": ("1:12", "pose needs 3 numbers"),
    'model ( size ["a" "b" "c"] )': ("1:9", "size needs numbers"),
    "model ( size [-1 1 1] )": ("1:9", "not be below 0"),
    'unit_length "feet"': ("1:1", "m or cm or mm"),
    'position ( drive "hover" )': ("1:12", "diff, omni, car"),
    "position ( velocity_bounds [1 2] )": ("1:12", "8 numbers"),
    'model ( bitmap "none.png" )': ("1:9", "No such file"),
    'model ( bitmap "rover.inc" )': ("1:9", "not an image"),
    "interval_sim 0": ("1:1", "above 0"),
    'position ( localization "magic" )': ("1:12", "not magic"),
}


@pytest.mark.parametrize(("text", "told"), BAD.items())
def test_what_stage_could_not_use_either_is_a_mistake_with_its_place(
    world, text: str, told: tuple[str, str]
) -> None:
    place, words = told
    with pytest.raises(StageError) as caught:
        world(text + "\n")
    assert f"text.world:{place}: " in str(caught.value)
    assert words in str(caught.value)
