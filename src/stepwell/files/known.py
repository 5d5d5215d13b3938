"""Keys of the numbers in a chain's tables, with units, bounds and defaults."""

import dataclasses
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any, get_args

from stepwell.base import Measure
from stepwell.files.cells import MAKE, merged
from stepwell.files.schema import chain as schema, elements
from stepwell.files.schema.keys import ENDS, Keys, Within, field_of, unit_of, written
from stepwell.mechanism import LIBRARY, Band, Cell, Element

Table = Mapping[str, Any]
Path = tuple[str | int, ...]


@dataclasses.dataclass(frozen=True, slots=True)
class KnownKey:
    """A possible key of a table."""

    path: Path  # from the table of the chain
    label: str
    units: tuple[str, ...]  # of each of its numbers; "" for none
    default: Any  # as in a file; None for no default
    bounds: tuple[float, float] | None  # None if it is not a single number


def known_keys(
    chain: Table, common: Table | None = None
) -> tuple[list[KnownKey], list[list[KnownKey]]]:
    """All possible keys of a chain, and those of each of its cells.

    Nothing is checked, so errors in a table hide none of its keys. `common` is the table common to
    the chains of all legs of a robot; None for a chain.
    """
    cells = [_table(one) for one in _list(chain.get("cell"))]
    shared = _defaults(Cell, ("lever_mm", "limit_deg", "unusual")) | _numbers_of(_table(common))
    band = _band_over(_band(), _table(common))
    own: list[KnownKey] = []
    if any(_form(cell) is None for cell in cells):
        own += _keys((), schema.SharedKeys, shared)
        own += _band_keys(("band",), band, _table(chain.get("band")))
    # Robots have one actuator for all legs, in a separate table.
    if common is None:
        own += _keys((), schema.ChainKeys, {schema.ACTUATORS[_measure(cells)]: "rigid"})
    shared |= _numbers_of(chain)
    band = _band_over(band, chain)
    return own, [list(_of_cell(cell, ("cell", i), shared, band)) for i, cell in enumerate(cells)]


def columns_of(cell: Any) -> tuple[str, str, str] | None:
    """Form of an element's curve and keys of travel and force; None without points."""
    table = _table(cell)
    form = next((one for one in MAKE if one in table), None)
    held = _table(table.get(form)) if form else {}
    for x, y in elements.COLUMNS.values():
        xs, ys = held.get(x), held.get(y)
        if form and isinstance(xs, list) and isinstance(ys, list) and len(xs) == len(ys):
            return form, x, y
    return None


def new_cells() -> dict[str, dict[str, Any]]:
    """Initial table of every kind of cell that can be added to a chain, by name."""
    tables: dict[str, dict[str, Any]] = {"levers and a band": {"p_mm": [-10, 0], "q_mm": [10, 0]}}
    tables |= {form.replace("_", " "): {form: {}} for form in elements.LibraryKeys.model_fields}
    # A force that rises, falls and rises again, in round numbers of each unit.
    for measure, (x, y) in elements.COLUMNS.items():
        points = {x: [0, 4, 12, 16], y: [0, 1, -1, 0.5]}
        tables[f"curve of {measure.travel} and {measure.force}"] = {"points": points}
    return tables


def _of_cell(cell: Table, path: Path, shared: Table, band: Table) -> Iterator[KnownKey]:
    form = _form(cell)
    if form is None:
        numbers = {**shared, **_defaults(Cell, ("friction_N", "mobility")), **_rows_in(cell)}
        numbers["name"] = ""
        if "load_mm_N" not in cell:
            numbers["load_N"] = 0
        if isinstance(cell.get("bands"), list):
            band = _band_over(band, cell)
            for k, one in enumerate(_list(cell["bands"])):
                yield from _band_keys((*path, "bands", k), band, _table(one))
        else:
            yield from _band_keys((*path, "band"), band, _table(cell.get("band")))
        yield from _keys(path, schema.LeverKeys, numbers)
        return
    measure = _measure([cell])
    stops: Any = False
    if form in elements.LibraryKeys.model_fields:
        arguments, stops = LIBRARY[form.replace("_", "-")].defaults, _usual(form).stops
        (table,) = get_args(elements.LibraryKeys.model_fields[form].annotation)[:1]
        numbers = {key: _file_value(key, arguments[field_of(key)]) for key in table.model_fields}
        yield from _keys((*path, form), table, numbers)
    friction = elements.key_in("friction", measure.force_unit)
    numbers = _defaults(Element, ("force_scale", "travel_scale", "mobility"))
    numbers |= {"name": "", "stops": _file_value("stops", stops), friction: 0}
    if form == "table":
        numbers[elements.key_in("noise", measure.force_unit)] = None
    yield from _keys(path, elements.ElementKeys, numbers)


