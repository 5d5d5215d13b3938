"""Designs that a search returned or changed: what to build, and the yield."""

import math
from dataclasses import replace
from operator import itemgetter
from typing import Any

from stepwell import base
from stepwell.accounts import run, yields
from stepwell.accounts.chain import BAND, actuator_schema, cell_columns, cell_schema, named
from stepwell.accounts.head import About, DesignShape, keys, of_class, recorded
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Picture, RecordTable, Text
from stepwell.accounts.words import LONGEST_IN_A_LINE, assumed, cells_of
from stepwell.base import Quantity, Schema, amount, join_first, number, signed, to_unit
from stepwell.design import Design, Impossible, Reprogramming, TappedDesign

# More states than these are not read in a line.
_MOST_STATES = 16
# More anchors than these are not read in a line.
_MOST_ANCHORS = 2
_ROBUSTNESS: Schema = (
    *keys(radius="mm", fraction=float, limit=str),
    Quantity("meet", read=lambda one: one.meeting and one.meeting[1:3], holds=[int], missing=True),
    Quantity("while", read=lambda one: one.meeting and one.meeting.way, missing=True),
)
_SCALES: Schema = (
    Quantity("force_scale", head="force scale", holds=float, left=False),
    Quantity("travel_scale", head="travel scale", holds=float, left=False),
)
_LEVER: Schema = (Quantity("lever", "mm", "lever"), Quantity("limit", "deg"))
# The type of band of a cell, and the number of its bands.
_BANDS: Schema = (
    *keys(name=(str, lambda one: one[0].name), count=(int, itemgetter(1))),
    Quantity("stiffness", "N/m", read=lambda one: one[0].stiffness),
    Quantity("rest_length", "mm", read=lambda one: one[0].rest_length),
)
_HOLES = Picture("holes", "The plates of each cell with p, q and the holes, origin and axes")
# Tables have every k-th place of a displacement.
_EVERY = 5
_PLACE: Schema = (
    *keys(fraction=(float, itemgetter(0))),
    Quantity("at", "mm", read=itemgetter(1), holds=[float]),
    Quantity("force_at_0", "N", "at state 0", itemgetter(2)),
    Quantity("force_at_1", "N", "at state 1", itemgetter(3)),
    Quantity("largest_force", "N", "largest", itemgetter(4)),
)

_TWO_DRIVES = (
    "Both actuators prescribe positions, so the cells within and beyond the tap do not act on each "
    "other. The engine follows the stroke of each side from step to step: the tap's position, and "
    "the end's less the tap's. A second actuator at the inner end would add a translation only."
)
_STEP: Schema = (
    Quantity("state", head="state", read=lambda row: row[0]),
    Quantity("tap", "mm", "tap", lambda row: row[1][0], left=False),
    Quantity("end", "mm", "end", lambda row: row[1][1], left=False),
)


def design_schema(shape: DesignShape) -> Schema:
    """What is reported of a design; an impossible one has null for most of it."""
    built = (
        *keys(sequence=str, loading_order=([int], "loading"), unloading_order=([int], "unloading")),
        *keys(state_count=(int, "reached.count"), states=([str], _states)),
        *keys(states_whole=(bool, "reached.whole"), states_how=(str, "reached.how")),
        *keys(actuator=(actuator_schema(shape), "chain")),
        *keys(cells=([built_schema(shape)], lambda one: named(one.chain)), bands=[_BANDS]),
        *(_of_grid(*one) for one in (("holes", "pitch", float), ("origin", "origin", [float]))),
        *keys(off_grid=str, candidates=int, robustness=_ROBUSTNESS),
        Quantity("yield", read="yield_", holds=yields.inner_yield_schema(shape)),
        Quantity("assumptions"),
    )
    gaps = base.in_measure(keys(largest_gap="N", gap_needed="N"), shape.measure)
    return (
        *keys(title=(str, lambda one: one.chain.title if isinstance(one, Design) else "")),
        *keys(possible=(bool, lambda one: isinstance(one, Design)), proved=bool),
        *keys(reason=(str, lambda one: one.method if isinstance(one, Design) else str(one))),
        *of_class(Design, built),
        *of_class(Impossible, gaps),
    )


