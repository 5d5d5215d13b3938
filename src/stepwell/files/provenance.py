"""Where a robot's numbers come from, put together so that people can read it."""

from __future__ import annotations

import re
from collections.abc import Iterable

from stepwell.files.parameters import Given, parameters
from stepwell.robot import Robot

_ITEM = r'(?:\."(?:[^"\\]|\\.)*"|\.[^.\[]+|\[\d+\])'
_SEVERAL = (re.compile(rf"^leg{_ITEM}"), re.compile(rf"(?<=chain\.cell){_ITEM}"))


def provenance(robot: Robot) -> tuple[Given, ...]:
    """Every number of a robot with its source; what legs and cells share stands once.

    Args:
        robot: any robot.

    Returns:
        In the order of a design file. Coordinates stand together, and `*` in a path means
        every leg or every cell.
    """
    found = _lists(parameters(robot))
    for several in _SEVERAL:
        found = _shared(found, several)
    return tuple(found)


def _lists(numbers: Iterable[Given]) -> list[Given]:
    """The numbers of a list put together, where one source gives all of them."""
    lists: dict[str, list[Given]] = {}
    for number in numbers:
        lists.setdefault(re.sub(r"(?:\[\d+\])+$", "", number.path), []).append(number)
    found: list[Given] = []
    for path, items in lists.items():
        if len({(item.unit, item.source) for item in items}) == 1:
            values = tuple(item.values[0] for item in items)
            found.append(Given(path, values, items[0].unit, items[0].source))
        else:
            found += items
    return found


def _shared(numbers: list[Given], several: re.Pattern[str]) -> list[Given]:
    """Numbers that are alike in every leg or cell, told once."""
    alike: dict[str, list[Given]] = {}
    for number in numbers:
        alike.setdefault(several.sub(_any, number.path), []).append(number)
    count = max((len(items) for path, items in alike.items() if "*" in path), default=0)
    found: list[Given] = []
    told: set[str] = set()
    for number in numbers:
        path = several.sub(_any, number.path)
        items = alike[path]
        same = len({(item.values, item.unit, item.source) for item in items}) == 1
        if path == number.path or not same or len(items) < max(count, 2):
            found.append(number)
        elif path not in told:
            told.add(path)
            found.append(Given(path, number.values, number.unit, number.source))
    return found


def _any(found: re.Match[str]) -> str:
    return "leg.*" if found[0].startswith("leg") else ".*"
