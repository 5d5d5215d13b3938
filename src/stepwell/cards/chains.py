"""Cards of chains, of what they do and what that means."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from stepwell.base import Quantity, counted, number, record, told_in
from stepwell.cards.html import Card, facts, text_of
from stepwell.mechanism import Cell, Chain, Element
from stepwell.results import (
    CELL,
    LONGEST_SPELLED_OUT,
    actuator_words,
    cell_records,
    cell_schema,
    cycle_schema,
    drive_schema,
    event_columns,
    event_records,
    tie_notes,
)
from stepwell.sequences.programs import turn_schema

if TYPE_CHECKING:
    from stepwell.sequences import (
        Cycle,
        ImplicitGraph,
        MemoryReading,
        Program,
        Sequence,
        TransitionGraph,
        Unreachable,
    )
    from stepwell.statics import Path

_FEW = 12


def _named(chain: Chain, kind: str) -> str:
    return f"{kind} of {chain.title}" if chain.title else kind


def _order(chain: Chain, cells: tuple[int, ...]) -> str:
    names = [chain.names[cell] for cell in cells[:_FEW]]
    return ", ".join(names) + f" and {len(cells) - _FEW} more" * (len(cells) > _FEW)


def _chain(chain: Chain) -> Card:
    count = counted(len(chain), "cell")
    return Card(
        chain.title or f"Chain of {count}",
        [f"{count}, innermost first. {actuator_words(chain)}"],
        {},
        cell_schema(chain),
        cell_records(chain),
        "cells",
    )


def _cell(cell: Cell) -> Card:
    bands = [
        f"A band from ({_mm(*band.p)}) to ({_mm(*band.q)}) mm, {number(band.stiffness)} N/m, "
        f"{number(band.rest_length * 1e3)} mm at rest."
        for band in cell.bands
    ]
    told = facts(CELL, cell, name="")
    return Card(f"Cell {cell.name}".strip(), bands, told)


def _mm(x: float, y: float) -> str:
    return f"{number(x * 1e3)}, {number(y * 1e3)}"


def _element(element: Element) -> Card:
    chain = Chain([element])
    (told,) = cell_records(chain)
    shown = {q.head: text_of(q, told[q.key]) for q in cell_schema(chain)[1:] if q.head}
    phases = counted(len(element.phases), "phase")
    says = f"{phases}: stretches of {element.measure.travel} that hold under a constant "
    return Card(
        f"Element {element.name}".strip(),
        [f"{says}{element.measure.force}."],
        {name: text for name, text in shown.items() if text},
    )


def _cycle(cycle: Cycle) -> Card:
    chain = cycle.chain
    spelled = len(chain) <= LONGEST_SPELLED_OUT and len(cycle.sequence) <= LONGEST_SPELLED_OUT
    sequence = str(cycle.sequence).replace(">", " → ") if spelled else repr(cycle.sequence)
    pathway = f", {cycle.pathway.label}" if cycle.pathway is not None else ""
    loads = (
        f"Cells load in the order {_order(chain, cycle.loading_order)}, and unload in the order "
        f"{_order(chain, cycle.unloading_order)}."
    )
    return Card(
        _named(chain, "Cycle"),
        [f"{sequence}{pathway}.", loads, *tie_notes(cycle.degenerate, chain)],
        facts(cycle_schema(chain), cycle),
        event_columns(chain),
        event_records(cycle.events, chain),
        "switches and snaps",
    )


def _path(path: Path) -> Card:
    chain = path.chain
    points, *_ = drive_schema(told_in(chain.drive_unit)[0])
    told = [number(point * points.factor) for point in path.turning_points[:_FEW]]
    dissipated, peak, *_ = cycle_schema(chain)
    return Card(
        _named(chain, "Path"),
        [f"{' → '.join(told)}{' → …' * (len(path.turning_points) > _FEW)} {points.sign}."],
        facts((dissipated, peak), path),
        event_columns(chain),
        event_records(path.events, chain),
        "switches and snaps",
    )


def _event(event: Any) -> Card:
    kind, _, rest = repr(event).partition(" ")
    return Card(kind.capitalize(), [rest])


def _landing(landing: Any) -> Card:
    return Card(f"Landing of a {landing.event.kind.name.lower()}", str(landing).splitlines())


def _sequence(sequence: Sequence) -> Card:
    spelled = len(sequence.first) * len(sequence) <= 1000
    told = str(sequence).replace(">", " → ") if spelled else repr(sequence)
    return Card(f"Sequence of {len(sequence)} states", [told])


def _program(program: Program) -> Card:
    unit, _ = told_in(program.chain.drive_unit)
    points, _, _, slack = drive_schema(unit)
    rows = [{"turn": k} | record(turn_schema(unit), t) for k, t in enumerate(program.turns, 1)]
    return Card(
        _named(program.chain, f"Program from {program.start} to {program.to}"),
        [f"{counted(program.strokes, 'stroke')}; {program.reason}."],
        facts((points, slack), program),
        [Quantity("turn", head="turn"), *turn_schema(unit)[:-1]] if rows else (),
        rows,
        "turns",
    )


def _unreachable(why: Unreachable) -> Card:
    proved = "This is proved." if why.proved else "A search found no way; that is no proof."
    return Card("Not in reach", [str(why), proved])


def _graph(graph: TransitionGraph) -> Card:
    chain = graph.chain
    title = f"Transition graph of {chain.title}" if chain and chain.title else "Transition graph"
    told = {
        "driven by": graph.actuator,
        "cells": ", ".join(graph.names[:_FEW]) + ", …" * (graph.cells > _FEW),
        "states with all cells at rest": str(len(graph.nodes.vertices)),
        "nodes": str(len(graph)),
        "ways": str(graph.transition_count),
    }
    return Card(title, [*tie_notes(graph.ties, chain)], told)


def _implicit(graph: ImplicitGraph) -> Card:
    return Card(f"{_named(graph.chain, 'Transition graph')}, not listed", str(graph).splitlines())


def _memory(reading: MemoryReading) -> Card:
    return Card("What the graph remembers", str(reading).splitlines()[:_FEW])


CHAINS: dict[str, Callable[[Any], Card]] = {
    "Cell": _cell,
    "Chain": _chain,
    "Cycle": _cycle,
    "Element": _element,
    "Event": _event,
    "ImplicitGraph": _implicit,
    "Landing": _landing,
    "MemoryReading": _memory,
    "Path": _path,
    "Program": _program,
    "Sequence": _sequence,
    "TransitionGraph": _graph,
    "Unreachable": _unreachable,
}
