"""What a kind of sensor does not see, is too high or too low for it, or is no solid thing."""

import math

import numpy as np
import pytest
from sensing import BLUE, BOX, GREEN, RED, Stage

from sensors.cones import cast_cones
from sensors.eyes import EYES
from sensors.rays import cast

LASER = {"type": "laser", "range": 20, "fov": 90, "samples": 91}
CAMERA = {"type": "blobfinder", "range": 20, "fov": 90, "image": [91, 60]}
RING = {"type": "ranger", "range": 20, "fov": 10}
FINDER = {"type": "fiducial", "range": 20}


def thing(stage, x, *, sees=tuple(EYES), color=RED, y=0.0, circle=False, **told):
    """A box of a metre, or a disc, that the named kinds of sensor see."""
    eyes = sum(EYES[name] for name in sees)
    entity = stage.scene.add_entity(color=color, pose=(x, y, 0.0), seen_by=eyes, **told)
    if circle:
        stage.scene.add_circle(entity, 0.5)
    else:
        stage.scene.add_polygon(entity, BOX)
    return entity


def seen_ahead(stage):
    """The range that laser, ranger and blobfinder measure straight ahead; None: nothing."""
    stage.sense()
    laser = stage.data(0, 0).ranges[0, 45]
    blobs = stage.data(0, 1)
    middle = [b for b in blobs.blobs[0, : blobs.counts[0]] if b["left"] <= 45 <= b["right"]]
    ring = stage.data(0, 2).ranges[0, 0]
    return (
        None if laser == 20 else round(float(laser), 3),
        middle[0]["color"] if middle else None,
        None if ring == 20 else round(float(ring), 3),
    )


@pytest.mark.parametrize("circle", [False, True])
@pytest.mark.parametrize(
    ("sees", "expected"),
    [
        (("laser", "ranger", "blobfinder"), (4.5, RED, 4.5)),
        (("laser",), (4.5, BLUE, 7.5)),
        (("ranger",), (7.5, BLUE, 4.5)),
        (("blobfinder",), (7.5, RED, 7.5)),
        (("fiducial", "bumper"), (7.5, BLUE, 7.5)),
        ((), (7.5, BLUE, 7.5)),
    ],
)
def test_only_the_kinds_of_sensor_that_see_a_thing_see_it(sees, expected, circle) -> None:
    stage = Stage()
    stage.robot(0, 0, 0, LASER, CAMERA, RING)
    thing(stage, 5.0, sees=sees, circle=circle)
    thing(stage, 8.0, color=BLUE)
    assert seen_ahead(stage) == expected


def test_walls_and_what_lies_within_them_are_left_out_for_who_does_not_see_them() -> None:
    stage = Stage()
    stage.robot(0, 0, 0, LASER, CAMERA, RING)
    glass = stage.scene.add_entity(seen_by=EYES["ranger"], color=RED)
    stage.scene.add_segments(glass, [[3, -50, 3, 50]])
    fog = stage.scene.add_entity(seen_by=EYES["ranger"], color=GREEN)
    stage.scene.add_solid(fog, [[-9, -9], [-0.6, -9], [-0.6, 9], [-9, 9]])
    thing(stage, 8.0, color=BLUE)
    assert seen_ahead(stage) == (7.5, BLUE, 3.0)
    stage.scene.poses[0, 0] = -5.0
    assert seen_ahead(stage) == (12.5, BLUE, 0.0)


def test_what_two_kinds_see_alike_they_see_in_one_cast_and_else_in_two() -> None:
    stage = Stage()
    stage.robot(0, 0, 0, LASER, CAMERA)
    thing(stage, 5.0, sees=("ranger",))
    stage.sense()
    scene = stage.scene
    assert scene.seen(EYES["laser"]) is scene.seen(EYES["blobfinder"])
    assert scene.seen(EYES["laser"]) is not scene.seen(EYES["ranger"])
    assert scene.seen(EYES["ranger"]) is scene.arrays
    assert (stage.data(0, 0).ranges == 20).all()
    assert (stage.data(0, 1).counts == 0).all()


def test_a_thing_that_comes_later_is_seen_by_its_own_kinds() -> None:
    stage = Stage()
    stage.robot(0, 0, 0, LASER, CAMERA, RING)
    thing(stage, 8.0, sees=("laser",))
    assert seen_ahead(stage) == (7.5, None, None)
    nearer = thing(stage, 5.0, sees=("ranger",))
    assert seen_ahead(stage) == (7.5, None, 4.5)
    stage.scene.poses[nearer, 1] = 9.0
    assert seen_ahead(stage) == (7.5, None, None)


def test_a_finder_neither_finds_nor_is_hindered_by_what_it_does_not_see() -> None:
    stage = Stage()
    stage.robot(0, 0, 0, FINDER)
    thing(stage, 4.0, fiducial=3, sees=("laser",))
    thing(stage, 6.0, fiducial=4)
    stage.sense()
    found = stage.data(0, 0)
    assert found.fiducials["id"][0, : found.counts[0]].tolist() == [4]


