"""Whatever a Stage world says is carried over, listed, or refused with its place: nothing else.

The properties are those that Stage 4.3 knows, by type, each with a value that is not its default,
and those of Stage 2 and 3 that were found in worlds of today.
"""

from __future__ import annotations

import pytest

from troupe.importers.stage import StageError

FLOOR = 'model ( size [20 10 1] boundary 1 color "green" )\n'

MODEL = {
    "name": '"other"', "pose": "[3 2 0 45]", "size": "[0.7 0.3 0.4]", "origin": "[0.1 0 0 0]",
    "color": '"blue"', "color_rgba": "[0 0 1 1]", "bitmap": '"yard.png"', "boundary": "1",
    "mass": "3", "friction": "2", "map_resolution": "0.5", "update_interval": "500",
    "ctrl": '"lasernoise 3"', "alwayson": "1", "say": '"hello"', "stack_children": "0",
    "obstacle_return": "0", "ranger_return": "-1", "blob_return": "0", "fiducial_return": "4",
    "fiducial_key": "2", "gripper_return": "1", "gui_nose": "1", "gui_grid": "1",
    "gui_outline": "1", "gui_move": "1", "trail_length": "5", "trail_interval": "5",
    "joules": "100", "joules_capacity": "100", "kjoules": "1", "kjoules_capacity": "1",
    "watts": "5", "give_watts": "5", "take_watts": "5", "noblocks": "1", "debug": "1",
    "event_queue": "1", "laser_return": "0", "unheard_of": "1",
}  # fmt: skip

TABLES = {
    "model": MODEL,
    "position": MODEL
    | {
        "drive": '"omni"', "velocity": "[1 0 0 0]", "localization": '"odom"',
        "localization_origin": "[1 0 0 0]", "odom_error": "[0.1 0.1 0 0.1]", "wheelbase": "0.4",
        "velocity_bounds": "[-2 2 0 0 0 0 -10 10]",
        "acceleration_bounds": "[-2 2 0 0 0 0 -10 10]", "odom": "[0 0 0]",
    },
    "sensor": {
        "pose": "[0.1 0 0 30]", "size": "[0.1 0.1 0.4]", "range": "[0 3]", "fov": "40",
        "samples": "7", "noise": "[0.01 0.1 0.1]", "color": '"blue"', "color_rgba": "[0 0 1 1]",
    },
    "blobfinder": {
        "colors_count": "1", "colors": '["red"]', "image": "[40 30]", "range": "5", "fov": "90",
        "pan": "10", "channels_count": "1", "channels": '["red"]', "range_max": "4",
    },
    "fiducial": {
        "range_min": "0.5", "range_max": "6", "range_max_id": "3", "fov": "90", "ignore_zloc": "1",
    },
    "bumper": {"bcount": "2", "bpose[0]": "[0.2 0 0 0]", "blength": "0.3", "blength[0]": "0.4"},
    "gripper": {
        "paddle_size": "[0.5 0.1 0.4]", "paddle_state": '["closed" "up"]', "autosnatch": "1",
        "pose": "[0.3 0.1 0 20]", "size": "[0.3 0.3 0.2]", "origin": "[0.1 0 0 0]",
        "color": '"blue"', "obstacle_return": "0", "gripper_return": "1", "update_interval": "500",
        "watts": "5", "alwayson": "1", "mass": "2",
    },
    "camera": {
        "resolution": "[64 64]", "range": "[0.3 4]", "fov": "[60 40]", "pantilt": "[10 0]",
        "size": "[0.1 0.1 0.1]", "color": '"red"',
    },
    "actuator": {
        "type": '"rotational"', "axis": "[0 0 1]", "min_position": "-1", "max_position": "2",
        "max_speed": "2", "start_position": "1",
    },
    "blinkenlight": {
        "dutycycle": "0.5", "period": "500", "enabled": "0", "color": '"blue"',
    },
    "lightindicator": {"color": '"blue"', "size": "[0.1 0.1 0.1]"},
    "laser": {
        "samples": "20", "range_min": "0.1", "range_max": "3", "fov": "90", "resolution": "2",
        "laser_sample_skip": "2", "size": "[0.1 0.1 0.1]",
    },
    "ranger": {
        "scount": "2", "spose[0]": "[0.1 0 30]", "sview": "[0.1 3 20]", "sview[0]": "[0.1 3 20]",
        "ssize": "[0.1 0.1]", "sraycount": "3", "pose": "[0.1 0 0 0]", "size": "[0.1 0.1 0.1]",
    },
    "world": {
        "name": '"n"', "interval_sim": "50", "quit_time": "7", "resolution": "0.1",
        "threads": "2", "show_clock": "1", "show_clock_interval": "10", "paused": "1",
        "threadpool": "2", "interval_real": "1",
        "speedup": "3", "confirm_on_quit": "0", "unit_length": '"cm"', "unit_angle": '"radians"',
    },
    "window": {
        "size": "[100 100]", "center": "[1 1]", "rotate": "[10 10]", "scale": "10",
        "show_data": "1", "pcam_loc": "[0 0 0]", "pcam_angle": "[0 0]", "pcam_on": "1",
    },
    "block": {"points": "3", "point[1]": "[2 1]", "z": "[0 0.5]", "color": '"blue"'},
}  # fmt: skip

