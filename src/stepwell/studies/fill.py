"""Computation of one chunk of a study, and estimates of the run time."""

import math
import os
import time
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import pairwise
from statistics import fmean, median_low
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import InputError, __version__
from stepwell.studies.screen import verdicts_of
from stepwell.studies.store import PROBLEM, Study, StudyError, edition, opened, same_version
from stepwell.studies.work import SCREEN_COLUMNS, TEXT

# Largest number of designs that an estimate computes, and its time limit [s].
_SAMPLE, _PATIENCE = 8, 10.0


def fill(folder: str, identity: str, chunk: int) -> None:
    """Compute a chunk and write it; the result is bit-identical for every worker. Another study in
    the folder, or one of another version, raises a `StudyError`.
    """
    study = _meant(folder, identity, edition(folder))
    if not study.is_done(chunk):
        study.write(chunk, columns_of(study, chunk))


@lru_cache(maxsize=1)
def _meant(folder: str, identity: str, _edition: tuple[int, ...]) -> Study:
    """The study, opened once for many chunks while its description file is unchanged."""
    study = opened(folder)
    same_version(study, __version__)
    if study.identity != identity:
        raise StudyError(f"{folder}: another study has replaced the one that was started.")
    return study


def columns_of(study: Study, chunk: int) -> dict[str, np.ndarray[Any, Any]]:
    """Every column of a chunk (rows,) [SI]; a design that fails has a problem instead."""
    rows = study.rows(chunk)
    columns: dict[str, list[Any]] = {name: [] for name in study.columns}
    made: Iterable[Any] = study.designs.made(study.subject, rows.start, rows.stop)
    verdicts = None
    if screen := study.work.screen:
        made = list(made)
        verdicts = verdicts_of(study, screen, chunk, [design for _, design in made])
    for row in _computed(study, rows, made, verdicts):
        for name, values in columns.items():
            values.append(row[name])
    return {
        name: np.array(values, dtype=np.dtypes.StringDType() if unit == TEXT else float)
        for (name, unit), values in zip(study.columns.items(), columns.values(), strict=True)
    }


def _computed(
    study: Study, rows: range, made: Iterable[Any], verdicts: Sequence[str] | None = None
) -> Any:
    """Rows of the designs, as values by column; after a screen, only selected rows are computed."""
    nothing = {name: "" if unit == TEXT else math.nan for name, unit in study.columns.items()}
    for number, (values, design) in zip(rows, made, strict=True):
        row = nothing | dict(zip(study.varied, values, strict=True))
        if isinstance(design, ValueError):
            yield row | {PROBLEM: _error_text(design)}
            continue
        if verdicts is not None and (screen := study.work.screen):
            verdict, lot = verdicts[number - rows.start], study.by_lot(number)
            again = not verdict or screen.kept(verdict) or lot
            row |= dict(zip(SCREEN_COLUMNS, (verdict, float(again), float(lot)), strict=True))
            if not again:
                yield row
                continue
        try:
            result = study.work.row(design, study.seed_of(number))
            if result.keys() != study.work.columns.keys():
                wanted = ", ".join(study.work.columns)
                raise StudyError(f"gave {', '.join(result)}: must give {wanted}.")
        except Exception as error:  # a function of one's own may raise anything
            yield row | {PROBLEM: _error_text(error)}
            continue
        yield row | dict(result)


def _error_text(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


class StudyEstimate(NamedTuple):
    """Estimated run time and disk space of a study.

    Attributes:
        designs: number of designs.
        sample: number of designs computed for the estimate.
        each: time per design on one core [s].
        seconds: time of all designs on `workers` cores [s].
        workers: number of cores.
        disk: upper limit before compression [bytes].
    """

    designs: int
    sample: int
    each: float
    seconds: float
    workers: int
    disk: int


def estimate(study: Study, workers: int) -> StudyEstimate:
    """Estimated run time and disk space of a study, started or not, on `workers` cores.

    A few evenly spaced designs are computed immediately. The time of the first, which includes
    compilation and imports, is ignored if there are others. A `ValueError` is raised if no design
    can be computed.
    """
    if study.work.screen:
        raise InputError(
            "estimate: the number of designs selected by a screen is unknown in advance: estimate "
            "with engine = 'cpu' for an upper limit."
        )
    count = min(_SAMPLE, study.count)
    chosen = sorted({round(k * (study.count - 1) / max(count - 1, 1)) for k in range(count)})
    begin, spent, text = time.perf_counter(), list[float](), 0
    for number in chosen:
        now = time.perf_counter()
        made = study.designs.made(study.subject, number, number + 1)
        (row,) = _computed(study, range(number, number + 1), made)
        spent.append(time.perf_counter() - now)
        text = max(text, sum(len(v.encode()) for v in row.values() if isinstance(v, str)))
        if time.perf_counter() - begin > _PATIENCE:
            break
    each = fmean(spent[1:] or spent)
    texts = sum(unit == TEXT for unit in study.columns.values())
    disk = study.count * (8 * (len(study.columns) - texts) + text + 4 * texts)
    seconds = each * study.count / workers
    return StudyEstimate(study.count, len(spent), each, seconds, workers, disk)


# Largest number of chunks used; a pause is longer than these seconds and this multiple of a gap.
_LAST, _PAUSE, _GAPS = 64, 20.0, 10.0


class Pace(NamedTuple):
    """Speed of a study's last run.

    Attributes:
        rate: designs per second.
        since: time since the last chunk was written [s].
        at_work: whether that time is short enough for a run in progress.
    """

    rate: float
    since: float
    at_work: bool


def pace(study: Study, now: float | None = None) -> Pace | None:
    """Speed of a study; None if fewer than two chunks were written without a pause.

    It is computed from file times only, at `now` [s] since the epoch, or the current time.
    """
    try:
        with os.scandir(study.folder / PROBLEM / "c") as files:
            times = [(one.stat().st_mtime, int(one.name)) for one in files if one.name.isdecimal()]
    except OSError:
        return None
    written = sorted(times)[-_LAST:]
    gaps = [later[0] - earlier[0] for earlier, later in pairwise(written)]
    if not gaps:
        return None
    pause = max(_PAUSE, _GAPS * median_low(gaps))
    first = max((k + 1 for k, gap in enumerate(gaps) if gap > pause), default=0)
    stretch = written[first:]
    spent = stretch[-1][0] - stretch[0][0]
    if spent <= 0:
        return None
    designs = sum(len(study.rows(chunk)) for _, chunk in stretch[1:])
    since = (time.time() if now is None else now) - stretch[-1][0]
    return Pace(designs / spent, since, since < max(pause, _GAPS * spent / len(stretch)))
