"""The table of the presets' proofs, and the page that shows it: `python tests/docs/proofs.py`."""

from pathlib import Path

import stepwell as sw
from stepwell.mechanism import Chain

PAGE = Path(__file__).resolve().parents[2] / "docs" / "certificates.md"
_BEGIN, _END = "<!-- proofs of the presets -->\n", "<!-- end -->\n"


def table() -> str:
    """For each preset of a chain the enclosed events of its cycle, and what is not proved."""
    lines = ["| preset | enclosed events | its cycle |", "|---|---|---|"]
    for name in sw.presets():
        chain = sw.preset(name)
        if isinstance(chain, Chain):
            path = chain.cycle().path
            proof = path.prove()
            causes = "; ".join(dict.fromkeys(gap.cause for gap in proof.gaps))
            outcome = "proved" if proof.proved else f"not decided: {causes}"
            lines.append(f"| `{name}` | {len(proof.events)} of {len(path.events)} | {outcome} |")
    return "\n".join(lines) + "\n"


def shown() -> str:
    """The table as the page has it."""
    return PAGE.read_text("utf-8").split(_BEGIN)[1].split(_END)[0]


if __name__ == "__main__":
    text = PAGE.read_text("utf-8")
    head, rest = text.split(_BEGIN)
    PAGE.write_text(head + _BEGIN + table() + _END + rest.split(_END)[1], "utf-8")
