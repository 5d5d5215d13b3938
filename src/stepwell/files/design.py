"""Design files in: a chain, its program or a robot, from a text, a file or the package."""

from __future__ import annotations

import os
import tomllib
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stepwell.base import ByValue, Shown, content_of, nearest_word
from stepwell.files.cells import Shared, cells_of, chain_of
from stepwell.files.curves import with_curves
from stepwell.files.folder import mixed_results
from stepwell.files.program import WrittenProgram, program_of
from stepwell.files.schema import chain as schema, wording
from stepwell.files.text import (
    DesignError,
    did_you_mean,
    in_decimals,
    in_floats,
    parsed,
    refuse_any,
)
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.robot import Robot

PRESET = "preset:"
_EMPTY = "is empty: a design file starts with a [chain] table."


@dataclass(frozen=True, eq=False)
class DesignFile(ByValue):
    """A design file: its text, and the chain or the robot that it describes.

    Attributes:
        text: TOML; "" where only its tables were given.
        name: what messages call it.
        subject: a Chain, or a Robot where the file has [[leg]]; in SI.
        program: the program of the actuator that the file of a chain holds; None for none.
    """

    text: str = field(repr=False)
    name: str
    subject: Chain | Robot
    program: WrittenProgram | None = None

    @property
    def chain(self) -> Chain:
        """The chain; DesignError if the file describes a robot."""
        if isinstance(self.subject, Chain):
            return self.subject
        problem = (
            "is a robot, and this needs a chain: try `stepwell walk` or `stepwell robot show`."
        )
        raise DesignError(self.name, [problem])

    @property
    def robot(self) -> Robot:
        """The robot; DesignError if the file describes a chain."""
        if not isinstance(self.subject, Chain):
            return self.subject
        way = "`stepwell new robot.toml --preset robot-forward` writes one to start from."
        problem = f"is a chain, and this needs a robot, which has [[leg]]: {way}"
        raise DesignError(self.name, [problem])


def load(design: str | os.PathLike[str]) -> DesignFile:
    """A design file, read and checked.

    Args:
        design: a TOML file, whose keys docs/design-files.md lists; or "preset:" and a name that
            `presets` lists, for example "preset:paper-forward".

    Raises:
        DesignError: the file is missing, no text, no TOML, or asks for what no mechanism can
            be; a line for every problem.
    """
    return loads(text_of(design), os.fspath(design))


def loads(text: str, name: str = "design") -> DesignFile:
    """The text of a design file, read and checked.

    Args:
        text: TOML; with [[leg]] it describes a robot.
        name: what messages call it.

    Raises:
        DesignError: the text is no TOML, or asks for what no mechanism can be.
    """
    return DesignFile(text, name, *_made(parsed(text, name, _EMPTY), name))


def loads_tables(tables: Any, name: str = "design") -> DesignFile:
    """A design file whose tables are Python values, as out of JSON.

    Args:
        tables: what JSON can hold, with the keys of the file; `tables_in` makes them of a text.
        name: what messages call it.

    Raises:
        DesignError: as `loads`, with the same words; or a value that no file can hold.
    """
    if not isinstance(tables, dict) or not tables:
        raise DesignError(name, [_EMPTY])
    return DesignFile("", name, *_made(in_decimals(tables, name), name))


def tables_in(text: str, name: str = "design") -> dict[str, Any]:
    """The tables of a design file as Python values, checked; `loads_tables` takes them.

    Returns:
        What JSON can hold; numbers are floats in the units of the file.

    Raises:
        DesignError: as `loads`.
    """
    tables = parsed(text, name, _EMPTY)
    _made(tables, name)
    return in_floats(tables)


