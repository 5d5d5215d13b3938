"""Panels of the motion of a chain: cycle, margins, parameters, graph, programs."""

import tomllib
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from stepwell.base import InputError, StepwellError, display_unit
from stepwell.design import margin, proved_margin
from stepwell.files import columns_of, known_keys, new_cells
from stepwell.mechanism import Chain, Element
from stepwell.sequences import Program, to_dot
from stepwell.studio import motion
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.message import in_steps


def answer_evaluate(design: PageDesign, ask: Ask) -> View:
    """The cycle, and the margins that are known in closed form.

    Keys have the same names for chains of volumes or angles; `units` has their units. For a design
    that `moves` under a hand, events are left out, and margins, which panel `limits` has.
    """
    if ask.switch("moves", default=False):
        return _while_it_moves(design.chain, ask)
    ask.close()
    chain = design.chain
    cycle = chain.cycle()
    path = motion.drawn(cycle.path)
    header = {
        **motion.path_header(cycle.path, path),
        **motion.cycle_header(cycle),
        # A search takes 100 times as long as the rest: panel `margin` runs it separately.
        **motion.margins_of(proved_margin(chain)),
        "names": list(chain.names),
        "full_stroke_mm": chain.full_stroke * display_unit(chain.measure.travel_unit)[1],
    }
    cells = range(len(chain))
    return View(header, motion.arrays_of(path) | motion.landscape(chain, cells))


def _while_it_moves(chain: Chain, ask: Ask) -> View:
    """The same for a chain under a hand that drags, with fewer samples.

    If `cells` are given, only their anchors and curves have changed, and what is as before is
    left out. With `drive` and `direction` of the cursor, tensions are those at the cursor alone.
    """
    moved = None
    if ask.has("cells"):
        moved = ask.wholes("cells", len(chain), 0, len(chain) - 1)
    cursor = None
    if ask.has("drive"):
        cursor = ask.number("drive", -_FARTHEST, _FARTHEST), ask.whole("direction", -1, 1)
    ask.close()
    cycle = chain.cycle()
    path = motion.drawn(cycle.path, moves=True)
    at = None if cursor is None else motion.sample_near(path, *cursor)
    arrays = motion.arrays_of(path, at)
    # The travels of all cells are most of the bytes, and are drawn.
    travel, steps = in_steps(arrays["travel"])
    header = {
        **motion.path_header(cycle.path, None, moved),
        **motion.cycle_header(cycle),
        "full_stroke_mm": chain.full_stroke * display_unit(chain.measure.travel_unit)[1],
        "steps": {"travel": steps},
    }
    landscape = motion.landscape(chain, range(len(chain)) if moved is None else moved)
    drawn = {k: v.astype(np.float32) for k, v in landscape.items()}
    return View(header, arrays | {"travel": travel} | drawn)


def answer_limits(design: PageDesign, ask: Ask) -> View:
    """The margins in closed form, without the sequence after the smallest change."""
    ask.close()
    return View(motion.margins_of(proved_margin(design.chain), becomes=False))


def answer_margin(design: PageDesign, ask: Ask) -> View:
    """The margins as panel `evaluate` has them, by closed forms or a search."""
    ask.close()
    return View(motion.margins_of(margin(design.chain, progress=ask.report)))


_POINTS = 121


def answer_cells(design: PageDesign, ask: Ask) -> View:
    """The keys of the shown chain and of every cell, what can be added, and samples of curves.

    An invalid design has no curves, and `units` is null, so that it can be corrected.
    """
    ask.close()
    tables = _tables(design)
    chain, cells = known_keys(*tables)
    header = {
        "chain": [asdict(one) for one in chain],
        "cells": [[asdict(one) for one in cell] for cell in cells],
        "columns": [columns_of(cell) for cell in tables[0]["cell"]] if cells else [],
        "new": new_cells(),
    }
    try:
        made = design.chain
    except StepwellError:
        # Without cells there are no fields to edit.
        if not cells:
            raise
        return View({**header, "units": None})
    return View(
        {**header, "units": motion.units_of(made), "words": motion.words_of(made)}, _curves(made)
    )


