"""What a frame costs to draw and to encode; `pytest --benchmark-only` runs these."""

from __future__ import annotations

from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from video_arenas import SQUARE, walled

from sim.video import Backdrop, Snapshot
from sim.video.encode import H264Encoder
from sim.video.picture import Picture

GREEN = 0x00FF00


def painters(picture: Picture, cells: np.ndarray, time: float) -> Snapshot:
    """Four painters with fans of 180 rays in 16 x 21 m, at 0.5 m/s, one strip each."""
    poses = []
    for robot in range(4):
        way, lap = 0.5 * time + 3 * robot, 14.6
        across = (way % lap) / lap
        x = 0.7 + lap * (across if int(way // lap) % 2 == 0 else 1 - across)
        y = 0.7 + 5.25 * robot + 0.9 * (int(way // lap) % 5)
        poses.append((x, y, 0.0 if int(way // lap) % 2 == 0 else np.pi))
    scans = []
    for robot, (x, y, yaw) in enumerate(poses):
        cells[
            max(int(y * 20) - 10, 0) : int(y * 20) + 10, max(int(x * 20) - 10, 0) : int(x * 20) + 10
        ] = robot + 1
        bearings = yaw + np.linspace(-np.pi / 2, np.pi / 2, 180)
        with np.errstate(divide="ignore"):
            sideways = (np.where(np.cos(bearings) > 0, 16 - x, -x)) / np.cos(bearings)
            upwards = (np.where(np.sin(bearings) > 0, 21 - y, -y)) / np.sin(bearings)
        ranges = np.minimum(np.minimum(sideways, upwards), 20)
        scans.append((robot, (x, y, yaw), np.pi, ranges))
    return Snapshot(
        time, np.array(poses), [GREEN] * 4, 0.5, ["", "at goal", "", ""], scans=scans, floor=cells
    )


def test_drawing_four_painters(benchmark: Any) -> None:
    picture = Picture(walled(16, 21))
    for robot in range(4):
        picture.add_robot(f"r{robot + 1}", SQUARE)
    cells = np.zeros((420, 320), np.int16)
    out = np.empty((840, 640, 3), np.uint8)
    frames = count()

    def snapshot() -> tuple[tuple[Snapshot, np.ndarray], dict[str, Any]]:
        return (painters(picture, cells, 0.4 * next(frames)), out), {}

    benchmark.pedantic(picture.draw, setup=snapshot, rounds=300, warmup_rounds=20)


def test_drawing_a_thousand_robots(benchmark: Any) -> None:
    picture = Picture(walled(316, 316))
    rng = np.random.default_rng(1)
    for robot in range(1000):
        picture.add_robot(f"r{robot}", SQUARE)
    poses = np.column_stack([rng.uniform(1, 315, (1000, 2)), rng.uniform(-3, 3, 1000)])
    colors = np.full(1000, GREEN)
    out = np.empty((840, 840, 3), np.uint8)
    frames = count()

    def snapshot() -> tuple[tuple[Snapshot, np.ndarray], dict[str, Any]]:
        poses[:, :2] += 0.2 * np.column_stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])])
        scans = [(robot, poses[robot], np.pi, np.full(180, 20.0)) for robot in range(32)]
        return (
            Snapshot(0.4 * next(frames), poses, colors, said=[""] * 1000, scans=scans),
            out,
        ), {}

    benchmark.pedantic(picture.draw, setup=snapshot, rounds=100, warmup_rounds=20)


def test_encoding_four_painters(benchmark: Any, tmp_path: Path) -> None:
    picture = Picture(walled(16, 21))
    for robot in range(4):
        picture.add_robot(f"r{robot + 1}", SQUARE)
    cells = np.zeros((420, 320), np.int16)
    encoder = H264Encoder(tmp_path / "bench.mp4", picture.size, 25)
    frames = count()

    def image() -> tuple[tuple[np.ndarray, int], dict[str, Any]]:
        return (picture.draw(painters(picture, cells, 0.4 * next(frames))), 1), {}

    benchmark.pedantic(encoder.write, setup=image, rounds=200, warmup_rounds=20)
    encoder.close()


def test_making_a_picture_of_a_large_map(benchmark: Any) -> None:
    blocks = [
        (np.array([[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]], float), 0x808080)
        for x in range(100)
        for y in range(100)
        if (x + y) % 2
    ]
    benchmark(Picture, Backdrop((100, 100), blocks))
