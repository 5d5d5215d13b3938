"""The numbers of a robot by name, with their sources; robots with changed numbers."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any

from stepwell.base import ByValue, InputError, grouped
from stepwell.files.design import loads
from stepwell.files.paths import Item, Steps, find, spelled
from stepwell.files.robots import is_number, leaves, robot as robot_of, set_leaf, sources, tree_of
from stepwell.files.schema import keys, robot as schema, wording
from stepwell.files.text import refuse_any, value_text
from stepwell.robot import Robot

_ITEM = r'(?:\."(?:[^"\\]|\\.)*"|\.[^.\[]+|\[\d+\])'
_SEVERAL = (re.compile(rf"^leg{_ITEM}"), re.compile(rf"(?<=chain\.cell){_ITEM}"))


@dataclass(frozen=True, slots=True, eq=False)
class RobotParameter(ByValue):
    """A number of a robot, or several of one list, and their source.

    Attributes:
        path: the key path for `vary`, such as "foot.link_mm" or
            "leg.left.chain.cell.inner.q_mm[0]".
        values: (n,) in the unit of the key.
        unit: of the key, such as "mm", "deg" or "N s/m"; "" for none.
        source: "paper", "authors' notes", "measured", "from the parts" or "assumed".
    """

    path: str
    values: tuple[float, ...]
    unit: str
    source: str

    def __str__(self):
        unit = f" {self.unit}" if self.unit else ""
        numbers = ", ".join(f"{value:.10g}" for value in self.values)
        return f"{self.path} = {numbers}{unit} ({self.source})"


def parameters(robot: Robot) -> tuple[RobotParameter, ...]:
    """Each number of a robot separately, also defaults, in the order of its file."""
    of, _ = sources(robot, _paths_by_source(robot))
    return tuple(
        RobotParameter(spelled(steps), (float(value),), _unit(steps), of[steps])
        for steps, value in leaves(tree_of(robot))
        if is_number(value) and steps in of
    )


def vary(robot: Robot | str, values: Mapping[str, Any]) -> Robot:
    """The same robot with other values, checked like a design file.

    The source of a changed number is "assumed". Parts that were built for the former numbers are
    left out; build the robot again.

    Args:
        robot: any robot, or the text of its design file.
        values: key path to value, in the unit of the key. A path may select several numbers,
            "leg.*.at_mm[0]", which all get the value; or a list, "leg.left.at_mm", which
            needs a value for each number. Of two paths to one number the later has priority.

    Raises:
        DesignError: a path selects no number, or values are invalid for a robot.
    """
    if isinstance(robot, str):
        robot = loads(robot, "robot").robot
    tree = tree_of(robot)
    before = dict(leaves(tree))
    sizes = _sizes(before)
    problems: list[str] = []
    changed: dict[Steps, Any] = {}
    for path, value in values.items():
        try:
            for steps, rest in find(path, before):
                changed[steps] = _file_value(_part(value, rest, steps, sizes))
        except ValueError as error:
            problems.append(f"{path}: {error}")
    name = robot.title or "robot"
    refuse_any(name, problems)
    # A number from `parameters` may lack the last digit of an angle in degrees.
    changed = {steps: value for steps, value in changed.items() if not _same(value, before[steps])}
    for steps, value in changed.items():
        set_leaf(tree, steps, value)
    # Sources may need other paths after the change, and are set separately.
    tree.pop("source", None)
    made = robot_of(wording.checked(schema.RobotKeys, tree, name), name)
    return replace(made, sources=_changed_sources(robot, list(changed)))


def key_unit(robot: Robot, path: str) -> str:
    """Unit of a key path of a robot, "" for none; ValueError if it selects no number."""
    steps, rest = find(path, dict(leaves(tree_of(robot))))[0]
    if rest:
        raise InputError(f"{path} is a list: name one of its numbers, such as {path}[0].")
    return _unit(steps)


def _changed_sources(robot: Robot, changed: list[Steps]) -> dict[str, str]:
    labels = dict(robot.sources)
    of, _ = sources(robot, _paths_by_source(robot))
    for steps in changed:
        if of.get(steps, schema.ASSUMED) != schema.ASSUMED:
            narrow = [path for path in labels if _selects_only(path, steps, of)]
            labels = {path: label for path, label in labels.items() if path not in narrow}
            labels[spelled(steps)] = schema.ASSUMED
    return labels


def _selects_only(path: str, steps: Steps, known: Mapping[Steps, str]) -> bool:
    try:
        return [meant for meant, _ in find(path, known)] == [steps]
    except ValueError:
        return False


def _same(value: Any, before: Any) -> bool:
    if is_number(value) and is_number(before):
        return float(value) == float(before)
    return type(value) is type(before) and value == before


def _paths_by_source(robot: Robot) -> dict[str, list[str]]:
    labels = robot.sources
    return {label: [path for path in labels if labels[path] == label] for label in labels.values()}


def _unit(steps: Steps) -> str:
    key = next(step for step in reversed(steps) if isinstance(step, str))
    last = steps[-1]
    return keys.unit_of(key, last.index if isinstance(last, Item) else 0)


def _sizes(known: Iterable[Steps]) -> dict[Steps, int]:
    sizes: dict[Steps, int] = {}
    for steps in known:
        for i, step in enumerate(steps):
            if isinstance(step, Item):
                sizes[steps[:i]] = max(sizes.get(steps[:i], 0), step.index + 1)
    return sizes


def _part(value: Any, rest: Steps, steps: Steps, sizes: Mapping[Steps, int]) -> Any:
    """The part of a value for the end of a path: all of it, or one of its numbers."""
    above = len(steps) - len(rest)
    for i, step in enumerate(rest, above):
        several = not isinstance(value, str | Mapping) and hasattr(value, "__len__")
        if not isinstance(step, Item) or not several or len(value) != sizes[steps[:i]]:
            way = f"name one number of it, such as {spelled(steps)}, or give all of its numbers."
            holds = f"does not match {spelled(steps[:above])}"
            raise InputError(f"{value_text(value)} {holds}: {way}")
        value = value[step.index]
    return value


def _file_value(value: Any) -> Any:
    """A value as in a file, a number as a decimal."""
    if isinstance(value, bool | str | int | Decimal):
        return value
    try:
        return Decimal(repr(float(value)))
    except (TypeError, ValueError):
        raise InputError(f"{value_text(value)} is no number.") from None


def provenance(robot: Robot) -> tuple[RobotParameter, ...]:
    """The numbers of a robot with their sources, in the order of a design file.

    Coordinates are grouped. Numbers common to legs or cells are listed once, with `*` in the path.
    """
    numbers = _merged_lists(parameters(robot))
    for several in _SEVERAL:
        numbers = _merged_alike(numbers, several)
    return tuple(numbers)


def _merged_lists(numbers: Iterable[RobotParameter]) -> list[RobotParameter]:
    lists = grouped((re.sub(r"(?:\[\d+\])+$", "", one.path), one) for one in numbers)
    together: list[RobotParameter] = []
    for path, items in lists.items():
        if len({(item.unit, item.source) for item in items}) == 1:
            values = tuple(item.values[0] for item in items)
            together.append(replace(items[0], path=path, values=values))
        else:
            together += items
    return together


def _merged_alike(numbers: list[RobotParameter], several: re.Pattern[str]) -> list[RobotParameter]:
    """The numbers, with those common to every leg or cell only once."""
    alike = grouped((several.sub(_with_star, one.path), one) for one in numbers)
    count = max((len(items) for path, items in alike.items() if "*" in path), default=0)
    shared: list[RobotParameter] = []
    for number in numbers:
        path = several.sub(_with_star, number.path)
        items = alike[path]
        same = len({(item.values, item.unit, item.source) for item in items}) == 1
        if path == number.path or not same or len(items) < max(count, 2):
            shared.append(number)
        elif number is items[0]:
            shared.append(replace(number, path=path))
    return shared


def _with_star(match: re.Match[str]) -> str:
    return "leg.*" if match[0].startswith("leg") else ".*"
