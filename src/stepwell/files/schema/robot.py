"""The keys of a robot's design file with their values and units."""

from decimal import Decimal
from itertools import islice
from typing import Annotated, Any

from pydantic import Field, PlainValidator, model_validator

from stepwell.base import nearest_word
from stepwell.files.schema import chain as schema, keys
from stepwell.files.schema.chain import Stiffness
from stepwell.files.schema.elements import Friction
from stepwell.files.text import did_you_mean
from stepwell.robot import FROM_PARTS, Blocks, Body, Drive, Floor, Foot, Profile


def _centre(value: Any) -> tuple[Decimal, ...]:
    problem = "must be three numbers from -1e6 to 1e6, in mm, as in [24, 0, 12]."
    return keys.lengths(value, 3, problem)


def _supports(value: Any) -> tuple[tuple[Decimal, ...], ...]:
    example = "[[-55, 0], [38, 45], [38, -45]]"
    problem = f"must be three points or more from -1e6 to 1e6, in mm, as in {example}."
    points = keys.listed("supports", value, 3, problem)
    return tuple(keys.lengths(point, 2, problem) for point in points)


def _profile(value: Any) -> str:
    known = [str(profile) for profile in Profile]
    if value not in known:
        near = f" {did_you_mean(value, known)}" if isinstance(value, str) else ""
        keys.refuse(f"must be one of {', '.join(map(repr, known))}.{near}")
    return value


def _cell(value: Any) -> int | str:
    if not (isinstance(value, str) or (type(value) is int and 1 <= value <= 10**6)):
        must = "the name of a cell in quotes, or its number, 1 for the innermost"
        keys.refuse(f'must be {must}, as in "inner" or 1.')
    return value


def _paths(value: Any) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(path, str) for path in value):
        keys.refuse('must be a list of keys in quotes, as in ["chain", "foot.link_mm"].')
    return tuple(keys.require_at_most("sources", value))


Size = Annotated[Decimal, keys.above_zero("1e-6", "1e6")]
Mass = Annotated[Decimal, keys.above_zero("1e-6", "1e9")]
Damping = Annotated[Decimal, keys.above_zero("1e-12", "1e9")]
Time = Annotated[Decimal, keys.above_zero("1e-6", "1e6")]
Grip = Annotated[Decimal, keys.above_zero("1e-6", "1e6")]
Swing = Annotated[Decimal, keys.above_zero("1e-3", "360")]
Turned = Annotated[Decimal, keys.bounded("-360", "360")]
Centre = Annotated[tuple[Decimal, ...], PlainValidator(_centre)]
Supports = Annotated[tuple[tuple[Decimal, ...], ...], PlainValidator(_supports)]
ProfileName = Annotated[str, PlainValidator(_profile)]
CellName = Annotated[int | str, PlainValidator(_cell)]
Paths = Annotated[tuple[str, ...], PlainValidator(_paths)]


class LegChainKeys(schema.SharedKeys):
    """The chain of a leg, or keys common to the chains of all legs."""

    title: keys.Line = ""
    cell: Annotated[tuple[schema.CellKeys, ...], keys.at_most("cells")] = ()

    @model_validator(mode="after")
    def _some_cell(self) -> "LegChainKeys":
        if "cell" in self.model_fields_set and not self.cell:
            keys.refuse("must hold two cells or more, inner first.", "cell")
        return self


class BodyKeys(keys.Keys):
    """The body and its passive supports."""

    mass_g: Mass | None = None
    centre_mm: Centre | None = None
    supports_mm: Supports | None = None
    length_mm: Size | None = None
    width_mm: Size | None = None
    wall_friction: Friction | None = None


class FootKeys(keys.Keys):
    """The V-shaped links and the foot of every leg."""

    link_mm: Size | None = None
    span_mm: Size | None = None
    mass_g: Mass | None = None
    below_mm: Friction | None = None
    radius_mm: Size | None = None


class BlocksKeys(keys.Keys):
    """The moving blocks of every leg."""

    mass_g: Mass | None = None
    carriage_g: Mass | None = None
    damping_N_s_per_m: Damping | None = None
    width_mm: Size | None = None
    length_mm: Size | None = None
    outer_g: Mass | None = None
    rail_friction_N: Friction | None = None


class FloorKeys(keys.Keys):
    """The floor."""

    drag_N: Friction | None = None
    foot_friction: Grip | None = None
    gravity_m_per_s2: Friction | None = None


class DriveKeys(keys.Keys):
    """The one actuator."""

    stroke_mm: Size | None = None
    period_s: Time | None = None
    profile: ProfileName | None = None
    stiffness_N_per_m: Stiffness | None = None
    speed_mm_per_s: Size | None = None


# The parts of a robot by the names of their tables.
PARTS = {"body": Body, "foot": Foot, "blocks": Blocks, "floor": Floor, "drive": Drive}


class LegKeys(keys.Keys):
    """A leg."""

    name: keys.Line
    at_mm: keys.Point
    chain: LegChainKeys = LegChainKeys()


class AntennaKeys(keys.Keys):
    """An antenna."""

    name: keys.Line
    pivot_mm: keys.Point
    length_mm: Size
    angle_deg: Turned
    leg: keys.Line
    cell: CellName | None = None
    moves_mm: keys.Point
    swing_deg: Swing | None = None
    hook_mm: Friction | None = None
    hook_deg: Turned | None = None
    mass_g: Mass | None = None
    damping_N_m_s_per_rad: Damping | None = None
    friction: Friction | None = None
    connected: keys.Switch | None = None


# Possible sources of a number; the first is the default.
ASSUMED = "assumed"
SOURCES = ("paper", "authors' notes", "measured", FROM_PARTS, ASSUMED)


class SourceKeys(keys.Keys):
    """Sources of the numbers."""

    paper: Paths = ()
    authors_notes: Paths = Field(default=(), alias="authors' notes")
    measured: Paths = ()
    from_parts: Paths = Field(default=(), alias=FROM_PARTS)
    assumed: Paths = ()

    def lists(self) -> dict[str, tuple[str, ...]]:
        """The key paths under each source."""
        lists = (self.paper, self.authors_notes, self.measured, self.from_parts, self.assumed)
        return dict(zip(SOURCES, lists, strict=True))


class RobotKeys(keys.Keys):
    """A robot's whole design file."""

    title: keys.Line = ""
    chain: LegChainKeys = LegChainKeys()
    body: BodyKeys = BodyKeys()
    foot: FootKeys = FootKeys()
    blocks: BlocksKeys = BlocksKeys()
    floor: FloorKeys = FloorKeys()
    drive: DriveKeys = DriveKeys()
    leg: Annotated[tuple[LegKeys, ...], keys.at_most("legs")]
    antenna: Annotated[tuple[AntennaKeys, ...], keys.at_most("antennas")] = ()
    source: SourceKeys = SourceKeys()
    unusual: keys.Switch = False


# Tables by path, used in messages on unknown keys.
TABLES = keys.tables_of(RobotKeys)
_LOOKED_AT = 100  # largest number of keys of a file that are checked for spelling
_ONLY_ROBOTS = RobotKeys.model_fields.keys() - schema.FileKeys.model_fields.keys()


def is_robot(tables: dict[str, Any]) -> bool:
    """Whether the tables are those of a robot, possibly with a misspelt or missing leg."""
    if any(key in _ONLY_ROBOTS for key in tables):
        return True
    return any(nearest_word(key, ["leg"]) for key in islice(tables, _LOOKED_AT))
