"""Arenas by name or from a file with tables in millimetres or a map of letters."""

import math
import os
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from functools import cache
from itertools import dropwhile, groupby, product
from typing import Annotated, Any, NamedTuple

from stepwell.base import InputError, check, from_unit, grouped, limits
from stepwell.files import design, robots, text
from stepwell.files.paths import Item, find
from stepwell.files.schema import keys, robot, wording
from stepwell.files.schema.keys import fields, lines_of
from stepwell.files.text import DesignError, parsed
from stepwell.robot import Arena, Cylinder, Goal, Patch, Plate, Slope, Wall, of_arena, other_start

Heading = Annotated[Decimal, keys.bounded("-1e6", "1e6")]


class WallKeys(keys.Keys):
    """A straight wall."""

    from_mm: keys.Point
    to_mm: keys.Point
    thickness_mm: robot.Size | None = None


class RoundKeys(keys.Keys):
    """A cylinder, or the goal."""

    at_mm: keys.Point
    radius_mm: robot.Size | None = None


class SlopeKeys(keys.Keys):
    """A tilt of the whole floor."""

    angle_deg: Annotated[Decimal, keys.bounded("-45", "45")]
    uphill_deg: Heading | None = None


class PatchKeys(keys.Keys):
    """A rectangle of the floor with another level or other friction."""

    from_mm: keys.Point
    to_mm: keys.Point
    level_mm: Annotated[Decimal, keys.bounded("-10", "10")] | None = None
    foot_friction: robot.Grip | None = None
    drag_N: robot.Friction | None = None


class PlateKeys(keys.Keys):
    """A loose plate on the floor."""

    at_mm: keys.Point
    size_mm: keys.Point
    thickness_mm: Annotated[Decimal, keys.above_zero("1e-6", "10")]
    mass_g: robot.Mass
    friction: robot.Friction | None = None
    heading_deg: Heading | None = None


class ArenaKeys(keys.Keys):
    """A whole arena."""

    title: keys.Line = ""
    start_mm: keys.Point | None = None
    heading_deg: Heading | None = None
    unusual: keys.Switch = False
    goal: RoundKeys | None = None
    wall: Annotated[tuple[WallKeys, ...], keys.at_most("obstacles")] = ()
    cylinder: Annotated[tuple[RoundKeys, ...], keys.at_most("obstacles")] = ()
    slope: SlopeKeys | None = None
    patch: Annotated[tuple[PatchKeys, ...], keys.at_most("patches")] = ()
    plate: Annotated[tuple[PlateKeys, ...], keys.at_most("patches")] = ()


# Tables by path, used in messages on unknown keys.
TABLES = keys.tables_of(ArenaKeys)

CYLINDER_RADIUS = 0.025
_HALF = Decimal("0.5")
HEADINGS = {"S": 0.0, ">": 0.0, "^": math.pi / 2, "<": math.pi, "v": -math.pi / 2}
_FIRST = re.compile(r"cell\s+([0-9.eE+-]+)\s*mm\s*")
_LETTERS = "# (wall), o (cylinder), S > < ^ v (start), G (goal), a point or a space (floor)"

Square = tuple[int, int]  # column and row, from the bottom left


class _Rectangle(NamedTuple):
    left: int
    bottom: int
    columns: int
    rows: int

    def squares(self) -> Iterator[Square]:
        across = range(self.left, self.left + self.columns)
        yield from product(across, range(self.bottom, self.bottom + self.rows))


def drawn(map_text: str, name: str) -> Arena:
    """The arena of a map; its origin is the lower left corner of the map."""
    size, title, rest, skipped = _map_parts(map_text, name)
    text.refuse_any(name, _problems(rest, skipped))
    squares: defaultdict[str, list[Square]] = defaultdict(list)
    for j, line in enumerate(reversed(rest)):
        for i, letter in enumerate(line):
            squares[letter].append((i, j))
    (start,) = squares.keys() & HEADINGS
    try:
        walls, posts = _walls(set(squares["#"]), size), squares["o"]
        limits.require("obstacles", len(walls) + len(posts), "has")
        # The size of a letter in a map has bounds of its own.
        made = Arena(
            walls=walls,
            cylinders=[Cylinder(_middle(square, size), CYLINDER_RADIUS) for square in posts],
            start=_middle(squares[start][0], size),
            heading=HEADINGS[start],
            goal=next((Goal(_middle(square, size)) for square in squares["G"]), None),
            title=title,
            unusual=True,
        )
        return replace(made, unusual=False)
    except ValueError as error:
        raise DesignError(name, str(error).split("\n")) from None


