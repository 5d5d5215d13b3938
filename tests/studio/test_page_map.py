"""Map, wish and yield in a browser: what is pointed at, wished and counted is Python's."""

from __future__ import annotations

import re

import numpy as np
import pytest

import stepwell as sw
from stepwell import files
from stepwell.design import check, parameter, parameter_map
from studio.browser import (
    HASTY,
    Opened,
    anchors,
    chain_shown,
    compare,
    drag,
    field,
    handle,
    number,
    output,
    settled,
    shown_as,
)

from playwright.sync_api import Locator, Page, expect  # isort: skip

WHOLE = "00>01>11>10>00"


def opened_tab(page: Page, name: str) -> None:
    page.get_by_role("tab", name=name).click()


def the_map(page: Page) -> Locator:
    image = page.get_by_role("application", name=re.compile("^Map over"))
    # Its process has to start first; a busy machine is no failure.
    legend = page.get_by_role("list", name="Sequences on the map")
    legend.locator("li").first.wait_for(timeout=120_000)
    expect(image).not_to_have_class(re.compile("stale"))
    return image


def point(page: Page, across: float, up: float) -> tuple[float, float, str]:
    """Point at a part of the map: the values there, and the sequence that is told."""
    canvas = the_map(page).locator("canvas")
    # A new picture comes later than new axes.
    expect(page.locator(".map.stale")).to_have_count(0)
    # A field that was filled may have scrolled it under the bar below.
    canvas.evaluate("one => one.scrollIntoView({ block: 'center' })")
    box = canvas.bounding_box()
    assert box is not None
    # The room of the axes is the page's own.
    wide, tall = box["width"] - 62, box["height"] - 56
    page.mouse.move(box["x"] + 50 + across * wide, box["y"] + 22 + (1 - up) * tall)
    place, sequence = output(page, "reading of Map").inner_text().replace("−", "-").split("\n")
    x, y = (float(one) for one in re.findall(r"-?[\d.]+", re.sub(r"N/m|mm|%", "", place)))
    return x, y, sequence


@pytest.fixture
def mapped(page: Page) -> Page:
    opened_tab(page, "Map")
    the_map(page).scroll_into_view_if_needed()
    return page


PLACES = ((0.1, 0.5), (0.3, 0.9), (0.3, 0.1), (0.8, 0.4))


def test_the_map_is_pythons(mapped: Page):
    chain = sw.preset("paper-forward")
    sequences = set()
    for place in PLACES:
        x, y, sequence = point(mapped, *place)
        there = parameter(chain, "outer.q").changed(chain, (x / 1e3, y / 1e3))
        assert sequence == str(there.cycle().sequence)
        sequences.add(sequence)
    assert len(sequences) > 2
    expect(output(mapped, "distance")).to_have_text(f"{chain.margin().anchors[1] * 1e3:.4g}")


def test_a_map_of_unlike_parameters_is_pythons(mapped: Page):
    chain = sw.preset("paper-forward")
    mapped.get_by_role("combobox", name="Map over").select_option("any two parameters")
    mapped.get_by_role("combobox", name="Parameter to the right").select_option(
        "stiffness of inner"
    )
    expect(
        mapped.get_by_role("application", name="Map over stiffness of inner and y of q of outer")
    ).to_be_visible()
    first = mapped.get_by_role("spinbutton", name="stiffness of inner, from, in N/m")
    first.fill("20")
    first.press("Enter")
    for place in PLACES:
        x, y, sequence = point(mapped, *place)
        ys = np.array([y, y + 1e-6]) / 1e3
        there = parameter_map(chain, ("inner.stiffness", [x]), ("outer.q.y", ys)).sequence
        words = there.attrs["flag_meanings"].split(" ")
        assert sequence == words[int(there.values[0, 0])]
    # The distance belongs to the design, whose numbers may come after the picture.
    expect(output(mapped, "distance along y")).to_be_visible()


def test_the_dot_moves_with_the_anchor_and_the_map_stays(mapped: Page):
    dot = the_map(mapped).locator("circle")
    expect(dot).to_have_attribute("data-x", "20")
    drag(mapped, "q", "outer", -40, 20)
    x, y = anchors(mapped, "outer")[1]
    expect(dot).to_have_attribute("data-x", f"{x:g}")
    expect(dot).to_have_attribute("data-y", f"{y:g}")
    expect(output(mapped, "distance")).to_have_text(
        f"{chain_shown(mapped).margin().anchors[1] * 1e3:.4g}"
    )


