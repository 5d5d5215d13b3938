"""Build files: sizes of sheet, pins, levers, hooks and bands, and the presets of materials."""

import math
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files as packaged
from typing import Annotated, Any, NamedTuple

from pydantic import PlainValidator, create_model

from stepwell.base import ByValue, InputError, Vec2, nearest_word, to_unit
from stepwell.files import DesignError, checked, did_you_mean, keys, parsed, text_of


@dataclass(frozen=True, slots=True, eq=False)
class SheetSizes(ByValue):
    """The material of all flat parts and the machine that cuts or prints them.

    Attributes:
        material: its name in file names and lists.
        thickness, density, strength: [m], [kg/m³], allowed stress [Pa].
        bed: width and height of the machine's bed [m].
        kerf_x, kerf_y: width of the cut along x and y [m]; 0 until a coupon was measured.
        bridge: least web between two openings, or an opening and the edge [m].
        corner: radius of outer corners [m].
    """

    material: str
    thickness: float
    density: float
    strength: float
    bed: Vec2
    kerf_x: float
    kerf_y: float
    bridge: float
    corner: float


@dataclass(frozen=True, slots=True, eq=False)
class PinSizes(ByValue):
    """Pins of the joints: diameter, clearance in plates and in levers [m], allowed stress [Pa]."""

    diameter: float
    plate_fit: float
    lever_fit: float
    strength: float


@dataclass(frozen=True, slots=True, eq=False)
class LeverSizes(ByValue):
    """Width, spacing of a block's two joints, clearance to spacers, shim thickness [m]."""

    width: float
    spacing: float
    clearance: float
    shim: float


@dataclass(frozen=True, slots=True, eq=False)
class BlockSizes(ByValue):
    """Distance of holes from the edge, and clearance of the blocks of one row [m]."""

    edge: float
    clearance: float


@dataclass(frozen=True, slots=True, eq=False)
class StopSizes(ByValue):
    """Angles θc [rad] at which faces stop a cell, and the gap of faces that do not stop [m]."""

    faces_from: float
    faces_to: float
    gap: float


@dataclass(frozen=True, slots=True, eq=False)
class GridSizes(ByValue):
    """Grid of holes for anchors: pitch, reach along and across the stroke [m]."""

    pitch: float
    side: float
    depth: float


@dataclass(frozen=True, slots=True, eq=False)
class HookSizes(ByValue):
    """Hooks: diameter, clearance of bands above nuts, height and width of their caps [m]."""

    diameter: float
    clearance: float
    cap: float
    cap_width: float


@dataclass(frozen=True, slots=True, eq=False)
class BandSizes(ByValue):
    """Rubber bands: width along the hook, thickness, gap of two levels, free lengths [m].

    `largest_stretch` is the largest length over the free length [1].
    """

    width: float
    thickness: float
    gap: float
    largest_stretch: float
    free_lengths: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ScrewSizes(ByValue):
    """Clamp screws: diameter, hole, height and width of head and nut [m]."""

    diameter: float
    hole: float
    head: float
    head_width: float
    nut: float
    nut_width: float


@dataclass(frozen=True, slots=True, eq=False)
class ActuatorLimits(ByValue):
    """Travel [m] and force [N] that the actuator can give."""

    travel: float
    force: float


@dataclass(frozen=True, slots=True, eq=False)
class RobotSizes(ByValue):
    """Sizes of a robot's rails, sliders, feet, cranks and bought boxes.

    Attributes:
        guide, rail, rail_fit: length of a slider in its rail, width of the rail, clearance on
            either side [m].
        flange: by how much flanges and tops of sliders overlap the plate on either side [m].
        slot_fit: clearance on either side of a pin in a transverse slot [m].
        gap: between sliders, tabs and blocks that pass each other [m].
        link_width, foot_radius: of the V's links, and of the discs at its apex [m].
        standoff: length of the posts of the T-foot [m].
        crank_arm, cord_arm: from the crank's pivot to the anchor, from the antenna's hub to the
            cord [m].
        battery, board: length, width and height of the room for each [m].
        battery_mass, board_mass: [kg].
    """

    guide: float
    rail: float
    rail_fit: float
    flange: float
    slot_fit: float
    gap: float
    link_width: float
    foot_radius: float
    standoff: float
    crank_arm: float
    cord_arm: float
    battery: tuple[float, ...]
    battery_mass: float
    board: tuple[float, ...]
    board_mass: float