def text_of(design: str | os.PathLike[str]) -> str:
    """The text of a design file, whatever it says, with the numbers of the CSV files it names.

    Args:
        design: a file's path, or "preset:" and a name that `presets` lists.

    Raises:
        DesignError: there is none, it is not UTF-8 text, a command was stopped while it replaced
            it, or a CSV file that it names cannot be used.
    """
    name = os.fspath(design)
    if name.startswith(PRESET):
        return preset_text(name.removeprefix(PRESET))
    try:
        text = content_of(Path(design), "design_bytes").decode("utf-8-sig")
        if (mixed := mixed_results(Path(design))) is None:
            return with_curves(text, name)
        problem = f"its folder {mixed}."
    except DesignError:
        raise
    except FileNotFoundError:
        problem = f"no such file.{_similar_file_hint(Path(design))}"
    except UnicodeDecodeError as error:
        line, byte = error.object[: error.start].count(b"\n") + 1, error.object[error.start]
        problem = f"line {line}: byte 0x{byte:02x} is not UTF-8: save the file as UTF-8 text."
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}."
    except ValueError as error:  # a name with a zero byte in it
        problem = f"is no file name: {error}."
    raise DesignError(name, [problem])


class Presets(dict[str, str], Shown):
    """The name of every design that comes with the package, and its title."""


def presets() -> Presets:
    """The name of every design that comes with the package, and its title."""
    return Presets({name: tomllib.loads(text)["title"] for name, text in _texts().items()})


def preset_text(name: str) -> str:
    """The design file of a name that `presets` lists, TOML with its comments, to be edited.

    Raises:
        DesignError: there is none of that name; the text says which is nearest.
    """
    texts = _texts()
    if name not in texts:
        raise DesignError(f"preset {name}", [f"no such design. {did_you_mean(name, texts)}"])
    return texts[name]


def preset(name: str) -> Any:
    """The design of that name that comes with the package: a Chain or a Robot, in SI.

    Args:
        name: as `presets` lists it, for example "paper-forward"; "robot-..." are robots.

    Raises:
        DesignError: there is none of that name; the text says which is nearest.
    """
    return loads(preset_text(name), f"preset {name}").subject


def _made(tables: dict[str, Any], name: str) -> tuple[Chain | Robot, WrittenProgram | None]:
    if not tables.keys() <= schema.FileKeys.model_fields.keys():
        # The keys of a robot are many: a chain does not wait for them.
        from stepwell.files.robots import robot
        from stepwell.files.schema import robot as robot_schema

        if robot_schema.is_robot(tables):
            return robot(wording.checked(robot_schema.RobotKeys, tables, name), name), None
    return _chain(wording.checked(schema.FileKeys, tables, name), name)


def _chain(keys: schema.FileKeys, name: str) -> tuple[Chain, WrittenProgram | None]:
    chain = keys.chain
    shared = Shared.of(chain.band.given(), chain)
    problems: list[str] = []
    cells = cells_of(chain.cell, shared, "chain.cell", problems)
    refuse_any(name, problems)
    try:
        made = chain_of(cells, chain, keys.title)
    except ValueError as error:
        raise DesignError(name, [f"chain: {error}"]) from None
    program = None if keys.program is None else program_of(keys.program, made, problems)
    refuse_any(name, problems)
    return made, program


def _similar_file_hint(path: Path) -> str:
    if str(path) in presets():
        return f" Did you mean {PRESET}{path}?"
    with suppress(OSError):
        others = [one.name for one in path.parent.iterdir() if one.suffix in (".toml", path.suffix)]
        if near := nearest_word(path.name, others):
            return f" Did you mean {path.with_name(near)}?"
    return ""


@cache
def _texts() -> dict[str, str]:
    folder = files("stepwell.files") / "presets"
    preset_files = (file for file in folder.iterdir() if file.name.endswith(".toml"))
    texts = {file.name.removesuffix(".toml"): file.read_text("utf-8") for file in preset_files}
    # The paper's first, as a reader of the paper looks for them; robots last.
    turn = {"paper": 0, "robot": 2}
    return dict(sorted(texts.items(), key=lambda one: (turn.get(one[0].split("-")[0], 1), one[0])))