def test_the_map_follows_what_is_not_on_it(mapped: Page):
    drag(mapped, "q", "inner", 30, 10)
    chain = chain_shown(mapped)
    assert chain != sw.preset("paper-forward")
    the_map(mapped).scroll_into_view_if_needed()
    for place in PLACES:
        x, y, sequence = point(mapped, *place)
        there = parameter(chain, "outer.q").changed(chain, (x / 1e3, y / 1e3))
        assert sequence == str(there.cycle().sequence)


def test_a_click_takes_the_design_there_in_one_step(mapped: Page):
    x, y, sequence = point(mapped, 0.3, 0.9)
    mapped.mouse.down()
    mapped.mouse.up()
    settled(mapped)
    assert anchors(mapped, "outer")[1] == [x, y]
    expect(output(mapped, "sequence")).to_have_attribute("data-value", sequence)
    compare(mapped)
    mapped.get_by_role("button", name="Undo").click()
    settled(mapped)
    assert anchors(mapped, "outer")[1] == [20, 0]
    expect(mapped.get_by_role("button", name="Undo")).to_be_disabled()


def test_the_keyboard_takes_the_design_there(mapped: Page):
    the_map(mapped).focus()
    for _ in range(4):
        mapped.keyboard.press("Shift+ArrowLeft")
    mapped.keyboard.press("ArrowUp")
    place, sequence = output(mapped, "reading of Map").inner_text().split("\n")
    assert place == "8 mm, 0.3 mm"
    mapped.keyboard.press("Enter")
    settled(mapped)
    assert anchors(mapped, "outer")[1] == [8, 0.3]
    expect(output(mapped, "sequence")).to_have_attribute("data-value", sequence)


def test_a_jump_of_a_number_is_one_step(mapped: Page):
    mapped.get_by_role("combobox", name="Map over").select_option("any two parameters")
    mapped.get_by_role("combobox", name="Parameter to the right").select_option(
        "stiffness of outer"
    )
    named = "Map over stiffness of outer and y of q of outer"
    expect(mapped.get_by_role("application", name=named)).to_be_visible()
    x, y, sequence = point(mapped, 0.9, 0.9)
    mapped.mouse.down()
    mapped.mouse.up()
    expect(field(mapped, "q", "outer", "y")).to_have_value(f"{y:g}")
    settled(mapped)
    expect(output(mapped, "sequence")).to_have_attribute("data-value", sequence)
    mapped.get_by_role("button", name="Show me the Python").click()
    expect(mapped.get_by_label("Python", exact=True).last).to_contain_text(f"{x:g}")


def test_a_locked_anchor_is_not_taken_anywhere(mapped: Page):
    mapped.get_by_role("button", name="Lock q of outer").click()
    point(mapped, 0.3, 0.9)
    mapped.mouse.down()
    mapped.mouse.up()
    expect(mapped.get_by_role("alert")).to_contain_text("q of outer is locked")
    assert anchors(mapped, "outer")[1] == [20, 0]


def wish(page: Page, *states: str) -> None:
    for state in states:
        page.get_by_role("button", name=f"State {state}", exact=True).click()
    page.get_by_role("button", name="Find a design").click()


def test_a_cycle_is_wished_by_clicks_and_taken_as_is_an_earlier_answer(page: Page):
    opened_tab(page, "Target")
    wish(page, "00", "01", "11", "10", "00")
    expect(output(page, "resulting sequence")).to_have_text(WHOLE)
    result = sw.design(WHOLE)
    assert number(page, "resulting yield") == float(f"{result.yield_.fraction * 100:.6g}")
    expect(page.get_by_role("group", name="Design for the target, all cells at 0")).to_be_visible()
    page.get_by_role("button", name="Use this design").click()
    expect(output(page, "sequence")).to_have_attribute("data-value", WHOLE)
    settled(page)
    assert chain_shown(page).cycle().peak_force == pytest.approx(result.chain.cycle().peak_force)
    page.get_by_role("button", name="Undo").click()
    expect(output(page, "sequence")).to_have_attribute("data-value", "00>10>11>01>00")
    expect(page.get_by_role("button", name="Undo")).to_be_disabled()
    # Of several answers an earlier one is taken.
    pitch = page.get_by_role("spinbutton", name="Spacing of the holes in mm")
    pitch.fill("5")
    pitch.press("Enter")
    page.get_by_role("button", name="Find a design").click()
    expect(output(page, "yield of result 1")).to_be_visible()
    first, second = result, sw.design(WHOLE, holes=0.005)
    assert number(page, "yield of result 1") == float(f"{first.yield_.fraction * 100:.6g}")
    assert number(page, "resulting yield") == float(f"{second.yield_.fraction * 100:.6g}")
    force = first.chain.cycle().peak_force
    assert number(page, "peak force of result 1") == shown_as(force)
    page.get_by_role("button", name="Use result 1").click()
    settled(page)
    assert number(page, "peak force") == shown_as(force)


