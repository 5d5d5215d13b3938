"""Every number of a cell in the page: what is typed there is what Python says."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from stepwell import files
from studio.browser import Opened, begun, handle, middle, number, output, settled, shown_as

from playwright.sync_api import Locator, Page, expect  # isort: skip


@pytest.fixture
def start(blank: Opened, empty_address: str) -> Callable[[str], Page]:
    """Opens a preset."""
    return lambda preset: begun(blank.page, empty_address, preset)


def more(page: Page, cell: str) -> None:
    page.locator(f'summary[aria-label="More of {cell}"]').click()


def spin(page: Page, name: str) -> Locator:
    return page.get_by_role("spinbutton", name=name, exact=True)


def typed(page: Page, name: str, value: object) -> None:
    field = spin(page, name)
    field.fill(str(value))
    field.press("Enter")
    settled(page)


def tables(name: str) -> dict[str, Any]:
    return files.tables_in(files.preset_text(name))


def same(page: Page, design: dict[str, Any]) -> None:
    cycle = files.loads_tables(design).chain.cycle()
    expect(output(page, "sequence")).to_have_attribute("data-value", str(cycle.sequence))
    assert number(page, "peak force") == shown_as(cycle.peak_force)
    assert number(page, "dissipated") == shown_as(cycle.dissipated * 1e3)


def test_a_stiffness_is_typed_shown_as_default_and_taken_out_again(page: Page):
    more(page, "inner")
    name = "stiffness of the band of inner in N/m"
    assert spin(page, name).input_value() == "28.5"
    out = page.get_by_role("button", name=f"Use the default of {name}")
    expect(out).to_have_count(0)
    typed(page, name, 40)
    design = tables("paper-forward")
    design["chain"]["cell"][0]["band"] = {"stiffness_N_per_m": 40}
    same(page, design)
    out.click()
    settled(page)
    assert spin(page, name).input_value() == "28.5"
    same(page, tables("paper-forward"))
    page.get_by_text("Common to all cells").click()
    typed(page, "stiffness of all bands in N/m", 33)
    assert spin(page, name).input_value() == "33"


def late(page: Page, kind: str) -> None:
    """The server's answers of a type come later than all others."""
    page.evaluate(
        """(kind) => {
          const send = WebSocket.prototype.send;
          WebSocket.prototype.send = function (message) {
            setTimeout(() => send.call(this, message), JSON.parse(message).type === kind ? 600 : 0);
          };
        }""",
        kind,
    )


def test_a_page_is_busy_until_its_fields_show_the_new_defaults(page: Page):
    more(page, "inner")
    page.get_by_text("Common to all cells").click()
    late(page, "cells")
    typed(page, "stiffness of all bands in N/m", 33)
    assert spin(page, "stiffness of the band of inner in N/m").input_value() == "33"


def test_a_panel_shows_that_its_answer_takes_long_while_the_numbers_are_there(page: Page):
    late(page, "graph")
    typed(page, "q of outer, x in mm", 19)
    panel = page.get_by_role("tabpanel")
    expect(panel).to_have_attribute("aria-busy", "true")
    design = tables("paper-forward")
    design["chain"]["cell"][1]["q_mm"] = [19, 0]
    same(page, design)
    expect(panel).to_have_attribute("aria-busy", "false")


def test_a_bad_value_is_reported_at_its_field_and_can_be_mended(page: Page):
    more(page, "outer")
    name = "friction of outer in N"
    before = number(page, "peak force")
    typed(page, name, -1)
    expect(spin(page, name)).to_have_attribute("aria-invalid", "true")
    expect(page.locator(".field").filter(has=spin(page, name))).to_contain_text("must be >= 0")
    assert number(page, "peak force") == before
    # A slip of unit names the cell, and stands at the field all the same.
    typed(page, name, 0)
    typed(page, "stiffness of the band of outer in N/m", 0)
    expect(spin(page, "stiffness of the band of outer in N/m")).to_have_attribute(
        "aria-invalid", "true"
    )
    page.get_by_role("button", name="Undo").click()
    settled(page)
    expect(page.get_by_role("alert")).to_have_count(0)
    design = tables("paper-forward")
    same(page, design)


