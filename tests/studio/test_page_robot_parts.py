"""A robot in its parts in a browser: drawn, moved, taken apart, named, or refused with a reason."""

import io
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("manifold3d")

from chromium import nothing_found
from stepwell.figures.robots import build as figure
from stepwell.simulation.live import tension_colour
from studio.browser import Opened, begun, output, settled, without
from studio.conftest import WIDE, blameless
from studio.test_robot_parts import asked

from playwright.sync_api import Browser, Locator, Page, expect  # isort: skip

# What else a robot's page asks takes seconds, and is looked at elsewhere.
QUIET = without("yield", "predict", "thumbnails", "atlas", "robot", "build")
PATIENT = 120_000
EDGE = 30  # px, where corners are round


@pytest.fixture(scope="module")
def built(browser: Browser, empty_address: str) -> Iterator[Page]:
    """A page with a robot in its parts, for all tests of this file."""
    context = browser.new_context(viewport=WIDE, color_scheme="light")
    opened = Opened(context.new_page())
    opened.page.add_init_script(QUIET)
    begun(opened.page, empty_address, "robot-antennas")
    opened.page.get_by_role("tab", name="Parts").click()
    space(opened.page).wait_for(timeout=PATIENT)
    yield opened.page
    context.close()
    blameless(opened)


@pytest.fixture
def robot_page(built: Page) -> Iterator[Page]:
    """That page, which is given back as it was."""
    yield built
    built.set_viewport_size(WIDE)
    built.mouse.move(0, 0)
    for name in ("Stroke", "Exploded view"):
        slid(built, name, "0")
    for box in built.get_by_role("group", name="Kinds of parts").get_by_role("checkbox").all():
        box.check()
    for box in built.get_by_role("checkbox", name="pressed").all():
        box.uncheck()


def space(page: Page) -> Locator:
    return page.locator(".parts canvas[data-ready=yes]")


def picture(page: Page) -> np.ndarray:
    """The pixels of the robot without the edges of its picture, of numbers from 0 to 1."""
    from PIL import Image

    # Of the size that it has on the page: after a change of that, it is the old one, stretched.
    page.wait_for_function(
        """() => {
          const canvas = document.querySelector(".parts canvas[data-ready=yes]");
          const near = (drawn, shown) => Math.abs(drawn - shown * devicePixelRatio) <= 1;
          return near(canvas.width, canvas.clientWidth) && near(canvas.height, canvas.clientHeight);
        }"""
    )
    # The picture of a change is that of the next frame.
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 50)))")
    seen = Image.open(io.BytesIO(space(page).screenshot())).convert("RGB")
    return np.asarray(seen, float)[EDGE:-EDGE, EDGE:-EDGE] / 255.0


