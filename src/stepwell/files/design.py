"""Reading of design files: a chain, its program or a robot, from text, file or package."""

from __future__ import annotations

import os
import tomllib
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stepwell.base import ByValue, Shown, content_of, nearest_word
from stepwell.files import text as toml_text
from stepwell.files.cells import Shared, cells_of, chain_of
from stepwell.files.curves import with_curves
from stepwell.files.folder import mixed_results
from stepwell.files.program import WrittenProgram, program_of
from stepwell.files.schema import chain as schema, wording
from stepwell.files.text import DesignError
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.robot import Hopper, Robot

    Made = tuple[Chain | Robot, WrittenProgram | None, Hopper | None]

PRESET = "preset:"
_EMPTY = "is empty: a design file starts with a [chain] table."


@dataclass(frozen=True, eq=False)
class DesignFile(ByValue):
    """A design file: its text, and its chain or robot.

    Attributes:
        text: TOML; "" if only tables were given.
        name: its name in messages.
        subject: a Chain, or a Robot if the file has [[leg]]; in SI.
        program: program of the actuator in the file of a chain; None for none.
        hopper: masses on the chain and the task of its snap, of the table [hopper].
    """

    text: str = field(repr=False)
    name: str
    subject: Chain | Robot
    program: WrittenProgram | None = None
    _hopper: Hopper | None = None

    @property
    def hopper(self) -> Hopper:
        """The hopper; DesignError if the file has no table [hopper]."""
        if self._hopper is not None:
            return self._hopper
        way = "`stepwell new hopper.toml --preset hopper` writes a file that has one"
        raise DesignError(self.name, [f"has no table [hopper], and this needs one: {way}."])

    @property
    def value(self) -> Chain | Robot | Hopper:
        """The hopper if the file has one, else the chain or the robot."""
        return self.subject if self._hopper is None else self._hopper

    @property
    def chain(self) -> Chain:
        """The chain; DesignError if the file has a robot."""
        if isinstance(self.subject, Chain):
            return self.subject
        name = "ROBOT" if self.name == "design" else self.name
        way = f"`stepwell robot show {name} --full` lists its gaits and their changes by antennas"
        problem = f"is a robot, and this needs a chain: {way}, `stepwell walk {name}` simulates it."
        raise DesignError(self.name, [problem])

    @property
    def robot(self) -> Robot:
        """The robot; DesignError if the file has a chain."""
        if not isinstance(self.subject, Chain):
            return self.subject
        way = (
            "`stepwell new robot.toml --preset robot-forward` writes one, and "
            "docs/how-to/robots.md puts a designed chain into its legs."
        )
        problem = f"is a chain, and this needs a robot, which has [[leg]]: {way}"
        raise DesignError(self.name, [problem])


def load(design: str | os.PathLike[str]) -> DesignFile:
    """A design file, read and checked.

    Args:
        design: a TOML file with the keys of docs/design-files.md; or "preset:" and a name in
            `presets`, for example "preset:paper-forward".

    Raises:
        DesignError: the file is missing, no text or no TOML, or has invalid values; a line for
            every problem.
    """
    return loads(text_of(design), os.fspath(design))


def loads(text: str, name: str = "design") -> DesignFile:
    """The text of a design file, read and checked.

    Args:
        text: TOML; with [[leg]] it is a robot.
        name: its name in messages.

    Raises:
        DesignError: the text is no TOML, or has invalid values.
    """
    return DesignFile(text, name, *_made(toml_text.parsed(text, name, _EMPTY), name))


def loads_tables(tables: Any, name: str = "design") -> DesignFile:
    """A design file from tables of Python values, as from JSON.

    Args:
        tables: JSON values with the keys of the file; `tables_in` returns those of a text.
        name: its name in messages.

    Raises:
        DesignError: as for `loads`, or a value is not possible in a file.
    """
    if not isinstance(tables, dict) or not tables:
        raise DesignError(name, [_EMPTY])
    return DesignFile("", name, *_made(toml_text.in_decimals(tables, name), name))


def tables_in(text: str, name: str = "design") -> dict[str, Any]:
    """Checked tables of a design file as Python values, for `loads_tables`.

    Returns:
        JSON values; numbers are floats in the units of the file.

    Raises:
        DesignError: as for `loads`.
    """
    tables = toml_text.parsed(text, name, _EMPTY)
    _made(tables, name)
    return toml_text.in_floats(tables)


