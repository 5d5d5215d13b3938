"""The table and the figure of docs/jump-scaling.md: height of a jump against mass, band and size.

`python tests/docs/jump_scaling.py --simulate` computes all curves, simulates the points (a minute)
and writes docs/jump-scaling.json; without it the figure and the table are made of that file.
"""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import stepwell as sw
from stepwell.base import number
from stepwell.figures import svg
from stepwell.figures.common import legends
from stepwell.figures.common.sheet import blank, place
from stepwell.figures.common.style import BLACK, BLUE, FAINT, PAGE as WIDE, VERMILLION, styled
from stepwell.mechanism import Band, Cell
from stepwell.robot import Hopper, after_stop, bound_of, predicted_stop, release

ROOT = Path(__file__).parents[2]
PAGE, FILE = ROOT / "docs" / "jump-scaling.md", ROOT / "docs" / "jump-scaling.json"
PICTURE = ROOT / "docs" / "img" / "jump-scaling.svg"
# Of the springs of the hopper, and of rubber as the paper measured it.
LOSSES = {"steel": 0.01, "rubber": 0.25}
# What is varied: a label, the values of the curve and those of the simulated points.
VARIED = {
    "mass": ("all masses, times", (0.1, 30.0), (0.25, 1.0, 4.0)),
    "stiffness": ("stiffness of the bands, times", (0.2, 10.0), (0.5, 4.0)),
    "size": ("all lengths, times", (0.1, 10.0), (0.4, 2.5)),
    "pairs": ("pairs of cells side by side", (1.0, 32.0), (1.0, 8.0)),
}
# Masses of the hopper [kg]: of each chain on the body and on the foot, of its outer block, of the
# actuator and of the sole.
ON_BODY, ON_FOOT, OUTER, ACTUATOR, SOLE = 0.070, 0.075, 0.035, 0.050, 0.020
POINTS = 41


def changed(what: str, by: float, springs: str = "steel") -> Hopper:
    """The hopper with one quantity varied, and an actuator that is strong enough."""
    one = sw.load("preset:hopper")
    one = replace(one, springs=replace(one.springs, loss=LOSSES[springs]))
    one = replace(one, actuator=replace(one.actuator, force=1e6))
    if what == "mass":
        return _masses(one, by)
    if what == "stiffness":
        return replace(one, chain=_chain(one, partial(_scaled, stiffness=by)))
    if what == "size":
        one = replace(one, chain=_chain(one, partial(_scaled, length=by, stiffness=by, rub=by**2)))
        lengths = {name: by * getattr(one, name) for name in ("height", "foot_length", "body_size")}
        return _masses(replace(one, damping=by**2 * one.damping, **lengths), by**3)
    return replace(
        one,
        copies=round(by),
        body_mass=ACTUATOR + by * ON_BODY,
        foot_mass=SOLE + by * ON_FOOT,
        block_mass=by * OUTER,
        damping=by / 2 * one.damping,
    )


def _masses(one: Hopper, by: float) -> Hopper:
    names = ("body_mass", "foot_mass", "block_mass")
    springs = replace(one.springs, mass=by * one.springs.mass)
    return replace(one, springs=springs, **{name: by * getattr(one, name) for name in names})


def _chain(one: Hopper, change: Any) -> sw.Chain:
    return replace(one.chain, cells=tuple(change(cell) for cell in one.chain.levers))


def _scaled(cell: Cell, length: float = 1.0, stiffness: float = 1.0, rub: float = 1.0) -> Cell:
    (old,) = cell.bands
    p, q = ((length * x, length * y) for x, y in (old.p, old.q))
    band = Band(p, q, stiffness * old.stiffness, length * old.rest_length)
    return replace(cell, band=band, lever=length * cell.lever, friction=rub * cell.friction)


def limit(one: Hopper) -> float:
    """n k S²/(M g) [m]: the height from k S² of each of n chains."""
    cell = one.chain.levers[0]
    energy = one.copies * cell.bands[0].stiffness * cell.full_travel**2
    return energy / (one.mass * one.gravity)


def heights(one: Hopper) -> tuple[float, float]:
    """Bound and model of the height [m]; zero where no snap lifts the body."""
    snap = release(one.whole, one.foot_after, one.load)
    if snap is None:
        return 0.0, 0.0
    stop = predicted_stop(one, snap)
    return bound_of(one, snap).height, after_stop(one, snap, stop).height


def curves() -> dict[str, Any]:
    """Heights of all curves [mm], against the varied value."""
    found: dict[str, Any] = {}
    for what, (_, ends, _) in VARIED.items():
        values = np.geomspace(ends[0], ends[1], POINTS)
        if what == "pairs":
            values = np.unique(values.round())
        rows = []
        for by in values.tolist():
            steel, rubber = (changed(what, by, one) for one in LOSSES)
            bound, model = heights(steel)
            rows.append([by, limit(steel), bound, model, heights(rubber)[1]])
        table = np.array(rows)
        table[:, 1:] *= 1e3
        found[what] = np.vectorize(lambda x: float(f"{x:.5g}"))(table).tolist()
    return found


