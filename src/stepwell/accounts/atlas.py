"""An atlas: the graphs of a space of designs, how often they occur, how surely they are built."""

from collections.abc import Sequence
from itertools import pairwise
from operator import itemgetter
from typing import Any, NamedTuple

from stepwell.accounts.head import About, keys, recorded
from stepwell.accounts.parts import CARD, PAGE, Account, Fact, Picture, RecordTable, Text
from stepwell.accounts.study import VARIED
from stepwell.base import Quantity, Schema, amount, counted, display_unit, number, read_off
from stepwell.design import parameter
from stepwell.studies import Atlas, Border, Cycling, Machine, Varied

# Rows of the table on a terminal.
_ROWS = 15
_GRAPH = keys(name=(str, itemgetter(0)), designs=(int, itemgetter(1)))
_SAMPLED: Schema = (
    *keys(asked=int, failed=int),
    Quantity("graphs", read=lambda atlas: list(atlas.machines.items()), holds=[_GRAPH]),
)
# What machines and cycles have of the most robust design that was drawn of them.
_DRAWN = keys(gap=("percent", "of.gap"), design=(int, "of.design"), values=[float])
# Of a border, the unit in which it is reported, and how many of the unit make one in SI.
_BORDER: Schema = (
    *keys(machine=(str, lambda one: one[0].machine), parameter=(str, lambda one: one[0].parameter)),
    Quantity("unit", read=lambda one: one[1] or "1"),
    Quantity("at", read=lambda one: one[0].value * one[2], holds=float),
    Quantity("step", read=lambda one: one[0].step * one[2], holds=float),
    Quantity("beyond", read=lambda one: one[0].beyond),
)
_EVENLY = "All designs were drawn evenly between these ends."


class _Drawn(NamedTuple):
    """A machine or a cycle of an atlas, of which a design was drawn."""

    atlas: Atlas
    of: Machine | Cycling

    @property
    def values(self) -> list[float]:
        """What the space varies, of that design, in the order and the units of `space`."""
        chain, names = self.of.chain, [axis.name for axis in self.atlas.axes]
        values = (parameter(self.atlas.chain, name).value(chain) for name in names)
        factors = (_unit_of(self.atlas, name)[1] for name in names)
        return [float(a) * b for a, b in zip(values, factors, strict=True)]  # type: ignore[arg-type]


def _space(atlas: Atlas) -> list[Varied]:
    scaled = ((one, *_unit_of(atlas, one.name)) for one in atlas.axes)
    return [Varied(one.name, unit, one.low * by, one.high * by) for one, unit, by in scaled]


def _unit_of(atlas: Atlas, name: str) -> tuple[str, float]:
    """The unit in which a parameter is reported, and how many of it make one in SI."""
    unit = parameter(atlas.chain, name).unit
    return ("", 1.0) if unit == "1" else display_unit(unit)


def _share(name: str, read: str) -> Schema:
    """A fraction of the designs with its interval."""
    ends = {name: "share", f"{name}_low": "low", f"{name}_high": "high"}
    return tuple(Quantity(end, "percent", read=f"{read}.{what}") for end, what in ends.items())


_MACHINE: Schema = (
    *read_off(
        (
            *keys(name=str, cycle=str, designs=(int, "share.times")),
            *_share("share", "share"),
            *_share("yield", "kept"),
        ),
        "of",
    ),
    *_DRAWN,
    *read_off(
        (
            *keys(agrees=bool, states=int, reached=int, snaps=int, sub_loops=int, remembers=bool),
            *keys(scrambled=int, counts=int, counts_by_hand=int, gardens=int, latches=int),
        ),
        "of",
    ),
)
_CYCLE: Schema = (
    *keys(sequence=(str, "of.sequence"), designs=(int, "of.share.times")),
    *_share("share", "of.share"),
    *_DRAWN,
)


