"""A chain, its cells and its actuator."""

import math
from dataclasses import replace
from typing import Any

from stepwell.accounts.head import About, DesignShape, Row, of_class, recorded
from stepwell.accounts.parts import CARD, FULL, Account, Fact, RecordTable, Sections
from stepwell.accounts.words import actuator_words, cells_of
from stepwell.base import Columns, Quantity, Schema, counted, in_measure, read_off, record
from stepwell.mechanism import Cell, Chain, Element

# By whether it stops at the low and at the high end.
_ENDS = ("none", "at the high end"), ("at the low end", "both")
_STABLE = "one state", "both states"
ERROR_BAND = (
    "error band: in about 95 % of simulated curves with white noise the whole curve is within it."
)
_LEVER: Schema = (
    Quantity("name", head="cell"),
    Quantity("F0", "N", "F0", "force_0"),
    Quantity("F1", "N", "F1", "force_1"),
    Quantity("F0", "over_kr", "F0/(kr)", lambda cell: cell.force_0 / _force_scale(cell)),
    Quantity("F1", "over_kr", "F1/(kr)", lambda cell: cell.force_1 / _force_scale(cell)),
    Quantity("full_travel", "mm", "travel"),
    Quantity("peak_angle", "deg", "peak"),
    Quantity("barrier", "mJ"),
    Quantity("bistable", "", "stable", "is_bistable", _STABLE.__getitem__, holds=bool, left=True),
)
_MOBILITY = Quantity("mobility", head="mobility", holds=float, left=False)


def _force_scale(cell: Cell) -> float:
    """k r [N], with k of the stiffest band: the forces of a cell are compared with it."""
    return max(band.stiffness for band in cell.bands) * cell.lever


def named(chain: Chain) -> list[Row]:
    """The cells of a chain and their names, innermost first."""
    return [{"name": n, "cell": cell} for n, cell in zip(chain.names, chain.cells, strict=True)]


def actuator_schema(shape: DesignShape) -> Schema:
    """What the actuator prescribes, and its stiffness."""

    def control(chain: Chain) -> str:
        stiffness = chain.actuator_stiffness
        return "stroke" if math.isinf(stiffness) else "spring" if stiffness else "force"

    stiffness = Quantity("stiffness", "N/m", read="actuator_stiffness")
    return in_measure((Quantity("control", read=control), stiffness), shape.measure)


def cell_schema(shape: DesignShape) -> Schema:
    """What is reported of a cell, read from a row of `named`.

    In a mixed chain cells with levers have the quantities of elements too.
    """
    if not shape.elements:
        name, *rest = (*_LEVER, _MOBILITY)
        return name, *read_off(rest, "cell")
    name, *rest = _element(shape)
    names = {quantity.key for quantity in (name, *rest)}
    levers = [quantity for quantity in _LEVER if quantity.key not in names]
    # Tables of mixed chains have no column for a quantity of levers alone.
    alone = [replace(one, head="") for one in of_class(Cell, levers)] if shape.levers else ()
    return in_measure((name, *read_off((*rest, *alone), "cell")), shape.measure)


def _element(shape: DesignShape) -> Schema:
    def whole(name: str, head: str, read: Any) -> Quantity:
        return Quantity(name, "", head, read, holds=int, left=False)

    def forces(name: str, head: str, read: Any) -> Quantity:
        return Quantity(name, "N", head, read, holds=[float])

    def stable(cell: Cell | Element) -> list[int]:
        phases = enumerate(cell.phases)
        return [k for k, phase in phases if phase.force_low < 0.0 < phase.force_high]

    return (
        Quantity("name", head="cell"),
        whole("phases", "phases", lambda cell: len(cell.phases)),
        whole("sheets", "sheets" * shape.folds, lambda cell: len(getattr(cell, "laws", (cell,)))),
        forces("force_up", "up at", lambda cell: [one.force_high for one in cell.phases[:-1]]),
        forces("force_down", "down at", lambda cell: [one.force_low for one in cell.phases[1:]]),
        Quantity("travel_low", "mm", "from", "low"),
        Quantity("travel_high", "mm", "to", "high"),
        Quantity("full_travel", "mm"),
        Quantity("stopped", head="stops", form=lambda at: _ENDS[at[0]][at[1]], holds=[bool]),
        _MOBILITY,
        Quantity("error_band", "N", "±", lambda cell: getattr(cell, "error_band", 0.0)),
        Quantity("bistable", read="is_bistable", holds=bool),
        # The phases that hold without any force.
        Quantity("stable", head="stable in", read=stable, holds=[int], left=True),
    )


