"""A robot as the tables of a file that leaves nothing out, and the numbers in them by path."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal
from typing import Any

from stepwell.files.tables.robot_text import whole_text
from stepwell.files.text import Item, Steps, parsed
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
    for key, value in tree.items():
        if key not in ("title", "name", "source"):
            yield from _leaves((key,), value)


def is_number(value: Any) -> bool:
    """Whether a value counts or measures something, and is not a name or a switch."""
    return isinstance(value, int | Decimal) and not isinstance(value, bool)


def put(tree: Tree, steps: Steps, value: Any) -> None:
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