def _of_grid(name: str, part: str, holds: Any) -> Quantity:
    """A length of the grid of holes; None without holes."""
    return Quantity(
        name,
        "mm",
        read=lambda one: one.holes and getattr(one.holes, part),
        holds=holds,
        missing=True,
    )


def _origin(design: Design) -> str:
    """The origin and axes of the anchors, and the distance of the holes."""
    if design.chain.elements:
        return ""
    grid, apart = design.holes, ""
    if grid is not None:
        through = [grid.shifted] * bool(grid.shifted)
        apart = ", ".join([f"{amount(grid.pitch, 'm')} apart", *through, ""])
    axes = "x across to the outer block, y along the stroke"
    return f"{apart}origin in the middle of the joints; {axes}"


def _states(design: Design) -> tuple[str, ...] | None:
    return design.states if len(design.chain) <= LONGEST_IN_A_LINE else None


def built_schema(shape: DesignShape) -> Schema:
    """What has to be built: anchors and the band of each cell, or scales of elements."""
    if shape.elements:
        return (*cell_schema(shape), *base.read_off(_SCALES, "cell"))
    name, p, q, *band = BAND
    forces = [one for one in cell_schema(shape) if one.key in ("F0_N", "F1_N")]
    # Chosen numbers are before given ones.
    first = [
        replace(one, read=lambda it, q=one: q.of(it["cell"].bands[0])) for one in (q, p, *band)
    ]
    return (name, *first, *base.read_off(_LEVER, "cell"), *forces)


def impossible_account(value: Impossible, about: About) -> Account:
    """What is reported if a search returns no design."""
    proved = "This is proved." if value.proved else "A search found none; that is no proof."
    schema = design_schema(DesignShape(value.measure))
    return Account(value, "No such design", "design/2", str(value), origin=proved, schema=schema)


def design_account(design: Design, about: About) -> Account:
    """What is reported of a design."""
    chain, sampled = design.chain, design.yield_
    facts = (
        *yields.counted_facts(sampled),
        yields.critical_fact(sampled),
        Fact("Snaps", _no_snaps(design)),
        Fact("Bands by cell", design.bands_used),
        Fact("Holes" if design.holes else "Axes", _origin(design)),
        Fact("Off the grid", design.off_grid),
        Fact("Cycle", run.cycle_words(design.cycle), FULL),
        *(replace(fact, level=FULL) for fact in run.cycle_facts(design.cycle)),
    )
    built = built_schema(DesignShape.of(chain))
    columns, rows = cell_columns(built, chain), recorded(built, named(chain))
    anchors = "" if chain.elements else "p is the anchor on the inner block, q on the outer block."
    cells = RecordTable(columns, rows, anchors, more="cells", level=CARD)

    def reachable() -> str:
        reached, states = design.reached, _states(design)
        text = f"{reached.count} states" + " at least" * (not reached.whole)
        text += "" if states is None else f": {join_first(states, _MOST_STATES)}"
        return text + f"; there may be more: {reached.how}" * (not reached.whole)

    sections = {
        "Cells, innermost first": (cells, _HOLES),
        "Robustness": Text(lambda: str(design.robustness or "")),
        "Reachable states": Text(reachable),
        "Outcomes of the samples": (yields.PICTURES[1], yields.other_outcomes(sampled)),
        "Method": Text(design.method, CARD),
        **assumed(chain, design.assumptions),
    }
    spelled = len(chain) <= LONGEST_IN_A_LINE
    target = design.sequence if spelled else f"{len(chain)} cells in the target order"
    answer = f"{target}, yield {base.percent(sampled.fraction)}"
    if len(chain) <= _MOST_ANCHORS and not chain.elements:
        anchors = (f"{row['name']} q ({BAND[2].cell(row)}) mm" for row in rows())
        answer += f": {', '.join(anchors)}"
    title, origin = chain.title or "A design", f"Found by search. {cells_of(chain)}."
    warned, seed = [yields.advised(sampled)], sampled.seed
    return Account(design, title, "design/2", answer, facts, sections, warned, origin, seed=seed)