def _map_parts(text: str, name: str) -> tuple[Decimal, str, list[str], int]:
    """Side of a square [mm], title, rows, and number of lines above the rows."""
    lines = [line.rstrip() for line in text.removeprefix("\ufeff").splitlines()]
    lines = list(dropwhile(lambda line: not line, lines))
    size = _size(lines[0] if lines else "", name)
    rest, title = lines[1:], ""
    if rest and rest[0].startswith("title "):
        title = rest.pop(0).removeprefix("title ").strip()[:200]
        title = "".join(filter(str.isprintable, title))
    skipped = len(lines) - len(rest)
    while rest and not rest[-1]:
        rest.pop()
    above = len(rest)
    rest = list(dropwhile(lambda line: not line, rest))
    return size, title, rest, skipped + above - len(rest)


def _size(line: str, name: str) -> Decimal:
    match = _FIRST.fullmatch(line)
    with suppress(ArithmeticError):
        if match and 1 <= (size := Decimal(match[1])) <= 10_000:
            return size
    must = "must be the size of one letter of the map, from 1 to 10000 mm, as in: cell 100 mm"
    raise DesignError(name, [f"line 1: {text.value_text(line)}: {must}"])


def _problems(rows: list[str], skipped: int) -> list[str]:
    if not rows:
        return [f"has no map below its first line: add rows of {_LETTERS}."]
    letters = sum(map(len, rows))
    if letters > limits.most("letters"):
        return [f"has {limits.problem('letters', letters)} Or use a larger size of a letter."]
    problems = []
    places: dict[str, list[str]] = {"start": [], "goal": []}
    for j, line in enumerate(rows):
        for i, letter in enumerate(line):
            place = f"line {skipped + j + 1}, column {i + 1}"
            if letter in HEADINGS:
                places["start"].append(place)
            elif letter == "G":
                places["goal"].append(place)
            elif letter not in "#o. ":
                problems.append(f"{place}: {text.value_text(letter)}: must be one of {_LETTERS}.")
    if not places["start"]:
        problems.append("has no start: put S on the floor, or > < ^ v for a start with a heading.")
    for what, marked in places.items():
        if len(marked) > 1:
            problems.append(f"{marked[1]}: a second {what}: the first one is in {marked[0]}.")
    return problems


def _walls(squares: set[Square], size: Decimal) -> list[Wall]:
    slanted, rest = _slanted(squares)
    walls = [_wall(rectangle, size) for rectangle in _rectangles(rest)]
    thickness = from_unit(float(size), "mm") / math.sqrt(2.0)
    for (left, begin), (right, end) in slanted:
        start, stop = (left, begin + (end < begin)), (right + 1, end + (end > begin))
        walls.append(Wall(_point(*start, size), _point(*stop, size), thickness))
    return walls


def _slanted(squares: set[Square]) -> tuple[list[tuple[Square, Square]], set[Square]]:
    """Lines of squares that touch only at corners, by left and right end; and the other squares."""
    sides = ((1, 0), (-1, 0), (0, 1), (0, -1))
    alone = {(i, j) for i, j in squares if not any((i + a, j + b) in squares for a, b in sides)}
    ends = []
    free = set(alone)  # squares in no line yet
    for up in (1, -1):
        for i, j in sorted(alone):
            if (i, j) not in free or (i - 1, j - up) in free:
                continue
            n = 1
            while (i + n, j + n * up) in free:
                n += 1
            if n > 1:
                ends.append(((i, j), (i + n - 1, j + (n - 1) * up)))
                free.difference_update((i + k, j + k * up) for k in range(n))
    return ends, squares - (alone - free)


def _rectangles(squares: set[Square]) -> list[_Rectangle]:
    """Rectangles that together cover the squares, large ones first, possibly overlapping."""
    flipped = _stacked({(j, i) for i, j in squares})
    candidates = [*_stacked(squares), *(_Rectangle(r[1], r[0], r[3], r[2]) for r in flipped)]
    left, chosen = set(squares), []
    for rectangle in sorted(candidates, key=lambda r: (-r.columns * r.rows, r)):
        inside = set(rectangle.squares())
        if inside & left:
            chosen.append(rectangle)
            left -= inside
    return chosen


