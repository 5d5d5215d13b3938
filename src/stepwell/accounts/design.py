"""Designs that were found or changed: what to build, and how surely it works."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from stepwell import base
from stepwell.accounts import run, yields
from stepwell.accounts.chain import BAND, actuator_schema, cell_columns, cell_schema, named
from stepwell.accounts.head import About, Shape, of_class
from stepwell.accounts.parts import Account, Fact, Level, Part, Picture, RecordTable, Section, Text
from stepwell.accounts.words import LONGEST_IN_A_LINE, assumed, cells_of
from stepwell.base import Quantity, Schema
from stepwell.design import Design, Impossible

if TYPE_CHECKING:
    from stepwell.design import Reprogramming, Robustness


# More states than these are not read in a line.
_MOST_STATES = 16


def design_schema(shape: Shape) -> Schema:
    """What is reported of a design; where there is none, what is known of it has null."""
    found = (
        Quantity("sequence"),
        Quantity("loading_order", read="loading", holds=[int]),
        Quantity("unloading_order", read="unloading", holds=[int]),
        Quantity("state_count", read="reached.count", holds=int),
        Quantity("states", read=_states, holds=[str]),
        Quantity("states_whole", read="reached.whole", holds=bool),
        Quantity("states_how", read="reached.how"),
        Quantity("actuator", read="chain", holds=actuator_schema(shape)),
        Quantity("cells", read=lambda one: named(one.chain), holds=[built_schema(shape)]),
        *base.quantities(holes="mm", candidates=int, robustness=_ROBUSTNESS),
        Quantity("yield", read="yield_", holds=yields.inner_yield_schema(shape)),
        Quantity("assumptions"),
    )
    return (
        Quantity("title", read=lambda one: "" if _none(one) else one.chain.title),
        Quantity("possible", read=lambda one: not _none(one), holds=bool),
        Quantity("proved", holds=bool),
        Quantity("reason", read=lambda one: str(one) if _none(one) else one.method),
        *of_class(Design, found),
        *of_class(Impossible, base.in_measure(_GAPS, shape.measure)),
    )


_GAPS: Schema = base.quantities(largest_gap="N", gap_needed="N")
_ROBUSTNESS: Schema = (
    *base.quantities(radius="mm", share=float, limit=str),
    Quantity("meet", read=lambda one: one.meeting and one.meeting[1:3], holds=[int], missing=True),
    Quantity("while", read=lambda one: one.meeting and one.meeting.way, missing=True),
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
    return (name, *map(_of_band, (q, p, *band)), *base.read_off(_LEVER, "cell"), *forces)


_SCALES: Schema = (
    Quantity("force_scale", head="force scale", holds=float, left=False),
    Quantity("travel_scale", head="travel scale", holds=float, left=False),
)
_LEVER: Schema = (Quantity("lever", "mm", "lever"), Quantity("limit", "deg"))


def _of_band(quantity: Quantity) -> Quantity:
    return replace(quantity, read=lambda one: quantity.of(one.cell.bands[0]))


def impossible_account(value: Impossible, about: About) -> Account:
    """What is reported where there is no such design."""
    return Account(
        value=value,
        title="No such design",
        kind="design/2",
        schema=design_schema(Shape(value.measure)),
        answer=str(value),
        origin="This is proved." if value.proved else "A search found none; that is no proof.",
    )


def robustness_account(value: Robustness, about: About) -> Account:
    """What a notebook shows of a robustness."""
    return Account(value=value, title="Robustness", answer=str(value))


def design_account(found: Design, about: About) -> Account:
    """What is reported of a design."""
    chain = found.chain
    spelled = len(chain) <= LONGEST_IN_A_LINE
    return Account(
        value=found,
        title=chain.title or "A design",
        kind="design/2",
        schema=design_schema(Shape.of(chain)),
        origin=f"Found by search. {cells_of(chain)}.",
        answer=found.sequence if spelled else f"{len(chain)} cells in the target order",
        seed=found.yield_.seed,
        facts=(
            *yields.counted_facts(found.yield_),
            yields.critical_fact(found.yield_),
            *(replace(fact, level=Level.PAGE) for fact in run.cycle_facts(found.cycle)),
        ),
        warnings=[yields.advised(found.yield_)],
        sections=(
            _cells(found),
            Section(
                "Robustness", lambda: [Text(str(found.robustness or ""))], level=Level.TERMINAL
            ),
            Section("Reachable states", lambda: _reachable(found), level=Level.TERMINAL),
            Section(
                "Outcomes of the samples",
                Picture("force-plane", yields.FORCE_PLANE),
                yields.other_outcomes(found.yield_),
            ),
            Section("Method", Text(found.method, Level.CARD)),
            assumed(chain, found.assumptions),
        ),
    )


def _cells(found: Design) -> Section:
    schema = built_schema(Shape.of(found.chain))
    table = RecordTable(
        cell_columns(schema, found.chain),
        lambda: [base.record(schema, one) for one in named(found.chain)],
        "" if found.chain.elements else "p is the anchor on the inner block, q on the outer block.",
        most=None,
        more="cells",
        level=Level.CARD,
    )
    return Section("Cells, innermost first", table)


def _reachable(found: Design) -> list[Part]:
    reached, states = found.reached, _states(found)
    listed = f"{reached.count} states" + " surely" * (not reached.whole)
    if states is not None:
        listed += f": {', '.join(states[:_MOST_STATES])}"
        left = len(states) - _MOST_STATES
        listed += f" and {left} more" * (left > 0)
    more = "" if reached.whole else f"more states may be reachable: {reached.how}"
    return [Text(listed), Text(more)]


# Of the places on the way tables have every k-th.
_EVERY = 5


def reprogram_schema(shape: Shape) -> Schema:
    """What is reported of a reprogramming; what is in another unit than the change has null."""
    force = shape.measure.force_unit
    return (
        Quantity("title", read="chain.title"),
        *base.quantities(by=str, target=str | None),
        Quantity("possible", read=_possible, holds=bool),
        Quantity("before"),
        Quantity("after", read=lambda found: found.after or None, missing=True),
        *(_change_schema("mm", "m", [float]) if shape.levers else ()),
        *(
            (*_change_schema("", "1"), *_change_schema(base.told_in(force)[0], force))
            if shape.elements
            else ()
        ),
        *base.quantities(reach="mm", method=str, resolution=str),
        Quantity("largest_force", "N", read="resistance.largest"),
        Quantity("work_at_0", "mJ", read="resistance.work_0"),
        Quantity("work_at_1", "mJ", read="resistance.work_1"),
        Quantity("way", read=_way, holds=[_PLACE]),
    )


def _change_schema(unit: str, si: str, holds: Any = float) -> Schema:
    """Size, way and end of a change; None where it is in another unit than `si`."""

    def read(name: str) -> Callable[[Reprogramming], Any]:
        return lambda found: getattr(found, name) if found.unit == si else None

    return (
        Quantity("distance", unit, read=read("distance"), holds=float),
        Quantity("displacement", unit, read=read("displacement"), holds=holds, missing=True),
        Quantity("place", unit, read=read("place"), holds=holds, missing=True),
    )


_PLACE: Schema = (
    Quantity("fraction", read=itemgetter(0), holds=float),
    Quantity("at", "mm", read=itemgetter(1), holds=[float]),
    Quantity("force_at_0", "N", "at state 0", itemgetter(2)),
    Quantity("force_at_1", "N", "at state 1", itemgetter(3)),
    Quantity("largest_force", "N", "largest", itemgetter(4)),
)


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
    chain, method = found.chain, str(found.method)
    changes = _possible(found) and not _already(found)
    return Account(
        value=found,
        kind="reprogram/2",
        schema=reprogram_schema(Shape.of(chain)),
        title=chain.title or "Reprogramming",
        origin=f"{cells_of(chain)}.",
        answer=_reprogramming_answer(found),
        facts=(
            Fact("Target", found.target or "any other sequence"),
            Fact("Sequence now", found.before),
            *(_change_facts(found) if changes else ()),
            Fact("Method", method),
        ),
        sections=(
            Section("Force against the displacement", *([_force_table(found)] if changes else [])),
            assumed(chain, f"searched, not exact: {found.resolution}" if found.resolution else ""),
        ),
    )


def _reprogramming_answer(found: Reprogramming) -> str:
    target = found.target or "another sequence"
    if not _possible(found):
        if math.isinf(found.reach):
            return f"No value of {found.by} that was tried gives {target}"
        return f"No displacement of {found.by} up to {base.amount(found.reach, 'm')} gives {target}"
    if _already(found):
        return f"The nominal design has the sequence {found.before} already"
    if isinstance(found.displacement, tuple):
        return f"{found.by} moved by {base.amount(found.distance, 'm')} gives {found.after}"
    return f"{found.by} changed to {_number(found, found.place)} gives {found.after}"


def _change_facts(found: Reprogramming) -> tuple[Fact, ...]:
    """The change, and what resists it."""
    past, by, place = Fact("Sequence past it", found.after), found.displacement, found.place
    if not (isinstance(by, tuple) and isinstance(place, tuple)):
        sign = base.signed(float(by) * base.told_in(found.unit)[1])  # type: ignore[arg-type]
        return past, Fact("Change", f"{found.by} to {_number(found, place)} ({sign})")
    move = ", ".join(base.signed(base.to_unit(one, "mm")) for one in by)
    to = ", ".join(base.number(base.to_unit(one, "mm")) for one in place)
    pull = found.resistance
    return (
        past,
        Fact(
            "Displacement",
            f"{found.by} by ({move}) mm, {base.amount(found.distance, 'm')}, to ({to}) mm",
        ),
        Fact("Force", f"up to {base.amount(pull.largest, 'N')} against the displacement"),
        Fact(
            "Work",
            f"{base.amount(pull.work_0, 'J')} at state 0 of the cell, "
            f"{base.amount(pull.work_1, 'J')} at state 1",
        ),
    )


def _number(found: Reprogramming, value: Any) -> str:
    unit, factor = base.told_in(found.unit)
    return f"{base.number(value * factor)} {Quantity('', unit).sign}".removesuffix(" 1")


def _force_table(found: Reprogramming) -> RecordTable:
    """The force on the way of an anchor."""
    distance = base.to_unit(found.distance, "mm")
    return RecordTable(
        [
            base.Column("moved [mm]", lambda row: base.number(row["fraction"] * distance), True),
            base.Column("x [mm]", lambda row: base.number(row["at_mm"][0]), True),
            base.Column("y [mm]", lambda row: base.number(row["at_mm"][1]), True),
            *_PLACE[2:],
        ],
        lambda: [base.record(_PLACE, place) for place in _way(found)[::_EVERY]],
        f"The force along the displacement, which resists it where it is positive; of the places "
        f"on the way every {_EVERY}th.",
        more="places",
    )
