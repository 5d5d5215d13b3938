"""The tables of a robot's design file as a robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from stepwell.files.schema import fields, robot as schema, slip_lines
from stepwell.files.tables.cells import Shared, cell, merged
from stepwell.files.tables.sources import sources
from stepwell.files.text import DesignError
from stepwell.mechanism import Chain, SlipError
from stepwell.robot import Antenna, Leg, Robot

T = TypeVar("T")


def robot(keys: schema.RobotKeys, name: str) -> Robot:
    """The robot, with every check; DesignError where that is none, with every reason found."""
    problems: list[str] = []
    parts = {
        name: _made(name, make, fields(getattr(keys, name)), problems)
        for name, (_, make) in schema.PARTS.items()
    }
    legs = [_leg(keys, i, problems) for i in range(len(keys.leg))]
    antennas = [
        _made(f"antenna[{i}]", Antenna, fields(one), problems) for i, one in enumerate(keys.antenna)
    ]
    said = {path: label for label, paths in keys.source.lists().items() for path in paths}
    if not problems:
        try:
            made = Robot(
                legs,  # type: ignore[arg-type]
                antennas=antennas,  # type: ignore[arg-type]
                title=keys.title,
                sources=said,
                unusual=keys.unusual,
                **parts,  # type: ignore[arg-type]
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


def _made(
    where: str, make: Callable[..., T], values: dict[str, Any], problems: list[str]
) -> T | None:
    try:
        return make(**values)
    except ValueError as error:
        problems.append(f"{where}: {error}")
        return None


def _leg(keys: schema.RobotKeys, index: int, problems: list[str]) -> Leg | None:
    leg, where = keys.leg[index], f"leg[{index}]"
    before = len(problems)
    chain = _chain(keys.chain, leg.chain, where, problems)
    if len(problems) > before:
        return None
    values = fields(leg, left_out=["chain"]) | {"chain": chain}
    return _made(where, Leg, values, problems)


def _chain(
    common: schema.LegChainKeys, own: schema.LegChainKeys, leg: str, problems: list[str]
) -> Chain | None:
    where = f"{leg}.chain" if own.cell else "chain"
    shared = Shared(
        own.lever_mm or common.lever_mm,
        own.limit_deg or common.limit_deg,
        own.unusual or common.unusual,
        merged(common.band.given(), own.band.given(), f"{leg}.chain.band", problems),
    )
    tables = own.cell or common.cell
    if not tables:
        problems.append(
            f"{leg}.chain: is missing. Give the cells of all legs under [[chain.cell]], or those "
            f"of this leg under [[leg.chain.cell]]."
        )
        return None
    cells = [cell(one, shared, f"{where}.cell[{i}]", problems) for i, one in enumerate(tables)]
    if any(one is None for one in cells):
        return None
    return Chain(tuple(one for one in cells if one), title=own.title or common.title)
