"""What a frame shows besides bodies: what robots perceive, say, draw and leave behind."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import GREEN, one_robot, pixel
from video_arenas import SQUARE

from sim.video import Backdrop, Drawing, Scan, Sighting, Snapshot
from sim.video.ground import soften
from sim.video.palette import GROUND, bgr, tint
from sim.video.picture import Picture


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


def test_the_status_line_shows_time_and_coverage(arena: Backdrop) -> None:
    picture, image = one_robot(arena)
    strip = picture.projection.field_height
    for change in ({"time": 1.0}, {"coverage": 0.5}):
        other = one_robot(arena, **change)[1]
        assert (other[strip:] != image[strip:]).any(), change
        assert (other[:strip] == image[:strip]).all(), change
