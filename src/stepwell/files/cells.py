"""Conversion of the tables of cells and elements in a design file to values and back."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from pydantic import ValidationError

from stepwell import mechanism
from stepwell.base import Floats, InputError, Measure, StepwellError, display_unit
from stepwell.files.schema import chain as chain_schema, elements as element_schema
from stepwell.files.schema.keys import field_of, fields, key_of, si, slip_text, written
from stepwell.files.text import Written, array, inline, lines, parsed, value_text

# Constructors of an element from two columns of numbers, by key.
MAKE = {
    "table": mechanism.Element.from_table,
    "points": mechanism.Element.from_points,
    "curve": mechanism.Element.from_curve,
}
# Relative tolerance of force and energy at a joint of two cubics.
_JOINT_TOLERANCE = 1e-9
# Tolerance between a turning point and the joint that was cut there, over the travel.
_CUT_TOLERANCE = 1e-6


def element_of(keys: element_schema.ElementKeys, unusual: bool = False) -> mechanism.Element:
    """The element in a table, or a ValueError; `unusual` unless the table has its own."""
    unusual = unusual if keys.unusual is None else keys.unusual
    (form,) = keys.forms
    given = getattr(keys, form)
    stops = False if keys.stops is None else keys.stops
    if isinstance(given, element_schema.ColumnKeys):
        x, y = map(si, element_schema.COLUMNS[given.measure], given.pair)
        options: dict[str, Any] = {"stops": stops, "measure": given.measure, "unusual": unusual}
        if form == "table":
            options["noise"] = _of_measure(keys, "noise", given.measure)
        element = MAKE[form](x, y, **options)
    elif form in element_schema.LibraryKeys.model_fields:
        element = mechanism.LIBRARY[form.replace("_", "-")].make(**fields(given))
    elif form == "sheets":
        element = mechanism.Element(_sheets(given), stops, measure=given[0].measure)
        _refuse_wrong_neighbours(element)
    else:
        element = mechanism.Element.side_by_side([element_of(part, unusual) for part in given])
    return with_options(element, keys)


def with_options(element: mechanism.Element, keys: element_schema.ElementKeys) -> mechanism.Element:
    """The element with the options in its table: name, stops, friction, scales."""
    given: dict[str, Any] = {"name": keys.name, "stops": keys.stops}
    for word in ("friction", "error_band"):
        given[word] = _of_measure(keys, word, element.measure)
    for key in ("force_scale", "travel_scale", "mobility"):
        given[key] = si(key, getattr(keys, key))
    return replace(element, **{key: value for key, value in given.items() if value is not None})


def _of_measure(keys: element_schema.ElementKeys, word: str, measure: Measure) -> float | None:
    """A force under the key with the unit of its measure; ValueError for another unit."""
    right = element_schema.key_in(word, measure.force_unit)
    for key in sorted(keys.model_fields_set):
        if key.startswith(f"{word}_") and key != right:
            curve = f"this curve is of {measure.travel} and {measure.force}"
            raise InputError(f"{key}: {curve}, so it must be {right}.")
    return si(right, getattr(keys, right))


def _sheets(tables: tuple[element_schema.SheetKeys, ...]) -> tuple[mechanism.Sheet, ...]:
    measure = tables[0].measure
    if any(one.measure is not measure for one in tables):
        raise InputError("sheets: all must be of one kind of travel.")
    sheets: list[mechanism.Sheet] = []
    for k, one in enumerate(tables):
        joints = np.array(getattr(one, element_schema.JOINTS[measure]), float)
        rows = np.column_stack([joints[:-1], np.array(one.cubics_SI, float)])
        rows.setflags(write=False)
        _refuse_gaps(rows, joints, f"sheets[{k}].cubics_SI")
        below, above = (None if n is None else n - 1 for n in (one.below, one.above))
        sheet = mechanism.Sheet(rows, float(joints[-1]), below, above)
        _refuse_turns(sheet, joints, f"sheets[{k}].cubics_SI")
        sheets.append(sheet)
    return tuple(sheets)


def _refuse_gaps(rows: Floats, joints: Floats, where: str) -> None:
    """Raise ValueError if force or energy jump between two cubics, or forces are out of range."""
    steps = np.diff(joints)[:, None] ** np.arange(5)
    force = np.sum(rows[:, 1:5] * steps[:, :4], axis=1)
    energy = rows[:, 5] + np.sum(rows[:, 1:5] * steps[:, 1:] / np.arange(1, 5), axis=1)
    size = float(np.max(np.abs([rows[:, 1], force])))
    if not 1e-12 <= size <= 1e15:
        raise InputError(f"{where}: forces up to {size:.3g}: must be from 1e-12 to 1e15.")
    work = size * (joints[-1] - joints[0])
    for ends, column, scale, what in ((force, 1, size, "force"), (energy, 5, work, "energy")):
        begins = rows[:, column]
        off = np.abs(ends[:-1] - begins[1:])
        if not np.all(off <= _JOINT_TOLERANCE * scale):
            k = int(np.argmax(off))
            raise InputError(
                f"{where}: row {k + 2} begins with the {what} {begins[k + 1]:.9g}, where row "
                f"{k + 1} ends with {ends[k]:.9g}: both must be equal."
            )


def _refuse_turns(sheet: mechanism.Sheet, joints: Floats, where: str) -> None:
    """Raise ValueError if force or stiffness have an extremum within a cubic."""
    cut = mechanism.Sheet.of(sheet.rows, sheet.end).rows[:, 0]
    # The computed cut may differ a little from the joint where it was made.
    after = np.clip(np.searchsorted(joints, cut), 1, len(joints) - 1)
    off = np.minimum(np.abs(cut - joints[after - 1]), np.abs(cut - joints[after]))
    misplaced = off > _CUT_TOLERANCE * (joints[-1] - joints[0])
    if misplaced.any():
        at = f"force or stiffness have an extremum at {cut[misplaced][0]:.9g}, within a row"
        raise InputError(f"{where}: {at}: a new row must begin there.")


def _refuse_wrong_neighbours(element: mechanism.Element) -> None:
    """Raise ValueError if a sheet leads to one without its end, or not of less energy."""
    unit, factor = display_unit(element.measure.travel_unit)
    sheets = element.sheets
    for k, sheet in enumerate(sheets):
        ends = ("below", sheet.begin, sheet.below), ("above", sheet.end, sheet.above)
        for side, at, to in ends:
            if to is None:
                continue
            held = to < len(sheets) and sheets[to].begin <= at <= sheets[to].end
            if not held or not element.energy_at(at, to) < element.energy_at(at, k):
                where = f"at {at * factor:.6g} {unit}, where this one ends"
                must = f"must be the number of a sheet of less energy {where}."
                raise InputError(f"sheets[{k}].{side} = {to + 1}: {must}")


def element_lines(element: mechanism.Element) -> list[str]:
    """Lines of the keys of a [[chain.cell]] table, without its name."""
    return lines(_written(element))


def _written(element: mechanism.Element) -> Written:
    """Keys of a table or points if they reproduce the element exactly, else of its cubics."""
    options, wanted = _options(element), element.renamed("")
    for curve in _as_columns(element):
        if _reads_as(keys := curve | options, wanted):
            return keys
    sheets = [inline(_sheet(sheet, element.measure)) for sheet in element.sheets]
    return {"sheets": "[\n" + "".join(f"    {sheet},\n" for sheet in sheets) + "]"} | options


def _options(element: mechanism.Element) -> Written:
    low, high = element.stopped
    keys: Written = {}
    if low or high:
        keys["stops"] = "true" if low and high else array(written("", one) for one in (low, high))
    keys |= _in_force(element, "friction") | _in_force(element, "error_band")
    for key in ("force_scale", "travel_scale", "mobility"):
        if getattr(element, key) != 1.0:
            keys[key] = written(key, getattr(element, key))
    if any(mechanism.sizes.of_element(element)):  # so that every chain can be read again
        keys["unusual"] = "true"
    return keys


def _in_force(element: mechanism.Element, word: str) -> Written:
    """A force of an element under the key with its unit; empty if it is 0."""
    key, value = element_schema.key_in(word, element.measure.force_unit), getattr(element, word)
    return {key: written(key, value)} if value else {}


def _as_columns(element: mechanism.Element) -> Iterator[Written]:
    """Tables and points that may reproduce the element's curve; the roundest numbers first."""
    sheet, *others = element.sheets
    if others:
        return
    rows = sheet.rows
    bent = bool(np.any(rows[:, 3:5]))
    # A cut within one cubic is not a given point.
    new = np.append(True, np.any(np.diff(rows[:, 4:5], axis=0) != 0.0, axis=1))
    every = np.ones(len(rows), bool)
    for form, chosen in (("points", every), ("table", new), ("table", every)):
        if bent is (form == "table"):
            x = np.append(rows[chosen, 0], sheet.end)
            y = np.append(rows[chosen, 1], mechanism.value(rows, np.array(sheet.end)))
            # The last force is computed; with fewer digits it may be the given one.
            largest = math.floor(math.log10(element.largest_force / element.force_scale))
            for digits in (12, 14, 15, 16, 17):
                last = round(float(y[-1]), digits - 1 - largest)
                yield {form: inline(_columns(element.measure, x, np.append(y[:-1], last)))}


