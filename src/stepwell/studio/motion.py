"""A motion for the page and for replays: samples, events, cells and margins in display units."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import zip_longest
from typing import Any, NamedTuple

import numpy as np

from stepwell.accounts import assumptions
from stepwell.base import Floats, InputError, Ints, __version__, display_unit, plain
from stepwell.design import Change, Margin, margin
from stepwell.files import WrittenProgram, dumps
from stepwell.mechanism import Cell, Chain, Element, layout, levers, phase_at
from stepwell.robot import Robot
from stepwell.sequences import Cycle, Program, ProgramMethod
from stepwell.statics import Event, EventKind, Path
from stepwell.studio.ask import View

MM, MJ = display_unit("m")[1], display_unit("J")[1]
# Most samples of a picture on all smooth segments together, on one of them, fewest on one, and
# samples of a segment over the whole range of the drive; most while a hand moves the chain.
_ALL, _MOST, _LEAST, _WHOLE = 600, 33, 3, 26
_MOVING = 360
_LANDSCAPE = 65


def units_of(chain: Chain) -> dict[str, str]:
    """The unit of every number of a chain on the page."""
    (travel, _), (force, _), (drive, _) = _units_of(chain)
    return {"travel": travel, "force": force, "stroke": travel, "drive": drive, "energy": "mJ"}


def words_of(chain: Chain) -> dict[str, str]:
    """The words of a chain on the page, and the symbol of its stroke."""
    travel, stroke, force = chain.measure.words
    return {"travel": travel, "stroke": stroke, "force": force, "symbol": chain.measure.symbols[0]}


def _units_of(chain: Chain) -> list[tuple[str, float]]:
    """Units of travel, force and drive, and their factors from SI."""
    units = chain.measure.travel_unit, chain.measure.force_unit, chain.drive_unit
    return [display_unit(unit) for unit in units]


def drawn(path: Path, *, moves: bool = False) -> Path:
    """The path, resampled for a picture; of a chain that `moves` under a hand, fewer samples.

    These are some of the others: every second one, or of many segments every fourth or sixth.
    """
    spans = path.move_spans
    longest = np.max(spans, initial=0.0) / (np.ptp(path.turning_points) or 1.0)
    least = max(_LEAST, math.ceil(_WHOLE * longest))
    # An even number of steps on each segment.
    steps = min(_MOST, max(least, _ALL // max(1, len(spans)))) // 2 * 2
    if moves:
        fewest = max(1, min(math.ceil(_WHOLE / 2 * longest), steps // 2))
        parts = [n for n in range(fewest, steps // 2 + 1) if steps % n == 0]
        steps = max((n for n in parts if (n + 1) * len(spans) <= _MOVING), default=parts[0])
    return path.resampled(steps + 1)


def sample_near(path: Path, drive: float, direction: int) -> int:
    """The first sample nearest to a drive, in the unit of `units_of`, on its way there or back."""
    _, _, (_, unit) = _units_of(path.chain)
    far = np.where(path.direction == direction, np.abs(path.drive * unit - drive), np.inf)
    return int(np.argmin(far))


def arrays_of(path: Path, at: int | None = None) -> dict[str, np.ndarray[Any, Any]]:
    """The samples of a path in the units of `units_of`; a snap is a jump between two of them.

    `tension` (n, B) is a fraction of the greatest tension of any band, NaN if slack; `pull` (n, E)
    is the force of every element on its curve. What is drawn and not printed has single precision.
    With a sample `at`, its tensions alone are computed: `tension_now` (B,).
    """
    (_, travel), (_, force), (_, drive) = _units_of(path.chain)
    tension = (
        {"tension": _tensions(path.chain, path.travel)}
        if at is None
        else {"tension_now": _tensions(path.chain, path.travel[at : at + 1])[0]}
    )
    return {
        "drive": path.drive * drive,
        "stroke": path.stroke * travel,
        "force": path.force * force,
        "travel": path.travel * travel,
        **tension,
        "pull": (_pulls(path) * force).astype(np.float32),
        "segment": path.branch,
        "direction": path.direction,
    }


def _tensions(chain: Chain, travel: Floats) -> np.ndarray[Any, Any]:
    """(n, B) tensions at travels, as in `arrays_of`."""
    turned = levers.Levers(chain.cells, travel)
    greatest = max(still.greatest_tension for still in _stills_of(chain))
    share = np.abs(turned.tension()) / (greatest or 1.0)
    return np.where(turned.slack, np.nan, share).astype(np.float32)


def _pulls(path: Path) -> Floats:
    pulls = np.empty((len(path.travel), len(path.chain.elements)))
    columns = zip(path.chain.cells, path.travel.T, path.sheet.T, strict=True)
    elements = (column for column in columns if isinstance(column[0], Element))
    for pull, (element, travel, sheet) in zip(pulls.T, elements, strict=True):
        for number in np.unique(sheet).tolist():
            here = sheet == number
            pull[here] = element.force_at(travel[here], number)
    return pulls


def landscape(chain: Chain, cells: Iterable[int]) -> dict[str, np.ndarray[Any, Any]]:
    """Travels and energies of single cells (m, k); NaN for curves that fold back."""
    stills = [_stills_of(chain)[i] for i in cells]
    return {
        "landscape_travel": np.stack([one.travel for one in stills], axis=1),
        "landscape_energy": np.stack([one.energy for one in stills], axis=1),
    }


class _Still(NamedTuple):
    """What the page shows of a cell whatever the rest of the chain is."""

    travel: Floats  # of the landscape, in the unit of `units_of`
    energy: Floats  # [mJ]
    header: Mapping[str, Any]
    greatest_tension: float  # [N]

    @classmethod
    def of(cls, cell: Cell | Element) -> "_Still":
        travel = np.linspace(cell.low, cell.high, _LANDSCAPE)
        known = isinstance(cell, Cell) or len(cell.laws) == 1
        energy = cell.energy_at(travel) if known else np.full_like(travel, np.nan)
        travel *= display_unit(cell.measure.travel_unit)[1]
        return cls(travel, energy * MJ, _cell(cell), layout.greatest_tension(cell))


_last: tuple[Sequence[Cell | Element], list[_Still]] = (), []


def _stills_of(chain: Chain) -> list[_Still]:
    """Of every cell; kept for the cells that are as in the last chain, most of them in a drag."""
    global _last
    cells, stills = _last
    if cells is not chain.cells:
        kept = zip_longest(cells[: len(chain)], stills[: len(chain)], chain.cells)
        stills = [still if old is cell else _Still.of(cell) for old, still, cell in kept]
        _last = chain.cells, stills
    return stills


def cells_of(chain: Chain, cells: Iterable[int]) -> list[dict[str, Any]]:
    """Geometry of cells, and the phases that are stable without a force."""
    names, stills = chain.names, _stills_of(chain)
    return [{"name": names[i], **stills[i].header} for i in cells]


def _cell(cell: Cell | Element) -> dict[str, Any]:
    travel, force = (
        display_unit(cell.measure.travel_unit)[1],
        display_unit(cell.measure.force_unit)[1],
    )
    phases = cell.phases
    first, last = (plain(end, force) for end in (phases[0].force_high, phases[-1].force_low))
    header: dict[str, Any] = {
        "kind": "lever" if isinstance(cell, Cell) else "element",
        "full_travel_mm": cell.full_travel * travel,
        "stable": [k for k, p in enumerate(phases) if p.force_low < 0.0 < p.force_high],
        "force_0_N": first,
        "force_1_N": last,
        "bands": [],
    }
    if isinstance(cell, Cell):
        # A slack band exerts no force at a stop, but a barrier may exist between the stops.
        if len(header["stable"]) < 2 and cell.is_bistable:
            header["stable"] = [0, 1]
        header |= {
            "lever_mm": cell.lever * MM,
            "limit_deg": float(np.degrees(cell.limit)),
            "bands": [{"p_mm": plain(b.p, MM), "q_mm": plain(b.q, MM)} for b in cell.bands],
        }
    return header


# Points of an element's curve in its symbol.
_CURVE = 49


def layout_of(path: Path) -> dict[str, Any]:
    """Sizes of the drawing [mm], and the curves of the elements in the units of `units_of`."""
    chain = path.chain
    # Lever cells move between their stops only; their symbols need no samples.
    reached = [path.travel.min(axis=0), path.travel.max(axis=0)] if chain.elements else ()
    drawing = layout.ChainLayout(chain, reached)
    (_, travel), (_, force), _ = _units_of(chain)
    names = ("reach", "half_pair", "half_block", "box", "rod", "spans", "wall")
    return {
        **{name: plain(getattr(drawing, name), MM) for name in names},
        # Drawn millimetres per unit of travel.
        "scale": drawing.unit * MM / travel,
        "edge": layout.EDGE,
        "sides": drawing.sides.tolist(),
        "symbols": [
            {
                "origin": plain(one.origin * (travel, force)),
                "size": plain(one.size * (travel, force)),
                "zero": None if math.isnan(one.zero) else one.zero,
                "curves": [
                    np.round(curve[:: len(curve) // _CURVE + 1], 4).tolist() for curve in one.curves
                ],
            }
            if (one := drawing.symbols.get(i))
            else None
            for i in range(len(chain))
        ],
    }


def events_of(events: Iterable[Event], path: Path) -> list[dict[str, Any]]:
    """Switches and snaps; each lies between its sample and the one after it."""
    (_, travel), _, _ = _units_of(path.chain)
    events = list(events)
    return [
        {
            "kind": event.kind.name.lower(),
            "direction": event.direction,
            "stroke_mm": event.stroke * travel,
            "cells": list(event.cells),
            "before_mm": [one * travel for one in event.before],
            "after_mm": [one * travel for one in event.after],
            "sample": sample,
        }
        for event, sample in zip(events, _samples_at(events, path), strict=True)
    ]


def path_header(path: Path, few: Path | None, moved: Iterable[int] | None = None) -> dict[str, Any]:
    """Cells, events, forces and dissipated energy of a path; events refer to samples of `few`.

    Without `few` there are no events: the page reads the snaps off the samples. If only anchors and
    curves of the cells `moved` are not as in the path before, what is as before is left out.
    """
    chain = path.chain
    listed: dict[str, Any] = {}
    if few is not None:
        listed["events"] = events_of(path.events, few)
    # The drawing of lever cells has room for their stops, and that of an element for its path.
    if moved is None or chain.elements:
        listed["layout"] = layout_of(path)
    return {
        "title": chain.title,
        "units": units_of(chain),
        "words": words_of(chain),
        "cells": cells_of(chain, range(len(chain)) if moved is None else moved),
        **listed,
        "peak_force_N": path.peak_force * display_unit(chain.measure.force_unit)[1],
        "dissipated_mJ": path.dissipated * MJ,
    }


def cycle_header(cycle: Cycle) -> dict[str, Any]:
    """The sequence of a full cycle, its name, and advice on every tie."""
    return {
        "sequence": str(cycle.sequence),
        "pathway": "" if cycle.pathway is None else cycle.pathway.label,
        "ties": [tie.advice for tie in cycle.degenerate],
    }


def _samples_at(events: Iterable[Event], path: Path) -> list[int]:
    samples: list[int] = []
    snaps = iter(np.flatnonzero(path.snap_after))
    # The drive of a sample may differ from that of its event by rounding.
    near = 1e-12 * float(np.ptp(path.drive))
    places = list(zip(path.drive.tolist(), path.direction.tolist(), strict=True))
    at = 0
    for event in events:
        if event.kind is EventKind.SNAP:
            at = int(next(snaps))
        else:
            at = next(
                (
                    k
                    for k, (drive, direction) in enumerate(places[at:], at)
                    if direction == event.direction and abs(drive - event.drive) <= near
                ),
                at,
            )
        samples.append(at)
        at += event.kind is EventKind.SNAP
    return samples


def margins_of(limits: Margin | None, *, becomes: bool = True) -> dict[str, Any]:
    """Margins of every anchor and every stiffness, and the smallest one.

    `becomes` adds the sequence after the smallest change, which takes a cycle of its own.
    """
    if limits is None:
        return {"margins": [], "margin": None, "method": "search"}
    known = [change for change in limits.changes if np.isfinite(change.distance)]
    known.sort(key=lambda change: (change.parameter != "anchor", change.distance))
    least = _change(known[0]) if known else None
    if least and becomes:
        least["becomes"] = known[0].becomes
    return {
        "margins": [_change(change) for change in limits.changes],
        "margin": least,
        "method": limits.method.name.lower(),
    }


def _change(change: Change) -> dict[str, Any]:
    moves = change.parameter == "anchor"
    reach = {"reach_mm" if moves else "reach_percent": plain(change.distance, MM if moves else 100)}
    move = None
    if isinstance(change.move, tuple) and math.isfinite(change.distance):
        move = [part * MM for part in change.move]
    return {"cell": change.cell, "what": change.parameter, **reach, "move_mm": move}


def program_header(program: Program) -> dict[str, Any]:
    """The result of a program, with drives in the unit of `units_of`."""
    drive = display_unit(program.chain.drive_unit)[1]
    return {
        "start": program.start,
        "target": program.target,
        "arrives": program.arrives,
        "meets_target": program.meets_target,
        "proved": program.shortest,
        "reason": program.reason,
        "turning_points_mm": [point * drive for point in program.turning_points],
        "turns": [
            {"drive_mm": t.drive * drive, "low_mm": t.low * drive, "high_mm": t.high * drive}
            for t in program.turns
        ],
        "states": list(program.sequence.states),
        "sequence": str(program.sequence),
    }


def motion_of(
    result: Chain | Cycle | Program,
    known: Margin | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> View:
    """The full cycle of a chain with its margins, or a program with its tolerance intervals."""
    if isinstance(result, Program):
        path, view_header = result.path, {**margins_of(None), "program": program_header(result)}
    else:
        cycle = result.cycle() if isinstance(result, Chain) else result
        limits = margin(cycle.chain, progress=progress) if known is None else known
        path, view_header = (
            cycle.path,
            {"program": None, **cycle_header(cycle), **margins_of(limits)},
        )
    few, rests = drawn(path), assumptions(path.chain)
    kept = written(result) if isinstance(result, Program) else None
    rest = {"version": __version__, "assumptions": rests, "toml": design_text(path.chain, kept)}
    header = {**path_header(path, few), **rest, **view_header}
    energies = landscape(path.chain, range(len(path.chain)))
    return View(header, arrays_of(few) | energies | {"phase": _phases(few)})


def written(program: Program) -> WrittenProgram:
    """The program of a design file; with rounded numbers for a planned program."""
    if program.method is ProgramMethod.GIVEN:
        return WrittenProgram(program.start, program.turning_points, program.target)
    return WrittenProgram.of(program)


def design_text(design: Chain | Robot, program: WrittenProgram | None = None) -> str:
    """The design file of a motion; "" if the design is outside the limits of its file."""
    try:
        return dumps(design, program=program)
    except InputError:
        return ""


def _phases(path: Path) -> Ints:
    """(n, N) the phase of every cell at every sample; -1 in transit."""
    columns = zip(path.chain.stretches, path.sheet.T.tolist(), path.travel.T.tolist(), strict=True)
    phases = [[phase_at(own, *at) for at in zip(on, s, strict=True)] for own, on, s in columns]
    return np.array([[-1 if one == "-" else int(one) for one in cell] for cell in phases]).T
