"""Phrases and sections that several kinds of results share, assumptions among them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from stepwell.accounts.head import About
from stepwell.accounts.parts import Level, Notes, Section, Warned
from stepwell.base import Measure, Quantity, amount, counted, number, told_in
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.mechanism import Cell, Element
    from stepwell.robot import Antenna
    from stepwell.simulation import Walk
    from stepwell.statics import Tie


_RIGID = (
    "Levers and blocks are rigid, joints have no play, and each cell stops where its blocks touch."
)


def assumptions(chain: Chain) -> list[str]:
    """What the results of a chain rest on, a sentence each."""
    from stepwell.mechanism import Cell, Element, Linear

    words = chain.measure
    named = list(zip(chain.names, chain.cells, strict=True))
    levers = [(name, cell) for name, cell in named if isinstance(cell, Cell)]
    elements = [(name, cell) for name, cell in named if isinstance(cell, Element)]
    rubbed = [f"{n} {amount(c.friction, words.force_unit)}" for n, c in named if c.friction]

    def having(holds: Callable[[Cell], Any]) -> list[str]:
        return [name for name, cell in levers if holds(cell)]

    def told(of: list[str], none: str, some: str, every: str = "") -> str:
        if every and len(of) == len(levers):
            return every
        return some.format(_some(of)) if of else none

    bands = [
        told(
            having(lambda cell: any(band.two_sided for band in cell.bands)),
            "Bands pull and never push: a slack band carries nothing.",
            "Bands of {} are two-sided springs that also push; the others pull only.",
            "Bands are two-sided springs, as in the paper: below rest length they push.",
        ),
        told(
            having(lambda cell: any(not isinstance(band.law, Linear) for band in cell.bands)),
            "Bands are linear: tension is stiffness times extension, without hysteresis.",
            "Bands of {} follow a nonlinear law; the others are linear.",
            "Bands follow a nonlinear law.",
        ),
    ]
    load = told(
        having(lambda cell: cell.load is not None),
        "No weight or other load acts on a cell.",
        "A load that depends on its travel acts on {}.",
    )
    return [
        f"Quasi-static: the {words.stroke} changes slowly, inertia plays no part between snaps.",
        *([_RIGID] if levers else []),
        *(_curves(elements, words) if elements else []),
        "After a snap the chain lands where overdamped flow at fixed drive leads it, "
        f"{_mobile(named, words)}; the energy released is lost.",
        actuator_words(chain),
        *(bands if levers else []),
        told(
            rubbed,
            "No friction between blocks." if levers else "No friction.",
            f"Coulomb friction against {words.travel}: {{}}.",
        ),
        *([load] if levers else []),
    ]


def simulation_assumptions(walk: Walk) -> list[str]:
    """What the numbers of a simulated walk assume, a sentence each."""
    robot, settings = walk.robot, walk.settings
    feelers = robot.antennas
    return [
        f"Simulated with inertia, contact and friction by MuJoCo, in steps of "
        f"{amount(settings.time_step, 's')}; nothing is random.",
        "The actuator's stroke over time is the only command; gaits follow from bands, weight and "
        "contact.",
        "Levers, links, blocks and floor are rigid, joints have no play; contacts and stops yield "
        f"with a time constant of {amount(settings.contact_time, 's')}.",
        f"Coulomb friction on a flat floor: coefficient {number(robot.floor.foot_friction)} under "
        f"the feet, {number(robot.support_friction)} under the supports.",
        *(
            [f"Antennas are rigid rods on springs, with friction {_frictions(feelers)} on walls."]
            if feelers
            else []
        ),
        "A manufactured robot differs from its nominal design in friction, bands and assembly.",
    ]


def _frictions(antennas: Iterable[Antenna]) -> str:
    return " and ".join(dict.fromkeys(number(one.friction) for one in antennas))


def _mobile(named: list[tuple[str, Cell | Element]], words: Measure) -> str:
    if len({cell.mobility for _, cell in named}) == 1:
        return f"every {words.travel} being equally mobile"
    others = [f"{name} {number(cell.mobility)}" for name, cell in named if cell.mobility != 1.0]
    rest = "" if len(others) == len(named) else ", all others 1"
    return f"every cell with its own mobility: {_some(others)}{rest}"


def _curves(elements: list[tuple[str, Element]], words: Measure) -> list[str]:
    beyond = [name for name, element in elements if not all(element.stopped)]
    folded = [name for name, element in elements if len(element.laws) > 1]
    told = [
        f"The {words.force} of {_some([name for name, _ in elements])} follows a curve over "
        f"{words.travel}, at any rate and whatever came before."
    ]
    if beyond:
        told.append(f"Past an end without a stop the curve of {_some(beyond)} goes on straight.")
    if folded:
        told.append(
            f"Where the curve of {_some(folded)} folds back, it jumps to the next stable stretch "
            f"along the curve."
        )
    return told


def actuator_words(chain: Chain) -> str:
    """What the actuator of a chain prescribes, in a sentence."""
    words, stiffness = chain.measure, chain.actuator_stiffness
    if math.isinf(stiffness):
        return f"The actuator is rigid: it prescribes the {words.stroke}."
    if stiffness == 0:
        return f"The actuator prescribes the {words.force}, not the {words.stroke}."
    return f"The actuator has a stiffness of {amount(stiffness, words.stiffness_unit)} in series."


def _some(items: list[str]) -> str:
    return ", ".join(items[:12]) + (f" and {len(items) - 12} more" if len(items) > 12 else "")


# Of longer chains states are not written out in a line, and no change is followed to its end.
LONGEST_IN_A_LINE = 12
# The states of a chain are as many as its cells, each as long: past this only orders are given.
LONGEST_SPELLED_OUT = 64
_MOST_DRIVES = 6


def cells_of(chain: Chain) -> str:
    """How many cells a chain has."""
    return f"{counted(len(chain), 'cell')}, innermost first"


def listed(items: Sequence[str], most: int = LONGEST_IN_A_LINE) -> str:
    """Names in a line, the first of many."""
    return ", ".join(items[:most]) + f" and {len(items) - most} more" * (len(items) > most)


def turning_points(points: Sequence[float], chain: Chain) -> str:
    """Turning points of the drive, in SI, in a line."""
    unit, factor = told_in(chain.drive_unit)
    shown = " → ".join(number(point * factor) for point in points[:LONGEST_IN_A_LINE])
    left = len(points) - LONGEST_IN_A_LINE
    return f"{shown} {Quantity('', unit).sign}" + f" and {left} more" * (left > 0)


def degenerate(ties: Iterable[Tie], chain: Chain | None) -> Warned:
    """The warning of ties, see `tie_notes`."""
    return Warned(
        "Too close to call",
        "The model cannot tell which of these happens; a real mechanism will decide.",
        tie_notes(ties, chain),
    )


def calibration(about: About) -> Section:
    """What the recordings gave that a design was calibrated on."""
    given = about.calibrated
    heading = "Bands, weight and friction as calibrated"
    if given is None:
        return Section(heading)
    return Section(f"{heading} on {given.data}", Notes(given.summary))


def assumed(chain: Chain, *more: str) -> Section:
    """What the numbers of a chain assume; terminals have `more` alone, which is of the result."""
    found = [Notes(assumptions(chain), Level.PAGE), Notes([one for one in more if one])]
    return Section("Assumptions", *found)


def tie_notes(ties: Iterable[Tie], chain: Chain | None) -> list[str]:
    """Advice on ties, once for the same cells and for cells that are alike.

    Args:
        ties: in the order in which they are met.
        chain: whose they are; None where it is not known, and then no cells are alike.

    Returns:
        A note for each: the advice on the first tie, and where the others are.
    """
    alike = {} if chain is None else _alike(chain)
    groups: dict[tuple[frozenset[int], int], list[Tie]] = {}
    for tie in ties:
        cells = frozenset(alike.get(cell, cell) for cell in tie.cells)
        groups.setdefault((cells, len(tie.cells)), []).append(tie)
    return [_note(group, chain) for group in groups.values()]


def _alike(chain: Chain) -> dict[int, int]:
    """For each cell the innermost one that is the same but for its name."""
    bare = [replace(cell, name="") for cell in chain.cells]
    first: dict[object, int] = {}
    return {i: first.setdefault(cell, i) for i, cell in enumerate(bare)}


def _note(group: list[Tie], chain: Chain | None) -> str:
    first = group[0]
    unit, factor = told_in(chain.drive_unit if chain else "m")
    # A rounding error is no other place, and has no sign.
    drives = dict.fromkeys(f"{round(tie.drive * factor, 6) + 0.0:.6g}" for tie in group)
    others = list(drives)[1:]
    cells = dict.fromkeys(cell for tie in group for cell in tie.cells)
    note = first.advice
    if set(cells) != set(first.cells) and chain is not None:
        note += f" So it is with all of {', '.join(chain.names[c] for c in sorted(cells))}, alike"
        note += " as they are" + (", also" if others else ".")
    elif others:
        note += " So it is also"
    if others:
        more = len(others) - _MOST_DRIVES
        note += f" at {', '.join(others[:_MOST_DRIVES])} {unit}"
        note += f" and {more} places more." if more > 0 else "."
    return note