def _no_snaps(design: Design) -> str:
    """The reason and a way out if no cell of a design can snap."""
    chain = design.chain
    if chain.elements or design.cycle.snaps or any(cell.is_bistable for cell in chain.levers):
        return ""
    first = "-".join(str(cell + 1) for cell in design.loading)
    other = f"; for snaps, try {first}/{first}" * (design.loading != design.unloading)
    return f"none: no cell is bistable{other}"


def reprogram_schema(shape: DesignShape) -> Schema:
    """What is reported of a reprogramming; the units of other changes have null."""
    force = shape.measure.force_unit
    anchors = _change_schema("mm", "m", [float])
    scales = (*_change_schema("", "1"), *_change_schema(base.display_unit(force)[0], force))
    work = keys(work_at_0=("mJ", "work_0"), work_at_1=("mJ", "work_1"))
    return (
        *keys(title=(str, "chain.title"), by=str, target=str | None),
        *keys(possible=(bool, lambda change: math.isfinite(change.distance)), before=str),
        *keys(after=(str | None, lambda change: change.after or None)),
        *(anchors if shape.levers else ()),
        *(scales if shape.elements else ()),
        *keys(reach="mm", method=str, resolution=str),
        *base.read_off((*keys(largest_force=("N", "largest")), *work), "resistance"),
        *keys(way=([_PLACE], _places)),
    )


def _change_schema(unit: str, si: str, holds: Any = float) -> Schema:
    """Size, direction and end of a change; None where its unit is not `si`."""

    def of(name: str, holds: Any, missing: bool = True) -> Quantity:
        def read(change: Reprogramming) -> Any:
            return getattr(change, name) if change.unit == si else None

        return Quantity(name, unit, read=read, holds=holds, missing=missing)

    return of("distance", float, False), of("displacement", holds), of("place", holds)


def _places(change: Reprogramming) -> list[tuple[Any, ...]]:
    pull = change.resistance
    # A rounding error has no sign.
    at = zip(change.along(0) + 0.0, change.along(1) + 0.0, strict=True)
    return [*zip(pull.fraction, at, pull.force_0, pull.force_1, pull.peak, strict=True)]


def reprogramming_account(change: Reprogramming, about: About) -> Account:
    """What is reported of a reprogramming."""
    chain, target = change.chain, change.target or "another sequence"
    facts = [
        Fact("Target", change.target or "any other sequence"),
        Fact("Sequence now", change.before),
    ]
    tables = []
    if math.isinf(change.distance):
        up_to = f"displacement of {change.by} up to {amount(change.reach, 'm')}"
        tried = f"value of {change.by} that was tried" if math.isinf(change.reach) else up_to
        answer = f"No {tried} gives {target}"
    # At a tie any change at all decides: then the sequence past it is another one.
    elif change.distance == 0 and change.after == change.before:
        answer = f"The nominal design has the sequence {change.before} already"
    else:
        moved, more = _change_facts(change)
        answer = f"{change.by} {moved} gives {change.after}"
        facts += [Fact("Sequence past it", change.after), *more]
        tables = [_force_table(change)]
    facts.append(Fact("Method", str(change.method)))
    searched = f"searched, not exact: {change.resolution}" if change.resolution else ""
    sections = {"Force against the displacement": tables, **assumed(chain, searched)}
    title, origin = chain.title or "Reprogramming", f"{cells_of(chain)}."
    return Account(change, title, "reprogram/2", answer, facts, sections, origin=origin)


