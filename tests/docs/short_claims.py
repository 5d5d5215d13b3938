"""The README's sentence on the claims: `python tests/docs/short_claims.py` writes it.

It is made of docs/claims.json alone, which `python tests/docs/claims_pages.py` computes.
"""

import json
from pathlib import Path
from typing import Any

from stepwell.paper.claims import replaced as between

ROOT = Path(__file__).resolve().parents[2]
BEGIN = "<!-- count of claims: written by `python tests/docs/short_claims.py`, not by hand -->"
END = "<!-- end of count -->"


def short(record: dict[str, Any]) -> str:
    """How many claims there are of each verdict."""
    claims = record["claims"]
    count = {
        verdict: sum(c["verdict"] == verdict for c in claims)
        for verdict in ("agrees", "differs", "undetermined", "needs data")
    }
    assert sum(count.values()) == len(claims)
    return (
        f"`make paper` recomputes {len(claims)} claims of the paper: {count['agrees']} agree, "
        f"{count['differs']} differ, {count['undetermined']} cannot be decided from the paper, "
        f"and {count['needs data']} need recordings that are not part of Stepwell. "
        f"[List of claims](docs/claims.md), with tolerances and reasons; "
        f"[results with the recordings](docs/measured.md)."
    )


def replaced(page: str, sentence: str) -> str:
    """The page with its sentence replaced."""
    return between(page, sentence, BEGIN, END)


if __name__ == "__main__":
    readme = ROOT / "README.md"
    sentence = short(json.loads((ROOT / "docs" / "claims.json").read_text("utf-8")))
    readme.write_text(replaced(readme.read_text("utf-8"), sentence), "utf-8")