def test_an_actuator_is_a_number_or_rigid(page: Page):
    page.get_by_text("Common to all cells").click()
    field = page.get_by_role("textbox", name="actuator stiffness of the chain in N/m")
    assert field.input_value() == "rigid"
    field.fill("40")
    field.press("Enter")
    settled(page)
    design = tables("paper-forward")
    design["chain"]["actuator_stiffness_N_per_m"] = 40
    same(page, design)


def test_a_band_is_added_and_removed(page: Page):
    more(page, "inner")
    page.get_by_role("button", name="Add a band to inner").click()
    settled(page)
    design = tables("paper-forward")
    cell = design["chain"]["cell"][0]
    p, q = cell.pop("p_mm"), cell.pop("q_mm")
    cell["bands"] = [{"p_mm": p, "q_mm": q}, {"p_mm": p, "q_mm": [q[0], q[1] + 2.5]}]
    same(page, design)
    expect(
        handle(page, "q", "band 2 of inner").or_(handle(page, "q of band 2", "inner"))
    ).to_be_visible()
    typed(page, "stiffness of band 2 of inner in N/m", 12)
    cell["bands"][1]["stiffness_N_per_m"] = 12
    same(page, design)
    lock = page.get_by_role("button", name="Lock q of band 2 of inner")
    lock.click()
    expect(handle(page, "q of band 2", "inner")).to_have_attribute("aria-disabled", "true")
    page.get_by_role("button", name="Mirror inner").click()
    settled(page)
    assert (
        page.get_by_role("spinbutton", name="q of band 2 of inner, y in mm").input_value() == "-2.5"
    )
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Remove band 2 of inner").click()
    settled(page)
    same(page, tables("paper-forward"))


def test_an_argument_of_a_truss_is_edited(start: Any):
    page = start("von-mises-truss")
    more(page, "flat")
    typed(page, "height of flat in mm", 10)
    design = tables("von-mises-truss")
    design["chain"]["cell"][0]["von_mises_truss"]["height_mm"] = 10
    same(page, design)
    expect(
        page.get_by_role("application", name="The curve of flat: force in N over travel in mm")
    ).to_be_visible()


def test_a_cell_of_another_measure_is_refused_and_can_be_removed(start: Any):
    page = start("balloon")
    page.get_by_role("combobox", name="Kind of the cell to add").select_option("balloon")
    page.get_by_role("button", name="Add a cell").click()
    expect(output(page, "sequence")).to_have_attribute("data-value", re.compile("^000>"))
    page.get_by_role("combobox", name="Kind of the cell to add").select_option("dome")
    page.get_by_role("button", name="Add a cell").click()
    expect(page.get_by_role("alert")).to_contain_text("chain")
    page.get_by_role("button", name="Remove cell 4").click()
    expect(page.get_by_role("alert")).to_have_count(0)