def cell_columns(schema: Schema, chain: Chain) -> Columns:
    """The columns of a table of cells, without those that have the same in every row."""
    useful = {
        "mobility": len({cell.mobility for cell in chain.cells}) > 1,
        "error_band": any(element.error_band for element in chain.elements),
    }
    return [quantity for quantity in schema if useful.get(quantity.name, True)]


def cell_section(chain: Chain) -> Sections:
    """The cells of a chain, and the bands of those that have levers."""
    schema = cell_schema(DesignShape.of(chain))
    about = (
        "F0 and F1 are the forces along travel at state 0 and state 1, k the stiffness of the "
        "cell's stiffest band, r its lever, the peak θmax, where its energy is largest."
    )
    if chain.elements:
        travel, _, force = chain.measure.words
        about = (
            f"A phase is a stretch of {travel} in which a cell is stable under a prescribed "
            f"{force}; at these {force}s it snaps up to the next phase and back down. It is stable "
            f"in the phases that hold without any {force}."
        )
        if any(element.error_band for element in chain.elements):
            about += f" ±: the {ERROR_BAND}"
    rows = recorded(schema, named(chain))
    cells = RecordTable(cell_columns(schema, chain), rows, about, more="cells", level=CARD)
    return {"Cells, innermost first": (cells, _band_table(chain))}


def _band_table(chain: Chain) -> RecordTable:
    rows = [
        {"name": name, "band": band}
        for name, cell in zip(chain.names, chain.cells, strict=True)
        for band in getattr(cell, "bands", ())
    ]
    about = "Bands: p is the anchor on the inner block, q on the outer block."
    schema = (BAND[0], *read_off(BAND[1:], "band"))
    return RecordTable(schema, recorded(schema, rows), about, more="bands", level=FULL)


def _point(at: list[float]) -> str:
    return ", ".join(f"{round(v, 3) + 0.0:.6g}" for v in at)


BAND: Schema = (
    Quantity("name", head="cell"),
    Quantity("p", "mm", "p", form=_point, holds=[float]),
    Quantity("q", "mm", "q", form=_point, holds=[float]),
    Quantity("stiffness", "N/m", "k"),
    Quantity("rest_length", "mm", "l0"),
)


def label_of(quantity: Quantity) -> str:
    """The label of a fact that is one number of a record."""
    return quantity.head or quantity.name.replace("_", " ")


def with_sign(quantity: Quantity, value: Any) -> str:
    """What a record holds of a quantity, with its unit; "" where there is none."""
    text = quantity.text(value)
    return f"{text} {quantity.sign}".strip() if text else ""


def texts(schema: Schema, value: Any) -> list[str]:
    """The quantities of a value, each with its unit; "" where there is none."""
    row = record(schema, value)
    return [with_sign(quantity, row[quantity.key]) for quantity in schema]


def chain_account(value: Chain, about: About) -> Account:
    """What a notebook shows of a chain."""
    title = value.title or f"Chain of {counted(len(value), 'cell')}"
    origin = f"{cells_of(value)}. {actuator_words(value)}"
    return Account(value, title, origin=origin, sections=cell_section(value))


def cell_account(value: Cell | Element, about: About) -> Account:
    """What a notebook shows of a cell."""
    chain = Chain([value])
    schema = [quantity for quantity in cell_schema(DesignShape.of(chain))[1:] if quantity.head]
    numbers = zip(schema, texts(schema, named(chain)[0]), strict=True)
    facts = [Fact(label_of(quantity), text) for quantity, text in numbers]
    name = f"{type(value).__name__} {value.name}".strip()
    bands = {"Bands": replace(_band_table(chain), level=CARD)} if isinstance(value, Cell) else {}
    return Account(value, name, facts=facts, sections=bands)


element_account = cell_account
