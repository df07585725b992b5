"""The page in a real browser: it draws what the run knows, and its hands reach the run."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import browsing
import numpy as np
import pytest
from browsing import Page
from watching import Watched, watched

from sim.build import load

pytestmark = browsing.NEEDED
NOTE = """() => {
  const box = document.getElementById("notices");
  window.noticed = [];
  new MutationObserver(() => noticed.push(box.textContent)).observe(box, { childList: true });
}"""


def test_the_page_draws_what_the_run_knows(page: Page, run: Watched) -> None:
    poses = page.get("Array.from(troupe.state.poses)")
    assert poses == pytest.approx([2, 2, np.pi / 2, 8, 2, 0], abs=1e-6)
    assert page.get("troupe.state.names") == ["anna", "berta"]
    page.page.evaluate("troupe.toggle('sensors'); troupe.changed()")
    page.until("(t) => !t.dirty")
    red, green, blue = page.pixel(2 - 0.3, 2 - 0.3)  # in anna's body, beside her arrow
    assert green > red + 60
    assert green > blue + 60
    red, green, blue = page.pixel(5, 4)  # the blue wall
    assert blue > red + 60
    red, green, blue = page.pixel(8, 6)  # the orange thing
    assert red > green > blue
    ground = page.pixel(1.3, 0.7)
    assert min(ground) > 240


def test_pause_holds_the_tick_and_step_moves_one(page: Page) -> None:
    page.page.keyboard.press(".")
    page.until("(t) => t.state.tick === 1")
    page.page.click("#step")
    page.until("(t) => t.state.tick === 2")
    page.page.keyboard.press("p")
    page.until("(t) => t.state.tick > 10 && !t.state.status.paused")
    page.page.keyboard.press("p")
    page.until("(t) => t.state.status.paused")
    tick = page.get("troupe.state.tick")
    moments = page.get("troupe.state.moments")
    page.until("(t, then) => t.state.moments > then", moments)
    assert page.get("troupe.state.tick") == tick
    assert "Paused" in page.page.inner_text("#state")


def test_keys_set_the_pace_as_in_stage(page: Page) -> None:
    for key, pace in (("{", 1), ("]", 2), ("[", 1), ("[", 0.5), ("}", None)):
        page.page.keyboard.press(key)
        page.until("(t, pace) => t.state.status.pace === pace", pace)


def test_the_floor_is_panned_the_wheel_zooms_and_space_shows_all(page: Page) -> None:
    start = page.get("[troupe.camera.x, troupe.camera.y, troupe.camera.scale]")
    page.drag((1, 0.7), (3, 0.7))
    x, _, scale = page.get("[troupe.camera.x, troupe.camera.y, troupe.camera.scale]")
    assert x == pytest.approx(start[0] - 2, abs=0.05)
    assert scale == start[2]
    page.page.mouse.move(*page.place(8, 2))
    before = page.place(8, 2)
    page.page.mouse.wheel(0, -300)
    page.until("(t, scale) => t.camera.scale > scale", scale)
    assert page.place(8, 2) == pytest.approx(before, abs=1)  # what lies under the pointer stays
    page.page.keyboard.press("Space")
    assert page.get("[troupe.camera.x, troupe.camera.y, troupe.camera.scale]") == start


def test_clicks_select_and_a_card_tells_what_a_robot_knows(page: Page) -> None:
    page.page.mouse.click(*page.place(2, 2))
    page.until("(t) => t.state.cards[0] !== undefined && document.querySelector('#card h2')")
    card = page.page.inner_text("#card")
    for text in ("anna", "2.00, 2.00 m, 90.0°", "laser: nearest", "bumper: 0 of 4 closed",
                 "fiducial", "blobfinder", "Drive it"):  # fmt: skip
        assert text in card
    page.page.keyboard.down("Shift")
    page.page.mouse.click(*page.place(8, 2))
    page.page.keyboard.up("Shift")
    assert page.get("[...troupe.view.selected]") == [0, 1]
    page.page.mouse.click(*page.place(1, 0.7))
    assert page.get("[...troupe.view.selected]") == []


def test_the_world_is_saved_as_it_stands(page: Page, still: Path) -> None:
    page.drag((2, 2), (2, 6))
    page.until("(t) => Math.abs(t.state.poses[1] - 6) < 0.1")
    with page.page.expect_download() as waiting:
        page.page.click("#world")
    saved = load(shutil.copy(waiting.value.path(), still))
    assert saved.start == pytest.approx(
        np.array(page.get("Array.from(troupe.state.poses)")).reshape(2, 3), abs=1e-4
    )
    with page.page.expect_download() as waiting:
        page.page.click("#picture")
    assert waiting.value.suggested_filename == "troupe-0.0.png"
    picture = browsing.image(Path(waiting.value.path()).read_bytes())
    column, row = page.get("[troupe.camera.column(5), troupe.camera.row(4)]")
    red, _, blue = (int(part) for part in picture[round(row), round(column)])
    assert blue > red + 60  # the wall


def test_which_sensors_show_is_chosen_by_kind(page: Page) -> None:
    page.page.evaluate("troupe.hands.select([0])")
    page.until("(t) => t.state.cards[0] !== undefined && t.drawn === t.state.moments")
    inside = page.pixel(2.7, 4.2)  # in anna's fan
    page.page.keyboard.press("D")
    page.page.uncheck("input[name=lasers]")
    page.page.uncheck("input[name=sonars]")
    page.until("(t) => !t.dirty")
    assert page.pixel(2.7, 4.2) != inside
    assert min(page.pixel(2.7, 4.2)) > 240


def test_everything_can_be_done_by_keys_alone(page: Page) -> None:
    for key in (",", ","):
        page.page.keyboard.press(key)
    assert page.get("[...troupe.view.selected]") == [1]
    page.page.keyboard.press("Shift+ArrowUp")
    page.until("(t) => Math.abs(t.state.poses[4] - 2.1) < 1e-5")
    page.page.keyboard.press("q")
    page.until("(t) => Math.abs(t.state.poses[5] - 0.1) < 1e-5")
    page.page.keyboard.press("?")
    assert page.page.is_visible("#help")
    page.page.keyboard.press("Escape")
    assert not page.page.is_visible("#help")
    page.page.keyboard.press("d")
    assert page.get("troupe.view.show.sensors") is False


def test_nothing_is_loaded_from_elsewhere_and_nothing_complained_of(
    page: Page, run: Watched
) -> None:
    page.page.mouse.click(*page.place(2, 2))
    page.page.keyboard.press("p")
    page.until("(t) => t.state.tick > 20")
    page.page.click("#looks")
    page.until("(t) => !t.dirty")
    assert page.complaints == []
    assert [url for url in page.requests if not url.startswith((run.address, "data:"))] == []


@pytest.mark.parametrize("looks", ["light", "dark"])
@pytest.mark.parametrize("width", [1100, 390])
def test_axe_finds_nothing_that_shuts_people_out(
    browser: Any, run: Watched, looks: str, width: int
) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    context = browser.new_context(
        viewport={"width": width, "height": 800}, color_scheme=looks, bypass_csp=True
    )
    page = Page(context.new_page(), run.address)
    page.page.evaluate("troupe.hands.select([0])")
    page.until("(t) => t.state.cards[0] !== undefined")
    page.page.keyboard.press("?")
    found = axe.Axe().run(page.page)
    assert found.violations_count == 0, found.generate_report()
    assert page.get("document.documentElement.scrollWidth") <= width
    context.close()


def test_the_run_begins_again_with_another_seed(page: Page) -> None:
    page.page.keyboard.press(".")
    page.until("(t) => t.state.tick === 1")
    page.page.evaluate(NOTE)
    page.page.fill("#seed", "twelve")
    page.page.press("#seed", "Enter")
    page.until("() => noticed.some((line) => line.includes('whole number'))")
    page.page.fill("#seed", "12")
    page.page.press("#seed", "Enter")
    page.until("(t) => t.state.tick === 0 && t.state.status.seed === 12")
    assert page.get("document.getElementById('seed').value") == "12"


def test_when_the_run_is_over_the_page_says_so(browser: Any, still: Path) -> None:
    with watched(still, paused=True, duration=1.0) as run:
        context = browser.new_context()
        page = Page(context.new_page(), run.address)
        page.page.keyboard.press("p")
        page.until("() => document.getElementById('state').textContent.includes('over')")
        assert "completed" in page.page.inner_text("#state")
        assert page.get("troupe.state.time") == 1.0
        context.close()
