"""The page draws a chain as the figures do: same positions, same colours, same bands."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex

import stepwell as sw
from stepwell.base import Floats
from stepwell.figures.common.style import BLOCK, FIXED_BLOCK, cell_colours
from stepwell.mechanism import Chain, layout
from stepwell.studio.motion import drawn
from stepwell.studio.standalone import replay
from studio.browser import Opened, opens

# Coordinates of the parts of the drawing: attributes, or the points of a path.
PLACES = """
() => {
  const all = (name) => [...document.querySelectorAll(`.drawing ${name}`)];
  const numbers = (text) => text.match(/-?[\\d.]+(e-?\\d+)?/g).map(Number);
  const attributes = (name, ...keys) =>
    all(name).map((one) => keys.map((key) => Number(one.getAttribute(key))));
  const paths = (name) => all(name).map((one) => numbers(one.getAttribute("d")));
  const bands = all(".band");
  return {
    blocks: attributes(".block", "x", "y", "width", "height"),
    boxes: attributes(".box", "x", "y", "width", "height"),
    dots: attributes(".at", "cx", "cy"),
    lines: paths("path.lever"),
    bands: paths(".band"),
    posts: paths(".post"),
    wall: paths(".wall"),
    curves: paths(".element"),
    shades: bands.map((one) => one.getAttribute("stroke")),
    widths: bands.map((one) => Number(one.getAttribute("stroke-width"))),
    slack: bands.map((one) => one.hasAttribute("stroke-dasharray")),
    faces: all(".block").map((one) => getComputedStyle(one).fill),
  };
}
"""
NEAR = 1e-6  # [mm]


def up(places: list[list[float]]) -> Floats:
    """Points (n, 2) of a page, y up."""
    return np.array(places, float).reshape(-1, 2) * (1.0, -1.0)


def boxes(places: list[list[float]]) -> Floats:
    """(n, 4) left, bottom, right, top of a page's rectangles, y up."""
    x, y, wide, high = np.array(places, float).reshape(-1, 4).T
    return np.column_stack([x, -y - high, x + wide, -y])


def millimetres(places: Floats, *shape: int) -> Floats:
    return 1e3 * places.reshape(shape)


@pytest.mark.parametrize(
    "name",
    [
        *("paper-forward", "three-wave", "paper-forward-double", "slack", "countdown"),
        *("curved-beam", "balloon", "kresling", "compliant-actuator"),
    ],
)
def test_a_replay_has_the_coordinates_of_the_figure(offline: Opened, tmp_path: Path, name: str):
    chain = sw.preset(name)
    assert isinstance(chain, Chain)
    page = opens(offline, tmp_path, replay(chain))
    path = chain.cycle().path
    few = drawn(path)
    figure = layout.ChainLayout(chain, [path.travel.min(axis=0), path.travel.max(axis=0)])
    slider = page.get_by_role("slider", name="Stroke")
    for k in (0, len(few.drive) // 3, int(few.drive.argmax()), len(few.drive) - 5):
        slider.fill(str(k))
        found: dict[str, Any] = page.evaluate(PLACES)
        pose = figure.pose(few.travel[k], few.sheet[k].tolist())
        assert boxes(found["blocks"]) == pytest.approx(1e3 * pose.blocks, abs=NEAR)
        assert boxes(found["boxes"]) == pytest.approx(1e3 * pose.boxes, abs=NEAR)
        assert up(found["dots"]) == pytest.approx(1e3 * pose.dots, abs=NEAR)
        lines = np.concatenate([pose.rods, pose.levers])
        assert up(found["lines"]) == pytest.approx(millimetres(lines, -1, 2), abs=NEAR)
        assert up(found["bands"]) == pytest.approx(millimetres(pose.bands, -1, 2), abs=NEAR)
        assert up(found["posts"]) == pytest.approx(millimetres(pose.posts, -1, 2), abs=NEAR)
        assert up(found["wall"]) == pytest.approx(millimetres(figure.wall, -1, 2), abs=NEAR)
        assert found["slack"] == pose.slack.tolist()
        # Tighter bands are thicker.
        taut = ~pose.slack
        assert np.array_equal(
            np.argsort(np.array(found["widths"])[taut].round(6), kind="stable"),
            np.argsort(np.abs(pose.tension)[taut].round(9), kind="stable"),
        )


def test_an_elements_curve_is_that_of_the_figure(offline: Opened, tmp_path: Path):
    chain = sw.preset("von-mises-truss")
    assert isinstance(chain, Chain)
    path = chain.cycle().path
    found = opens(offline, tmp_path, replay(chain)).evaluate(PLACES)
    figure = layout.ChainLayout(chain, [path.travel.min(axis=0), path.travel.max(axis=0)])
    corners = 1e3 * figure.pose(path.travel[0], path.sheet[0].tolist()).boxes[:, :2]
    side = 1e3 * figure.box
    curves = [
        corner + side * curve
        for corner, symbol in zip(corners, figure.symbols.values(), strict=True)
        for curve in symbol.curves
    ]
    for curve, drawn_curve in zip(curves, found["curves"], strict=True):
        for point in up(drawn_curve):
            assert np.hypot(*(curve - point).T).min() < 0.002 * side


@pytest.mark.parametrize("name", ["metachronal-wave", "four-shuffle"])
def test_a_light_page_has_the_colours_of_the_figures(offline: Opened, tmp_path: Path, name: str):
    chain = sw.preset(name)
    assert isinstance(chain, Chain)
    offline.page.emulate_media(color_scheme="light")
    found = opens(offline, tmp_path, replay(chain)).evaluate(PLACES)
    owners = layout.ChainLayout(chain).owner
    assert found["shades"] == [to_hex(cell_colours(len(chain))[i]) for i in owners]
    faces = [
        "#" + "".join(f"{int(one):02X}" for one in re.findall(r"\d+", face))
        for face in found["faces"]
    ]
    assert faces == [FIXED_BLOCK] + [BLOCK] * len(chain)


def test_the_page_knows_every_colour_of_the_figures():
    text = (Path(__file__).parents[2] / "studio" / "src" / "colours.ts").read_text("utf-8")
    light, _ = text.split("const DARK")
    listed = re.findall(r'"(#\w{6})"', light)
    assert [one.upper() for one in listed] == [one.upper() for one in cell_colours(len(listed))]
