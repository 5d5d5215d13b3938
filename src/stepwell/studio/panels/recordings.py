"""Comparison of recordings of a test machine with the model of the design."""

import base64
import zlib
from collections.abc import Iterable, Iterator, Sequence
from copy import deepcopy
from itertools import product
from pathlib import PurePosixPath
from typing import Any

import numpy as np

from stepwell import files, lab, mechanism, statics
from stepwell.accounts import account
from stepwell.base import InputError, Ints, Measure, display_unit, plain, to_unit
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.message import LONGEST_MESSAGE

MM = display_unit("m")[1]
_MOST_FILES = 32
# Limit of all unpacked files together: a recording of an hour at 50 Hz has 6 MB.
_MOST_BYTES = 16 << 20
# Most samples of one run in a picture.
_DRAWN = 1500
# Gaps in time and in stroke, in median steps, at which a line is interrupted.
_GAP = 3.0, 20.0


def answer_measured(design: PageDesign, ask: Ask) -> View:
    """Contents of the recordings, their comparison with the model, and bands fitted to them.

    `reading` has the keys of `lab.Reading`; a recording.toml among the files completes it. The
    columns of each file are listed, with the problem of one that cannot be read. The design is the
    one that was tested; parameters in file names are ignored.
    """
    keys = ask.table("reading") if ask.has("reading") else {}
    given = _Files(ask.parts("files", _MOST_FILES), keys)
    ask.close()
    recordings = given.recordings
    held = account(lab.Batch(tuple(recordings), ())).record["recordings"]
    shown = [_file(one, run) for one, run in zip(held, recordings, strict=True)]
    header: dict[str, Any] = {"files": shown, "refused": given.refused, "tables": given.tables}
    header |= {"toml": given.reading.toml, "options": given.reading.options, "units": _UNITS}
    header |= {"series": [], "notes": [], "fit": None, "why_no_fit": ""}
    chain = design.chain
    blocks: dict[str, np.ndarray[Any, Any]] = {}
    if chain.measure is not Measure.TRAVEL or chain.drive_unit != Measure.TRAVEL.travel_unit:
        why = "the design is not driven by a stroke in mm, and recordings are of stroke and force"
        header["notes"] = [f"No comparison: {why}."]
    elif recordings:
        series, notes = _series(recordings, chain)
        comparison, why = _compared(recordings, chain, series)
        header["notes"] = [*notes, why] if why else notes
        header["series"] = [_series_record(one, comparison) for one in series]
        for k, one in enumerate(series):
            blocks |= _curves(f"{k}", one)
        if comparison is not None:
            try:
                fit = lab.refit(comparison)
                header["fit"] = {**fit.record(), "design": _taken(fit, design)}
            except lab.LabError as error:
                header["why_no_fit"] = error.problem
    return View(header, blocks)


def answer_element(_design: PageDesign, ask: Ask) -> View:
    """A design of the one element in a recording, and its phases in a line.

    Raises:
        LabError: the file cannot be read, or its curve is no element.
    """
    reading = lab.Reading.of(ask.table("reading")) if ask.has("reading") else None
    ((name, content),) = _contents([ask], [])
    measured = lab.measure_element(lab.read_bytes(content, name, reading))
    tables = files.tables_in(files.dumps(measured.chain), name)
    return View({"design": tables, "text": str(measured), "notes": list(measured.notes)})


# Units of stroke and of force, in the order in which they are offered.
_UNITS = [["mm", "cm", "m", "um", "in"], ["N", "mN", "cN", "kN", "g", "kg", "lbf"]]


