"""The text of a design file in; a chain, its program or a robot out."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from stepwell.files.schema import chain as schema, robot as robot_schema, worded
from stepwell.files.tables import Shared, WrittenProgram, cell, program_of, robot
from stepwell.files.text import DesignError, parsed
from stepwell.mechanism import Chain
from stepwell.robot import Robot

_EMPTY = "is empty: a design file starts with a [chain] table."


# A union would make every caller narrow by hand what the name of its file already says.
def loads(text: str, name: str = "design") -> Any:
    """The chain or the robot that the text of a design file describes.

    Args:
        text: TOML; with [[leg]] it is a robot.
        name: what messages call it.

    Returns:
        A Chain or a Robot, in SI.

    Raises:
        DesignError: the text is no TOML, or asks for what no mechanism can be; its own text
            has one line for every problem.
    """
    return _read(text, name)[0]


def loads_chain(text: str, name: str = "design") -> Chain:
    """The chain that the text of a design file describes.

    Args:
        text: TOML.
        name: what messages call it.

    Returns:
        The chain, in SI.

    Raises:
        DesignError: as `loads`, or the text describes a robot.
    """
    return _read_chain(text, name)[0]


def loads_program(text: str, name: str = "design") -> WrittenProgram | None:
    """The program of the actuator that the design file of a chain holds.

    Args:
        text: TOML.
        name: what messages call it.

    Returns:
        The program, in SI; None where there is no table [program].

    Raises:
        DesignError: as `loads_chain`.
    """
    return _read_chain(text, name)[1]


def loads_robot(text: str, name: str = "design") -> Robot:
    """The robot that the text of a design file describes.

    Args:
        text: TOML with [[leg]].
        name: what messages call it.

    Returns:
        The robot, in SI.

    Raises:
        DesignError: as `loads`, or the text describes a chain.
    """
    design = loads(text, name)
    if isinstance(design, Robot):
        return design
    raise DesignError(
        name,
        [
            "is a chain, and this needs a robot, which has [[leg]]: `stepwell new robot.toml "
            "--preset robot-forward` writes one to start from."
        ],
    )


def _read_chain(text: str, name: str) -> tuple[Chain, WrittenProgram | None]:
    design, program = _read(text, name)
    if isinstance(design, Chain):
        return design, program
    raise DesignError(
        name, ["is a robot, and this needs a chain: try `stepwell walk` or `stepwell robot show`."]
    )


def _read(text: str, name: str) -> tuple[Chain | Robot, WrittenProgram | None]:
    tables = parsed(text, name, _EMPTY)
    is_robot = robot_schema.is_robot(tables)
    try:
        if is_robot:
            return robot(robot_schema.RobotKeys.model_validate(tables), name), None
        return _chain(schema.FileKeys.model_validate(tables), name)
    except ValidationError as error:
        known = robot_schema.TABLES if is_robot else schema.TABLES
        raise DesignError(name, worded(error, known)) from None


def _chain(keys: schema.FileKeys, name: str) -> tuple[Chain, WrittenProgram | None]:
    chain = keys.chain
    shared = Shared.of(chain, chain.band.given())
    problems: list[str] = []
    cells = [cell(one, shared, f"chain.cell[{i}]", problems) for i, one in enumerate(chain.cell)]
    if problems:
        raise DesignError(name, problems)
    actuator = float(chain.actuator_stiffness_N_per_m)
    made = Chain(tuple(cell for cell in cells if cell), actuator, keys.title)
    program = None if keys.program is None else program_of(keys.program, made, problems)
    if problems:
        raise DesignError(name, problems)
    return made, program