@dataclass(frozen=True, slots=True, eq=False)
class LinearActuator(ByValue):
    """The linear actuator of a robot.

    Attributes:
        name: for the parts list.
        travel, closed: stroke, and distance of its two holes when the rod is in [m].
        length, width, height: of its housing [m].
        behind: from the hole of the housing to its end [m].
        rod: width of the rod [m].
        force, speed: that it reaches, and its speed under the load of the legs [N, m/s].
        mass, rod_mass: of the housing and of the rod [kg].
    """

    name: str
    travel: float
    closed: float
    length: float
    width: float
    height: float
    behind: float
    rod: float
    force: float
    speed: float
    mass: float
    rod_mass: float


@dataclass(frozen=True, slots=True, eq=False)
class BuildErrors(ByValue):
    """Errors of a build: holes (radius), joints (slop), stops, kerf [m]; bands, relative [1]."""

    hole: float
    joint: float
    stop: float
    kerf: float
    stiffness: float
    rest_length: float


@dataclass(frozen=True, slots=True, eq=False)
class BuildFile(ByValue):
    """All sizes with which the parts of a mechanism are made; one field for each table."""

    title: str
    sheet: SheetSizes
    pin: PinSizes
    lever: LeverSizes
    block: BlockSizes
    stop: StopSizes
    grid: GridSizes
    hook: HookSizes
    band: BandSizes
    screw: ScrewSizes
    actuator: ActuatorLimits
    robot: RobotSizes
    linear_actuator: LinearActuator
    tolerance: BuildErrors

    def __repr__(self):
        return f"BuildFile({self.title!r})"

    @property
    def foot_radius(self) -> float:
        """Radius of the feet under screw heads in the layer of arc slots [m]."""
        return max(self.screw.head_width / 2.0, self.screw.hole / 2.0 + self.sheet.bridge)

    def with_lengths(self, **lengths: float) -> "BuildFile":
        """A copy with other numbers [SI], each named "table__field", such as lever__width.

        Raises:
            ValueError: no such number.
        """
        changed = self
        for name, value in lengths.items():
            table, _, field = name.partition("__")
            held: Any = getattr(changed, table, None)
            if (table, field) not in _every_field():
                known = [f"{t}__{f}" for t, f in _every_field()]
                near = nearest_word(name, known) or "lever__width"
                raise InputError(f"{name}: no number of a build file. Did you mean {near}?")
            own: Any = {field: value}
            whole: Any = {table: replace(held, **own)}
            changed = replace(changed, **whole)
        return changed


class _Range(NamedTuple):
    """Allowed numbers of a key, as in the file."""

    least: str
    most: str


_SIZE = _Range("0.05", "1000")
_FIT = _Range("0", "5")
_STRESS = _Range("0.1", "5000")
_ANGLE = _Range("0", "90")
_PERCENT = _Range("0", "24")


_MASS = _Range("0.01", "1e5")


def _box(value: Any) -> Any:
    return keys.lengths(value, 3, "must be three numbers in mm, as in [45, 30, 16].")


def _list(value: Any) -> Any:
    return keys.lengths(value, None, "must be a list of numbers in mm, as in [10, 15, 20].")


