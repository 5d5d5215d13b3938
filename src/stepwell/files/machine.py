"""State machines over strokes as files: those of the package by name, and TOML files."""

import os
from functools import cache
from importlib.resources import files

from stepwell.base import InputError
from stepwell.files import design
from stepwell.files.text import DesignError, did_you_mean
from stepwell.sequences import Machine


def machines() -> dict[str, str]:
    """Titles of the state machines in the package, by name."""
    every = ((name, Machine.parse(text)) for name, text in _texts().items())
    return {name: machine.title for name, machine in every}


def machine_text(machine: str | os.PathLike[str]) -> str:
    """Text of the file of a state machine, unchecked.

    Args:
        machine: a name that `machines` lists, such as "second-touch"; or a TOML file.

    Raises:
        DesignError: there is no machine of that name, or no such file.
    """
    name = os.fspath(machine)
    if name in _texts():
        return _texts()[name]
    if not name.endswith(".toml"):
        advice = did_you_mean(name, _texts())
        problem = f"no such machine, and no file that ends in .toml. {advice}"
        raise DesignError(f"machine {name}", [problem])
    return design.text_of(machine)


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


@cache
def _texts() -> dict[str, str]:
    """Texts of the files of the package, by name."""
    folder = files("stepwell.files") / "machines"
    every = sorted(folder.iterdir(), key=lambda file: file.name)
    return {file.name.removesuffix(".toml"): file.read_text("utf-8") for file in every}