def _stacked(squares: set[Square]) -> Iterator[_Rectangle]:
    """Rectangles of runs along rows; equal runs in consecutive rows are one rectangle."""
    rows = grouped((j, i) for i, j in sorted(squares))
    begun: dict[tuple[int, int], int] = {}  # left and columns of a run: its first row
    for j in range(min(rows, default=0), max(rows, default=-1) + 2):
        runs = list(_runs(rows.get(j, [])))
        for run in [run for run in begun if run not in runs]:
            bottom = begun.pop(run)
            yield _Rectangle(run[0], bottom, run[1], j - bottom)
        for run in runs:
            begun.setdefault(run, j)


def _runs(columns: list[int]) -> Iterator[tuple[int, int]]:
    for _, run in groupby(enumerate(columns), lambda place: place[1] - place[0]):
        first, *others = (column for _, column in run)
        yield first, 1 + len(others)


def _wall(rectangle: _Rectangle, size: Decimal) -> Wall:
    left, bottom, columns, rows = rectangle
    thickness = text.exact_si(size * min(columns, rows), "mm")
    if columns >= rows:
        y = bottom + rows * _HALF
        return Wall(_point(left, y, size), _point(left + columns, y, size), thickness)
    x = left + columns * _HALF
    return Wall(_point(x, bottom, size), _point(x, bottom + rows, size), thickness)


def _middle(square: Square, size: Decimal) -> tuple[float, float]:
    return _point(square[0] + _HALF, square[1] + _HALF, size)


def _point(x: Decimal | int, y: Decimal | int, size: Decimal) -> tuple[float, float]:
    return text.exact_si(x * size, "mm"), text.exact_si(y * size, "mm")


_EMPTY = "is empty: an arena is tables, as in start_mm = [0, 0], or a map below: cell 100 mm"
_SUFFIXES = (".toml", ".txt")


def arenas() -> dict[str, str]:
    """Titles of the arenas in the package, by name."""
    return {name: loads_arena(text, f"arena {name}").title for name, text in _texts().items()}


def load_arena(arena: str | os.PathLike[str]) -> Arena:
    """The arena with this name or in this file, in SI.

    Args:
        arena: a name that `arenas` lists, for example "three-walls"; or a file that ends in
            .toml or .txt, in the format of docs/design-files.md.

    Raises:
        DesignError: there is none, or its file is invalid; a line for every problem.
    """
    name = os.fspath(arena)
    if name not in _texts() and name.endswith(_SUFFIXES):
        return loads_arena(design.text_of(arena), name)
    return loads_arena(
        _text(name, "no such arena, and no file that ends in .toml or .txt"), f"arena {name}"
    )


def arena_text(name: str) -> str:
    """Text of the file of an arena in the package, a map or TOML, with its comments.

    Raises:
        DesignError: there is none of that name; the message has the nearest name.
    """
    return _text(name, "no such arena")


def _text(name: str, problem: str) -> str:
    if name not in _texts():
        advice = text.did_you_mean(name, _texts())
        raise DesignError(f"arena {name}", [f"{problem}. {advice}"])
    return _texts()[name]


def loads_arena(text: str, name: str = "arena") -> Arena:
    """The arena in a text, in SI.

    Args:
        text: TOML, or a map if it starts with the word cell or `name` ends in .txt.
        name: its name in messages.

    Raises:
        DesignError: the text is neither, or has invalid values.
    """
    if name.endswith(".txt") or re.match(r"\s*cell\b(?!\s*=)", text):
        return drawn(text, name)
    return _arena(parsed(text, name, _EMPTY), name)


def loads_arena_tables(tables: Any, name: str = "arena") -> Arena:
    """The arena in tables of Python values, as from JSON.

    Args:
        tables: JSON values with the keys of the file; an empty table is a bare floor.
        name: its name in messages.

    Raises:
        DesignError: as for `loads_arena`, or a value is not possible in a file.
    """
    return _arena(text.in_decimals(tables, name), name)


def arena_tables(arena: Arena) -> dict[str, Any]:
    """Tables of an arena's file as Python values, for `loads_arena_tables`."""
    return text.in_floats(parsed(arena_toml(arena), "arena", _EMPTY))