class _Files:
    """The files of the page, read: recordings, columns of each file, and problems."""

    def __init__(self, given: Iterable[Ask], keys: dict[str, Any]):
        self.refused: list[str] = []
        contents = dict(_contents(given, self.refused))
        self.reading = lab.Reading()
        kept = contents.pop(lab.READING_FILE, b"").decode("utf-8", "replace")
        for read in (lambda: lab.Reading.of_toml(kept), lambda: lab.Reading.of(keys)):
            try:
                self.reading = read().over(self.reading)
            except ValueError as error:
                self.refused.append(str(error))
        self.recordings: list[lab.Recording] = []
        self.tables: list[dict[str, Any]] = []
        for name, content in contents.items():
            self._read(name, content)

    def _read(self, name: str, content: bytes) -> None:
        problem, columns = "", ()
        try:
            self.recordings += lab.read_every(content, name, self.reading)
        except lab.LabError as error:
            # The page has fields in place of the options of the command.
            problem, columns = error.problem.split("; or give --")[0], error.columns
            if not columns:
                self.refused.append(str(error))
        # Files of one machine have the same columns: those of the first are enough.
        if not problem and not any(one["columns"] for one in self.tables):
            columns = lab.list_columns(content, name, self.reading)
        self.tables.append({"name": name, "problem": problem, "columns": list(columns)})


def _contents(given: Iterable[Ask], refused: list[str]) -> Iterator[tuple[str, bytes]]:
    """Names and unpacked contents of files of the page."""
    left = _MOST_BYTES
    for file in given:
        # Only a name for messages, never opened.
        name = PurePosixPath(file.text("name", 200).replace("\\", "/")).name or "recording"
        packed = file.text("gzip_base64", LONGEST_MESSAGE)
        file.close()
        try:
            content = _unpacked(packed, left)
        except ValueError as error:
            refused.append(f"{name}: {error}")
            continue
        left -= len(content)
        yield name, content


def _unpacked(packed: str, most: int) -> bytes:
    """Data unpacked from gzip and base64, limited to `most` bytes."""
    unpacking = zlib.decompressobj(wbits=31)
    try:
        content = unpacking.decompress(base64.b64decode(packed, validate=True), most + 1)
    except (ValueError, zlib.error):
        raise InputError("did not arrive whole: choose it again.") from None
    if len(content) > most:
        limit = f"all recordings together have at most {_MOST_BYTES >> 20} MiB"
        way = "Export fewer samples a second, or compare them by `stepwell lab compare`"
        raise InputError(f"is too long: {limit}. {way}.")
    if not unpacking.eof:
        raise InputError("did not arrive whole: choose it again.")
    return content


def _series(
    recordings: Sequence[lab.Recording], chain: mechanism.Chain
) -> tuple[list[lab.Series], list[str]]:
    try:
        batch = lab.sort_series(recordings, [chain], as_designed=True)
    except lab.LabError as error:
        return [], [error.problem]
    return list(batch.series), list(batch.notes)


def _compared(
    recordings: Sequence[lab.Recording], chain: mechanism.Chain, series: Sequence[lab.Series]
) -> tuple[lab.Comparison | None, str]:
    if not series:
        return None, ""
    if len(chain) > 2 or chain.elements:
        kind = "elements" if chain.elements else f"{len(chain)} cells"
        return None, f"The design has {kind}: one or two cells of levers get a verdict and a fit."
    return lab.compare(recordings, [chain], as_designed=True), ""


def _file(record: dict[str, Any], recording: lab.Recording) -> dict[str, Any]:
    stroke = [record["stroke_from_mm"], record["stroke_to_mm"]]
    same = {key: record[key] for key in ("samples", "rate_Hz", "direction", "odd")}
    how = "; ".join(recording.reading)
    return {"name": record["source"], "stroke_mm": stroke, "reading": how, **same}


