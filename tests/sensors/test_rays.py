"""Rays see what brute force says they see."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors.rays import bearings_of, cast
from sensors.scene import Scene
from troupe.testing import rays

BOX = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


class Pair:
    """The same things in a Scene and for brute force."""

    def __init__(self):
        self.scene = Scene()
        self.world = rays.Things()

    def polygon(self, pose, vertices=BOX):
        entity = self.scene.add_entity(pose=pose)
        self.scene.add_polygon(entity, vertices)
        self.world.polygon(entity, np.array(pose, float), np.array(vertices, float))
        return entity

    def circle(self, pose, radius):
        entity = self.scene.add_entity(pose=pose)
        self.scene.add_circle(entity, radius)
        self.world.circle(entity, np.array(pose, float), radius)
        return entity

    def walls(self, segments, pose=(0.0, 0.0, 0.0)):
        entity = self.scene.add_entity(pose=pose)
        lines = np.array(segments, float)
        self.scene.add_segments(entity, lines)
        self.world.segments(entity, np.array(pose, float), lines)
        return entity

    def room(self, x0, y0, x1, y1):
        return self.walls([[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]])

    def block(self, vertices, pose=(0.0, 0.0, 0.0), hollow=False):
        """Walls with something solid behind them; hollow: round what lies within."""
        corners = np.array(vertices, float)
        entity = self.walls(np.hstack([corners, np.roll(corners, -1, axis=0)]), pose)
        self.scene.add_solid(entity, corners[::-1] if hollow else corners)
        self.world.inside(entity, np.array(pose, float), corners, hollow)
        return entity

    def check(self, origins, own, fov, samples, max_range):
        self.scene.refresh()
        origins = np.array(origins, float).reshape(-1, 3)
        own = np.broadcast_to(own, len(origins))
        ranges, hits = cast(self.scene, origins, own, fov, samples, max_range)
        bearings = bearings_of(fov, samples)
        for k, origin in enumerate(origins):
            answer = rays.scan(self.world, origin, own[k], bearings, max_range)
            rays.check_scan(answer, ranges[k], hits[k], max_range)
        return ranges, hits


def random_pair(rng, size):
    """A crowd of boxes, circles and polygons, overlapping as they like, in a room with walls."""
    pair = Pair()
    if rng.random() < 0.7:
        pair.room(0, 0, size, size)
    if rng.random() < 0.5:
        pair.block(BOX * size + size / 2, hollow=True)
    for _ in range(rng.integers(0, 12)):
        pose = (*rng.uniform(0, size, 2), rng.uniform(-10, 10))
        pair.block(BOX * rng.uniform(0.02, size / 4, 2), pose)
    if rng.random() < 0.5:
        a = rng.uniform(0, size, (rng.integers(1, 60), 2))
        pair.walls(np.hstack([a, a + rng.normal(0, size / 6, a.shape)]))
    robots = []
    for _ in range(rng.integers(1, 30)):
        pose = (*rng.uniform(0, size, 2), rng.uniform(-10, 10))
        shape = rng.integers(4)
        if shape == 0:
            robots.append(pair.circle(pose, rng.uniform(0.05, 1.0)))
        elif shape == 1:
            robots.append(pair.polygon(pose, BOX * rng.uniform(0.1, 3, 2)))
        elif shape == 2:
            angles = np.sort(rng.uniform(0, 2 * np.pi, 7))
            ring = rng.uniform(0.2, 1.5) * np.array([np.cos(angles), np.sin(angles)]).T
            robots.append(pair.polygon(pose, ring))
        else:
            robots.append(pair.polygon(pose))
    if rng.random() < 0.2:
        pair.circle((*rng.uniform(0, size, 2), 0.0), size / 3)
    return pair, robots


@pytest.mark.parametrize("seed", range(100))
def test_random_crowds_look_as_brute_force_says(seed):
    rng = np.random.default_rng(seed)
    size = rng.choice([3.0, 16.0, 60.0])
    pair, robots = random_pair(rng, size)
    fov = rng.choice([0.1, 1.0, np.pi, 4.0, 2 * np.pi])
    samples = int(rng.choice([1, 2, 3, 37, 180]))
    origins = [pair.scene.poses[r] for r in robots]  # a robot's own body is invisible
    pair.check(origins, np.array(robots), fov, samples, rng.choice([0.5, 5.0, 20.0]))
    strangers = np.column_stack([rng.uniform(-1, size + 1, (5, 2)), rng.uniform(-9, 9, 5)])
    pair.check(strangers, -1, fov, samples, 20.0)
    around = np.vstack([pair.scene.world_edges()[0][:, :2], pair.scene.world_circles()[0][:, :2]])
    on_the_rim = around[rng.integers(0, len(around), 20)] + rng.normal(0, 0.02, (20, 2))
    pair.check(np.column_stack([on_the_rim, rng.uniform(-9, 9, 20)]), -1, fov, samples, 20.0)


grid = st.integers(-12, 12).map(lambda k: k / 4)
quarter = st.integers(-4, 4).map(lambda k: k * np.pi / 2)
anywhere = st.floats(-4, 4).map(lambda a: round(a, 3))
exact_pose = st.tuples(grid, grid, st.one_of(st.just(0.0), quarter, anywhere))


@settings(max_examples=250)
@given(
    st.lists(st.tuples(exact_pose, st.sampled_from(["box", "circle", "bar"])), max_size=6),
    st.lists(exact_pose, min_size=1, max_size=4),
    st.sampled_from([np.pi / 2, np.pi, 2 * np.pi]),
    st.sampled_from([2, 5, 9, 91]),
)
def test_touching_bodies_and_sensors_in_corners_and_on_walls(bodies, sensors, fov, samples):
    """Everything lies on a grid, so that edges, corners and sensors coincide exactly."""
    pair = Pair()
    pair.room(-3, -3, 3, 3)
    for pose, shape in bodies:
        if shape == "circle":
            pair.circle(pose, 0.5)
        else:
            pair.polygon(pose, BOX if shape == "box" else BOX * (2.0, 0.5))
    pair.check(sensors, -1, fov, samples, 20.0)


def test_no_ray_leaves_a_closed_room_through_a_corner():
    """Rays aimed at corners, from everywhere: an edge may answer, but never nothing."""
    pair = Pair()
    pair.room(0, 0, 7, 3)
    for corner in [(0, 0), (7, 0), (7, 3), (0, 3)]:
        origins = np.random.default_rng(3).uniform((0.01, 0.01), (6.99, 2.99), (200, 2))
        toward = np.arctan2(corner[1] - origins[:, 1], corner[0] - origins[:, 0])
        ranges, hits = pair.check(np.column_stack([origins, toward]), -1, 1.0, 3, 50.0)
        expected = np.hypot(*(origins - corner).T)
        np.testing.assert_allclose(ranges[:, 1], expected, atol=1e-9)
        assert (hits == 0).all()


def test_no_ray_slips_between_the_edges_of_a_regular_polygon():
    pair = Pair()
    angles = np.arange(64) * 2 * np.pi / 64
    ring = pair.block(5 * np.array([np.cos(angles), np.sin(angles)]).T, (0, 0, 0.1), hollow=True)
    origins = np.column_stack([np.zeros((160, 2)), np.arange(160) * np.pi / 80])
    _, hits = pair.check(origins, -1, 2 * np.pi, 65, 50.0)
    assert (hits == ring).all()


def test_a_sensor_on_a_wall_reads_zero_everywhere():
    pair = Pair()
    wall = pair.walls([[0, 0, 5, 0]])
    pair.polygon((2, 1, 0))
    ranges, hits = pair.check([[1, 0, 0.3], [0, 0, 1.0], [5, 0, 0]], -1, 2 * np.pi, 9, 10.0)
    assert (ranges == 0).all()
    assert (hits == wall).all()


U = [[-2, -2], [2, -2], [2, 2], [1, 2], [1, -1], [-1, -1], [-1, 2], [-2, 2]]


def test_a_sensor_within_something_solid_reads_zero_everywhere():
    pair = Pair()
    things = {
        pair.polygon((0, 0, 0.4)): [(0, 0), (0.4, 0.2), (-0.3, 0)],
        pair.circle((5, 0, 0), 2.0): [(5, 0), (5.5, 0), (3.01, 0)],
        pair.polygon((0, 8, 0), U): [(1.5, 9.9), (-1.5, 9), (0, 6.5), (1.001, 8)],
        pair.block(BOX * 2, (9, 9, 0.3)): [(9, 9), (9.5, 9.3)],
        pair.block(U, (20, 0, 0)): [(21.5, 1.9), (20, -1.5), (19, 1)],
        pair.block(BOX * 80, hollow=True): [(40.001, 0), (-41, -41), (3, 1e6), (1e3, -1e3)],
    }
    for thing, places in things.items():
        for fov in (0.1, np.pi, 2 * np.pi):
            ranges, hits = pair.check([[*at, 0.3] for at in places], -1, fov, 5, 10.0)
            assert (ranges == 0).all()
            assert (hits == thing).all()
    ranges, _ = pair.check([[0, 9, 0], [20, 1, 0], [9, 7.5, 0], [39.999, 0, 0]], -1, 1.0, 5, 10.0)
    assert (ranges > 1e-4).all()  # within the bays of the U's, and just inside the hollow one


def test_what_a_robot_carries_itself_is_not_in_the_way_of_its_sensors():
    pair = Pair()
    own = pair.block(BOX, (2, 2, 0.3))
    pair.scene.add_circle(own, 1.0)
    pair.room(0, 0, 8, 8)
    ranges, _ = pair.check([[2, 2, 0], [2.2, 2, 1]], own, 1.0, 5, 10.0)
    assert (ranges > 1).all()
    pair.world.circle(own, np.array([2.0, 2, 0]), 1.0)
    ranges, _ = pair.check([[2, 2, 0]], -1, 1.0, 5, 10.0)
    assert (ranges == 0).all()


def test_what_is_solid_moves_with_its_entity_and_is_hidden_with_it():
    scene = Scene()
    entity = scene.add_entity(pose=(5, 5, 0.3))
    scene.add_solid(entity, BOX)
    for pose, hidden, expected in [
        ((5, 5, 0.3), False, 0.0),
        ((7, 5, 0.3), False, 3.0),
        ((5, 5, 2.0), False, 0.0),
        ((5, 5, 2.0), True, 3.0),
    ]:
        scene.poses[entity] = pose
        scene.hide(entity, hidden)
        scene.refresh()
        assert cast(scene, [[5.4, 5, 0]], [-1], 0.1, 1, 3.0)[0] == expected


@pytest.mark.parametrize("seed", range(10))
def test_pieces_side_by_side_have_no_seam(seed):
    """A sensor exactly on the border of two pieces, or a rounding beside it, is within them."""
    rng = np.random.default_rng(seed)
    scene = Scene()
    wall = scene.add_entity(pose=(0, 0, rng.uniform(-3, 3)))
    edges = np.sort(rng.uniform(0, 30, 40))
    for left, right in itertools.pairwise(edges):
        scene.add_solid(wall, [[left, 0], [right, 0], [right, 1], [left, 1]])
    scene.refresh()
    local = edges + 1j * rng.uniform(0.01, 0.99, 40)
    at = np.concatenate([local, local + rng.uniform(-1, 1, 40) * 1e-10])[np.r_[1:39, 41:79]]
    at = at * np.exp(1j * scene.poses[wall, 2])
    origins = np.column_stack([at.real, at.imag, 0 * at.real])
    ranges, hits = cast(scene, origins, np.full(76, -1), 1.0, 3, 5.0)
    assert (ranges == 0).all()
    assert (hits == wall).all()


def test_both_ends_of_the_fov_are_rays_and_the_right_one_is_the_first():
    pair = Pair()
    pair.walls([[-5, -2, 5, -2]])  # to the right
    ranges, hits = pair.check([[0, 0, 0]], -1, np.pi, 181, 8.0)
    assert ranges[0, 0] == pytest.approx(2.0, abs=1e-12)
    assert ranges[0, -1] == 8.0
    assert hits[0, -1] == -1


def test_the_ends_of_a_full_turn_coincide():
    pair = Pair()
    pair.room(-3, -4, 5, 2)
    for heading in np.linspace(-7, 7, 29):
        ranges, _ = pair.check([[0.3, 0.2, heading]], -1, 2 * np.pi, 73, 20.0)
        assert ranges[0, 0] == pytest.approx(ranges[0, -1], abs=1e-12)


def test_what_is_farther_than_the_range_is_not_seen():
    pair = Pair()
    pair.walls([[5, -1, 5, 1]])
    ranges, hits = pair.check([[0, 0, 0]], -1, 0.1, 3, 4.99)
    assert (ranges == 4.99).all()
    assert (hits == -1).all()


def test_bodies_much_larger_than_the_others_are_seen_from_everywhere():
    """They lie outside of the grid's cells, which are made for the usual body."""
    rng = np.random.default_rng(5)
    pair = Pair()
    for _ in range(40):
        pair.polygon((*rng.uniform(0, 100, 2), rng.uniform(-3, 3)))
    pair.polygon((50, 50, 0.3), BOX * (70, 2))
    pair.circle((90, 5, 0), 30.0)
    origins = np.column_stack([rng.uniform(0, 100, (60, 2)), rng.uniform(-3, 3, 60)])
    pair.check(origins, -1, np.pi, 60, 40.0)