def test_a_set_of_states_is_wished_and_reached(page: Page):
    opened_tab(page, "Target")
    page.get_by_role("button", name="A set of states").click()
    page.get_by_role("button", name="2 cells").click()
    wish(page, "10", "11")
    # That the design is Python's is held where panels are asked without a page: it takes seconds.
    expect(output(page, "resulting states")).to_have_text("00 10 11", timeout=120_000)
    sequence = output(page, "resulting sequence").inner_text()
    page.get_by_role("button", name="Use this design").click()
    expect(output(page, "sequence")).to_have_attribute("data-value", sequence)
    settled(page)
    chain = chain_shown(page)
    assert str(chain.cycle().sequence) == sequence
    assert {"00", "10", "11"} <= chain.graph().reachable()


def test_what_cannot_be_had_is_reported_with_its_proof(page: Page):
    opened_tab(page, "Target")
    page.get_by_role("spinbutton", name="Maximum force in N").fill("0.01")
    page.get_by_role("spinbutton", name="Maximum force in N").press("Enter")
    wish(page)
    with pytest.raises(ValueError, match=re.escape("00>10")) as error:
        sw.design("00>10>11>01>00", most_force=0.01)
    expect(page.get_by_role("alert")).to_have_text(str(error.value))
    expect(page.get_by_role("button", name="Use this design")).to_have_count(0)


def test_a_wish_of_five_cells_is_typed(page: Page):
    opened_tab(page, "Target")
    text = page.get_by_role("textbox", name="Cycle")
    text.fill("00000>10000>11000")
    text.press("Enter")
    expect(page.get_by_role("button", name="State 00", exact=True)).to_have_count(0)
    page.get_by_role("button", name="Find a design").click()
    expect(page.get_by_role("alert")).to_contain_text("00000>10000>11000")


@pytest.fixture
def counted(opened: Opened, address: str) -> Page:
    """A page that is soon told its yields."""
    opened.page.add_init_script(HASTY)
    opened.page.goto(address)
    expect(output(opened.page, "yield")).to_have_text("100")
    return opened.page


def test_the_yield_is_pythons_and_follows_the_design(counted: Page):
    page = counted
    tolerance = page.get_by_role("spinbutton", name="Tolerance of the anchors in mm", exact=True)
    expect(output(page, "verdict")).to_have_text("robust")
    expect(output(page, "verdict in the bar")).to_be_in_viewport()
    expect(tolerance).to_have_value("0.3")
    tolerance.fill("4")
    tolerance.press("Enter")
    chain = files.preset("paper-forward")
    assert isinstance(chain, sw.Chain)
    expected = chain.yields(sw.Tolerances(anchor=4e-3, stiffness=0.05), seed=0)
    low, high = expected.interval
    expect(output(page, "yield")).to_have_text(f"{expected.fraction * 100:.6g}")
    expect(output(page, "verdict")).to_have_text(
        check(chain, tolerances=expected.tolerances).verdict
    )
    expect(output(page, "interval")).to_have_text(f"{low * 100:.6g} to {high * 100:.6g}")
    expect(output(page, "most failures")).to_have_text(next(iter(expected.outcomes)))
    assert expected.critical is not None
    first, second = expected.critical.names
    expect(output(page, "fails first")).to_have_text(
        f"{first} before {second} while {expected.critical.way}"
    )
    tolerance.fill("0.3")
    tolerance.press("Enter")
    expect(output(page, "yield")).to_have_text("100")
    handle(page, "q", "outer").focus()
    field(page, "q", "outer", "x").fill("10.4")
    field(page, "q", "outer", "x").press("Enter")
    settled(page)
    share = chain_shown(page).yields().fraction
    assert share < 1
    expect(output(page, "yield")).to_have_text(f"{share * 100:.6g}")
    assert number(page, "margin") == shown_as(chain_shown(page).margin().anchors.min() * 1e3)
