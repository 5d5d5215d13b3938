"""A claim of the paper, and what became of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum

from stepwell.base import ByValue, InputError, described


class Judgement(StrEnum):
    """How a claim and our computation compare."""

    AGREES = "agrees"
    DIFFERS = "differs"
    UNDETERMINED = "undetermined"
    NEEDS_DATA = "needs data"
    NEEDS_MUJOCO = "needs MuJoCo"


@dataclass(frozen=True, slots=True, eq=False)
class Finding(ByValue):
    """What we compute for a claim.

    Attributes:
        ours: our value, in words short enough for a table.
        verdict: how it compares.
        reason: why it differs or what is missing; how far it holds, where it agrees.

    Raises:
        ValueError: a difference, or a want of data, without a reason.
    """

    ours: str
    verdict: Judgement
    reason: str = ""

    def __post_init__(self):
        if self.verdict is not Judgement.AGREES and not self.reason:
            raise InputError(f"verdict = {self.verdict}: must come with a reason.")


@dataclass(frozen=True, slots=True, eq=False)
class Claim(ByValue):
    """Something the paper says.

    Attributes:
        id: a short name that stays.
        claim: what is said, in our words.
        where: where the paper says it.
        paper_value: the paper's value.
        tolerance: how far ours may be from it and still agree.
        find: computes ours.
    """

    id: str
    claim: str
    where: str
    paper_value: str
    tolerance: str
    find: Callable[..., Finding] = field(repr=False)

    def judge(self) -> Verdict:
        """Compute ours and compare; without the simulator say so, if that takes it."""
        try:
            finding = self.find()
        except ModuleNotFoundError as error:
            if error.name is None or not error.name.startswith("mujoco"):
                raise
            finding = Finding("", Judgement.NEEDS_MUJOCO, "pip install 'stepwell[robot]'")
        return Verdict(self, finding.ours, finding.verdict, finding.reason)


@dataclass(frozen=True, slots=True, eq=False)
class Verdict(ByValue):
    """What became of a claim.

    Attributes:
        claim: what the paper says.
        ours: our value.
        verdict: how they compare.
        reason: why; empty where they simply agree.
    """

    claim: Claim
    ours: str
    verdict: Judgement
    reason: str

    def __repr__(self):
        return (
            f"Verdict({self.claim.id} {self.verdict}: paper {self.claim.paper_value}; "
            f"ours {self.ours})"
        )


def claim(
    where: str, paper_value: str, tolerance: str
) -> Callable[[Callable[..., Finding]], Claim]:
    """Make a claim of the function that computes ours.

    The function's name is the claim's, with dashes, and its docstring is what is said.

    Args:
        where, paper_value, tolerance: as for `Claim`.
    """

    def made(find: Callable[..., Finding]) -> Claim:
        name, said = find.__name__.replace("_", "-"), described(find)
        return Claim(name, said, where, paper_value, tolerance, find)

    return made


def judged(agrees: bool, ours: str, *, note: str = "", otherwise: str = "") -> Finding:
    """Agreement with a note on how far it goes, or a difference with its reason or the note."""
    if agrees:
        return Finding(ours, Judgement.AGREES, note)
    return Finding(ours, Judgement.DIFFERS, otherwise or note or "Outside the tolerance.")
