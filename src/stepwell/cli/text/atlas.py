"""An atlas as people read it: what there is, how often, how sure, and what is proved."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from stepwell.base import Column, number
from stepwell.cli.screen import show_facts, show_records, show_text

# Rows of a table; --json has all.
_ROWS = 15


def atlas(record: dict[str, Any]) -> None:
    """Print what `results.atlas_record` returns."""
    facts = {
        "Space": f"{record['cells']} cells driven by {record['drive']}, "
        f"{len(record['space'])} numbers varied",
        "Designs": f"{record['designs']} drawn evenly, {record['told']} told in closed form",
        "Found": f"{record['graphs']} graphs, {len(record['cycles'])} cycles",
        "Proved": _proved(record),
        "Engine": f"the same graph for {record['agreed']} of {record['checked']} more designs",
    }
    if record["sampled"]["asked"]:
        facts["Others"] = _sampled(record)
    show_facts(record, facts, 8)
    _show_machines("Machines, most frequent first", record["machines"])
    _assumed(record)


def found(record: dict[str, Any]) -> None:
    """Print the machines of such a record that were asked for."""
    if not record["machines"]:
        show_text("No machine of this atlas does that.")
        return
    _show_machines("Machines that do that, highest yield first", record["machines"])
    _assumed(record)


def _assumed(record: dict[str, Any]) -> None:
    within = record["tolerances"]
    show_text(
        f"Back: the cells in the order in which they come back, numbered as they load. Yield: of "
        f"mechanisms built after the most robust design "
        f"that was drawn, within {number(within['anchor_mm'])} mm and "
        f"{number(within['stiffness_percent'])} % of stiffness, those with the same graph."
    )


def _proved(record: dict[str, Any]) -> str:
    if record["whole"]:
        return "no other graph occurs in this space, ties left aside"
    cells = "every design" if record["space_proved"] else "not every design"
    of = "" if record["possible"] is None else f"; at most {record['possible']} graphs can occur"
    return f"{cells} of the space has concave cells{of}"


def _sampled(record: dict[str, Any]) -> str:
    sampled = record["sampled"]
    known = {one["name"] for one in record["machines"]}
    others = sum(one["name"] not in known for one in sampled["graphs"])
    missed = record["designs"] - record["told"]
    return (
        f"{missed} designs; of a sample of {sampled['asked']} the engine finds "
        f"{len(sampled['graphs'])} graphs, {others} of them others"
    )


def _show_machines(title: str, machines: list[dict[str, Any]]) -> None:
    columns = [
        Column("name", lambda one: one["name"]),
        Column("back", _back),
        Column("share [%]", lambda one: number(one["share_percent"]), True),
        Column("yield [%]", lambda one: number(one["yield_percent"]), True),
        Column("reached", lambda one: f"{one['reached']} of {one['states']}", True),
        Column("memory", _memory),
    ]
    show_records(title, columns, machines[:_ROWS])
    if len(machines) > _ROWS:
        show_text(f"and {len(machines) - _ROWS} more: --json has all.")


def _back(one: Mapping[str, Any]) -> str:
    """The cells in the order in which they come back, numbered as they load."""
    states = one["cycle"].split(">")
    down = states[len(states) // 2 :]
    return " ".join(
        str(next(k for k in range(len(a)) if a[k] != b[k]) + 1) for a, b in pairwise(down)
    )


def _memory(one: Mapping[str, Any]) -> str:
    words = [] if one["remembers"] else ["forgets"]
    if one["scrambled"]:
        words.append("scrambles")
    counts = max(one["counts"], one["counts_by_hand"])
    if counts:
        words.append(f"counts to {counts}" + ("" if one["counts"] == counts else " by hand"))
    if one["latches"]:
        words.append("latches")
    return ", ".join(words)
