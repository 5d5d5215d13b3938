"""The tables of proofs, and the page that shows them: `python tests/docs/proofs.py [TABLE]`.

That of random chains shows the record that `benchmarks/random_proofs.py` writes.
"""

import json
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import stepwell as sw
from stepwell.base import percent
from stepwell.mechanism import Chain
from stepwell.paper import ClaimProof, claim_proofs
from stepwell.proof import BoxOutcome

PAGE = Path(__file__).resolve().parents[2] / "docs" / "certificates.md"
RECORD = PAGE.with_name("random-proofs.jsonl")
# Samples of each preset, of which the engine follows some one by one.
SAMPLES = 1000
_END = "<!-- end -->\n"


def chains() -> Iterator[tuple[str, Chain]]:
    """The presets of chains by name."""
    for name in sw.presets():
        chain = sw.preset(name)
        if isinstance(chain, Chain):
            yield name, chain


def table() -> str:
    """For each preset of a chain the enclosed events of its cycle, and what is not proved."""
    lines = ["| preset | enclosed events | its cycle |", "|---|---|---|"]
    for name, chain in chains():
        path = chain.cycle().path
        proof = path.prove()
        causes = "; ".join(dict.fromkeys(gap.cause for gap in proof.gaps))
        outcome = "proved" if proof.proved else f"not decided: {causes}"
        lines.append(f"| `{name}` | {len(proof.events)} of {len(path.events)} | {outcome} |")
    return "\n".join(lines) + "\n"


def box_row(name: str, chain: Chain) -> str:
    """What samples show of a preset within the default tolerances, and what is proved."""
    counted = chain.yields(samples=SAMPLES)
    proof = counted.prove()
    outcome = str(proof.outcome)
    if proof.counterexample is not None:
        outcome += f": {proof.cause}"
    elif not proof.proved:
        outcome += f" in {percent(proof.undecided or 0.0)} of the box: {proof.cause}"
    return f"| `{name}` | {percent(counted.fraction)} | {outcome} |"


def boxes() -> str:
    """`box_row` of each preset of a chain."""
    lines = ["| preset | yield by samples | all machines within the tolerances |", "|---|---|---|"]
    return "\n".join([*lines, *(box_row(*one) for one in chains())]) + "\n"


def margin_row(name: str, chain: Chain) -> str:
    """How many margins of a preset are proved, and what the others are."""
    proof = chain.margin().prove()
    done = sum(one.proved for one in proof.changes)
    rest: list[str] = []
    for outcome in (BoxOutcome.REFUTED, BoxOutcome.UNDECIDED):
        causes = dict.fromkeys(one.cause for one in proof.changes if one.outcome is outcome)
        rest += [f"{outcome}: {', '.join(causes)}"] * bool(causes)
    return f"| `{name}` | {done} of {len(proof.changes)} | {'; '.join(rest)} |"


def margins() -> str:
    """`margin_row` of each preset of a chain."""
    lines = ["| preset | margins proved | others |", "|---|---|---|"]
    return "\n".join([*lines, *(margin_row(*one) for one in chains())]) + "\n"


def claim_row(one: ClaimProof) -> str:
    """What is proved of a claim of the paper."""
    claim = one.claim.claim.replace("|", "\\|")
    return f"| {claim} | {one.outcome} | {one.statement} |"


def claims() -> str:
    """`claim_row` of each claim about cells, pairs and chains."""
    lines = ["| claim | outcome | what is proved, or why it is not |", "|---|---|---|"]
    return "\n".join([*lines, *map(claim_row, claim_proofs())]) + "\n"


def random_chains() -> str:
    """What is proved of the random chains of the record, by kind, and the causes of the rest."""
    rows = [json.loads(line) for line in RECORD.read_text("utf-8").splitlines()]
    kinds = [*dict.fromkeys(row["kind"] for row in rows), "all"]
    own = {k: [row for row in rows if k in ("all", row["kind"])] for k in kinds}
    lines = [
        "| cells | chains | proved | a tie | not proved | contradicted | wrong answers caught |"
    ]
    lines += ["|---|---|---|---|---|---|---|"]
    for kind, some in own.items():
        count = Counter(row["outcome"] for row in some)
        tried = [row["caught"] for row in some if "caught" in row]
        numbers = len(some) - count["no answer"], *(count[name] for name in OUTCOMES)
        columns = map(str, (kind, *numbers, f"{sum(tried)} of {len(tried)}"))
        lines.append(f"| {' | '.join(columns)} |")
    heads = " | ".join(kinds[:-1])
    lines += ["", f"| cause of the first gap | {heads} |", "|---|" + "---|" * (len(kinds) - 1)]
    causes = {
        k: Counter(row["cause"] for row in own[k] if row["outcome"] in OUTCOMES[1:]) for k in kinds
    }
    for cause, _ in causes["all"].most_common():
        lines.append(f"| {cause} | {' | '.join(str(causes[k][cause]) for k in kinds[:-1])} |")
    return "\n".join(lines) + "\n"


OUTCOMES = "proved", "tie", "not proved", "contradicted"
TABLES = {
    "presets": table,
    "machines": boxes,
    "margins": margins,
    "claims": claims,
    "random chains": random_chains,
}


def shown(name: str = "presets") -> str:
    """A table as the page has it."""
    return PAGE.read_text("utf-8").split(_begin(name))[1].split(_END)[0]


def _begin(name: str) -> str:
    return f"<!-- proofs of the {name} -->\n"


if __name__ == "__main__":
    for one, made in TABLES.items():
        if not one.startswith(tuple(sys.argv[1:]) or ""):
            continue
        text = PAGE.read_text("utf-8")
        head, rest = text.split(_begin(one))
        PAGE.write_text(head + _begin(one) + made() + _END + rest.split(_END, 1)[1], "utf-8")
