"""Makes the pictures of docs/viewing.md: the page as headless Chromium shows it.

Needs the system's Chromium, and the extra `dev` for what drives it.
"""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "pictures"
REACHED = """(tick) => new Promise((done) => {
  const look = () => (window.troupe && troupe.state.tick >= tick && !troupe.dirty)
    ? done() : requestAnimationFrame(look);
  look();
})"""
CARD = """(robot) => new Promise((done) => {
  troupe.hands.select([robot]);
  const look = () => troupe.state.cards[robot] && document.querySelector("#card h2")
    ? requestAnimationFrame(done) : requestAnimationFrame(look);
  look();
})"""


def watch(world: str) -> tuple[subprocess.Popen[str], str]:
    """A run that stands at its beginning, and its page's address."""
    run = subprocess.Popen(
        [sys.executable, "-m", "troupe", "view", world, "--no-open", "--quiet"],
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert run.stderr is not None
    return run, next(m[1] for line in run.stderr if (m := re.search(r"(http://\S+)", line)))


def take(browser: Any, world: str, ticks: int, robot: int | None, name: str, **looks: Any) -> None:
    """A picture of the page after so many ticks."""
    run, address = watch(world)
    try:
        context = browser.new_context(device_scale_factor=1, **looks)
        page = context.new_page()
        page.goto(address)
        page.evaluate(REACHED, 0)
        for tick in range(4, ticks + 1, 4):  # trails have marks on the way
            page.evaluate("troupe.link.ask({do: 'step', ticks: 4})")
            page.evaluate(REACHED, tick)
        if robot is not None:
            page.evaluate(CARD, robot)
        page.screenshot(path=PICTURES / name)
        context.close()
    finally:
        run.send_signal(signal.SIGINT)
        run.wait()


def main() -> None:
    """All of them."""
    found = filter(None, map(shutil.which, ("chromium", "chromium-browser")))
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=next(found), args=["--no-sandbox"])
        desk, phone = {"width": 1200, "height": 780}, {"width": 390, "height": 780}
        take(browser, "wander", 240, 0, "view.png", viewport=desk)
        take(
            browser, "paint_swarm_16", 300, None, "view_phone.png",
            viewport=phone, color_scheme="dark",
        )  # fmt: skip
        browser.close()


if __name__ == "__main__":
    main()
