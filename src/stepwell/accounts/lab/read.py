"""Recordings: contents and oddities of each file, and an element measured from one."""

from collections import Counter
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

from stepwell import base
from stepwell.accounts.chain import ERROR_BAND, label_of, texts, with_sign
from stepwell.accounts.head import About, DesignShape, Row, keys
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Notes, Picture, RecordTable, Text
from stepwell.accounts.words import folded_notes
from stepwell.lab import Batch, MeasuredElement, Recording, half_cycles, hashes

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
_EXTREME = keys(stroke="mm", force="N")
_JUMP = keys(stroke="mm", jump="N")
_HALF: base.Schema = (
    base.Quantity("half", head="half", read="number", holds=int),
    *keys(direction=str, stroke_from=("mm", "start"), stroke_to=("mm", "end")),
    *keys(force_least=("N", "least"), force_most=("N", "most")),
    *keys(peaks=[_EXTREME], valleys=[_EXTREME], snaps=[_JUMP], work="mJ", loss=float),
    *keys(stiffness_0="N/m", stiffness_1="N/m", noise="N"),
)
_READ: base.Schema = (
    *base.read_off(_RECORDING, "recording"),
    base.Quantity("half_cycles", holds=[_HALF], read=lambda row: half_cycles(row["recording"])),
    base.Quantity("odd", holds=[str]),
)
_REFUSED = keys(source=(str, "name"), problem=str)
_SHOWN = [quantity for quantity in _RECORDING if quantity.head]
# Half cycles that a terminal shows; more than one leave less room for extremes and jumps.
_SHOWN_HALVES, _PLACES = 3, {1: 4, 2: 2}


def _rows(batch: Batch) -> Sequence[Row]:
    return base.rows_of({"recording": batch.recordings, "odd": batch.odd})


READ: base.Schema = (
    *keys(data_sha256={str: str}),
    *keys(recordings=([_READ], _rows), refused=[_REFUSED], ignored=[str]),
)


def batch_account(batch: Batch, about: About) -> Account:
    """Recordings that were read, the extremes, work and stiffness of each half, and oddities."""
    odd = [f"{one['recording'].source}: {line}" for one in _rows(batch) for line in one["odd"]]
    read, refused = len(batch.recordings), len(batch.refused)
    not_read = f"; {base.counted(refused, 'file')} could not be read" * (refused > 0)
    endings = Counter(PurePath(name).suffix or PurePath(name).name for name in batch.ignored)
    ignored = ", ".join(f"{count} {ending}" for ending, count in sorted(endings.items()))
    hint = f"{ignored}. A file that is named is always tried."
    halves = [
        f"{k} {one.direction_of(half)}"
        for one in batch.recordings
        for k, half in enumerate(one.halves, 1)
    ]
    few = halves[:_SHOWN_HALVES]
    first = f": the first {len(few)} of {len(halves)}" * (len(halves) > len(few))
    how = "Forces at strokes [mm]; k at the onset of force, and at the largest stroke."
    sections = {
        f"Half cycles{first}": RecordTable(
            _across(few), "recordings", level=CARD, pick=_transposed
        ),
        "All half cycles": RecordTable(_HALF_COLUMNS, "recordings", how, level=FULL, pick=_halves),
        "Recordings": (
            Picture("recordings", "Force against stroke"),
            RecordTable(_COLUMNS, "recordings", more="recordings", level=FULL),
        ),
        **folded_notes("Oddities", odd, 2 + (not refused)),
        **folded_notes("Not read", [str(one) for one in batch.refused]),
        "Not tried": Notes([hint] if ignored else [], FULL),
    }
    not_read += f"; {ignored} not tried" * bool(ignored)
    samples = base.counted(sum(map(len, batch.recordings)), "sample")
    answer = f"{base.counted(read, 'recording')} with {samples} read{not_read}"
    origin = f"{base.counted(read + refused, 'file')} tried."
    given = {"data_sha256": hashes(batch.recordings)}
    title, kind = "Recordings", "lab.read/1"
    return Account(batch, title, kind, answer, (), sections, origin=origin, given=given)


def _halves(recordings: Sequence[Row]) -> list[dict[str, Any]]:
    """The half cycles of all recordings, with the name of the recording."""
    return [
        {"name": PurePath(one["source"]).stem, **half}
        for one in recordings
        for half in one["half_cycles"]
    ]


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


def _range(row: Row, low: str, high: str) -> str:
    return f"{base.number(row[low], 3)} to {base.number(row[high], 3)}"


def _places(row: Row, name: str, value: str) -> str:
    """Forces at strokes of the first extremes or jumps, and the number of the others."""
    each = [f"{base.number(x[value], 3)} at {base.number(x['stroke_mm'], 3)}" for x in row[name]]
    return base.join_first(each, row.get("places", len(each))) or "-"


