"""The paper's figures about unit cells and two-cell mechanisms, drawn from the model."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from stepwell import figures
from stepwell.design import boundaries, transition_map
from stepwell.paper.mechanisms import (
    PAIRS,
    monostable_pair,
    outer_anchor,
    pair_cycle,
    six_cells,
)
from stepwell.sequences import Cycle, Pathway

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def force() -> Figure:
    """F against θ of the six unit cells (Fig. 1D)."""
    return figures.unit_cell_force(list(six_cells().values()))


def energy() -> Figure:
    """E against θ of the six unit cells (Fig. 1E)."""
    return figures.unit_cell_energy(list(six_cells().values()))


def landscapes() -> Figure:
    """Energy of two cells with the path on it, a pair for each pathway (Fig. 2B).

    One more has an outer cell that is monostable by itself.
    """
    lone = monostable_pair()
    name = f"Outer monostable: q = ({_mm(lone.chain.levers[1].bands[0].q)}) mm"
    return figures.landscapes(_pairs() | {name: lone})


def map_() -> Figure:
    """Pathways over the anchor of the outer cell, with the four pairs marked (Fig. 2C)."""
    x, y = np.linspace(0.0, 0.020, 400), np.linspace(-0.015, 0.015, 400)
    chain = pair_cycle(Pathway.CLOCKWISE).chain
    marked = {f"({_mm(outer_anchor(p))})": outer_anchor(p) for p in PAIRS}
    found = transition_map(chain, 1, x=x, y=y)
    return figures.transition_map(found, boundaries(chain, 1, x=x, y=y), marked)


def strokes() -> Figure:
    """Force and travels against stroke, a pair of cells for each pathway (Figs. 2D to 2G)."""
    return figures.strokes(_pairs())


FIGURES: MappingProxyType[str, Callable[[], Figure]] = MappingProxyType(
    {
        "fig1d-force": force,
        "fig1e-energy": energy,
        "fig2b-landscapes": landscapes,
        "fig2c-map": map_,
        "fig2d-2g-pathways": strokes,
    }
)


def gaits() -> Figure:
    """Where the paper's four robots go (Figs. 3C to 3E)."""
    from stepwell.paper.robots import walk_of

    names = {
        "forward: q_out = 20 mm": "forward",
        "backward: q_out = 5 mm": "backward",
        "one of each": "left",
        "q_out = 15 mm": "15",
    }
    return figures.trajectories({label: walk_of(name) for label, name in names.items()})


def three_walls() -> Figure:
    """A robot with antennas past three walls (Fig. 4D)."""
    from stepwell import files
    from stepwell.paper.robots import robot
    from stepwell.simulation import maze

    return figures.maze(maze(robot("explorer"), files.load_arena("three-walls")))


def tornado() -> Figure:
    """The results about the robot against every number that is assumed."""
    from stepwell.paper.robots import sensitivities

    return figures.tornado(sensitivities())


# Figures for which the simulator is needed.
ROBOT_FIGURES: MappingProxyType[str, Callable[[], Figure]] = MappingProxyType({"fig3-gaits": gaits})
MANY_RUNS: MappingProxyType[str, Callable[[], Figure]] = MappingProxyType(
    {"fig4d-three-walls": three_walls, "robot-tornado": tornado}
)


def figures_of(everything: bool) -> dict[str, Callable[[], Figure]]:
    """The figures that can be drawn here, by name; those of many runs only when asked for."""
    found = dict(FIGURES)
    if find_spec("mujoco") is not None:
        found |= ROBOT_FIGURES
        found |= MANY_RUNS if everything else {}
    return found


def _pairs() -> dict[str, Cycle]:
    found: dict[str, Cycle] = {}
    for cycle in map(pair_cycle, PAIRS):
        words = cycle.pathway.label if cycle.pathway else str(cycle.sequence)
        q = cycle.chain.levers[1].bands[0].q
        found[f"{words.capitalize()}: outer q = ({_mm(q)}) mm"] = cycle
    return found


def _mm(q: tuple[float, float]) -> str:
    return ", ".join(f"{part * 1e3:g}" for part in q).replace("-", "\N{MINUS SIGN}")
