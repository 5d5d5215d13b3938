"""Four pictures of the README, what one can do: `python 00_pictures_of_the_front_page.py`.

All are of one size, and every number and curve in them is computed here.
"""

import math
import sys
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import stepwell as sw
from stepwell import figures
from stepwell.figures.cells.linkage import Drawing
from stepwell.figures.common.marks import plain
from stepwell.figures.common.sheet import blank, place, text_at
from stepwell.figures.common.style import (
    BLUE,
    COLUMN,
    FAINT,
    GREEN,
    INK,
    LOADING,
    MM,
    UNLOADING,
    pale,
    styled,
)
from stepwell.mechanism.layout import ChainLayout

# 640 by 400 pixels.
TALL = COLUMN * 400 / 640
BIG = 8.5
# What is wished for, and what a careful workshop can hold, as `stepwell design` takes it to be.
WISH, PATHWAY = "00>01>11>10>00", "counterclockwise"
WORKSHOP = sw.Tolerances(anchor=0.0003, stiffness=0.05)
HOLES = 0.005


@styled
def see() -> Figure:
    """States of a leg, and the force that its actuator feels."""
    cycle = sw.preset("paper-forward").cycle()
    figure = blank(COLUMN, TALL)
    linkage = ChainLayout(cycle.chain)
    states = list(cycle.sequence)[:-1]
    full = np.array(cycle.chain.full_travels)
    left, bottom, _, top = linkage.bounds([[0.0, 0.0], full])
    scale, high = 250.0, TALL / len(states)
    ax = place(figure, 0.0, 0.0, 32.0, TALL)
    plain(ax, (0.0, 32.0, 0.0, TALL))
    for k, state in enumerate(states):
        y = TALL - (k + 0.5) * high
        origin = 9.5 - left * scale, y - (bottom + top) / 2 * scale
        Drawing(ax, linkage, origin, scale, 0.62).move([int(c) for c in state] * full)
        ax.text(1.5, y, state, fontsize=BIG, fontweight="bold", va="center")
    ax = place(figure, 48.5, 9.5, 35.0, 37.5)
    figures.force_stroke(cycle, ax=ax)
    key = ax.get_legend()
    assert key is not None
    key.remove()
    for x, word, colour in ((40.0, "loading", LOADING), (58.0, "unloading", UNLOADING)):
        text_at(figure, x, TALL - 5.0, word, color=colour, fontsize=BIG, fontweight="bold")
    return figure


@styled
def want() -> Figure:
    """Anchors for a target sequence, on the map of the outer anchor."""
    made = sw.design(WISH, tolerances=WORKSHOP)
    assert made.yield_ is not None
    x, y = np.linspace(-0.005, 0.020, 121), np.linspace(-0.015, 0.015, 145)
    shown = sw.transition_map(made.chain, "outer", x=x, y=y)
    words = shown["pathway"].attrs["flag_meanings"].split()
    wished = words.index(PATHWAY)
    does = np.asarray(shown["pathway"] == wished, float)
    figure = blank(COLUMN, TALL)
    ax = place(figure, 12.5, 9.5, 32.0, 38.4)
    look = {"colors": ["#F2F2F2", pale(GREEN, 0.55)], "levels": [-0.5, 0.5, 1.5]}
    ax.contourf(x * MM, y * MM, does, **look)
    ax.contour(x * MM, y * MM, does, levels=[0.5], colors=[INK], linewidths=0.8)
    q = np.array(made.chain.levers[1].bands[0].q) * MM
    ax.plot(*q, "*", markersize=13, color=INK, markeredgecolor="white", zorder=5, clip_on=False)
    ax.text(7.0, -13.8, "target", ha="center", fontsize=BIG)
    ax.text(19.5, 12.3, "other", ha="right", fontsize=BIG)
    ax.set(xlabel="Outer anchor $q_x$ [mm]", ylabel="$q_y$ [mm]", aspect="equal")
    rows = [("target", WISH, INK), ("outer anchor $q$", point(q), INK)]
    rows.append(("anchors ±0.3 mm", surely(made.yield_), GREEN))
    tell(figure, 47.0, rows)
    return figure


@styled
def real() -> Figure:
    """The yield against the tolerance of the anchors."""
    leg = sw.preset("paper-forward")
    off = np.arange(0.0, 6.01, 0.5)
    found = [leg.yields(sw.Tolerances(anchor=a / MM, stiffness=0.05), samples=20_000) for a in off]
    share = np.array([one.fraction for one in found]) * 100
    low, high = (np.array([one.interval[k] for one in found]) * 100 for k in (0, 1))
    figure = blank(COLUMN, TALL)
    ax = place(figure, 15.0, 10.0, 67.0, 40.0)
    ax.fill_between(off, low, high, color=pale(BLUE, 0.6), linewidth=0)
    ax.plot(off, share, color=BLUE, linewidth=2.2)
    ax.set(xlabel="Anchor tolerance ± [mm]", ylabel="Yield [%]")
    ax.set(xlim=(0.0, 6.0), ylim=(75.0, 102.0))
    safe = off[low > 99.9][-1]
    ax.axvline(safe, color=FAINT, linewidth=0.8, linestyle=(0, (3, 2)))
    ax.text(safe + 0.15, 84.5, f"up to ±{safe:g} mm:\nover 99.9 %", fontsize=BIG, color=BLUE)
    ax.text(safe + 0.15, 77.0, "20,000 samples,\nstiffness ±5 %", fontsize=BIG)
    return figure


def build() -> Figure:
    """Holes to drill for a target sequence, as `stepwell design --out` draws them."""
    made = sw.design(WISH, holes=HOLES, tolerances=WORKSHOP)
    assert made.yield_ is not None
    title = f"{WISH}: {surely(made.yield_)}"
    draw = partial(figures.holes, made.chain, HOLES)
    figure = figures.compose({title: [draw]}, width=120.0)
    # Rows a little further apart, for the size of the other pictures.
    figure.set_size_inches(120.0 / 25.4, 75.0 / 25.4)
    return figure


def surely(found: sw.Yield) -> str:
    """The lower bound of the yield, in words."""
    low = math.floor(found.interval[0] * 1e4) / 100
    return f"yield over {low:g} %"


def point(q: np.ndarray) -> str:
    """An anchor as text."""
    return f"({q[0]:.3g}, {q[1] + 0.0:.2g}) mm".replace("-", "\N{MINUS SIGN}")


def tell(figure: Figure, x: float, rows: list[tuple[str, str, str]]) -> None:
    """Words and below each what they stand for."""
    for k, (word, value, colour) in enumerate(rows):
        y = TALL - 8.0 - 14.0 * k
        text_at(figure, x, y, word, fontsize=7.5)
        text_at(figure, x, y - 5.0, value, fontsize=BIG, fontweight="bold", color=colour)


def draw(folder: Path) -> None:
    """Write the four pictures into `folder`."""
    for make in (see, want, real, build):
        figure = make()
        figures.save(figure, folder / f"{make.__name__}.png", dpi=640 / figure.get_figwidth())


if __name__ == "__main__":
    pages = Path(__file__).resolve().parents[1] / "docs" / "img"
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else pages)
