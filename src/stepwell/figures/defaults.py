"""The usual figure of every value that can be drawn."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from stepwell.base import InputError, of_kind
from stepwell.design import Design
from stepwell.figures import graphs, maps, measured, robustness
from stepwell.figures.cells.cell_curves import element_curve, unit_cell_force
from stepwell.figures.cells.force_plane import force_plane
from stepwell.figures.cells.mechanism import mechanism
from stepwell.figures.motion.overview import overview
from stepwell.figures.motion.stroke_program import stroke_program
from stepwell.figures.motion.strokes import force_stroke
from stepwell.figures.robots.gaits import prediction, sweep
from stepwell.figures.robots.mazes import maze
from stepwell.figures.robots.robot import robot_drawing
from stepwell.figures.robots.trajectory import trajectory
from stepwell.lab import choose_law
from stepwell.mechanism import Chain

# Mechanisms that are drawn around a design.
_CLOUD = 600


def plot(value: Any, **options: Any) -> Figure:
    """The usual figure of a value; `value.plot()` is the same.

    | of | drawn by |
    |---|---|
    | a chain, a cell, an element | `mechanism`, `unit_cell_force`, `element_curve` |
    | a cycle, a path, a program | `overview`, `force_stroke`, `stroke_program` |
    | a transition graph, what it remembers | `transition_graph` |
    | a margin, a yield, a design that was found | `margins`, `yield_bars`, `force_plane` |
    | a map | `transition_map` |
    | a robot, a prediction | `robot_drawing`, `prediction` |
    | a walk, a way through an arena, a sweep | `trajectory`, `maze`, `sweep` |
    | a recording, a test of bands | `recording`, `band_laws` |
    | an atlas | `machines` |
    | a measured cell, a measured pair | `measured_forces`, `measured_pairs` |
    | a comparison | `measured_forces`, or `measured_pairs` where there are no unit cells |
    | a calibration | `calibration` |

    Args:
        value: any of these.
        options: of the function that draws it.

    Raises:
        ValueError: a value of which there is no usual figure, or what that function raises.
    """
    draw = maps.transition_map if _is_map(value) else of_kind(_USUAL, value)
    if draw is None:
        known = ", ".join(sorted(_USUAL))
        raise InputError(
            f"{type(value).__name__}: has no usual figure. Those that have one: {known}, and maps."
        )
    return draw(value, **options)


def _designed(found: Design) -> Figure:
    drilled = found.holes is not None
    # Cells of more than two phases have more switches than there are cells to be in order.
    one_each = len(found.forces) == len(found.chain)
    return force_plane(
        found.chain,
        loading=found.loading if one_each else None,
        unloading=found.unloading if one_each else None,
        region=() if drilled else found.region,
        places=np.concatenate(found.region) if drilled else None,
        clouds=found.yield_.end_forces(_CLOUD),
    )


def _is_map(value: Any) -> bool:
    return type(value).__module__.startswith("xarray.") and "moved_cell" in value.attrs


def _map_view(view: Any, **options: Any) -> Figure:
    if not _is_map(view.dataset):
        raise InputError(
            "this dataset is no map: only those of transition_map and parameter_map can be drawn."
        )
    return maps.transition_map(view.dataset, **options)


def _chain(chain: Chain, **options: Any) -> Figure:
    return mechanism(chain, options.pop("states", (chain.first_state, chain.last_state)), **options)


_USUAL: dict[str, Callable[..., Figure]] = {
    "Atlas": graphs.machines,
    "BandFit": lambda fit, **options: measured.band_laws(fit.test, fit.choice, **options),
    "BandTest": lambda test, **options: measured.band_laws(
        test, **{"choice": choose_law(test)} | options
    ),
    "Calibration": measured.calibration,
    "Cell": lambda cell, **options: unit_cell_force([cell], **options),
    "CellTest": lambda test: measured.measured_forces([test]),
    "Chain": _chain,
    "Comparison": lambda found: (
        measured.measured_forces(found.cells)
        if found.cells
        else measured.measured_pairs(found.pairs)
    ),
    "Cycle": overview,
    "Design": _designed,
    "Element": element_curve,
    "MapView": _map_view,
    "Margin": robustness.margins,
    "Maze": maze,
    "MemoryReading": lambda reading, **options: graphs.transition_graph(reading.graph, **options),
    "PairTest": lambda test: measured.measured_pairs([test]),
    "Path": force_stroke,
    "Prediction": prediction,
    "Program": stroke_program,
    "Recording": measured.recording,
    "Robot": robot_drawing,
    "Sweep": sweep,
    "TransitionGraph": graphs.transition_graph,
    "Walk": trajectory,
    "Yield": robustness.yield_bars,
}