def _back(one: Machine) -> str:
    """The cells in the order in which they snap back, numbered as they load."""
    states = one.cycle.split(">")
    down = states[len(states) // 2 :]
    return " ".join(
        str(next(k for k in range(len(a)) if a[k] != b[k]) + 1) for a, b in pairwise(down)
    )


# The tables of machines and of cycles.
_MACHINES: Schema = (
    Quantity("name", head="name"),
    Quantity("back", head="back", read=_back),
    Quantity("share", "percent", "fraction", read="share.share"),
    Quantity("yield", "percent", "yield", read="kept.share"),
    Quantity("reached", head="reached", read=lambda m: f"{m.reached} of {m.states}", left=False),
    Quantity("memory", head="memory"),
)
_CYCLES: Schema = (Quantity("sequence", head="cycle"), _MACHINES[2])
# What is reported of an atlas.
ATLAS: Schema = (
    *keys(title=(str, "chain.title"), cells=(int, lambda atlas: len(atlas.chain)), drive=str),
    *keys(space=([VARIED], _space), designs=int, told=int, not_proved=int, ties=int, wakes=int),
    *keys(tolerances=keys(anchor="mm", stiffness="percent", rest_length="percent")),
    *keys(graphs=(int, lambda atlas: len(atlas.machines)), possible=int | None),
    *keys(space_proved=bool, whole=bool),
    Quantity("unseen_at_most", "percent", read=lambda one: one.unseen and one.unseen.high),
    *keys(checked=int, agreed=int, sampled=_SAMPLED, machines=[_MACHINE]),
    *keys(
        cycles=([_CYCLE], lambda atlas: [_Drawn(atlas, one) for one in atlas.cycles]),
        borders=[_BORDER],
    ),
)


def atlas_account(
    atlas: Atlas,
    about: About,
    machines: Sequence[Machine] | None = None,
    borders: Sequence[Border] = (),
    query: str = "",
) -> Account:
    """What is reported of an atlas: all machines or those that answer a query, and borders."""
    shown = atlas.machines if machines is None else machines
    cycles = counted(len(atlas.cycles), "cycle")
    answer = f"{counted(len(atlas.machines), 'graph')} and {cycles}"
    if query:
        matching = counted(len(shown), "machine") if shown else "no machine"
        answer = f"{query}: {matching} of this atlas"
    bordering = [(one, *_unit_of(atlas, one.parameter)) for one in borders]
    given: dict[str, Any] = {
        "machines": [_Drawn(atlas, one) for one in shown],
        "borders": bordering,
    }
    rows, space = recorded(_MACHINES, shown), recorded(VARIED, _space(atlas))
    full = recorded(_CYCLES, atlas.cycles)
    sections = {
        f"Machines, {'highest yield' if query else 'most frequent'} first": (
            Picture("machines", "The most frequent machines, their fractions and yields"),
            RecordTable(_MACHINES, rows, most=_ROWS, more="machines", level=CARD),
        ),
        "Columns of the table": Text(_defined(atlas) if shown else "", CARD),
        "Full cycles": RecordTable(_CYCLES, full, "The inner cell is the first.", level=PAGE),
        "Varied parameters": RecordTable(VARIED, space, _EVENLY, level=PAGE),
    }
    title = atlas.chain.title or f"Atlas of {counted(len(atlas.chain), 'cell')}"
    facts, of = () if query else _facts(atlas), {"packages": ["zarr"], "given": given}
    return Account(atlas, title, "atlas/1", answer, facts, sections, seed=atlas.seed, **of)


def _facts(atlas: Atlas) -> list[Fact]:
    varied = counted(len(atlas.axes), "parameter")
    unseen = "unknown of a single block of designs"
    if atlas.unseen is not None:
        most = number(atlas.unseen.high * 100)
        unseen = f"at most {most} % of designs have another graph, at 95 %"
    sampled, known = atlas.sampled, {one.name for one in atlas.machines}
    others = (
        f"{atlas.designs - atlas.told} designs; of a sample of {sampled.asked} the engine finds "
        f"{counted(len(sampled.machines), 'graph')}, "
        f"{len(sampled.machines.keys() - known) or 'none'} of them new"
    )
    return [
        Fact("Proved", _proved(atlas)),
        Fact("Unseen", "" if atlas.whole else unseen),
        Fact("Space", f"{len(atlas.chain)} cells driven by {atlas.drive}, {varied} varied"),
        Fact("Designs", f"{atlas.designs} drawn evenly, {atlas.told} of them in closed form"),
        Fact("Engine", f"the same graph for {atlas.agreed} of {atlas.checked} more designs"),
        Fact("Others", others if sampled.asked else ""),
    ]


def _defined(atlas: Atlas) -> str:
    within = atlas.tolerances
    return (
        "Back: the cells in the order in which they snap back, numbered as they load. Yield: the "
        "fraction of mechanisms built after the most robust design that was drawn, within "
        f"{amount(within.anchor, 'm')} and {number(within.stiffness * 100)} % of stiffness, "
        "that have the same graph."
    )


def _proved(atlas: Atlas) -> str:
    if atlas.whole:
        return "no other graph occurs in this space, ties aside"
    cells = "every design" if atlas.space_proved else "not every design"
    of = "" if atlas.possible is None else f"; at most {atlas.possible} graphs can occur"
    return f"{cells} of the space has concave cells{of}"
