"""A log in a real browser: its time line shows the pose of that time, and can be linked to."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import browsing
import numpy as np
import pytest
from browsing import Page
from test_live_log import Watched, log, watched_log

import troupe

pytestmark = browsing.NEEDED
__all__ = ["log"]  # the fixture


@pytest.fixture
def run(log: Path) -> Iterator[Watched]:
    with watched_log(log) as run:
        yield run


@pytest.fixture
def page(browser: Any, run: Watched) -> Iterator[Page]:
    context = browser.new_context(viewport={"width": 1100, "height": 720}, accept_downloads=True)
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    yield Page(context.new_page(), run.address)
    context.close()


def move_slider(page: Page, time: float) -> None:
    """As a hand does that lets the slider go at a time."""
    page.page.evaluate(
        "(time) => { const slider = document.getElementById('when'); slider.value = time;"
        " slider.dispatchEvent(new Event('input')); }",
        time,
    )


def test_a_page_on_which_nothing_changes_asks_for_no_pictures(page: Page) -> None:
    page.until("(t) => !t.dirty")
    asked = page.get("""(async () => {
      const ask = requestAnimationFrame;
      let asked = 0;
      window.requestAnimationFrame = (what) => { asked += 1; return ask(what); };
      for (let k = 0; k < 3; k++) await new Promise(ask);
      window.requestAnimationFrame = ask;
      return asked;
    })()""")
    assert asked == 0


def test_the_time_line_shows_the_poses_of_that_time(page: Page, log: Path) -> None:
    kept = troupe.Log(log)
    assert page.page.is_visible("#line")
    for time in (9.0, 4.0, 6.5):
        move_slider(page, time)
        tick = round(time / 0.1)
        page.until("(t, tick) => t.state.tick === tick && t.drawn === t.state.moments", tick)
        now = kept.poses[tick - 1]
        now = now[~np.isnan(now[:, 0])]
        poses = page.get("Array.from(troupe.state.poses)")
        assert poses == pytest.approx(now.reshape(-1).tolist(), abs=1e-5)
        assert float(page.get("document.getElementById('when').value")) == pytest.approx(time)
    red, green, blue = page.pixel(*(now[0, :2] - 0.28))  # the edge of anna's body
    assert (red, green, blue) != tuple(page.pixel(9.5, 7.5))


def test_keys_play_step_and_go_back(page: Page) -> None:
    keyboard = page.page.keyboard
    keyboard.press(".")
    page.until("(t) => t.state.tick === 2")
    keyboard.press(">")
    page.until("(t) => t.state.tick === 3")
    keyboard.press("<")
    page.until("(t) => t.state.tick === 2")
    keyboard.press("p")
    page.until("(t) => !t.state.status.paused && t.state.tick > 4")
    assert page.page.inner_text("#go") == "Pause"
    keyboard.press("]")
    page.until("(t) => t.state.status.pace === 2")
    keyboard.press("p")
    page.until("(t) => t.state.status.paused")


def test_what_happened_is_listed_and_leads_there(page: Page) -> None:
    page.page.click("#events summary")
    events = page.page.locator("#happened button").all_inner_texts()
    assert any("anna: half way" in text for text in events)
    assert any("berta: finished" in text for text in events)
    page.page.click("#happened button:has-text('half way')")
    page.until("(t) => Math.abs(t.state.time - 5) < 0.21")
    assert page.get("troupe.state.said.get(0).text") == "half way"


def test_a_mark_on_the_line_leads_there(page: Page) -> None:
    column, row = page.page.evaluate(
        "() => { const canvas = document.getElementById('marks'), { from, until } ="
        " troupe.state.scene.log, [time] = troupe.state.scene.log.said[0];"
        " return [8 + (canvas.clientWidth - 16) * (time - from) / (until - from), 3]; }"
    )
    page.page.click("#marks", position={"x": column, "y": row})
    page.until("(t) => Math.abs(t.state.time - t.state.scene.log.said[0][0]) < 1e-6")


def test_a_link_to_a_moment_leads_to_it(page: Page, run: Watched, browser: Any) -> None:
    move_slider(page, 7.2)
    page.until("(t) => Math.abs(t.state.time - 7.2) < 1e-6")
    page.page.click("#here")
    page.until("() => location.hash === '#t=7.2'")
    page.until("() => document.getElementById('state').textContent.length > 0")
    link = page.page.evaluate("() => navigator.clipboard.readText()")
    assert link == f"{run.view.server.address}#t=7.2"
    move_slider(page, 1.0)
    page.until("(t) => t.state.tick === 10")
    context = browser.new_context()
    other = Page(context.new_page(), link)
    other.until("(t) => t.state.tick === 72")
    context.close()


def test_the_scene_is_saved_as_svg(page: Page) -> None:
    move_slider(page, 6.0)
    page.until("(t) => t.state.tick === 60 && t.drawn === t.state.moments")
    page.page.click("#looks")  # dark, or light again: both can be saved
    with page.page.expect_download() as waiting:
        page.page.click("#svg")
    assert waiting.value.suggested_filename == "troupe-6.0.svg"
    root = ET.parse(waiting.value.path()).getroot()
    space = "{http://www.w3.org/2000/svg}"
    texts = [element.text for element in root.iter(f"{space}text")]
    assert {"anna", "berta", "half way"} <= set(texts)
    assert len(list(root.iter(f"{space}path"))) > 20
    assert len(list(root.iter(f"{space}image"))) == 1  # the paint


FANNED = """async (selected) => {
  const { svgOf } = await import("./save.js");
  const ranges = new Float32Array([2, 2, 2]);
  troupe.state.fans = [{ robot: 0, sensor: 0, x: 3, y: 3, yaw: 0, fov: 1, ranges }];
  troupe.view.selected = new Set(selected);
  return svgOf(troupe);
}"""


def test_paint_lies_over_fans_but_not_over_those_of_who_is_selected(page: Page) -> None:
    move_slider(page, 6.0)
    page.until("(t) => t.state.tick === 60 && t.state.paint")
    for selected in ([], [0]):
        text = page.page.evaluate(FANNED, selected)
        assert (text.index("fill-opacity") > text.index("<image")) == bool(selected)


def test_the_pictures_of_the_page_and_of_the_svg_are_alike(page: Page, browser: Any) -> None:
    page.page.click("#looks") if page.get("troupe.view.dark") else None
    page.until("(t) => !t.dirty")
    text = page.page.evaluate("async () => (await import('./save.js')).svgOf(troupe)")
    box = page.page.locator("#canvas").bounding_box()
    context = browser.new_context(
        viewport={"width": round(box["width"]), "height": round(box["height"])}
    )
    other = context.new_page()
    other.set_content(f"<style>body {{ margin: 0 }}</style>{text}")
    drawn = browsing.image(other.screenshot())
    page.page.evaluate("() => document.querySelectorAll('#layers, #notices').forEach("
                       "(box) => { box.hidden = true; })")  # fmt: skip
    shown = browsing.image(page.page.locator("#canvas").screenshot())
    height, width = (min(a, b) for a, b in zip(drawn.shape[:2], shown.shape[:2], strict=True))
    off = np.abs(drawn[:height, :width].astype(int) - shown[:height, :width]).max(axis=2)
    assert (off > 60).mean() < 0.01
    context.close()


def test_a_log_complains_of_nothing_and_shuts_nobody_out(
    page: Page, run: Watched, browser: Any
) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    for width in (1100, 390):
        context = browser.new_context(viewport={"width": width, "height": 800}, bypass_csp=True)
        other = Page(context.new_page(), run.address)
        other.page.evaluate("troupe.hands.select([0])")
        other.until("(t) => t.state.cards[0] !== undefined")
        other.page.evaluate("document.getElementById('events').open = true")
        found = axe.Axe().run(other.page)
        assert found.violations_count == 0, found.generate_report()
        assert other.get("document.documentElement.scrollWidth") <= width
        assert other.complaints == []
        context.close()
    assert page.complaints == []
    assert [url for url in page.requests if not url.startswith((run.address, "data:"))] == []
