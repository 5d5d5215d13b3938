"""Figures of the paper, computed with the model, and the contents of their folder."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import stepwell as sw
from stepwell import base, figures, sequences
from stepwell.accounts import Account
from stepwell.design import boundaries, transition_map
from stepwell.paper import PAIRS, monostable_pair, outer_anchor, pair_cycle, six_cells
from stepwell.reports.write import Content, Contents

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# Width of a page with five rows of three panels [mm].
_NARROW = 165.0


def unit_cells() -> Figure:
    """Force and energy of the six unit cells over the angle of their lever (Figs. 1D and 1E)."""
    cells = list(six_cells().values())
    drawn = figures.unit_cell_force, figures.unit_cell_energy
    return figures.compose([partial(draw, cells) for draw in drawn])


def pathways() -> Figure:
    """Energy, force and travels of a pair for each pathway (Figs. 2B and 2D to 2G). A further pair
    has a monostable outer cell.
    """
    lone = monostable_pair()
    name = f"Outer monostable: q = ({_mm(lone.chain.levers[1].bands[0].q)}) mm"
    drawn = figures.landscape, figures.force_stroke, figures.travel_stroke
    pairs = (_pairs() | {name: lone}).items()
    rows = {name: [partial(draw, one) for draw in drawn] for name, one in pairs}
    return figures.compose(rows, width=_NARROW)


def map_() -> Figure:
    """Pathways over the anchor of the outer cell, with the four pairs marked (Fig. 2C)."""
    x, y = np.linspace(0.0, 0.020, 400), np.linspace(-0.015, 0.015, 400)
    chain = pair_cycle(sequences.Pathway.CLOCKWISE).chain
    marked = {f"({_mm(outer_anchor(p))})": outer_anchor(p) for p in PAIRS}
    dataset = transition_map(chain, 1, x=x, y=y)
    return figures.transition_map(dataset, boundaries(chain, 1, x=x, y=y), marked)


Drawings = dict[str, Callable[[], "Figure"]]
FIGURES: Drawings = {"fig1": unit_cells, "fig2": pathways, "fig2c": map_}


def gaits() -> Figure:
    """Paths of the paper's four robots (Figs. 3C to 3E)."""
    names = {
        "forward: q_out = 20 mm": "forward",
        "backward: q_out = 5 mm": "backward",
        "one leg of each kind": "left",
        "q_out = 15 mm": "15",
    }
    return figures.trajectories({label: sw.paper.walk_of(name) for label, name in names.items()})


def three_walls() -> Figure:
    """A robot with antennas past three walls, from above and over time (Fig. 4D)."""
    run = sw.simulation.maze(sw.paper.robot("explorer"), sw.files.load_arena("three-walls"))
    return figures.compose([partial(figures.maze, run), partial(figures.maze_timeline, run)])


def tornado() -> Figure:
    """Sensitivity of the robot's results to every assumed parameter."""
    return figures.tornado(sw.paper.sensitivities())


# Figures that need the simulator.
ROBOT_FIGURES: Drawings = {"fig3": gaits}
MANY_RUNS: Drawings = {"fig4": three_walls, "robot-tornado": tornado}


def _pairs() -> dict[str, sequences.Cycle]:
    pairs: dict[str, sequences.Cycle] = {}
    for cycle in map(pair_cycle, PAIRS):
        words = cycle.pathway.label if cycle.pathway else str(cycle.sequence)
        q = _mm(cycle.chain.levers[1].bands[0].q)
        pairs[f"{words.capitalize()}: outer q = ({q}) mm"] = cycle
    return pairs


def _mm(q: tuple[float, float]) -> str:
    return ", ".join(f"{base.to_unit(part, 'mm'):g}" for part in q).replace("-", "\N{MINUS SIGN}")


def paper_contents(_: sw.paper.Verdicts, _account: Account, everything: bool = False) -> Contents:
    """Contents of the verdicts: the paper's figures; `everything` adds the longest simulations."""
    files: dict[str, Content] = {}
    simulated = ROBOT_FIGURES | (MANY_RUNS if everything else {})
    for name, draw in (FIGURES | (simulated if base.have("robot") else {})).items():
        # Drawn only when its first file is written, because some take minutes.
        drawn = cache(draw)

        def save(file: Path, drawn: Callable[[], Figure] = drawn) -> None:
            figures.save(drawn(), file)

        files |= {f"{name}.png": save, f"{name}.svg": save}
    return Contents("paper", "claims.json", files)


def figure_of(name: str) -> Figure:
    """A figure of the paper, computed with the model.

    Args:
        name: fig1 (Figs. 1D, 1E), fig2 (2B, 2D to 2G), fig2c, fig3 (3C to 3E), fig4 (4D), or
            robot-tornado. Robot figures need simulations, the last two many.

    Raises:
        ValueError: an unknown name.
        ExtraError: the simulator is not installed.
    """
    every = FIGURES | ROBOT_FIGURES | MANY_RUNS
    if name not in every:
        near = base.nearest_word(name, every)
        guess = f"Did you mean {near}?" if near else f"There are {', '.join(every)}."
        raise base.InputError(f"{name!r}: no such figure of the paper. {guess}")
    return every[name]()
