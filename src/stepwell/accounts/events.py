"""Switches and snaps of a chain, and whether snaps land there for other mobilities."""

import math
from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import Any

from stepwell import base, mechanism
from stepwell.accounts.head import DesignShape, Row, keys, recorded
from stepwell.accounts.parts import CARD, Fact, RecordTable, Sections, Warned
from stepwell.base import Column, Quantity
from stepwell.statics import Cause, Event, Landing, Path, SafeRate

NOT_CHECKED = "not checked for other mobilities"
_ARRIVAL = keys(cell=(int, itemgetter(0)), state=(int, itemgetter(1)))


def event_schema(shape: DesignShape) -> base.Schema:
    """What is reported of a switch or a snap."""
    schema = (
        Quantity("kind", head="event"),
        Quantity("cause"),
        Quantity("direction", head="while", read=way),
        Quantity("drive", shape.drive),
        Quantity("stroke", "mm", "stroke"),
        Quantity("cells", holds=[int]),
        Quantity("before", "mm", holds=[float]),
        Quantity("after", "mm", holds=[float]),
        *(keys(sheets_before=[int], sheets_after=[int]) if shape.folds else ()),
        Quantity("force_before", "N", "force before"),
        Quantity("force_after", "N", "force after"),
        Quantity("released", "mJ", "released"),
        Quantity("arrivals", holds=[_ARRIVAL]),
        *keys(tie=bool, distance_force="N", distance_travel="mm", error="mm", decided=str | None),
    )
    return base.in_measure(schema, shape.measure)


def way(event: Any) -> str:
    """Whether an event happens during loading or unloading."""
    return "loading" if event.direction > 0 else "unloading"


def landed(landings: Sequence[Landing] | None, events: Sequence[Event]) -> list[Row] | None:
    """Landings with the numbers of their snaps; None where they were not checked."""
    if landings is None:
        return None
    rows: list[Row] = []
    # Landings are in the order of their snaps: of equal snaps the next one is meant.
    for landing in landings:
        at = events.index(landing.event, rows[-1]["event"] + 1 if rows else 0)
        rows.append({"event": at, "landing": landing})
    return rows


def landing_schema(shape: DesignShape) -> base.Schema:
    """What is known of the landing of a snap, read from a row of `landed`."""
    known = keys(holds=bool, ratio=float, proof=str | None, corners=int, samples=int, bound=float)
    elsewhere = Quantity("elsewhere", holds=[_elsewhere(shape)])
    return (*keys(event=int), *base.read_off((*known, elsewhere), "landing"))


def _elsewhere(shape: DesignShape) -> base.Schema:
    schema = (
        Quantity("state", head="in state"),
        Quantity("travel", "mm", holds=[float]),
        *keys(mobility=[float], fraction=float),
        *(keys(sheet=[int]) if shape.folds else ()),
    )
    return base.in_measure(schema, shape.measure)


def event_sections(
    chain: mechanism.Chain, events: Sequence[Event], landings: Sequence[Landing] | None
) -> Sections:
    """Switches and snaps as a table, and where snaps land for other mobilities of the cells."""
    measure = chain.measure
    arriving = "in another phase" if chain.elements else "at a stop"
    event, place = event_schema(DesignShape.of(chain)), _elsewhere(DesignShape.of(chain))
    known = {quantity.attribute: quantity for quantity in event}
    table = RecordTable(
        _columns(chain, known),
        recorded(event, events),
        f"A switch is a cell arriving {arriving}; a snap is a jump at a fixed {measure.stroke}. "
        f"{measure.stroke.capitalize()}s are exact, not read off a grid.",
        wide=[Column("cause", lambda row: Cause[row["cause"].upper()].value)],
        more="switches and snaps",
        level=CARD,
    )
    columns = (
        known["direction"],
        known["stroke"],
        Column("mobility factors", lambda row: _mobilities(row["mobility"], chain.names)),
        place[0],
        Column("samples", lambda row: f"{100 * row['fraction']:.0f} %", True),
    )
    rest = RecordTable(
        columns,
        lambda: [
            base.record(event, landing.event) | base.record(place, one)
            for landing in landings or ()
            for one in landing.elsewhere
        ],
        "Landings of the same snaps for other mobilities of the cells, with the mobilities nearest "
        "to the given ones that lead there and the fraction of the samples.",
    )
    return {"Switches and snaps": table, "Landings that other mobilities of the cells change": rest}


