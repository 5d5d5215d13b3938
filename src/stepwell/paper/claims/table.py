"""The verdicts as a table in a page of text."""

from __future__ import annotations

from collections.abc import Iterable

from stepwell.base import InputError
from stepwell.paper.claims.claim import Judgement, Verdict

BEGIN = "<!-- claims: written by `python -m stepwell.paper`, not by hand -->"
END = "<!-- end of claims -->"


def markdown(verdicts: Iterable[Verdict]) -> str:
    """The verdicts as a Markdown table, reasons and notes below it.

    Args:
        verdicts: what `run` returns.
    """
    verdicts = tuple(verdicts)
    lines = ["| Claim | Where | Paper | Stepwell | Within | Verdict |", "|---|---|---|---|---|---|"]
    for verdict in verdicts:
        claim = verdict.claim
        row = (claim.claim, claim.where, claim.paper_value, verdict.ours, claim.tolerance)
        cells = " | ".join(text.replace("|", "\\|") for text in row)
        lines.append(f"| {cells} | **{verdict.verdict}** |")
    lines += ["", _count(verdicts), ""]
    lines += [f"- {v.claim.claim} *{v.verdict}*: {v.reason}" for v in verdicts if v.reason]
    return "\n".join(lines)


def replaced(page: str, text: str, begin: str = BEGIN, end: str = END, what: str = "claims") -> str:
    """A page with the text between its two markers replaced; `what` it is, for who forgot them.

    Raises:
        ValueError: a marker is missing.
    """
    before, first, rest = page.partition(begin)
    _, last, after = rest.partition(end)
    if not (first and last):
        raise InputError(f"the page has no place for the {what}: put in {begin} and {end}.")
    return f"{before}{begin}\n\n{text}\n\n{end}{after}"


def _count(verdicts: tuple[Verdict, ...]) -> str:
    found = [verdict.verdict for verdict in verdicts]
    words = {
        Judgement.AGREES: "agree",
        Judgement.DIFFERS: "differ",
        Judgement.UNDETERMINED: "are undetermined",
        Judgement.NEEDS_DATA: "need data",
        Judgement.NEEDS_MUJOCO: "need MuJoCo",
    }
    seldom = {Judgement.UNDETERMINED, Judgement.NEEDS_MUJOCO}.difference(found)
    parts = [f"{found.count(one)} {word}" for one, word in words.items() if one not in seldom]
    return f"Of {len(found)} claims {', '.join(parts)}."
