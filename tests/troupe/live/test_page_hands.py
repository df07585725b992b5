"""The page's hands in a real browser: what mouse, fingers and keys move, drive, and let go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import browsing
import pytest
from browsing import Page
from watching import watched

pytestmark = browsing.NEEDED
ASKED = """() => {
  const ask = troupe.link.ask.bind(troupe.link);
  window.asked = [];
  troupe.link.ask = (what) => {
    if (what.do !== "seen") asked.push(what);
    ask(what);
  };
}"""
"""Keeps what the page asks for from now on."""
FINGERS = """(events) => {
  const canvas = document.getElementById("canvas");
  canvas.setPointerCapture = () => {};
  for (const [type, pointerId, x, y] of events) {
    canvas.dispatchEvent(new PointerEvent(`pointer${type}`, { pointerId, clientX: x, clientY: y }));
  }
}"""
"""What fingers do: down, move or up; which of them; and where on the screen."""
STILL = [0, 0, 0]


def card_of(page: Page, robot: int) -> None:
    """Select a robot, and wait until its card is there."""
    page.page.evaluate(f"troupe.hands.select([{robot}])")
    page.until(f"(t) => t.state.cards[{robot}] && document.querySelector('.pad')")
    page.page.evaluate(ASKED)


def test_a_drag_moves_a_robot_and_nothing_through_walls(page: Page) -> None:
    page.drag((2, 2), (2, 6))
    page.until("(t) => Math.abs(t.state.poses[1] - 6) < 0.1")
    x, y = page.get("[troupe.state.poses[0], troupe.state.poses[1]]")
    assert (x, y) == pytest.approx((2, 6), abs=0.05)  # a pixel is 0.01 m
    page.drag((x, y), (5, 4))  # into the wall
    page.until("(t) => document.querySelector('#notices p') !== null")
    assert "no room" in page.page.inner_text("#notices")
    now = page.get("[troupe.state.poses[0], troupe.state.poses[1]]")
    assert abs(now[0] - 5) >= 1.0 or abs(now[1] - 4) >= 2.5
    assert page.get("troupe.state.tick") == 0


def test_a_right_drag_turns_it(page: Page) -> None:
    page.drag((2, 2), (0.5, 2), button="right")
    page.until("(t) => Math.abs(Math.abs(t.state.poses[2]) - Math.PI) < 0.05")
    assert page.get("troupe.state.poses[0]") == 2


def test_a_thing_is_moved_as_well(page: Page) -> None:
    page.drag((8, 6), (7, 7))
    page.until("(t) => Math.abs(t.state.things[0] - 7) < 0.1")


def test_a_wall_that_has_a_name_is_moved_where_it_is_met_and_shows_there(
    browser: Any, still: Path
) -> None:
    still.write_text(still.read_text().replace("color: blue", "color: blue, name: wall"))
    with watched(still, paused=True) as run:
        context = browser.new_context(viewport={"width": 1100, "height": 720})
        page = Page(context.new_page(), run.address)
        x = page.get("troupe.camera.x")
        page.drag((6, 4), (6.5, 4))  # beside it: the floor
        assert page.get("troupe.camera.x") != x
        page.page.keyboard.press(" ")
        page.drag((5.3, 5.5), (6.3, 6))
        page.until("(t) => Math.abs(t.state.things[3] - 6) < 0.05 && t.scene?.begun !== 0")
        page.until("(t) => !t.dirty")
        red, _, blue = page.pixel(6, 6.2)
        assert blue > red + 60
        assert min(page.pixel(4.7, 4)) > 200
        context.close()


def test_arrows_drive_who_is_selected(page: Page) -> None:
    page.page.fill("#robot", "berta")
    page.page.press("#robot", "Enter")
    page.until("(t) => t.state.cards[1] !== undefined")
    page.page.focus("#canvas")
    page.page.keyboard.press("p")
    page.page.keyboard.down("ArrowLeft")
    page.until("(t) => t.state.poses[5] > 0.3")
    page.page.keyboard.up("ArrowLeft")
    page.until("(t) => t.state.cards[1].command[1].every((part) => part === 0)")


def test_a_stick_drives_who_is_selected_until_it_is_let_go(page: Page) -> None:
    page.page.evaluate("troupe.hands.select([0])")
    page.page.locator(".stick").scroll_into_view_if_needed()
    box = page.page.locator(".stick").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.page.keyboard.press("p")
    page.page.mouse.move(x, y)
    page.page.mouse.down()
    page.page.mouse.move(x, y - 23)  # half way ahead
    page.until("(t) => t.state.poses[1] > 2.2")
    half = page.get("troupe.state.cards[0].command[1]")
    assert half == pytest.approx([0.3, 0, 0])
    page.page.mouse.up()
    page.until("(t) => t.state.cards[0].command[1].every((part) => part === 0)")


def test_a_robot_is_taken_from_its_controller_and_given_back(browser: Any) -> None:
    with watched("wander", paused=True) as run:
        context = browser.new_context()
        page = Page(context.new_page(), run.address)
        page.page.evaluate("troupe.hands.select([0])")
        page.page.click("#take")
        page.until("(t) => t.state.cards[0].taken && document.querySelector('.stick')")
        page.page.focus("#canvas")
        page.page.keyboard.down("ArrowLeft")
        page.page.keyboard.press(".")
        page.until("(t) => t.state.tick === 1 && t.state.cards[0].command[1][2] > 0.3")
        page.page.keyboard.up("ArrowLeft")
        page.page.keyboard.press("k")
        page.until("(t) => !t.state.cards[0].taken && !document.querySelector('.stick')")
        assert page.complaints == []
        context.close()
    what = [touch.what for touch in run.result().touched]
    assert (what[0], what[-1]) == ("take", "give")


def test_who_was_driven_stops_when_another_one_is_selected(page: Page) -> None:
    card_of(page, 0)
    page.page.focus("#canvas")
    page.page.keyboard.down("ArrowUp")
    page.page.keyboard.press(",")
    page.page.keyboard.up("ArrowUp")
    assert page.get("asked")[1:] == [
        {"do": "drive", "robot": 0, "twist": STILL},
        {"do": "select", "robots": [1]},
    ]


def test_who_was_driven_from_a_card_stops_when_that_shows_another_one(page: Page) -> None:
    card_of(page, 0)
    box = page.page.locator(".pad button").nth(1).bounding_box()
    page.page.mouse.move(box["x"] + 5, box["y"] + 5)
    page.page.mouse.down()
    page.page.evaluate("troupe.hands.select([1])")
    page.until("(t) => document.querySelector('#card h2')?.textContent === 'berta'")
    page.page.mouse.up()
    drives = [(ask["robot"], ask["twist"]) for ask in page.get("asked") if ask["do"] == "drive"]
    assert drives[0] == (0, [0.6, 0, 0])
    assert drives[1:]
    assert all(drive == (0, STILL) for drive in drives[1:])


def test_who_only_goes_through_the_page_by_keys_drives_nobody(page: Page) -> None:
    card_of(page, 0)
    page.page.focus("#find button")
    for _ in range(14):  # over the buttons that drive, and what it said and printed
        page.page.keyboard.press("Tab")
    page.page.focus("#card pre")
    page.page.keyboard.press("ArrowDown")  # scrolls
    assert page.get("asked") == []


def test_keys_drive_from_a_button_until_they_are_let_go(page: Page) -> None:
    card_of(page, 0)
    page.page.focus(".pad button[aria-label='turn left']")
    page.page.keyboard.down("Enter")
    page.page.keyboard.up("Enter")
    twists = [ask["twist"] for ask in page.get("asked")]
    assert twists == [[0, 0, pytest.approx(0.785, abs=0.01)], STILL]


def test_two_fingers_zoom_and_the_one_that_stays_moves_the_floor(page: Page) -> None:
    scale = page.get("troupe.camera.scale")
    page.page.evaluate(
        FINGERS, [["down", 1, 300, 300], ["down", 2, 400, 300], ["move", 2, 500, 300]]
    )
    assert page.get("troupe.camera.scale") == pytest.approx(2 * scale)
    x = page.get("troupe.camera.x")
    page.page.evaluate(FINGERS, [["up", 2, 500, 300], ["move", 1, 350, 300], ["up", 1, 350, 300]])
    assert page.get("troupe.camera.x") == pytest.approx(x - 50 / (2 * scale))
    assert page.get("troupe.hands.grip") is None
    assert page.complaints == []


def test_who_moves_the_view_follows_nobody_any_more(page: Page) -> None:
    page.page.evaluate("troupe.hands.select([0])")
    for move in ("Alt+ArrowLeft", None):
        page.page.focus("#canvas")
        page.page.keyboard.press("f")
        page.until("(t) => !t.dirty")
        assert page.page.is_checked("input[name=follow]")
        if move:
            page.page.keyboard.press(move)
        else:
            page.drag((3.6, 2.5), (4, 2.5))
        assert not page.page.is_checked("input[name=follow]")
        assert page.get("troupe.view.show.follow") is False


def test_space_opens_and_closes_what_has_the_focus(page: Page) -> None:
    page.page.focus("#layers > summary")
    page.page.keyboard.press("Space")
    assert page.get("document.getElementById('layers').open") is False


def test_of_many_that_are_selected_the_latest_has_the_card(browser: Any, still: Path) -> None:
    more = "".join(f"  - {{model: box, pose: [{1.2 + 1.3 * k}, 0.8, 0]}}\n" for k in range(3))
    more += "".join(f"  - {{model: box, pose: [1, {3.3 + 1.3 * k}, 0]}}\n" for k in range(4))
    still.write_text(still.read_text().replace("pose: [2, 2, 90]", "pose: [3, 6, 90]") + more)
    with watched(still, paused=True) as run:
        context = browser.new_context()
        page = Page(context.new_page(), run.address)
        page.page.evaluate("troupe.hands.select([...Array(9).keys()])")
        page.until("(t) => t.state.cards[8] !== undefined")
        page.until("(t) => document.querySelector('#card h2')?.textContent === t.state.names[8]")
        context.close()