def _series_record(series: lab.Series, comparison: lab.Comparison | None) -> dict[str, Any]:
    """A series with its verdict, and its snaps paired with those of the model."""
    tests = comparison.tests if comparison else ()
    test = next((one for one in tests if one.series.name == series.name), None)
    events = series.path.events
    predicted = [one.stroke for one in events if one.kind is statics.EventKind.SNAP]
    measured = getattr(test, "snaps", None)
    if measured is None:
        measured = [_measured(series, run) for run in series.recordings]
    return {
        "name": series.name,
        "unloading": series.unloading,
        "runs": [run.source for run in series.recordings],
        "baseline": [run.source for run in series.baseline],
        "notes": list(series.notes),
        "verdict": test.verdict if test else "",
        "rms_N": test.rmse * series.scale if test else None,
        "snaps": [
            {"run": run.source, **pair}
            for run, snaps in zip(series.recordings, measured, strict=True)
            for pair in _snap_rows(predicted, snaps)
        ],
    }


def _measured(series: lab.Series, run: lab.Recording) -> tuple[float, ...]:
    stroke = series.placed(run)
    return tuple(snap.stroke for snap in lab.find_snaps(stroke, run.force, series.quiet))


def _snap_rows(predicted: Sequence[float], measured: Sequence[float]) -> list[dict[str, Any]]:
    """Strokes of snaps of a run and of the model, paired by distance; None if missing."""
    return [
        {
            "predicted_mm": plain(a, MM),
            "measured_mm": plain(b, MM),
            "difference_mm": None if a is None or b is None else to_unit(b - a, "mm"),
        }
        for a, b in _pairs(predicted, measured)
    ]


def _pairs(
    predicted: Sequence[float], measured: Sequence[float]
) -> list[tuple[float | None, float | None]]:
    pairs = product(enumerate(predicted), enumerate(measured))
    near = sorted((abs(a - b), i, j) for (i, a), (j, b) in pairs)
    partner: dict[int, int] = {}
    for _, i, j in near:
        if i not in partner and j not in partner.values():
            partner[i] = j
    measured_of = {i: measured[j] for i, j in partner.items()}
    alone = [(None, b) for j, b in enumerate(measured) if j not in partner.values()]
    return [*((a, measured_of.get(i)) for i, a in enumerate(predicted)), *alone]


def _curves(name: str, series: lab.Series) -> dict[str, np.ndarray[Any, Any]]:
    """Stroke from state 0 and force of all runs of a series; a new segment where a line ends."""
    columns: list[tuple[np.ndarray[Any, Any], ...]] = []
    last = 0
    for run in series.recordings:
        stroke, segment = to_unit(series.placed(run), "mm"), _segments(run)
        shown = np.unique(np.linspace(0, len(run) - 1, min(len(run), _DRAWN)).astype(int))
        columns.append((stroke[shown], run.force[shown], segment[shown] + last))
        last += int(segment[-1]) + 1
    names = (f"{what} {name}" for what in ("stroke", "force", "segment"))
    return dict(zip(names, map(np.concatenate, zip(*columns, strict=True)), strict=True))


def _segments(run: lab.Recording) -> Ints:
    """Indices (n,) of the pieces without a gap in time or stroke."""
    gap = np.zeros(len(run), dtype=bool)
    for values, most in zip((run.time, run.stroke), _GAP, strict=True):
        steps = np.abs(np.diff(values))
        if np.any(steps > 0):
            gap[1:] |= steps > most * np.median(steps[steps > 0])
    return np.cumsum(gap)


def _taken(fit: lab.Refit, design: PageDesign) -> dict[str, Any]:
    tables = deepcopy(design.tables or {})
    legs = tables.get("leg") or [{}]
    leg = legs[design.leg] if design.leg < len(legs) else {}
    chain = leg["chain"] if "cell" in leg.get("chain", {}) else tables["chain"]
    stiffness, rest_length = plain(fit.stiffness), plain(fit.rest_length, MM)
    fitted = {"stiffness_N_per_m": stiffness, "rest_length_mm": rest_length}
    chain["band"] = {**chain.get("band", {}), **fitted}
    bands = [band for cell in chain["cell"] for band in (cell.get("band"), *cell.get("bands", []))]
    for band, key in product(bands, fitted):
        if isinstance(band, dict):
            band.pop(key, None)
    return tables
