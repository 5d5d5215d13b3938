"""Reading of recordings from files, and one tidy table of all recordings."""

import hashlib
import os
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell import base
from stepwell.base import ByValue, Ints, Measure, Quantity, Schema
from stepwell.lab.recordings.reading import Reading, of_folder
from stepwell.lab.recordings.recording import LabError, Recording
from stepwell.lab.recordings.recording_warnings import batch_warnings, recording_warnings
from stepwell.lab.recordings.roles import Unclear
from stepwell.lab.recordings.samples import Specimen, listed, samples

if TYPE_CHECKING:
    import xarray as xr


SAMPLE: Schema = (
    Quantity("half"),
    Quantity("direction"),
    Quantity("time", "s"),
    Quantity("stroke", "mm"),
    Quantity("force", "N"),
)


def table(recordings: Sequence[Recording]) -> "xr.Dataset":
    """Dataset with a row for every sample of every recording.

    Variables over "row": of (number of the recording), half (from 0 in each recording), direction
    (+1 loading, -1 unloading), time [s], stroke [m], force [N]; over "recording": the source.
    """
    base.need("tables")
    import xarray as xr

    of, columns = _rows(recordings)
    data = {q.name: ("row", column, {"units": q.si}) for q, column in columns.items()}

    data["of"] = "row", of, {"units": "1", "long_name": "number of the recording"}
    sources = [recording.source for recording in recordings]
    origin = {"title": "recordings", "source": f"stepwell {base.__version__}, lab.table"}
    return xr.Dataset(data, {"recording": sources}, origin)


def _rows(recordings: Sequence[Recording]) -> tuple[Ints, dict[Quantity, Any]]:
    """Number of the recording and columns in SI, for every sample of every recording."""
    parts = [np.zeros((6, 0))]
    for number, recording in enumerate(recordings):
        # A turning point belongs to the half that it ends.
        half = np.searchsorted(recording.turns, np.arange(len(recording)), side="left")
        ways = [1 if recording.direction_of(h) == "loading" else -1 for h in recording.halves]
        rows = np.full(len(recording), number), half, np.array(ways)[half]
        parts.append(np.array([*rows, recording.time, recording.stroke, recording.force]))
    of, *columns = np.concatenate(parts, axis=1)
    named = zip(SAMPLE, columns, strict=True)
    typed = {q: column.astype(float if q.unit else np.int64) for q, column in named}
    return of.astype(np.int64), typed


def to_csv(recordings: Sequence[Recording], file: str | os.PathLike[str]) -> None:
    """Write the same rows as CSV, units in the column names (s, mm, N)."""
    of, columns = _rows(recordings)
    names = [recordings[number].name for number in of]
    base.write_csv(file, [(Quantity("recording"), names), *columns.items()], 10)


def hashes(recordings: Sequence[Recording]) -> dict[str, str]:
    """SHA-256 of each recording's file by name, for provenance."""
    return {recording.source: recording.sha256 for recording in recordings}


