"""A chain in, a design file out."""

from __future__ import annotations

import json
import math
import os
from decimal import Decimal

from stepwell.files import _units as units
from stepwell.files.atomic import write_atomic
from stepwell.files.design import loads
from stepwell.mechanism import Band, Cell, Chain, Cubic, Table

Keys = dict[str, str]


def save(chain: Chain, path: str | os.PathLike[str]) -> None:
    """Write a chain as a design file, whole or not at all.

    Args:
        chain: any chain.
        path: where to; an existing file is replaced.

    Raises:
        ValueError: the chain lies outside what a design file may hold.
        OSError: the folder is missing or cannot be written.
    """
    write_atomic(path, dumps(chain))


def dumps(chain: Chain) -> str:
    """The design file of a chain; reading it gives an equal chain, to the last bit.

    Args:
        chain: any chain.

    Returns:
        TOML: what the cells share first, then each cell, innermost first.

    Raises:
        ValueError: the chain lies outside what a design file may hold, such as a name of two
            lines or a lever of a thousand kilometres.
    """
    text = _text(chain)
    if loads(text, "this chain, written as a design file") != chain:
        raise ValueError(f"{chain!r} did not survive being written: please report this chain.")
    return text


def _text(chain: Chain) -> str:
    cells = [_cell(cell) for cell in chain.cells]
    bands = [[_band(band) for band in cell.bands] for cell in chain.cells]
    shared = _shared(cells, ("lever_mm", "limit_deg"))
    every = [band for of_cell in bands for band in of_cell]
    shared_band = _shared(every, ("stiffness_N_per_m", "rest_length_mm", "two_sided"))
    shared_band |= _shared_law(every)
    lines = [f"title = {_quoted(chain.title)}", ""] if chain.title else []
    lines += ["[chain]", *_lines(shared)]
    if chain.actuator_stiffness != math.inf:
        lines.append(f"actuator_stiffness_N_per_m = {_number(chain.actuator_stiffness)}")
    if shared_band:
        lines.append(f"band = {_inline(shared_band)}")
    for cell, keys, own in zip(chain.cells, cells, bands, strict=True):
        lines += ["", "[[chain.cell]]"]
        if cell.name:
            lines.append(f"name = {_quoted(cell.name)}")
        own = [{key: band[key] for key in band if key not in shared_band} for band in own]
        lines += _own_bands(own)
        lines += _lines({key: keys[key] for key in keys if key not in shared})
    return "\n".join(lines) + "\n"


def _own_bands(bands: list[Keys]) -> list[str]:
    if len(bands) > 1:
        return ["bands = [", *(f"    {_inline(band)}," for band in bands), "]"]
    anchors = {key: bands[0][key] for key in ("p_mm", "q_mm")}
    rest = {key: bands[0][key] for key in bands[0] if key not in anchors}
    return _lines(anchors) + ([f"band = {_inline(rest)}"] if rest else [])


def _shared(tables: list[Keys], names: tuple[str, ...]) -> Keys:
    return {
        name: tables[0][name]
        for name in names
        if all(table.get(name) == tables[0].get(name) for table in tables) and name in tables[0]
    }


def _shared_law(bands: list[Keys]) -> Keys:
    names = ("quadratic_per_mm", "cubic_per_mm2", "table_mm_N", "shape_mm")
    laws = [{name: band[name] for name in names if name in band} for band in bands]
    return laws[0] if all(law == laws[0] for law in laws) else {}


def _cell(cell: Cell) -> Keys:
    keys = {"lever_mm": _mm(cell.lever), "limit_deg": units.toml(units.degrees(cell.limit))}
    if cell.load is not None:
        rows = list(zip(cell.load.travel, cell.load.force, strict=True))
        if len(rows) == 1 and rows[0][0] == 0:
            keys["load_N"] = _number(rows[0][1])
        else:
            keys["load_mm_N"] = _array(f"[{_mm(s)}, {_number(f)}]" for s, f in rows)
    if cell.friction:
        keys["friction_N"] = _number(cell.friction)
    return keys


def _band(band: Band) -> Keys:
    keys = {
        "p_mm": _array(map(_mm, band.p)),
        "q_mm": _array(map(_mm, band.q)),
        "stiffness_N_per_m": _number(band.stiffness),
        "rest_length_mm": _mm(band.rest_length),
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
            column, name = list(map(_number, tension)), "table_mm_N"
        else:
            column, name = list(map(_mm, band.law.shape)), "shape_mm"
        extension = map(_mm, band.law.extension)
        keys[name] = _array(f"[{e}, {y}]" for e, y in zip(extension, column, strict=True))
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


def _mm(metres: float) -> str:
    return units.toml(units.shortest(metres, 3))


def _number(value: float) -> str:
    return units.toml(Decimal(repr(float(value))))


def _array(items) -> str:
    return f"[{', '.join(items)}]"


def _inline(keys: Keys) -> str:
    return "{ " + ", ".join(_lines(keys)) + " }"


def _lines(keys: Keys) -> list[str]:
    return [f"{key} = {value}" for key, value in keys.items()]


def _quoted(text: str) -> str:
    # JSON's escapes are TOML's, but TOML also wants the delete character escaped.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