def _arena(tables: dict[str, Any], name: str) -> Arena:
    keys = wording.checked(ArenaKeys, tables, name)
    problems: list[str] = []

    def parts(path: str, kind: type[Any], tables: Iterable[Any]) -> list[Any]:
        each = enumerate(tables)
        return [robots.part_of(f"{path}[{i}]", kind, fields(one), problems) for i, one in each]

    walls, patches, plates = (
        parts(path, kind, getattr(keys, path))
        for path, kind in (("wall", Wall), ("patch", Patch), ("plate", Plate))
    )
    text.refuse_any(name, problems)
    try:
        cylinders = [Cylinder(**fields(one)) for one in keys.cylinder]
        goal = None if keys.goal is None else Goal(**fields(keys.goal))
        slope = None if keys.slope is None else Slope(**fields(keys.slope))
        ground = {"slope": slope, "patches": patches, "plates": plates}
        rest = fields(keys, left_out=[*_PARTS, "goal", "slope"])
        return Arena(walls, cylinders, goal=goal, **ground, **rest)
    except ValueError as error:
        raise DesignError(name, lines_of(error)) from None


# Tables of an arena's file of which there may be several, and the fields of the arena.
_PARTS: dict[str, tuple[type[keys.Keys], str]] = {
    "patch": (PatchKeys, "patches"),
    "plate": (PlateKeys, "plates"),
    "wall": (WallKeys, "walls"),
    "cylinder": (RoundKeys, "cylinders"),
}


def arena_toml(arena: Arena) -> str:
    """Text of the file of an arena: start and goal first, then ground and obstacles."""
    left_out = [*_PARTS, "goal", "slope", "unusual", *([] if arena.title else ["title"])]
    odd = ["unusual = true"] if arena.unusual or any(of_arena(arena)) else []
    text = [*odd, *keys.table_lines(ArenaKeys, arena, left_out), ""]
    for table, kind, part in (("goal", RoundKeys, arena.goal), ("slope", SlopeKeys, arena.slope)):
        if part is not None:
            text += [f"[{table}]", *keys.table_lines(kind, part), ""]
    for table, (kind, field) in _PARTS.items():
        for part in getattr(arena, field):
            text += [f"[[{table}]]", *keys.table_lines(kind, part), ""]
    return "\n".join(text).rstrip("\n") + "\n"


START_SEED = "start_seed"  # the key of `vary_arena` that is a seed, not a key of the file


def vary_arena(arena: Arena, values: Mapping[str, float]) -> Arena:
    """The same arena with other values, checked like its file.

    Args:
        arena: any arena.
        values: key path to value, in the unit of the key, such as "slope.angle_deg" or
            "patch[0].level_mm"; or "start_seed" to a whole number >= 0, the seed of a random start
            as of `other_start`. A slope and the friction of a patch need not be in the arena.

    Raises:
        DesignError: a path selects no number, or values are invalid for an arena.
    """
    name = arena.title or "arena"
    tree = parsed(arena_toml(arena), name, _EMPTY)
    tree.setdefault("slope", {"angle_deg": Decimal(0), "uphill_deg": Decimal(0)})
    known = {steps for steps, value in robots.leaves(tree) if robots.is_number(value)}
    for i in range(len(arena.patches)):
        known |= {("patch", Item(i), key) for key in ("foot_friction", "drag_N")}
    problems: list[str] = []
    for path, value in values.items():
        if path == START_SEED:
            continue
        try:
            found = [steps for steps, rest in find(path, known, "arena") if not rest]
            if not found:
                raise InputError(f"is a list: name one of its numbers, such as {path}[0].")
            for steps in found:
                robots.set_leaf(tree, steps, Decimal(repr(float(value))))
        except ValueError as error:
            problems.append(f"{path}: {error}")
    text.refuse_any(name, problems)
    changed = _arena(tree, name)
    if START_SEED not in values:
        return changed
    try:
        return other_start(changed, check.whole(START_SEED, values[START_SEED], 0))
    except ValueError as error:
        raise DesignError(name, [str(error)]) from None


@cache
def _texts() -> dict[str, str]:
    texts = text.packaged("arenas")
    # From the empty floor to the hardest.
    order = (
        "open",
        "wall",
        "wall-ahead",
        "long-wall",
        "corner",
        "cylinder",
        "pen",
        "three-walls",
        "corridor",
        "bend-right",
        "bend-left",
    )
    return {name: texts[name] for name in order}
