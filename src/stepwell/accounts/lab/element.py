"""An element from a recording: its phases, friction, noise and error band."""

from stepwell import base
from stepwell.accounts.chain import ERROR_BAND, texts
from stepwell.accounts.head import About, keys
from stepwell.accounts.parts import CARD, Account, Fact, Notes, Picture, RecordTable, Text
from stepwell.lab import MeasuredElement

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
ELEMENT: base.Schema = (
    *keys(data_sha256={str: str}, name=(str, "element.name"), half=str),
    base.Quantity("phases", read=_phases, holds=[_PHASE]),
    *_NUMBERS,
    *keys(resolution=("N", "step"), correlated_rows=(int, "correlated"), outliers=int, rows=int),
    *keys(notes=[str]),
)


def measured_element_account(measured: MeasuredElement, about: About) -> Account:
    """Phases of a measured element, and what limits their accuracy."""
    halves = "loading and unloading" if measured.half == "both" else f"{measured.half} only"
    numbers = zip(_NUMBERS, texts(_NUMBERS, measured), strict=True)
    facts = (
        *(Fact(base.headed(q.head), text) for q, text in numbers if getattr(measured, q.attribute)),
        Fact("Rows", f"{measured.rows}, {halves}"),
    )
    band = (
        ERROR_BAND,
        "Friction is Coulomb friction: half the difference between loading and unloading.",
        "Between the phases the curve is known only if the machine prescribed the travel.",
    )
    columns = "Up at, down at: forces at which a phase snaps to the next and to the previous one."
    if len(measured.phases) == 1:
        columns = ""
    sections = {
        "Phases": (RecordTable(_PHASE, "phases", more="phases", level=CARD), Text(columns)),
        "Notes": Notes(measured.notes),
        "Curve": Picture("element", "The curve over the points, its phases numbered"),
        "Assumptions": Notes(band),
    }
    title, given = f"Element {measured.element.name}", {"data_sha256": about.data_sha256}
    return Account(measured, title, "lab.element/1", f"{measured}", facts, sections, given=given)
