"""A screen: many designs looked at at once, ranked, and those that are worth it computed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import ByValue, Floats, InputError, need
from stepwell.design import Share, share_of
from stepwell.studies.designs import Subject
from stepwell.studies.work import SCREENED, WARP, Screen, work_of

if TYPE_CHECKING:
    from stepwell.studies.store import Study


def ranked(columns: Mapping[str, Floats], by: Sequence[str]) -> list[int]:
    """Numbers of the designs from the best to the worst, by columns (n,) of these names.

    Each name counts for its largest values first or, with - before it, its least; the next decides
    where one has ties, and at last who stands first. Designs without a value in the first are none.
    """
    keys = [columns[one[1:]] if one.startswith("-") else -np.asarray(columns[one]) for one in by]
    # A value that is missing sorts behind all others.
    order = np.lexsort(keys[::-1])
    return [int(k) for k in order if not np.isnan(keys[0][k])]


def aimed(what: str, given: Mapping[str, Any], subject: Subject) -> dict[str, Any]:
    """What a study is given, with what its screen keeps: what does as the design itself does.

    A `ValueError` refuses a design that does nothing that others could keep.
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
    """What a screen says of the designs that a chunk is made of, once and for all."""

    def find() -> list[str]:
        able = [k for k, one in enumerate(made) if not isinstance(one, ValueError)]
        told = dict(zip(able, screen.verdicts([made[k] for k in able]), strict=True))
        return [told.get(k, "") for k in range(len(made))]

    return study.once(SCREENED, chunk, find)


@dataclass(frozen=True, eq=False)
class Screened(ByValue):
    """How a screen and what was computed agree.

    Attributes:
        designs, kept: of which the screen could tell something, and of these, worth it by it.
        computed: designs that were computed.
        alike: of designs drawn by lot, those of which both say the same.
        held: of those kept, those that are worth it by what was computed.
        missed: of designs not kept but drawn by lot, those that are worth it after all.
    """

    designs: int
    kept: int
    computed: int
    alike: Share | None
    held: Share | None
    missed: Share | None


def screened(study: "Study") -> Screened | None:
    """How a study's screen and what it computed agree so far; None where it has none.

    What is drawn by lot is drawn by number, whatever the screen says, so the share of those alike
    is that of all designs; its interval is Clopper and Pearson's.
    """
    screen = study.work.screen
    if screen is None:
        return None
    chunks = study.done_chunks()
    columns = {name: study.values(name, chunks) for name in study.columns}
    told = [str(one) for one in columns[SCREENED]]
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    kept = np.array([one != "" and screen.kept(one) for one in told], bool)
    again = columns["again"] == 1
    both = again & np.array([one != "" for one in told], bool)
    found = [screen.verdict(row) if one else "" for row, one in zip(rows, both, strict=True)]
    alike = np.array([a == b for a, b in zip(told, found, strict=True)], bool)
    worth = np.array([one != "" and screen.kept(one) for one in found], bool)
    lot = both & (columns["lot"] == 1)
    return Screened(
        sum(one != "" for one in told),
        int(kept.sum()),
        int(again.sum()),
        _share(alike, lot),
        _share(worth, both & kept),
        _share(worth, lot & ~kept),
    )


def _share(of: Sequence[bool] | np.ndarray, among: np.ndarray) -> Share | None:
    count = int(among.sum())
    return share_of(int(np.asarray(of)[among].sum()), count) if count else None