def _columns(measure: Measure, x: Floats, y: Floats) -> Written:
    keys = element_schema.COLUMNS[measure]
    return {key: written(key, tuple(c.tolist())) for key, c in zip(keys, (x, y), strict=True)}


def _sheet(sheet: mechanism.Sheet, measure: Measure) -> Written:
    key = element_schema.JOINTS[measure]
    cubics = tuple(map(tuple, sheet.rows[:, 1:].tolist()))
    keys = {key: written(key, (*sheet.rows[:, 0].tolist(), sheet.end))}
    keys["cubics_SI"] = written("cubics_SI", cubics)
    ends = {"below": sheet.below, "above": sheet.above}
    return keys | {side: str(other + 1) for side, other in ends.items() if other is not None}


def _reads_as(keys: Written, wanted: mechanism.Element) -> bool:
    with suppress(ValidationError, InputError):
        tables = parsed("\n".join(lines(keys)), "", "")
        return element_of(element_schema.ElementKeys.model_validate(tables)) == wanted
    return False


class Shared(NamedTuple):
    """Values common to the cells of a chain: fields of a cell, and keys of its band."""

    cell: dict[str, Any]
    band: dict[str, Any]

    @classmethod
    def of(cls, band: dict[str, Any], *tables: chain_schema.SharedKeys) -> "Shared":
        """Common values from `band` and the tables; later tables have priority."""
        given = {key: value for table in tables for key, value in table.given().items()}
        names = given.keys() & {"lever_mm", "limit_deg", "unusual"}
        return cls({field_of(key): si(key, given[key]) for key in names}, band)