WITHIN = {
    "model": "model ( pose [2 0 0 0] {} )\n",
    "position": "position ( {} )\n",
    "sensor": "position ( ranger ( sensor ( {} ) ) )\n",
    "world": "position ( pose [2 0 0 1] ranger ( sensor ( samples 9 ) ) )\n{}\n",
    "ranger": "position ( ranger ( scount 1 {} ) )\n",
    "bumper": "position ( bumper ( bcount 1 bpose[0] [0.1 0 0 0] {} ) )\n",
    "window": "window ( {} )\n",
    "block": (
        "model ( pose [2 0 0 0] block ( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1]\n"
        "point[3] [0 1] {} ) block ( points 3 point[0] [2 2] point[1] [3 2] point[2] [3 3] ) )\n"
    ),
}
NEEDS = {
    "colors": "colors_count 1 ", "channels": "channels_count 1 ",
    "colors_count": 'colors ["red"] ', "channels_count": 'channels ["red" "green"] ',
    "localization_origin": 'localization "odom" ', "odom_error": 'localization "odom" ',
    "wheelbase": 'drive "car" ',
}  # fmt: skip
"""What a property has no meaning without."""


@pytest.mark.parametrize(
    ("kind", "key"), [(kind, key) for kind, table in TABLES.items() for key in table]
)
def test_a_property_is_carried_over_listed_or_refused(world, kind: str, key: str) -> None:
    whole = WITHIN.get(kind, f"position ( {kind} ( {{}} ) )\n")
    whole = (FLOOR if kind != "world" else "") + whole
    needs = NEEDS.get(key, "")
    try:
        got = world(whole.format(f"{needs}{key} {TABLES[kind][key]}"))
    except StageError as error:
        refused = error
    else:
        refused = None
    if refused is not None:
        assert refused.place is not None
        return
    without = world(whole.format(needs))
    listed = {note.what for note in got.notes} - {note.what for note in without.notes}
    listed |= {note.what for note in got.notes if key.split("[", maxsplit=1)[0] in note.what}
    carried = got.data != without.data
    assert carried or listed or (kind, key) in SAID_TOGETHER, (got.text, listed)
    if kind in NO_SUCH:
        assert any(note.what.startswith(f"{kind}: ") and key in note.what for note in got.notes)


NO_SUCH = ("camera", "actuator", "blinkenlight", "lightindicator")
"""Types that there are not here: the line that says so names what was said of one."""
SAID_TOGETHER = {("window", key) for key in TABLES["window"]}
"""What one line for the whole says."""


def test_what_one_line_says_of_the_whole_is_said(world) -> None:
    got = world(FLOOR + "window ( size [100 100] scale 10 )\n")
    assert got.noted("unneeded", "text.world:2") == ["window: concerns Stage's window"]


def test_a_gripper_is_where_stage_has_it_and_opens_as_wide(world) -> None:
    got = world(
        FLOOR + "position ( size [0.4 0.4 0.3] gripper ( pose [0.3 0.1 0 90]\n"
        "size [0.2 0.4 0.2] paddle_size [0.5 0.1 0.4] ) gripper ( ) )\n"
    )
    first, second = got.model("position_0")["actuators"]
    assert first["type"] == "gripper"
    assert first["pose"] == pytest.approx([0.3, 0.15, 90])
    assert first["space"] == pytest.approx([0.1, 0.32])
    assert second["pose"] == pytest.approx([0.034, 0, 0])
    assert second["space"] == pytest.approx([0.132, 0.24])


def test_grippers_are_served_where_the_table_has_them(world) -> None:
    got = world("yard.world", "yard.cfg")
    assert not [note.what for note in got.notes if note.place.file.endswith(".cfg")
                and "gripper" in note.what]  # fmt: skip
    assert [one["type"] for one in got.model("r1")["actuators"]] == ["gripper"]


def test_what_stands_on_a_device_that_is_not_here_is_listed(world) -> None:
    got = world(FLOOR + "position ( camera ( model ( size [1 1 1] ) ranger ( sensor ( ) ) ) )\n")
    assert "model upon a camera" in [note.what for note in got.notes if note.kind == "lost"]
    assert len(got.model("position_0")["sensors"]) == 1


def test_a_thing_of_every_type_is_carried_over_or_listed(world) -> None:
    from troupe.importers.stage.things import PARTS, TYPES  # noqa: PLC0415

    for kind in sorted(TYPES - PARTS - {"model", "position"}):
        got = world(FLOOR + f"position ( {kind} ( ) )\n")
        sensors = got.model("position_0").get("sensors", [])
        said = [note for note in got.notes if note.kind in ("lost", "looks", "differs")]
        assert sensors or any(kind in note.what or "sensor" in note.what for note in said), kind
        alone = world(FLOOR + f"{kind} ( )\n")
        assert any(kind in note.what for note in alone.notes), kind
