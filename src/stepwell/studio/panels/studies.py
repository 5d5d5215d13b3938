"""Panels of parameter studies: list, start, progress, stop, results."""

from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from stepwell import accounts, files, robot
from stepwell.base import InputError, have, missing, to_unit
from stepwell.kernels import cores
from stepwell.studies import IndependentBlocks, Study, begun, cancel, estimate, pace, status
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.stores import begin, described, home, how, stop, stores, study_of
from stepwell.studio.sweeps import asked_study, command_of


def answer_studies(_design: PageDesign, ask: Ask) -> View:
    """All studies, newest first; `missing` is the command that installs a missing package."""
    ask.close()
    if not have("studies"):
        return View({"missing": str(missing("studies")), "folder": "", "studies": []})
    folder = home(ask)
    entries: list[dict[str, Any]] = []
    for name, place in stores(folder).items():
        if description := described(place):
            running, problem = how(place)
            entries.append({"name": name, "running": running, "problem": problem, **description})
    return View({"missing": "", "folder": str(folder), "studies": entries})


# Most designs that are shown, and most words of a column of words.
_POINTS, _WORDS = 4000, 12


def answer_study(_design: PageDesign, ask: Ask) -> View:
    """The record of `stepwell sweep status --json`, its pace, and columns in units of the page.

    `rows` are numbers of finished designs, evenly spaced; a column of words has indices into
    its list, whose last entry stands for any other word.
    """
    study = study_of(ask)
    ask.close()
    progress, going, done = status(study), pace(study), study.done_chunks()
    record = accounts.account(progress).record
    numbers = np.concatenate([np.empty(0, int), *(np.asarray(study.rows(k)) for k in done)])
    some = np.unique(np.linspace(0, len(numbers) - 1, min(len(numbers), _POINTS)).astype(int))
    blocks: dict[str, np.ndarray[Any, Any]] = {"rows": numbers[some].astype(np.int32)}
    columns = [
        _column(study, name, study.values(name, done), some, k, blocks)
        for k, name in enumerate(study.columns)
    ]
    rate = going.rate if going else None
    header = {
        **record,
        "name": study.folder.name,
        "command": command_of(study),
        "designs_done": len(numbers),
        "rate_per_s": rate,
        "left_s": (study.count - len(numbers)) / rate if rate else None,
        "at_work": bool(going and going.at_work and not progress.finished),
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
    (unit, factor), block = study.display_unit(name), f"c{k}"
    header = {"name": name, "unit": unit, "varied": name in study.varied, "block": block}
    if study.columns[name] != "text":
        blocks[block] = values[some] * factor
        return {**header, "words": None}
    words = [str(one).partition(":")[0] if name == "problem" else str(one) for one in values]
    often = [word for word, _ in Counter(words).most_common(_WORDS)]
    places = {word: place for place, word in enumerate(often)}
    blocks[block] = np.array([places.get(words[i], len(often)) for i in some], np.int32)
    return {**header, "words": [*often, "any other"]}


def answer_study_begin(design: PageDesign, ask: Ask) -> View:
    """The name of the store; a study that exists already is resumed."""
    if ask.has("name"):
        study = study_of(ask)
        ask.close()
    else:
        study = asked_study(design, ask, home(ask))
        home(ask).mkdir(parents=True, exist_ok=True)
    study = begun(study)
    begin(study.folder)
    return View({"name": study.folder.name})


def answer_study_stop(_design: PageDesign, ask: Ask) -> View:
    """Stop a study: at once if this server runs it, otherwise after the current chunks."""
    study = study_of(ask)
    ask.close()
    at_once = stop(study.folder)
    if not at_once:
        cancel(study)
    return View({"name": study.folder.name, "at_once": at_once})


def answer_study_estimate(design: PageDesign, ask: Ask) -> View:
    """Numbers of `stepwell sweep ... --estimate`."""
    study = asked_study(design, ask, home(ask))
    times = estimate(study, cores())
    header = {
        "name": study.folder.name,
        "designs": times.designs,
        "sample": times.sample,
        "each_ms": to_unit(times.each, "ms"),
        "time_s": times.seconds,
        "workers": times.workers,
        "disk_MB": times.disk / 1e6,
        "command": command_of(study),
    }
    return View(header)


_MOST = 1_000_000


def answer_study_csv(_design: PageDesign, ask: Ask) -> View:
    """The bytes of the table of `stepwell sweep export`."""
    study = study_of(ask)
    ask.close()
    if study.count > _MOST:
        way = f"stepwell sweep export {study.folder} --out study.parquet"
        raise InputError(
            f"{study.folder.name}: {study.count} designs are too many for a page: {way}"
        )
    with TemporaryDirectory() as folder:
        file = Path(folder) / "study.csv"
        count = study.to_csv(file)
        data = np.frombuffer(file.read_bytes(), np.uint8)
    return View({"suffix": "csv", "designs": count}, {"file": data})


def answer_study_design(_design: PageDesign, ask: Ask) -> View:
    """The tables of the design with a `number`, counted from 0."""
    study = study_of(ask)
    number = ask.whole("number", 0, study.count - 1)
    ask.close()
    designs = study.designs
    if isinstance(designs, IndependentBlocks):
        raise InputError(f"{study.folder.name}: is an atlas, whose rows are blocks of designs.")
    (_, made), *_ = designs.made(study.subject, number, number + 1)
    if isinstance(made, ValueError):
        raise InputError(f"design {number}: cannot be built: {made}")
    tables = files.tables_in(files.dumps(made))
    return View({"number": number, "design": tables, "robot": isinstance(made, robot.Robot)})
