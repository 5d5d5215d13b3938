"""The steps of the story: what each computes, says and shows."""

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
from stepwell.studio import embedded, replay

if TYPE_CHECKING:
    from xarray import Dataset

    from stepwell.design import Boundary
    from stepwell.simulation import Maze, Walk


@dataclass(frozen=True, slots=True)
class StoryPiece:
    """A piece of the page: an element, what it shows, and the states it goes through, if any."""

    html: str = field(repr=False)
    caption: str
    sequence: str = ""
    moves: bool = True  # whether it plays


def moving(
    result: Chain | Program | Walk | Maze,
    caption: str,
    sequence: str = "",
    progress: Callable[[float, float], None] | None = None,
) -> StoryPiece:
    """A chain, a program or a robot that plays."""
    page = replay(result, title=caption, progress=progress)
    return StoryPiece(embedded(page, caption, plays=True), caption, sequence)


def map_of(
    dataset: Dataset, borders: Iterable[Boundary], marks: Mapping[str, tuple[float, float]]
) -> StoryPiece:
    """A map, with the places [m] of some designs on it."""
    from stepwell import figures

    caption = "The order for every place of the outer cell's anchor"
    source, width, height = image_of(figures.transition_map(dataset, borders, marks))
    name = escape(caption)
    picture = (
        f'<div tabindex="0" role="group" aria-label="{name}"><img alt="{name}" '
        f'width="{width}" height="{height}" src="{source}"></div>'
    )
    return StoryPiece(picture, caption, moves=False)


OPENING = (
    "A cell is a linkage held by a rubber band: it stands in (0) or out (1). One motor pulls a "
    "row of them, and where the ends of their bands are hooked decides which moves when."
)
# Places along an axis of the map. Its borders are exact curves, whatever the number.
_PLACES = 81
_WISH = "000>010>011>111>101>001>000"
_ANCHOR, _STIFFNESS = 1.0e-3, 0.05  # [m], and a share of the mean
_FINGER = "index"
_CYCLES = 5
_REVERSED = "00>01>11>10>00"
_ARENA, _LIMIT = "cylinder", 44.0  # [s]

Progress = Callable[[float, float], None]


@dataclass(frozen=True, eq=False, slots=True)
class StoryStep(ByValue):
    """What one step of the story made.

    Attributes:
        told: sentences, the same on the terminal and on the page.
        shown: what is seen of it, moving where it can.
        commands: what to type, in the folder of the story, to do it again.
        files: design files, text by name.
        changed: lines of a design file that say it, with - and + where they replace others.
    """

    told: tuple[str, ...]
    shown: tuple[StoryPiece, ...]
    commands: tuple[str, ...]
    files: dict[str, str] = field(default_factory=dict)
    changed: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class Telling(ByValue):
    """A step before it is made.

    Attributes:
        title: what is done, in plain words.
        needs: extras that it uses and that some installations do without.
        make: computes it; takes what to call with (done, total), or None.
    """

    title: str
    needs: tuple[str, ...]
    make: Callable[[Progress | None], StoryStep]

    @property
    def can_be_told(self) -> bool:
        """Whether all that it needs is installed."""
        return have(*self.needs)


def _pull(progress: Progress | None) -> StoryStep:
    leg, _ = _legs()
    cycle = leg.cycle()
    snaps = len(cycle.snaps)
    return StoryStep(
        (f"{_order(cycle)} It snaps {number(snaps)} times on the way.",),
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
            f"The end of the outer band is hooked {far} nearer, and the same pull makes another "
            f"order. {_order(cycle)}",
        ),
        (
            moving(before, "As it was", str(before.cycle().sequence), progress),
            moving(after, "With that anchor moved", str(cycle.sequence), progress),
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
            "Every place of that anchor, and the order it makes. The first leg's may be off by "
            f"{near} and the second's by {far} before a border is crossed.",
        ),
        (map_of(dataset, borders, marks),),
        ("stepwell map leg.toml --out map",),
    )


