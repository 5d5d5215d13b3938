"""Cycles and stroke programs as plain numbers with the unit in every name."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from stepwell.accounts import head, tie_notes
from stepwell.base import (
    Column,
    Columns,
    Quantity,
    Schema,
    in_measure,
    number,
    plain,
    record,
    signed,
    told_in,
)
from stepwell.mechanism import Cell, Chain, Element
from stepwell.results.landings import (
    checked,
    elsewhere_columns,
    landing_records,
)
from stepwell.sequences.programs import turn_schema
from stepwell.statics import Cause

if TYPE_CHECKING:
    from stepwell.design import Change, Margin
    from stepwell.sequences import Cycle, Program, Unreachable
    from stepwell.statics import Event, Landing

# The states of a chain are as many as its cells, each as long: past this only orders are told.
LONGEST_SPELLED_OUT = 64
# What a design becomes past each of its changes takes a cycle a change: longer chains are told
# the distances alone.
LONGEST_BECOMING = 12


def force_scale(cell: Cell) -> float:
    """k r [N] of a cell, with k of its stiffest band: what its forces are compared with."""
    return max(band.stiffness for band in cell.bands) * cell.lever


def _way(direction: int) -> str:
    return "loading" if direction > 0 else "unloading"


CELL: Schema = (
    Quantity("name", head="cell"),
    Quantity("F0", "N", "F0", "force_0"),
    Quantity("F1", "N", "F1", "force_1"),
    Quantity("F0", "over_kr", "F0/(kr)", lambda cell: cell.force_0 / force_scale(cell)),
    Quantity("F1", "over_kr", "F1/(kr)", lambda cell: cell.force_1 / force_scale(cell)),
    Quantity("full_travel", "mm", "travel"),
    Quantity("peak_angle", "deg", "peak"),
    Quantity("barrier", "mJ"),
    Quantity(
        "bistable", "", "stable", "is_bistable", lambda both: "both states" if both else "one state"
    ),
)
_ENDS = {
    (True, True): "both",
    (True, False): "at the low end",
    (False, True): "at the high end",
    (False, False): "none",
}
MARGIN: Schema = (
    Quantity("method"),
    Quantity("reach", "mm"),
    Quantity("gap", "over_kr"),
)


def cycle_schema(chain: Chain) -> Schema:
    """What is told of a cycle in numbers; ends of curves say little of how far it goes."""
    schema = (
        Quantity("dissipated", "mJ"),
        Quantity("peak_force", "N"),
        Quantity("full_stroke", "mm", read="chain.full_stroke"),
        Quantity(
            "turning_points",
            told_in(chain.drive_unit)[0],
            read="path.turning_points",
            form=lambda points: " → ".join(map(number, points)),
        ),
    )
    return in_measure(schema[: None if chain.elements else -1], chain.measure)


def cell_schema(chain: Chain) -> Schema:
    """What is told of the cells of a chain: all that holds of an element, where it has any."""
    unlike = len({cell.mobility for cell in chain.cells}) > 1
    mobility = Quantity("mobility", head="mobility" if unlike else "", left=False)
    if not chain.elements:
        return *CELL, mobility
    band = "±" if any(element.error_band for element in chain.elements) else ""
    sheets = "sheets" if _folds(chain) else ""
    schema = (
        Quantity("name", head="cell"),
        Quantity("phases", head="phases", read=lambda cell: len(cell.phases), left=False),
        Quantity("sheets", head=sheets, read=_sheets, left=False),
        Quantity("force_up", "N", "up at", lambda cell: [p.force_high for p in cell.phases[:-1]]),
        Quantity("force_down", "N", "down at", lambda cell: [p.force_low for p in cell.phases[1:]]),
        Quantity("travel_low", "mm", "from", "low"),
        Quantity("travel_high", "mm", "to", "high"),
        Quantity("full_travel", "mm"),
        Quantity("stopped", head="stops", form=lambda ends: _ENDS[*ends]),
        mobility,
        Quantity("error_band", "N", band, lambda cell: getattr(cell, "error_band", 0.0)),
        Quantity("bistable", read="is_bistable"),
        Quantity("stable", head="stable in", read=_stable, left=True),
    )
    return in_measure(schema, chain.measure)


def _folds(chain: Chain) -> bool:
    return any(len(element.laws) > 1 for element in chain.elements)


def _sheets(cell: Cell | Element) -> int:
    return len(cell.laws) if isinstance(cell, Element) else 1


def _stable(cell: Cell | Element) -> list[int]:
    """The phases in which a cell can stand without any force."""
    return [k for k, one in enumerate(cell.phases) if one.force_low < 0.0 < one.force_high]


def cell_records(chain: Chain) -> list[dict[str, Any]]:
    """The cells of a chain; those with levers among elements are told as both."""
    schema = cell_schema(chain)
    return [
        record(schema, cell, name=name)
        | (record(CELL, cell, name=name) if isinstance(cell, Cell) else {})
        for cell, name in zip(chain.cells, chain.names, strict=True)
    ]


def event_schema(chain: Chain) -> Schema:
    """What is told of a switch or a snap of a chain."""
    schema = (
        Quantity("kind", head="event"),
        Quantity("cause"),
        Quantity("direction", head="while", read=lambda event: _way(event.direction)),
        Quantity("drive", told_in(chain.drive_unit)[0]),
        Quantity("stroke", "mm", "stroke"),
        Quantity("cells"),
        Quantity("before", "mm"),
        Quantity("after", "mm"),
        *((Quantity("sheets_before"), Quantity("sheets_after")) if _folds(chain) else ()),
        Quantity("force_before", "N", "force before"),
        Quantity("force_after", "N", "force after"),
        Quantity("released", "mJ", "released"),
        Quantity(
            "arrivals",
            read=lambda event: [{"cell": cell, "state": state} for cell, state in event.arrivals],
        ),
        Quantity("tie"),
        Quantity("distance_force", "N"),
        Quantity("distance_travel", "mm"),
        Quantity("error", "mm"),
        Quantity("decided"),
    )
    return in_measure(schema, chain.measure)


def change_schema(unit: str) -> Schema:
    """What is told of a change of one thing; `unit` is that of the thing."""
    return (
        Quantity("cell"),
        Quantity("parameter", head="what"),
        Quantity("method"),
        Quantity("distance", unit),
        Quantity("move", unit),
        Quantity("becomes", head="sequence past it"),
    )


def run_record(
    cycle: Cycle,
    margin: Margin | None,
    landings: Sequence[Landing] | None = None,
    *,
    design: str | None = None,
) -> dict[str, Any]:
    """What a design does, as docs/commands.md describes it.

    Args:
        margin: how far the design is from doing something else; None where that is not known.
        landings: what `Path.landings` says of its snaps; None asks it where cells are few.
    """
    chain = cycle.chain
    landings = checked(cycle.path) if landings is None else landings
    spelled = len(chain) <= LONGEST_SPELLED_OUT
    return {
        **head("run/1", design or chain),
        "title": chain.title,
        "actuator": actuator_record(chain),
        "cells": cell_records(chain),
        "sequence": str(cycle.sequence) if spelled else None,
        "pathway": plain(cycle.pathway),
        "loading_order": list(cycle.loading_order),
        "unloading_order": list(cycle.unloading_order),
        "events": event_records(cycle.events, chain),
        "landings": landing_records(landings, cycle.events, chain),
        **record(cycle_schema(chain), cycle),
        "margin": margin and record(MARGIN, margin) | {"changes": margin_changes(margin)},
        "ties": tie_notes(cycle.degenerate, chain),
    }


def event_records(events: Iterable[Event], chain: Chain) -> list[dict[str, Any]]:
    """The switches and snaps of a chain."""
    schema = event_schema(chain)
    return [record(schema, event) for event in events]


def actuator_record(chain: Chain) -> dict[str, Any]:
    """What the actuator of a chain prescribes, and its stiffness."""
    stiffness = chain.actuator_stiffness
    control = "stroke" if math.isinf(stiffness) else "spring" if stiffness else "force"
    (told,) = in_measure([Quantity("stiffness", "N/m", read="actuator_stiffness")], chain.measure)
    return {"control": control, **record([told], chain)}


def margin_changes(margin: Margin) -> list[dict[str, Any]]:
    """The changes that a margin tells of, each with what the design becomes past it."""
    becoming = len(margin.chain) <= LONGEST_BECOMING
    return [_change(one, becoming) for one in margin.changes]


def _change(change: Change, becoming: bool) -> dict[str, Any]:
    schema = change_schema("mm" if isinstance(change.move, tuple) else "percent")
    return record(schema, change, becomes=change.becomes or None if becoming else None)


def event_columns(chain: Chain, *, page: bool = False) -> Columns:
    """The columns of a table of events.

    Args:
        chain: whose events they are.
        page: one with room for both forces and for the cause.
    """
    names, measure = chain.names, chain.measure
    schema = {q.attribute: q for q in event_schema(chain)}
    here, there = schema["before"], schema["after"]
    before_, after_, lost = (schema[key] for key in ("force_before", "force_after", "released"))

    def moves(event: Any) -> str:
        if event["kind"] == "switch":
            return ", ".join(f"{names[a['cell']]} at {a['state']}" for a in event["arrivals"])
        rows = zip(event["cells"], event[here.key], event[there.key], strict=True)
        # Lever cells tell by their travels where they arrive.
        to = {a["cell"]: f" at {a['state']}" for a in event["arrivals"] if chain.elements}
        return ", ".join(
            f"{names[cell]} {number(a)} → {number(b)}{to.get(cell, '')}" for cell, a, b in rows
        )

    def force(event: Any) -> str:
        before, after = before_.cell(event), after_.cell(event)
        return f"{before} → {after}" if event["kind"] == "snap" else before

    released = Column(
        lost.heading, lambda event: lost.cell(event) if event["kind"] == "snap" else "", True
    )
    forces = (
        (before_, after_) if page else (Column(f"{measure.force} [{before_.sign}]", force, True),)
    )
    cause = Column("cause", lambda event: Cause[event["cause"].upper()].value)
    return (
        schema["direction"],
        schema["kind"],
        schema["stroke"],
        Column(f"cells [{here.sign} of {measure.travel}]", moves),
        *forces,
        released,
        *([cause] if page else []),
    )


def elsewhere_of(chain: Chain) -> Columns:
    """The columns of a table of other places where snaps of a chain land."""
    return elsewhere_columns(chain, event_schema(chain))


def nearest_changes(chain: Chain, changes: list[dict[str, Any]]) -> dict[str, str]:
    """The smallest change of each kind of thing in words, where there is one."""
    measure = chain.measure
    kinds = {
        "anchor": "mm of an anchor",
        "stiffness": "% of a stiffness",
        "force_scale": f"% in {measure.force}",
        "travel_scale": f"% in {measure.travel}",
        "friction": "% in friction",
    }
    found: dict[str, str] = {}
    for kind, told in kinds.items():
        unit = "mm" if kind == "anchor" else "percent"
        of_kind = (change[f"distance_{unit}"] for change in changes if change["parameter"] == kind)
        known = [distance for distance in of_kind if distance is not None]
        if known:
            found[kind] = f"{number(min(known))} {told}"
    return found


def change_columns(chain: Chain, changes: list[dict[str, Any]]) -> Columns:
    """The columns of a table of changes; where a change leads is not known of long chains."""
    names, measure = chain.names, chain.measure
    changed = {
        "stiffness": "k",
        "force_scale": f"{measure.force}s",
        "travel_scale": f"{measure.travel}s",
    }

    def far(change: Any) -> str:
        if change.get("distance_mm") is not None:
            return f"{number(change['distance_mm'])} mm"
        if change.get("distance_percent") is not None:
            return f"{number(change['distance_percent'])} %"
        return "none within reach" if "distance_mm" in change else "none"

    def way(change: Any) -> str:
        if change.get("distance_mm") is not None:
            x, y = map(signed, change["move_mm"])
            return f"q by ({x}, {y}) mm"
        if change.get("distance_percent") is not None:
            by = f"by {signed(change['move_percent'])} %"
            if change["parameter"] == "friction":
                return f"{by} of the largest {measure.force}"
            return f"{changed[change['parameter']]} {by}"
        return ""

    _, what, *_, past = change_schema("")
    return (
        Quantity("cell", head="cell", form=lambda cell: names[cell]),
        what,
        Column("how far", far, True),
        Column("which way", way),
        *([past] if any(change["becomes"] for change in changes) else []),
    )


def drive_schema(unit: str) -> Schema:
    """What is told of the drives of a program; `unit` is that in which they are."""
    return (
        Quantity("turning_points", unit),
        Quantity("end_low", unit, read="low"),
        Quantity("end_high", unit, read="high"),
        Quantity("slack", unit),
    )


def program_record(
    program: Program,
    landings: Sequence[Landing] | None = None,
    *,
    design: str | None = None,
) -> dict[str, Any]:
    """A program that was found, as docs/commands.md describes it; `landings` as of a run."""
    path, chain = program.path, program.chain
    landings = checked(path) if landings is None else landings
    unit, _ = told_in(chain.drive_unit)
    points, *ends = drive_schema(unit)
    return {
        **_head(chain, program.start, program.to, design),
        "arrives": program.arrives,
        "does_it": program.arrives == program.to and program.hangs is None,
        "proved": program.shortest,
        "robust": program.robust,
        "reason": program.reason,
        "strokes": program.strokes,
        **record([points], program),
        "sequence": str(program.sequence) if len(chain) <= LONGEST_SPELLED_OUT else None,
        "events": event_records(path.events, chain),
        "landings": landing_records(landings, path.events, chain),
        **record([Quantity("dissipated", "mJ")], path),
        "turns": [record(turn_schema(unit), turn) for turn in program.turns],
        **record(ends, program),
    }


def unreachable_record(
    chain: Chain,
    start: str | None,
    to: str | None,
    why: Unreachable,
    *,
    robust: float | None = None,
    design: str | None = None,
) -> dict[str, Any]:
    """That no program does it, as docs/commands.md describes it.

    Args:
        start, to: the states between which there is no way.
        robust: as it was asked of `Chain.program`.
    """
    return {
        **_head(chain, start, to, design),
        "arrives": None,
        "does_it": False,
        "proved": why.proved,
        "robust": robust,
        "reason": str(why),
    }


def _head(chain: Chain, start: str | None, to: str | None, design: str | None) -> dict[str, Any]:
    return {
        **head("program/1", design or chain),
        "title": chain.title,
        "actuator": actuator_record(chain),
        "cells": list(chain.names),
        "from": start or chain.first_state,
        "to": to,
    }
