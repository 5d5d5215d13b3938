"""The default figure of each type of result."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from stepwell.base import InputError, of_kind
from stepwell.design import Design
from stepwell.figures import graphs, maps, measured, robustness
from stepwell.figures.cells.cell_curves import element_curve, unit_cell_force
from stepwell.figures.cells.force_plane import force_plane
from stepwell.figures.cells.layers import layers
from stepwell.figures.cells.mechanism import mechanism
from stepwell.figures.motion.overview import overview
from stepwell.figures.motion.stroke_program import stroke_program
from stepwell.figures.motion.strokes import force_stroke
from stepwell.figures.robots.build import robot_parts
from stepwell.figures.robots.gait_plane import gait_plane
from stepwell.figures.robots.gaits import prediction, sweep
from stepwell.figures.robots.jumps import energy_flow
from stepwell.figures.robots.mazes import maze
from stepwell.figures.robots.robot import robot_drawing
from stepwell.figures.robots.trajectory import trajectory
from stepwell.lab import choose_law
from stepwell.mechanism import Chain

# Samples drawn round a nominal design.
_CLOUD = 600


def plot(value: Any, **options: Any) -> Figure:
    """The default figure of a value; `value.plot()` is equivalent.

    | value | function |
    |---|---|
    | a chain, a cell, an element | `mechanism`, `unit_cell_force`, `element_curve` |
    | a cycle, a path, a program | `overview`, `force_stroke`, `stroke_program` |
    | a transition graph, a reading of its memory | `transition_graph` |
    | a margin, a yield, a result of `design` | `margins`, `yield_bars`, `force_plane` |
    | a map | `transition_map` |
    | a build | `layers` |
    | a build of a robot | `robot_parts` |
    | a robot, a prediction | `robot_drawing`, `prediction` |
    | a compiled robot | `gait_plane` |
    | a walk, a path through an arena, a sweep | `trajectory`, `maze`, `sweep` |
    | a jump | `energy_flow` |
    | a recording, a test of bands | `recording`, `band_laws` |
    | a measured element | `measured_element` |
    | an atlas | `graph_classes` |
    | a measured cell, a measured pair or chain | `measured_forces`, `measured_pairs` |
    | a comparison | `measured_forces`, or `measured_pairs` without unit cells |
    | a calibration | `calibration` |

    Args:
        value: a value of one of these types.
        options: keyword arguments of the function.

    Raises:
        ValueError: a value without a default figure, or an error of the function.
    """
    draw = maps.transition_map if _is_map(value) else of_kind(_USUAL, value)
    if draw is None:
        known = ", ".join(sorted(_USUAL))
        raise InputError(
            f"{type(value).__name__}: has no default figure. Types with one: {known}, and maps."
        )
    return draw(value, **options)


def _designed(result: Design) -> Figure:
    drilled = result.holes is not None
    # Cells with more than two phases have more transitions than the orders have entries.
    one_each = len(result.forces) == len(result.chain)
    return force_plane(
        result.chain,
        loading=result.loading if one_each else None,
        unloading=result.unloading if one_each else None,
        region=() if drilled else result.region,
        places=np.concatenate(result.region) if drilled and result.region else None,
        clouds=result.yield_.end_forces(_CLOUD),
    )


def _is_map(value: Any) -> bool:
    return type(value).__module__.startswith("xarray.") and "moved_cell" in value.attrs


def _map_view(view: Any, **options: Any) -> Figure:
    if not _is_map(view.dataset):
        raise InputError(
            "this dataset is not a map: use a result of transition_map or parameter_map."
        )
    return maps.transition_map(view.dataset, **options)


def _chain(chain: Chain, **options: Any) -> Figure:
    return mechanism(chain, options.pop("states", (chain.first_state, chain.last_state)), **options)


_USUAL: dict[str, Callable[..., Figure]] = {
    "Atlas": graphs.graph_classes,
    "Build": layers,
    "RobotBuild": robot_parts,
    "BandFit": lambda fit, **options: measured.band_laws(fit.test, fit.choice, **options),
    "BandTest": lambda test, **options: measured.band_laws(
        test, **{"choice": choose_law(test)} | options
    ),
    "Calibration": measured.calibration,
    "Cell": lambda cell, **options: unit_cell_force([cell], **options),
    "CellTest": lambda test: measured.measured_forces([test]),
    "ChainTest": lambda test: measured.measured_pairs([test]),
    "Chain": _chain,
    "Comparison": lambda comparison: (
        measured.measured_forces(comparison.cells)
        if comparison.cells
        else measured.measured_pairs(comparison.pairs or comparison.chains)
    ),
    "CompiledRobot": gait_plane,
    "Cycle": overview,
    "Design": _designed,
    "ProvedDesign": _designed,
    "Element": element_curve,
    "Jump": energy_flow,
    "MapView": _map_view,
    "Margin": robustness.margins,
    "Maze": maze,
    "MeasuredElement": measured.measured_element,
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
