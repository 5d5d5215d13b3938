"""What is told of a build: names, units, headings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from stepwell.base import Quantity, Schema, __version__, percent, record, told_in, versions
from stepwell.lab.as_built.rebuilt import AsBuilt, Known

KNOWN: Schema = (
    Quantity("parameter", head="number"),
    Quantity("drawn", head="drawn", left=False),
    Quantity("value", head="as built", left=False),
    Quantity("doubt", head="±", left=False),
    Quantity("doubt_before", head="± before", left=False),
    Quantity("unit", head="unit"),
    Quantity("told", head="told by what was seen", form=lambda told: "yes" if told else "no"),
)
_PLACED: Schema = (
    Quantity("anchor", read="anchor.name"),
    Quantity("was", "mm"),
    Quantity("to", "mm"),
)
MOVE: Schema = (
    Quantity("move", head="move", read=str),
    *_PLACED,
    Quantity("also", read=lambda move: [record(_PLACED, step) for step in move.steps[1:]]),
    Quantity("share", head="share", form=percent, left=False),
)
WRONG: Schema = (
    Quantity("wrong", head="hole", read=str),
    *_PLACED,
    Quantity("share", head="share", form=percent, left=False),
)


def as_built_record(found: AsBuilt) -> dict[str, Any]:
    """A build as JSON can hold it; docs/commands.md describes the names."""
    seen = found.seen
    return {
        "schema": "stepwell.lab.as_built/1",
        "stepwell": __version__,
        "versions": versions(),
        "title": found.drawing.title,
        "advice": found.advice,
        "wanted": found.wanted,
        "share": found.share,
        "moves": [record(MOVE, move) for move in found.moves],
        "hole_mm": found.hole * 1e3,
        "wrong_hole": found.chance,
        "wrong_holes": [record(WRONG, one) for one in found.wrong],
        "seen": {
            "sequence": seen.sequence,
            "snaps_out_mm": _mm(seen.out),
            "snaps_back_mm": _mm(seen.back),
            "pulls": [
                {"direction": p.direction, "stroke_mm": p.stroke * 1e3, "force_N": p.force}
                for p in seen.pulls
            ],
            "ruler_mm": seen.ruler * 1e3,
            "scale_N": seen.scale,
        },
        "known": [_known(one) for one in found.known],
        "drawn": found.n,
        "seed": found.seed,
        "agreeing": found.agreeing,
        "wider": found.wider,
        "anchor_mm": found.tolerances.anchor * 1e3,
        "stiffness_percent": found.tolerances.stiffness * 1e2,
    }


def holes_told(told: Mapping[str, Any]) -> str:
    """What a record of a build says of its holes, in words."""
    if not told["wrong_hole"]:
        return "as drawn; wrong ones were not looked for"
    if not told["wrong_holes"]:
        return "as drawn, as far as was seen"
    each = [f"{one['wrong']} in {percent(one['share'])}" for one in told["wrong_holes"]]
    return f"{', '.join(each)} of the builds that would do this; p the other way does the same"


def _known(one: Known) -> dict[str, Any]:
    unit, factor = told_in(one.parameter.unit)
    numbers = {
        "drawn": one.drawn,
        "value": one.value,
        "doubt": one.doubt,
        "doubt_before": one.before,
    }
    return {
        "parameter": one.parameter.name,
        **{name: value * factor for name, value in numbers.items()},
        "unit": Quantity("", unit).sign,
        "told": one.told,
    }


def _mm(strokes: tuple[float, ...] | None) -> list[float] | None:
    return None if strokes is None else [u * 1e3 for u in strokes]
