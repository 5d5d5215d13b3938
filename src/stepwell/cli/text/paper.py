"""The result of `stepwell paper` as people read it."""

from __future__ import annotations

from typing import Any

from stepwell.cli.screen import show_lines, show_table


def show(record: dict[str, Any]) -> None:
    """Print what `stepwell.paper.record` returns."""
    claims = record["claims"]
    show_table(
        "What the paper claims, and what Stepwell computes",
        ["claim", "where", "paper", "ours", "verdict"],
        [
            [
                claim["id"],
                claim["where"],
                claim["paper"],
                claim["ours"],
                claim["verdict"],
            ]
            for claim in claims
        ],
        left=(0, 1, 2, 3, 4),
    )
    reasons = [f"{claim['id']}: {claim['reason']}" for claim in claims if claim["reason"]]
    if reasons:
        show_lines("", *reasons)
    agreed = sum(claim["verdict"] == "agrees" for claim in claims)
    show_lines("", f"{agreed} of {len(claims)} claims agree.")
