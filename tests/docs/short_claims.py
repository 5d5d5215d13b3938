"""The README's short form of the claims: `python tests/docs/short_claims.py` writes it.

It is made of docs/claims.json alone, which `python -m stepwell.paper docs/claims.json` computes.
"""

import json
from pathlib import Path
from typing import Any

from stepwell.paper.claims.table import replaced as between

ROOT = Path(__file__).resolve().parents[2]
BEGIN = "<!-- short claims: written by `python tests/docs/short_claims.py`, not by hand -->"
END = "<!-- end of short claims -->"

# One of each kind of claim that agrees; those that differ or stay undetermined are all shown.
SHOWN = (
    "force-20-0",
    "bistable",
    "order-two-cells",
    "order-many-cells",
    "undirected-boundary",
    "share-clockwise",
    "robot-forward",
    "robot-turn",
)


def short(record: dict[str, Any]) -> str:
    """The table, and how many claims there are of each verdict."""
    claims = record["claims"]
    count = {
        verdict: sum(c["verdict"] == verdict for c in claims)
        for verdict in ("agrees", "differs", "undetermined", "needs data")
    }
    lines = [
        f"`make paper` computes {len(claims)} claims of the paper about cells, pairs and the robot "
        f"anew: {count['agrees']} agree, {count['differs']} differ, {count['undetermined']} hang "
        f"on what the paper does not say, and {count['needs data']} need data that is not part of "
        f"Stepwell ([how they come out](docs/measured.md)). Some of the first and all of the "
        f"second and third:",
        "",
        "| Claim | Paper | Stepwell | Verdict |",
        "|---|---|---|---|",
    ]
    for claim in claims:
        if claim["id"] in SHOWN or claim["verdict"] in ("differs", "undetermined"):
            row = (claim[key].replace("|", "\\|") for key in ("claim", "paper", "ours"))
            lines.append(f"| {' | '.join(row)} | {claim['verdict']} |")
    lines += ["", "[All of them](docs/claims.md), with tolerances and the reasons."]
    return "\n".join(lines)


def replaced(page: str, table: str) -> str:
    """The page with its short claims written anew."""
    return between(page, table, BEGIN, END)


if __name__ == "__main__":
    readme = ROOT / "README.md"
    table = short(json.loads((ROOT / "docs" / "claims.json").read_text("utf-8")))
    readme.write_text(replaced(readme.read_text("utf-8"), table), "utf-8")