def test_a_concave_polygon_hides_its_own_far_edges():
    pair = Pair()
    pair.polygon((0, 0, 0.2), U)
    rng = np.random.default_rng(1)
    origins = np.column_stack([rng.uniform(-4, 4, (200, 2)), rng.uniform(-3, 3, 200)])
    pair.check(origins, -1, np.pi, 60, 20.0)


def test_a_line_of_bodies_and_a_single_one_have_a_grid_too():
    pair = Pair()
    for k in range(200):
        pair.circle((1.0 * k, 0, 0), 0.3)
    pair.check([[x, 0.7, 0.1 * x] for x in range(0, 200, 7)], -1, 2 * np.pi, 90, 15.0)
    lone = Pair()
    lone.circle((1e4, 1e4, 0), 0.3)
    lone.check([[1e4 - 2, 1e4, 0], [0, 0, 0.7]], -1, 1.0, 11, 3.0)


def test_only_the_wanted_rows_are_written():
    pair = Pair()
    pair.room(0, 0, 4, 4)
    pair.scene.refresh()
    out = np.full((3, 5), 7.5), np.full((3, 5), -9, np.int32)
    origins = [[1, 1, 0], [2, 2, 0], [3, 3, 0]]
    cast(pair.scene, origins, [-1] * 3, 1.0, 5, 9.0, rows=np.array([1]), out=out)
    assert (out[0][[0, 2]] == 7.5).all()
    assert (out[1][[0, 2]] == -9).all()
    assert (out[0][1] < 3).all()


def test_an_empty_scene_shows_nothing():
    ranges, hits = cast(Scene(), [[0, 0, 0]], [-1], np.pi, 4, 6.0)
    assert (ranges == 6.0).all()
    assert (hits == -1).all()


def test_a_ray_two_billionths_beside_a_corner_gives_one_answer():
    """The fan's middle ray aims just past, or just onto, corners that stand out against nothing."""
    rng = np.random.default_rng(11)
    pair = Pair()
    box = pair.polygon((0, 0, 0.4))
    corners = rays.placed(np.array([0, 0, 0.4]), BOX)
    for _ in range(100):
        bearing = rng.uniform(-np.pi, np.pi)
        x, y = 3 * np.cos(bearing), 3 * np.sin(bearing)
        toward = np.angle(corners - complex(x, y))
        middle = np.angle(-complex(x, y))
        off = np.angle(np.exp(1j * (toward - middle)))
        for side in (off.argmin(), off.argmax()):  # the two corners at the silhouette
            inward = -np.sign(off[side])
            headings = toward[side] + inward * np.array([2e-9, -2e-9])
            _, hits = pair.check([[x, y, h] for h in headings], -1, 1.0, 3, 10.0)
            assert hits[:, 1].tolist() == [box, -1]
