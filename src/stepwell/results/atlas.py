"""An atlas as plain numbers, with the unit in every name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from stepwell.accounts import head
from stepwell.base import Column, counted, number, told_in

if TYPE_CHECKING:
    from stepwell.design import Share
    from stepwell.mechanism import Chain
    from stepwell.studies import Atlas, Border, Cycling, Machine


def atlas_record(
    found: Atlas, machines: Sequence[Machine] | None = None, borders: Sequence[Border] = ()
) -> dict[str, Any]:
    """An atlas, as docs/commands.md describes it.

    Args:
        found: the atlas.
        machines: those of it that are told; all by default.
        borders: where one becomes another, as `atlas.borders` finds them.
    """
    shown = found.machines if machines is None else machines
    return {
        **head("atlas/1", found.chain, found.seed, "zarr"),
        "title": found.chain.title,
        "cells": len(found.chain),
        "drive": found.drive,
        "space": [_axis(found, axis.name, axis.low, axis.high) for axis in found.axes],
        "designs": found.designs,
        "told": found.told,
        "not_proved": found.not_proved,
        "ties": found.ties,
        "wakes": found.wakes,
        "tolerances": {
            "anchor_mm": found.tolerances.anchor * 1e3,
            "stiffness_percent": found.tolerances.stiffness * 100,
            "rest_length_percent": found.tolerances.rest_length * 100,
        },
        "graphs": len(found.machines),
        "possible": found.possible,
        "space_proved": found.space_proved,
        "whole": found.whole,
        "unseen_at_most_percent": None if found.unseen is None else found.unseen.high * 100,
        "checked": found.checked,
        "agreed": found.agreed,
        "sampled": {
            "asked": found.sampled.asked,
            "failed": found.sampled.failed,
            "graphs": [
                {"name": name, "designs": times} for name, times in found.sampled.machines.items()
            ],
        },
        "machines": [_machine(found, one) for one in shown],
        "cycles": [_cycling(found, one) for one in found.cycles],
        "borders": [_border(found, one) for one in borders],
    }


def _axis(found: Atlas, name: str, low: float, high: float) -> dict[str, Any]:
    unit, factor = _told(found, name)
    return {"parameter": name, "unit": unit or "1", "from": low * factor, "to": high * factor}


def _told(found: Atlas, name: str) -> tuple[str, float]:
    from stepwell.design import parameter

    unit = parameter(found.chain, name).unit
    return ("", 1.0) if unit == "1" else told_in(unit)


def _values(found: Atlas, chain: Chain) -> list[float]:
    """What the space varies, of one design of it, in the order and the units of `space`."""
    from stepwell.design import parameter

    return [
        float(parameter(chain, axis.name).value(chain)) * _told(found, axis.name)[1]  # type: ignore[arg-type]
        for axis in found.axes
    ]


def _share(name: str, share: Share) -> dict[str, float]:
    return {
        f"{name}_percent": share.share * 100,
        f"{name}_low_percent": share.low * 100,
        f"{name}_high_percent": share.high * 100,
    }


def _machine(found: Atlas, one: Machine) -> dict[str, Any]:
    return {
        "name": one.name,
        "cycle": one.cycle,
        "designs": one.share.times,
        **_share("share", one.share),
        **_share("yield", one.kept),
        "gap_percent": one.gap * 100,
        "design": one.design,
        "values": _values(found, one.chain),
        "agrees": one.agrees,
        "states": one.states,
        "reached": one.reached,
        "snaps": one.snaps,
        "sub_loops": one.sub_loops,
        "remembers": one.remembers,
        "scrambled": one.scrambled,
        "counts": one.counts,
        "counts_by_hand": one.counts_by_hand,
        "gardens": one.gardens,
        "latches": one.latches,
    }


def _border(found: Atlas, one: Border) -> dict[str, Any]:
    unit, factor = _told(found, one.parameter)
    return {
        "machine": one.machine,
        "parameter": one.parameter,
        "unit": unit or "1",
        "at": one.value * factor,
        "step": one.step * factor,
        "beyond": one.beyond,
    }


def _cycling(found: Atlas, one: Cycling) -> dict[str, Any]:
    return {
        "sequence": one.sequence,
        "designs": one.share.times,
        **_share("share", one.share),
        "gap_percent": one.gap * 100,
        "design": one.design,
        "values": _values(found, one.chain),
    }


def atlas_facts(record: Mapping[str, Any]) -> dict[str, str]:
    """What an atlas holds and how sure that is, of its record."""
    facts = {
        "Found": f"{counted(record['graphs'], 'graph')}, {counted(len(record['cycles']), 'cycle')}",
        "Proved": _proved(record),
        **({} if record["whole"] else {"Unseen": _unseen(record)}),
        "Space": f"{record['cells']} cells driven by {record['drive']}, "
        f"{len(record['space'])} numbers varied",
        "Designs": f"{record['designs']} drawn evenly, {record['told']} told in closed form",
        "Engine": f"the same graph for {record['agreed']} of {record['checked']} more designs",
    }
    if record["sampled"]["asked"]:
        facts["Others"] = _sampled(record)
    return facts


def atlas_assumed(record: Mapping[str, Any]) -> str:
    """What "back" and "yield" mean in its table."""
    within = record["tolerances"]
    return (
        f"Back: the cells in the order in which they come back, numbered as they load. Yield: of "
        f"mechanisms built after the most robust design "
        f"that was drawn, within {number(within['anchor_mm'])} mm and "
        f"{number(within['stiffness_percent'])} % of stiffness, those with the same graph."
    )


def _proved(record: Mapping[str, Any]) -> str:
    if record["whole"]:
        return "no other graph occurs in this space, ties left aside"
    cells = "every design" if record["space_proved"] else "not every design"
    of = "" if record["possible"] is None else f"; at most {record['possible']} graphs can occur"
    return f"{cells} of the space has concave cells{of}"


def _unseen(record: Mapping[str, Any]) -> str:
    most = record["unseen_at_most_percent"]
    if most is None:
        return "nothing is said of a single block of designs"
    return f"at most {number(most)} % of designs have another graph, at 95 %"


def _sampled(record: Mapping[str, Any]) -> str:
    sampled = record["sampled"]
    known = {one["name"] for one in record["machines"]}
    others = sum(one["name"] not in known for one in sampled["graphs"])
    missed = record["designs"] - record["told"]
    return (
        f"{missed} designs; of a sample of {sampled['asked']} the engine finds "
        f"{len(sampled['graphs'])} graphs, {others or 'none'} of them new"
    )


def _back(one: Mapping[str, Any]) -> str:
    """The cells in the order in which they come back, numbered as they load."""
    states = one["cycle"].split(">")
    down = states[len(states) // 2 :]
    return " ".join(
        str(next(k for k in range(len(a)) if a[k] != b[k]) + 1) for a, b in pairwise(down)
    )


def memory_words(one: Mapping[str, Any]) -> str:
    """What a machine of an atlas's record does with what was done to it before."""
    words = [] if one["remembers"] else ["forgets"]
    if one["scrambled"]:
        words.append("scrambles")
    counts = max(one["counts"], one["counts_by_hand"])
    if counts:
        words.append(f"counts to {counts}" + ("" if one["counts"] == counts else " by hand"))
    if one["latches"]:
        words.append("latches")
    return ", ".join(words)


# The table of an atlas's machines, a line each, from the `machines` of its record.
ATLAS_MACHINES = (
    Column("name", lambda one: one["name"]),
    Column("back", _back),
    Column("share [%]", lambda one: number(one["share_percent"]), True),
    Column("yield [%]", lambda one: number(one["yield_percent"]), True),
    Column("reached", lambda one: f"{one['reached']} of {one['states']}", True),
    Column("memory", memory_words),
)