def test_a_point_of_a_curve_is_dragged_added_and_removed(page: Page):
    page.get_by_role("combobox", name="Kind of the cell to add").select_option(
        "curve of travel and force"
    )
    page.get_by_role("button", name="Add a cell").click()
    expect(output(page, "sequence")).to_have_attribute("data-value", re.compile("^000>"))
    settled(page)
    more(page, "cell 3")
    point = page.get_by_role("button", name="point 2 of cell 3", exact=True)
    x, y = middle(point.locator(".dot"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 10, y + 12, steps=4)
    page.mouse.up()
    settled(page)
    travel, force = (
        float(spin(page, f"{what} of point 2 of cell 3 in {unit}").input_value())
        for what, unit in (("travel", "mm"), ("force", "N"))
    )
    assert 4 < travel < 6
    assert 0 < force < 1
    design = tables("paper-forward")
    points = {"travel_mm": [0, travel, 12, 16], "force_N": [0, force, -1, 0.5]}
    design["chain"]["cell"].append({"name": "cell 3", "points": points})
    same(page, design)
    point.focus()
    page.get_by_role("button", name="Add a point to cell 3").click()
    settled(page)
    expect(page.get_by_role("button", name="point 5 of cell 3", exact=True)).to_be_visible()
    page.get_by_role("button", name="Remove point 3 of cell 3").click()
    settled(page)
    same(page, design)


def test_a_leg_is_edited_and_the_other_stays(start: Any):
    page = start("robot-left")
    more(page, "outer")
    typed(page, "stiffness of the band of outer in N/m", 45)
    before = tables("robot-left")
    held = page.evaluate("JSON.parse(localStorage.getItem('stepwell.designs'))")[0]["design"]
    assert held["leg"][0]["chain"]["cell"][1]["band"] == {"stiffness_N_per_m": 45}
    assert held["leg"][1] == before["leg"][1]
    assert held["chain"] == before["chain"]
    design = files.loads_tables(held).robot
    assert number(page, "peak force") == shown_as(design.legs[0].chain.cycle().peak_force)


def test_the_drawing_zooms_by_keys_and_buttons(page: Page):
    block = page.locator(".drawing .block.fixed")
    before = block.bounding_box()
    drawing = page.get_by_role(
        "group", name="Drawing: plus and minus zoom, 0 or Escape shows all of it"
    )
    drawing.focus()
    page.keyboard.press("+")
    page.get_by_role("button", name="Zoom in").click()
    after = block.bounding_box()
    assert before is not None
    assert after is not None
    assert after["height"] == pytest.approx(before["height"] * 1.25**2, rel=0.02)
    drawing.focus()
    page.keyboard.press("0")
    assert block.bounding_box() == before


def test_two_fingers_zoom_the_drawing(page: Page):
    block = page.locator(".drawing .block.fixed")
    svg = page.locator(".drawing svg").bounding_box()
    before = block.bounding_box()
    assert svg is not None
    assert before is not None
    x, y = svg["x"] + svg["width"] - 60, svg["y"] + 40
    touch = page.context.new_cdp_session(page)
    for kind, apart in (("touchStart", 20), ("touchMove", 30), ("touchMove", 40)):
        points = [{"x": x, "y": y, "id": 0}, {"x": x, "y": y + apart, "id": 1}]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    touch.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    after = block.bounding_box()
    assert after is not None
    assert after["height"] == pytest.approx(before["height"] * 2, rel=0.05)


def test_a_lock_stays_while_bands_come(page: Page):
    page.get_by_role("button", name="Lock q of outer").click()
    more(page, "outer")
    page.get_by_role("button", name="Add a band to outer").click()
    settled(page)
    expect(handle(page, "q of band 1", "outer")).to_have_attribute("aria-disabled", "true")
    expect(handle(page, "q of band 2", "outer")).to_have_attribute("aria-disabled", "false")


def test_the_rows_of_a_load_are_edited(page: Page, tmp_path: Path):
    design = tables("paper-forward")
    text = files.preset_text("paper-forward") + "load_mm_N = [[0, 0.02], [20, 0.05]]\n"
    path = tmp_path / "loaded.toml"
    path.write_text(text)
    page.get_by_label("Open a design file").set_input_files(path)
    settled(page)
    more(page, "outer")
    expect(spin(page, "load of outer, row 2, in N")).to_have_value("0.05")
    typed(page, "load of outer, row 2, in N", 0.09)
    design["chain"]["cell"][1]["load_mm_N"] = [[0, 0.02], [20, 0.09]]
    same(page, design)
    page.get_by_role("button", name="Add a row to load of outer").click()
    settled(page)
    expect(spin(page, "load of outer, row 3, in mm")).to_have_value("40")
    page.get_by_role("button", name="Use the default of load of outer in mm").click()
    settled(page)
    same(page, tables("paper-forward"))
    expect(spin(page, "load of outer in N")).to_have_value("0")
