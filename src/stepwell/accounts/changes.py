"""The smallest changes after which a chain does something else."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from stepwell import base, mechanism
from stepwell.accounts.head import About, Shape, keys, recorded
from stepwell.accounts.parts import CARD, Account, Part, RecordTable
from stepwell.base import Quantity
from stepwell.design import LONGEST_FOLLOWED, Change, Margin

# A displacement [m] and a fraction of this size are no change.
_NO_MOVE, _NO_CHANGE = 1e-9, 1e-11
# A longer sequence is not written in a sentence.
_MOST_LETTERS = 60


def change_schema(shape: Shape) -> base.Schema:
    """A change of an anchor in mm, or of a number in percent; the other unit has null."""
    anchors = (
        Quantity("distance", "mm", read=_of("distance", True)),
        Quantity("move", "mm", read=_of("move", True), holds=[float], missing=True),
    )
    return (
        Quantity("cell", holds=int),
        Quantity("parameter", head="what"),
        Quantity("method"),
        *(anchors if shape.levers else ()),
        Quantity("distance", "percent", read=_of("distance", False)),
        Quantity("move", "percent", read=_of("move", False)),
        Quantity("becomes", head="sequence past it", read=_becomes, missing=True),
    )


def _of(name: str, anchor: bool) -> Any:
    return lambda change: getattr(change, name) if _of_anchor(change) is anchor else None


def _of_anchor(change: Change) -> bool:
    return change.parameter == "anchor"


def _becomes(change: Change) -> str | None:
    # It takes a cycle: of longer chains the distances alone are reported.
    return change.becomes or None if len(change.chain) <= LONGEST_FOLLOWED else None


def _part(parameter: str, measure: base.Measure) -> str:
    """What of a cell is changed, in a word or two."""
    scales = {"force_scale": f"{measure.force}s", "travel_scale": f"{measure.travel}s"}
    return {"anchor": "anchor q", **scales}.get(parameter, parameter)


def critical_words(change: Change) -> str:
    """The change that breaks a design first, and what the design does past it."""
    chain, part = change.chain, change.parameter
    name, what = chain.names[change.cell], _part(part, chain.measure)
    if change.distance < (_NO_MOVE if _of_anchor(change) else _NO_CHANGE):
        return "any change at all decides what it does"
    if isinstance(change.move, tuple):
        far, way = base.amount(change.distance, "m", 3), _sides(*change.move)
        words = f"{what} of {name} {far} {way}"
    else:
        of = f" of its largest {chain.measure.force}" * (part == "friction")
        words = f"{name}'s {what}: {base.signed(float(f'{change.move * 1e2:.3g}'))} %{of}"
    becomes = _becomes(change)
    return f"{words} breaks it" + (f": then {becomes}" if becomes else "")


def _sides(x: float, y: float) -> str:
    """Where an anchor goes, (x, y) [m], as it is seen on a drawing."""
    size = max(abs(x), abs(y))
    ways = [(x, "to the right" if x > 0 else "to the left"), (y, "up" if y > 0 else "down")]
    kept = [(base.to_unit(abs(v), "mm"), way) for v, way in ways if abs(v) > 0.02 * size]
    if len(kept) == 1:
        return kept[0][1]
    return "(" + " and ".join(f"{base.number(v, 3)} {way}" for v, way in kept) + ")"


def margin_schema(shape: Shape) -> base.Schema:
    """What is reported of a robustness margin."""
    return keys(method=str, reach="mm", gap="over_kr", changes=[change_schema(shape)])


def margin_words(margin: Margin) -> str:
    """The smallest change of each kind that gives another sequence."""
    chain, measure = margin.chain, margin.chain.measure
    kinds = {
        "anchor": "mm of an anchor",
        "stiffness": "% of a stiffness",
        "force_scale": f"% in {measure.force}",
        "travel_scale": f"% in {measure.travel}",
        "friction": "% in friction",
    }
    found: list[str] = []
    for kind, text in kinds.items():
        distances = [one.distance for one in margin.changes if one.parameter == kind]
        least = min(distances, default=math.inf)
        if math.isfinite(least):
            unit = "mm" if kind == "anchor" else "percent"
            found.append(f"{base.number(base.to_unit(least, unit))} {text}")
    if found:
        near = " or ".join([*([", ".join(found[:-1])] if found[1:] else []), found[-1]])
        return f"{near} to another sequence ({margin.method})"
    if len(chain.elements) == len(chain):
        return "no other sequence by any change of one thing"
    return f"no other sequence within {base.amount(margin.reach, 'm')} of any anchor"


def margin_section(margin: Margin, *parts: Part) -> dict[str, tuple[Part, ...]]:
    """The smallest change of each thing as a table, the nearest first; `parts` stand above it."""
    shape = Shape.of(margin.chain)
    near = sorted(margin.changes, key=lambda change: change.distance)
    exact = margin.method == "exact"
    searched = f"searched with the engine. {margin.resolution}"
    how = "exact: every change is in closed form" if exact else searched
    reach = f"; anchors were moved by up to {base.amount(margin.reach, 'm')}" * shape.levers
    gap = (
        f" The smallest gap between two F0 or two F1 is {base.number(margin.gap)} times k r of the "
        f"innermost cell."
    ) * math.isfinite(margin.gap)
    about = (
        f"The smallest change of one thing at a time that gives another sequence ({how})"
        f"{reach}.{gap}"
    )
    rows = recorded(change_schema(shape), near)
    table = RecordTable(_columns(margin.chain, near), rows, about, more="changes", level=CARD)
    return {"Margin: the smallest change of one thing that gives another sequence": (*parts, table)}


def _columns(chain: mechanism.Chain, changes: Sequence[Change]) -> base.Columns:
    """The columns of a table of changes; where a change leads is not known of long chains."""
    names, measure = chain.names, chain.measure

    def far(change: Mapping[str, Any]) -> str:
        if change.get("distance_mm") is not None:
            return f"{base.number(change['distance_mm'])} mm"
        if change["distance_percent"] is not None:
            return f"{base.number(change['distance_percent'])} %"
        return "none within reach" if change["parameter"] == "anchor" else "none"

    def way(change: Mapping[str, Any]) -> str:
        if change.get("distance_mm") is not None:
            x, y = map(base.signed, change["move_mm"])
            return f"q by ({x}, {y}) mm"
        if change["distance_percent"] is None:
            return ""
        by, part = f"by {base.signed(change['move_percent'])} %", change["parameter"]
        if part == "friction":
            return f"{by} of the largest {measure.force}"
        return f"{'k' if part == 'stiffness' else _part(part, measure)} {by}"

    _, what, *_, past = change_schema(Shape.of(chain))
    becomes = len(chain) <= LONGEST_FOLLOWED and any(change.becomes for change in changes)
    return (
        Quantity("cell", head="cell", form=lambda cell: names[cell]),
        what,
        base.Column("how far", far, True),
        base.Column("which way", way),
        *([past] if becomes else []),
    )


def otherwise_words(margin: Margin, *, tied: bool = False) -> str:
    """The smallest changes after which a chain, which may be `tied` already, does another thing."""
    if tied and all(change.distance < _NO_MOVE for change in margin.changes):
        return "It stands between two sequences: any change at all decides which it takes."
    near = sorted(margin.changes, key=lambda change: change.distance)
    near = [change for change in near if math.isfinite(change.distance)]
    # An anchor and a number do not compare: the nearest of both is reported.
    kinds = {_of_anchor(change): change for change in reversed(near)}
    nearest = [kinds[kind] for kind in (True, False) if kind in kinds]
    if nearest:
        return f"It would go {', or '.join(map(_instead, nearest))}."
    anchors = any(_of_anchor(change) for change in margin.changes)
    reach = f" of an anchor within {base.amount(margin.reach, 'm')}, and none" * anchors
    return f"No change{reach} of one number alone makes it do anything else."


def _instead(change: Change) -> str:
    becomes = _becomes(change) or ""
    spelled = 0 < len(becomes) <= _MOST_LETTERS and "no answer" not in becomes
    return f"{becomes if spelled else 'another way'} if {_changed(change)}"


def _changed(change: Change) -> str:
    name = change.chain.names[change.cell]
    if isinstance(change.move, tuple):
        return f"the anchor q of {name} were moved by {base.amount(change.distance, 'm', 3)}"
    words = change.chain.measure
    share = f"{base.number(abs(change.move) * 100, 3)} %"
    if change.parameter == "friction":
        return f"{name} had friction of {share} of its largest {words.force} more"
    more = change.move > 0
    if change.parameter == "stiffness":
        return f"the bands of {name} were {share} {'stiffer' if more else 'softer'}"
    of = words.travel if change.parameter == "travel_scale" else words.force
    return f"all {of}s of {name} were {share} {'larger' if more else 'smaller'}"


def margin_account(margin: Margin, about: About) -> Account:
    """What a notebook shows of a margin."""
    method = "Every change is in closed form." if margin.method == "exact" else margin.resolution
    answer, sections = margin_words(margin), margin_section(margin)
    return Account(margin, "Robustness margin", origin=method, answer=answer, sections=sections)
