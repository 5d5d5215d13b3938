"""A replay: one file that plays without a server, with Python's numbers."""

import re
from pathlib import Path

import pytest

import stepwell as sw
from stepwell.mechanism import Chain
from stepwell.studio.motion import drawn
from stepwell.studio.standalone import replay
from studio.browser import Opened, number, numbers, opens, output, shown_as

from playwright.sync_api import expect  # isort: skip


def chain(name: str) -> Chain:
    design = sw.preset(name)
    assert isinstance(design, Chain)
    return design


def test_every_number_of_a_cycle_is_pythons_and_nothing_is_loaded(offline: Opened, tmp_path: Path):
    forward = chain("paper-forward")
    text = replay(forward)
    assert len(text.encode()) < 400_000
    page = opens(offline, tmp_path, text)
    cycle, path = forward.cycle(), drawn(forward.cycle().path)
    expect(output(page, "sequence")).to_have_attribute("data-value", str(cycle.sequence))
    assert number(page, "peak force") == shown_as(cycle.peak_force)
    assert number(page, "margin") == shown_as(min(forward.margin().anchors) * 1e3)
    slider = page.get_by_role("slider", name="Stroke")
    for k in (0, 40, len(path.drive) - 20):
        slider.fill(str(k))
        names = (f"travel of {name}" for name in forward.names)
        assert numbers(page, "stroke", "force", *names) == [
            shown_as(path.stroke[k] * 1e3),
            shown_as(path.force[k]),
            *(shown_as(travel * 1e3) for travel in path.travel[k]),
        ]


def test_it_plays_and_goes_by_the_keyboard(offline: Opened, tmp_path: Path):
    page = opens(offline, tmp_path, replay(chain("paper-forward")))
    slider = page.get_by_role("slider", name="Stroke")
    slider.press("ArrowRight")
    expect(slider).to_have_value("1")
    page.get_by_role("button", name="Play").press("Enter")
    expect(slider).not_to_have_value("1")
    page.get_by_role("button", name="Pause").press("Enter")
    expect(page.get_by_role("button", name="Play")).to_be_visible()


def test_state_snap_and_actuator_are_reported_at_the_cursor(offline: Opened, tmp_path: Path):
    forward = chain("paper-forward")
    page = opens(offline, tmp_path, replay(forward))
    slider = page.get_by_role("slider", name="Stroke")
    path = drawn(forward.cycle().path)
    top = int(path.drive.argmax())
    for k, state, way in ((0, "00", "loads"), (top, "11", "loads"), (top + 2, "–1", "unloads")):
        slider.fill(str(k))
        expect(output(page, "state")).to_have_text(state)
        expect(page.get_by_role("img", name=f"The actuator {way}")).to_be_visible()
    snaps = path.snap_after.nonzero()[0].tolist()
    marks = page.get_by_role("button", name="Snap at ")
    expect(marks).to_have_count(len(snaps))
    for mark, sample in zip(marks.all(), snaps, strict=True):
        mark.click()
        expect(slider).to_have_value(str(sample))


def test_a_chain_of_volumes_has_the_words_of_figures_and_reports(offline: Opened, tmp_path: Path):
    balloon = chain("balloon")
    page = opens(offline, tmp_path, replay(balloon))
    assert number(page, "peak pressure") == shown_as(balloon.cycle().peak_force / 1e3)
    for label in ("pressure [kPa] over volume [mL]", "volume of each cell [mL] over volume [mL]"):
        expect(page.get_by_role("application", name=label)).to_be_visible()
    expect(page.get_by_text("V = 0 mL")).to_be_visible()
    for part in (".summary", ".stroke", ".drawing"):
        words = re.compile(r"\b(force|stroke|travel)\b")
        expect(page.locator(part)).not_to_contain_text(words)
    assert numbers(page, "volume", "pressure", "volume of thin") == [0.0, 0.0, 0.0]


def test_a_program_ends_where_it_leads(offline: Opened, tmp_path: Path):
    program = chain("paper-forward").program("01")
    page = opens(offline, tmp_path, replay(program))
    expect(output(page, "sequence")).to_have_attribute("data-value", str(program.sequence))
    expect(output(page, "ends in")).to_have_text("01")


def test_a_title_is_text_whatever_it_holds(offline: Opened, tmp_path: Path):
    title = "</script></title><img src=x onerror=\"document.title='hit'\"> $data <!-- <script>"
    page = opens(offline, tmp_path, replay(chain("paper-forward"), title=title))
    expect(page.get_by_role("banner")).to_contain_text(title)
    assert page.title() == title
    assert page.locator("img").count() == 0


def test_a_narrow_page_needs_no_sideways_scrolling(offline: Opened, tmp_path: Path):
    offline.page.set_viewport_size({"width": 390, "height": 844})
    page = opens(offline, tmp_path, replay(chain("metachronal-wave")))
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_what_is_no_motion_is_refused():
    with pytest.raises(ValueError, match="Robot: a replay needs a Chain, a Program, or a robot's"):
        replay(sw.preset("robot-left"))  # type: ignore[arg-type]
