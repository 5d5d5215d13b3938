"""A chain, its cells and its actuator."""

import math
from dataclasses import replace
from typing import Any, NamedTuple

from stepwell.accounts.head import About, Shape, of_class, recorded
from stepwell.accounts.parts import CARD, PAGE, Account, Fact, RecordTable, Sections
from stepwell.accounts.words import actuator_words, cells_of
from stepwell.base import Columns, Quantity, Schema, counted, in_measure, read_off, record
from stepwell.mechanism import Cell, Chain, Element

# By whether it stops at the low and at the high end.
_ENDS = ("none", "at the high end"), ("at the low end", "both")
_LEVER: Schema = (
    Quantity("name", head="cell"),
    Quantity("F0", "N", "F0", "force_0"),
    Quantity("F1", "N", "F1", "force_1"),
    Quantity("F0", "over_kr", "F0/(kr)", lambda cell: cell.force_0 / force_scale(cell)),
    Quantity("F1", "over_kr", "F1/(kr)", lambda cell: cell.force_1 / force_scale(cell)),
    Quantity("full_travel", "mm", "travel"),
    Quantity("peak_angle", "deg", "peak"),
    Quantity("barrier", "mJ"),
    Quantity(
        "bistable",
        head="stable",
        read="is_bistable",
        form=lambda both: "both states" if both else "one state",
        holds=bool,
        left=True,
    ),
)
_MOBILITY = Quantity("mobility", head="mobility", holds=float, left=False)


class Named(NamedTuple):
    """A cell and its name in a chain."""

    name: str
    cell: Cell | Element


def named(chain: Chain) -> list[Named]:
    """The cells of a chain, innermost first."""
    return [Named(name, cell) for name, cell in zip(chain.names, chain.cells, strict=True)]


def force_scale(cell: Cell) -> float:
    """k r [N] of a cell, with k of its stiffest band: its forces are compared with it."""
    return max(band.stiffness for band in cell.bands) * cell.lever


def actuator_schema(shape: Shape) -> Schema:
    """What the actuator prescribes, and its stiffness."""
    stiffness = Quantity("stiffness", "N/m", read="actuator_stiffness")
    return in_measure((Quantity("control", read=_control), stiffness), shape.measure)


def _control(chain: Chain) -> str:
    stiffness = chain.actuator_stiffness
    return "stroke" if math.isinf(stiffness) else "spring" if stiffness else "force"


def cell_schema(shape: Shape) -> Schema:
    """What is reported of the cells of a chain; of a mixed one levers have what elements have too.

    It is read from what `named` makes.
    """
    if not shape.elements:
        name, *rest = (*_LEVER, _MOBILITY)
        return name, *read_off(rest, "cell")
    names = {quantity.key for quantity in _element(shape)}
    levers = [quantity for quantity in _LEVER if quantity.key not in names]
    # In tables of mixed chains what levers alone have is in no column.
    alone = [replace(one, head="") for one in of_class(Cell, levers)] if shape.levers else ()
    name, *rest = _element(shape)
    return in_measure((name, *read_off((*rest, *alone), "cell")), shape.measure)


def _sheets(cell: Cell | Element) -> int:
    return len(cell.laws) if isinstance(cell, Element) else 1


def _forces(name: str, head: str, read: Any) -> Quantity:
    return Quantity(name, "N", head, read, holds=[float])


def _element(shape: Shape) -> Schema:
    return (
        Quantity("name", head="cell"),
        Quantity(
            "phases", head="phases", read=lambda cell: len(cell.phases), holds=int, left=False
        ),
        Quantity("sheets", head="sheets" * shape.folds, read=_sheets, holds=int, left=False),
        _forces("force_up", "up at", lambda cell: [one.force_high for one in cell.phases[:-1]]),
        _forces("force_down", "down at", lambda cell: [one.force_low for one in cell.phases[1:]]),
        Quantity("travel_low", "mm", "from", "low"),
        Quantity("travel_high", "mm", "to", "high"),
        Quantity("full_travel", "mm"),
        Quantity("stopped", head="stops", form=lambda at: _ENDS[at[0]][at[1]], holds=[bool]),
        _MOBILITY,
        Quantity("error_band", "N", "±", lambda cell: getattr(cell, "error_band", 0.0)),
        Quantity("bistable", read="is_bistable", holds=bool),
        Quantity("stable", head="stable in", read=_stable, holds=[int], left=True),
    )