def simulated() -> list[dict[str, Any]]:
    """The points, each a simulated jump."""
    found = []
    for what, (_, _, values) in VARIED.items():
        for by in values:
            for springs in LOSSES:
                one = changed(what, by, springs)
                jump = sw.simulation.jump(one, halve=0)
                bound, model = heights(one)
                found.append(
                    {
                        "varied": what,
                        "times": by,
                        "springs": springs,
                        "mass_g": 1e3 * one.mass,
                        "limit_mm": 1e3 * limit(one),
                        "bound_mm": 1e3 * bound,
                        "model_mm": 1e3 * model,
                        "height_mm": 1e3 * jump.first.height,
                        "efficiency": jump.first.flow.efficiency,
                        "balance": jump.balance,
                    }
                )
                print(found[-1], flush=True)
    return found


def record() -> dict[str, Any]:
    """What was computed."""
    return json.loads(FILE.read_text("utf-8"))


def table() -> str:
    """The simulated points beside limit, bound and model."""
    lines = [
        "| varied | times | M [g] | springs | k S²/(M g) [mm] | bound [mm] | "
        "model [mm] | simulated [mm] |",
        "|---" * 8 + "|",
    ]
    for row in record()["points"]:
        sizes = (number(row[f"{name}_mm"], 3) for name in ("limit", "bound", "model", "height"))
        head = f"{row['varied']} | {row['times']:g} | {number(row['mass_g'], 3)} | {row['springs']}"
        lines.append(f"| {head} | {' | '.join(sizes)} |")
    return "\n".join(lines)


def written(text: str) -> str:
    """The page with its table as it should be."""
    begin, end = "<!-- points: written by tests/docs/jump_scaling.py -->", "<!-- end -->"
    new = f"{begin}\n\n{table()}\n\n{end}"
    return re.sub(f"{re.escape(begin)}.*?{end}", lambda _: new, text, flags=re.S)


LINES = {
    "k S²/(M g)": (1, FAINT, (0, (4, 1.5))),
    "bound": (2, BLACK, "-"),
    "model, steel": (3, BLUE, "-"),
    "model, rubber": (4, VERMILLION, "-"),
}
MARKS = {"steel": ("o", BLUE), "rubber": ("s", VERMILLION)}


@styled
def picture() -> Any:
    """A panel for each varied quantity: limit, bound, models and simulated jumps."""
    made, gap, left, foot, high = record(), 18.0, 15.0, 20.0, 42.0
    wide = (WIDE - left - gap - 4.0) / 2
    figure = blank(WIDE, 2 * high + foot + 17.0)
    for k, (what, (label, _, _)) in enumerate(VARIED.items()):
        x, y = left + (k % 2) * (wide + gap), foot + (1 - k // 2) * (high + 13.0)
        ax = place(figure, x, y, wide, high)
        rows = np.array(made["curves"][what])
        for column, colour, dashes in LINES.values():
            shown = rows[:, column] > 0.0
            ax.plot(rows[shown, 0], rows[shown, column], color=colour, linestyle=dashes)
        for point in (one for one in made["points"] if one["varied"] == what):
            mark, colour = MARKS[point["springs"]]
            look = {"markerfacecolor": "white", "markeredgecolor": colour, "zorder": 5}
            ax.plot(point["times"], point["height_mm"], mark, markersize=4.5, clip_on=False, **look)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlim(rows[0, 0], rows[-1, 0])
        ax.set_ylim(*((1.0, 5e3) if what in ("mass", "stiffness") else (10.0, 1e3)))
        if what == "pairs":
            ax.set_xticks([1, 2, 4, 8, 16, 32])
            ax.minorticks_off()
        ax.set_xlabel(label)
        ax.set_ylabel("height [mm]")
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_formatter(lambda at, _: f"{at:g}")
            axis.set_minor_formatter(lambda at, _: "")
    handles = [
        legends.line(name, colour, 1.4, linestyle=dashes)
        for name, (_, colour, dashes) in LINES.items()
    ]
    for springs, (mark, colour) in MARKS.items():
        look: dict[str, Any] = {"markerfacecolor": "white", "markeredgecolor": colour}
        handles.append(legends.mark(f"simulated, {springs}", mark, **look))
    legends.below(figure, handles, 3)
    return figure


def drawn() -> str:
    return svg(picture())


if __name__ == "__main__":
    if "--simulate" in sys.argv[1:]:
        FILE.write_text(json.dumps({"curves": curves(), "points": simulated()}, indent=1) + "\n")
    PICTURE.write_text(drawn(), "utf-8")
    PAGE.write_text(written(PAGE.read_text("utf-8")), "utf-8")
