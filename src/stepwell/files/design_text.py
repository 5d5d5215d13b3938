"""Text of the design file of a chain or a robot: common values first, then each cell."""

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from stepwell.files.cells import element_lines
from stepwell.files.schema import chain as chain_schema, robot as schema
from stepwell.files.schema.keys import table_lines, written
from stepwell.files.text import Written, array, inline, lines, quoted
from stepwell.mechanism import Band, Cell, Chain, Cubic, Element, Table, slips
from stepwell.robot import Robot, of_robot


class Common(NamedTuple):
    """Keys that are written once for several cells."""

    keys: Written
    band: Written

    def lines(self) -> list[str]:
        """Lines of the [chain] table."""
        return lines(self.keys) + ([f"band = {inline(self.band)}"] if self.band else [])


def chain_text(chain: Chain) -> str:
    """Text of the design file of a chain."""
    shared = _shared_by(chain.cells)
    text = [*_title(chain.title), ""] if chain.title else []
    text += ["[chain]", *lines(shared.keys)]
    if chain.actuator_stiffness != math.inf:
        key = chain_schema.ACTUATORS[chain.measure]
        text += lines(_written({key: chain.actuator_stiffness}))
    text += shared._replace(keys={}).lines()
    for cell in chain.cells:
        text += ["", "[[chain.cell]]", *_cell_lines(cell, shared)]
    return "\n".join(text) + "\n"


def _shared_by(every_cell: Sequence[Cell | Element]) -> Common:
    cells = [cell for cell in every_cell if isinstance(cell, Cell)]
    if not cells:
        return Common({}, {})
    every = [_band(band) for cell in cells for band in cell.bands]
    band = _shared(every, ("stiffness_N_per_m", "rest_length_mm", "two_sided"))
    keys = _shared([_cell(cell) for cell in cells], ("lever_mm", "limit_deg"))
    return Common(keys, band | _shared_law(every))


def _cell_lines(cell: Cell | Element, shared: Common) -> list[str]:
    name = [f"name = {quoted(cell.name)}"] if cell.name else []
    if isinstance(cell, Element):
        return [*name, *element_lines(cell)]
    bands = [_without(_band(band), shared.band) for band in cell.bands]
    return [*name, *_own_bands(bands), *lines(_without(_cell(cell), shared.keys))]


def _without(keys: Written, others: Iterable[str]) -> Written:
    return {key: value for key, value in keys.items() if key not in others}


def _own_bands(bands: list[Written]) -> list[str]:
    if len(bands) > 1:
        return ["bands = [", *(f"    {inline(band)}," for band in bands), "]"]
    anchors = {key: bands[0][key] for key in ("p_mm", "q_mm")}
    rest = _without(bands[0], anchors)
    return lines(anchors) + ([f"band = {inline(rest)}"] if rest else [])


def _shared(tables: list[Written], names: tuple[str, ...]) -> Written:
    first, *others = tables
    alike = (name for name in names if all(one.get(name) == first.get(name) for one in others))
    return {name: first[name] for name in alike if name in first}


def _shared_law(bands: list[Written]) -> Written:
    names = set[str]().union(*chain_schema.LAWS.values())
    laws = [{name: band[name] for name in band if name in names} for band in bands]
    return laws[0] if all(law == laws[0] for law in laws) else {}


def _cell(cell: Cell) -> Written:
    keys: dict[str, Any] = {"lever_mm": cell.lever, "limit_deg": cell.limit}
    if cell.load is not None:
        rows = tuple(zip(cell.load.travel, cell.load.force, strict=True))
        if len(rows) == 1 and rows[0][0] == 0:
            keys["load_N"] = rows[0][1]
        else:
            keys["load_mm_N"] = rows
    if cell.friction:
        keys["friction_N"] = cell.friction
    if cell.mobility != 1.0:
        keys["mobility"] = cell.mobility
    if cell.unusual or slips(cell):  # so that every chain can be read again
        keys["unusual"] = True
    return _written(keys)


