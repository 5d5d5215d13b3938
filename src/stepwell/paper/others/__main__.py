"""`python -m stepwell.paper.others FILE [PAGE.md …]`: transition graphs of pairs in series.

Writes the known designs for graphs of two hysterons into FILE, and their table into the pages.
"""

import json
import sys
from pathlib import Path
from typing import Any

from stepwell.base import write_atomic
from stepwell.paper.claims import replaced
from stepwell.paper.others import pairs

BEGIN = "<!-- pairs: written by `python -m stepwell.paper.others`, not by hand -->"
END = "<!-- end of pairs -->"
_HOW = ("ordinary curves", "one curve folds back", "both curves fold back")
_KEYS = ("travel_mm", "force_N")
_DIGITS = 4


def rows() -> list[dict[str, Any]]:
    """One row for every graph: how it is made, and by which curves."""
    alone = {pairs.canonical(pairs.graph_of(chain, "force")) for chain in pairs.pairs().values()}
    rows: list[dict[str, Any]] = []
    for graph in pairs.graphs():
        curves = pairs.design(graph)
        elements = [
            {key: [round(point[k], _DIGITS) for point in curve] for k, key in enumerate(_KEYS)}
            for curve in curves or ()
        ]
        rows.append(
            {
                "graph": " ".join(graph),
                "reached": " ".join(pairs.reached(graph)),
                "under_force": graph in alone,
                "under_length": _how(graph),
                "elements": elements,
            }
        )
    return rows


def _how(graph: pairs.Graph) -> str:
    chain = pairs.pairs().get(graph)
    if chain is not None and pairs.canonical(pairs.graph_of(chain)) == graph:
        return _HOW[pairs.folding(chain)]
    return "undecided" if pairs.possible(graph, plain=False) else "impossible"


def table(rows: list[dict[str, Any]]) -> str:
    """The graphs as a table in Markdown, avalanches in bold."""
    lines = ["| graph | states reached | under force | under length or behind a spring |"]
    lines += ["|---|---|---|---|"]
    for row in rows:
        arrows = " ".join(f"**{way}**" if len(way) > 4 else way for way in row["graph"].split())
        states = len({way[:2] for way in row["reached"].split()})
        alone = "made" if row["under_force"] else "impossible"
        lines.append(f"| {arrows} | {states} | {alone} | {row['under_length']} |")
    return "\n".join(lines)


def main(file: Path, pages: list[Path]) -> None:
    """Write the designs into the file, and their table into the pages."""
    texts = [page.read_text("utf-8") for page in pages]
    graph_rows = rows()
    written = [replaced(text, table(graph_rows), BEGIN, END, "table") for text in texts]
    lines = ",\n".join(map(json.dumps, graph_rows))
    write_atomic(file, f"[\n{lines}\n]\n")
    for page, text in zip(pages, written, strict=True):
        write_atomic(page, text)


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        raise SystemExit("usage: python -m stepwell.paper.others FILE [PAGE.md ...]")
    main(Path(sys.argv[1]), [Path(page) for page in sys.argv[2:]])
