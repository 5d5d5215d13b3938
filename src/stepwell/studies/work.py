"""What a study computes of every design: its columns, and the function that fills a row."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from stepwell.base import InputError, nearest_word
from stepwell.mechanism import Chain

Row = Mapping[str, Any]
TEXT = "text"


class Work(NamedTuple):
    """What is computed.

    Attributes:
        columns: unit of every column by its name; `TEXT` for words, "1" for ratios and counts.
        row: the values of one design, from the chain and a seed of its own.
    """

    columns: Mapping[str, str]
    row: Callable[[Chain, int], Row]


def work_of(what: str) -> Work:
    """What is computed under a name.

    Raises:
        ValueError: nothing is; the text says which name is nearest.
    """
    if what not in WORKS:
        raise InputError(f"what = {what!r}: must be one of {', '.join(WORKS)}.{_meant(what)}")
    return WORKS[what]


def _meant(what: str) -> str:
    near = nearest_word(what, WORKS)
    return f" Did you mean {near}?" if near else ""


def _cycle(chain: Chain, _seed: int) -> Row:
    from stepwell.sequences import cycle

    found = cycle(chain)
    return {
        "sequence": str(found.sequence),
        "snaps": len(found.snaps),
        "peak_force": found.peak_force,
        "dissipated": found.dissipated,
        "ties": len(found.degenerate),
    }


def _margin(chain: Chain, _seed: int) -> Row:
    from stepwell.design import margin
    from stepwell.sequences import cycle

    found = margin(chain)
    return {
        "sequence": str(cycle(chain).sequence),
        "anchor": float(found.anchors.min(initial=float("inf"))),
        "stiffness": float(found.stiffness.min(initial=float("inf"))),
    }


def _yield(chain: Chain, seed: int) -> Row:
    from stepwell.design import yields

    found = yields(chain, seed=seed)
    low, high = found.interval
    return {"sequence": found.wanted, "share": found.share, "share_low": low, "share_high": high}


def _graph(chain: Chain, _seed: int) -> Row:
    graph = chain.graph()
    return {"states": len(graph), "transitions": graph.number_of_edges()}


WORKS = {
    "cycle": Work(
        {"sequence": TEXT, "snaps": "1", "peak_force": "N", "dissipated": "J", "ties": "1"}, _cycle
    ),
    "margin": Work({"sequence": TEXT, "anchor": "m", "stiffness": "1"}, _margin),
    "yield": Work({"sequence": TEXT, "share": "1", "share_low": "1", "share_high": "1"}, _yield),
    "graph": Work({"states": "1", "transitions": "1"}, _graph),
}
