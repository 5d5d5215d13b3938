"""A reprogramming: the smallest change of an anchor or a number that gives another sequence."""

from __future__ import annotations

import math
from collections.abc import Callable
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from stepwell.accounts.account import Account, Fact, Section, Table
from stepwell.accounts.head import About
from stepwell.accounts.shape import Shape
from stepwell.accounts.words import assumed, cells_of
from stepwell.base import Column, Quantity, Schema, amount, number, record, signed, told_in

if TYPE_CHECKING:
    from stepwell.design import Reprogramming

# Of the places on the way tables have every k-th.
_EVERY = 5


def reprogram_schema(shape: Shape) -> Schema:
    """What is reported of a reprogramming; what is in another unit than the change has null."""
    force = shape.measure.force_unit
    return (
        Quantity("title", read="chain.title"),
        Quantity("by"),
        Quantity("target", missing=True),
        Quantity("possible", read=_possible, holds=bool),
        Quantity("before"),
        Quantity("after", read=lambda found: found.after or None, missing=True),
        *(_change("mm", "m", [float]) if shape.levers else ()),
        *((*_change("", "1"), *_change(told_in(force)[0], force)) if shape.elements else ()),
        Quantity("reach", "mm"),
        Quantity("method"),
        Quantity("resolution"),
        Quantity("largest_force", "N", read="resistance.largest"),
        Quantity("work_at_0", "mJ", read="resistance.work_0"),
        Quantity("work_at_1", "mJ", read="resistance.work_1"),
        Quantity("way", read=_way, holds=[_PLACE]),
    )


def _change(unit: str, si: str, holds: Any = float) -> Schema:
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


def reprogramming_account(found: Reprogramming, about: About | None = None) -> Account:
    """What is reported of a reprogramming."""
    chain, method = found.chain, str(found.method)
    changes = _possible(found) and not _already(found)
    return Account(
        value=found,
        kind="reprogram/2",
        schema=reprogram_schema(Shape.of(chain)),
        title=chain.title or "Reprogramming",
        origin=f"{cells_of(chain)}.",
        answer=_answer(found),
        about=about or About(chain),
        facts=(
            Fact("Target", found.target or "any other sequence"),
            Fact("Sequence now", found.before),
            *(_changed(found) if changes else ()),
            Fact("Method", method),
        ),
        sections=(
            Section("Force against the displacement", [_table(found)] if changes else []),
            assumed(chain, f"searched, not exact: {found.resolution}" if found.resolution else ""),
        ),
    )


def _answer(found: Reprogramming) -> str:
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


def _changed(found: Reprogramming) -> tuple[Fact, ...]:
    """The change, and what resists it."""
    past, by, place = Fact("Sequence past it", found.after), found.displacement, found.place
    if not (isinstance(by, tuple) and isinstance(place, tuple)):
        sign = signed(float(by) * told_in(found.unit)[1])  # type: ignore[arg-type]
        return past, Fact("Change", f"{found.by} to {_number(found, place)} ({sign})")
    move = ", ".join(signed(one * 1e3) for one in by)
    to = ", ".join(number(one * 1e3) for one in place)
    pull = found.resistance
    return (
        past,
        Fact(
            "Displacement",
            f"{found.by} by ({move}) mm, {amount(found.distance, 'm')}, to ({to}) mm",
        ),
        Fact("Force", f"up to {amount(pull.largest, 'N')} against the displacement"),
        Fact(
            "Work",
            f"{amount(pull.work_0, 'J')} at state 0 of the cell, "
            f"{amount(pull.work_1, 'J')} at state 1",
        ),
    )


def _number(found: Reprogramming, value: Any) -> str:
    unit, factor = told_in(found.unit)
    return f"{number(value * factor)} {Quantity('', unit).sign}".removesuffix(" 1")


def _table(found: Reprogramming) -> Table:
    """The force on the way of an anchor."""
    distance = found.distance * 1e3
    return Table(
        [
            Column("moved [mm]", lambda row: number(row["fraction"] * distance), True),
            Column("x [mm]", lambda row: number(row["at_mm"][0]), True),
            Column("y [mm]", lambda row: number(row["at_mm"][1]), True),
            *_PLACE[2:],
        ],
        lambda: [record(_PLACE, place) for place in _way(found)[::_EVERY]],
        f"The force along the displacement, which resists it where it is positive; of the places "
        f"on the way every {_EVERY}th.",
        more="places",
    )