def _keys(path: Path, table: type[Keys], defaults: Table) -> Iterator[KnownKey]:
    """Keys of a table that have a default."""
    for key, field in table.model_fields.items():
        if key not in defaults:
            continue
        pair = key.endswith("_mm_N") or key in _ROWS
        end = next((end for end in ("_mm_N", *ENDS) if key.endswith(end)), "")
        label = key.removesuffix(end).replace("_", " ")
        units = tuple(unit_of(key, column) for column in range(1 + pair))
        bounds = next(_bounds(field.annotation), None)
        yield KnownKey((*path, key), label, units, defaults[key], bounds)


def _bounds(annotation: Any) -> Iterator[tuple[float, float]]:
    for one in get_args(annotation):
        check = getattr(one, "func", None)
        if isinstance(check, Within):
            yield float(check.least), float(check.most)
        yield from _bounds(one)


def _band_keys(path: Path, shared: Table, own: Table) -> Iterator[KnownKey]:
    """Keys of a band without those that its law excludes."""
    law = merged({**shared}, {**own}, "", []).keys()
    hidden: set[str] = set()
    if law & {"table_mm_N", "table_csv", "shape_mm"}:
        hidden = {"two_sided", *_CUBIC}
    if law & {"table_mm_N", "table_csv"}:
        hidden.add("stiffness_N_per_m")
    defaults = {k: shared.get(k, value) for k, value in _band().items() if k not in hidden}
    yield from _keys(path, schema.BandKeys, defaults | _rows_in(own))


def _rows_in(table: Table) -> dict[str, Any]:
    return {key: None for key in _ROWS if key in table}  # they have no default


def _band_over(shared: Table, table: Table) -> dict[str, Any]:
    return merged({**shared}, {**_table(table.get("band"))}, "", [])


_ROWS = ("table_mm_N", "shape_mm", "load_mm_N")
_CUBIC = ("quadratic_per_mm", "cubic_per_mm2")


@cache
def _band() -> Table:
    usual = _defaults(Band, ("stiffness_N_per_m", "rest_length_mm", "two_sided"))
    return usual | dict.fromkeys(_CUBIC, 0)


def _defaults(value: type, keys: Sequence[str]) -> dict[str, Any]:
    by_name = {field.name: field.default for field in dataclasses.fields(value)}
    return {key: _file_value(key, by_name[field_of(key)]) for key in keys}


def _file_value(key: str, value: Any) -> Any:
    return tomllib.loads(f"x = {written(key, value)}")["x"]


def _numbers_of(table: Table) -> dict[str, Any]:
    return {key: table[key] for key in ("lever_mm", "limit_deg", "unusual") if key in table}


def _form(cell: Table) -> str | None:
    return next((form for form in schema.FORMS if form in cell), None)


def _measure(cells: Sequence[Table]) -> Measure:
    """Measure of the first cell that defines one."""
    for cell in cells:
        form = _form(cell)
        if form is None or form in elements.LibraryKeys.model_fields:
            return Measure.TRAVEL if form is None else _usual(form).measure
        for measure, columns in elements.COLUMNS.items():
            if any(key in _table(cell[form]) for key in columns):
                return measure
    return Measure.TRAVEL


@cache
def _usual(form: str) -> Element:
    """The element of the library with its default arguments."""
    return LIBRARY[form.replace("_", "-")].make()


def _table(value: Any) -> Table:
    return value if isinstance(value, Mapping) else {}


def _list(value: Any) -> Sequence[Any]:
    return value if isinstance(value, list) else []
