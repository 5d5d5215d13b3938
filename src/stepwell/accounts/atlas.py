"""An atlas: the graphs of a space of designs, how often they occur, how surely they are built."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

from stepwell.accounts.head import About
from stepwell.accounts.parts import Account, Fact, Level, Picture, RecordTable, Section, Text
from stepwell.accounts.study import VARIED
from stepwell.base import Quantity, Schema, amount, counted, number, quantities, record, told_in

if TYPE_CHECKING:
    from stepwell.studies import Atlas, Border, Cycling, Machine, Varied

# Rows of the table on a terminal.
_ROWS = 15


class _Drawn(NamedTuple):
    """A machine or a cycle of an atlas, of which a design was drawn."""

    atlas: Atlas
    of: Machine | Cycling

    @property
    def values(self) -> list[float]:
        """What the space varies, of that design, in the order and the units of `space`."""
        from stepwell.design import parameter

        chain, names = self.of.chain, [axis.name for axis in self.atlas.axes]
        values = (parameter(self.atlas.chain, name).value(chain) for name in names)
        factors = (_told(self.atlas, name)[1] for name in names)
        return [float(a) * b for a, b in zip(values, factors, strict=True)]  # type: ignore[arg-type]


class _Bordering(NamedTuple):
    """A border of an atlas, and the unit in which it is reported."""

    of: Border
    unit: str
    factor: float


def _space(found: Atlas) -> list[Varied]:
    from stepwell.studies import Varied

    axes = ((axis, *_told(found, axis.name)) for axis in found.axes)
    return [
        Varied(axis.name, unit, axis.low * factor, axis.high * factor)
        for axis, unit, factor in axes
    ]


def _told(found: Atlas, name: str) -> tuple[str, float]:
    """The unit in which a parameter is reported, and how many of it make one in SI."""
    from stepwell.design import parameter

    unit = parameter(found.chain, name).unit
    return ("", 1.0) if unit == "1" else told_in(unit)


def _drawn(found: Atlas, designs: Sequence[Machine | Cycling]) -> list[_Drawn]:
    return [_Drawn(found, one) for one in designs]


def _unseen_at_most(found: Atlas) -> float | None:
    return None if found.unseen is None else found.unseen.high


def _shares(name: str, read: str) -> Schema:
    """A fraction of the designs with its interval."""
    return (
        Quantity(name, "percent", read=f"{read}.share"),
        Quantity(f"{name}_low", "percent", read=f"{read}.low"),
        Quantity(f"{name}_high", "percent", read=f"{read}.high"),
    )


def _of(name: str, holds: Any = None, read: str = "") -> Quantity:
    return Quantity(name, read=f"of.{read or name}", holds=holds)


_TOLERANCES: Schema = quantities(anchor="mm", stiffness="percent", rest_length="percent")
_SAMPLED: Schema = (
    *quantities(asked=int, failed=int),
    Quantity(
        "graphs",
        read=lambda found: list(found.machines.items()),
        holds=[
            (
                Quantity("name", read=lambda one: one[0]),
                Quantity("designs", read=lambda one: one[1], holds=int),
            )
        ],
    ),
)
# What machines and cycles have of the most robust design that was drawn of them.
_DRAWN: Schema = (
    Quantity("gap", "percent", read="of.gap"),
    _of("design", int),
    Quantity("values", holds=[float]),
)
_MACHINE: Schema = (
    _of("name"),
    _of("cycle"),
    _of("designs", int, "share.times"),
    *_shares("share", "of.share"),
    *_shares("yield", "of.kept"),
    *_DRAWN,
    _of("agrees", bool),
    *(_of(name, int) for name in ("states", "reached", "snaps", "sub_loops")),
    _of("remembers", bool),
    *(_of(name, int) for name in ("scrambled", "counts", "counts_by_hand", "gardens", "latches")),
)
_CYCLE: Schema = (
    _of("sequence"),
    _of("designs", int, "share.times"),
    *_shares("share", "of.share"),
    *_DRAWN,
)
_BORDER: Schema = (
    _of("machine"),
    _of("parameter"),
    Quantity("unit", read=lambda one: one.unit or "1"),
    Quantity("at", read=lambda one: one.of.value * one.factor, holds=float),
    Quantity("step", read=lambda one: one.of.step * one.factor, holds=float),
    _of("beyond"),
)


def _back(one: Machine) -> str:
    """The cells in the order in which they snap back, numbered as they load."""
    states = one.cycle.split(">")
    down = states[len(states) // 2 :]
    return " ".join(
        str(next(k for k in range(len(a)) if a[k] != b[k]) + 1) for a, b in pairwise(down)
    )


def _reached(one: Machine) -> str:
    return f"{one.reached} of {one.states}"


# The tables of machines and of cycles.
_MACHINES: Schema = (
    Quantity("name", head="name"),
    Quantity("back", head="back", read=_back),
    Quantity("share", "percent", "fraction", read="share.share"),
    Quantity("yield", "percent", "yield", read="kept.share"),
    Quantity("reached", head="reached", read=_reached, left=False),
    Quantity("memory", head="memory"),
)
_CYCLES: Schema = (
    Quantity("sequence", head="cycle"),
    Quantity("share", "percent", "fraction", read="share.share"),
)


# What is reported of an atlas.
ATLAS: Schema = (
    Quantity("title", read="chain.title"),
    Quantity("cells", read=lambda found: len(found.chain), holds=int),
    Quantity("drive"),
    Quantity("space", read=_space, holds=[VARIED]),
    *(Quantity(name, holds=int) for name in ("designs", "told", "not_proved", "ties", "wakes")),
    Quantity("tolerances", holds=_TOLERANCES),
    Quantity("graphs", read=lambda found: len(found.machines), holds=int),
    *quantities(possible=int | None, space_proved=bool, whole=bool),
    Quantity("unseen_at_most", "percent", read=_unseen_at_most),
    *quantities(checked=int, agreed=int, sampled=_SAMPLED, machines=[_MACHINE]),
    Quantity("cycles", read=lambda found: _drawn(found, found.cycles), holds=[_CYCLE]),
    Quantity("borders", holds=[_BORDER]),
)


def atlas_account(
    found: Atlas,
    about: About,
    machines: Sequence[Machine] | None = None,
    borders: Sequence[Border] = (),
    query: str = "",
) -> Account:
    """What is reported of an atlas.

    Args:
        found: the atlas.
        about: the design file that was varied.
        machines: those of the atlas that are reported; all by default.
        borders: where one becomes another, as `borders` finds them.
        query: what was asked of the machines, where they are the answer to a query.
    """
    shown = found.machines if machines is None else machines
    cycles = counted(len(found.cycles), "cycle")
    answer = f"{counted(len(found.machines), 'graph')} and {cycles}"
    if query:
        matching = counted(len(shown), "machine") if shown else "no machine"
        answer = f"{query}: {matching} of this atlas"
    return Account(
        found,
        found.chain.title or f"Atlas of {counted(len(found.chain), 'cell')}",
        "atlas/1",
        ATLAS,
        answer=answer,
        seed=found.seed,
        packages=("zarr",),
        given={
            "machines": _drawn(found, shown),
            "borders": [_Bordering(one, *_told(found, one.parameter)) for one in borders],
        },
        facts=() if query else _facts(found),
        sections=(
            Section(
                "Machines, highest yield first" if query else "Machines, most frequent first",
                Picture("machines", "The most frequent machines, their fractions and yields"),
                RecordTable(
                    _MACHINES,
                    lambda: [record(_MACHINES, one) for one in shown],
                    most=_ROWS,
                    more="machines",
                    level=Level.CARD,
                ),
            ),
            Section("Columns of the table", Text(_defined(found) if shown else "", Level.CARD)),
            Section(
                "Full cycles",
                RecordTable(
                    _CYCLES,
                    lambda: [record(_CYCLES, one) for one in found.cycles],
                    "The inner cell is the first.",
                    level=Level.PAGE,
                ),
            ),
            Section(
                "Varied parameters",
                RecordTable(
                    VARIED,
                    lambda: [record(VARIED, one) for one in _space(found)],
                    "All designs were drawn evenly between these ends.",
                    level=Level.PAGE,
                ),
            ),
        ),
    )


def _facts(found: Atlas) -> list[Fact]:
    varied = counted(len(found.axes), "parameter")
    return [
        Fact("Proved", _proved(found)),
        Fact("Unseen", "" if found.whole else _unseen(found)),
        Fact("Space", f"{len(found.chain)} cells driven by {found.drive}, {varied} varied"),
        Fact("Designs", f"{found.designs} drawn evenly, {found.told} of them in closed form"),
        Fact("Engine", f"the same graph for {found.agreed} of {found.checked} more designs"),
        Fact("Others", _sampled(found) if found.sampled.asked else ""),
    ]


def _defined(found: Atlas) -> str:
    within = found.tolerances
    return (
        "Back: the cells in the order in which they snap back, numbered as they load. Yield: the "
        "fraction of mechanisms built after the most robust design that was drawn, within "
        f"{amount(within.anchor, 'm')} and {number(within.stiffness * 100)} % of stiffness, "
        "that have the same graph."
    )


def _proved(found: Atlas) -> str:
    if found.whole:
        return "no other graph occurs in this space, ties aside"
    cells = "every design" if found.space_proved else "not every design"
    of = "" if found.possible is None else f"; at most {found.possible} graphs can occur"
    return f"{cells} of the space has concave cells{of}"


def _unseen(found: Atlas) -> str:
    if found.unseen is None:
        return "unknown of a single block of designs"
    return f"at most {number(found.unseen.high * 100)} % of designs have another graph, at 95 %"


def _sampled(found: Atlas) -> str:
    sampled, known = found.sampled, {one.name for one in found.machines}
    others = len(sampled.machines.keys() - known)
    return (
        f"{found.designs - found.told} designs; of a sample of {sampled.asked} the engine finds "
        f"{counted(len(sampled.machines), 'graph')}, {others or 'none'} of them new"
    )
