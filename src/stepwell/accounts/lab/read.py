"""Recordings: contents of each file, and its oddities."""

from collections import Counter
from collections.abc import Sequence
from pathlib import PurePath

from stepwell import base
from stepwell.accounts.chain import label_of, with_sign
from stepwell.accounts.head import About, Row, keys
from stepwell.accounts.parts import CARD, Account, Fact, Notes, RecordTable
from stepwell.lab import Batch, Recording, hashes

_RECORDING: base.Schema = (
    base.Quantity("source", head="file"),
    base.Quantity("samples", head="samples", read=len, holds=int, left=False),
    base.Quantity("rate", "Hz", "rate"),
    base.Quantity("speed", "mm_s", "speed", form=3),
    *keys(stroke_from=("mm", lambda r: r.stroke[0]), stroke_to=("mm", lambda r: r.stroke[-1])),
    *keys(stroke_range=("mm", lambda r: r.stroke.max() - r.stroke.min())),
    *keys(force_from=("N", lambda r: r.force[0]), force_least=("N", lambda r: r.force.min())),
    *keys(force_most=("N", lambda r: r.force.max())),
    base.Quantity("direction", head="direction"),
    base.Quantity("halves", head="halves", read=lambda one: len(one.halves), holds=int, left=False),
    base.Quantity(
        "turns", "mm", read=lambda one: [one.stroke[i] for i in one.turns], holds=[float]
    ),
)
_READ: base.Schema = (*base.read_off(_RECORDING, "recording"), base.Quantity("odd", holds=[str]))
_REFUSED = keys(source=(str, "name"), problem=str)
_SHOWN = [quantity for quantity in _RECORDING if quantity.head]


def _rows(batch: Batch) -> Sequence[Row]:
    return base.rows_of({"recording": batch.recordings, "odd": batch.odd})


READ: base.Schema = (
    *keys(data_sha256=({str: str}, lambda batch: hashes(batch.recordings))),
    *keys(recordings=([_READ], _rows), refused=[_REFUSED], ignored=[str]),
)


def batch_account(batch: Batch, about: About) -> Account:
    """Recordings that were read, their oddities, and files that could not be read."""
    odd = [f"{one['recording'].source}: {line}" for one in _rows(batch) for line in one["odd"]]
    read, refused = len(batch.recordings), len(batch.refused)
    not_read = f"; {base.counted(refused, 'file')} could not be read" * (refused > 0)
    facts = (
        Fact("Samples", f"{sum(map(len, batch.recordings))}"),
        Fact("Oddities", f"{len(odd)}"),
        Fact("Not read", f"{refused}"),
    )
    endings = Counter(PurePath(name).suffix or PurePath(name).name for name in batch.ignored)
    ignored = ", ".join(f"{count} {ending}" for ending, count in sorted(endings.items()))
    hint = f"{ignored}. A file that is named is always tried."
    sections = {
        "Recordings": RecordTable(_COLUMNS, "recordings", more="recordings", level=CARD),
        "Oddities": Notes(odd),
        "Not read": Notes([str(one) for one in batch.refused]),
        "Not tried": Notes([hint] if ignored else []),
    }
    answer = f"{base.counted(read, 'recording')} read{not_read}"
    origin = f"{base.counted(read + refused, 'file')} tried."
    return Account(batch, "Recordings", "lab.read/1", answer, facts, sections, origin=origin)


def recording_account(recording: Recording, about: About) -> Account:
    """Card of a recording in a notebook."""
    values = base.record(_RECORDING, recording)
    schema = [q for q in _RECORDING if q.name not in ("source", "turns")]
    facts = [Fact(base.headed(label_of(q)), with_sign(q, values[q.key])) for q in schema]
    title, answer = f"Recording {recording.name}", "; ".join(recording.remarks)
    return Account(recording, title, answer=answer, facts=facts)


def _strokes(row: Row) -> str:
    """Start, turning points and end of the stroke; of more than six the outer five."""
    points = [row["stroke_from_mm"], *row["turns_mm"], row["stroke_to_mm"]]
    texts = [base.number(one) for one in points]
    return " to ".join(texts if len(texts) <= 6 else [*texts[:3], "...", *texts[-2:]])


_COLUMNS = (
    *_SHOWN[:4],
    base.Column("stroke [mm]", _strokes, True),
    base.Column(
        "force [N]",
        lambda row: f"{base.number(row['force_least_N'])} to {base.number(row['force_most_N'])}",
        True,
    ),
    *_SHOWN[4:],
)