def text_of(design: str | os.PathLike[str], *, robots: bool | None = None) -> str:
    """The unchecked text of a design file, with the numbers of its CSV files inserted.

    Args:
        design: path of a file, or "preset:" and a name in `presets`.
        robots: whether errors suggest presets of robots only, or of chains only; None for both.

    Raises:
        DesignError: there is none, it is not UTF-8 text, a command was stopped while it replaced
            the file, or a CSV file in it cannot be used.
    """
    name = os.fspath(design)
    if name.startswith(PRESET):
        return preset_text(name.removeprefix(PRESET), robots=robots)
    try:
        text = content_of(Path(design), "design_bytes").decode("utf-8-sig")
        if (mixed := mixed_results(Path(design))) is None:
            return with_curves(text, name)
        problem = f"its folder {mixed}."
    except DesignError:
        raise
    except FileNotFoundError:
        problem = f"no such file.{_similar_file_hint(Path(design), robots)}"
    except UnicodeDecodeError as error:
        line, byte = error.object[: error.start].count(b"\n") + 1, error.object[error.start]
        problem = f"line {line}: byte 0x{byte:02x} is not UTF-8: save the file as UTF-8 text."
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}."
    except ValueError as error:  # a name with a zero byte in it
        problem = f"is no file name: {error}."
    raise DesignError(name, [problem])


class Presets(dict[str, str], Shown):
    """Titles of the designs in the package, by name."""


def presets() -> Presets:
    """Titles of the designs in the package, by name."""
    return Presets({name: tomllib.loads(text)["title"] for name, text in _texts().items()})


def preset_text(name: str, *, robots: bool | None = None) -> str:
    """Text of a design file in the package, TOML with comments, for editing.

    Raises:
        DesignError: there is none of that name; the message has similar names, with `robots` as in
            `text_of`.
    """
    texts = _texts()
    if name not in texts:
        raise DesignError(f"preset {name}", [f"no such design.{_similar_presets(name, robots)}"])
    return texts[name]


def preset(name: str) -> Any:
    """The design of that name in the package: a Chain or a Robot, in SI; of a hopper its chain.

    `load("preset:NAME").hopper` is the hopper.

    Args:
        name: as in `presets`, for example "paper-forward"; "robot-..." are robots.

    Raises:
        DesignError: there is none of that name; the message has the nearest name.
    """
    return loads(preset_text(name), f"preset {name}").subject


def _made(tables: dict[str, Any], name: str) -> Made:
    if not tables.keys() <= schema.FileKeys.model_fields.keys():
        # The many keys of a robot are imported only for robots.
        from stepwell.files.robots import robot
        from stepwell.files.schema import robot as robot_schema

        if robot_schema.is_robot(tables):
            return robot(wording.checked(robot_schema.RobotKeys, tables, name), name), None, None
    return _chain(wording.checked(schema.FileKeys, tables, name), name)


def _chain(keys: schema.FileKeys, name: str) -> Made:
    chain = keys.chain
    shared = Shared.of(chain.band.given(), chain)
    problems: list[str] = []
    cells = cells_of(chain.cell, shared, "chain.cell", problems)
    toml_text.refuse_any(name, problems)
    try:
        made = chain_of(cells, chain, keys.title)
    except ValueError as error:
        raise DesignError(name, [f"chain: {error}"]) from None
    program = None if keys.program is None else program_of(keys.program, made, problems)
    hopper = None
    if keys.hopper is not None:
        # Only the files of hoppers import the package of robots.
        from stepwell.files.hoppers import hopper_of

        hopper = hopper_of(keys.hopper, made, problems)
    toml_text.refuse_any(name, problems)
    return made, program, hopper


def _similar_file_hint(path: Path, robots: bool | None) -> str:
    if str(path) in _texts():
        return f" Did you mean {PRESET}{path}?"
    with suppress(OSError):
        others = [one.name for one in path.parent.iterdir() if one.suffix in (".toml", path.suffix)]
        if near := nearest_word(path.name, others):
            return f" Did you mean {path.with_name(near)}?"
    is_name = path.name == str(path) and not path.suffix
    return _similar_presets(path.name, robots, PRESET) if is_name else ""


def _similar_presets(name: str, robots: bool | None, before: str = "") -> str:
    known = [one for one in _texts() if robots in (None, one.startswith("robot-"))]
    near = [one for one in known if name.lower() in one][:3] or [nearest_word(name, known)]
    meant = f" Did you mean {' or '.join(f'{before}{one}' for one in near)}?" if near[0] else ""
    return f"{meant} `stepwell presets` lists the presets."


@cache
def _texts() -> dict[str, str]:
    texts = toml_text.packaged("presets")
    # The paper's designs first, robots last.
    turn = {"paper": 0, "robot": 2}
    return dict(sorted(texts.items(), key=lambda one: (turn.get(one[0].split("-")[0], 1), one[0])))
