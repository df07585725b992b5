"""A frame shows what the snapshot says, where the snapshot says it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from video_arenas import SQUARE, walled

from sim.video import Backdrop, Drawing, Scan, Sighting, Snapshot
from sim.video.axes import ticks
from sim.video.bodies import heading_wedge, outline_of, reach_ahead
from sim.video.errors import VideoError
from sim.video.ground import soften
from sim.video.layers import LAYERS, SHOWN, Layer
from sim.video.palette import GROUND, bgr, tint
from sim.video.picture import Picture, save_picture

GREEN = 0x00FF00


def pixel(picture: Picture, image: np.ndarray, x: float, y: float) -> list[int]:
    """BGR at a place in the world."""
    column, row = picture.projection.edges(np.array([x, y], dtype=float))
    return image[int(row), int(column)].tolist()


def one_robot(backdrop: Backdrop, **snapshot: object) -> tuple[Picture, np.ndarray]:
    picture = Picture(backdrop, show=snapshot.pop("show", SHOWN))  # type: ignore[arg-type]
    picture.add_robot("r1", SQUARE)
    values = {"time": 0.0, "poses": np.array([[4.0, 5.0, 0.0]]), "colors": [GREEN]} | snapshot
    return picture, picture.draw(Snapshot(**values))


def bounds(backdrop: Backdrop, pose: list[float]) -> tuple[float, float, float, float]:
    """Left, bottom, right, top in metres of all pixels that a robot at a pose changes."""
    picture, image = one_robot(backdrop, poses=np.array([pose]), show=frozenset())
    _, away = one_robot(backdrop, poses=np.array([[1e4, 1e4, 0.0]]), show=frozenset())
    rows, columns = np.nonzero((image != away).any(axis=2))
    p = picture.projection
    return (
        (columns.min() - p.left) / p.scale,
        (p.bottom - rows.max() - 1) / p.scale,
        (columns.max() + 1 - p.left) / p.scale,
        (p.bottom - rows.min()) / p.scale,
    )


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


def test_who_has_settled_has_no_fan(arena: Backdrop) -> None:
    scan = Scan(0, (4.0, 5.0, 0.0), np.pi, np.full(181, 3.0))
    still = one_robot(arena, settled=[True])[1]
    assert (one_robot(arena, scans=[scan], settled=[True])[1] == still).all()


def test_paint_lies_above_fans(arena: Backdrop) -> None:
    cells = np.zeros((420, 320), np.int16)
    cells[100:110] = 2
    scan = Scan(0, (4.0, 5.0, 0.0), np.pi, np.full(181, 3.0))
    picture, bare = one_robot(arena, floor=cells, resolution=0.05)
    _, image = one_robot(arena, floor=cells, resolution=0.05, scans=[scan])
    assert pixel(picture, image, 6.3, 5.25) == pixel(picture, bare, 6.3, 5.25)
    assert pixel(picture, image, 6.3, 5.7) != pixel(picture, bare, 6.3, 5.7)


@pytest.mark.parametrize(
    ("robots", "inside", "at_all"), [(8, True, True), (9, False, True), (21, False, False)]
)
def test_fans_of_many_robots_are_edges_and_of_more_are_none(
    arena: Backdrop, robots: int, inside: bool, at_all: bool
) -> None:
    poses = np.array([[0.7 + 0.7 * k, 18.0, 0.0] for k in range(robots)])
    scan = Scan(0, (4.0, 5.0, 0.0), np.pi, np.full(181, 3.0))
    images = []
    for scans in ([], [scan]):
        picture = Picture(arena)
        for robot in range(robots):
            picture.add_robot(f"r{robot}", 0.3)
        images.append(picture.draw(Snapshot(0.0, poses, [GREEN] * robots, scans=scans)))
    assert (pixel(picture, images[0], 6.3, 5.7) != pixel(picture, images[1], 6.3, 5.7)) == inside
    assert (images[0] != images[1]).any() == at_all


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


def test_what_a_blobfinder_sees_stands_around_its_robot(arena: Backdrop) -> None:
    sighting = Sighting(
        0, (4, 5, np.pi / 2), np.array([[-0.5, 0.5], [0.6, 1.5]]), np.array([0xFF0000, 0x0000FF])
    )
    picture = Picture(arena, show=frozenset({"blobs"}))
    picture.add_robot("r1", 0.5)
    snapshot = Snapshot(0.0, np.array([[4.0, 5.0, 0.0]]), [GREEN], sightings=[sighting])
    image = picture.draw(snapshot)
    column, row = picture.projection.edges(np.array([4.0, 5.0]))
    for color, bearing in ((0xFF0000, 0.0), (0x0000FF, 1.0)):
        rows, columns = np.nonzero((image == bgr(color)).all(axis=2))
        bearings = np.arctan2(row - rows - 0.5, columns + 0.5 - column) - np.pi / 2
        assert abs(bearings.mean() - bearing) < 0.1
        assert (
            np.hypot(rows + 0.5 - row, columns + 0.5 - column) > picture.projection.scale / 2
        ).all()


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


def test_a_fan_shades_what_it_sees_and_nothing_else(arena: Backdrop) -> None:
    scan = Scan(0, (4.0, 5.0, 0.0), np.pi, np.full(181, 3.0))
    _, bare = one_robot(arena)
    picture, image = one_robot(arena, scans=[scan])
    for x, y in ((6.6, 5.3), (4.3, 7.6), (4.3, 2.4)):
        assert pixel(picture, image, x, y) != pixel(picture, bare, x, y)
    for x, y in ((7.4, 5.3), (3.2, 5.3), (3.7, 6.4), (6.5, 7.5)):
        assert pixel(picture, image, x, y) == pixel(picture, bare, x, y)


def test_a_full_circle_of_rays_shades_all_around(arena: Backdrop) -> None:
    scan = Scan(0, (4.0, 5.0, 1.0), 2 * np.pi, np.full(361, 2.0))
    _, bare = one_robot(arena)
    picture, image = one_robot(arena, scans=[scan])
    for x, y in ((5.5, 5.3), (2.5, 5.3), (4.3, 6.5), (4.3, 3.5)):
        assert pixel(picture, image, x, y) != pixel(picture, bare, x, y)


@pytest.mark.parametrize("ranges", [[], [3.0], [np.inf] * 20, [np.nan] * 20, [0.0] * 20])
def test_odd_readings_are_drawn_without_complaint(arena: Backdrop, ranges: list[float]) -> None:
    picture, image = one_robot(arena, scans=[(0, (4, 5, 0), np.pi, np.array(ranges))])
    assert pixel(picture, image, 3.7, 5.0) == list(bgr(soften(GREEN)))


def test_painted_floor_has_the_painters_tint(arena: Backdrop) -> None:
    cells = np.zeros((420, 320), np.int16)
    cells[200:220, 100:120] = 3  # x 5 to 6, y 10 to 11
    picture, image = one_robot(arena, floor=cells, resolution=0.05)
    blue, green, red = pixel(picture, image, 5.4, 10.4)
    assert green > red  # robot 2's tint is a bluish green
    assert green > blue
    assert pixel(picture, image, 6.4, 10.4) == list(bgr(GROUND))
    assert pixel(picture, image, 5.4, 9.4) == list(bgr(GROUND))
    assert tint(2) == 0x009E73


def test_a_trail_stays_behind_a_robot_that_moves(arena: Backdrop) -> None:
    picture = Picture(arena)
    picture.add_robot("r1", SQUARE)
    for step in range(10):
        image = picture.draw(Snapshot(step / 10, np.array([[3.0 + step / 2, 5.27, 0]]), [GREEN]))
    column, row = picture.projection.edges(np.array([5.3, 5.27])).astype(int)
    assert (image[row - 1 : row + 2, column] != bgr(GROUND)).any()
    far = picture.draw(Snapshot(2.0, np.array([[3.0, 15.27, 0]]), [GREEN]))
    for step in range(200):
        far = picture.draw(Snapshot(3 + step, np.array([[3.0, 15.27, 0]]), [GREEN]))
    assert (far[row - 1 : row + 2, column] == bgr(GROUND)).all()


def test_a_robot_that_comes_later_leaves_no_trail_from_nowhere(arena: Backdrop) -> None:
    picture = Picture(arena)
    picture.add_robot("r1", 0.3)
    for step in range(5):
        picture.draw(Snapshot(step / 10, np.array([[3.3, 5.3, 0]]), [GREEN]))
    picture.add_robot("r2", 0.3)
    poses = np.array([[3.3, 5.3, 0], [12.3, 15.3, 0]])
    image = picture.draw(Snapshot(1.0, poses, [GREEN, GREEN]))
    again = Picture(arena)
    again.add_robot("r1", 0.3)
    again.add_robot("r2", 0.3)
    assert (image == again.draw(Snapshot(1.0, poses, [GREEN, GREEN]))).all()


def test_what_is_said_appears_over_the_robot_and_goes_away(arena: Backdrop) -> None:
    picture, silent = Picture(arena, speech_time=5.0), Picture(arena)
    for each in (picture, silent):
        each.add_robot("r1", SQUARE)
    poses = np.array([[8.0, 10.0, 0.0]])

    def differs(time: float, said: str, said_at: float) -> np.ndarray:
        snapshot = Snapshot(time, poses, [GREEN], said=[said], said_at=[said_at])
        image = picture.draw(snapshot)
        bare = silent.draw(Snapshot(time, poses, [GREEN]))
        return np.nonzero((image != bare).any(axis=2))[0]

    row = picture.projection.edges(poses[:, :2])[0, 1]
    assert differs(0.0, "", 0.0).size == 0
    rows = differs(1.0, "at goal", 1.0)
    assert rows.size > 0
    assert rows.max() < row
    assert differs(5.9, "at goal", 1.0).size > 0
    assert differs(6.1, "at goal", 1.0).size == 0
    assert differs(7.0, "at goal", 7.0).size > 0  # said again
    assert differs(7.1, "", 7.1).size == 0


@pytest.mark.parametrize("place", [(0.1, 0.1), (15.9, 20.9), (0.1, 20.9), (-50.0, 3.0)])
@pytest.mark.parametrize("said", ["ok", "a very long sentence " * 10, "zwölf 中 \n\t\x00\ud800😀"])
def test_anything_may_be_said_anywhere(
    arena: Backdrop, place: tuple[float, float], said: str
) -> None:
    picture, image = one_robot(arena, poses=np.array([[*place, 0.0]]), said=[said])
    _, silent = one_robot(arena, poses=np.array([[*place, 0.0]]))
    visible = place[0] > 0
    assert (image != silent).any() == visible
    strip = picture.projection.field_height
    assert (image[strip:] == silent[strip:]).all()


def test_names_are_written_below_their_robots(arena: Backdrop) -> None:
    images = []
    for name in ("r1", "r2"):
        picture = Picture(arena)
        picture.add_robot(name, SQUARE)
        images.append(picture.draw(Snapshot(0.0, np.array([[8.0, 10.0, 0]]), [GREEN])))
    rows, columns = np.nonzero((images[0] != images[1]).any(axis=2))
    column, row = picture.projection.edges(np.array([8.0, 9.5]))
    assert rows.min() > row
    assert abs(columns.mean() - column) < 15


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


def test_every_kind_of_drawing_is_shown(arena: Backdrop) -> None:
    drawings = [
        Drawing("points", np.array([[2.0, 2.0]]), 0x123456),
        Drawing("polyline", np.array([[8.0, 2.0], [8.0, 4.0], [10, 4]]), 0x123456),
        Drawing("multiline", np.array([[8.0, 6.0], [10, 6], [8, 8], [10, 8]]), 0x123456),
        Drawing(
            "polygon", np.array([[2.0, 10], [4, 10], [4, 12], [2, 12]]), 0x123456, True, 0x654321
        ),
        Drawing("polygon", np.array([[2.0, 14], [4, 14], [4, 16], [2, 16]]), 0x123456),
    ]
    picture, image = one_robot(arena, drawings=drawings)
    p = picture.projection

    def near(x: float, y: float) -> np.ndarray:
        column, row = p.edges(np.array([x, y])).astype(int)
        return image[row - 2 : row + 3, column - 2 : column + 3].reshape(-1, 3).astype(int)

    def drawn(x: float, y: float) -> bool:
        # A thin line between two rows of pixels has half its colour in each.
        return bool((np.abs(near(x, y) - bgr(0x123456)).sum(axis=1) < 330).any())

    for x, y in ((2, 2), (8, 3), (9, 4), (9, 6), (9, 8), (2, 11), (2, 15)):
        assert drawn(x, y), (x, y)
    assert not drawn(8.4, 7)  # multiline: the second and third point are not joined
    assert pixel(picture, image, 3, 11) == list(bgr(0x654321))
    assert not drawn(3.4, 15.4)


def test_an_unknown_drawing_is_an_error(arena: Backdrop) -> None:
    with pytest.raises(ValueError, match="spiral"):
        one_robot(arena, drawings=[Drawing("spiral", np.zeros((3, 2)))])  # type: ignore[arg-type]


def test_drawings_without_enough_points_show_nothing(arena: Backdrop) -> None:
    none = [Drawing(kind, np.empty((0, 2))) for kind in ("points", "polyline", "multiline")]
    few = [Drawing("polyline", np.ones((1, 2))), Drawing("polygon", np.ones((2, 2)))]
    assert (one_robot(arena, drawings=[*none, *few])[1] == one_robot(arena)[1]).all()


def test_poses_must_be_as_many_as_robots(arena: Backdrop) -> None:
    with pytest.raises(ValueError, match="1 robots were added, but 2 poses"):
        one_robot(arena, poses=np.zeros((2, 3)), colors=[1, 2])
    with pytest.raises(ValueError, match="1 bodies need 1 colors"):
        one_robot(arena, colors=[1, 2])


def test_the_status_line_shows_time_and_coverage(arena: Backdrop) -> None:
    picture, image = one_robot(arena)
    strip = picture.projection.field_height
    for change in ({"time": 1.0}, {"coverage": 0.5}):
        other = one_robot(arena, **change)[1]
        assert (other[strip:] != image[strip:]).any(), change
        assert (other[:strip] == image[:strip]).all(), change


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