def _columns(chain: mechanism.Chain, known: Mapping[str, Quantity]) -> base.Columns:
    names = chain.names
    here, there, lost = (known[key] for key in ("before", "after", "released"))
    forces = known["force_before"], known["force_after"]

    def moves(row: Row) -> str:
        if row["kind"] == "switch":
            return ", ".join(f"{names[a['cell']]} at {a['state']}" for a in row["arrivals"])
        ends = zip(row["cells"], row[here.key], row[there.key], strict=True)
        # Lever cells show by their travels where they arrive.
        to = {a["cell"]: f" at {a['state']}" for a in row["arrivals"] if chain.elements}
        return ", ".join(
            f"{names[cell]} {base.number(a)} → {base.number(b)}{to.get(cell, '')}"
            for cell, a, b in ends
        )

    def force(row: Row) -> str:
        return " → ".join(q.cell(row) for q in forces[: 2 if row["kind"] == "snap" else 1])

    return (
        known["direction"],
        known["kind"],
        known["stroke"],
        Column(f"cells [{here.sign} of {chain.measure.travel}]", moves),
        Column(f"{chain.measure.force} [{forces[0].sign}]", force, True),
        Column(lost.heading, lambda row: lost.cell(row) * (row["kind"] == "snap"), True),
    )


def extrapolated(path: Path) -> list[Row]:
    """Elements that a path uses past an end of their curve, and that curve."""
    names, cells = path.chain.names, path.chain.cells
    curves = ((names[i], cells[i], travel) for i, travel in path.extrapolated)
    return [{"cell": n, "used": at, "low": c.low, "high": c.high} for n, c, at in curves]


def extrapolated_schema(shape: DesignShape, path: str) -> base.Schema:
    """What is reported of elements past an end of their curve; `path` is where the path is read."""
    each = base.in_measure(keys(cell=str, used="mm", low="mm", high="mm"), shape.measure)
    past = Quantity("extrapolated", read=extrapolated, holds=[each])
    return base.read_off([past], path)


def extrapolated_warning(path: Path) -> Warned:
    """The warning of elements past an end of their curve."""
    unit, factor = base.display_unit(path.chain.measure.travel_unit)

    def line(row: Row) -> str:
        used, low, high = (base.number(row[key] * factor) for key in ("used", "low", "high"))
        return (
            f"Element {row['cell']} is used at {used} {unit}, outside its known {low} to {high} "
            f"{unit}; the {path.chain.measure.force} there is extrapolated."
        )

    text = "Past an end without a stop a curve is extended straight. Measure over more travel."
    return Warned("Extrapolated curves", text, [line(row) for row in extrapolated(path)])


def landing_words(landings: Sequence[Landing] | None) -> str:
    """How many landings hold for other mobilities, in a line; "" where there are no snaps."""
    if landings is None:
        return NOT_CHECKED
    if not landings:
        return ""
    holding = [one for one in landings if one.holds]
    sampled = [one for one in holding if one.proof is None]
    ratio = f"for mobility ratios up to {base.number(landings[0].ratio)}"
    words = f"{len(holding)} of {len(landings)} hold {ratio}"
    if proved := len(holding) - len(sampled):
        words += f"; {proved} proved"
    if sampled:
        words += (
            f"; {len(sampled)} sampled: at most "
            f"{base.percent_at_most(max(one.bound for one in sampled))} of mobilities lead "
            f"elsewhere (95 % confidence, {min(one.samples for one in sampled)} samples)"
        )
    return words


def _mobilities(mobility: Sequence[float], names: Sequence[str]) -> str:
    """Factors on the given mobilities, with the least as 1."""
    least = min(mobility)
    named = zip(names, mobility, strict=True)
    above = [f"{name} {base.number(x / least, 3)}" for name, x in named if x > least]
    return ", ".join([*above, "others 1"])


def _finite(path: Path) -> float | None:
    rate = path.usual_safe_rate.rate
    return None if rate is None or math.isinf(rate) else rate


def assumed_of(safe: SafeRate) -> str:
    """What a safe rate assumes, or why there is none."""
    if safe.rate is None or math.isinf(safe.rate):
        return safe.reason
    how = "proved by energy" if safe.proved else "two rates were integrated"
    mass = base.amount(safe.masses[0], "kg", 3)
    return f"blocks of {mass}, no dampers, dead stops, a crank; snaps: {how}"


# Of a path: cycles per second, None where any rate is safe or none is known to be.
RATE: base.Schema = keys(
    safe_rate=("Hz", _finite),
    safe_rate_assumes=(str, lambda path: assumed_of(path.usual_safe_rate)),
)


def rate_fact(path: Path) -> Fact:
    """The safe rate in a line."""
    safe = path.usual_safe_rate
    if safe.rate is None:
        text = f"none known: {safe.reason}"
    elif math.isinf(safe.rate):
        text = f"any: {safe.reason}"
    else:
        mass = base.amount(safe.masses[0], "kg", 3)
        text = f"{base.amount(safe.rate, 'Hz', 3)} with blocks of {mass}"
    return Fact("Safe rate", text)