def _curves(chain: Chain) -> dict[str, np.ndarray[Any, Any]]:
    rows: list[np.ndarray[Any, Any]] = [np.empty((0, 4))]
    for i, cell in enumerate(chain.cells):
        if isinstance(cell, Element):
            for k, sheet in enumerate(cell.laws):
                travel = np.linspace(sheet.begin, sheet.end, _POINTS)
                force = cell.force_at(travel, k)
                rows.append(np.column_stack([np.full((_POINTS, 2), (i, k)), travel, force]))
    of, segment, travel, force = np.concatenate(rows).T
    return {
        "cell": of.astype(int),
        "segment": segment.astype(int),
        "travel": travel * display_unit(chain.measure.travel_unit)[1],
        "force": force * display_unit(chain.measure.force_unit)[1],
    }


def _tables(design: PageDesign) -> tuple[Mapping[str, Any], Mapping[str, Any] | None]:
    tables = design.tables or {}
    common, legs = _table(tables.get("chain")), tables.get("leg")
    if not isinstance(legs, list):
        return common, None
    leg: Any = legs[design.leg] if design.leg < len(legs) else {}
    own = _table(_table(leg).get("chain"))
    return (own, common) if "cell" in own else (common, {})


def _table(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


# Limit for a readable graph; `stepwell graph` handles more cells.
_MOST_CELLS = 8


def answer_graph(design: PageDesign, ask: Ask) -> View:
    """Nodes and edges, their drives in the unit of `units`, and the graph in DOT."""
    ask.close()
    chain = design.chain
    if len(chain) > _MOST_CELLS:
        most = f"the limit of the page is {_MOST_CELLS} cells; use `stepwell graph`"
        raise InputError(f"the graph of {len(chain)} cells has too many states to display: {most}.")
    graph = chain.graph()
    drive, reached = display_unit(chain.drive_unit)[1], graph.reachable()
    nodes = [
        {
            "state": node.state,
            "label": node.label,
            "low_mm": node.low * drive,
            "high_mm": node.high * drive,
            "reached": node.label in reached,
        }
        for node in graph.nodes
    ]
    edges = [
        {
            "from": node.label,
            "to": way[0],
            "kind": way[1].kind.name.lower(),
            "direction": direction,
            "drive_mm": way[1].drive * drive,
        }
        for node in graph.nodes
        for direction in (1, -1)
        if (way := graph.transition(node.label, direction)) is not None
    ]
    units, dot = motion.units_of(chain), to_dot(graph)
    return View({"units": units, "dot": dot, "nodes": nodes, "edges": edges})


_MOST_TURNS = 100
_FARTHEST = 1e6


def answer_program(design: PageDesign, ask: Ask) -> View:
    """The program from `start` to `to`, or the one of `turning_points_mm`, with its samples."""
    program = program_of(design.chain, ask)
    ask.close()
    path = motion.drawn(program.path)
    header = {
        "units": motion.units_of(program.chain),
        **motion.program_header(program),
        "events": motion.events_of(program.path.events, path),
        "written": tomllib.loads(motion.written(program).text(program.chain))["program"],
    }
    return View(header, motion.arrays_of(path))


def program_of(chain: Chain, ask: Ask) -> Program:
    """The requested program."""
    start = _state(chain, ask, "start", chain.first_state)
    if ask.has("turning_points_mm"):
        drive = display_unit(chain.drive_unit)[1]
        points = ask.numbers("turning_points_mm", _MOST_TURNS, -_FARTHEST, _FARTHEST)
        target = _state(chain, ask, "target") if ask.has("target") else None
        return Program.given(chain, [point / drive for point in points], start=start, target=target)
    return chain.program(_state(chain, ask, "target"), start=start)


def _state(chain: Chain, ask: Ask, key: str, default: str | None = None) -> str:
    state, last = ask.text(key, len(chain), default), chain.last_state
    if len(state) == len(last) and all("0" <= a <= b for a, b in zip(state, last, strict=True)):
        return state
    raise InputError(f"ask.{key} = {state!r}: must be one digit a cell, up to {last}.")
