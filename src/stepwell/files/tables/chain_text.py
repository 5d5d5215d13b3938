"""A chain as the tables of a design file: what the cells share first, then each cell."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from stepwell.files.schema import chain as schema
from stepwell.files.text import Written, array, inline, lines, mm, number, quoted, units
from stepwell.mechanism import Band, Cell, Chain, Cubic, Table, slips


class Shared(NamedTuple):
    """What is written once for several cells."""

    keys: Written
    band: Written

    def lines(self) -> list[str]:
        """The keys of a [chain] table."""
        return lines(self.keys) + ([f"band = {inline(self.band)}"] if self.band else [])


NOTHING = Shared({}, {})


def chain_text(chain: Chain) -> str:
    """The design file of a chain."""
    shared = shared_by(chain.cells)
    text = [f"title = {quoted(chain.title)}", ""] if chain.title else []
    text += ["[chain]", *lines(shared.keys)]
    if chain.actuator_stiffness != math.inf:
        text.append(f"actuator_stiffness_N_per_m = {number(chain.actuator_stiffness)}")
    text += shared._replace(keys={}).lines()
    for cell in chain.cells:
        text += ["", "[[chain.cell]]", *cell_lines(cell, shared)]
    return "\n".join(text) + "\n"


def shared_by(cells: Sequence[Cell]) -> Shared:
    """What all these cells have in common."""
    every = [_band(band) for cell in cells for band in cell.bands]
    band = _shared(every, ("stiffness_N_per_m", "rest_length_mm", "two_sided"))
    keys = _shared([_cell(cell) for cell in cells], ("lever_mm", "limit_deg"))
    return Shared(keys, band | _shared_law(every))


def cell_lines(cell: Cell, shared: Shared) -> list[str]:
    """The keys of a [[chain.cell]] table, without those that are shared."""
    keys = _cell(cell)
    bands = [_band(band) for band in cell.bands]
    bands = [{key: band[key] for key in band if key not in shared.band} for band in bands]
    name = [f"name = {quoted(cell.name)}"] if cell.name else []
    rest = {key: keys[key] for key in keys if key not in shared.keys}
    return [*name, *_own_bands(bands), *lines(rest)]


def _own_bands(bands: list[Written]) -> list[str]:
    if len(bands) > 1:
        return ["bands = [", *(f"    {inline(band)}," for band in bands), "]"]
    anchors = {key: bands[0][key] for key in ("p_mm", "q_mm")}
    rest = {key: bands[0][key] for key in bands[0] if key not in anchors}
    return lines(anchors) + ([f"band = {inline(rest)}"] if rest else [])


def _shared(tables: list[Written], names: tuple[str, ...]) -> Written:
    return {
        name: tables[0][name]
        for name in names
        if all(table.get(name) == tables[0].get(name) for table in tables) and name in tables[0]
    }


def _shared_law(bands: list[Written]) -> Written:
    names = set[str]().union(*schema.LAWS.values())
    laws = [{name: band[name] for name in band if name in names} for band in bands]
    return laws[0] if all(law == laws[0] for law in laws) else {}


def _cell(cell: Cell) -> Written:
    keys = {"lever_mm": mm(cell.lever), "limit_deg": units.toml(units.degrees(cell.limit))}
    if cell.load is not None:
        rows = list(zip(cell.load.travel, cell.load.force, strict=True))
        if len(rows) == 1 and rows[0][0] == 0:
            keys["load_N"] = number(rows[0][1])
        else:
            keys["load_mm_N"] = array(f"[{mm(s)}, {number(f)}]" for s, f in rows)
    if cell.friction:
        keys["friction_N"] = number(cell.friction)
    if cell.unusual or slips(cell):  # what the program made is read again, however odd
        keys["unusual"] = "true"
    return keys


def _band(band: Band) -> Written:
    keys = {
        "p_mm": array(map(mm, band.p)),
        "q_mm": array(map(mm, band.q)),
        "stiffness_N_per_m": number(band.stiffness),
        "rest_length_mm": mm(band.rest_length),
    }
    if band.two_sided:
        keys["two_sided"] = "true"
    if isinstance(band.law, Cubic):
        keys["quadratic_per_mm"] = units.toml(units.shortest(band.law.a2, -3))
        keys["cubic_per_mm2"] = units.toml(units.shortest(band.law.a3, -6))
    if isinstance(band.law, Table):
        tension = _tension(band, band.law)
        if tension:
            del keys["stiffness_N_per_m"]
            column, name = list(map(number, tension)), "table_mm_N"
        else:
            column, name = list(map(mm, band.law.shape)), "shape_mm"
        extension = map(mm, band.law.extension)
        keys[name] = array(f"[{e}, {y}]" for e, y in zip(extension, column, strict=True))
    return keys


def _tension(band: Band, law: Table) -> tuple[float, ...] | None:
    """The law in newtons, if reading it gives this very band again; round numbers first."""
    for digits in (15, 16, 17):
        tension = tuple(float(f"{band.stiffness * y:.{digits}g}") for y in law.shape)
        if tension[-1] < 1e-9:
            return None
        again = Band.from_table(band.p, band.q, band.rest_length, law.extension, tension)
        if (again.stiffness, again.law) == (band.stiffness, law):
            return tension
    return None
