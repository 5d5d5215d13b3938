"""Designs that were found or changed: what to build, and how surely it works."""

import math
from dataclasses import replace
from operator import itemgetter
from typing import Any

from stepwell import base
from stepwell.accounts import run, yields
from stepwell.accounts.chain import BAND, actuator_schema, cell_columns, cell_schema, named
from stepwell.accounts.head import About, Shape, keys, of_class, recorded
from stepwell.accounts.parts import CARD, PAGE, Account, Fact, RecordTable, Text
from stepwell.accounts.words import LONGEST_IN_A_LINE, assumed, cells_of
from stepwell.base import Quantity, Schema, amount, join_first, number, signed, to_unit
from stepwell.design import Design, Impossible, Reprogramming, Robustness

# More states than these are not read in a line.
_MOST_STATES = 16
_ROBUSTNESS: Schema = (
    *keys(radius="mm", share=float, limit=str),
    Quantity("meet", read=lambda one: one.meeting and one.meeting[1:3], holds=[int], missing=True),
    Quantity("while", read=lambda one: one.meeting and one.meeting.way, missing=True),
)
_SCALES: Schema = (
    Quantity("force_scale", head="force scale", holds=float, left=False),
    Quantity("travel_scale", head="travel scale", holds=float, left=False),
)
_LEVER: Schema = (Quantity("lever", "mm", "lever"), Quantity("limit", "deg"))
# Of the places on the way tables have every k-th.
_EVERY = 5
_PLACE: Schema = (
    Quantity("fraction", read=itemgetter(0), holds=float),
    Quantity("at", "mm", read=itemgetter(1), holds=[float]),
    Quantity("force_at_0", "N", "at state 0", itemgetter(2)),
    Quantity("force_at_1", "N", "at state 1", itemgetter(3)),
    Quantity("largest_force", "N", "largest", itemgetter(4)),
)


def design_schema(shape: Shape) -> Schema:
    """What is reported of a design; where there is none, what is known of it has null."""
    found = (
        *keys(sequence=str, loading_order=([int], "loading"), unloading_order=([int], "unloading")),
        *keys(state_count=(int, "reached.count"), states=([str], _states)),
        *keys(states_whole=(bool, "reached.whole"), states_how=(str, "reached.how")),
        Quantity("actuator", read="chain", holds=actuator_schema(shape)),
        Quantity("cells", read=lambda one: named(one.chain), holds=[built_schema(shape)]),
        *keys(holes="mm", candidates=int, robustness=_ROBUSTNESS),
        Quantity("yield", read="yield_", holds=yields.inner_yield_schema(shape)),
        Quantity("assumptions"),
    )
    gaps = base.in_measure(keys(largest_gap="N", gap_needed="N"), shape.measure)
    return (
        Quantity("title", read=lambda one: "" if _none(one) else one.chain.title),
        Quantity("possible", read=lambda one: not _none(one), holds=bool),
        Quantity("proved", holds=bool),
        Quantity("reason", read=lambda one: str(one) if _none(one) else one.method),
        *of_class(Design, found),
        *of_class(Impossible, gaps),
    )


def _none(value: Design | Impossible) -> bool:
    return isinstance(value, Impossible)


def _states(found: Design) -> tuple[str, ...] | None:
    return found.states if len(found.chain) <= LONGEST_IN_A_LINE else None


def built_schema(shape: Shape) -> Schema:
    """What has to be built: anchors and the band of each cell, or scales of elements."""
    if shape.elements:
        return (*cell_schema(shape), *base.read_off(_SCALES, "cell"))
    name, p, q, *band = BAND
    forces = [one for one in cell_schema(shape) if one.key in ("F0_N", "F1_N")]
    # What can be chosen stands before what is given.
    first = [
        replace(one, read=lambda it, q=one: q.of(it["cell"].bands[0])) for one in (q, p, *band)
    ]
    return (name, *first, *base.read_off(_LEVER, "cell"), *forces)


def impossible_account(value: Impossible, about: About) -> Account:
    """What is reported where there is no such design."""
    proved = "This is proved." if value.proved else "A search found none; that is no proof."
    schema = design_schema(Shape(value.measure))
    return Account(value, "No such design", "design/2", str(value), origin=proved, schema=schema)


def robustness_account(value: Robustness, about: About) -> Account:
    """What a notebook shows of a robustness."""
    return Account(value, "Robustness", answer=str(value))


def design_account(found: Design, about: About) -> Account:
    """What is reported of a design."""
    chain, sampled = found.chain, found.yield_
    facts = (
        *yields.counted_facts(sampled),
        yields.critical_fact(sampled),
        *(replace(fact, level=PAGE) for fact in run.cycle_facts(found.cycle)),
    )
    built = built_schema(Shape.of(chain))
    columns, rows = cell_columns(built, chain), recorded(built, named(chain))
    anchors = "" if chain.elements else "p is the anchor on the inner block, q on the outer block."
    cells = RecordTable(columns, rows, anchors, most=None, more="cells", level=CARD)

    def reachable() -> str:
        count, states = found.reached.count, _states(found)
        text = f"{count} states" + " surely" * (not found.reached.whole)
        return text if states is None else f"{text}: {join_first(states, _MOST_STATES)}"

    def more() -> str:
        reached = found.reached
        return "" if reached.whole else f"more states may be reachable: {reached.how}"

    sections = {
        "Cells, innermost first": cells,
        "Robustness": Text(lambda: str(found.robustness or "")),
        "Reachable states": (Text(reachable), Text(more)),
        "Outcomes of the samples": (yields.PICTURES[1], yields.other_outcomes(sampled)),
        "Method": Text(found.method, CARD),
        **assumed(chain, found.assumptions),
    }
    spelled = len(chain) <= LONGEST_IN_A_LINE
    answer = found.sequence if spelled else f"{len(chain)} cells in the target order"
    title, origin = chain.title or "A design", f"Found by search. {cells_of(chain)}."
    warned, seed = [yields.advised(sampled)], sampled.seed
    return Account(found, title, "design/2", answer, facts, sections, warned, origin, seed=seed)