def _change_facts(change: Reprogramming) -> tuple[str, list[Fact]]:
    """The change in a few words, its numbers, and what resists it."""
    by, place = change.displacement, change.place
    if not (isinstance(by, tuple) and isinstance(place, tuple)):
        factor = base.display_unit(change.unit)[1]
        to = amount(place, change.unit).removesuffix(" 1")  # type: ignore[arg-type]
        sign = signed(by * factor)  # type: ignore[operator]
        return f"changed to {to}", [Fact("Change", f"{change.by} to {to} ({sign})")]
    move = ", ".join(signed(to_unit(one, "mm")) for one in by)
    to = ", ".join(number(to_unit(one, "mm")) for one in place)
    pull, far = change.resistance, amount(change.distance, "m")
    work_0, work_1 = amount(pull.work_0, "J"), amount(pull.work_1, "J")
    return f"moved by more than {far}", [
        Fact("Displacement", f"{change.by} by ({move}) mm, {far}, to ({to}) mm"),
        Fact("Force", f"up to {amount(pull.largest, 'N')} against the displacement"),
        Fact("Work", f"{work_0} at state 0 of the cell, {work_1} at state 1"),
    ]


def _force_table(change: Reprogramming) -> RecordTable:
    distance = to_unit(change.distance, "mm")
    columns = (
        base.Column("moved [mm]", lambda row: number(row["fraction"] * distance), True),
        base.Column("Δx [mm]", lambda row: number(row["at_mm"][0]), True),
        base.Column("Δy [mm]", lambda row: number(row["at_mm"][1]), True),
        *_PLACE[2:],
    )
    about = (
        "The force along the displacement; a positive force resists. Every "
        f"{_EVERY}th place of the displacement is listed."
    )
    return RecordTable(columns, recorded(_PLACE, _places(change)[::_EVERY]), about)


def tapped_design_schema(shape: DesignShape) -> Schema:
    """What is reported of a chain with two actuators."""
    sampled = yields.inner_yield_schema(shape)
    return (
        *keys(title=(str, "chain.title"), walk=[str], tap=int),
        Quantity("yield", read="fraction", holds=float),
        *keys(inner_yield=(sampled, "inner.yield_"), outer_yield=(sampled, "outer.yield_")),
        *keys(cells=([built_schema(shape)], lambda one: named(one.chain))),
        *keys(bands=([_BANDS], lambda one: [*one.inner.bands, *one.outer.bands])),
        *keys(positions=([_STEP], _steps)),
        Quantity("one_actuator", read="single", holds=str),
        *keys(proved=bool),
    )


def _steps(made: TappedDesign) -> list[tuple[str, tuple[float, float]]]:
    return [*zip(made.walk, made.positions.tolist(), strict=True)]


def tapped_design_account(made: TappedDesign, about: About) -> Account:
    """What is reported of a chain with two actuators."""
    chain, tap = made.chain, made.tap
    single = made.single or "one actuator can follow this walk too"
    proved = "; this is proved" * made.proved
    sides = (("within", made.inner), ("beyond", made.outer))
    facts = (
        Fact("Tap", f"holds the block between cells {tap} and {tap + 1}"),
        Fact("One actuator", f"{single}{proved}"),
        *(Fact(f"Yield {side} the tap", base.percent(one.yield_.fraction)) for side, one in sides),
        *(Fact(f"Bands {side} the tap", one.bands_used) for side, one in sides),
        Fact("Full stroke", amount(chain.full_stroke, "m")),
    )
    built = built_schema(DesignShape.of(chain))
    columns, rows = cell_columns(built, chain), recorded(built, named(chain))
    anchors = "p is the anchor on the inner block, q on the outer block."
    steps = RecordTable(
        _STEP,
        recorded(_STEP, _steps(made)),
        "Positions of both actuators.",
        more="states",
        level=CARD,
    )
    sections = {
        "Positions": steps,
        "Cells, innermost first": RecordTable(columns, rows, anchors, more="cells", level=CARD),
        "Drive": Text(_TWO_DRIVES),
        **assumed(chain),
    }
    answer = f"tap after cell {tap}, yield {base.percent(made.fraction)}"
    origin = f"Found by search. {cells_of(chain)}."
    return Account(made, chain.title, "tapped_design/1", answer, facts, sections, origin=origin)