def cells_of(
    tables: Sequence[chain_schema.OneCellKeys], shared: Shared, where: str, problems: list[str]
) -> tuple[mechanism.Cell | mechanism.Element, ...]:
    """Cells of a list of tables; a line is added to `problems` for every problem."""
    made = (
        (_element if one.forms else _cell)(shared, one, f"{where}[{i}]", problems)
        for i, one in enumerate(tables)
    )
    return tuple(filter(None, made))


def chain_of(
    cells: Sequence[mechanism.Cell | mechanism.Element], keys: chain_schema.ChainKeys, title: str
) -> mechanism.Chain:
    """The chain of these cells and its actuator; ValueError if they are inconsistent."""
    rigid = mechanism.Chain(cells, title=title)
    right = chain_schema.ACTUATORS[rigid.measure]
    for key in chain_schema.ACTUATORS.values():
        stiffness = getattr(keys, key)
        if stiffness is not None and key != right:
            kind = f"this chain is of {rigid.measure.travel} and {rigid.measure.force}"
            raise InputError(f"{key} = {value_text(stiffness)}: {kind}, so it must be {right}.")
    stiffness = getattr(keys, right)
    return rigid if stiffness is None else mechanism.Chain(cells, si(right, stiffness), title)


def _element(
    shared: Shared, keys: chain_schema.OneCellKeys, where: str, problems: list[str]
) -> mechanism.Element | None:
    before = len(problems)
    inside = getattr(keys, "inside", None)
    cells = () if inside is None else cells_of(inside, shared, f"{where}.inside", problems)
    if len(problems) > before:
        return None
    try:
        if inside is None:
            return element_of(keys, shared.cell.get("unusual", False))
        return with_options(mechanism.Element.from_chain(mechanism.Chain(cells)), keys)
    except mechanism.SlipError as error:
        problems += [f"{where}.{slip_text(slip, key_of(slip))} {UNUSUAL}" for slip in error.slips]
        return None
    except StepwellError as error:
        problems += [f"{where}: {line}" for line in str(error).split("\n")]
        return None


