"""An atlas: transition graphs of a space of designs, their frequency and their yield."""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from operator import itemgetter
from typing import Any

from stepwell.accounts.head import About, Row, keys, recorded
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Picture, RecordTable, Text
from stepwell.accounts.study import VARIED
from stepwell.base import Quantity, Schema, amount, counted, display_unit, number, plain, read_off
from stepwell.design import parameter
from stepwell.studies import Atlas, ClassBoundary, FullCycle, GraphClass, Varied

_GRAPH = keys(name=(str, itemgetter(0)), designs=(int, itemgetter(1)))
_SAMPLED = keys(asked=int, failed=int, graphs=([_GRAPH], lambda one: one.graph_classes.items()))
# Of graph classes and cycles: their most robust design among those drawn.
_DRAWN = keys(gap=("percent", "of.gap"), design=(int, "of.design"), values=[float])
_CLASS_BOUNDARY = keys(graph_class=str, parameter=str, unit=str, at=float, step=float, beyond=str)


def _unit_of(atlas: Atlas, name: str) -> tuple[str, float]:
    """The unit in which a parameter is reported, and its factor from SI."""
    unit = parameter(atlas.chain, name).unit
    return ("", 1.0) if unit == "1" else display_unit(unit)


def _space(atlas: Atlas) -> list[Varied]:
    units = ((one, *_unit_of(atlas, one.name)) for one in atlas.axes)
    return [Varied(one.name, unit, one.low * by, one.high * by) for one, unit, by in units]


def _drawn(atlas: Atlas, of: Iterable[GraphClass | FullCycle]) -> list[Row]:
    """Graph classes or cycles, each with the varied parameters of a design, in units of `space`."""
    names = [axis.name for axis in atlas.axes]
    read = [(parameter(atlas.chain, name).value, _unit_of(atlas, name)[1]) for name in names]
    drawn = ((one, [plain(value(one.chain), by) for value, by in read]) for one in of)
    return [{"of": one, "values": values} for one, values in drawn]


def _fraction(name: str, read: str) -> Schema:
    """Fraction of the designs, and the ends of its interval."""
    ends = {name: "estimate", f"{name}_low": "low", f"{name}_high": "high"}
    return tuple(Quantity(end, "percent", read=f"{read}.{what}") for end, what in ends.items())


_GRAPH_CLASS: Schema = (
    *keys(name=(str, "of.name"), cycle=(str, "of.cycle"), designs=(int, "of.fraction.times")),
    *_fraction("fraction", "of.fraction"),
    *_fraction("yield", "of.kept"),
    *_DRAWN,
    *read_off(keys(agrees=bool, states=int, reached=int, snaps=int, sub_loops=int), "of"),
    *read_off(keys(remembers=bool, scrambled=int, counts=int, counts_by_hand=int), "of"),
    *read_off(keys(gardens=int, latches=int), "of"),
)
_CYCLE: Schema = (
    *keys(sequence=(str, "of.sequence"), designs=(int, "of.fraction.times")),
    *_fraction("fraction", "of.fraction"),
    *_DRAWN,
)


