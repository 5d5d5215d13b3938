"""State machines over strokes as files: those of the package by name, and TOML files."""

import os

from stepwell.base import InputError
from stepwell.files import design
from stepwell.files.text import DesignError, did_you_mean, packaged
from stepwell.sequences import Machine


def machines() -> dict[str, str]:
    """Titles of the state machines in the package, by name."""
    every = ((name, Machine.parse(text)) for name, text in packaged("machines").items())
    return {name: machine.title for name, machine in every}


def machine_text(machine: str | os.PathLike[str]) -> str:
    """Text of the file of a state machine, unchecked.

    Args:
        machine: a name that `machines` lists, such as "second-touch"; or a TOML file.

    Raises:
        DesignError: there is no machine of that name, or no such file.
    """
    return named_text("machine", machine)


def load_machine(machine: str | os.PathLike[str]) -> Machine:
    """The state machine of that name or in a file.

    Args:
        machine: a name that `machines` lists, such as "second-touch"; or a TOML file with the
            keys of `Machine.parse`.

    Raises:
        DesignError: the file is missing or invalid; the text has its name.
    """
    text = machine_text(machine)
    try:
        return Machine.parse(text)
    except InputError as why:
        raise DesignError(os.fspath(machine), [str(why)]) from None


def named_text(kind: str, given: str | os.PathLike[str]) -> str:
    """The unchecked text of a file: one of the package by name, or a TOML file.

    Args:
        kind: "behaviour" or "machine".
        given: name or path.

    Raises:
        DesignError: there is none of that name, or no such file; the text has similar names.
    """
    name, texts = os.fspath(given), packaged(f"{kind}s")
    if name in texts:
        return texts[name]
    if not name.endswith(".toml"):
        advice = did_you_mean(name, texts)
        problem = f"no such {kind}, and no file that ends in .toml. {advice}"
        raise DesignError(f"{kind} {name}", [problem])
    return design.text_of(given)
