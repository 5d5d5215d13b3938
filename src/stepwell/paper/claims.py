"""A claim of the paper, its verdict, and the verdicts as a table in Markdown."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import StrEnum

from stepwell.base import IN_CLONE, ByValue, InputError, Shown, described, install


class Judgement(StrEnum):
    """Comparison of a claim with our computation."""

    AGREES = "agrees"
    DIFFERS = "differs"
    UNDETERMINED = "undetermined"
    NEEDS_DATA = "needs data"
    NEEDS_MUJOCO = "needs MuJoCo"


@dataclass(frozen=True, slots=True, eq=False)
class Finding(ByValue):
    """Our result for a claim.

    Attributes:
        ours: our value, in words short enough for a table.
        verdict: the comparison.
        reason: of a difference or of missing data; limits of an agreement.

    Raises:
        ValueError: a difference, or missing data, without a reason.
    """

    ours: str
    verdict: Judgement
    reason: str = ""

    def __post_init__(self):
        if self.verdict is not Judgement.AGREES and not self.reason:
            raise InputError(f"verdict = {self.verdict}: must come with a reason.")


@dataclass(frozen=True, slots=True, eq=False)
class Claim(ByValue):
    """A statement of the paper.

    Attributes:
        id: a short permanent name.
        claim, where: the statement in our words, and its place in the paper.
        paper_value: the paper's value.
        tolerance: largest deviation of ours that counts as agreement.
        find: computes ours.
    """

    id: str
    claim: str
    where: str
    paper_value: str
    tolerance: str
    find: Callable[..., Finding] = field(repr=False)

    def judge(self) -> "ClaimVerdict":
        """Compute ours and compare; if it needs MuJoCo and it is missing, report that."""
        try:
            finding = self.find()
        except ModuleNotFoundError as error:
            if error.name is None or not error.name.startswith("mujoco"):
                raise
            finding = Finding("", Judgement.NEEDS_MUJOCO, install("robot") + IN_CLONE)
        return ClaimVerdict(self, finding.ours, finding.verdict, finding.reason)


@dataclass(frozen=True, slots=True, eq=False)
class ClaimVerdict(ByValue):
    """Verdict on a claim: our value, the comparison, and a reason, "" for plain agreement."""

    claim: Claim
    ours: str
    verdict: Judgement
    reason: str

    def __repr__(self):
        return (
            f"ClaimVerdict({self.claim.id} {self.verdict}: paper {self.claim.paper_value}; "
            f"ours {self.ours})"
        )


class Verdicts(tuple[ClaimVerdict, ...], Shown):
    """A verdict for each claim, in the order of the claims."""

    __slots__ = ()

    @property
    def agreed(self) -> int:
        """Number of claims that agree."""
        return sum(one.verdict is Judgement.AGREES for one in self)

    def __repr__(self):
        return f"Verdicts({self.agreed} of {len(self)} claims agree)"


def claim(
    where: str, paper_value: str, tolerance: str
) -> Callable[[Callable[..., Finding]], Claim]:
    """Decorator: make a claim from the function that computes ours; arguments as for `Claim`.

    The claim's id is the function's name with dashes, its statement is the docstring.
    """

    def made(find: Callable[..., Finding]) -> Claim:
        name, statement = find.__name__.replace("_", "-"), described(find)
        return Claim(name, statement, where, paper_value, tolerance, find)

    return made


def finding_of(agrees: bool, ours: str, *, note: str = "", otherwise: str = "") -> Finding:
    """Agreement with a note on its limits, or a difference with its reason or the note."""
    if agrees:
        return Finding(ours, Judgement.AGREES, note)
    return Finding(ours, Judgement.DIFFERS, otherwise or note or "Outside the tolerance.")


BEGIN = "<!-- claims: written by `python tests/docs/claims_pages.py`, not by hand -->"
END = "<!-- end of claims -->"


def markdown(verdicts: Iterable[ClaimVerdict]) -> str:
    """The verdicts that `run` returns as a Markdown table, reasons and notes below it."""
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
    """A page with the text between two markers replaced; `what` names the text in an error."""
    before, first, rest = page.partition(begin)
    _, last, after = rest.partition(end)
    if not (first and last):
        raise InputError(f"the page has no place for the {what}: add {begin} and {end}.")
    return f"{before}{begin}\n\n{text}\n\n{end}{after}"


def _count(verdicts: tuple[ClaimVerdict, ...]) -> str:
    judgements = [verdict.verdict for verdict in verdicts]
    words = "agree", "differ", "are undetermined", "need data", "need MuJoCo"
    seldom = {Judgement.UNDETERMINED, Judgement.NEEDS_MUJOCO}.difference(judgements)
    each = zip(Judgement, words, strict=True)
    parts = [f"{judgements.count(one)} {word}" for one, word in each if one not in seldom]
    return f"Of {len(judgements)} claims {', '.join(parts)}."
