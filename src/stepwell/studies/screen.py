"""Screens (prefilters in single precision): verdicts, selection and agreement with results."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import ByValue, Floats, InputError, need
from stepwell.design import Fraction, fraction_of
from stepwell.studies.designs import Subject
from stepwell.studies.work import SCREENED, WARP, Screen, work_of

if TYPE_CHECKING:
    from stepwell.studies.store import Study


def ranked(columns: Mapping[str, Floats], by: Sequence[str]) -> list[int]:
    """Numbers of the designs from the best to the worst, by columns (n,) of these names.

    A name sorts by falling values or, with - before it, by rising values; later names break ties,
    then the number of the design. Designs without a value in the first column are left out.
    """
    keys = [columns[one[1:]] if one.startswith("-") else -np.asarray(columns[one]) for one in by]
    # Missing values are sorted last.
    order = np.lexsort(keys[::-1])
    return [int(k) for k in order if not np.isnan(keys[0][k])]


def aimed(what: str, given: Mapping[str, Any], subject: Subject) -> dict[str, Any]:
    """The options of a study, with the verdict of the nominal design as the target of its screen. A
    `ValueError` is raised if the nominal design has no verdict to reproduce.
    """
    if given.get("engine") != WARP or "wanted" in given:
        return dict(given)
    need("gpu")
    work = work_of(what, given, subject)
    assert work.screen is not None
    try:
        return {**given, "wanted": work.screen.aim(work.screen.verdict(work.row(subject, 0)))}
    except InputError as error:
        raise InputError(f"{what}: engine = {WARP!r}: {error}") from None


def verdicts_of(study: "Study", screen: Screen, chunk: int, made: Sequence[Any]) -> list[str]:
    """Verdicts of a screen on the designs of a chunk, computed once and stored."""

    def find() -> list[str]:
        able = [k for k, one in enumerate(made) if not isinstance(one, ValueError)]
        verdicts = dict(zip(able, screen.verdicts([made[k] for k in able]), strict=True))
        return [verdicts.get(k, "") for k in range(len(made))]

    return study.once(SCREENED, chunk, find)


@dataclass(frozen=True, eq=False)
class Screened(ByValue):
    """Agreement of a screen with the computed results.

    Attributes:
        designs, kept: number of designs with a verdict, and of designs selected by the screen.
        computed: number of computed designs.
        alike: of designs drawn at random, the fraction with equal verdicts.
        held: of selected designs, the fraction that meets the target when computed.
        missed: of designs drawn at random and not selected, the fraction that meets the target.
    """

    designs: int
    kept: int
    computed: int
    alike: Fraction | None
    held: Fraction | None
    missed: Fraction | None


def screened(study: "Study") -> Screened | None:
    """Agreement of a study's screen with its results so far; None without a screen.

    Random designs are drawn by number, independent of the screen, so the fraction of equal verdicts
    is unbiased; its interval is Clopper and Pearson's.
    """
    screen = study.work.screen
    if screen is None:
        return None
    chunks = study.done_chunks()
    columns = {name: study.values(name, chunks) for name in study.columns}
    verdicts = [str(one) for one in columns[SCREENED]]
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    kept = np.array([one != "" and screen.kept(one) for one in verdicts], bool)
    again = columns["again"] == 1
    both = again & np.array([one != "" for one in verdicts], bool)
    computed = [screen.verdict(row) if one else "" for row, one in zip(rows, both, strict=True)]
    alike = np.array([a == b for a, b in zip(verdicts, computed, strict=True)], bool)
    worth = np.array([one != "" and screen.kept(one) for one in computed], bool)
    lot = both & (columns["lot"] == 1)
    return Screened(
        sum(one != "" for one in verdicts),
        int(kept.sum()),
        int(again.sum()),
        _fraction(alike, lot),
        _fraction(worth, both & kept),
        _fraction(worth, lot & ~kept),
    )


def _fraction(of: Sequence[bool] | np.ndarray, among: np.ndarray) -> Fraction | None:
    count = int(among.sum())
    return fraction_of(int(np.asarray(of)[among].sum()), count) if count else None