def _stable(cell: Cell | Element) -> list[int]:
    """The phases in which a cell can stand without any force."""
    return [k for k, one in enumerate(cell.phases) if one.force_low < 0.0 < one.force_high]


def cell_columns(schema: Schema, chain: Chain) -> Columns:
    """The columns of a table of cells, without those that have the same in every row."""
    useful = {
        "mobility": len({cell.mobility for cell in chain.cells}) > 1,
        "error_band": any(element.error_band for element in chain.elements),
    }
    return [quantity for quantity in schema if useful.get(quantity.name, True)]


def cell_section(chain: Chain) -> Sections:
    """The cells of a chain, and the bands of those that have levers."""
    schema = cell_schema(Shape.of(chain))
    about = (
        "F0 and F1 are the forces along travel at state 0 and state 1, k the stiffness of the "
        "cell's stiffest band, r its lever, the peak θmax, where its energy is largest."
    )
    if chain.elements:
        travel, _, force = chain.measure.words
        about = (
            f"A phase is a stretch of {travel} in which a cell is stable under a prescribed "
            f"{force}; at these {force}s it goes up to the next phase and back down. It is stable "
            f"in the phases that hold without any {force}."
        )
        if any(element.error_band for element in chain.elements):
            about += " ±: the largest deviation of measured points from the curve."
    rows = recorded(schema, named(chain))
    cells = RecordTable(cell_columns(schema, chain), rows, about, more="cells", level=CARD)
    return {"Cells, innermost first": (cells, band_table(chain))}


def band_table(chain: Chain) -> RecordTable:
    """The bands of all cells with levers."""
    about = "Bands: p is the anchor on the inner block, q on the outer block."
    rows = [
        (name, band) for name, cell in named(chain) if isinstance(cell, Cell) for band in cell.bands
    ]
    return RecordTable(
        BAND,
        lambda: [record(BAND, band, name=name) for name, band in rows],
        about,
        more="bands",
        level=PAGE,
    )


def _place(at: list[float]) -> str:
    return ", ".join(f"{round(v, 3) + 0.0:.6g}" for v in at)


BAND: Schema = (
    Quantity("name", head="cell"),
    Quantity("p", "mm", "p", form=_place, holds=[float]),
    Quantity("q", "mm", "q", form=_place, holds=[float]),
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


def chain_account(value: Chain, about: About) -> Account:
    """What a notebook shows of a chain."""
    title = value.title or f"Chain of {counted(len(value), 'cell')}"
    origin = f"{cells_of(value)}. {actuator_words(value)}"
    return Account(value, title, origin=origin, sections=cell_section(value))


def cell_account(value: Cell | Element, about: About) -> Account:
    """What a notebook shows of a cell."""
    chain = Chain([value])
    schema = cell_schema(Shape.of(chain))[1:]
    found = record(schema, named(chain)[0])
    facts = [Fact(label_of(q), with_sign(q, found[q.key])) for q in schema if q.head]
    if isinstance(value, Cell):
        bands = {"Bands": replace(band_table(chain), level=CARD)}
        return Account(value, f"Cell {value.name}".strip(), facts=facts, sections=bands)
    phases, words = counted(len(value.phases), "phase"), value.measure
    stable = f"stretches of {words.travel} that are stable under a constant {words.force}"
    title = f"Element {value.name}".strip()
    return Account(value, title, origin=f"{phases}: {stable}.", facts=facts)


element_account = cell_account
