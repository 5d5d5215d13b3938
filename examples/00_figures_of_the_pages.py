"""The pictures of the README and of the pages, drawn anew: `python 00_figures_of_the_pages.py`."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

import stepwell as sw
from stepwell import figures
from stepwell.design import boundaries

DPI = 130


def draw(folder: Path) -> None:
    """Write every picture into `folder`."""
    leg = sw.preset("paper-forward")
    cycle = leg.cycle()
    figures.save(figures.overview(cycle), folder / "overview.png", dpi=DPI)

    x, y = np.linspace(0.0, 0.020, 200), np.linspace(-0.015, 0.015, 200)
    shown = sw.transition_map(leg, "outer", x=x, y=y)
    curves = boundaries(leg, "outer", x=x, y=y)
    design = {"this leg": leg.cells[1].bands[0].q}
    figures.save(figures.transition_map(shown, curves, design), folder / "map.png", dpi=DPI)

    just_past = cycle.snaps[0].stroke + 0.0001
    turned = leg.path([0.020, just_past, 0.020], start="10")
    figures.save(figures.landscape(turned), folder / "turned-back.png", dpi=DPI)

    loading = three_cells().path([0.0, 0.060])
    figures.save(figures.travel_stroke(loading), folder / "left-half-way.png", dpi=DPI)

    # The drawings with the letters; the cell is the paper's with q = (10, -15) mm.
    figures.save(figures.labelled_cell(), folder / "unit-cell.svg")
    figures.save(figures.labelled_chain(leg), folder / "leg.svg")
    figures.save(by_hand(), folder / "by-hand.svg")

    library = {name: entry.make() for name, entry in sw.elements.LIBRARY.items()}
    figures.save(figures.element_curves(library), folder / "elements.png", dpi=DPI)


def by_hand() -> Figure:
    """A band on a nail beside a ruler, and a cell on a kitchen scale."""
    ink, faint, band, hand = "#222222", "#8A8A8A", "#D55E00", "#0072B2"
    figure = Figure(figsize=(180 / 25.4, 88 / 25.4))
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, 180), ylim=(0, 88), aspect="equal")
    ax.set_axis_off()
    words: dict[str, Any] = {"fontsize": 8.5, "color": ink, "va": "center"}
    moved: dict[str, Any] = {**words, "color": hand}
    quiet: dict[str, Any] = {**words, "color": faint}

    def arrow(low: float, high: float, x: float, colour: str, kind: str = "<->") -> None:
        look = {"arrowstyle": kind, "color": colour, "linewidth": 1.1, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", (x, high), (x, low), arrowprops=look)

    # Left: nail, ruler, band with its two marks, a bag of coins.
    ax.add_patch(Rectangle((14, 6), 9, 72, facecolor="#F4F0DC", edgecolor=faint))
    for k in range(0, 71, 2):
        ax.plot([23 - (4 if k % 10 == 0 else 2), 23], [7 + k, 7 + k], color=faint, linewidth=0.6)
    ax.plot([38], [77], marker="o", color=ink, markersize=6)
    ax.plot([35.5, 38, 40.5, 40.5, 38, 35.5, 35.5], [75, 77, 75, 37, 35, 37, 75], color=band, lw=2)
    for y in (70, 42):
        ax.plot([33.5, 42.5], [y, y], color=ink, linewidth=1.6)
    ax.plot([38, 38], [35, 29], color=ink, linewidth=1)
    ax.add_patch(
        Polygon([(31, 12), (45, 12), (42, 28), (34, 28)], facecolor="#DCDCDC", edgecolor=ink)
    )
    arrow(42, 70, 47, ink)
    ax.text(49, 56, "length between\nthe marks", ha="left", **words)
    ax.text(38, 20, "weight", ha="center", **words)
    ax.text(42, 79, "nail", ha="left", **words)
    ax.text(18.5, 82, "ruler", ha="center", **words)

    # Right: a cell without its band, its inner block on the scale, the outer one moved by hand.
    ax.add_patch(Rectangle((96, 6), 66, 9, facecolor="#DCDCDC", edgecolor=ink))
    ax.text(129, 10.5, "kitchen scale", ha="center", **words)
    lever, up = 22.0, np.deg2rad(20.0)
    side, rise = lever * np.cos(up), lever * np.sin(up)
    joints = [(114.0, 29.0), (114.0, 43.0)]
    inner = Rectangle((106, 15), 16, 36, facecolor="#A8A8A8", edgecolor=ink, linewidth=1.2)
    outer = Rectangle((106 + side, 22 + rise), 16, 28, facecolor="white", edgecolor=ink, lw=1.2)
    ax.add_patch(inner)
    ax.add_patch(outer)
    for x, y in joints:
        ax.plot([x, x + side], [y, y + rise], color=ink, linewidth=3, solid_capstyle="round")
        for joint in ((x, y), (x + side, y + rise)):
            ax.plot(*joint, marker="o", color="white", markeredgecolor=ink, markersize=5)
    top, middle = 50 + rise, 114 + side
    arrow(top + 3, top + 19, middle, hand)
    ax.text(middle - 3, top + 13, "slowly down,\nslowly up", ha="right", **moved)
    ax.text(112, 56, "r, joint to joint", ha="center", **words)
    stop = lever * np.sin(np.deg2rad(45.0))
    for way, name in ((-1, "stop"), (1, "stop")):
        y = 50 + way * stop
        ax.plot([147, 168], [y, y], color=faint, linewidth=0.8, linestyle=(0, (4, 3)))
        ax.text(169, y, name, ha="left", **quiet)
    arrow(50 - stop, 50 + stop, 158, ink)
    ax.text(160, 50, "travel S", ha="left", **words)
    return figure


def three_cells() -> sw.Chain:
    """The chain of the theory page, "Sorting", in which a is left half way instead of c."""
    bands = {
        "a": ((0.009405, 0.002068), 53.935),
        "b": ((0.018983, -0.008699), 55.823),
        "c": ((0.008011, -0.010351), 15.018),
    }
    return sw.Chain(
        tuple(sw.Cell(sw.Band((0.0, 0.0), d, k), name=name) for name, (d, k) in bands.items())
    )


if __name__ == "__main__":
    pages = Path(__file__).resolve().parents[1] / "docs" / "img"
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else pages)
