"""A study opened: how far it is, how fast, what it has found, and designs to be pointed at."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from stepwell.accounts import account
from stepwell.studies import Study, pace, status
from stepwell.studio.panels.studies._command import command_of
from stepwell.studio.panels.studies._folder import study_of
from stepwell.studio.wire import Ask, Design, View

LONG = True
# Designs that are shown at most, and of a column of words the most frequent ones.
_POINTS, _WORDS = 4000, 12


def answer(_design: Design, ask: Ask) -> View:
    """The record of `stepwell sweep status --json`, its pace, and columns as they are told.

    `rows` are numbers of designs that are done, evenly over all; of words a column has their
    places in its list, the last of which is any other.
    """
    study = study_of(ask)
    ask.close()
    found = status(study)
    record = account(found).record
    going = pace(study)
    done = study.done_chunks()
    numbers = np.concatenate([np.asarray(study.rows(k)) for k in done] or [np.empty(0, int)])
    some = np.unique(np.linspace(0, len(numbers) - 1, min(len(numbers), _POINTS)).astype(int))
    if not len(numbers):
        some = np.empty(0, int)
    blocks: dict[str, np.ndarray[Any, Any]] = {"rows": numbers[some].astype(np.int32)}
    columns = [
        _column(study, name, study.values(name, done), some, k, blocks)
        for k, name in enumerate(study.columns)
    ]
    designs = sum(len(study.rows(k)) for k in done)
    rate = going.rate if going else None
    header = {
        **record,
        "name": study.folder.name,
        "command": command_of(study),
        "designs_done": designs,
        "rate_per_s": rate,
        "left_s": (study.count - designs) / rate if rate else None,
        "at_work": bool(going and going.at_work and not found.finished),
        "version": study.version,
        "columns": columns,
    }
    del header["schema"]
    header["failures"] = header.pop("problems")  # `problems` are those of a message that is refused
    return View(header, blocks)


def _column(
    study: Study,
    name: str,
    values: np.ndarray[Any, Any],
    some: np.ndarray[Any, Any],
    k: int,
    blocks: dict[str, np.ndarray[Any, Any]],
) -> dict[str, Any]:
    unit, factor = study.told(name)
    told: dict[str, Any] = {"name": name, "unit": unit, "varied": name in study.varied}
    if study.columns[name] != "text":
        blocks[f"c{k}"] = values[some] * factor
        return {**told, "block": f"c{k}", "words": None}
    words = [str(one) for one in values]
    if name == "problem":
        words = [one.partition(":")[0] for one in words]
    often = [word for word, _ in Counter(words).most_common(_WORDS)]
    places = {word: place for place, word in enumerate(often)}
    blocks[f"c{k}"] = np.array([places.get(words[i], len(often)) for i in some], np.int32)
    return {**told, "block": f"c{k}", "words": [*often, "any other"]}
