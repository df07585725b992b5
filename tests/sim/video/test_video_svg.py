"""A picture as SVG: the same things in the same places as in pixels."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from video_arenas import SQUARE

from sim.video import Backdrop, Drawing, Scan, Sighting, Snapshot
from sim.video.errors import VideoError
from sim.video.layers import LAYERS
from sim.video.paint import rectangles_of
from sim.video.palette import tint
from sim.video.picture import Picture, save_picture

SVG = "{http://www.w3.org/2000/svg}"


def painted() -> np.ndarray:
    cells = np.zeros((420, 320), np.int16)
    cells[40:80, 20:200] = 1
    cells[60:100, 150:300] = 2
    return cells


def full(arena: Backdrop) -> tuple[Picture, Snapshot]:
    """A picture and a snapshot with something of everything."""
    picture = Picture(arena, axes=True, show=frozenset(LAYERS))
    picture.add_robot("r<1>", SQUARE)
    picture.add_robot("r2", 0.4)
    picture.composer.mark(0.0, np.array([[3.0, 5.0, 0.0], [9.0, 9.0, 0.0]]))
    snapshot = Snapshot(
        12.5,
        np.array([[4.0, 5.0, 0.5], [9.0, 9.0, 2.0]]),
        [0x00FF00, 0x123456],
        coverage=0.25,
        said=["5 > 3 & 2 \ud800", ""],
        settled=[False, True],
        scans=[Scan(0, (4.0, 5.0, 0.5), np.pi, np.full(181, 3.0))],
        sightings=[Sighting(0, (4, 5, 0.5), np.array([[-0.5, 0.5]]), np.array([0xFF0000]))],
        floor=painted(),
        resolution=0.05,
        movables=[(SQUARE, 0x777777)],
        movable_poses=np.array([[12.0, 12.0, 0.3]]),
        drawings=[
            Drawing("points", np.array([[2.0, 2.0]]), 0x102030),
            Drawing("polyline", np.array([[8.0, 2.0], [8.0, 4.0]]), 0x203040),
            Drawing("multiline", np.array([[8.0, 6.0], [10, 6]]), 0x304050),
            Drawing("polygon", np.array([[2.0, 10], [4, 10], [4, 12]]), 0x405060, True, 0x506070),
        ],
    )
    return picture, snapshot


def corners(data: str) -> np.ndarray:
    return np.array(re.findall(r"(-?[\d.]+) (-?[\d.]+)", data), float)


def test_the_document_is_sound_and_says_what_the_frame_says(arena: Backdrop) -> None:
    picture, snapshot = full(arena)
    document = ET.fromstring(picture.svg(snapshot))
    assert document.get("viewBox") == "0 0 640 840"
    texts = [element.text for element in document.iter(f"{SVG}text")]
    for words in ("12.5 s", "painted 25.0 %", "2 robots", "r<1>", "r2", "5 > 3 & 2", "16 m"):
        assert words in texts, texts


def test_bodies_stand_where_their_poses_say(arena: Backdrop) -> None:
    picture, snapshot = full(arena)
    document = ET.fromstring(picture.svg(snapshot))
    found = [
        corners(element.get("d", ""))
        for element in document.iter(f"{SVG}path")
        if element.get("fill") == f"#{tint(0):06x}" and "fill-opacity" not in element.attrib
    ]
    turn = np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    wanted = picture.projection.edges(SQUARE @ turn.T + [4.0, 5.0])
    assert np.allclose(found[0], wanted, atol=0.01)  # hundredths of a pixel are written


def test_all_that_is_drawn_is_in_the_document(arena: Backdrop) -> None:
    picture, snapshot = full(arena)
    text = picture.svg(snapshot)
    for color in ("#102030", "#203040", "#304050", "#405060", "#506070", "#ff0000", "#e9e7e1"):
        assert (color in text) == (color != "#e9e7e1"), color


def test_paint_becomes_few_rectangles_that_cover_just_what_is_painted() -> None:
    cells = painted()
    again = np.zeros_like(cells)
    count = 0
    for owner, rectangles in rectangles_of(cells):
        for row, column, rows, columns in rectangles:
            assert (again[row : row + rows, column : column + columns] == 0).all()
            again[row : row + rows, column : column + columns] = owner
            count += 1
    assert (again == cells).all()
    assert count == 3


def test_random_paint_is_covered_too() -> None:
    cells = np.random.default_rng(1).integers(0, 4, (30, 40)).astype(np.int16)
    again = np.zeros_like(cells)
    for owner, rectangles in rectangles_of(cells):
        for row, column, rows, columns in rectangles:
            assert (again[row : row + rows, column : column + columns] == 0).all()
            again[row : row + rows, column : column + columns] = owner
    assert (again == cells).all()


def test_a_picture_is_written_by_the_ending_of_its_name(arena: Backdrop, tmp_path: Path) -> None:
    picture, snapshot = full(arena)
    save_picture(tmp_path / "a.svg", picture, snapshot)
    save_picture(tmp_path / "a.PNG", picture, snapshot)
    assert (tmp_path / "a.svg").read_text().startswith("<svg ")
    assert (tmp_path / "a.PNG").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(VideoError, match=r"\.png or \.svg"):
        save_picture(tmp_path / "a.gif", picture, snapshot)
