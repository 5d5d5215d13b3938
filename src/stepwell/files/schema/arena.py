"""The keys of an arena's file: what each may hold, and in which unit."""

from __future__ import annotations

from decimal import Decimal
from typing import Annotated

from pydantic import Field

from stepwell.files.schema.checks import Keys, Line, Point, Switch, at_most, bounded, tables_of
from stepwell.files.schema.robot import Size

Heading = Annotated[Decimal, bounded("-1e6", "1e6")]


class WallKeys(Keys):
    """A straight wall."""

    from_mm: Point
    to_mm: Point
    thickness_mm: Size | None = None


class CylinderKeys(Keys):
    """A cylinder."""

    at_mm: Point
    radius_mm: Size | None = None


class GoalKeys(Keys):
    """The goal."""

    at_mm: Point
    radius_mm: Size | None = None


class ArenaKeys(Keys):
    """A whole arena."""

    title: Line = ""
    start_mm: Point | None = None
    heading_deg: Heading | None = None
    unusual: Switch = False
    goal: GoalKeys | None = None
    wall: Annotated[tuple[WallKeys, ...], Field(strict=False), at_most("obstacles")] = ()
    cylinder: Annotated[tuple[CylinderKeys, ...], Field(strict=False), at_most("obstacles")] = ()


# Where a reader may come from when a path holds one of these keys.
TABLES = tables_of(ArenaKeys)
