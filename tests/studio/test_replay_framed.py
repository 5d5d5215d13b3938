"""Replays inside another page: compact, apart from it, and still unless asked."""

import time
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import stepwell as sw
from stepwell.mechanism import Chain
from stepwell.studio.standalone import as_iframe, replay
from studio.browser import Opened, opens, output

from playwright.sync_api import Frame, Page, expect  # isort: skip


def around(*frames: str) -> str:
    """A page with frames, in an encoding that is not theirs."""
    return f"""<!doctype html><html lang="en"><meta charset="windows-1252"><title>Around</title>
<meta name="color-scheme" content="light dark"><style>body {{ margin: 0 }}</style>
<main>{"".join(frames)}</main></html>"""


@cache
def page_of(name: str) -> str:
    chain = sw.preset(name)
    assert isinstance(chain, Chain)
    return replay(chain)


def frames_of(page: Page) -> list[Frame]:
    frames = page.main_frame.child_frames
    for frame in frames:
        expect(frame.get_by_role("slider", name="Stroke")).to_be_visible()
    return frames


@pytest.mark.parametrize("name", ["paper-forward", "metachronal-wave"])
def test_all_of_it_is_in_view_without_a_bar_of_its_own(offline: Opened, tmp_path: Path, name: str):
    page = opens(offline, tmp_path, around(as_iframe(page_of(name), "It moves")))
    (frame,) = frames_of(page)
    assert frame.get_by_role("banner").count() == 0
    for width in (900, 340):
        page.set_viewport_size({"width": width, "height": 800})
        frame.wait_for_function("(width) => innerWidth === width", arg=width)
        all_in_view(frame)


