"""Phrases and sections that several kinds of results share, assumptions among them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from stepwell.accounts.head import About
from stepwell.accounts.parts import PAGE, Notes, Sections, Warned
from stepwell.base import Measure, Quantity, amount, counted, display_unit, join_first, number
from stepwell.mechanism import Cell, Chain, Element, Linear

if TYPE_CHECKING:
    from stepwell.sequences import Cycle, Program
    from stepwell.simulation import Walk
    from stepwell.statics import Tie

# Of longer chains states are not written out in a line, and no change is followed to its end.
LONGEST_IN_A_LINE = 12
# The states of a chain are as many as its cells, each as long: past this only orders are given.
_LONGEST_SPELLED_OUT = 64
_MOST_DRIVES = 6
_RIGID = (
    "Levers and blocks are rigid, joints have no play, and each cell stops where its blocks touch."
)


def assumptions(chain: Chain) -> list[str]:
    """What the results of a chain rest on, a sentence each."""
    words = chain.measure
    named = list(zip(chain.names, chain.cells, strict=True))
    levers = [(name, cell) for name, cell in named if isinstance(cell, Cell)]
    elements = [(name, cell) for name, cell in named if isinstance(cell, Element)]
    rubbed = [f"{n} {amount(c.friction, words.force_unit)}" for n, c in named if c.friction]

    def having(holds: Callable[[Cell], Any], none: str, some: str, every: str = "") -> str:
        found = [name for name, cell in levers if holds(cell)]
        if every and len(found) == len(levers):
            return every
        return some.format(listed(found)) if found else none

    bands = (
        having(
            lambda cell: any(band.two_sided for band in cell.bands),
            "Bands pull and never push: a slack band carries nothing.",
            "Bands of {} are two-sided springs that also push; the others pull only.",
            "Bands are two-sided springs, as in the paper: below rest length they push.",
        ),
        having(
            lambda cell: any(not isinstance(band.law, Linear) for band in cell.bands),
            "Bands are linear: tension is stiffness times extension, without hysteresis.",
            "Bands of {} follow a nonlinear law; the others are linear.",
            "Bands follow a nonlinear law.",
        ),
    )
    load = having(
        lambda cell: cell.load is not None,
        "No weight or other load acts on a cell.",
        "A load that depends on its travel acts on {}.",
    )
    smooth = "No friction between blocks." if levers else "No friction."
    rubs = f"Coulomb friction against {words.travel}: {listed(rubbed)}."
    return [
        f"Quasi-static: the {words.stroke} changes slowly, inertia plays no part between snaps.",
        *([_RIGID] if levers else []),
        *(_curves(elements, words) if elements else []),
        "After a snap the chain lands where overdamped flow at fixed drive leads it, "
        f"{_mobile(named, words)}; the energy released is lost.",
        actuator_words(chain),
        *(bands if levers else []),
        rubs if rubbed else smooth,
        *([load] if levers else []),
    ]


def simulation_assumptions(walk: Walk) -> list[str]:
    """What the numbers of a simulated walk assume, a sentence each."""
    robot, settings = walk.robot, walk.settings
    rods = " and ".join(dict.fromkeys(number(one.friction) for one in robot.antennas))
    return [
        f"Simulated with inertia, contact and friction by MuJoCo, in steps of "
        f"{amount(settings.time_step, 's')}; nothing is random.",
        "The actuator's stroke over time is the only command; gaits follow from bands, weight and "
        "contact.",
        "Levers, links, blocks and floor are rigid, joints have no play; contacts and stops yield "
        f"with a time constant of {amount(settings.contact_time, 's')}.",
        f"Coulomb friction on a flat floor: coefficient {number(robot.floor.foot_friction)} under "
        f"the feet, {number(robot.support_friction)} under the supports.",
        *([f"Antennas are rigid rods on springs, with friction {rods} on walls."] if rods else []),
        "A manufactured robot differs from its nominal design in friction, bands and assembly.",
    ]


def _mobile(named: list[tuple[str, Cell | Element]], words: Measure) -> str:
    if len({cell.mobility for _, cell in named}) == 1:
        return f"every {words.travel} being equally mobile"
    others = [f"{name} {number(cell.mobility)}" for name, cell in named if cell.mobility != 1.0]
    rest = "" if len(others) == len(named) else ", all others 1"
    return f"every cell with its own mobility: {listed(others)}{rest}"


def _curves(elements: list[tuple[str, Element]], words: Measure) -> Iterable[str]:
    yield (
        f"The {words.force} of {listed([name for name, _ in elements])} follows a curve over "
        f"{words.travel}, at any rate and whatever came before."
    )
    if beyond := [name for name, element in elements if not all(element.stopped)]:
        yield f"Past an end without a stop the curve of {listed(beyond)} goes on straight."
    if folded := [name for name, element in elements if len(element.laws) > 1]:
        yield (
            f"Where the curve of {listed(folded)} folds back, it jumps to the next stable stretch "
            f"along the curve."
        )


def actuator_words(chain: Chain) -> str:
    """What the actuator of a chain prescribes, in a sentence."""
    words, stiffness = chain.measure, chain.actuator_stiffness
    if math.isinf(stiffness):
        return f"The actuator is rigid: it prescribes the {words.stroke}."
    if stiffness == 0:
        return f"The actuator prescribes the {words.force}, not the {words.stroke}."
    return f"The actuator has a stiffness of {amount(stiffness, words.stiffness_unit)} in series."


def cells_of(chain: Chain) -> str:
    """How many cells a chain has."""
    return f"{counted(len(chain), 'cell')}, innermost first"


def spelled_out(found: Cycle | Program) -> str | None:
    """The sequence of a cycle or a program; None of a long chain."""
    return str(found.sequence) if len(found.chain) <= _LONGEST_SPELLED_OUT else None


def listed(items: Sequence[str]) -> str:
    """Names in a line, the first of many."""
    return join_first(items, LONGEST_IN_A_LINE)


def turning_points(points: Sequence[float], chain: Chain) -> str:
    """Turning points of the drive, in SI, in a line."""
    unit, factor = display_unit(chain.drive_unit)
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


def calibration(about: About) -> Sections:
    """What the recordings gave that a design was calibrated on."""
    given, heading = about.calibrated, "Bands, weight and friction as calibrated"
    return {f"{heading} on {given.data}": Notes(given.summary)} if given else {heading: ()}


def assumed(chain: Chain, *more: str) -> Sections:
    """What the numbers of a chain assume; terminals have `more` alone, which is of the result."""
    return {"Assumptions": (Notes(assumptions(chain), PAGE), Notes([*filter(None, more)]))}


def tie_notes(ties: Iterable[Tie], chain: Chain | None) -> list[str]:
    """Advice on ties, once for the same cells and for cells that are alike.

    Args:
        ties: in the order in which they are met.
        chain: whose they are; None where it is not known, and then no cells are alike.

    Returns:
        A note for each: the advice on the first tie, and where the others are.
    """
    # For each cell the innermost one that is the same but for its name.
    first: dict[object, int] = {}
    bare = [replace(cell, name="") for cell in (chain.cells if chain else ())]
    alike = {i: first.setdefault(cell, i) for i, cell in enumerate(bare)}
    groups: dict[tuple[frozenset[int], int], list[Tie]] = {}
    for tie in ties:
        cells = frozenset(alike.get(cell, cell) for cell in tie.cells)
        groups.setdefault((cells, len(tie.cells)), []).append(tie)
    return [_note(group, chain) for group in groups.values()]


def _note(group: list[Tie], chain: Chain | None) -> str:
    unit, factor = display_unit(chain.drive_unit if chain else "m")
    # A rounding error is no other place, and has no sign.
    drives = dict.fromkeys(f"{round(tie.drive * factor, 6) + 0.0:.6g}" for tie in group)
    others = list(drives)[1:]
    cells = {cell for tie in group for cell in tie.cells}
    note = group[0].advice
    if cells != set(group[0].cells) and chain is not None:
        note += f" So it is with all of {', '.join(chain.names[c] for c in sorted(cells))}, alike"
        note += " as they are" + (", also" if others else ".")
    elif others:
        note += " So it is also"
    if others:
        more = len(others) - _MOST_DRIVES
        note += f" at {', '.join(others[:_MOST_DRIVES])} {unit}"
        note += f" and {more} places more." if more > 0 else "."
    return note
