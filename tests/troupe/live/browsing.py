"""A real browser that looks at the page, and what a test asks of it."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any

import cv2
import numpy as np
import pytest

from tests.patience import PATIENCE

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
NEEDED = pytest.mark.skipif(
    CHROMIUM is None or find_spec("playwright") is None, reason="no Chromium or playwright here"
)

UNTIL = """([wanted]) => new Promise((done) => {
  const holds = (%s);
  const look = () => (window.troupe && troupe.state.scene && holds(troupe, wanted))
    ? done() : requestAnimationFrame(look);
  look();
})"""


@contextlib.contextmanager
def chromium(**options: Any) -> Iterator[Any]:
    """A headless Chromium, with options of Playwright's `launch`."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=CHROMIUM,
            args=["--no-sandbox", "--disable-dev-shm-usage"],
            timeout=1000 * PATIENCE,
            **options,
        )
        yield browser
        browser.close()


def image(data: bytes) -> np.ndarray:
    """A picture (height, width, 3), red, green, blue."""
    found = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    return np.asarray(found[:, :, ::-1])


class Page:
    """A browser's page at a run, with all that it has asked for and complained of."""

    def __init__(self, page: Any, address: str) -> None:
        self.page = page
        self.requests: list[str] = []
        self.complaints: list[str] = []
        page.set_default_timeout(1000 * PATIENCE)
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("console", lambda line: self.complaints.append(line.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.goto(address)
        self.until("(t) => t.state.count > 0 && t.drawn === t.state.moments")

    def until(self, holds: str, wanted: Any = None) -> None:
        """Wait until a condition holds of the page's state."""
        self.page.evaluate(UNTIL % holds, [wanted])

    def get(self, expression: str) -> Any:
        return self.page.evaluate(f"() => {expression}")

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Where metres are on the screen."""
        box = self.page.locator("#canvas").bounding_box()
        column, row = self.get(f"[troupe.camera.column({x}), troupe.camera.row({y})]")
        return box["x"] + column, box["y"] + row

    def pixel(self, x: float, y: float) -> list[int]:
        """Red, green and blue at a place of the world, as the screen shows it."""
        column, row = self.place(x, y)
        return [int(part) for part in image(self.page.screenshot())[round(row), round(column)]]

    def drag(self, start: tuple[float, float], end: tuple[float, float], **how: Any) -> None:
        """Drag from one place of the world to another."""
        mouse = self.page.mouse
        mouse.move(*self.place(*start))
        mouse.down(**how)
        (x0, y0), (x1, y1) = self.place(*start), self.place(*end)
        for part in (0.3, 0.6, 1.0):
            mouse.move(x0 + part * (x1 - x0), y0 + part * (y1 - y0))
        mouse.up(**how)
