"""A design by the name its user gives it: a file's path, or a design of the package."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from stepwell.base import content_of, nearest_word
from stepwell.files.design import loads, loads_chain, loads_program, loads_robot
from stepwell.files.folder import doubt
from stepwell.files.shipped import preset_text, presets
from stepwell.files.tables import WrittenProgram
from stepwell.files.text import DesignError
from stepwell.mechanism import Chain
from stepwell.robot import Robot

PRESET = "preset:"


# A union would make every caller narrow by hand what the name of its file already says.
def load(design: str | os.PathLike[str]) -> Any:
    """The chain or the robot that a design file describes.

    Args:
        design: a TOML file, whose keys docs/design-files.md lists; or "preset:" and a name that
            `presets` lists, for example "preset:paper-forward".

    Returns:
        A Chain, or a Robot where the file has [[leg]]; in SI.

    Raises:
        DesignError: the file is missing, no text, no TOML, or asks for what no mechanism can
            be; its text has one line for every problem.
    """
    return loads(read(design), os.fspath(design))


def load_chain(design: str | os.PathLike[str]) -> Chain:
    """The chain that a design file describes.

    Args:
        design: as for `load`.

    Returns:
        The chain, in SI.

    Raises:
        DesignError: as for `load`, or the file describes a robot.
    """
    return loads_chain(read(design), os.fspath(design))


def load_program(design: str | os.PathLike[str]) -> WrittenProgram | None:
    """The program of the actuator that the design file of a chain holds.

    Args:
        design: as for `load`.

    Returns:
        The program, in SI; None where the file has no table [program].

    Raises:
        DesignError: as for `load`, or the file describes a robot.
    """
    return loads_program(read(design), os.fspath(design))


def load_robot(design: str | os.PathLike[str]) -> Robot:
    """The robot that a design file describes.

    Args:
        design: as for `load`.

    Returns:
        The robot, in SI.

    Raises:
        DesignError: as for `load`, or the file describes a chain.
    """
    return loads_robot(read(design), os.fspath(design))


def read(design: str | os.PathLike[str]) -> str:
    """The text of a design file, whatever it says.

    Args:
        design: a file's path, or "preset:" and a name that `presets` lists.

    Returns:
        The text.

    Raises:
        DesignError: there is none, it is not UTF-8 text, or a command was stopped while it
            replaced it.
    """
    name = os.fspath(design)
    if name.startswith(PRESET):
        return preset_text(name.removeprefix(PRESET))
    try:
        text = content_of(Path(design), "design_bytes").decode("utf-8-sig")
        unsure = doubt(Path(design))
        if unsure is None:
            return text
        problem = f"its folder {unsure}."
    except FileNotFoundError:
        problem = f"no such file.{_neighbour(Path(design))}"
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        byte = error.object[error.start]
        problem = f"line {line}: byte 0x{byte:02x} is not UTF-8: save the file as UTF-8 text."
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}."
    except ValueError as error:  # a name with a zero byte in it
        problem = f"is no file name: {error}."
    raise DesignError(name, [problem])


def _neighbour(path: Path) -> str:
    if str(path) in presets():
        return f" Did you mean {PRESET}{path}?"
    try:
        suffixes = (".toml", path.suffix)
        names = [other.name for other in path.parent.iterdir() if other.suffix in suffixes]
    except OSError:
        return ""
    near = nearest_word(path.name, names)
    return f" Did you mean {path.with_name(near)}?" if near else ""
