"""Pictures and videos of runs on the grid."""

import xml.etree.ElementTree as ET

import av
import cv2
import numpy as np
import pytest

from gridworld import draw
from gridworld.draw import cells_of, entries_of
from gridworld.grid import GridRun
from gridworld.regions import parse, rectangle
from sim.video import cells
from sim.video.errors import VideoError
from sim.video.palette import bgr
from troupe.grid_film import picture_of, record

SVG = "{http://www.w3.org/2000/svg}"


def drawn(run, pixels=None):
    return picture_of(run, "fcdfs", pixels).draw(cells_of(run), entries_of(run))


def colors(run, column, row, pixels):
    """The colours of a map's cell in a picture with a frame of one cell."""
    shows = picture_of(run, pixels=pixels)
    image = shows.draw(cells_of(run), entries_of(run))
    top, left = (row + 1) * pixels, shows.left + (column + 1) * pixels
    tile = image[top : top + pixels, left : left + pixels].reshape(-1, 3)
    return {tuple(color) for color in tile.tolist()}


def test_both_sides_number_the_kinds_alike():
    for name in ("WALL", "FREE", "ARROW", "DOT", "DIAMOND", "DOOR"):
        assert getattr(draw, name) == getattr(cells, name)


def test_walls_robots_and_doors_have_their_colours():
    run = GridRun(parse("S..#\n"), "fcdfs")
    run.advance(5)  # the first has settled at the end, the second moved, the third came in
    assert colors(run, 3, 0, 16) == {bgr(cells.WALL_COLOR)}
    assert bgr(cells.SETTLED) in colors(run, 2, 0, 16)
    assert bgr(cells.ACTIVE) in colors(run, 0, 0, 16)
    assert bgr(cells.DOOR_COLOR) in colors(run, 0, 0, 16)


@pytest.mark.parametrize(
    ("text", "cell", "pull"),
    [
        (".\n.\n.\nS\n", (0, 2), (0, -1)),
        ("S...\n", (1, 0), (1, 0)),
        ("S\n.\n.\n.\n", (0, 1), (0, 1)),
        ("...S\n", (2, 0), (-1, 0)),
    ],
)
def test_arrows_point_in_the_primary_direction(text, cell, pull):
    run = GridRun(parse(text), "fcdfs")
    run.advance(2)
    pixels = 24
    shows = picture_of(run, pixels=pixels)
    image = shows.draw(cells_of(run), entries_of(run))
    top, left = (cell[1] + 1) * pixels, shows.left + (cell[0] + 1) * pixels
    tile = image[top : top + pixels, left : left + pixels]
    ink = (tile == bgr(cells.ACTIVE)).all(axis=2)
    along = ink.sum(axis=1 if pull[0] == 0 else 0)  # its pixels, line by line
    along = along[along > 0][:: -1 if sum(pull) > 0 else 1]  # from the head
    assert along[0] < along[-1] < along.max()  # a tip, a shaft, and a head broader than it


def test_a_frame_stands_around_a_region_that_has_no_walls_of_its_own():
    assert cells_of(GridRun(rectangle(4, 3, [(1, 1)]), "fcdfs")).shape == (5, 6)
    walled = GridRun(parse("#####\n#S..#\n#####\n"), "fcdfs")
    assert cells_of(walled).shape == (3, 5)


def test_a_picture_shows_the_step_asked_for(tmp_path):
    run = GridRun(rectangle(5, 5, [(2, 2)]), "fcdfs")
    record(run, picture=tmp_path / "p.png", at=7, rule="fcdfs")
    other = GridRun(rectangle(5, 5, [(2, 2)]), "fcdfs")
    other.advance(7)
    assert (cv2.imread(str(tmp_path / "p.png")) == drawn(other)).all()
    assert run.outcome().all_settled


def test_an_svg_holds_every_robot_the_step_the_rule_and_a_legend(tmp_path):
    run = GridRun(rectangle(5, 5, [(2, 2)]), "fcdfs")
    record(run, picture=tmp_path / "p.svg", at=9, rule="fcdfs")
    other = GridRun(rectangle(5, 5, [(2, 2)]), "fcdfs")
    other.advance(9)
    root = ET.parse(tmp_path / "p.svg").getroot()
    texts = [element.text for element in root.iter(f"{SVG}text")]
    robots, settled = other.emitted, other.emitted - len(other.at_work)
    for words in ("step 9", f"{robots} robots, {settled} settled", "rule fcdfs", "settled", "door"):
        assert words in texts
    (group,) = (each for each in root.iter(f"{SVG}g") if "scale" in each.get("transform", ""))
    places = {
        (float(each.get("x", "0")), float(each.get("y", "0"))) for each in group.iter(f"{SVG}use")
    }
    wanted = {
        (column + 1.5, row + 1.5)
        for column, row in other.cell_of(other.position[: other.emitted]).tolist()
    }
    assert places == wanted | {(3.5, 3.5)}  # and the door


def test_a_legend_and_the_step_stand_below_the_grid():
    run = GridRun(rectangle(5, 5, [(2, 2)]), "fcdfs")
    shows = picture_of(run, "fcdfs")
    before = drawn(run)
    run.advance(3)
    after = drawn(run)
    height = 7 * shows.pixels
    assert (before[height:] != after[height:]).any()  # the step
    legend = before[height + 30 :]
    assert (legend == bgr(cells.SETTLED)).all(axis=2).any()
    assert (legend == bgr(cells.DOOR_COLOR)).all(axis=2).any()


def test_a_large_region_gets_a_pixel_a_cell():
    run = GridRun(rectangle(1200, 3, [(0, 0)]), "fcdfs")
    run.advance(10)
    shows = picture_of(run)
    assert shows.pixels == 1
    assert drawn(run).shape == (*shows.size[::-1], 3)
    assert shows.size[0] == 1202


def test_a_video_has_a_frame_a_step_and_leaves_the_run_as_it_is(tmp_path):
    region = rectangle(4, 3, [(1, 1)])
    run, silent = GridRun(region, "fcdfs"), GridRun(region, "fcdfs")
    record(run, film=tmp_path / "v.mp4", picture=tmp_path / "p.png", at=9)
    silent.advance(10**6)
    assert run.outcome().figures() == silent.outcome().figures()
    with av.open(str(tmp_path / "v.mp4")) as container:
        frames = list(container.decode(video=0))
        assert container.streams.video[0].codec_context.name == "h264"
    assert len(frames) == 1 + run.steps  # the empty region, and the end of every step
    still = cv2.imread(str(tmp_path / "p.png")).astype(int)
    frame = frames[9].to_ndarray(format="bgr24").astype(int)
    # H.264 at its default quality with halved colour planes: a mean error of a few levels of 255.
    assert np.abs(frame - still).mean() < 6


def test_without_pyav_opencv_steps_in(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    run = GridRun(rectangle(3, 3, [(1, 1)]), "fcdfs")
    record(run, film=tmp_path / "v.mp4")
    capture = cv2.VideoCapture(str(tmp_path / "v.mp4"))
    assert capture.get(cv2.CAP_PROP_FRAME_COUNT) == 1 + run.steps


def test_a_full_disk_ends_the_film_with_a_plain_error(tmp_path):
    path = tmp_path / "v.mp4"
    path.symlink_to("/dev/full")
    with pytest.raises(VideoError, match="No space left"):
        record(GridRun(rectangle(9, 9, [(1, 1)]), "fcdfs"), film=path)
