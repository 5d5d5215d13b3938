"""Recordings as one tidy table, and a line about each."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import Ints, Quantity, Schema, __version__, need, record, write_csv
from stepwell.lab.recordings.oddities import batch_oddities, oddities
from stepwell.lab.recordings.recording import Recording

if TYPE_CHECKING:
    import xarray as xr

SAMPLE: Schema = (
    Quantity("half"),
    Quantity("direction"),
    Quantity("time", "s"),
    Quantity("stroke", "mm"),
    Quantity("force", "N"),
)
SUMMARY: Schema = (
    Quantity("source", head="file"),
    Quantity("samples", head="samples", read=len, left=False),
    Quantity("rate", "Hz", "rate"),
    Quantity("speed", "mm_s", "speed", form=3),
    Quantity("stroke_from", "mm", read=lambda one: one.stroke[0]),
    Quantity("stroke_to", "mm", read=lambda one: one.stroke[-1]),
    Quantity("stroke_range", "mm", read=lambda one: np.ptp(one.stroke)),
    Quantity("force_from", "N", read=lambda one: one.force[0]),
    Quantity("force_least", "N", read=lambda one: np.min(one.force)),
    Quantity("force_most", "N", read=lambda one: np.max(one.force)),
    Quantity("direction", head="direction"),
    Quantity("halves", head="halves", read=lambda one: len(one.halves), left=False),
    Quantity("turns", "mm", read=lambda one: [one.stroke[i] for i in one.turns]),
    Quantity("odd"),
)


def table(recordings: Sequence[Recording]) -> xr.Dataset:
    """Every sample of every recording as one row.

    Args:
        recordings: any number.

    Returns:
        Dataset over "row": recording (its number), half (counted from 0 in each recording),
        direction (+1 loading, -1 unloading), time [s], stroke [m], force [N]; and over
        "recording" the coordinate source.
    """
    need("tables")
    import xarray as xr

    of, columns = _rows(recordings)
    data = {q.name: ("row", column, {"units": q.si}) for q, column in columns.items()}
    numbered = {"units": "1", "long_name": "number of the recording"}
    data["of"] = "row", of, numbered
    return xr.Dataset(
        data,
        {"recording": [recording.source for recording in recordings]},
        {"title": "recordings", "source": f"stepwell {__version__}, lab.table"},
    )


def _rows(recordings: Sequence[Recording]) -> tuple[Ints, dict[Quantity, Any]]:
    """Every sample of every recording: the number of its recording, and its columns in SI."""
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
    write_csv(file, [(Quantity("recording"), names), *columns.items()], 10)


def summary(recordings: Sequence[Recording]) -> list[dict[str, Any]]:
    """What each recording holds, as JSON can hold it; docs/commands.md describes the names."""
    beside = batch_oddities(recordings)
    return [
        record(SUMMARY, one, odd=[*oddities(one), *beside.get(one.source, ())])
        for one in recordings
    ]


def hashes(recordings: Sequence[Recording]) -> dict[str, str]:
    """The SHA-256 of each recording's file by its name: what a result was computed from."""
    return {recording.source: recording.sha256 for recording in recordings}