# Keys and allowed numbers of all tables; the value that each table becomes.
_TABLES: dict[str, tuple[type, dict[str, Any]]] = {
    "sheet": (
        SheetSizes,
        {
            "material": keys.Line,
            "thickness_mm": _Range("0.5", "30"),
            "density_kg_per_m3": _Range("10", "20000"),
            "strength_MPa": _STRESS,
            "bed_mm": keys.Point,
            "kerf_x_mm": _Range("-1", "2"),
            "kerf_y_mm": _Range("-1", "2"),
            "bridge_mm": _FIT,
            "corner_mm": _FIT,
        },
    ),
    "pin": (
        PinSizes,
        {
            "diameter_mm": _SIZE,
            "plate_fit_mm": _Range("-0.5", "2"),
            "lever_fit_mm": _Range("0", "2"),
            "strength_MPa": _STRESS,
        },
    ),
    "lever": (
        LeverSizes,
        {"width_mm": _SIZE, "spacing_mm": _SIZE, "clearance_mm": _FIT, "shim_mm": _FIT},
    ),
    "block": (BlockSizes, {"edge_mm": _SIZE, "clearance_mm": _SIZE}),
    "stop": (StopSizes, {"faces_from_deg": _ANGLE, "faces_to_deg": _ANGLE, "gap_mm": _FIT}),
    "grid": (
        GridSizes,
        {"pitch_mm": _SIZE, "side_mm": _FIT._replace(most="1000"), "depth_mm": _SIZE},
    ),
    "hook": (
        HookSizes,
        {"diameter_mm": _SIZE, "clearance_mm": _FIT, "cap_mm": _SIZE, "cap_width_mm": _SIZE},
    ),
    "band": (
        BandSizes,
        {
            "width_mm": _SIZE,
            "thickness_mm": _SIZE,
            "gap_mm": _FIT,
            "largest_stretch": _Range("1", "20"),
            "free_lengths_mm": Annotated[tuple[Any, ...], PlainValidator(_list)],
        },
    ),
    "screw": (
        ScrewSizes,
        {
            "diameter_mm": _SIZE,
            "hole_mm": _SIZE,
            "head_mm": _SIZE,
            "head_width_mm": _SIZE,
            "nut_mm": _SIZE,
            "nut_width_mm": _SIZE,
        },
    ),
    "actuator": (ActuatorLimits, {"travel_mm": _SIZE, "force_N": _Range("0.001", "1e6")}),
    "robot": (
        RobotSizes,
        {
            "guide_mm": _SIZE,
            "rail_mm": _SIZE,
            "rail_fit_mm": _Range("0", "2"),
            "flange_mm": _SIZE,
            "slot_fit_mm": _Range("0", "2"),
            "gap_mm": _SIZE,
            "link_width_mm": _SIZE,
            "foot_radius_mm": _SIZE,
            "standoff_mm": _SIZE,
            "crank_arm_mm": _SIZE,
            "cord_arm_mm": _SIZE,
            "battery_mm": Annotated[tuple[Any, ...], PlainValidator(_box)],
            "battery_mass_g": _MASS,
            "board_mm": Annotated[tuple[Any, ...], PlainValidator(_box)],
            "board_mass_g": _MASS,
        },
    ),
    "linear_actuator": (
        LinearActuator,
        {
            "name": keys.Line,
            "travel_mm": _SIZE,
            "closed_mm": _SIZE,
            "length_mm": _SIZE,
            "width_mm": _SIZE,
            "height_mm": _SIZE,
            "behind_mm": _SIZE,
            "rod_mm": _SIZE,
            "force_N": _Range("0.001", "1e6"),
            "speed_mm_per_s": _Range("0.01", "1e4"),
            "mass_g": _MASS,
            "rod_mass_g": _MASS,
        },
    ),
    "tolerance": (
        BuildErrors,
        {
            **dict.fromkeys(("hole_mm", "joint_mm", "stop_mm", "kerf_mm"), _FIT),
            **dict.fromkeys(("stiffness_percent", "rest_length_percent"), _PERCENT),
        },
    ),
}


def _every_field() -> list[tuple[str, str]]:
    return [(table, keys.field_of(key)) for table, (_, own) in _TABLES.items() for key in own]


