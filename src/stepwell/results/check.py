"""A verdict on a design as plain numbers with the unit in every name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stepwell.base import Measure, Quantity, Schema, in_measure, number, percent, record, signed
from stepwell.mechanism import Chain
from stepwell.results.design import COUNTED
from stepwell.results.head import head, tie_notes
from stepwell.results.run import LONGEST_BECOMING, change_schema

if TYPE_CHECKING:
    from stepwell.design import Change, Check, Measurement

_GRAM_FORCE = 9.80665e-3  # N
# What a measurement is of, in words, and the unit of its tolerance.
_MEASURED = {
    "d": ("anchors", "mm"),
    "stiffness": ("stiffness", "percent"),
    "rest_length": ("rest length", "percent"),
    "lever": ("lever", "mm"),
    "friction": ("friction", "N"),
    "force_scale": ("{force}s", "percent"),
    "travel_scale": ("{travel}s", "percent"),
}
CHECK: Schema = (
    Quantity("verdict", read=lambda found: str(found.verdict)),
    Quantity("reason"),
    Quantity("wanted"),
    Quantity("does"),
    Quantity("does_it"),
)


def pull_schema(chain: Chain) -> Schema:
    """What is told of the actuator's force and of the energy lost."""
    schema = (
        Quantity("peak_force", "N"),
        Quantity("dissipated", "mJ"),
    )
    return in_measure(schema, chain.measure)


def check_record(
    found: Check, *, design: str | None = None, calibrated: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """A verdict on a design, as docs/commands.md describes it.

    Args:
        found: the verdict.
        design: the text of the design file.
        calibrated: what is told of the recordings that were folded in; None for none.

    Returns:
        Plain numbers and texts.
    """
    chain = found.chain
    grams = abs(found.peak_force) / _GRAM_FORCE if chain.measure is Measure.TRAVEL else None
    return {
        **head("stepwell.check/1", design or chain, found.yield_.seed),
        "title": chain.title,
        "cells": list(chain.names),
        **record(CHECK, found),
        **record(COUNTED, found.yield_),
        "killer": None if found.killer is None else _killer(found, found.killer),
        **record(pull_schema(chain), found),
        "pull_g": grams,
        "oddities": list(found.oddities),
        "measure": None if found.measure is None else _measure(chain, found.measure),
        "ties": tie_notes(found.path.degenerate, chain),
        "calibrated": None if calibrated is None else dict(calibrated),
        "assumptions": found.yield_.assumptions,
    }


def _killer(found: Check, killer: Change) -> dict[str, Any]:
    # Past a program's killer it is the state at its end that is another one.
    told = ">" in found.wanted and len(found.chain) <= LONGEST_BECOMING
    schema = change_schema("mm" if isinstance(killer.move, tuple) else "percent")
    return record(schema, killer, becomes=killer.becomes or None if told else None)


def _measure(chain: Chain, found: Measurement) -> dict[str, Any]:
    _, unit = _MEASURED[found.what]
    schema = (
        Quantity("cell"),
        Quantity("what"),
        Quantity("now", unit),
        Quantity("then", unit),
        Quantity("share_before", read="before"),
        Quantity("share_after", read="after"),
    )
    return record(in_measure(schema, chain.measure), found)


def verdict_words(told: dict[str, Any]) -> str:
    """The verdict of a record and its reason, in a sentence."""
    return f"{told['verdict']}: {told['reason']}"


def pull_words(told: dict[str, Any], chain: Chain) -> str:
    """The largest force of the actuator in a record, in grams too where it is a force."""
    peak, lost = pull_schema(chain)
    grams = "" if told["pull_g"] is None else f" ({number(told['pull_g'], 3)} g)"
    return (
        f"{number(abs(told[peak.key]), 3)} {peak.sign}{grams} at most; "
        f"{number(told[lost.key], 3)} {lost.sign} lost on the way"
    )


def killer_words(told: dict[str, Any], chain: Chain) -> str:
    """What breaks a design most easily, of its record."""
    killer = told["killer"]
    if killer is None:
        return "" if not told["does_it"] else "no single change within reach breaks it"
    name, part = chain.names[killer["cell"]], killer["parameter"]
    measure = chain.measure
    if part == "anchor":
        far, how = killer["distance_mm"], _sides(*killer["move_mm"])
        what = f"anchor q of {name} {number(far, 3)} mm {how}"
    else:
        far = killer["distance_percent"]
        change = f"{signed(_short(killer['move_percent']))} %"
        words = {"stiffness": "stiffness", "friction": "friction"}
        words |= {"force_scale": f"{measure.force}s", "travel_scale": f"{measure.travel}s"}
        of = f" of its largest {measure.force}" * (part == "friction")
        what = f"{name}'s {words[part]}: {change}{of}"
    if far * (1.0 if part == "anchor" else 10.0) < 1e-6:
        return "any change at all decides what it does"
    then = f": then {killer['becomes']}" if killer["becomes"] else ""
    return f"{what} breaks it{then}"


def _short(value: float) -> float:
    return float(f"{value:.3g}")


def _sides(x: float, y: float) -> str:
    """Where an anchor goes, (x, y) [mm], as it is seen on a drawing."""
    size = max(abs(x), abs(y))
    told = [
        (x, "to the right" if x > 0 else "to the left"),
        (y, "up" if y > 0 else "down"),
    ]
    kept = [(abs(v), way) for v, way in told if abs(v) > 0.02 * size]
    if len(kept) == 1:
        return kept[0][1]
    return "(" + " and ".join(f"{number(v, 3)} {way}" for v, way in kept) + ")"


def measure_words(told: dict[str, Any], chain: Chain) -> str:
    """Which measurement makes a design surest, of its record; "" where none does."""
    found = told["measure"]
    if found is None:
        return ""
    what, unit = _MEASURED[found["what"]]
    (then,) = in_measure([Quantity("then", unit)], chain.measure)
    part = what.format(force=chain.measure.force, travel=chain.measure.travel)
    before, after = (percent(found[f"share_{when}"]) for when in ("before", "after"))
    return (
        f"the {part} of {chain.names[found['cell']]} to ±{number(found[then.key], 3)} "
        f"{then.sign}, and make it as drawn: {before} become {after}"
    )
