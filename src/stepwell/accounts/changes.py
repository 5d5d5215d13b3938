"""The smallest changes after which a chain has another sequence."""

import math
from typing import Any

from stepwell import base
from stepwell.accounts.head import About, DesignShape, keys
from stepwell.accounts.parts import CARD, Account, Part, RecordTable
from stepwell.design import LONGEST_FOLLOWED, Change, Margin

# A displacement [m] and a fraction of this size are no change.
_NO_MOVE, _NO_CHANGE = 1e-9, 1e-11
_KINDS = "anchor", "stiffness", "force_scale", "travel_scale", "friction"


def change_schema(shape: DesignShape) -> base.Schema:
    """A change of an anchor in mm, or of a number in percent; the other unit has null."""
    anchors = (
        base.Quantity("distance", "mm", read=_of("distance", True)),
        base.Quantity("move", "mm", read=_of("move", True), holds=[float], missing=True),
    )
    return (
        base.Quantity("cell", holds=int),
        base.Quantity("parameter", head="what"),
        base.Quantity("method"),
        *(anchors if shape.levers else ()),
        base.Quantity("distance", "percent", read=_of("distance", False)),
        base.Quantity("move", "percent", read=_of("move", False)),
        base.Quantity("becomes", head="sequence past it", read=_becomes, missing=True),
    )


def _of(name: str, anchor: bool) -> Any:
    return lambda change: getattr(change, name) if _of_anchor(change) is anchor else None


def _of_anchor(change: Change) -> bool:
    return change.parameter == "anchor"


def _becomes(change: Change) -> str | None:
    # It takes a cycle: of longer chains the distances alone are reported.
    return change.becomes or None if len(change.chain) <= LONGEST_FOLLOWED else None


def change_words(change: Change) -> str:
    """A change of a cell, and the sequence past it; how far an anchor moves is in brackets."""
    anchor = _of_anchor(change)
    if change.distance < (_NO_MOVE if anchor else _NO_CHANGE):
        return "any change at all decides the sequence"
    becomes, far = _becomes(change), f" ({_distance(change)})" if anchor else ""
    moved = _moved(change, f" of {change.chain.names[change.cell]}")
    return f"{moved}{far}" + (f", then {becomes}" if becomes else "")


def _moved(change: Change, of: str = "") -> str:
    """What is changed, `of` which cell, and by how much; the latter only where it is finite."""
    measure = change.chain.measure
    part = f"{part_words(change.parameter, measure)}{of}"
    if not math.isfinite(change.distance):
        return part
    if isinstance(change.move, tuple):
        x, y = (base.signed(base.to_unit(v, "mm")) for v in change.move)
        return f"{part} by ({x}, {y}) mm"
    return f"{part} by {base.signed(change.move * 100)} %{_of_largest(change)}"


def _of_largest(change: Change) -> str:
    is_friction = change.parameter == "friction"
    return f" of the largest {change.chain.measure.force}" if is_friction else ""


def part_words(part: str, measure: base.Measure) -> str:
    """The part of a cell that is changed or measured, in a word or two."""
    scales = {"force_scale": f"{measure.force}s", "travel_scale": f"{measure.travel}s"}
    names = {"anchor": "anchor q", "d": "anchors", "rest_length": "rest length", **scales}
    return names.get(part, part)


def _distance(change: Change) -> str:
    if not math.isfinite(change.distance):
        return "none within reach" if _of_anchor(change) else "none"
    if _of_anchor(change):
        return base.amount(change.distance, "m")
    return f"{base.number(change.distance * 100)} %"


def margin_schema(shape: DesignShape) -> base.Schema:
    """What is reported of a robustness margin."""
    return keys(method=str, reach="mm", gap="over_kr", changes=[change_schema(shape)])


def margin_words(margin: Margin) -> str:
    """The smallest change of each kind that gives another sequence."""
    measure, words = margin.chain.measure, []
    for kind in _KINDS:
        finite = [c for c in margin.changes if c.parameter == kind and math.isfinite(c.distance)]
        if finite:
            nearest = min(finite, key=lambda change: change.distance)
            part = f"{part_words(kind, measure)} of {margin.chain.names[nearest.cell]}"
            words.append(f"{_distance(nearest)}{_of_largest(nearest)} in {part}")
    if words:
        return f"{', '.join(words)} to another sequence ({margin.method})"
    if len(margin.chain.elements) == len(margin.chain):
        return "no other sequence by any change of one thing"
    return f"no other sequence within {base.amount(margin.reach, 'm')} of any anchor"


def margin_section(margin: Margin, *parts: Part) -> dict[str, tuple[Part, ...]]:
    """The smallest change of each thing as a table, the nearest first; `parts` stand above it."""
    chain, near = margin.chain, sorted(margin.changes, key=lambda change: change.distance)
    schema = change_schema(DesignShape.of(chain))
    searched = f"searched with the engine. {margin.resolution}"
    how = "exact: every change is in closed form" if margin.method == "exact" else searched
    about = f"The smallest change of one thing at a time that gives another sequence ({how})"
    if len(chain.elements) < len(chain):
        about += f"; anchors were moved by up to {base.amount(margin.reach, 'm')}"
    if math.isfinite(margin.gap):
        about += (
            f". The smallest gap between two F0 or two F1 is {base.number(margin.gap)} times k r "
            "of the innermost cell"
        )
    # The sequence past a change of a long chain is not computed.
    becomes = len(chain) <= LONGEST_FOLLOWED and any(change.becomes for change in near)
    columns = (
        base.Quantity("cell", head="cell", form=lambda cell: chain.names[cell]),
        base.Column("change", lambda row: _moved(row["change"])),
        base.Column("distance", lambda row: _distance(row["change"]), True),
        *(schema[-1:] if becomes else ()),
    )
    table = RecordTable(
        columns,
        lambda: [base.record(schema, change) | {"change": change} for change in near],
        f"{about}.",
        more="changes",
        level=CARD,
    )
    return {"Margin: the smallest change of one thing that gives another sequence": (*parts, table)}


def margin_account(margin: Margin, about: About) -> Account:
    """What a notebook shows of a margin."""
    method = "Every change is in closed form." if margin.method == "exact" else margin.resolution
    answer, sections = margin_words(margin), margin_section(margin)
    return Account(margin, "Robustness margin", "margin/1", answer, (), sections, origin=method)