def mm(value: float) -> str:
    """A length [m] as a number of millimetres."""
    return f"{to_unit(value, 'mm'):.4g}"


def key_of(table: str, field: str) -> str:
    """The key of a field in a build file: "lever", "width" is lever.width_mm."""
    return next(f"{table}.{key}" for key in _TABLES[table][1] if keys.field_of(key) == field)


@cache
def _schema() -> type[keys.Keys]:
    """The keys of a whole build file, for checks and messages."""
    make: Any = create_model
    models: dict[str, Any] = {"title": (keys.Line, "")}
    for name, (value, own) in _TABLES.items():
        checks = {
            key: (keys.bounded_number(*allowed) if isinstance(allowed, _Range) else allowed, ...)
            for key, allowed in own.items()
        }
        models[name] = make(value.__name__, __base__=keys.Keys, **checks), ...
    return make("BuildFile", __base__=keys.Keys, **models)


_FOLDER = "presets"
# Holes of the grid at one pair of joints: files and pictures of more take minutes.
_MOST_HOLES = 1000


@cache
def _texts() -> Mapping[str, str]:
    folder = packaged("stepwell.build") / _FOLDER
    return {
        one.name.removesuffix(".toml"): one.read_text("utf-8")
        for one in sorted(folder.iterdir(), key=lambda one: one.name)
        if one.name.endswith(".toml")
    }


def build_presets() -> list[str]:
    """Names of the build files in the package."""
    return list(_texts())


def preset_text(name: str) -> str:
    """Text of a build file of the package, with the sources of its numbers.

    Raises:
        DesignError: there is none of that name; the message has the nearest name.
    """
    if name not in _texts():
        advice = did_you_mean(name, _texts())
        raise DesignError(f"build file {name}", [f"no such preset. {advice}"])
    return _texts()[name]


def load_build_file(material: str | os.PathLike[str]) -> BuildFile:
    """The build file with this name or path, in SI.

    Args:
        material: a name that `build_presets` lists, such as "acrylic-3mm"; or a file that ends in
            .toml. Its key `base` names the preset whose numbers it keeps, "acrylic-3mm" if absent.

    Raises:
        DesignError: there is none, or it is invalid; a line for every problem.
    """
    name = os.fspath(material)
    bare = name.removeprefix("preset:")
    if bare in _texts():
        return loads_build_file(_texts()[bare], bare)
    if not name.endswith(".toml"):
        advice = did_you_mean(bare, _texts())
        raise DesignError(
            f"build file {name}", [f"no such preset, and no file that ends in .toml. {advice}"]
        )
    return loads_build_file(text_of(name), name)


def loads_build_file(text: str, name: str = "build file") -> BuildFile:
    """The build file in a TOML text, in SI; `name` is its name in messages.

    Raises:
        DesignError: the text is invalid; a line for every problem.
    """
    tables = parsed(text, name, "is empty: a build file has one key or more, as in [sheet].")
    whole = _on_base(tables, name)
    read: Any = checked(_schema(), whole, name)
    values: dict[str, Any] = {
        table: kind(**keys.fields(getattr(read, table))) for table, (kind, _) in _TABLES.items()
    }
    made = BuildFile(title=read.title, **values)
    if problems := _problems(made):
        raise DesignError(name, problems)
    return made


def dumps_build_file(build_file: BuildFile) -> str:
    """The TOML text of a build file, with all of its numbers; reading it gives an equal value."""
    lines = [f"title = {keys.written('title', build_file.title)}"]
    for table, (_, own) in _TABLES.items():
        held = getattr(build_file, table)
        lines += ["", f"[{table}]"]
        for key in own:
            lines.append(f"{key} = {keys.written(key, getattr(held, keys.field_of(key)))}")
    return "\n".join(lines) + "\n"


