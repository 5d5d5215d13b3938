"""A robot as tables that leave nothing out; the numbers in them by path, and their sources."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from typing import Any, NamedTuple

from stepwell.files.schema import robot as schema
from stepwell.files.tables.design_text import whole_text
from stepwell.files.text import Item, Steps, find, parsed, quoted, value_text
from stepwell.robot import Robot

Tree = dict[str, Any]


def tree_of(robot: Robot) -> Tree:
    """The tables of the robot's file, with every key of every leg and every cell."""
    tree = parsed(whole_text(robot), "this robot, written as a design file", "is empty.")
    for leg in tree["leg"]:
        for cell in leg["chain"]["cell"]:
            cell.setdefault("friction_N", Decimal(0))
    return tree


def leaves(tree: Tree) -> Iterator[tuple[Steps, Any]]:
    """The path and the value of everything but names, titles and sources."""
    return _leaves((), {key: value for key, value in tree.items() if key != "source"})


def is_number(value: Any) -> bool:
    """Whether a value counts or measures something, and is not a name or a switch."""
    return isinstance(value, int | Decimal) and not isinstance(value, bool)


def set_leaf(tree: Tree, steps: Steps, value: Any) -> None:
    """Set what stands at a path."""
    place: Any = tree
    for step in steps[:-1]:
        place = place[step.index if isinstance(step, Item) else step]
    last = steps[-1]
    place[last.index if isinstance(last, Item) else last] = value


def _leaves(steps: Steps, value: Any) -> Iterator[tuple[Steps, Any]]:
    if isinstance(value, dict):
        for key, below in value.items():
            if key not in ("title", "name"):
                yield from _leaves((*steps, key), below)
    elif isinstance(value, list):
        names = [one.get("name") if isinstance(one, dict) else None for one in value]
        if steps[-1] == "cell" and len(value) == 2:  # what `Chain.names` calls a pair
            names = [name or other for name, other in zip(names, ("inner", "outer"), strict=True)]
        for i, (one, name) in enumerate(zip(value, names, strict=True)):
            alone = name if name and names.count(name) == 1 else None
            yield from _leaves((*steps, Item(i, alone)), one)
    else:
        yield steps, value


class Sources(NamedTuple):
    """The source of every number, and what is wrong with the lists."""

    of: dict[Steps, str]
    problems: list[str]


class _Said(NamedTuple):
    size: int  # how many numbers the path means
    label: str
    where: str


def sources(robot: Robot, lists: Mapping[str, Sequence[str]]) -> Sources:
    """What lists of key paths, one for each source, say of a robot's numbers.

    Of several paths that mean a number, the one that means the fewest numbers counts.
    """
    numbers = [steps for steps, value in leaves(tree_of(robot)) if is_number(value)]
    said: dict[Steps, list[_Said]] = {steps: [] for steps in numbers}
    problems: list[str] = []
    for label, paths in lists.items():
        for i, path in enumerate(paths):
            if not robot.antennas and path.split(".")[0].split("[")[0] == "antenna":
                continue  # said of antennas that were taken off
            table = label if label.isalpha() else quoted(label)
            where = f"source.{table}[{i}] = {value_text(path)}"
            try:
                found = find(path, numbers)
            except ValueError as error:
                problems.append(f"{where}: {error}")
                continue
            for steps, _ in found:
                said[steps].append(_Said(len(found), label, where))
    of: dict[Steps, str] = {}
    for steps, every in said.items():
        narrowest = min((one.size for one in every), default=0)
        found = [one for one in every if one.size == narrowest]
        one, *others = found or [_Said(0, schema.ASSUMED, "")]
        of[steps] = one.label
        problems += [
            f"{other.where}: {one.label} has that too; keep one of them."
            for other in others
            if other.label != one.label
        ]
    return Sources(of, list(dict.fromkeys(problems)))
