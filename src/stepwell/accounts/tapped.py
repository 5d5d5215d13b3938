"""Chains with two actuators: the positions of both at each state, and what to build."""

from stepwell.accounts.chain import cell_columns, named
from stepwell.accounts.design import built_schema
from stepwell.accounts.head import About, DesignShape, keys, recorded
from stepwell.accounts.parts import CARD, Account, Fact, RecordTable, Text
from stepwell.accounts.words import assumed, cells_of
from stepwell.accounts.yields import inner_yield_schema
from stepwell.base import Quantity, Schema, amount, percent
from stepwell.design import TappedDesign

_DRIVE = (
    "Both actuators prescribe positions, so the cells within and beyond the tap do not act on each "
    "other. The engine follows the stroke of each side from step to step: the tap's position, and "
    "the end's less the tap's. A second actuator at the inner end would add a translation only."
)
_STEP: Schema = (
    Quantity("state", head="state", read=lambda row: row[0]),
    Quantity("tap", "mm", "tap", lambda row: row[1][0], left=False),
    Quantity("end", "mm", "end", lambda row: row[1][1], left=False),
)


def tapped_design_schema(shape: DesignShape) -> Schema:
    """What is reported of a chain with two actuators."""
    sampled = inner_yield_schema(shape)
    return (
        *keys(title=(str, "chain.title"), walk=[str], tap=int),
        Quantity("yield", read="fraction", holds=float),
        *keys(inner_yield=(sampled, "inner.yield_"), outer_yield=(sampled, "outer.yield_")),
        *keys(cells=([built_schema(shape)], lambda one: named(one.chain))),
        *keys(positions=([_STEP], _rows)),
        Quantity("one_actuator", read="single", holds=str),
        *keys(proved=bool),
    )


def _rows(made: TappedDesign) -> list[tuple[str, tuple[float, float]]]:
    return [*zip(made.walk, made.positions.tolist(), strict=True)]


def tapped_design_account(made: TappedDesign, about: About) -> Account:
    """What is reported of a chain with two actuators."""
    chain, tap = made.chain, made.tap
    single = made.single or "one actuator can follow this walk too"
    proved = "; this is proved" * made.proved
    sides = zip(("within", "beyond"), (made.inner, made.outer), strict=True)
    facts = (
        Fact("Tap", f"holds the block between cells {tap} and {tap + 1}"),
        Fact("One actuator", f"{single}{proved}"),
        *(Fact(f"Yield {side} the tap", percent(one.yield_.fraction)) for side, one in sides),
        Fact("Full stroke", amount(chain.full_stroke, "m")),
    )
    built = built_schema(DesignShape.of(chain))
    columns, rows = cell_columns(built, chain), recorded(built, named(chain))
    anchors = "p is the anchor on the inner block, q on the outer block."
    steps = RecordTable(
        _STEP,
        recorded(_STEP, _rows(made)),
        "Positions of both actuators.",
        more="states",
        level=CARD,
    )
    sections = {
        "Positions": steps,
        "Cells, innermost first": RecordTable(columns, rows, anchors, more="cells", level=CARD),
        "Drive": Text(_DRIVE),
        **assumed(chain),
    }
    answer = f"tap after cell {tap}, yield {percent(made.fraction)}"
    origin = f"Found by search. {cells_of(chain)}."
    return Account(made, chain.title, "tapped_design/1", answer, facts, sections, origin=origin)
