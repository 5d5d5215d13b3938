"""A chain, a robot or an arena in, its file out."""

import os
import re
from contextlib import suppress

from stepwell.base import InputError, write_atomic
from stepwell.files.arena import arena_toml, loads_arena
from stepwell.files.design import loads
from stepwell.files.design_text import chain_text, robot_text
from stepwell.files.program import WrittenProgram
from stepwell.files.text import DesignError
from stepwell.mechanism import Chain
from stepwell.robot import Arena, Robot

# The table from its head to the next one or to what is said above that; checked afterwards.
_PROGRAM = re.compile(
    r"^\[ *program *\].*?(?=^(?:#[^\n]*\n|\n)*\[[a-z\[]|\Z)", re.MULTILINE | re.DOTALL
)


def save(
    design: Chain | Robot | Arena,
    path: str | os.PathLike[str],
    *,
    program: WrittenProgram | None = None,
) -> None:
    """Write a chain, a robot or an arena as its file, whole or not at all.

    Args:
        design: any.
        path: where to, as TOML; an existing file is replaced.
        program: of a chain's actuator, for a table [program].

    Raises:
        ValueError: the design lies outside what its file may hold, or an arena is to be a map.
        OSError: the folder is missing or cannot be written.
    """
    if isinstance(design, Arena) and os.fspath(path).endswith(".txt"):
        raise InputError(f"{os.fspath(path)}: an arena is written as TOML: let it end in .toml.")
    write_atomic(path, dumps(design, program=program))


def dumps(design: Chain | Robot | Arena, *, program: WrittenProgram | None = None) -> str:
    """The file of a chain, a robot or an arena; reading it gives an equal one, to the last bit.

    TOML: what cells and legs share first, then each of them, innermost first; at the end the
    program of a chain's actuator.

    Raises:
        ValueError: the design lies outside what its file may hold, such as a name of two lines
            or a lever of a thousand kilometres; or it is no chain and has a program.
    """
    if program is not None and not isinstance(design, Chain):
        raise InputError("program: only the design file of a chain holds one; leave it out.")
    if isinstance(design, Arena):
        text = arena_toml(design)
        again = loads_arena(text, "this arena, written as a file")
    elif isinstance(design, Robot):
        text = robot_text(design)
        again = loads(text, "this robot, written as a design file").subject
    else:
        text = chain_text(design) + ("" if program is None else f"\n{program.text(design)}")
        again = loads(text, "this chain, written as a design file").subject
    if again != design:
        raise InputError(f"{design!r} did not survive being written: please report this design.")
    return text


def with_program(text: str, program: WrittenProgram) -> str:
    """The design file of a chain as TOML with another table [program], all else as it was.

    Raises:
        DesignError: the text is no chain's design file.
    """
    chain = loads(text).chain
    kept = _PROGRAM.sub("", text.replace("\r\n", "\n")).rstrip("\n")
    changed = f"{kept}\n\n{program.text(chain)}"
    with suppress(DesignError):
        if loads(changed).chain == chain and loads(changed).program == program:
            return changed
    # A table that stood there in another form, such as program = { ... } on one line.
    return dumps(chain, program=program)
