"""Writing of chains, robots, arenas and rigs to files, and reading of rigs."""

import math
import os
import re
from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from typing import TYPE_CHECKING, Annotated

from stepwell.base import InputError, write_atomic
from stepwell.files.arena import arena_toml, loads_arena
from stepwell.files.design import loads
from stepwell.files.design_text import chain_text, robot_text
from stepwell.files.hoppers import hopper_text
from stepwell.files.program import WrittenProgram
from stepwell.files.schema.keys import Keys, above_zero, bounded, fields, table_lines
from stepwell.files.schema.wording import checked
from stepwell.files.text import DesignError, parsed
from stepwell.mechanism import Chain
from stepwell.robot import Arena, Hopper, Robot

if TYPE_CHECKING:
    from stepwell.lab import Rig

# The table from its head to the next table with its comments; the result is checked.
_PROGRAM = re.compile(
    r"^\[ *program *\].*?(?=^(?:#[^\n]*\n|\n)*\[[a-z\[]|\Z)", re.MULTILINE | re.DOTALL
)


def save(
    design: Chain | Robot | Hopper | Arena,
    path: str | os.PathLike[str],
    *,
    program: WrittenProgram | None = None,
) -> None:
    """Write a chain, a robot, a hopper or an arena to a file, completely or not at all.

    Args:
        design: chain, robot, hopper or arena.
        path: of the TOML file; an existing file is replaced.
        program: of a chain's actuator, for a table [program].

    Raises:
        ValueError: the design is outside the limits of its file, or `path` is that of a map.
        OSError: the folder is missing or cannot be written.
    """
    if isinstance(design, Arena) and os.fspath(path).endswith(".txt"):
        raise InputError(f"{os.fspath(path)}: an arena is written as TOML: use the suffix .toml.")
    write_atomic(path, dumps(design, program=program))


def dumps(design: Chain | Robot | Hopper | Arena, *, program: WrittenProgram | None = None) -> str:
    """Text of the file of a chain, robot, hopper or arena; reading returns an equal value.

    TOML: common values of cells and legs first, then each of them, innermost first; at the end the
    program of a chain's actuator.

    Raises:
        ValueError: the design is outside the limits of its file, such as a name of two lines or a
            lever of a thousand kilometres; or it is no chain and has a program.
    """
    if program is not None and not isinstance(design, Chain):
        raise InputError("program: only the design file of a chain has one; leave it out.")
    if isinstance(design, Arena):
        text = arena_toml(design)
        again = loads_arena(text, "this arena, written as a file")
    elif isinstance(design, Robot):
        text = robot_text(design)
        again = loads(text, "this robot, written as a design file").subject
    elif isinstance(design, Hopper):
        text = f"{chain_text(replace(design.chain, title=design.title))}\n{hopper_text(design)}"
        again = loads(text, "this hopper, written as a design file").value
    else:
        text = chain_text(design) + ("" if program is None else f"\n{program.text(design)}")
        again = loads(text, "this chain, written as a design file").subject
    if again != design:
        raise InputError(f"{design!r} did not survive being written: please report this design.")
    return text


def with_program(text: str, program: WrittenProgram) -> str:
    """The design file of a chain with another table [program], otherwise unchanged.

    Raises:
        DesignError: the text is no chain's design file.
    """
    chain = loads(text).chain
    kept = _PROGRAM.sub("", text.replace("\r\n", "\n")).rstrip("\n")
    changed = f"{kept}\n\n{program.text(chain)}"
    with suppress(DesignError):
        if loads(changed).chain == chain and loads(changed).program == program:
            return changed
    # The table had another form, such as program = { ... } on one line.
    return dumps(chain, program=program)


Start = Annotated[Decimal, bounded("-10", "10")]


class RigKeys(Keys):
    """The rig between a test machine and a mechanism."""

    bar_mm: Annotated[Decimal, bounded("20", "1e6")] | None = None
    stretch: Annotated[Decimal, above_zero("0.5", "2")] | None = None
    start_loading_mm: Start | None = None
    start_unloading_mm: Start | None = None
    compliance_mm_per_N: Annotated[Decimal, bounded("0", "1e3")] | None = None
    friction_N: Annotated[Decimal, bounded("0", "1e6")] | None = None


_EMPTY = "is empty: a rig is what `stepwell lab calibrate` writes, as in stretch = 1.02"


def loads_rig(text: str, name: str = "rig") -> "Rig":
    """The rig in a text, in SI.

    Args:
        text: TOML, as `stepwell lab calibrate` writes it; without bar_mm the machine moves with
            the block.
        name: its name in messages.

    Raises:
        DesignError: the text is no TOML, or has invalid values; a line for every problem.
    """
    from stepwell.lab import Rig

    return Rig(**fields(checked(RigKeys, parsed(text, name, _EMPTY), name)))


def rig_toml(rig: "Rig") -> str:
    """Text of the file of a rig; an infinite bar is left out."""
    lines = table_lines(RigKeys, rig, ["bar_mm"] if math.isinf(rig.bar) else [])
    return "\n".join(lines) + "\n"
