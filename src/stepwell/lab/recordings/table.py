"""Recordings as one tidy table, and a line about each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import __version__, csv_text
from stepwell.lab.recordings.oddities import batch_oddities, oddities
from stepwell.lab.recordings.recording import Recording

if TYPE_CHECKING:
    import xarray as xr


def table(recordings: Sequence[Recording]) -> xr.Dataset:
    """Every sample of every recording as one row.

    Args:
        recordings: any number.

    Returns:
        Dataset over "row": recording (its number), half (counted from 0 in each recording),
        direction (+1 loading, -1 unloading), time [s], stroke [m], force [N]; and over
        "recording" the coordinate source.
    """
    import xarray as xr

    columns: dict[str, list[Any]] = {"recording": [], "half": [], "direction": []}
    for number, recording in enumerate(recordings):
        # A turning point belongs to the half that it ends.
        half = np.searchsorted(recording.turns, np.arange(len(recording)), side="left")
        ways = [1 if recording.direction_of(h) == "loading" else -1 for h in recording.halves]
        columns["recording"].append(np.full(len(recording), number))
        columns["half"].append(half)
        columns["direction"].append(np.array(ways)[half])
    measured = {"time": "s", "stroke": "m", "force": "N"}
    data: dict[str, Any] = {
        name: ("row", np.concatenate([*parts, []]).astype(np.int64), {"units": "1"})
        for name, parts in columns.items()
    }
    for name, unit in measured.items():
        values = np.concatenate([*(getattr(r, name) for r in recordings), []])
        data[name] = ("row", values, {"units": unit})
    data["of"] = data.pop("recording")
    data["of"][2]["long_name"] = "number of the recording"
    return xr.Dataset(
        data,
        {"recording": [recording.source for recording in recordings]},
        {"title": "recordings", "source": f"stepwell {__version__}, lab.table"},
    )


def table_csv(recordings: Sequence[Recording]) -> str:
    """The same rows as CSV text, units in the column names (s, mm, N)."""
    head = ("recording", "half", "direction", "time_s", "stroke_mm", "force_N")
    data = table(recordings)
    columns = (data[name].values for name in ("of", "half", "direction", "time", "stroke", "force"))
    rows = (
        (recordings[of].name, str(half), str(way), f"{time:.10g}", f"{u * 1e3:.10g}", f"{f:.10g}")
        for of, half, way, time, u, f in zip(*columns, strict=True)
    )
    return csv_text(head, rows)


def summary(recordings: Sequence[Recording]) -> list[dict[str, Any]]:
    """What each recording holds, as JSON can hold it; docs/commands.md describes the names."""
    beside = batch_oddities(recordings)
    return [
        {
            "source": recording.source,
            "samples": len(recording),
            "rate_Hz": _known(recording.rate),
            "speed_mm_s": _known(recording.speed * 1e3),
            "stroke_from_mm": float(recording.stroke[0]) * 1e3,
            "stroke_to_mm": float(recording.stroke[-1]) * 1e3,
            "stroke_range_mm": float(np.ptp(recording.stroke)) * 1e3,
            "force_from_N": float(recording.force[0]),
            "force_least_N": float(np.min(recording.force)),
            "force_most_N": float(np.max(recording.force)),
            "direction": recording.direction,
            "halves": len(recording.halves),
            "turns_mm": [float(recording.stroke[i]) * 1e3 for i in recording.turns],
            "odd": [*oddities(recording), *beside.get(recording.source, ())],
        }
        for recording in recordings
    ]


def hashes(recordings: Sequence[Recording]) -> dict[str, str]:
    """The SHA-256 of each recording's file by its name: what a result was computed from."""
    return {recording.source: recording.sha256 for recording in recordings}


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
