"""A robot from the tables of its design file, and complete tables of a robot."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import Decimal
from typing import Any, NamedTuple, TypeVar

from stepwell.files.cells import Shared, cells_of, merged
from stepwell.files.design_text import whole_text
from stepwell.files.paths import Item, Steps, find
from stepwell.files.schema import robot as schema
from stepwell.files.schema.keys import fields, lines_of
from stepwell.files.text import DesignError, parsed, quoted, value_text
from stepwell.mechanism import Chain
from stepwell.robot import Antenna, Leg, Robot

Tree = dict[str, Any]


def tree_of(robot: Robot) -> Tree:
    """Tables of the robot's file, with every key of every leg and every cell."""
    tree = parsed(whole_text(robot), "this robot, written as a design file", "is empty.")
    tree["blocks"].setdefault("rail_friction_N", Decimal(0))
    for leg in tree["leg"]:
        for cell in leg["chain"]["cell"]:
            cell.setdefault("friction_N", Decimal(0))
    return tree


def leaves(tree: Tree) -> Iterator[tuple[Steps, Any]]:
    """Path and value of every key except names, titles and sources."""
    return _leaves((), {key: value for key, value in tree.items() if key != "source"})


def is_number(value: Any) -> bool:
    """Whether a value is a number, not a name or a switch."""
    return isinstance(value, int | Decimal) and not isinstance(value, bool)


def set_leaf(tree: Tree, steps: Steps, value: Any) -> None:
    """Set the value at a path."""
    place: Any = tree
    *before, last = (step.index if isinstance(step, Item) else step for step in steps)
    for step in before:
        place = place[step]
    place[last] = value


def _leaves(steps: Steps, value: Any) -> Iterator[tuple[Steps, Any]]:
    if isinstance(value, dict):
        for key, below in value.items():
            if key not in ("title", "name"):
                yield from _leaves((*steps, key), below)
    elif isinstance(value, list):
        names = [one.get("name") if isinstance(one, dict) else None for one in value]
        if steps[-1] == "cell" and len(value) == 2:  # the names of a pair in `Chain.names`
            names = [name or other for name, other in zip(names, ("inner", "outer"), strict=True)]
        for i, (one, name) in enumerate(zip(value, names, strict=True)):
            alone = name if name and names.count(name) == 1 else None
            yield from _leaves((*steps, Item(i, alone)), one)
    else:
        yield steps, value


class _SourcePath(NamedTuple):
    size: int  # count of the numbers that the path selects
    label: str
    where: str


def sources(robot: Robot, lists: Mapping[str, Sequence[str]]) -> tuple[dict[Steps, str], list[str]]:
    """Source of every number from lists of key paths, one for each source; and problems.

    Of several paths that select a number, the one with the fewest numbers has priority.
    """
    named_by, problems = _paths_by_number(robot, lists)
    of: dict[Steps, str] = {}
    for steps, every in named_by.items():
        narrowest = min((one.size for one in every), default=0)
        narrow = [one for one in every if one.size == narrowest]
        label = narrow[0].label if narrow else schema.ASSUMED
        of[steps] = label
        others = [one.where for one in narrow if one.label != label]
        problems += [f"{where}: {label} lists it too; keep one of them." for where in others]
    return of, list(dict.fromkeys(problems))


def _paths_by_number(
    robot: Robot, lists: Mapping[str, Sequence[str]]
) -> tuple[dict[Steps, list[_SourcePath]], list[str]]:
    """Paths that select each number of a robot, and problems with other paths."""
    named_by: dict[Steps, list[_SourcePath]] = {
        steps: [] for steps, value in leaves(tree_of(robot)) if is_number(value)
    }
    problems: list[str] = []
    for label, paths in lists.items():
        table = label if label.isalpha() else quoted(label)
        for i, path in enumerate(paths):
            if not robot.antennas and re.match(r"antenna([.\[]|$)", path):
                continue  # sources of antennas that were removed
            where = f"source.{table}[{i}] = {value_text(path)}"
            try:
                matches = find(path, named_by)
            except ValueError as error:
                problems.append(f"{where}: {error}")
                continue
            for steps, _ in matches:
                named_by[steps].append(_SourcePath(len(matches), label, where))
    return named_by, problems


T = TypeVar("T")


def robot(keys: schema.RobotKeys, name: str) -> Robot:
    """The checked robot; DesignError with all problems."""
    problems: list[str] = []
    parts: dict[str, Any] = {
        part: part_of(part, make, fields(getattr(keys, part)), problems)
        for part, make in schema.PARTS.items()
    }
    legs = [_leg(keys.chain, one, f"leg[{i}]", problems) for i, one in enumerate(keys.leg)]
    antennas: list[Any] = [
        part_of(f"antenna[{i}]", Antenna, fields(one), problems)
        for i, one in enumerate(keys.antenna)
    ]
    source_labels = {path: label for label, paths in keys.source.lists().items() for path in paths}
    if not problems:
        how = {"title": keys.title, "sources": source_labels, "unusual": keys.unusual, **parts}
        try:
            made = Robot(legs, antennas=antennas, **how)
        except ValueError as error:
            # The only attribute with another name in files.
            problems += [
                line.replace("drive.amplitude", "drive.stroke_mm") for line in lines_of(error)
            ]
        else:
            problems += sources(made, keys.source.lists())[1]
            if not problems:
                return made
    # Problems of a chain common to several legs are reported once.
    raise DesignError(name, dict.fromkeys(problems))


def part_of(
    where: str, make: Callable[..., T], values: dict[str, Any], problems: list[str]
) -> T | None:
    """A part, or None with a line added to `problems`."""
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
        way = "Give the cells of all legs under [[chain.cell]], or those of this leg under"
        problems.append(f"{where}.chain: is missing. {way} [[leg.chain.cell]].")
    place = f"{where}.chain.cell" if own.cell else "chain.cell"
    cells = cells_of(tables, Shared.of(band, common, own), place, problems)
    if len(problems) > before:
        return None
    chain = Chain(cells, title=own.title or common.title)
    return part_of(where, Leg, fields(keys, left_out=["chain"]) | {"chain": chain}, problems)
