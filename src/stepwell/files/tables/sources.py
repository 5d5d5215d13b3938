"""Where each number of a robot comes from: of all that is said of it, the narrowest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from stepwell.files.schema import ASSUMED
from stepwell.files.tables.tree import is_number, leaves, tree_of
from stepwell.files.text import Steps, find, quoted, value_text
from stepwell.robot import Robot


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
        one, *others = [one for one in every if one.size == narrowest] or [_Said(0, ASSUMED, "")]
        of[steps] = one.label
        problems += [
            f"{other.where}: {one.label} has that too; keep one of them."
            for other in others
            if other.label != one.label
        ]
    return Sources(of, list(dict.fromkeys(problems)))