def _wish(progress: Progress | None) -> StoryStep:
    tolerances = Tolerances(anchor=_ANCHOR, stiffness=_STIFFNESS)
    found = design(_WISH, tolerances=tolerances, progress=progress)
    made, built = with_(found.chain, title="Made to order"), found.yield_
    text = dumps(made)
    anchors = [line for line in text.splitlines() if line.startswith("q_mm")]
    return StoryStep(
        (
            f"{_order(made.cycle())} Anchors for it are found. Of {built.samples:,} built at "
            f"random with anchors up to {amount(_ANCHOR, 'm')} off and bands that differ by "
            f"{number(_STIFFNESS * 100)} %, {built.successes:,} do it too.",
        ),
        (moving(made, "Made to order", _WISH, progress),),
        (
            f"stepwell design '{_WISH}' --anchor {number(to_unit(_ANCHOR, 'mm'))} "
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
            f"Five fingers, one motor. It goes out to {points[1]} mm and back to {points[2]} "
            f"mm, and the {_FINGER} finger alone is up. It may turn {off} sooner or later; every "
            "finger has a turn of its own.",
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
            f"After {_CYCLES} strokes it is {amount(straight.distance, 'm', 3)} ahead; the stroke "
            f"is all that commands it. With one anchor of its left leg moved as before, it turns "
            f"{angle}° to the left with every stroke.",
        ),
        (
            moving(straight, "Both legs alike", straight.gaits["left"][-1]),
            moving(turned, "Its left leg reversed", turned.gaits["left"][-1]),
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
    found = robot.maze(arena, limit=_LIMIT, progress=progress)
    contact = found.contacts[0]
    turned = next(change for change in found.changes if change.after == _REVERSED)
    yaw = float(np.degrees(found.walk.yaw[-1]))
    return StoryStep(
        (
            f"After {contact.begin:.0f} s its {contact.antenna} antenna touches a post and pushes "
            f"an anchor of the {turned.leg} leg by {amount(contact.moved, 'm', 3)}. That leg "
            f"then moves as the second leg did, and the robot turns {abs(yaw):.0f}° to the "
            f"{'left' if yaw > 0 else 'right'} and walks on.",
        ),
        (moving(found, "Antennas meet a post"),),
        (
            f"stepwell maze robot-antennas.toml {_ARENA} --limit {_LIMIT:.0f} --out maze",
            "stepwell maze robot-antennas.toml three-walls --out walls",
        ),
        {"robot-antennas.toml": preset_text("robot-antennas")},
    )


# What is not needed by the engine itself, and missing in some installations.
_DRAWS, _SIMULATES = ("figures", "tables"), ("robot",)
STEPS = (
    Telling("Pull a leg of two cells, and let it back", (), _pull),
    Telling("Move one anchor", (), _move_an_anchor),
    Telling("Look where that anchor may be", _DRAWS, _map),
    Telling("Wish for an order", (), _wish),
    Telling("Put up one finger of five", (), _finger),
    Telling("Let it walk on two such legs", _SIMULATES, _walk),
    Telling("Let it feel its way", _SIMULATES, _feel),
)


def _legs() -> tuple[Chain, Chain]:
    """The legs of the paper's robot: one that steps forward, and one that steps backward."""
    names = ("paper-forward", "First leg"), ("paper-backward", "Second leg")
    first, second = (with_(load(f"preset:{name}").chain, title=title) for name, title in names)
    return first, second


def _outer(chain: Chain) -> Band:
    """The band of the outer cell, which has no other."""
    cell = chain.cells[-1]
    assert isinstance(cell, Cell)
    (band,) = cell.bands
    return band


def _order(cycle: Cycle) -> str:
    """In which order the cells of a cycle move, in words."""
    names = cycle.chain.names
    out, back = (
        " then ".join(names[k] for k in cells)
        for cells in (cycle.loading_order, cycle.unloading_order)
    )
    return f"Out: {out}. Back: {back}."


def _moved(remark: str, before: Chain, after: Chain) -> tuple[str, ...]:
    """The line of a design file in which two chains differ, as it was and as it is."""
    places = ([number(to_unit(at, "mm")) for at in _outer(chain).q] for chain in (before, after))
    was, now = map(", ".join, places)
    return (f'name = "{after.names[-1]}"{remark}', f"-q_mm = [{was}]", f"+q_mm = [{now}]")
