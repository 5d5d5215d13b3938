"""A design that was found: what to build, how surely it works; or why there is none."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from stepwell.accounts.account import (
    Account,
    Level,
    Part,
    Picture,
    Section,
    Table,
    Text,
)
from stepwell.accounts.chain import BAND, actuator_schema, cell_columns, cell_schema, named
from stepwell.accounts.head import About
from stepwell.accounts.run import cycle_facts
from stepwell.accounts.shape import Shape
from stepwell.accounts.tolerances import FORCE_PLANE, counted_facts
from stepwell.accounts.words import LONGEST_IN_A_LINE, assumed, cells_of
from stepwell.accounts.yields import advised, critical_fact, inner_yield_schema, other_outcomes
from stepwell.base import Quantity, Schema, in_measure, record
from stepwell.design import Impossible

if TYPE_CHECKING:
    from stepwell.design import Design, Robustness

# More states than these are not read in a line.
_MOST_STATES = 16


def design_schema(shape: Shape) -> Schema:
    """What is reported of a design; where there is none, what is known of it has null."""
    found = (
        Quantity("sequence"),
        Quantity("loading_order", read="loading", holds=[int]),
        Quantity("unloading_order", read="unloading", holds=[int]),
        Quantity("state_count", read="reached.count", holds=int),
        Quantity("states", read=_states, holds=[str]),
        Quantity("states_whole", read="reached.whole", holds=bool),
        Quantity("states_how", read="reached.how"),
        Quantity("actuator", read="chain", holds=actuator_schema(shape)),
        Quantity("cells", read=lambda one: named(one.chain), holds=[built_schema(shape)]),
        Quantity("holes", "mm"),
        Quantity("candidates", holds=int),
        Quantity("robustness", holds=_ROBUSTNESS),
        Quantity("yield", read="yield_", holds=inner_yield_schema(shape)),
        Quantity("assumptions"),
    )
    return (
        Quantity("title", read=lambda one: "" if _none(one) else one.chain.title),
        Quantity("possible", read=lambda one: not _none(one), holds=bool),
        Quantity("proved", holds=bool),
        Quantity("reason", read=lambda one: str(one) if _none(one) else one.method),
        *(_if(q, found=True) for q in found),
        *(_if(q, found=False) for q in in_measure(_GAPS, shape.measure)),
    )


_GAPS: Schema = (Quantity("largest_gap", "N"), Quantity("gap_needed", "N"))
_ROBUSTNESS: Schema = (
    Quantity("radius", "mm"),
    Quantity("share", holds=float),
    Quantity("limit"),
    Quantity("meet", read=lambda one: one.meeting and one.meeting[1:3], holds=[int], missing=True),
    Quantity("while", read=lambda one: one.meeting and one.meeting.way, missing=True),
)


def _none(value: Design | Impossible) -> bool:
    return isinstance(value, Impossible)


def _if(quantity: Quantity, *, found: bool) -> Quantity:
    """A quantity of a design that was found, or of the reason why there is none; None else."""

    def read(value: Design | Impossible) -> Any:
        return None if _none(value) == found else quantity.of(value)

    return replace(quantity, read=read, missing=True)


def _states(found: Design) -> tuple[str, ...] | None:
    return found.states if len(found.chain) <= LONGEST_IN_A_LINE else None


def built_schema(shape: Shape) -> Schema:
    """What has to be built: anchors and the band of each cell, or scales of elements."""
    if shape.elements:
        return (*cell_schema(shape), *map(_of_cell, _SCALES))
    name, p, q, *band = BAND
    forces = [one for one in cell_schema(shape) if one.key in ("F0_N", "F1_N")]
    # What can be chosen stands before what is given.
    return (name, *map(_of_band, (q, p, *band)), *map(_of_cell, _LEVER), *forces)


_SCALES: Schema = (
    Quantity("force_scale", head="force scale", holds=float, left=False),
    Quantity("travel_scale", head="travel scale", holds=float, left=False),
)
_LEVER: Schema = (Quantity("lever", "mm", "lever"), Quantity("limit", "deg"))


def _of_cell(quantity: Quantity) -> Quantity:
    return replace(quantity, read=lambda one: quantity.of(one.cell))


def _of_band(quantity: Quantity) -> Quantity:
    return replace(quantity, read=lambda one: quantity.of(one.cell.bands[0]))


def impossible_account(value: Impossible, about: About | None = None) -> Account:
    """What is reported where there is no such design."""
    return Account(
        value=value,
        title="No such design",
        kind="design/2",
        schema=design_schema(Shape(value.measure)),
        answer=str(value),
        origin="This is proved." if value.proved else "A search found none; that is no proof.",
        about=about or About(),
    )


def robustness_account(value: Robustness, about: About | None = None) -> Account:
    """What a notebook shows of a robustness."""
    return Account(value=value, title="Robustness", answer=str(value))


def design_account(found: Design, about: About | None = None) -> Account:
    """What is reported of a design."""
    chain = found.chain
    about = about or About(chain)
    spelled = len(chain) <= LONGEST_IN_A_LINE
    return Account(
        value=found,
        title=chain.title or "A design",
        kind="design/2",
        schema=design_schema(Shape.of(chain)),
        origin=f"Found by search. {cells_of(chain)}.",
        answer=found.sequence if spelled else f"{len(chain)} cells in the target order",
        about=about,
        seed=found.yield_.seed,
        facts=(
            *counted_facts(found.yield_),
            critical_fact(found.yield_),
            *(replace(fact, level=Level.PAGE) for fact in cycle_facts(found.cycle)),
        ),
        warnings=[advised(found.yield_)],
        sections=(
            _cells(found),
            Section("Robustness", lambda: [Text(str(found.robustness or ""))], Level.TERMINAL),
            Section("Reachable states", lambda: _reachable(found), Level.TERMINAL),
            Section(
                "Outcomes of the samples",
                [Picture("force-plane", FORCE_PLANE), other_outcomes(found.yield_)],
            ),
            Section("Method", [Text(found.method, Level.CARD)]),
            assumed(chain, found.assumptions),
        ),
    )


def _cells(found: Design) -> Section:
    schema = built_schema(Shape.of(found.chain))
    table = Table(
        cell_columns(schema, found.chain),
        lambda: [record(schema, one) for one in named(found.chain)],
        "" if found.chain.elements else "p is the anchor on the inner block, q on the outer block.",
        most=None,
        more="cells",
        level=Level.CARD,
    )
    return Section("Cells, innermost first", [table])


def _reachable(found: Design) -> list[Part]:
    reached, states = found.reached, _states(found)
    listed = f"{reached.count} states" + " surely" * (not reached.whole)
    if states is not None:
        listed += f": {', '.join(states[:_MOST_STATES])}"
        left = len(states) - _MOST_STATES
        listed += f" and {left} more" * (left > 0)
    more = "" if reached.whole else f"more states may be reachable: {reached.how}"
    return [Text(listed), Text(more)]
