"""How many pictures a second the page of the live view draws, and what they cost the run's process.

Headless Chromium without a graphics card looks at robots that all move: 1000, 10,000, 1000 on a map
of 2000 x 2000 cells, and 16 that paint a floor of so many. Moments are made as fast as the page
takes them, 30 a second at the most; what is counted are the pictures that it has drawn. Needs the
system's Chromium, and the extra `dev`.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, sleep, thread_time
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
COUNT = """(seconds) => new Promise((done) => {
  const { painter, state } = troupe, draw = painter.draw.bind(painter);
  let drawn = 0, frames = 0, busy = 0;
  painter.draw = (...told) => {
    const began = performance.now();
    draw(...told);
    drawn += 1;
    busy += performance.now() - began;
  };
  const began = performance.now();
  const look = (now) => {
    frames += 1;
    if (now - began < 1000 * seconds) { requestAnimationFrame(look); return; }
    painter.draw = draw;
    const passed = (now - began) / 1000;
    done([drawn / passed, frames / passed, busy / Math.max(drawn, 1)]);
  };
  requestAnimationFrame(look);
})"""
PAN = """(goes) => {
  clearInterval(troupe.panning);
  let k = 0;
  const pan = () => { troupe.camera.pan(3 * Math.sign(Math.sin(++k / 20)), 1); troupe.changed(); };
  if (goes) troupe.panning = setInterval(pan, 33);
}"""
NEAR = """(metres) => {
  const { camera } = troupe;
  camera.zoom(camera.width / metres / camera.scale);
  troupe.changed();
}"""


class Source(threading.Thread):
    """Makes moments of robots that go round in circles, whenever one is due."""

    def __init__(self, loaded: Any, exchange: Any, paints: bool) -> None:
        from sim.view.moment import Robot  # noqa: PLC0415 - after the path is set
        from troupe.live.scene import scene_of  # noqa: PLC0415

        super().__init__(daemon=True)
        self.loaded, self.exchange, self.going = loaded, exchange, True
        self.paints = paints
        self.scene = scene_of(loaded, seed=1, duration=100.0, again=False)
        self.robots = [Robot(robot.name, robot.model) for robot in loaded.robots]
        self.cost, self.moments = 0.0, 0
        self.floor: Any = None

    def painted(self, poses: Any) -> Any:
        """The floor, with a square of cells painted about each robot; None: nobody paints."""
        if not self.paints:
            return None
        floor = self.scene.about["floor"]
        if self.floor is None:
            self.floor = np.zeros((floor["rows"], floor["columns"]), np.int16)
        cells = (poses[:, :2] / floor["resolution"]).astype(int)
        for robot, (column, row) in enumerate(cells.tolist(), 1):
            self.floor[row - 2 : row + 3, column - 2 : column + 3] = robot
        return self.floor.copy()

    def run(self) -> None:
        from sim.view.moment import Moment  # noqa: PLC0415

        start = self.loaded.start
        count = len(start)
        colors = np.array([0x00A000 + 40 * (k % 3) for k in range(count)], np.uint32)
        self.exchange.show(self.scene)
        tick = 0
        while self.going:
            if not self.exchange.due and tick:
                sleep(0.001)
                continue
            began = thread_time()
            tick += 1
            time = 0.1 * tick
            turned = start[:, 2] + 0.1 * tick
            way = np.column_stack([np.cos(turned), np.sin(turned), turned / 0.3])
            poses = (start + 0.3 * way).astype(np.float32)
            status = {"paused": False, "pace": 1.0, "seed": 1, "waiting": [], "running": count}
            states = np.zeros(count, np.uint8)
            moment = Moment(
                time, tick, poses, colors, states, self.robots, paint=self.painted(poses),
                status=status,
            )  # fmt: skip
            self.exchange.offer(moment, 0.0, idle=True)
            self.cost += thread_time() - began
            self.moments += 1


def crowd(count: int, side: float) -> dict[str, Any]:
    """A world of robots in rows and columns."""
    columns = int(np.ceil(np.sqrt(count)))
    step = side / (columns + 1)
    places = [(1 + k % columns, 1 + k // columns) for k in range(count)]
    return {
        "size": [side, side],
        "models": {
            "rover": {"body": {"shape": "circle", "radius": 0.3}, "drive": {}},
            "cart": {"body": {"shape": "box", "size": [0.7, 0.5]}, "drive": {}},
        },
        "robots": [
            {"model": "cart" if k % 2 else "rover", "pose": [step * x, step * y, 7 * k % 360]}
            for k, (x, y) in enumerate(places)
        ],
    }


def mapped(folder: Path, cells: int, count: int, side: float) -> dict[str, Any]:
    """The same on a map: rooms, and clutter that the robots' places are kept free of."""
    random = np.random.default_rng(1)
    walls = np.zeros((cells, cells), bool)
    for at in range(0, cells, cells // 20):
        walls[at : at + 3] = True
        walls[:, at : at + 3] = True
        for door in random.integers(0, cells, 60):
            walls[max(0, at - 1) : at + 4, door : door + 25] = False
            walls[door : door + 25, max(0, at - 1) : at + 4] = False
    rows, columns = random.integers(0, cells - 4, (2, 20_000))
    for row, column in zip(rows, columns, strict=True):
        walls[row : row + random.integers(1, 4), column : column + random.integers(1, 4)] = True
    world = crowd(count, side)
    free = 1.0 / (side / cells)
    for robot in world["robots"]:
        x, y, _ = robot["pose"]
        column, row = x / side * cells, cells - y / side * cells
        walls[
            int(max(0, row - free)) : int(row + free) + 1,
            int(max(0, column - free)) : int(column + free) + 1,
        ] = False
    image = np.where(walls, 0, 255).astype(np.uint8)
    path = folder / "map.pgm"
    path.write_bytes(b"P5 %d %d 255\n" % (cells, cells) + image.tobytes())
    del world["size"]
    world["map"] = {"file": str(path), "resolution": side / cells}
    return world


def rates(
    browser: Any, world: dict[str, Any], seconds: float, looks: list[Any], paints: bool = False
) -> None:
    """Measure and tell."""
    from sim.build import load_data  # noqa: PLC0415
    from troupe.live.exchange import Exchange  # noqa: PLC0415
    from troupe.live.server import LiveServer  # noqa: PLC0415

    began = monotonic()
    loaded = load_data(world)
    exchange = Exchange()
    server = LiveServer(exchange)
    server.open("127.0.0.1", 0)
    source = Source(loaded, exchange, paints)
    solids = f"{len(source.scene.solids)} solids, " if len(source.scene.solids) > 10 else ""
    print(f"{len(loaded.robots)} robots, {solids}loaded in {monotonic() - began:.1f} s")
    source.start()
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    page = context.new_page()
    began = monotonic()
    page.goto(server.address)
    page.wait_for_function("() => window.troupe && troupe.drawn > 0")
    print(f"  first picture after {monotonic() - began:.1f} s")
    for name, script, told in looks:
        if script:
            page.evaluate(script, told)
        page.evaluate(COUNT, 1)
        before, spent = source.moments, server._spent
        cost = source.cost
        drawn, frames, busy = page.evaluate(COUNT, seconds)
        made = max(source.moments - before, 1)
        print(
            f"  {name}: {drawn:.1f} pictures/s ({frames:.0f} frames/s), drawing takes "
            f"{busy:.1f} ms; a moment takes {1e3 * (source.cost - cost) / made:.2f} ms to make "
            f"here, {1e3 * (server._spent - spent) / made:.2f} ms to send"
        )
        if "--shots" in sys.argv:
            page.screenshot(path=f"/tmp/view_rates_{len(loaded.robots)}_{name.split()[0]}.png")
    context.close()
    source.going = False
    source.join()
    server.close()


def main() -> None:
    """All of them."""
    told = argparse.ArgumentParser(description=__doc__)
    told.add_argument("--seconds", type=float, default=5.0, help="of each measurement")
    told.add_argument("--only", default="1000 10000 map paint", help="which of them")
    told.add_argument("--shots", action="store_true", help="pictures into /tmp")
    given = told.parse_args()
    found: Callable[[str], str | None] = shutil.which
    chromium = found("chromium") or found("chromium-browser")
    if chromium is None:
        raise SystemExit("there is no Chromium here")
    looks = [
        ("whole world", None, None),
        ("whole, panned", PAN, True),
        ("20 m wide, panned", NEAR, 20.0),
        ("20 m wide", PAN, False),
    ]
    with TemporaryDirectory() as folder, sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=chromium, args=["--no-sandbox", "--disable-gpu"]
        )
        if "1000" in given.only.split():
            rates(browser, crowd(1000, 100.0), given.seconds, looks)
        if "10000" in given.only.split():
            rates(browser, crowd(10_000, 300.0), given.seconds, looks)
        if "map" in given.only.split():
            rates(browser, mapped(Path(folder), 2000, 1000, 200.0), given.seconds, looks)
        if "paint" in given.only.split():
            painted = {**crowd(16, 100.0), "floor": {"resolution": 0.05}}
            rates(browser, painted, given.seconds, looks, paints=True)
        browser.close()


if __name__ == "__main__":
    main()