# -- heights --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("z", "expected"),
    [(None, 2.5), (0.1, 2.5), (0.3, 2.5), (0.31, 4.5), (0.5, 4.5), (0.51, 7.5), (1.9, 7.5)],
)
def test_a_sensor_looks_over_what_ends_below_and_under_what_begins_above(z, expected) -> None:
    stage = Stage()
    stage.robot(0, 0, 0, LASER | ({} if z is None else {"z": z}))
    thing(stage, 3.0, height=0.3)
    thing(stage, 5.0, height=0.5)
    thing(stage, 6.5, bottom=2.0)
    thing(stage, 8.0, height=2.0)
    stage.sense()
    assert stage.data(0, 0).ranges[0, 45] == pytest.approx(expected)


def test_sensors_at_different_heights_that_see_the_same_share_its_arrays() -> None:
    stage = Stage()
    stage.robot(0, 0, 0, LASER | {"z": 0.2}, CAMERA | {"z": 0.4})
    low = thing(stage, 3.0, height=0.3)
    stage.sense()
    scene = stage.scene
    assert scene.seen(EYES["laser"], 0.2) is scene.arrays
    assert scene.seen(EYES["blobfinder"], 0.4) is not scene.arrays
    assert stage.data(0, 0).hits[0, 45] == low
    assert stage.data(0, 1).counts[0] == 0


# -- what is not solid ----------------------------------------------------------------------------


def shell(circle: bool):
    """A scene with a thing of a metre that has no inside, and a wall behind it."""
    stage = Stage()
    thing(stage, 0.0, solid=False, circle=circle)
    stage.wall(5, -9, 5, 9)
    stage.scene.refresh()
    return stage.scene


def fan(scene, x, y=0.0, fov=2 * math.pi, samples=721, far=9.0):
    return cast(scene, [[x, y, 0.0]], [-1], fov, samples, far)[0][0]


@pytest.mark.parametrize("circle", [False, True])
def test_what_is_not_solid_is_seen_from_without_as_a_solid_thing_is(circle) -> None:
    stage = Stage()
    thing(stage, 0.0, circle=circle)
    stage.wall(5, -9, 5, 9)
    stage.scene.refresh()
    for x, y in ((-2.0, 0.0), (0.7, 0.9), (3.0, -1.0)):
        np.testing.assert_allclose(fan(shell(circle), x, y), fan(stage.scene, x, y), atol=1e-12)


def test_from_within_a_box_that_is_not_solid_its_sides_are_seen() -> None:
    ranges = fan(shell(circle=False), 0.2, 0.1, samples=5)
    np.testing.assert_allclose(ranges, [0.7, 0.6, 0.3, 0.4, 0.7], atol=1e-12)  # from behind, ccw


@pytest.mark.parametrize("x", [0.0, 0.3, -0.49])
def test_from_within_a_disc_that_is_not_solid_its_rim_is_seen_all_around(x) -> None:
    scene = shell(circle=True)
    bearings = np.linspace(-math.pi, math.pi, 721)
    ranges = fan(scene, x)
    rim = np.hypot(x + ranges * np.cos(bearings), ranges * np.sin(bearings))
    np.testing.assert_allclose(rim, 0.5, atol=1e-9)


@pytest.mark.parametrize("circle", [False, True])
def test_an_edge_of_it_on_which_a_sensor_stands_is_not_in_its_way(circle) -> None:
    scene = shell(circle)
    ahead = fan(scene, 0.5, fov=0.0, samples=1)
    np.testing.assert_allclose(ahead, [4.5])
    behind = cast(scene, [[0.5, 0.0, math.pi]], [-1], 0.0, 1, 9.0)[0]
    np.testing.assert_allclose(behind, [[1.0]])


def test_a_sheet_on_which_a_sensor_stands_is_not_in_its_way() -> None:
    stage = Stage()
    lane = stage.scene.add_entity(solid=False)
    stage.scene.add_segments(lane, [[0, -5, 0, 5], [2, -5, 2, 5]])
    stage.scene.refresh()
    np.testing.assert_allclose(fan(stage.scene, 0.0, fov=0.0, samples=1), [2.0])
    ranges = np.zeros(1)
    cast_cones(stage.scene.arrays, np.zeros((1, 3)), np.array([-1]), 0.2, 9.0, ranges)
    np.testing.assert_allclose(ranges, [2.0])


@pytest.mark.parametrize("circle", [False, True])
@pytest.mark.parametrize("fov", [0.2, 1.5, 4.0, 2 * math.pi])
def test_a_sonar_within_it_measures_the_nearest_point_of_its_outline(circle, fov) -> None:
    scene = shell(circle)
    origins = np.array([[0.1, -0.2, a] for a in np.linspace(0, 6, 13)])
    ranges = np.zeros(len(origins))
    cast_cones(scene.arrays, origins, np.full(len(origins), -1), fov, 9.0, ranges)
    for origin, measured in zip(origins, ranges, strict=True):
        rays = cast(scene, [origin], [-1], fov, 4001, 9.0)[0]
        assert measured == pytest.approx(rays.min(), abs=1e-6)
        assert measured <= rays.min() + 1e-12
