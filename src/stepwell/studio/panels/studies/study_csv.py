"""A study as a table, a line for every design."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from stepwell.base import InputError
from stepwell.studio.panels.studies._folder import study_of
from stepwell.studio.wire import Ask, Design, View

LONG = True
_MOST = 1_000_000


def answer(_design: Design, ask: Ask) -> View:
    """The bytes that `stepwell sweep export` writes."""
    study = study_of(ask)
    ask.close()
    if study.count > _MOST:
        raise InputError(
            f"{study.folder.name}: {study.count} designs are too many for a page: "
            f"stepwell sweep export {study.folder} --out study.parquet"
        )
    with TemporaryDirectory() as folder:
        file = Path(folder) / "study.csv"
        count = study.to_csv(file)
        data = np.frombuffer(file.read_bytes(), np.uint8)
    return View({"suffix": "csv", "designs": count}, {"file": data})