SUFFIXES = (
    *(".txt", ".csv", ".tsv", ".raw", ".dat", ".asc", ".lvm", ".log", ".tra"),
    *(".xlsx", ".xls", ".ods"),
)
# Tables about recordings, not recordings.
_NOT_DATA = re.compile(r"manifest|readme|licen[cs]e|requirements", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Batch(ByValue):
    """Result of reading files; each file is in one of the three lists.

    Attributes:
        recordings: read files, in the natural order of the names.
        refused: an error for each file that could not be read.
        ignored: files of a folder with another suffix or a name such as manifest or readme.
    """

    recordings: tuple[Recording, ...]
    refused: tuple[LabError, ...]
    ignored: tuple[str, ...] = ()

    @cached_property
    def odd(self) -> tuple[tuple[str, ...], ...]:
        """Warnings for each recording, by itself and compared with the others, a line each."""
        compared = batch_warnings(self.recordings)
        return tuple(
            (*recording_warnings(one), *compared.get(one.source, ())) for one in self.recordings
        )

    def __repr__(self):
        return f"Batch({len(self.recordings)} recordings, {len(self.refused)} refused)"


def read(
    file: str | os.PathLike[str],
    reading: Reading | None = None,
    measures: Iterable[Measure] = (Measure.TRAVEL,),
) -> Recording:
    """One recording, in SI, from the export of a test machine or any table with units.

    Args:
        file: text in any encoding with commas, semicolons, tabs or white space, or a workbook.
        reading: columns, units, signs and part, where the file leaves them open; recording.toml in
            its folder completes it.
        measures: accepted quantities; `tuple(Measure)` also reads volume and pressure, and angle
            and torque.

    Raises:
        LabError: the file is missing, broken, binary or empty, no reading stands out (the error
            lists its columns), or it has several specimens.
    """
    name = os.fspath(file)
    return _only(name, _recordings(name, _content(file), _completed(file, reading), measures))


def read_bytes(content: bytes, name: str, reading: Reading | None = None) -> Recording:
    """One recording, in SI, from the content of a file as for `read`; `name` is not opened.

    Raises:
        LabError: as `read`.
    """
    return _only(name, _recordings(name, content, reading))


def read_every(
    content: bytes,
    name: str,
    reading: Reading | None = None,
    measures: Iterable[Measure] = (Measure.TRAVEL,),
) -> list[Recording]:
    """All specimens in the content of a file, a recording each; `name` is not opened.

    `measures` are as for `read`.

    Raises:
        LabError: as `read`.
    """
    return _recordings(name, content, reading, measures)


def list_columns(
    content: bytes, name: str, reading: Reading | None = None
) -> list[tuple[str, ...]]:
    """The columns in the content of a file; `name` is not opened.

    Returns:
        number, name, unit and range of each column, and its role or why it has none.

    Raises:
        LabError: the file is broken, binary or empty.
    """
    try:
        return listed(content, reading, (Measure.TRAVEL,))
    except ValueError as error:
        raise LabError(name, str(error)) from None


def samples_of(file: str | os.PathLike[str], reading: Reading | None = None) -> list[Specimen]:
    """Every specimen in a file, of stroke and force or of another pair of quantities.

    Raises:
        LabError: as `read`.
    """
    return _samples(os.fspath(file), _content(file), _completed(file, reading), Measure)


def several(name: str, found: Sequence[Any]) -> LabError:
    """The error for a file of several specimens where one is needed."""
    return LabError(
        name,
        f"holds {len(found)} specimens: give sample = 1 to {len(found)} (--sample 1); "
        f"`stepwell lab read` lists them.",
    )


def _only(name: str, found: list[Recording]) -> Recording:
    if len(found) > 1:
        raise several(name, found)
    return found[0]


def _content(file: str | os.PathLike[str]) -> bytes:
    name = os.fspath(file)
    try:
        return base.content_of(Path(file), "recording_bytes")
    except FileNotFoundError:
        raise LabError(name, "no such file.") from None
    except OSError as error:
        raise LabError(name, f"cannot be read: {error.strerror or error}.") from None


def _completed(file: str | os.PathLike[str], reading: Reading | None) -> Reading:
    """The reading, completed by the one kept in the folder of the file."""
    try:
        return (reading or Reading()).over(of_folder(file))
    except ValueError as error:
        raise LabError(os.fspath(file), str(error)) from None


def _samples(
    name: str, content: bytes, reading: Reading | None, measures: Iterable[Measure]
) -> list[Specimen]:
    try:
        return samples(content, reading, measures)
    except Unclear as error:
        raise LabError(name, str(error), error.rows) from None
    except ValueError as error:
        raise LabError(name, str(error), flips=getattr(error, "flips", ())) from None


def _recordings(
    name: str,
    content: bytes,
    reading: Reading | None,
    measures: Iterable[Measure] = (Measure.TRAVEL,),
) -> list[Recording]:
    found = _samples(name, content, reading, measures)
    sha256 = hashlib.sha256(content).hexdigest()
    return [
        Recording(
            _source(name, one.label),
            one.time,
            one.travel,
            one.force,
            one.remarks,
            sha256,
            one.gauge,
            one.steps,
            one.reading,
            one.measure,
            one.other_flip,
        )
        for one in found
    ]


def _source(name: str, label: str) -> str:
    """The name of a specimen of a file with several: strip.csv is strip (2).csv."""
    if not label:
        return name
    path = PurePath(name)
    return str(path.with_name(f"{path.stem} ({label}){path.suffix}"))


def read_all(
    files: Iterable[str | os.PathLike[str]],
    reading: Reading | None = None,
    progress: Callable[[int, int], None] | None = None,
    measures: Iterable[Measure] = (Measure.TRAVEL,),
) -> Batch:
    """Recordings from files and folders, and an error for every other file.

    Every specimen of a file with several is a recording of its own.

    Args:
        files: files, and folders that are searched at any depth for text (.txt, .csv, .tsv, .raw,
            .dat, .asc, .lvm, .log, .tra) and workbooks (.xlsx, .xls, .ods). A named file is always
            read.
        reading: as for `read`, for all files.
        progress: called with (done, total) files.
        measures: as for `read`.
    """
    recordings: list[Recording] = []
    refused: list[LabError] = []
    ignored: list[str] = []
    names = list(dict.fromkeys(name for f in files for name in _files(os.fspath(f), ignored)))
    for done, name in enumerate(names, 1):
        try:
            content, own = _content(name), _completed(name, reading)
            recordings += _recordings(name, content, own, measures)
        except LabError as error:
            refused.append(error)
        base.notify(progress, done, len(names))
    return Batch(tuple(recordings), tuple(refused), tuple(ignored))


def natural(name: str) -> tuple[tuple[int, str], ...]:
    """Sort key that places run_2 before run_10."""
    return tuple(
        (int(part), "") if part.isdecimal() and part.isascii() else (-1, part)
        for part in re.split(r"(\d{1,18})", name)
    )


def _files(name: str, ignored: list[str]) -> list[str]:
    if not os.path.isdir(name):
        return [name]
    wanted: list[str] = []
    for path in sorted(filter(Path.is_file, Path(name).rglob("*")), key=lambda p: natural(str(p))):
        is_data = path.suffix.lower() in SUFFIXES and not _NOT_DATA.search(path.stem)
        (wanted if is_data else ignored).append(str(path))
    return wanted