def reprogram_schema(shape: Shape) -> Schema:
    """What is reported of a reprogramming; what is in another unit than the change has null."""
    force = shape.measure.force_unit
    anchors = _change_schema("mm", "m", [float])
    scales = (*_change_schema("", "1"), *_change_schema(base.display_unit(force)[0], force))
    resistance = keys(largest_force=("N", "largest"), work_at_0=("mJ", "work_0"))
    return (
        *keys(title=(str, "chain.title"), by=str, target=str | None, possible=(bool, _possible)),
        *keys(before=str, after=(str | None, lambda found: found.after or None)),
        *(anchors if shape.levers else ()),
        *(scales if shape.elements else ()),
        *keys(reach="mm", method=str, resolution=str),
        *base.read_off((*resistance, Quantity("work_at_1", "mJ", read="work_1")), "resistance"),
        *keys(way=([_PLACE], _way)),
    )


def _change_schema(unit: str, si: str, holds: Any = float) -> Schema:
    """Size, way and end of a change; None where it is in another unit than `si`."""

    def of(name: str, holds: Any, missing: bool = True) -> Quantity:
        def read(found: Reprogramming) -> Any:
            return getattr(found, name) if found.unit == si else None

        return Quantity(name, unit, read=read, holds=holds, missing=missing)

    return of("distance", float, False), of("displacement", holds), of("place", holds)


def _way(found: Reprogramming) -> list[tuple[Any, ...]]:
    pull = found.resistance
    # A rounding error has no sign.
    at = zip(found.along(0) + 0.0, found.along(1) + 0.0, strict=True)
    return [*zip(pull.fraction, at, pull.force_0, pull.force_1, pull.peak, strict=True)]


def _possible(found: Reprogramming) -> bool:
    return math.isfinite(found.distance)


def _already(found: Reprogramming) -> bool:
    """Whether the nominal design reproduces the target; at a tie any change at all decides."""
    return found.distance == 0 and found.after == found.before


def reprogramming_account(found: Reprogramming, about: About) -> Account:
    """What is reported of a reprogramming."""
    chain = found.chain
    changes = _possible(found) and not _already(found)
    facts = (
        Fact("Target", found.target or "any other sequence"),
        Fact("Sequence now", found.before),
        *(_change_facts(found) if changes else ()),
        Fact("Method", str(found.method)),
    )
    searched = f"searched, not exact: {found.resolution}" if found.resolution else ""
    title, answer = chain.title or "Reprogramming", _reprogramming_answer(found)
    sections = {
        "Force against the displacement": [_force_table(found)] if changes else [],
        **assumed(chain, searched),
    }
    origin = f"{cells_of(chain)}."
    return Account(found, title, "reprogram/2", answer, facts, sections, origin=origin)


def _reprogramming_answer(found: Reprogramming) -> str:
    target = found.target or "another sequence"
    if not _possible(found):
        if math.isinf(found.reach):
            return f"No value of {found.by} that was tried gives {target}"
        return f"No displacement of {found.by} up to {amount(found.reach, 'm')} gives {target}"
    if _already(found):
        return f"The nominal design has the sequence {found.before} already"
    if isinstance(found.displacement, tuple):
        return f"{found.by} moved by {amount(found.distance, 'm')} gives {found.after}"
    return f"{found.by} changed to {_number(found, found.place)} gives {found.after}"


def _change_facts(found: Reprogramming) -> tuple[Fact, ...]:
    """The change, and what resists it."""
    past, by, place = Fact("Sequence past it", found.after), found.displacement, found.place
    if not (isinstance(by, tuple) and isinstance(place, tuple)):
        sign = signed(float(by) * base.display_unit(found.unit)[1])  # type: ignore[arg-type]
        return past, Fact("Change", f"{found.by} to {_number(found, place)} ({sign})")
    move = ", ".join(signed(to_unit(one, "mm")) for one in by)
    to = ", ".join(number(to_unit(one, "mm")) for one in place)
    pull, far = found.resistance, amount(found.distance, "m")
    work_0, work_1 = amount(pull.work_0, "J"), amount(pull.work_1, "J")
    return (
        past,
        Fact("Displacement", f"{found.by} by ({move}) mm, {far}, to ({to}) mm"),
        Fact("Force", f"up to {amount(pull.largest, 'N')} against the displacement"),
        Fact("Work", f"{work_0} at state 0 of the cell, {work_1} at state 1"),
    )


def _number(found: Reprogramming, value: Any) -> str:
    unit, factor = base.display_unit(found.unit)
    return f"{number(value * factor)} {Quantity('', unit).sign}".removesuffix(" 1")


def _force_table(found: Reprogramming) -> RecordTable:
    """The force on the way of an anchor."""
    distance = to_unit(found.distance, "mm")
    columns = (
        base.Column("moved [mm]", lambda row: number(row["fraction"] * distance), True),
        base.Column("x [mm]", lambda row: number(row["at_mm"][0]), True),
        base.Column("y [mm]", lambda row: number(row["at_mm"][1]), True),
        *_PLACE[2:],
    )
    about = (
        f"The force along the displacement, which resists it where it is positive; of the places "
        f"on the way every {_EVERY}th."
    )
    return RecordTable(columns, recorded(_PLACE, _way(found)[::_EVERY]), about)