def _band(band: Band) -> Written:
    keys: dict[str, Any] = {
        "p_mm": band.p,
        "q_mm": band.q,
        "stiffness_N_per_m": band.stiffness,
        "rest_length_mm": band.rest_length,
    }
    if band.two_sided:
        keys["two_sided"] = True
    if isinstance(band.law, Cubic):
        keys |= {"quadratic_per_mm": band.law.a2, "cubic_per_mm2": band.law.a3}
    if isinstance(band.law, Table):
        if tension := _tension(band, band.law):
            del keys["stiffness_N_per_m"]
        name = "table_mm_N" if tension else "shape_mm"
        keys[name] = tuple(zip(band.law.extension, tension or band.law.shape, strict=True))
    return _written(keys)


def _written(keys: dict[str, Any]) -> Written:
    return {key: written(key, value) for key, value in keys.items()}


def _tension(band: Band, law: Table) -> tuple[float, ...] | None:
    """The law in newtons if it reproduces the band exactly, with few digits; else None."""
    for digits in (15, 16, 17):
        tension = tuple(float(f"{band.stiffness * y:.{digits}g}") for y in law.shape)
        if tension[-1] < 1e-9:
            return None
        again = Band.from_table(band.p, band.q, band.rest_length, law.extension, tension)
        if (again.stiffness, again.law) == (band.stiffness, law):
            return tension
    return None


def robot_text(robot: Robot) -> str:
    """Text of the file of a robot; values common to legs and cells are written once."""
    chains = [leg.chain for leg in robot.legs]
    shared = _shared_by([cell for chain in chains for cell in chain.cells])
    alike = all(chain == chains[0] for chain in chains)
    text = ["[chain]", *(_title(chains[0].title) if alike else []), *shared.lines(), ""]
    if alike:
        text += _cells("chain.cell", chains[0], shared)
    return _text(robot, text, shared, own_chains=not alike)


def whole_text(robot: Robot) -> str:
    """Text of the file of a robot in which every leg and every cell has all its keys."""
    return _text(robot, [], Common({}, {}), own_chains=True)


def _text(robot: Robot, chain: list[str], shared: Common, *, own_chains: bool) -> str:
    odd = robot.unusual or any(of_robot(robot))
    head = [*_title(robot.title), *["unusual = true"] * odd]
    text = [*head, *[""] * bool(head), *chain]
    # Without friction there is no line, as for cells.
    unused = [] if robot.blocks.rail_friction else ["rail_friction_N"]
    for name in schema.PARTS:
        lines_of = table_lines(schema.TABLES[name], getattr(robot, name), left_out=unused)
        text += [f"[{name}]", *lines_of, ""]
    for leg in robot.legs:
        text += ["[[leg]]", *table_lines(schema.LegKeys, leg, left_out=["chain"]), ""]
        if own_chains:
            text += ["[leg.chain]", *_title(leg.chain.title), ""] if leg.chain.title else []
            text += _cells("leg.chain.cell", leg.chain, shared)
    for antenna in robot.antennas:
        text += ["[[antenna]]", *table_lines(schema.AntennaKeys, antenna), ""]
    return "\n".join([*text, *_source(robot)]).rstrip("\n") + "\n"


def _cells(table: str, chain: Chain, shared: Common) -> list[str]:
    parts = ((f"[[{table}]]", *_cell_lines(cell, shared), "") for cell in chain.cells)
    return [line for part in parts for line in part]


def _title(title: str) -> list[str]:
    return [f"title = {quoted(title)}"] if title else []


def _source(robot: Robot) -> list[str]:
    labels = {*robot.sources.values()}
    rows: list[str] = []
    for label in (*schema.SOURCES, *sorted(labels - {*schema.SOURCES})):
        paths = array(quoted(path) for path, source in robot.sources.items() if source == label)
        if label in labels:
            rows.append(f"{label if label.isalpha() else quoted(label)} = {paths}")
    return ["[source]", *rows] if rows else []