_HALF_COLUMNS = (
    base.Column("recording", lambda row: row["name"]),
    base.Column("half", lambda row: f"{row['half']} {row['direction']}"),
    base.Column("stroke [mm]", lambda row: _range(row, "stroke_from_mm", "stroke_to_mm"), True),
    base.Column("force [N]", lambda row: _range(row, "force_least_N", "force_most_N"), True),
    base.Column("peak [N at mm]", lambda row: _places(row, "peaks", "force_N"), True),
    base.Column("valley [N at mm]", lambda row: _places(row, "valleys", "force_N"), True),
    base.Column("jump [N at mm]", lambda row: _places(row, "snaps", "jump_N"), True),
    base.Column("work [mJ]", lambda row: base.number(row["work_mJ"]), True),
    base.Column("loss", lambda row: "" if row["loss"] is None else base.percent(row["loss"]), True),
    base.Column("k at onset [N/m]", lambda row: base.number(row["stiffness_0_N_per_m"]), True),
    base.Column("k at end [N/m]", lambda row: base.number(row["stiffness_1_N_per_m"]), True),
    base.Column("noise [N]", lambda row: base.number(row["noise_N"], 2), True),
)


def _across(halves: Sequence[str]) -> tuple[base.Column, ...]:
    """A column for each of the first half cycles, after the names of their quantities."""
    each = (base.Column(one, lambda row, k=k: row[str(k)], True) for k, one in enumerate(halves))
    return (base.Column("half", lambda row: row["quantity"]), *each)


def _transposed(recordings: Sequence[Row]) -> list[dict[str, str]]:
    """A row for each quantity of the first half cycles; quantities without a text are left out."""
    halves = _halves(recordings)
    few = halves[:_SHOWN_HALVES]
    room = {"places": _PLACES.get(len(few), 1)}
    names = [*_HALF_COLUMNS[: len(recordings) > 1], *_HALF_COLUMNS[2:]]
    rows = [
        {
            "quantity": column.heading,
            **{str(k): column.cell(half | room) for k, half in enumerate(few)},
        }
        for column in names
    ]
    return [row for row in rows if any(row[str(k)] not in ("", "-") for k in range(len(few)))]


_PHASE: base.Schema = (
    base.Quantity("phase", head="phase", read="number", holds=int, left=False),
    base.Quantity("low", "mm", "from"),
    base.Quantity("high", "mm", "to"),
    base.Quantity("force_low", "N", "down at", missing=True),
    base.Quantity("force_high", "N", "up at", missing=True),
)


def _phases(measured: MeasuredElement) -> list[dict[str, float]]:
    rows: list[dict[str, float]] = []
    for number, (low, high) in enumerate(measured.phases):
        phase = measured.element.phases[number]
        forces = {"force_low": phase.force_low, "force_high": phase.force_high}
        rows.append({"number": number, "low": low, "high": high} | forces)
    return rows


_NUMBERS: base.Schema = (
    base.Quantity("noise", "N", "noise"),
    base.Quantity("error_band", "N", "error band"),
    base.Quantity("friction", "N", "friction"),
    base.Quantity("smallest_drop", "N", "smallest drop that is seen"),
    base.Quantity("approach", "mm", "travel without contact"),
)


def element_schema(shape: DesignShape) -> base.Schema:
    """Schema of a measured element in the units of its measure."""
    schema = (
        *keys(data_sha256={str: str}, name=(str, "element.name"), half=str),
        base.Quantity("phases", read=_phases, holds=[_PHASE]),
        *_NUMBERS,
        *keys(resolution=("N", "step"), correlated_rows=(int, "correlated"), outliers=int),
        *keys(rows=int, notes=[str]),
    )
    return base.in_measure(schema, shape.measure)


def measured_element_account(measured: MeasuredElement, about: About) -> Account:
    """Phases of a measured element, and what limits their accuracy."""
    halves = "loading and unloading" if measured.half == "both" else f"{measured.half} only"
    measure = measured.element.measure
    schema, phase = (base.in_measure(one, measure) for one in (_NUMBERS, _PHASE))
    numbers = zip(schema, texts(schema, measured), strict=True)
    facts = (
        *(Fact(base.headed(q.head), text) for q, text in numbers if getattr(measured, q.attribute)),
        Fact("Rows", f"{measured.rows}, {halves}"),
    )
    band = (
        ERROR_BAND,
        "Friction is Coulomb friction: half the difference between loading and unloading.",
        "Between the phases the curve is known only if the machine prescribed the "
        f"{measure.travel}.",
    )
    columns = (
        f"Up at, down at: {measure.force}s at which a phase snaps to the next and to the previous "
        f"one."
    )
    if len(measured.phases) == 1:
        columns = ""
    sections = {
        "Phases": (RecordTable(phase, "phases", more="phases", level=CARD), Text(columns)),
        "Notes": Notes(measured.notes),
        "Curve": Picture("element", "The curve over the points, its phases numbered"),
        "Assumptions": Notes(band),
    }
    title = f"Element {measured.element.name}"
    return Account(measured, title, "lab.element/1", f"{measured}", facts, sections)