def all_in_view(frame: Frame) -> None:
    room = frame.evaluate("[innerWidth, innerHeight]")
    rem = 16
    assert 30 * rem <= room[1] <= 40 * rem
    whole = frame.evaluate(
        "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    assert whole[0] <= room[0] and whole[1] <= room[1]
    for seen in (
        frame.get_by_role("group", name="The mechanism at the cursor"),
        frame.get_by_role("application", name="Force: "),
        frame.get_by_role("application", name="Travel: "),
        frame.get_by_role("button", name="Play"),
        output(frame, "state"),
    ):
        box = seen.bounding_box()
        assert box is not None and box["height"] > 10
        assert box["y"] + box["height"] <= room[1] + 1


def test_side_by_side_where_wide_and_one_above_the_other_where_narrow(
    offline: Opened, tmp_path: Path
):
    page = opens(offline, tmp_path, around(as_iframe(page_of("paper-forward"), "It moves")))
    (frame,) = frames_of(page)

    def places() -> tuple[dict[str, float], dict[str, float]]:
        regions = [frame.get_by_role("region", name=name) for name in ("Mechanism", "Motion")]
        boxes = [region.bounding_box() for region in regions]
        assert boxes[0] is not None and boxes[1] is not None
        return dict(boxes[0]), dict(boxes[1])  # pyright: ignore[reportReturnType]

    page.set_viewport_size({"width": 900, "height": 800})
    drawing, curves = places()
    assert drawing["y"] == curves["y"] and drawing["x"] < curves["x"]
    page.set_viewport_size({"width": 340, "height": 800})
    drawing, curves = places()
    assert drawing["x"] == curves["x"] and drawing["y"] < curves["y"]


def test_two_side_by_side_have_legible_curves_and_their_legend(offline: Opened, tmp_path: Path):
    page = opens(offline, tmp_path, around(as_iframe(page_of("paper-forward"), "It moves")))
    (frame,) = frames_of(page)
    page.locator("iframe").evaluate("frame => { frame.style.height = '48rem' }")
    curves = [frame.get_by_role("application", name=name) for name in ("Force: ", "Travel: ")]
    tall = "curve => new Promise((done) => requestAnimationFrame(() => done(curve.clientHeight)))"
    for width in (580, 700):
        page.set_viewport_size({"width": width, "height": 800})
        frame.wait_for_function("(width) => innerWidth === width", arg=width)
        # A frame of another height is laid out some frames later.
        until = time.monotonic() + 20
        while min(curve.evaluate(tall) for curve in curves) <= 110:
            assert time.monotonic() < until
        expect(frame.get_by_text("a snap leads from ○ to ●")).to_be_visible()
        expect(frame.get_by_text("anchor of outer")).to_be_visible()


def test_curves_of_a_frame_lie_one_below_the_other_inside_it(offline: Opened, tmp_path: Path):
    page = opens(offline, tmp_path, around(as_iframe(page_of("paper-forward"), "It moves")))
    (frame,) = frames_of(page)
    page.set_viewport_size({"width": 1200, "height": 800})
    drawings = frame.locator(".charts canvas:visible")
    gaps = """all => {
      const boxes = all.map((one) => one.getBoundingClientRect());
      const ends = [...boxes.slice(1).map((one) => one.top), innerHeight];
      return boxes.map((one, k) => ends[k] - one.bottom);
    }"""
    for height in (400, 640):
        page.locator("iframe").evaluate(f"frame => {{ frame.style.height = '{height}px' }}")
        frame.wait_for_function("(height) => innerHeight === height", arg=height)
        # A frame of another height is laid out some frames later.
        until = time.monotonic() + 10
        while min(drawings.evaluate_all(gaps)) < 0:
            assert time.monotonic() < until, drawings.evaluate_all(gaps)


def test_what_it_rests_on_can_be_read_in_a_frame(offline: Opened, tmp_path: Path):
    page = opens(offline, tmp_path, around(as_iframe(page_of("paper-forward"), "It moves")))
    (frame,) = frames_of(page)
    words = frame.get_by_text("Quasi-static")
    expect(words).to_be_hidden()
    frame.get_by_role("button", name="Assumptions").press("Enter")
    expect(words).to_be_visible()
    frame.get_by_role("button", name="Close").press("Enter")
    expect(words).to_be_hidden()


def test_twenty_cells_with_ties_leave_room_for_what_is_seen(offline: Opened, tmp_path: Path):
    wave = sw.preset("metachronal-wave")
    assert isinstance(wave, Chain)
    many = [*wave.cells, *wave.cells, *wave.cells, *wave.cells][:20]
    cells = tuple(replace(cell, name=f"cell {k} of many") for k, cell in enumerate(many))
    text = replay(replace(wave, cells=cells))
    page = opens(offline, tmp_path, around(as_iframe(text, "Many")))
    (frame,) = frames_of(page)
    for width in (900, 340):
        page.set_viewport_size({"width": width, "height": 800})
        for part, least in (
            (frame.get_by_role("group", name="The mechanism at the cursor"), 100),
            (frame.get_by_role("application", name="Force: "), 60),
            (frame.get_by_role("application", name="Travel: "), 60),
        ):
            box = part.bounding_box()
            assert box is not None and box["height"] > least and box["width"] > 200
        tall = frame.evaluate("[document.documentElement.scrollHeight, innerHeight]")
        assert tall[0] <= tall[1]
    ties = frame.get_by_text("so friction will decide").first
    expect(ties).to_be_hidden()
    frame.get_by_role("button", name="Assumptions, and").click()
    expect(ties).to_be_visible()


def test_nothing_moves_unasked_and_one_that_is_played_leaves_the_others(
    offline: Opened, tmp_path: Path
):
    one = as_iframe(page_of("paper-forward"), "It moves")
    page = opens(offline, tmp_path, around(one, one))
    page.set_viewport_size({"width": 900, "height": 1400})
    first, second = frames_of(page)
    slider = first.get_by_role("slider", name="Stroke")
    slider.press("ArrowRight")
    expect(slider).to_have_value("1")
    first.get_by_role("button", name="Play").press("Enter")
    expect(slider).not_to_have_value("1")
    expect(second.get_by_role("slider", name="Stroke")).to_have_value("0")


def test_what_is_to_play_does_so_in_view_until_the_reader_takes_over(
    offline: Opened, tmp_path: Path
):
    plays = as_iframe(page_of("paper-forward"), "It moves", plays=True)
    page = opens(offline, tmp_path, around(plays, '<div style="height: 3000px"></div>'))
    (frame,) = frames_of(page)
    slider = frame.get_by_role("slider", name="Stroke")
    expect(slider).not_to_have_value("0")
    page.mouse.wheel(0, 2500)
    expect(frame.get_by_role("button", name="Play")).to_be_visible()
    page.mouse.wheel(0, -2500)
    pause = frame.get_by_role("button", name="Pause")
    expect(pause).to_be_visible()
    pause.click()
    page.mouse.wheel(0, 2500)
    page.mouse.wheel(0, -2500)
    page.wait_for_timeout(300)
    expect(frame.get_by_role("button", name="Play")).to_be_visible()


def test_readers_who_want_less_motion_have_none_unasked(offline: Opened, tmp_path: Path):
    offline.page.emulate_media(reduced_motion="reduce")
    plays = as_iframe(page_of("paper-forward"), "It moves", plays=True)
    page = opens(offline, tmp_path, around(plays))
    (frame,) = frames_of(page)
    # What is emulated reaches a frame of its own process a little later than the page.
    frame.wait_for_function("matchMedia('(prefers-reduced-motion: reduce)').matches")
    slider = frame.get_by_role("slider", name="Stroke")
    page.wait_for_timeout(300)
    stood = slider.input_value()
    page.wait_for_timeout(500)
    expect(slider).to_have_value(stood)
    frame.get_by_role("button", name="Play").click()
    expect(slider).not_to_have_value(stood)


def test_a_frame_has_the_colours_that_the_reader_wants(offline: Opened, tmp_path: Path):
    page = opens(offline, tmp_path, around(as_iframe(page_of("paper-forward"), "It moves")))
    (frame,) = frames_of(page)
    for scheme in ("dark", "light", "dark"):
        page.emulate_media(color_scheme=scheme)
        expect(frame.locator("html")).to_have_attribute("data-theme", scheme)


def test_a_title_stays_text_in_an_attribute(offline: Opened, tmp_path: Path):
    title = '"></iframe><img src=x onerror="document.title=1"> & \N{HIRAGANA LETTER A}'
    page = opens(offline, tmp_path, around(as_iframe(page_of("paper-forward"), title)))
    frames_of(page)
    assert page.locator("iframe").get_attribute("title") == title
    assert page.locator("img").count() == 0
