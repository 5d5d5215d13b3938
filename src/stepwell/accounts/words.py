"""Phrases and sections that several kinds of results share, assumptions among them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from stepwell.accounts.head import About
from stepwell.accounts.parts import FULL, TERMINAL, Level, Notes, Part, Sections, Warned
from stepwell.base import Quantity, amount, counted, display_unit, grouped, join_first, number
from stepwell.mechanism import Cell, Chain, Element, Linear, scatter_of_curve

if TYPE_CHECKING:
    from stepwell.sequences import Cycle, Program
    from stepwell.simulation import Walk
    from stepwell.statics import Tie

# States of longer chains are not written in a line.
LONGEST_IN_A_LINE = 12
# A sequence of longer chains is reported as orders only: it has a state per cell.
_LONGEST_SPELLED_OUT = 64
_MOST_DRIVES = 6


def assumptions(chain: Chain) -> list[str]:
    """The assumptions behind the results of a chain, a sentence each."""
    words, named = chain.measure, list(zip(chain.names, chain.cells, strict=True))
    rubbed = [f"{n} {amount(c.friction, words.force_unit)}" for n, c in named if c.friction]
    levers = [(name, cell) for name, cell in named if isinstance(cell, Cell)]
    landing = (
        "After a snap the chain lands where overdamped flow at fixed drive leads it, "
        f"{_mobilities(chain)}; the energy released is lost."
    )
    friction = f"Coulomb friction against {words.travel}: {listed(rubbed)}."
    quasi_static = (
        f"Quasi-static: the {words.stroke} changes slowly, inertia plays no part between snaps."
    )
    if not levers:
        rest = [friction if rubbed else "No friction."]
        return [quasi_static, *_curves(chain), landing, actuator_words(chain), *rest]

    def having(holds: Callable[[Cell], Any], none: str, some: str, every: str = "") -> str:
        matches = [name for name, cell in levers if holds(cell)]
        if every and len(matches) == len(levers):
            return every
        return some.format(listed(matches)) if matches else none

    return [
        quasi_static,
        "Levers and blocks are rigid, joints have no play, and each cell stops where its blocks "
        "touch.",
        *_curves(chain),
        landing,
        actuator_words(chain),
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
        friction if rubbed else "No friction between blocks.",
        having(
            lambda cell: cell.load is not None,
            "No weight or other load acts on a cell.",
            "A load that depends on its travel acts on {}.",
        ),
    ]


def simulation_assumptions(walk: Walk) -> list[str]:
    """The assumptions behind a simulated walk, a sentence each."""
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


def _mobilities(chain: Chain) -> str:
    if len({cell.mobility for cell in chain.cells}) == 1:
        return f"with the same mobility of every {chain.measure.travel}"
    named = zip(chain.names, chain.cells, strict=True)
    others = [f"{name} {number(cell.mobility)}" for name, cell in named if cell.mobility != 1.0]
    rest = "" if len(others) == len(chain) else ", all others 1"
    return f"with the mobility of each cell: {listed(others)}{rest}"


def _curves(chain: Chain) -> Iterable[str]:
    words, named = chain.measure, zip(chain.names, chain.cells, strict=True)
    elements = [(name, cell) for name, cell in named if isinstance(cell, Element)]
    if elements:
        yield (
            f"The {words.force} of {listed([name for name, _ in elements])} follows a curve over "
            f"{words.travel}, at any rate and for any history."
        )
    if beyond := [name for name, element in elements if not all(element.stopped)]:
        yield f"Past an end without a stop the curve of {listed(beyond)} is extended straight."
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


def spelled_out(result: Cycle | Program) -> str | None:
    """The sequence of a cycle or a program; None for a long chain."""
    return str(result.sequence) if len(result.chain) <= _LONGEST_SPELLED_OUT else None


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
        "Degenerate events (ties)",
        "The model cannot decide between their outcomes; a real mechanism will.",
        tie_notes(ties, chain),
    )


def curve_notes(chain: Chain) -> list[str]:
    """Sentences on elements whose scatter or error band changes results, or can change them."""
    notes: list[str] = []
    unit = chain.measure.force_unit
    for name, cell in zip(chain.names, chain.cells, strict=True):
        if not isinstance(cell, Element):
            continue
        drops = [one.force_high - two.force_low for one, two in pairwise(cell.phases)]
        # Without a drop, one of a fraction of the largest force would matter.
        if min(drops, default=0.25 * cell.largest_force) < 2.0 * cell.error_band:
            notes.append(
                f"{name}: its error band of {amount(cell.error_band, unit, 2)} can make or hide a "
                f"phase. Measure with less noise or more rows."
            )
        scatter = max(scatter_of_curve(one.rows, one.end) for one in cell.laws)
        if scatter:
            # Noise of a table is before scales.
            given = display_unit(unit)[1] * scatter / cell.force_scale
            key = f"noise_{display_unit(unit)[0]} = {given:.2g}"
            notes.append(
                f"{name}: its points scatter by about {amount(scatter, unit, 2)}, and the curve "
                f"passes through all of them, so that stiffness, snaps and dissipated energy are "
                f"partly scatter. Give {key} with its table, or use stepwell lab element."
            )
    return notes


def scattered(chain: Chain | None, sequences: Sequence[str] = ()) -> Warned:
    """The warning of measured curves: `curve_notes`, and other sequences in error bands."""
    others = f"Within the error bands the sequence can be {join_first(sequences, 4)} too."
    text = "Scatter of measured points changes the result, or can change it."
    notes = [] if chain is None else curve_notes(chain)
    return Warned("Measured curves", text, [*notes, *([others] if sequences else [])])


def calibration(about: About) -> Sections:
    """The results of the recordings on which a design was calibrated."""
    given, heading = about.calibrated, "Bands, weight and friction as calibrated"
    return {f"{heading} on {given.data}": Notes(given.summary)} if given else {heading: ()}


def assumed(chain: Chain, *more: str) -> Sections:
    """The assumptions of a chain, and `more` of a result, whose parts end with semicolons."""
    of_result = [one for text in more if text for one in text.split("; ")]
    return {"Assumptions": Notes([*assumptions(chain), *of_result], FULL)}


def tie_notes(ties: Iterable[Tie], chain: Chain | None) -> list[str]:
    """Advice on ties, once for the same cells and for cells that are alike.

    Args:
        ties: in the order of the events.
        chain: the chain with these ties; None if unknown, and then no cells are alike.

    Returns:
        A note for each: the advice on the first tie, and where the others are.
    """
    # The innermost cell that equals each cell except for the name.
    first: dict[object, int] = {}
    bare = [replace(cell, name="") for cell in (chain.cells if chain else ())]
    alike = {i: first.setdefault(cell, i) for i, cell in enumerate(bare)}
    groups = grouped(
        ((frozenset(alike.get(cell, cell) for cell in tie.cells), len(tie.cells)), tie)
        for tie in ties
    )
    return [_note(group, chain) for group in groups.values()]


def _note(group: list[Tie], chain: Chain | None) -> str:
    unit, factor = display_unit(chain.drive_unit if chain else "m")
    # A rounding error is no other drive, and has no sign.
    drives = dict.fromkeys(f"{round(tie.drive * factor, 6) + 0.0:.6g}" for tie in group)
    others, note = [*drives][1:], group[0].advice
    cells = {cell for tie in group for cell in tie.cells}
    alike = ""
    if cells != set(group[0].cells) and chain is not None:
        alike = f" for all of {', '.join(chain.names[c] for c in sorted(cells))}, which are alike"
    also = ""
    if others:
        more = f" and at {len(others) - _MOST_DRIVES} more" * (len(others) > _MOST_DRIVES)
        also = f"{', also' if alike else ''} at {', '.join(others[:_MOST_DRIVES])} {unit}{more}"
    return f"{note} The same holds{alike}{also}." if alike or others else note


# Letters of a line; the rest of a longer one is on the page and in JSON.
_WIDE = 96
# A word that names one file, run or number, and is not the kind of a note.
_OWN = re.compile(r"^['(+-]*[\w./\\-]*[\d_/\\][\w./\\%-]*[',);]*$")


def folded_notes(
    heading: str, lines: Sequence[str], most: int = 3, level: Level = TERMINAL
) -> dict[str, Part]:
    """Section of a list of notes: one line for each kind on a terminal, all lines on a page.

    Args:
        heading: of the section.
        lines: the notes, each "name: text".
        most: number of kinds that a terminal shows.
        level: shortest form that shows the folded list.
    """
    if not lines:
        return {}
    short = by_kind(lines, most)
    if len(lines) <= most and all(len(line) <= _WIDE for line in lines):
        return {heading: Notes(lines, level)}
    return {heading: Notes(lines, level, short)}


def by_kind(lines: Sequence[str], most: int = 3) -> list[str]:
    """The first line of each kind with the count of its kind, rare kinds first.

    Lines are of one kind if they differ in names of files and numbers only. Of more than `most`
    kinds, the last line has the count of the others.
    """
    kinds = sorted(grouped((_kind(line), line) for line in lines).values(), key=len)
    if len(kinds) > most:
        kinds, rest = kinds[: most - 1], kinds[most - 1 :]
        hidden = sum(map(len, rest))
        return [*map(_first, kinds), f"and {counted(hidden, 'more note')}"]
    return [*map(_first, kinds)]


def clipped(text: str, letters: int = _WIDE) -> str:
    """A text in at most this many letters, cut at a space."""
    if len(text) <= letters:
        return text
    return f"{text[: letters - 4].rpartition(' ')[0].rstrip(',;:')} ..."


def _first(lines: Sequence[str]) -> str:
    more = f" (and {len(lines) - 1} of this kind)" if len(lines) > 1 else ""
    source, colon, text = lines[0].partition(": ")
    file = source.replace("\\", "/").rpartition("/")[2]
    return clipped(f"{file}{colon}{text}", _WIDE - len(more)) + more


def _kind(line: str) -> str:
    """The first part of a note that is no name, without its names and numbers."""
    _, *parts = line.split(": ") if ": " in line else ("", line)
    for part in parts:
        words = [word for word in part.split() if not _OWN.match(word)]
        if any(len(word) > 2 for word in words):
            return " ".join(words)
    return line if not parts else parts[-1]
