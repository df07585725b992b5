"""Pictures and videos of runs on the grid."""

import av
import cv2
import numpy as np
import pytest

from gridworld import draw
from gridworld.draw import Painter, record
from gridworld.grid import GridRun
from gridworld.regions import parse, rectangle


def colors(image, column, row, pixels):
    """The colours of a map's cell in a picture, which has a frame of one cell."""
    top, left = (row + 1) * pixels, (column + 1) * pixels
    return {
        tuple(color) for color in image[top : top + pixels, left : left + pixels].reshape(-1, 3)
    }


def test_walls_robots_and_doors_have_their_colours():
    run = GridRun(parse("S..#\n"), "fcdfs")
    run.advance(5)  # the first has settled at the end, the second moved, the third came in
    image = Painter(run, 16).draw(run)
    assert image.shape == (3 * 16, 6 * 16, 3)
    assert colors(image, 3, 0, 16) == {draw.WALL_COLOR}
    assert draw.SETTLED_COLOR in colors(image, 2, 0, 16)
    assert draw.ACTIVE_COLOR in colors(image, 0, 0, 16)
    assert draw.DOOR_COLOR in colors(image, 0, 0, 16)


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
    image = Painter(run, pixels).draw(run)
    top, left = (cell[1] + 1) * pixels, (cell[0] + 1) * pixels
    tile = image[top : top + pixels, left : left + pixels]
    red = (tile == draw.ACTIVE_COLOR).all(axis=2)
    along = red.sum(axis=1 if pull[0] == 0 else 0)  # red pixels, line by line
    along = along[along > 0][:: -1 if sum(pull) > 0 else 1]  # from the head
    assert along[0] < along[-1] < along.max()  # a tip, a shaft, and a head broader than it


def test_a_picture_shows_the_step_asked_for(tmp_path):
    run = GridRun(rectangle(5, 5, [(2, 2)]), "fcdfs")
    record(run, picture=tmp_path / "p.png", at=7)
    other = GridRun(rectangle(5, 5, [(2, 2)]), "fcdfs")
    other.advance(7)
    image = cv2.imread(str(tmp_path / "p.png"))[:, :, ::-1]
    assert (image == Painter(other).draw(other)).all()
    assert run.outcome().all_settled


def test_a_large_region_gets_a_pixel_a_cell():
    run = GridRun(rectangle(1200, 3, [(0, 0)]), "fcdfs")
    run.advance(10)
    assert Painter(run).draw(run).shape == (5, 1202, 3)


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
    still = cv2.imread(str(tmp_path / "p.png"))[:, :, ::-1].astype(int)
    frame = frames[9].to_ndarray(format="rgb24").astype(int)[: still.shape[0], : still.shape[1]]
    # H.264 at crf 20 with halved colour planes: a mean error of a few levels out of 255.
    assert np.abs(frame - still).mean() < 6


def test_without_pyav_opencv_steps_in(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    run = GridRun(rectangle(3, 3, [(1, 1)]), "fcdfs")
    record(run, film=tmp_path / "v.mp4")
    capture = cv2.VideoCapture(str(tmp_path / "v.mp4"))
    assert capture.get(cv2.CAP_PROP_FRAME_COUNT) == 1 + run.steps
