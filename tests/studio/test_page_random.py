"""The page under seeded random actions, and under two fingers."""

from __future__ import annotations

import base64
import json
import random
import time
from typing import Any

import pytest

from sizes import cases
from stepwell import files
from studio.browser import anchors, handle, middle, number, output, settled, shown_as

from playwright.sync_api import Page, expect  # isort: skip

# Fewer than the steps that undo remembers.
MOST = 90
SECONDS = cases([30.0], [8.0])
PRESETS = "balloon", "metachronal-wave", "paper-forward"


def shown(page: Page) -> dict[str, Any]:
    """The design of the address, which is the one that a reload or another tab opens."""
    text = page.evaluate("location.hash").partition("=")[2]
    return json.loads(base64.urlsafe_b64decode(text + "=" * (-len(text) % 4)))


class Hand:
    """A hand that does anything on the page; `turn` draws what."""

    def __init__(self, page: Page, turn: random.Random):
        self.page, self.turn = page, turn
        self.steps = [
            *(self.drags, self.drags, self.drags_and_cancels, self.presses_arrows, self.types),
            *(self.undoes, self.redoes, self.opens_a_card, self.looks, self.seeks, self.grows),
        ]

    def does(self) -> str:
        """One action; its name."""
        action = self.turn.choice(self.steps)
        action()
        return action.__name__

    def _one(self, selector: str) -> Any:
        return self.turn.choice(self.page.locator(selector).all() or [None])

    def _pulls(self, end: str) -> None:
        if (dot := self._one(".drawing .handle .dot")) is None:
            return
        x, y = middle(dot)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        dx, dy = self.turn.randint(-40, 40), self.turn.randint(-40, 40)
        self.page.mouse.move(x + dx, y + dy, steps=4)
        if end:
            self.page.keyboard.press(end)
        self.page.mouse.up()

    def drags(self) -> None:
        self._pulls("")

    def drags_and_cancels(self) -> None:
        self._pulls(self.turn.choice(["Escape", "Control+z"]))

    def presses_arrows(self) -> None:
        if (grip := self._one(".drawing .handle")) is not None:
            grip.focus()
            for _ in range(self.turn.randint(1, 4)):
                self.page.keyboard.press(self.turn.choice(["ArrowLeft", "Shift+ArrowUp"]))

    def types(self) -> None:
        if (field := self._one(".cells .anchor input")) is not None:
            field.fill(self.turn.choice(["12", "-7.25", "3,5", "", "x", "1e9"]))
            field.press(self.turn.choice(["Enter", "Tab", "Escape"]))

    def undoes(self) -> None:
        self.page.keyboard.press("Escape")
        self.page.keyboard.press("Control+z")

    def redoes(self) -> None:
        self.page.keyboard.press("Control+y")

    def opens_a_card(self) -> None:
        self.page.get_by_role("button", name="Gallery").click()
        name = self.turn.choice(PRESETS)
        self.page.locator(".card", has_text=files.presets()[name]).first.click()
        self.page.locator(".workspace").wait_for()

    def looks(self) -> None:
        self._one("[role=tab]").click()

    def seeks(self) -> None:
        # A refused design that undo leads to has no motion.
        if (slider := self._one('input[aria-label="Stroke"]')) is not None:
            slider.fill(str(self.turn.randint(0, 60)))
            self.page.keyboard.press("Space")

    def grows(self) -> None:
        name = self.turn.choice(["Add a cell", "Mirror", "Remove cell"])
        buttons = self.page.get_by_role("button", name=name).all()
        cells = self.page.locator(".cells > .cell").count()
        if buttons and (cells < 5 or name != "Add a cell"):
            self.turn.choice(buttons).click()


def true_to_python(page: Page, done: list[str]) -> None:
    """The numbers are those of the design in the address, unless it is refused."""
    settled(page)
    assert page.get_by_text("The server is gone").count() == 0, done
    if page.locator(".problems").count():
        return
    cycle = files.loads_tables(shown(page)).chain.cycle()
    expect(output(page, "sequence")).to_have_attribute("data-value", str(cycle.sequence))
    assert number(page, "dissipated") == shown_as(cycle.dissipated * 1e3), done


@pytest.mark.parametrize("seconds", SECONDS)
@pytest.mark.parametrize("seed", cases([1, 2, 3], [1]))
def test_after_random_actions_numbers_are_pythons_and_undo_leads_to_the_first_design(
    page: Page, seed: int, seconds: float
):
    settled(page)
    first, hand, done = shown(page), Hand(page, random.Random(seed)), []
    until = time.monotonic() + seconds
    while time.monotonic() < until and len(done) < MOST:
        done.append(hand.does())
        if len(done) % 8 == 0:
            true_to_python(page, done)
    true_to_python(page, done)
    undo = page.get_by_role("button", name="Undo")
    for _ in range(100):
        if undo.is_disabled():
            break
        undo.click()
    settled(page)
    assert shown(page) == first, done


def test_a_second_finger_leaves_the_anchor_of_the_first_and_takes_no_other(page: Page):
    places = [
        middle(handle(page, anchor, cell).locator(".dot"))
        for anchor, cell in (("p", "inner"), ("q", "outer"))
    ]
    inner, outer = anchors(page, "inner"), anchors(page, "outer")
    fingers = page.context.new_cdp_session(page)
    for kind, by in (("touchStart", 0), ("touchMove", 6), ("touchMove", 12)):
        (x, y), (u, v) = places
        points = [{"x": x + by, "y": y, "id": 0}, {"x": u, "y": v + by, "id": 1}]
        fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    fingers.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    settled(page)
    assert anchors(page, "outer") == outer
    p, q = anchors(page, "inner")
    assert q == inner[1]
    assert p != inner[0]
    page.get_by_role("button", name="Undo").click()
    assert anchors(page, "inner") == inner