def _cell(
    shared: Shared, keys: chain_schema.OneCellKeys, where: str, problems: list[str]
) -> mechanism.Cell | None:
    before = len(problems)
    own = merged(shared.band, keys.band.given(), f"{where}.band", problems)
    tables = [
        merged(own, placed.given(), f"{where}.bands[{j}]", problems)
        for j, placed in enumerate(keys.bands or ())
    ] or [own | {"p_mm": keys.p_mm, "q_mm": keys.q_mm}]
    if len(problems) > before:
        return None
    values = shared.cell | fields(keys, left_out=["p_mm", "q_mm", "band", "bands", "load_N"])
    try:
        if keys.load_N is not None:
            values["load"] = mechanism.Load.constant(float(keys.load_N))
        elif keys.load_mm_N is not None:
            values["load"] = mechanism.Load(*zip(*values["load"], strict=True))
        return _lever_cell(tuple(tuple(table.items()) for table in tables), tuple(values.items()))
    except mechanism.SlipError as error:
        for slip in error.slips:
            band = None if slip.band is None else tables[slip.band]
            at = f"{where}.bands[{slip.band}]" if keys.bands and band else where
            problems.append(f"{at}.{slip_text(slip, _key(slip, keys, band))} {UNUSUAL}")
        return None
    except ValueError as error:
        problems.append(f"{where}: {error}")
        return None


# Kept, like elements: while one cell of a chain is edited, the others stay the same objects.
@lru_cache(maxsize=256)
def _lever_cell(
    tables: tuple[tuple[tuple[str, Any], ...], ...], values: tuple[tuple[str, Any], ...]
) -> mechanism.Cell:
    return mechanism.Cell(tuple(_band(dict(table)) for table in tables), **dict(values))


def _key(slip: mechanism.Slip, cell: chain_schema.OneCellKeys, band: dict[str, Any] | None) -> str:
    if slip.name.startswith("load."):
        constant = slip.name == "load.force" and cell.load_N is not None
        return "load_N" if constant else "load_mm_N"
    if band is None or slip.name not in ("extension", "tension"):
        return key_of(slip)
    return "table_mm_N" if "table_mm_N" in band else "shape_mm"


UNUSUAL = "If the value is intended, set unusual = true in the table of the cell."


def merged(
    shared: dict[str, Any], own: dict[str, Any], where: str, problems: list[str]
) -> dict[str, Any]:
    """The shared band updated by its own keys; an own law replaces the shared law."""
    laws = set[str]().union(*chain_schema.LAWS.values())
    replaced = {*(laws if laws & own.keys() else ())}
    if "table_mm_N" in own:
        replaced.add("stiffness_N_per_m")
    band = {key: value for key, value in shared.items() if key not in replaced} | own
    if "table_mm_N" in band and "stiffness_N_per_m" in band:
        value = value_text(band.pop("stiffness_N_per_m"))
        problems.append(f"{where}.stiffness_N_per_m = {value}: {chain_schema.TABLE_OWNS_STIFFNESS}")
    return band


def _band(keys: dict[str, Any]) -> mechanism.Band:
    values = {field_of(key): si(key, value) for key, value in keys.items()}
    table, shape = values.pop("table", ()), values.pop("shape", ())
    cubic = values.pop("a2", None), values.pop("a3", None)
    if shape:
        values["law"] = mechanism.Table(*zip(*shape, strict=True))
    elif cubic != (None, None):
        values["law"] = mechanism.Cubic(*(number or 0.0 for number in cubic))
    elif table:
        columns = zip(*table, strict=True)
        measured = mechanism.Band.from_table(values["p"], values["q"], 0.0, *columns)
        values |= {"law": measured.law, "stiffness": measured.stiffness}
    return mechanism.Band(**values)
