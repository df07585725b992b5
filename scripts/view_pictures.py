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
from tempfile import TemporaryDirectory
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
    """A picture of the page after so many ticks; of a log, at the tick at which it begins."""
    run, address = watch(world)
    try:
        context = browser.new_context(device_scale_factor=1, **looks)
        page = context.new_page()
        page.goto(address)
        page.wait_for_function("() => window.troupe && troupe.state.count > 0")
        page.evaluate(REACHED, ticks if world.partition("#")[0].endswith(".mcap") else 0)
        if robot is not None:
            page.evaluate(CARD, robot)  # now: its waits are timed
        started = page.evaluate("troupe.state.tick")
        for tick in range(started + 4, ticks + 1, 4):  # trails have marks on the way
            page.evaluate("troupe.link.ask({do: 'step', ticks: 4})")
            page.evaluate(REACHED, tick)
        page.evaluate("new Promise(requestAnimationFrame)")
        page.screenshot(path=PICTURES / name)
        context.close()
    finally:
        run.send_signal(signal.SIGINT)
        run.wait()


def main(wanted: list[str]) -> None:
    """All of them, or those whose names are given."""

    def make(world: str, ticks: int, robot: int | None, name: str, **looks: Any) -> None:
        if not wanted or name in wanted:
            take(browser, world, ticks, robot, name, **looks)

    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        raise SystemExit("there is no Chromium here")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        desk, phone = {"width": 1200, "height": 780}, {"width": 390, "height": 780}
        make("wander", 240, 0, "view.png", viewport=desk)
        make(
            "paint_swarm_16", 300, None, "view_phone.png",
            viewport=phone, color_scheme="dark",
        )  # fmt: skip
        make("docs/viewing/hall.yaml", 76, 0, "view_fault.png", viewport=desk)
        with TemporaryDirectory() as folder:
            log = f"{folder}/run.mcap"
            words = ["run", "paint_case_1", "--duration", "100", "--log", log, "--quiet"]
            subprocess.run([sys.executable, "-m", "troupe", *words], cwd=ROOT, check=False)
            make(f"{log}#t=90", 900, 0, "view_log.png", viewport=desk)
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1:])
