"""The tables of larger atlases in docs/atlas.md, from docs/atlases.json.

`python tests/docs/larger_atlases.py STORE...` reads stores that the commands on the page have made,
and writes both anew; without a store, the page alone.
"""

from __future__ import annotations

import json
import re
import shlex
import sys
from pathlib import Path
from typing import Any

from stepwell.base import counted, number
from stepwell.files import write_atomic
from stepwell.studies import Atlas, charted, find, opened

ROOT = Path(__file__).parents[2]
PAGE, FILE = ROOT / "docs" / "atlas.md", ROOT / "docs" / "atlases.json"
_BEGIN, _END = "<!-- larger: written by tests/docs/larger_atlases.py -->", "<!-- end -->"
# What is asked of all graph classes of an atlas, and how the page says it.
ASKED = {
    "reaches every state": "reach every state",
    "latches": "latch",
    "remembers": "remember where they turned",
    "scrambles": "scramble",
    "counts": "count, the actuator alone",
    "counts to 2 by hand": "count to two or more, set by hand",
    "counts to 3 by hand": "count to three or more, set by hand",
    "never snaps": "never snap",
}


def summary(store: str) -> dict[str, Any]:
    """What the page tells of a store."""
    study = opened(store)
    atlas = charted(study, checks=100)
    known = {one.name for one in atlas.graph_classes}
    return {
        "identity": study.identity,
        "cells": len(atlas.chain),
        "designs": atlas.designs,
        "closed_form": atlas.closed_form,
        "ties": atlas.ties,
        "wakes": atlas.wakes,
        "not_proved": atlas.not_proved,
        "graphs": len(atlas.graph_classes),
        "cycles": len(atlas.cycles),
        "whole": atlas.whole,
        "unseen_at_most_percent": None if atlas.unseen is None else atlas.unseen.high * 100,
        "checked": atlas.checked,
        "agreed": atlas.agreed,
        "classes_agree": sum(one.agrees for one in atlas.graph_classes),
        "sampled": {
            "asked": atlas.sampled.asked,
            "failed": atlas.sampled.failed,
            "others": sum(name not in known for name in atlas.sampled.graph_classes),
        },
        "sure": _share(atlas, [one for one in atlas.graph_classes if one.kept.low >= 0.99]),
        "does": {query: _share(atlas, find(atlas, query)) for query in ASKED},
    }


def _share(atlas: Atlas, graph_classes: Any) -> dict[str, float]:
    times = sum(one.fraction.times for one in graph_classes)
    return {"graphs": len(graph_classes), "designs_percent": 100 * times / atlas.closed_form}


def records() -> list[dict[str, Any]]:
    return json.loads(FILE.read_text("utf-8"))


def tables(found: list[dict[str, Any]]) -> str:
    """Both tables, as Markdown."""
    lines = [
        "| cells | designs | decided in closed form | graphs | cycles | another graph, at 95 % | "
        "of these the engine agrees on |",
        "|---|---|---|---|---|---|---|",
    ]
    for one in found:
        most = one["unseen_at_most_percent"]
        other = "proved: none" if one["whole"] else f"in at most one design of {100 / most:,.0f}"
        lines.append(
            f"| {one['cells']} | {one['designs']:,} | {one['closed_form']:,} | {one['graphs']} | "
            f"{one['cycles']} | {other} | {one['classes_agree']} of {one['graphs']} graph classes, "
            f"{one['agreed']} of {one['checked']} more designs |"
        )
    heads = " | ".join(f"{one['cells']} cells: graphs | of designs" for one in found)
    lines += ["", f"| graph classes that | {heads} |", "|---|" + "---|---|" * len(found)]
    rows = {"are built surely (99 %)": "sure", **{text: query for query, text in ASKED.items()}}
    for text, key in rows.items():
        shares = [one["sure"] if key == "sure" else one["does"][key] for one in found]
        told = " | ".join(f"{s['graphs']} | {number(s['designs_percent'])} %" for s in shares)
        lines.append(f"| {text} | {told} |")
    return "\n".join(lines)


def others(found: list[dict[str, Any]]) -> str:
    """What closed form did not tell."""
    parts = []
    for one in found:
        left = one["designs"] - one["closed_form"]
        if left:
            sampled = one["sampled"]
            new = counted(sampled["others"], "graph") if sampled["others"] else "no graph"
            parts.append(
                f"of {one['cells']} cells {left:,} designs, and of a sample of {sampled['asked']} "
                f"of these the engine finds {new} that the others have not"
            )
    return f"Not decided in closed form: {'; '.join(parts)}."


def written(text: str) -> str:
    """The page with its tables as they should be."""
    found = records()
    inside = f"{_BEGIN}\n\n{tables(found)}\n\n{others(found)}\n\n{_END}"
    return re.sub(f"{re.escape(_BEGIN)}.*?{_END}", lambda _: inside, text, flags=re.DOTALL)


def commands() -> list[list[str]]:
    """The words of the page's commands that begin them, in the order of the tables."""
    lines = re.findall(r"^stepwell (atlas build .*)$", PAGE.read_text("utf-8"), re.M)
    return [shlex.split(line) for line in lines if "larger" in line]


if __name__ == "__main__":
    if sys.argv[1:]:
        text = json.dumps([summary(store) for store in sys.argv[1:]], indent=1)
        write_atomic(FILE, text + "\n")
    PAGE.write_text(written(PAGE.read_text("utf-8")), "utf-8")