def _unloading_order(graph_class: GraphClass) -> str:
    """The cells in the order in which they snap back, numbered as they load."""
    states = graph_class.cycle.split(">")
    steps = pairwise(states[len(states) // 2 :])
    cells = (next(k for k, cell in enumerate(a, 1) if cell != b[k - 1]) for a, b in steps)
    return " ".join(map(str, cells))


# Tables of graph classes and of cycles.
_CLASS_TABLE: Schema = (
    Quantity("name", head="name"),
    Quantity("back", head="back", read=_unloading_order),
    Quantity("fraction", "percent", "fraction", read="fraction.estimate"),
    Quantity("yield", "percent", "yield", read="kept.estimate"),
    Quantity("reached", head="reached", read=lambda m: f"{m.reached} of {m.states}", left=False),
    Quantity("memory", head="memory"),
)
_CYCLES: Schema = (Quantity("sequence", head="cycle"), _CLASS_TABLE[2])
ATLAS: Schema = (
    *keys(title=(str, "chain.title"), cells=(int, lambda atlas: len(atlas.chain)), drive=str),
    *keys(space=([VARIED], _space), designs=int, closed_form=int, not_proved=int, ties=int),
    *keys(wakes=int, tolerances=keys(anchor="mm", stiffness="percent", rest_length="percent")),
    *keys(graphs=(int, lambda atlas: len(atlas.graph_classes)), possible=int | None),
    *keys(space_proved=bool, whole=bool),
    Quantity("unseen_at_most", "percent", read=lambda one: one.unseen and one.unseen.high),
    *keys(checked=int, agreed=int, sampled=_SAMPLED, graph_classes=[_GRAPH_CLASS]),
    *keys(
        cycles=([_CYCLE], lambda atlas: _drawn(atlas, atlas.cycles)),
        class_boundaries=[_CLASS_BOUNDARY],
    ),
)


def atlas_account(
    atlas: Atlas,
    about: About,
    graph_classes: Sequence[GraphClass] | None = None,
    class_boundaries: Sequence[ClassBoundary] = (),
    query: str = "",
) -> Account:
    """Graph classes of an atlas, all or those that match a query: yields and boundaries."""
    graph_classes = atlas.graph_classes if graph_classes is None else graph_classes
    cycles = counted(len(atlas.cycles), "cycle")
    answer = f"{counted(len(atlas.graph_classes), 'graph')} and {cycles}"
    if query:
        matching = number(len(graph_classes)) if graph_classes else "none"
        answer = f"{query}: {matching} of the graphs in this atlas"
    rows, space = recorded(_CLASS_TABLE, graph_classes), recorded(VARIED, _space(atlas))
    full, within = recorded(_CYCLES, atlas.cycles), atlas.tolerances.most
    columns = (
        "Back: the cells in the order in which they snap back, numbered as they load. Yield: the "
        "fraction of samples of the most robust design with the same graph, within "
        f"{amount(within.anchor, 'm')} and {number(within.stiffness * 100)} % of stiffness."
    )
    ends = "All designs were drawn evenly between these ends."
    sections = {
        f"Graph classes, {'highest yield' if query else 'most frequent'} first": (
            Picture("graph_classes", "The most frequent graph classes, their fractions and yields"),
            RecordTable(_CLASS_TABLE, rows, more="graph classes", level=CARD),
        ),
        "Columns of the table": Text(columns if graph_classes else "", CARD),
        "Full cycles": RecordTable(_CYCLES, full, "The inner cell is the first.", level=FULL),
        "Varied parameters": RecordTable(VARIED, space, ends, level=FULL),
    }
    boundaries = [
        {**one._asdict(), "unit": unit or "1", "at": one.value * by, "step": one.step * by}
        for one, unit, by in ((one, *_unit_of(atlas, one.parameter)) for one in class_boundaries)
    ]
    classes = _drawn(atlas, graph_classes)
    given: dict[str, Any] = {"graph_classes": classes, "class_boundaries": boundaries}
    title = atlas.chain.title or f"Atlas of {counted(len(atlas.chain), 'cell')}"
    facts, options = () if query else _facts(atlas), {"packages": ["zarr"], "given": given}
    return Account(atlas, title, "atlas/2", answer, facts, sections, seed=atlas.seed, **options)


def _facts(atlas: Atlas) -> list[Fact]:
    unseen = "unknown for a single block of designs"
    if atlas.unseen is not None:
        most = number(atlas.unseen.high * 100)
        unseen = f"at most {most} % of designs have another graph, at 95 %"
    sampled, known = atlas.sampled, {one.name for one in atlas.graph_classes}
    others = (
        f"{atlas.designs - atlas.closed_form} designs; of a sample of {sampled.asked} the engine "
        f"finds {counted(len(sampled.graph_classes), 'graph')}, "
        f"{len(sampled.graph_classes.keys() - known) or 'none'} of them new"
    )
    varied = counted(len(atlas.axes), "parameter")
    drawn = f"{atlas.designs} drawn evenly, {atlas.closed_form} of them in closed form"
    return [
        Fact("Proved", _proved(atlas)),
        Fact("Unseen", "" if atlas.whole else unseen),
        Fact("Space", f"{len(atlas.chain)} cells driven by {atlas.drive}, {varied} varied"),
        Fact("Designs", drawn),
        Fact("Engine", f"the same graph for {atlas.agreed} of {atlas.checked} more designs"),
        Fact("Others", others if sampled.asked else ""),
    ]


def _proved(atlas: Atlas) -> str:
    if atlas.whole:
        return "no other graph occurs in this space, ties aside"
    cells = "every design" if atlas.space_proved else "not every design"
    of = "" if atlas.possible is None else f"; at most {atlas.possible} graphs can occur"
    return f"{cells} of the space has concave cells{of}"