def drawn(pixels: np.ndarray) -> np.ndarray:
    """Where a part is drawn: not of the colour of the ground in the middle of the upper edge."""
    ground = pixels[5, pixels.shape[1] // 2]
    return np.abs(pixels - ground).max(axis=2) > 0.02


def slid(page: Page, name: str, value: str) -> None:
    page.get_by_role("slider", name=name, exact=True).fill(value)


def test_a_robot_is_drawn_in_its_parts_moved_taken_apart_and_named(robot_page: Page, axe: str):
    page = robot_page
    header, blocks = asked("robot_parts", "robot-antennas")
    bands = len(header["bands"]) + len(header["cords"])
    corners, triangles = len(blocks["corners"]) + 24 * bands, len(blocks["triangles"]) + 12 * bands
    words = page.get_by_text("in one batch").inner_text().replace(" ", "")
    assert f"{corners}vertices,{triangles}triangles" in words
    # Laptops draw a hundred times as many in a frame.
    assert corners < 20_000
    nothing_found(page, axe, "[role=tabpanel]")

    rest = picture(page)
    assert 0.05 < drawn(rest).mean() < 0.6
    slid(page, "Stroke", str(len(blocks["drive"]) // 3))
    moved = picture(page)
    assert (drawn(rest) != drawn(moved)).mean() > 0.005
    page.get_by_role("checkbox", name="antenna left pressed").check()
    assert (drawn(moved) != drawn(picture(page))).mean() > 0.002
    page.get_by_role("checkbox", name="antenna left pressed").uncheck()
    slid(page, "Exploded view", "1")
    apart = picture(page)
    assert np.ptp(np.flatnonzero(drawn(apart).any(axis=1))) > 20 and (apart != moved).mean() > 0.05
    slid(page, "Exploded view", "0")
    assert (picture(page) != moved).mean() < 0.001

    # What the pointer is on is named.
    rows, columns = np.nonzero(drawn(moved))
    k = len(rows) // 2
    space(page).hover(position={"x": float(EDGE + columns[k]), "y": float(EDGE + rows[k])})
    expect(output(page, "part")).not_to_contain_text("Point at a part")
    name = output(page, "part").inner_text()
    known = {one["name"] for key in ("parts", "bands") for one in header[key]}
    assert name.partition(": ")[0] in known
    space(page).hover(position={"x": 4, "y": 4})
    expect(output(page, "part")).to_contain_text("Point at a part")

    # Wheel, hand and keys turn the view and come closer.
    space(page).hover(position={"x": 60, "y": 60})
    page.mouse.wheel(0, -300)
    closer = picture(page)
    assert drawn(closer).mean() > 1.2 * drawn(moved).mean()
    page.mouse.down()
    page.mouse.move(200, 300, steps=3)
    page.mouse.up()
    turned = picture(page)
    assert (turned != closer).mean() > 0.05
    page.get_by_role("application", name=re.compile("parts in 3D")).focus()
    for key in ("ArrowLeft", "-"):
        page.keyboard.press(key)
    assert (picture(page) != turned).mean() > 0.05


def test_bands_have_the_colour_of_their_tension(robot_page: Page):
    page = robot_page
    header, blocks = asked("robot_parts", "robot-antennas")
    for one in {"cords", *(part["role"] for part in header["parts"])}:
        page.get_by_role("checkbox", name=one, exact=True).uncheck()
    for k in (0, int(blocks["tension"][0, :, 0].argmax())):
        slid(page, "Stroke", str(k))
        pixels = picture(page)
        seen = pixels[drawn(pixels)]
        # Light makes a face brighter or darker, and keeps its hue.
        seen = seen / seen.max(axis=1, keepdims=True)
        for share in blocks["tension"][0, k]:
            colour = np.array(tension_colour(float(share))[:3])
            off = np.abs(seen - colour / colour.max()).max(axis=1)
            assert (off < 0.05).sum() > 20, (k, share)
    page.get_by_role("checkbox", name=re.compile("bands")).uncheck()
    assert not drawn(picture(page)).any()


def test_an_edit_ends_the_work_and_the_parts_of_the_new_design_follow(robot_page: Page):
    page = robot_page
    page.evaluate(
        """() => {
          window.ended = 0;
          const send = WebSocket.prototype.send;
          WebSocket.prototype.send = function (message) {
            if (JSON.parse(message).type === "cancel") window.ended += 1;
            send.call(this, message);
          };
        }"""
    )
    field = page.get_by_role("spinbutton", name="q of outer, x in mm")
    for value in ("18", "19"):
        field.fill(value)
        field.press("Enter")
        expect(page.get_by_text("Building the parts…")).to_be_visible()
    assert page.evaluate("window.ended") >= 1
    for _ in range(2):
        page.get_by_role("button", name="Undo").click()
    settled(page)
    expect(page.get_by_text("Building the parts…")).to_have_count(0)
    expect(space(page)).to_have_count(1)


def test_on_a_phone_the_robot_fits_and_two_fingers_come_closer(robot_page: Page):
    page = robot_page
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    before = drawn(picture(page)).mean()
    assert before > 0.05
    space(page).evaluate(
        """(canvas) => {
          const { left, top, width, height } = canvas.getBoundingClientRect();
          canvas.setPointerCapture = canvas.releasePointerCapture = () => {};
          const send = (type, pointerId, x) =>
            canvas.dispatchEvent(new PointerEvent(type, {
              pointerId, pointerType: "touch", bubbles: true,
              clientX: left + x * width, clientY: top + height / 2 }));
          send("pointerdown", 1, 0.4);
          send("pointerdown", 2, 0.6);
          send("pointermove", 1, 0.3);
          send("pointermove", 2, 0.7);
          send("pointerup", 1, 0.3);
          send("pointerup", 2, 0.7);
        }"""
    )
    assert drawn(picture(page)).mean() > 1.3 * before


def test_without_webgl_and_for_a_robot_that_cannot_be_cut_the_panel_says_why(
    blank: Opened, empty_address: str
):
    page = begun(blank.page, empty_address, "robot-explorer")
    page.get_by_role("tab", name="Parts").click()
    expect(output(page, "robot parts")).to_contain_text("right-body-top", timeout=PATIENT)
    page.get_by_role("button", name="Leg as a chain").click()
    page.get_by_role("group", name="Plan of the parts").wait_for()
    begun(page, empty_address, "robot-forward")
    page.get_by_role("tab", name="Parts").click()
    page.get_by_role("button", name="Whole robot").click()
    panel = page.get_by_role("tabpanel")
    expect(panel.get_by_role("status", name="3D view")).to_contain_text("no WebGL")


def test_the_colours_of_parts_are_those_of_the_figures():
    text = (Path(__file__).parents[2] / "studio/src/robot/roles.ts").read_text("utf-8")
    table = text.split("const ROLES")[1].split("};")[0]
    listed = dict(re.findall(r'"?([a-z][a-z ]*)"?: "(#\w{6})"', table))
    assert {role: colour.upper() for role, colour in listed.items()} == {
        str(role): colour.upper() for role, colour in figure._COLOURS.items()
    }
