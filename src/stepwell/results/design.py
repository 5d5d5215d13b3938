"""Designs found, and how surely they work, as plain numbers with the unit in every name."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stepwell.accounts import head
from stepwell.base import Quantity, Schema, in_measure, number, record, rows_of, told_in
from stepwell.design import WAY
from stepwell.mechanism import Chain
from stepwell.results.run import CELL, actuator_record, cell_schema

if TYPE_CHECKING:
    from stepwell.design import (
        Design,
        Impossible,
        Reprogramming,
        Robustness,
        Survival,
        Tolerances,
        Yield,
    )

# The states of a longer chain are too many to be listed.
MOST_CELLS = 12


def _place(at: list[float]) -> str:
    return ", ".join(f"{round(v, 3) + 0.0:.6g}" for v in at)


# What has to be built; every cell has one band.
BUILT: Schema = (
    Quantity("name", head="cell"),
    Quantity("p", "mm", "p", lambda cell: cell.bands[0].p, _place),
    Quantity("q", "mm", "q", lambda cell: cell.bands[0].q, _place),
    Quantity("stiffness", "N/m", "k", lambda cell: cell.bands[0].stiffness),
    Quantity("rest_length", "mm", "l0", lambda cell: cell.bands[0].rest_length),
    Quantity("lever", "mm", "lever"),
    Quantity("limit", "deg"),
    *CELL[1:3],
)
COUNTED: Schema = (
    Quantity("share"),
    Quantity("share_low", read=lambda found: found.interval[0]),
    Quantity("share_high", read=lambda found: found.interval[1]),
    Quantity("samples", read="n"),
    Quantity("seed"),
    Quantity("successes"),
    Quantity(
        "tolerances", read=lambda found: record(tolerance_schema(found.chain), found.tolerances)
    ),
)


CRITICAL: Schema = (
    Quantity("first"),
    Quantity("second"),
    Quantity("while", read="way"),
    Quantity("share"),
    Quantity("narrowest"),
)
YIELD: Schema = (
    Quantity("wanted"),
    Quantity("wanted_states", read="states"),
    *COUNTED,
    Quantity(
        "outcomes",
        read=lambda found: [{"outcome": text, "count": n} for text, n in found.outcomes.items()],
    ),
    Quantity("critical", read=lambda found: _critical(found)),
    Quantity("by_engine"),
    Quantity("robust"),
    Quantity("proved"),
    Quantity("assumptions"),
    Quantity("gap_deviation", "N", read=lambda found: _of(found.sensitivities, "deviation")),
    Quantity("advice"),
    Quantity("gap_agreement", read=lambda found: _of(found.sensitivities, "agreed")),
    Quantity("sensitivities", read=lambda found: _sensitivities(found)),
)


def built_schema(chain: Chain) -> Schema:
    """What has to be built: bands and anchors, or elements and their scales."""
    if not chain.elements:
        return BUILT
    scales = (
        Quantity("force_scale", head="force scale", left=False),
        Quantity("travel_scale", head="travel scale", left=False),
    )
    return (*cell_schema(chain), *scales)


def tolerance_schema(chain: Chain) -> Schema:
    """What is told of the tolerances of a chain; each kind of cell has its own."""
    levers = len(chain.elements) < len(chain)
    of_levers = (
        Quantity("anchor", "mm", "anchors ±"),
        Quantity("stiffness", "percent", "stiffness ±"),
        Quantity("rest_length", "percent", "rest length ±"),
        Quantity("lever", "mm", "levers ±"),
    )
    schema = (
        *(of_levers if levers else [Quantity("stiffness", "percent", "force ±")]),
        Quantity("friction", "N", "friction up to "),
        *([Quantity("travel", "percent", "travel ±")] if chain.elements else ()),
        Quantity("mobility", head="mobilities as far apart as 1 to ", read=_apart),
    )
    return in_measure(schema, chain.measure)


def _apart(tolerances: Tolerances) -> float | None:
    return tolerances.mobility if tolerances.mobility > 1 else None


def _share(value: float) -> str:
    # An estimate may fall a little below zero.
    return f"{max(0.0, value):.2f}"


def tolerance_words(given: Tolerances | dict[str, float], chain: Chain) -> str:
    """The tolerances of a chain, themselves or their record, in words."""
    schema = tolerance_schema(chain)
    told = given if isinstance(given, dict) else record(schema, given)
    words = [f"{q.head}{number(told[q.key])} {q.sign}" for q in schema if told[q.key]]
    return ", ".join(words) or "no tolerance"


SENSITIVITY: Schema = (
    Quantity("part", head="part", read="parameters"),
    Quantity("first_order", head="alone", form=_share, left=False),
    Quantity("total", head="with others", form=_share, left=False),
)


def yield_record(
    found: Yield, *, design: str | None = None, calibrated: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """How many built mechanisms do what is wanted, as docs/commands.md describes it.

    Args:
        found: the share.
        design: the text of the design file.
        calibrated: what is told of the recordings that were folded in; None for none.

    Returns:
        Plain numbers and texts.
    """
    return {
        **_about("yield/1", found, design),
        **_yield(found),
        "calibrated": None if calibrated is None else dict(calibrated),
    }


def survival_record(
    found: Survival, *, design: str | None = None, calibrated: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """How many mechanisms a program brings where it should, as docs/commands.md describes it.

    Args:
        found: the share.
        design: the text of the design file.
        calibrated: what is told of the recordings that were folded in; None for none.

    Returns:
        Plain numbers and texts.
    """
    schema = (
        Quantity("from", read="start"),
        Quantity("to", read="ends"),
        Quantity("turning_points", told_in(found.chain.drive_unit)[0]),
        *COUNTED,
        Quantity("assumptions"),
    )
    return {
        **_about("survival/1", found, design),
        **record(schema, found),
        "calibrated": None if calibrated is None else dict(calibrated),
    }


def design_record(found: Design) -> dict[str, Any]:
    """A design that `design.design` found, as docs/commands.md describes it."""
    chain = found.chain
    return {
        **_head(chain, found.yield_.seed, proved=found.proved),
        "reason": found.method,
        "sequence": found.sequence,
        "loading_order": list(found.loading),
        "unloading_order": list(found.unloading),
        "state_count": found.reached.count,
        "states": list(found.states) if len(chain) <= MOST_CELLS else None,
        "states_whole": found.reached.whole,
        "states_how": found.reached.how,
        "actuator": actuator_record(chain),
        "cells": [
            record(built_schema(chain), cell, name=name)
            for cell, name in zip(chain.cells, chain.names, strict=True)
        ],
        **record([Quantity("holes", "mm"), Quantity("candidates")], found),
        "robustness": None if found.robustness is None else _robustness(found.robustness),
        "yield": _yield(found.yield_),
        "assumptions": found.assumptions,
    }


def impossible_record(why: Impossible) -> dict[str, Any]:
    """That nothing allowed does what is wanted, as `design.design` raised it."""
    gaps = Quantity("largest_gap", "N"), Quantity("gap_needed", "N")
    told = record(in_measure(gaps, why.measure), why)
    return {**_head(None, None, proved=why.proved), "reason": str(why), **told}


def reprogramming_schema(unit: str) -> Schema:
    """What is told of a reprogramming; `unit` is that of the anchor or the number."""
    return (
        Quantity("by"),
        Quantity("target"),
        Quantity("possible", read=lambda found: math.isfinite(found.distance)),
        Quantity("before"),
        Quantity("after", read=lambda found: found.after or None),
        Quantity("distance", unit),
        Quantity("displacement", unit),
        Quantity("place", unit),
        Quantity("reach", unit),
        Quantity("method"),
        Quantity("resolution"),
        Quantity("largest_force", "N", read="resistance.largest"),
        Quantity("work_at_0", "mJ", read="resistance.work_0"),
        Quantity("work_at_1", "mJ", read="resistance.work_1"),
    )


def reprogram_record(found: Reprogramming, *, design: str | None = None) -> dict[str, Any]:
    """The smallest displacement of an anchor that does it, as docs/commands.md describes it."""
    columns = record(WAY, found).values()
    unit = told_in(found.unit)[0]
    return {
        **head("reprogram/1", design or found.chain),
        "title": found.chain.title,
        **record(reprogramming_schema("" if unit == "1" else unit), found),
        "way": [
            {
                "fraction": part,
                "at_mm": [x + 0.0, y + 0.0],
                "force_at_0_N": force_0,
                "force_at_1_N": force_1,
                "largest_force_N": peak,
            }
            for part, x, y, force_0, force_1, peak in zip(*columns, strict=True)
        ],
    }


def _head(chain: Chain | None, seed: int | None, *, proved: bool) -> dict[str, Any]:
    return {
        **head("design/1", chain, seed),
        "title": "" if chain is None else chain.title,
        "possible": chain is not None,
        "proved": proved,
    }


def _robustness(found: Robustness) -> dict[str, Any]:
    meeting = found.meeting
    most = Quantity("radius", "mm") if math.isnan(found.share) else Quantity("share")
    return {
        **record([most, Quantity("limit")], found),
        "meet": meeting and [meeting.first, meeting.second],
        "while": meeting and meeting.way,
    }


def _about(schema: str, found: Yield | Survival, design: str | None) -> dict[str, Any]:
    chain = found.chain
    return {
        **head(schema, design or chain, found.seed),
        "title": chain.title,
        "cells": list(chain.names),
    }


def _yield(found: Yield) -> dict[str, Any]:
    return record(in_measure(YIELD, found.chain.measure), found)


def _critical(found: Yield) -> dict[str, Any] | None:
    """The neighbours that go wrong first; names tell the phases of a cell apart."""
    if found.critical is None:
        return None
    names = {"names": list(found.critical.names)} if found.chain.elements else {}
    return record(CRITICAL, found.critical) | names


def _of(table: Any, name: str) -> Any:
    return None if table is None else getattr(table, name)


def _sensitivities(found: Yield) -> list[dict[str, Any]] | None:
    if found.sensitivities is None:
        return None
    return rows_of(record(SENSITIVITY, found.sensitivities))