def _on_base(tables: dict[str, Any], name: str) -> dict[str, Any]:
    """The tables of the file on those of the preset that it names."""
    if name in _texts():
        return tables
    own = dict(tables)
    base = own.pop("base", "acrylic-3mm")
    if base not in _texts():
        raise DesignError(
            name, [f"base = {base!r}: no such preset. {did_you_mean(str(base), _texts())}"]
        )
    whole: dict[str, Any] = parsed(_texts()[base], base, "is empty.")
    whole["title"] = f"{whole['title']}, changed"
    for key, value in own.items():
        both = isinstance(value, dict) and isinstance(whole.get(key), dict)
        whole[key] = {**whole[key], **value} if both else value
    return whole


def _problems(build_file: BuildFile) -> list[str]:
    """Numbers that contradict each other, one line each."""
    sheet, pin, lever, screw = build_file.sheet, build_file.pin, build_file.lever, build_file.screw

    problems: list[str] = []
    hole = pin.diameter + pin.lever_fit
    least = hole + 2.0 * sheet.bridge
    if lever.width < least - 1e-12:
        problems.append(
            f"lever.width_mm = {mm(lever.width)}: must be >= {mm(least)}, the hole of "
            f"{mm(hole)} mm and a web of {mm(sheet.bridge)} mm on both sides."
        )
    if lever.spacing < lever.width:
        problems.append(
            f"lever.spacing_mm = {mm(lever.spacing)}: must be >= lever.width_mm = "
            f"{mm(lever.width)}, or the two levers of a cell overlap."
        )
    if hole < sheet.thickness / 2:
        problems.append(
            f"pin.diameter_mm = {mm(pin.diameter)}: must be >= {mm(sheet.thickness / 2)}, half of "
            f"sheet.thickness_mm: smaller holes cannot be cut."
        )
    if screw.hole < screw.diameter:
        problems.append(
            f"screw.hole_mm = {mm(screw.hole)}: must be >= screw.diameter_mm = "
            f"{mm(screw.diameter)}."
        )
    if build_file.block.edge < screw.hole / 2 + sheet.bridge:
        problems.append(
            f"block.edge_mm = {mm(build_file.block.edge)}: must be >= "
            f"{mm(screw.hole / 2 + sheet.bridge)}, half a screw hole and a web."
        )
    if build_file.stop.faces_from > build_file.stop.faces_to:
        problems.append("stop.faces_from_deg: must be <= stop.faces_to_deg.")
    if min(sheet.bed) <= 0.0:
        problems.append("sheet.bed_mm: both numbers must be > 0.")
    if not re.fullmatch(r"\w[\w .+-]*", sheet.material):
        problems.append(
            f"sheet.material = {sheet.material!r}: names files, so it must have letters, digits, "
            f"spaces and . + - _ only, as in acrylic."
        )
    return problems + _grid_problems(build_file)


def _above(length: float) -> str:
    """A length [m] as a number of millimetres that is not below it."""
    return f"{math.ceil(to_unit(length, 'mm') * 100.0 - 1e-6) / 100.0:g}"


def _grid_problems(build_file: BuildFile) -> list[str]:
    """Whether the holes of the grid leave webs, and are few enough to drill."""
    grid = build_file.grid
    hole = build_file.hook.diameter + build_file.pin.plate_fit
    least = hole + build_file.sheet.bridge
    if grid.pitch < least - 1e-12:
        return [
            f"grid.pitch_mm = {mm(grid.pitch)}: must be >= {_above(least)}, a hole for hooks of "
            f"{mm(hole)} mm and a web of {mm(build_file.sheet.bridge)} mm."
        ]
    holes = (2 * int(grid.side / grid.pitch) + 1) * (int(grid.depth / grid.pitch) + 1)
    if holes > _MOST_HOLES:
        return [
            f"grid.side_mm = {mm(grid.side)}, grid.depth_mm = {mm(grid.depth)}: with grid.pitch_mm "
            f"= {mm(grid.pitch)} these are {holes} holes a cell on each block, and at most "
            f"{_MOST_HOLES} are drilled: use a larger pitch or a smaller grid."
        ]
    return []
