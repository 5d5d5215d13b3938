"""How fast a study goes, told from when its chunks were written, whoever writes them."""

from __future__ import annotations

import os
import time
from itertools import pairwise
from statistics import median_low
from typing import NamedTuple

from stepwell.studies.store import PROBLEM, Study

# So many chunks are looked at, and a pause is longer than these seconds and than so many gaps.
_LAST, _PAUSE, _GAPS = 64, 20.0, 10.0


class Pace(NamedTuple):
    """How fast a study went when it was worked on last.

    Attributes:
        rate: designs a second.
        since: how long ago the last chunk was written [s].
        at_work: whether that is not long ago, for chunks that take as long as its own.
    """

    rate: float
    since: float
    at_work: bool


def pace(study: Study, now: float | None = None) -> Pace | None:
    """How fast a study goes; None where fewer than two chunks were written without a pause.

    Args:
        study: whose store is looked at; nothing but the times of its files.
        now: seconds since the epoch; the clock's by default.
    """
    try:
        with os.scandir(study.folder / PROBLEM / "c") as files:
            found = [(one.stat().st_mtime, int(one.name)) for one in files if one.name.isdecimal()]
    except OSError:
        return None
    written = sorted(found)[-_LAST:]
    gaps = [later[0] - earlier[0] for earlier, later in pairwise(written)]
    if not gaps:
        return None
    pause = max(_PAUSE, _GAPS * median_low(gaps))
    first = max((k + 1 for k, gap in enumerate(gaps) if gap > pause), default=0)
    stretch = written[first:]
    spent = stretch[-1][0] - stretch[0][0]
    if len(stretch) < 2 or spent <= 0:
        return None
    designs = sum(len(study.rows(chunk)) for _, chunk in stretch[1:])
    since = (time.time() if now is None else now) - stretch[-1][0]
    return Pace(designs / spent, since, since < max(pause, _GAPS * spent / len(stretch)))
