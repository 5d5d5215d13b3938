"""Recordings: what each file holds, and what is odd about it."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from stepwell import base
from stepwell.accounts.head import About
from stepwell.accounts.parts import Account, Fact, Level, Notes, RecordTable, Row, Section
from stepwell.base import Quantity
from stepwell.lab import Batch, Recording, hashes

# More turning points of a stroke than this are not listed.
_MOST_POINTS = 6

_RECORDING: base.Schema = (
    Quantity("source", head="file"),
    Quantity("samples", head="samples", read=len, holds=int, left=False),
    Quantity("rate", "Hz", "rate"),
    Quantity("speed", "mm_s", "speed", form=3),
    Quantity("stroke_from", "mm", read=lambda one: one.stroke[0]),
    Quantity("stroke_to", "mm", read=lambda one: one.stroke[-1]),
    Quantity("stroke_range", "mm", read=lambda one: one.stroke.max() - one.stroke.min()),
    Quantity("force_from", "N", read=lambda one: one.force[0]),
    Quantity("force_least", "N", read=lambda one: one.force.min()),
    Quantity("force_most", "N", read=lambda one: one.force.max()),
    Quantity("direction", head="direction"),
    Quantity("halves", head="halves", read=lambda one: len(one.halves), holds=int, left=False),
    Quantity("turns", "mm", read=lambda one: [one.stroke[i] for i in one.turns], holds=[float]),
)


_READ: base.Schema = (*base.read_off(_RECORDING, "recording"), Quantity("odd", holds=[str]))


def _rows(batch: Batch) -> Sequence[Row]:
    return base.rows_of({"recording": batch.recordings, "odd": batch.odd})


# What is reported of recordings.
READ: base.Schema = (
    Quantity("data_sha256", holds={str: str}, read=lambda batch: hashes(batch.recordings)),
    Quantity("recordings", holds=[_READ], read=_rows),
    *base.quantities(
        refused=[(Quantity("source", read="name"), Quantity("problem"))], ignored=[str]
    ),
)


def batch_account(found: Batch, about: About) -> Account:
    """What is reported of recordings."""
    odd = [f"{one['recording'].source}: {line}" for one in _rows(found) for line in one["odd"]]
    read, refused = len(found.recordings), len(found.refused)
    not_read = f"; {base.counted(refused, 'file')} could not be read" * (refused > 0)
    return Account(
        found,
        title="Recordings",
        kind="lab.read/1",
        schema=READ,
        origin=f"{base.counted(read + refused, 'file')} tried.",
        answer=f"{base.counted(read, 'recording')} read{not_read}",
        facts=(
            Fact("Samples", f"{sum(map(len, found.recordings))}"),
            Fact("Oddities", f"{len(odd)}"),
            Fact("Not read", f"{refused}"),
        ),
        sections=(
            Section(
                "Recordings",
                RecordTable(_COLUMNS, "recordings", most=None, more="recordings", level=Level.CARD),
            ),
            Section("Oddities", Notes(odd)),
            Section("Not read", Notes([str(one) for one in found.refused])),
            Section("Not tried", Notes(_ignored(found))),
        ),
    )


def recording_account(found: Recording, about: About) -> Account:
    """What a notebook shows of a recording."""
    known = base.record(_RECORDING, found)
    texts = {
        q.head or q.name.replace("_", " "): f"{q.text(known[q.key])} {q.sign}".strip()
        for q in _RECORDING
        if q.name not in ("source", "turns") and known[q.key] is not None
    }
    return Account(
        found,
        title=f"Recording {found.name}",
        answer="; ".join(found.remarks),
        facts=[Fact(base.headed(label), text) for label, text in texts.items()],
    )


def _ignored(found: Batch) -> list[str]:
    """How many files of each ending were not tried."""
    endings = Counter(PurePath(name).suffix or PurePath(name).name for name in found.ignored)
    each = ", ".join(f"{count} {ending}" for ending, count in sorted(endings.items()))
    return [f"{each}. A file that is named is always tried."] if each else []


def _strokes(row: Mapping[str, Any]) -> str:
    """Where the stroke began, turned and ended; of many turns the first two and the last."""
    points = [row["stroke_from_mm"], *row["turns_mm"], row["stroke_to_mm"]]
    texts = [base.number(one) for one in points]
    if len(texts) > _MOST_POINTS:
        texts = [*texts[:3], "...", *texts[-2:]]
    return " to ".join(texts)


def _forces(row: Mapping[str, Any]) -> str:
    return f"{base.number(row['force_least_N'])} to {base.number(row['force_most_N'])}"


def _columns() -> base.Columns:
    shown = [quantity for quantity in _RECORDING if quantity.head]
    return [
        *shown[:4],
        base.Column("stroke [mm]", _strokes, True),
        base.Column("force [N]", _forces, True),
        *shown[4:],
    ]


_COLUMNS = _columns()
