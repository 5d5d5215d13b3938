"""The steps of the demonstration: computations, texts and animations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace as with_
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import ByValue, amount, have, number, to_unit
from stepwell.design import Tolerances, boundaries, design, margin, transition_map
from stepwell.files import WrittenProgram, dumps, load, load_arena, preset_text, with_program
from stepwell.mechanism import Band, Cell, Chain
from stepwell.reports.write import image_of
from stepwell.sequences import Cycle, Program
from stepwell.studio import as_iframe, replay

if TYPE_CHECKING:
    from xarray import Dataset

    from stepwell.design import Boundary
    from stepwell.simulation import Maze, Walk


@dataclass(frozen=True, slots=True)
class StoryPiece:
    """An element of the page with its caption, and the sequence of states, if any."""

    html: str = field(repr=False)
    caption: str
    sequence: str = ""
    moves: bool = True  # whether it is an animation


def moving(
    result: Chain | Program | Walk | Maze,
    caption: str,
    sequence: str = "",
    progress: Callable[[float, float], None] | None = None,
) -> StoryPiece:
    """Animation of a chain, a program or a robot."""
    page = replay(result, title=caption, progress=progress)
    return StoryPiece(as_iframe(page, caption, plays=True), caption, sequence)


def map_of(
    dataset: Dataset, borders: Iterable[Boundary], marks: Mapping[str, tuple[float, float]]
) -> StoryPiece:
    """A design map with the anchor positions [m] of some designs."""
    from stepwell import figures

    caption = "State sequence as a function of the outer cell's anchor position"
    source, width, height = image_of(figures.transition_map(dataset, borders, marks))
    name = escape(caption)
    picture = (
        f'<div tabindex="0" role="group" aria-label="{name}"><img alt="{name}" '
        f'width="{width}" height="{height}" src="{source}"></div>'
    )
    return StoryPiece(picture, caption, moves=False)


OPENING = (
    "A cell is a linkage with a rubber band and two stable states, closed (0) and open (1). One "
    "actuator pulls several cells in series. The anchor positions of the bands determine the "
    "sequence of states."
)
# Nodes along an axis of the map. Its boundaries are exact curves for any number.
_PLACES = 81
_TARGET = "000>010>011>111>101>001>000"
_ANCHOR, _STIFFNESS = 1.0e-3, 0.05  # [m], and a fraction of the mean
_FINGER = "index"
_CYCLES = 5
_REVERSED = "00>01>11>10>00"
_ARENA, _LIMIT = "cylinder", 44.0  # [s]

Progress = Callable[[float, float], None]


@dataclass(frozen=True, eq=False, slots=True)
class StoryStep(ByValue):
    """The result of one step of the demonstration.

    Attributes:
        sentences: text for the terminal and the page.
        shown: figures and animations.
        commands: commands that reproduce the step in the folder of the demonstration.
        files: texts of design files by name.
        changed: relevant lines of a design file, with - and + for removed and added ones.
    """

    sentences: tuple[str, ...]
    shown: tuple[StoryPiece, ...]
    commands: tuple[str, ...]
    files: dict[str, str] = field(default_factory=dict)
    changed: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class PlannedStep(ByValue):
    """A step before its computation.

    Attributes:
        title: heading of the step.
        needs: extras that it needs.
        make: computes it; takes a progress callback with (done, total), or None.
    """

    title: str
    needs: tuple[str, ...]
    make: Callable[[Progress | None], StoryStep]

    @property
    def available(self) -> bool:
        """Whether its extras are installed."""
        return have(*self.needs)


def _pull(progress: Progress | None) -> StoryStep:
    leg, _ = _legs()
    cycle = leg.cycle()
    snaps = len(cycle.snaps)
    return StoryStep(
        (f"{_order(cycle)} The cycle has {number(snaps)} snaps.",),
        (moving(leg, "The first leg", str(cycle.sequence), progress),),
        ("stepwell run leg.toml", "stepwell studio leg.toml"),
        {"leg.toml": dumps(leg)},
    )


def _move_an_anchor(progress: Progress | None) -> StoryStep:
    before, after = _legs()
    far = amount(float(np.hypot(*np.subtract(_outer(before).q, _outer(after).q))), "m")
    cycle = after.cycle()
    return StoryStep(
        (
            f"The anchor of the outer band is moved by {far}. The same stroke then gives another "
            f"sequence. {_order(cycle)}",
        ),
        (
            moving(before, "Before", str(before.cycle().sequence), progress),
            moving(after, "With the moved anchor", str(cycle.sequence), progress),
        ),
        ("stepwell run leg-reversed.toml",),
        {"leg-reversed.toml": dumps(after)},
        _moved("", before, after),
    )


def _map(progress: Progress | None) -> StoryStep:
    legs = _legs()
    x, y = np.linspace(0.0, 0.020, _PLACES), np.linspace(-0.015, 0.015, _PLACES)
    dataset = transition_map(legs[0], 1, x=x, y=y, progress=progress)
    borders = boundaries(legs[0], 1, x=x, y=y, progress=progress)
    near, far = (amount(float(margin(leg).anchors[1]), "m") for leg in legs)
    marks = {leg.title.lower(): _outer(leg).q for leg in legs}
    return StoryStep(
        (
            "State sequence as a function of the anchor position. "
            f"Margins of the outer cell's anchor: {near} (first leg), {far} (second leg).",
        ),
        (map_of(dataset, borders, marks),),
        ("stepwell map leg.toml --out map",),
    )


def _design_sequence(progress: Progress | None) -> StoryStep:
    tolerances = Tolerances(anchor=_ANCHOR, stiffness=_STIFFNESS)
    result = design(_TARGET, tolerances=tolerances, progress=progress)
    made, built = with_(result.chain, title="Made to order"), result.yield_
    text = dumps(made)
    anchors = [line for line in text.splitlines() if line.startswith("q_mm")]
    return StoryStep(
        (
            f"The inverse design gives anchors for the target sequence. {_order(made.cycle())} "
            f"{built.successes:,} of {built.samples:,} random samples reproduce the sequence, with "
            f"an anchor tolerance of {amount(_ANCHOR, 'm')} and a stiffness tolerance of "
            f"{number(_STIFFNESS * 100)} %.",
        ),
        (moving(made, "Made to order", _TARGET, progress),),
        (
            f"stepwell design '{_TARGET}' --anchor {number(to_unit(_ANCHOR, 'mm'))} "
            f"--stiffness-tolerance {number(_STIFFNESS * 100)} --out wish",
        ),
        {"wish.toml": text},
        tuple(f"{line} # {name}" for line, name in zip(anchors, made.names, strict=True)),
    )


def _finger(progress: Progress | None) -> StoryStep:
    hand = load("preset:finger-selector").chain
    up = "".join("1" if name == _FINGER else "0" for name in hand.names)
    program = hand.program(up)
    (turn,) = program.turns
    points = [number(to_unit(point, "mm")) for point in program.turning_points]
    off = amount(min(turn.drive - turn.low, turn.high - turn.drive), "m", 3)
    text = with_program(preset_text("finger-selector"), WrittenProgram.of(program))
    return StoryStep(
        (
            f"One actuator drives five fingers. Its stroke rises to {points[1]} mm and falls to "
            f"{points[2]} mm; then only the {_FINGER} finger is up. The tolerance of the turning "
            f"point is ±{off}. Each finger has its own turning point.",
        ),
        (moving(program, "Five fingers", str(program.sequence), progress),),
        (
            "stepwell program fingers.toml",
            "stepwell program fingers.toml --from 00000 --target 00010",
        ),
        {"fingers.toml": text},
        ("[program]", *WrittenProgram.of(program).text(hand).strip().splitlines()[1:]),
    )


def _walk(progress: Progress | None) -> StoryStep:
    robots = load("preset:robot-forward").robot, load("preset:robot-left").robot
    straight, turned = (robot.walk(_CYCLES) for robot in robots)
    before, after = (robot.leg("left").chain for robot in robots)
    angle = number(float(np.degrees(turned.turn[1:].mean())), 3)
    return StoryStep(
        (
            f"The robot advances by {amount(straight.distance, 'm', 3)} in {_CYCLES} cycles; the "
            f"stroke is its only input. With one anchor of its left leg moved as in step 2, it "
            f"turns by {angle}° to the left in each cycle.",
        ),
        (
            moving(straight, "Equal legs", straight.gaits["left"][-1]),
            moving(turned, "Reversed left leg", turned.gaits["left"][-1]),
        ),
        ("stepwell walk robot.toml --out walk", "stepwell walk robot-turning.toml --out turn"),
        {
            "robot.toml": preset_text("robot-forward"),
            "robot-turning.toml": preset_text("robot-left"),
        },
        _moved(" # of the left leg", before, after),
    )


def _feel(progress: Progress | None) -> StoryStep:
    robot, arena = load("preset:robot-antennas").robot, load_arena(_ARENA)
    maze = robot.maze(arena, limit=_LIMIT, progress=progress)
    contact = maze.contacts[0]
    obstacle, time = next((name, at) for name, at in maze.touched.items() if at)
    turned = next(change for change in maze.changes if change.after == _REVERSED)
    yaw = float(np.degrees(maze.walk.yaw[-1]))
    return StoryStep(
        (
            f"After {time:g} s the {contact.antenna} antenna touches {obstacle} and moves "
            f"an anchor of the {turned.leg} leg by {amount(contact.moved, 'm', 3)}. That leg "
            f"then has the sequence of the second leg in step 2. The robot turns by "
            f"{abs(yaw):.0f}° to the {'left' if yaw > 0 else 'right'} and continues.",
        ),
        (moving(maze, "Antenna contact with a cylinder"),),
        (
            f"stepwell maze robot-antennas.toml {_ARENA} --limit {_LIMIT:.0f} --out maze",
            "stepwell maze robot-antennas.toml three-walls --out walls",
        ),
        {"robot-antennas.toml": preset_text("robot-antennas")},
    )


# Optional extras of the steps.
_DRAWS, _SIMULATES = ("figures", "tables"), ("robot",)
STEPS = (
    PlannedStep("Cycle of a two-cell chain", (), _pull),
    PlannedStep("Moving an anchor", (), _move_an_anchor),
    PlannedStep("Design map of the anchor position", _DRAWS, _map),
    PlannedStep("Inverse design of a sequence", (), _design_sequence),
    PlannedStep("Stroke program that selects one of five fingers", (), _finger),
    PlannedStep("Walking robot with two such legs", _SIMULATES, _walk),
    PlannedStep("Robot with antennas", _SIMULATES, _feel),
)


def _legs() -> tuple[Chain, Chain]:
    """The legs of the paper's robot: a forward and a backward stepping one."""
    names = ("paper-forward", "First leg"), ("paper-backward", "Second leg")
    first, second = (with_(load(f"preset:{name}").chain, title=title) for name, title in names)
    return first, second


def _outer(chain: Chain) -> Band:
    """The only band of the outer cell."""
    cell = chain.cells[-1]
    assert isinstance(cell, Cell)
    (band,) = cell.bands
    return band


def _order(cycle: Cycle) -> str:
    """Text with the loading and the unloading order of a cycle."""
    names = cycle.chain.names
    loading, unloading = (
        " then ".join(names[k] for k in cells)
        for cells in (cycle.loading_order, cycle.unloading_order)
    )
    return f"Loading order: {loading}. Unloading order: {unloading}."


def _moved(remark: str, before: Chain, after: Chain) -> tuple[str, ...]:
    """The differing line of two chains' design files, before and after."""
    places = ([number(to_unit(at, "mm")) for at in _outer(chain).q] for chain in (before, after))
    was, now = map(", ".join, places)
    return (f'name = "{after.names[-1]}"{remark}', f"-q_mm = [{was}]", f"+q_mm = [{now}]")
