"""The tables of a robot's design file as a robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from stepwell.files.schema import fields, robot as schema, slip_lines
from stepwell.files.tables.cells import Shared, cells_of, merged
from stepwell.files.tables.tree import sources
from stepwell.files.text import DesignError
from stepwell.mechanism import Chain, SlipError
from stepwell.robot import Antenna, Leg, Robot

T = TypeVar("T")


def robot(keys: schema.RobotKeys, name: str) -> Robot:
    """The robot, with every check; DesignError where that is none, with every reason found."""
    problems: list[str] = []
    parts: dict[str, Any] = {
        name: part_of(name, make, fields(getattr(keys, name)), problems)
        for name, make in schema.PARTS.items()
    }
    legs = [_leg(keys.chain, one, f"leg[{i}]", problems) for i, one in enumerate(keys.leg)]
    antennas: list[Any] = [
        part_of(f"antenna[{i}]", Antenna, fields(one), problems)
        for i, one in enumerate(keys.antenna)
    ]
    said = {path: label for label, paths in keys.source.lists().items() for path in paths}
    if not problems:
        try:
            made = Robot(
                legs,
                antennas=antennas,
                title=keys.title,
                sources=said,
                unusual=keys.unusual,
                **parts,
            )
        except SlipError as error:
            problems += slip_lines(error)
        except ValueError as error:
            problems += str(error).split("\n")
        else:
            problems += sources(made, keys.source.lists()).problems
            if not problems:
                return made
    # A chain that several legs share has its problems once.
    raise DesignError(name, dict.fromkeys(problems))


def part_of(
    where: str, make: Callable[..., T], values: dict[str, Any], problems: list[str]
) -> T | None:
    """A part, or None and a line more in `problems`."""
    try:
        return make(**values)
    except ValueError as error:
        problems.append(f"{where}: {error}")
        return None


def _leg(common: schema.LegChainKeys, keys: schema.LegKeys, where: str, problems: list[str]) -> Any:
    own, before = keys.chain, len(problems)
    band = merged(common.band.given(), own.band.given(), f"{where}.chain.band", problems)
    tables = own.cell or common.cell
    if not tables:
        problems.append(
            f"{where}.chain: is missing. Give the cells of all legs under [[chain.cell]], or those "
            f"of this leg under [[leg.chain.cell]]."
        )
    place = f"{where}.chain.cell" if own.cell else "chain.cell"
    cells = cells_of(tables, Shared.of(band, common, own), place, problems)
    if len(problems) > before:
        return None
    chain = Chain(cells, title=own.title or common.title)
    return part_of(where, Leg, fields(keys, left_out=["chain"]) | {"chain": chain}, problems)
