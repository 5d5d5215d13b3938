"""The work of a study: one chunk of it, whoever does it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stepwell.design import parameter
from stepwell.mechanism import Chain
from stepwell.statics import StaticsError
from stepwell.studies.store import PROBLEM, Study, StudyError, opened
from stepwell.studies.work import TEXT, work_of


def fill(folder: str, identity: str, version: str, chunk: int) -> None:
    """Compute a chunk and write it: the same bytes whoever does it, and however often.

    Args:
        folder: of the store.
        identity: of the study that is meant.
        version: of Stepwell that began it.
        chunk: which.

    Raises:
        StudyError: the folder holds another study, or this is another version.
        OSError: it cannot be written.
    """
    study = opened(Path(folder))
    if study.identity != identity or study.version != version:
        raise StudyError(f"{folder}: holds another study than the one that was begun.")
    if not study.is_done(chunk):
        study.write(chunk, columns_of(study, chunk))


def columns_of(study: Study, chunk: int) -> dict[str, np.ndarray[Any, Any]]:
    """Every column of a chunk (rows,), in SI; a design that cannot be has a problem instead."""
    work, rows = work_of(study.what), study.rows(chunk)
    points = study.space.points(rows.start, rows.stop)
    columns: dict[str, Any] = dict(zip(study.space.names, points.T, strict=True))
    for name, unit in work.columns.items():
        columns[name] = [""] * len(rows) if unit == TEXT else np.full(len(rows), np.nan)
    problems = [""] * len(rows)
    for k, number in enumerate(rows):
        try:
            row = work.row(_varied(study, points[k].tolist()), study.seed_of(number))
        except (ValueError, StaticsError, ArithmeticError) as error:
            problems[k] = f"{type(error).__name__}: {error}"
            continue
        for name, value in row.items():
            columns[name][k] = value
    columns[PROBLEM] = problems
    return {
        name: np.array(values, dtype=np.dtypes.StringDType() if unit == TEXT else float)
        for (name, unit), values in zip(
            study.columns.items(), (columns[name] for name in study.columns), strict=True
        )
    }


def _varied(study: Study, values: list[float]) -> Chain:
    chain = study.chain
    for name, value in zip(study.space.names, values, strict=True):
        chain = parameter(chain, name).changed(chain, value)
    return chain
