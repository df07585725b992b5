"""A scene shows what is in it, where it is now."""

import numpy as np
import pytest

from sensors.rays import cast
from sensors.scene import Scene

BOX = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]


def ahead(scene, pose=(0.0, 0.0, 0.0), own=-1):
    scene.refresh()
    ranges, hits = cast(scene, [pose], [own], 0.1, 3, 100.0)
    return float(ranges[0, 1]), int(hits[0, 1])


def test_a_body_is_seen_where_its_pose_says_after_a_refresh():
    scene = Scene()
    box = scene.add_entity(pose=(3, 0, 0))
    scene.add_polygon(box, BOX)
    assert ahead(scene) == (pytest.approx(2.5), box)
    scene.poses[box] = 5, 0, np.pi / 4
    assert ahead(scene) == (pytest.approx(5 - np.sqrt(0.5)), box)
    scene.move([box], [[9, 0, 0]])
    assert ahead(scene) == (pytest.approx(8.5), box)


def test_walls_may_move_too():
    scene = Scene()
    wall = scene.add_entity()
    scene.add_segments(wall, [[4, -1, 4, 1]])
    assert ahead(scene) == (pytest.approx(4.0), wall)
    scene.poses[wall] = 0.5, 0.25, 0
    assert ahead(scene) == (pytest.approx(4.5), wall)


def test_what_is_hidden_is_not_seen_until_it_is_shown_again():
    scene = Scene()
    wall, box, ball = (scene.add_entity(pose=(x, 0, 0)) for x in (8, 5, 3))
    scene.add_segments(wall, [[0, -1, 0, 1]])
    scene.add_polygon(box, BOX)
    scene.add_circle(ball, 0.5)
    for entity, behind in ((ball, 4.5), (box, 8.0), (wall, 100.0)):
        scene.hide(entity)
        assert ahead(scene)[0] == pytest.approx(behind)
    scene.hide(ball, False)
    assert ahead(scene) == (pytest.approx(2.5), ball)


def test_nobody_sees_its_own_body_but_all_its_shapes_belong_to_it():
    scene = Scene()
    robot = scene.add_entity()
    scene.add_polygon(robot, BOX)
    scene.add_circle(robot, 0.2, (2.0, 0.0))
    scene.add_segments(robot, [[3, -1, 3, 1]])
    scene.add_solid(robot, [[3, -1], [4, -1], [4, 1], [3, 1]])
    for x, seen in ((0.0, 0.0), (1.0, 0.8), (2.1, 0.0), (2.5, 0.5), (3.5, 0.0)):
        assert ahead(scene, (x, 0, 0), own=robot) == (100.0, -1)
        assert ahead(scene, (x, 0, 0)) == (pytest.approx(seen, abs=1e-12), robot)


def test_a_circle_may_lie_beside_the_origin_of_its_entity():
    scene = Scene()
    entity = scene.add_entity(pose=(0, 0, np.pi / 2))
    scene.add_circle(entity, 0.5, (0.0, -4.0))  # turned by 90 degrees: at (4, 0)
    assert ahead(scene)[0] == pytest.approx(3.5)


def test_clockwise_polygons_are_turned_round():
    scene = Scene()
    entity = scene.add_entity(pose=(3, 0, 0))
    scene.add_polygon(entity, BOX[::-1])
    assert ahead(scene)[0] == pytest.approx(2.5)
    assert ahead(scene, (3, 0, 0)) == (0.0, entity)


def test_a_scene_grows_while_it_is_in_use():
    scene = Scene()
    for k in range(100):
        entity = scene.add_entity(color=k, height=k / 10, fiducial=k, pose=(1000 - 10 * k, 0, 0))
        scene.add_polygon(entity, BOX)
        assert ahead(scene, (0, 0, 0))[1] == (entity if 1000 - 10 * k < 100.5 else -1)
    assert len(scene) == 100
    np.testing.assert_array_equal(scene.colors, np.arange(100))
    np.testing.assert_array_equal(scene.fiducials, np.arange(100))
    np.testing.assert_allclose(scene.heights, np.arange(100) / 10)
    np.testing.assert_array_equal(scene.poses[:, 0], 1000 - 10 * np.arange(100))


def test_edges_and_circles_of_the_world_are_those_that_are_seen():
    scene = Scene()
    box, ball, wall, gone = (scene.add_entity(pose=(k, 0, 0)) for k in range(4))
    scene.add_polygon(box, BOX)
    scene.add_circle(ball, 0.25)
    scene.add_segments(wall, [[0, 1, 0, 2]])
    scene.add_polygon(gone, BOX)
    scene.hide(gone)
    scene.refresh()
    edges, owners = scene.world_edges()
    assert owners.tolist() == [box] * 4 + [wall]
    np.testing.assert_allclose(edges[0], [-0.5, -0.5, 0.5, -0.5])
    np.testing.assert_allclose(edges[4], [2, 1, 2, 2])
    circles, owners = scene.world_circles()
    np.testing.assert_allclose(circles, [[1, 0, 0.25]])
    assert owners.tolist() == [ball]


def test_mistakes_are_refused_with_a_reason():
    scene = Scene()
    entity = scene.add_entity()
    with pytest.raises(IndexError, match="no entity 7"):
        scene.add_circle(7, 1.0)
    with pytest.raises(ValueError, match="k >= 3"):
        scene.add_polygon(entity, [[0, 0], [1, 1]])
    with pytest.raises(ValueError, match="an area"):
        scene.add_polygon(entity, [[0, 0], [1, 1], [2, 2]])
    with pytest.raises(ValueError, match="an area"):
        scene.add_solid(entity, [[0, 0], [1, 1], [2, 2]])
    with pytest.raises(ValueError, match="positive radius"):
        scene.add_circle(entity, 0.0)
    with pytest.raises(ValueError, match="finite"):
        scene.add_segments(entity, [[0, 0, np.nan, 1]])


@pytest.mark.parametrize("kind", ["body", "wall"])
def test_a_pose_that_is_not_finite_is_named(kind):
    scene = Scene()
    scene.add_entity()
    entity = scene.add_entity()
    if kind == "body":
        scene.add_circle(entity, 1.0)
    else:
        scene.add_segments(entity, [[0, 0, 1, 1]])
    scene.poses[entity, 2] = np.nan
    with pytest.raises(ValueError, match=r"not finite"):
        scene.refresh()
