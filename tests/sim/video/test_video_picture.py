"""A frame shows what the snapshot says, where the snapshot says it: the world and its bodies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from drawn import GREEN, bounds, one_robot, pixel
from video_arenas import SQUARE, walled

from sim.video import Backdrop, Scan, Sighting, Snapshot
from sim.video.axes import ticks
from sim.video.bodies import heading_wedge, outline_of, reach_ahead
from sim.video.errors import VideoError
from sim.video.ground import soften
from sim.video.layers import LAYERS, Layer
from sim.video.palette import GROUND, bgr, tint
from sim.video.picture import Picture, save_picture


def test_a_body_lies_where_its_pose_says(arena: Backdrop) -> None:
    # The edge line and its smoothing take two pixels all around: 2 / 38 m.
    assert bounds(arena, [4.0, 5.0, 0.0]) == pytest.approx((3.5, 4.5, 4.5, 5.5), abs=0.06)


def test_a_turned_body_reaches_out_to_its_corners(arena: Backdrop) -> None:
    half = np.sqrt(0.5)
    wanted = (4 - half, 5 - half, 4 + half, 5 + half)
    # At a corner of 90 degrees the edge line takes sqrt(2) times as much as at a side.
    assert bounds(arena, [4.0, 5.0, np.pi / 4]) == pytest.approx(wanted, abs=0.09)


@pytest.mark.parametrize("yaw", [0.0, np.pi / 2, np.pi, -np.pi / 2, 2.0])
def test_the_wedge_points_ahead(arena: Backdrop, yaw: float) -> None:
    picture, image = one_robot(arena, poses=np.array([[4.0, 5.0, yaw]]))
    ahead = 0.2 * np.array([np.cos(yaw), np.sin(yaw)])
    assert pixel(picture, image, 4 + ahead[0], 5 + ahead[1]) == list(bgr(tint(0)))
    assert pixel(picture, image, 4 - ahead[0], 5 - ahead[1]) == list(bgr(soften(GREEN)))


def test_a_robots_rim_and_arrow_have_its_identity_colour_whatever_its_body_has(
    arena: Backdrop,
) -> None:
    poses = np.array([[2.0 + 2 * (k % 6), 3.0 + 4 * (k // 6), 0.0] for k in range(24)])
    bodies = [GREEN, 0x4040FF, 0x808080] * 8
    picture = Picture(arena, (1280, 1680), show=frozenset())
    for robot in range(24):
        picture.add_robot(f"r{robot}", SQUARE)
    image = picture.draw(Snapshot(0.0, poses, bodies))
    for robot, (x, y, _) in enumerate(poses):
        assert pixel(picture, image, x + 0.15, y) == list(bgr(tint(robot)))
        assert pixel(picture, image, x - 0.3, y + 0.2) == list(bgr(soften(bodies[robot])))
        assert list(bgr(tint(robot))) in [
            pixel(picture, image, x - 0.5 + step / 100, y + 0.1) for step in range(2, 10)
        ]


def test_who_has_settled_is_paler(arena: Backdrop) -> None:
    picture, image = one_robot(arena)
    _, pale = one_robot(arena, settled=[True])
    for x, y in ((3.8, 5.0), (4.2, 5.0), (3.7, 5.3)):
        bright = np.array(pixel(picture, pale, x, y)) - pixel(picture, image, x, y)
        assert bright.min() >= 0
        assert bright.max() > 60


@pytest.mark.parametrize("layer", LAYERS)
def test_a_layer_shows_only_where_it_is_asked_for(arena: Backdrop, layer: Layer) -> None:
    sighting = Sighting(0, (4, 5, 0), np.array([[-0.5, 0.5]]), np.array([0xFF0000]))
    views = [
        Snapshot(
            step / 2,
            np.array([[3.0 + step, 5.0, 0.0]]),
            [GREEN],
            said=["hello"],
            scans=[Scan(0, (3.0 + step, 5.0, 0.0), np.pi, np.full(181, 3.0))],
            sightings=[sighting],
        )
        for step in range(3)
    ]
    images = []
    for show in (frozenset(), frozenset({layer}), frozenset(LAYERS), frozenset(LAYERS) - {layer}):
        picture = Picture(arena, show=frozenset(show))
        picture.add_robot("r1", SQUARE)
        images.append([picture.draw(snapshot) for snapshot in views][-1])
    assert (images[0] != images[1]).any()
    assert (images[2] != images[3]).any()


def test_text_grows_with_the_picture(arena: Backdrop) -> None:
    heights = []
    for size in ((640, 840), (1280, 1680)):
        picture = Picture(arena, size)
        image = picture.draw(Snapshot(0.0, np.empty((0, 3)), []))
        strip = image[picture.projection.field_height + 2 :, : size[0] // 4]
        rows = np.flatnonzero((strip.astype(int).sum(axis=2) < 300).any(axis=1))
        heights.append(np.ptp(rows) + 1)
    # Whole pixels: two digits of one height may differ by one.
    assert heights[1] == pytest.approx(2 * heights[0], abs=2)


def test_axes_count_metres(arena: Backdrop) -> None:
    picture = Picture(arena, axes=True)
    found = ticks(arena.size, picture.projection, picture.composer.lettering)
    for tick in found:
        value = float(tick.text.removesuffix(" m"))
        place = picture.projection.edges(np.array([value, value]))
        assert tick.at == pytest.approx(place[0 if tick.axis == "x" else 1])
    for axis, length in zip("xy", arena.size, strict=True):
        texts = [tick.text for tick in found if tick.axis == axis]
        assert texts[0] == "0"
        assert texts[-1].endswith(" m")
        assert float(texts[-1].removesuffix(" m")) <= length
    image = picture.draw(Snapshot(0.0, np.empty((0, 3)), []))
    bare = Picture(arena, axes=True)
    assert (image == bare.draw(Snapshot(0.0, np.empty((0, 3)), []))).all()
    margin = image[: picture.projection.field_height, : int(picture.projection.left) - 12]
    assert (margin.min(axis=2) < 160).any()  # the numbers of the y axis


def test_a_circle_is_round(arena: Backdrop) -> None:
    picture = Picture(arena)
    picture.add_robot("r1", 2.0)
    image = picture.draw(Snapshot(0.0, np.array([[8.0, 10.0, 0.0]]), [GREEN]))
    for angle in np.linspace(0, 2 * np.pi, 16, endpoint=False) + 0.3:
        direction = np.array([np.cos(angle), np.sin(angle)])
        inside, outside = [8, 10] + 1.85 * direction, [8, 10] + 2.1 * direction
        assert pixel(picture, image, *inside) == list(bgr(soften(GREEN)))
        assert pixel(picture, image, *outside) != list(bgr(soften(GREEN)))


def test_walls_stand_around_the_world(arena: Backdrop) -> None:
    picture, image = one_robot(arena)
    wall = list(bgr(soften(0xFF0000)))
    for x, y in ((-0.1, 10), (16.1, 10), (8, -0.1), (8, 21.1)):
        assert pixel(picture, image, x, y) == wall
    assert pixel(picture, image, 8.4, 10.4) == list(bgr(GROUND))


def test_movable_things_are_drawn_where_they_are(arena: Backdrop) -> None:
    things = {"movables": [(SQUARE, 0x0000FF), (0.4, 0x0000FF)]}
    poses = np.array([[10.0, 10.0, 0.0], [12.0, 3.0, 0.0]])
    picture, image = one_robot(arena, **things, movable_poses=poses)
    for x, y, _ in poses:
        assert pixel(picture, image, x, y) == list(bgr(soften(0x0000FF)))


def test_what_stands_is_drawn_where_it_stands_now_and_paint_about_it(arena: Backdrop) -> None:
    floor = np.ones((21, 16), np.int16)
    wall = np.array([[4.0, 4.0], [7.0, 4.0], [7.0, 6.0], [4.0, 6.0]])
    moved = replace(arena, solids=[*arena.solids, (wall, 0x0000FF)])
    poses = np.array([[10.0, 15.0, 0.0]])
    paint = {"floor": floor, "resolution": 1.0, "poses": poses, "colors": [GREEN]}
    picture, before = one_robot(arena, **paint)
    there, expected = one_robot(moved, **paint)
    now = picture.draw(Snapshot(0.0, **paint, backdrop=moved))
    assert pixel(there, expected, 5.5, 5.0) == list(bgr(soften(0x0000FF)))
    assert np.array_equal(now, expected)
    shade = f"#{soften(0x0000FF):06x}"
    assert shade in picture.svg(Snapshot(0.0, **paint, backdrop=moved))
    assert shade not in picture.svg(Snapshot(0.0, **paint))
    assert np.array_equal(picture.draw(Snapshot(0.0, **paint)), before)


def test_poses_must_be_as_many_as_robots(arena: Backdrop) -> None:
    with pytest.raises(ValueError, match="1 robots were added, but 2 poses"):
        one_robot(arena, poses=np.zeros((2, 3)), colors=[1, 2])
    with pytest.raises(ValueError, match="1 bodies need 1 colors"):
        one_robot(arena, colors=[1, 2])


def test_a_frame_covers_whatever_was_in_the_buffer(arena: Backdrop) -> None:
    picture = Picture(arena)
    picture.add_robot("r1", SQUARE)
    snapshot = Snapshot(
        0.0, np.array([[4.0, 5.0, 0]]), [GREEN], scans=[(0, (4, 5, 0), 3, np.ones(9))]
    )
    clean = picture.draw(snapshot)
    dirty = np.full_like(clean, 77)
    assert (picture.draw(snapshot, out=dirty) == clean).all()


@pytest.mark.parametrize("size", [(64, 64), (64, 4096), (4096, 64), (642, 840)])
def test_every_size_can_be_drawn(arena: Backdrop, size: tuple[int, int]) -> None:
    picture = Picture(arena, size)
    picture.add_robot("a name that is longer than the frame", SQUARE)
    snapshot = Snapshot(
        1e6, np.array([[4.0, 5.0, 0]]), [GREEN], 1.0, ["a sentence longer than the frame"]
    )
    assert picture.draw(snapshot).shape == (size[1], size[0], 3)


def test_a_thousand_robots_are_all_in_the_picture() -> None:
    picture = Picture(walled(316, 316))
    places = np.stack(np.meshgrid(np.arange(32), np.arange(32)), axis=-1).reshape(-1, 2) * 9.5 + 9
    for index in range(len(places)):
        picture.add_robot(f"r{index}", SQUARE)
    poses = np.column_stack([places, np.zeros(len(places))])
    image = picture.draw(Snapshot(0.0, poses, np.full(len(poses), GREEN)))
    shown = [pixel(picture, image, x, y) == list(bgr(soften(GREEN))) for x, y in places]
    assert all(shown)


def test_a_map_of_thousands_of_blocks_is_drawn() -> None:
    blocks = [
        (np.array([[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]], float), 0x808080)
        for x in range(60)
        for y in range(60)
        if (x + y) % 2
    ]
    picture = Picture(Backdrop((60, 60), blocks))
    image = picture.draw(Snapshot(0.0, np.empty((0, 3)), []))
    assert pixel(picture, image, 1.5, 0.5) == list(bgr(soften(0x808080)))
    assert pixel(picture, image, 1.5, 1.5) != list(bgr(soften(0x808080)))


def test_a_heading_wedge_lies_inside_its_body() -> None:
    shapes = [SQUARE, outline_of(0.4, 40), np.array([[-0.2, -0.3], [0.6, 0], [-0.2, 0.3]])]
    for shape in shapes:
        for corner in heading_wedge(shape).astype(np.float32):
            assert cv2.pointPolygonTest(shape.astype(np.float32), corner.tolist(), False) >= 0


def test_the_reach_ahead_is_where_the_axis_leaves_the_body() -> None:
    assert reach_ahead(SQUARE) == 0.5
    assert reach_ahead(np.array([[-0.2, -0.3], [0.6, 0.0], [-0.2, 0.3]])) == pytest.approx(0.6)
    assert reach_ahead(SQUARE + np.array([0, 5])) == 0.0


def test_a_picture_is_saved_as_it_was_drawn(arena: Backdrop, tmp_path: Path) -> None:
    picture = Picture(arena)
    picture.add_robot("r1", SQUARE)
    snapshot = Snapshot(0.0, np.array([[4.0, 5.0, 0]]), [GREEN])
    path = save_picture(tmp_path / "one.png", picture, snapshot)
    assert (cv2.imread(str(path)) == picture.draw(snapshot)).all()


def test_a_picture_that_cannot_be_saved_says_why(arena: Backdrop, tmp_path: Path) -> None:
    picture = Picture(arena)
    snapshot = Snapshot(0.0, np.empty((0, 3)), [])
    with pytest.raises(VideoError, match=r"must end in \.png"):
        save_picture(tmp_path / "one.jpg", picture, snapshot)
    with pytest.raises(VideoError, match="No such file"):
        save_picture(tmp_path / "nowhere" / "one.png", picture, snapshot)
