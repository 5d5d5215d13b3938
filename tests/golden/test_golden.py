"""What every command prints and writes stays as it is, unless a change is accepted.

A change that is meant is accepted with `python tests/golden/freeze.py [CASE…]`, and seen in the
diff of the files under frozen/.
"""

import re
import shlex
from collections.abc import Iterator
from typing import Any

import pytest
from stepwell.results.json_schema import violations

from golden.cases import CASES, Case, commands
from golden.comparing import EXACT, differences, text_differences
from golden.options import options
from golden.reducing import laid_out, read
from golden.running import FROZEN, Outcome, entries_of, frozen, invoke, outcome, shown_in
from stepwell.base import number
from stepwell.studies import WORKS

# Digits and the places of ticks are those of the locked dependencies.
pytestmark = pytest.mark.shown
_SHOWN = 60
# The claims that take minutes, what is said of this machine alone, what needs a cluster, and what
# has tests of its own: the demo, and the claims as JSON.
_NOT_FROZEN = {
    "demo",
    "demo --out",
    "demo --no-open",
    "paper --all",
    "paper --json",
    "doctor",
    "doctor --json",
    "sweep WHAT --estimate",
    "sweep WHAT --scheduler",
    "atlas build --scheduler",
}
_WIDE = 80
# A number with a point: counts and the digits of states are too many to mean one thing.
_NUMBER = re.compile(r"(?<![\w.>])[-+]?\d+\.\d+(?![\w.>])")
# Their screens show numbers of what is no result of theirs: of a story, of a design file.
_OTHER_NUMBERS = {"files/presets", "help/pages"}


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=name, marks=[pytest.mark.slow] if case.slow else [])
        for name, case in CASES.items()
    ],
)
def test_a_command_prints_and_writes_what_was_frozen(case: Case, tmp_path):
    entries, text = frozen(case)
    found = outcome(case, tmp_path)
    # As it would be read again.
    lines = list(differences(entries, read(laid_out(found.entries)), case.within))
    lines += text_differences(text, found.text, case.within)
    more = [f"and {len(lines) - _SHOWN} more lines"] if len(lines) > _SHOWN else []
    accept = f"If this is better: python tests/golden/freeze.py {case.name}"
    assert not lines, "\n".join([*lines[:_SHOWN], *more, accept])
    _keeps_its_promises(case, found)


def _keeps_its_promises(case: Case, found: Outcome) -> None:
    """What holds for every command: its schema, the list of its files, its width, its numbers."""
    assert [problem for record in found.records for problem in violations(record)] == []
    for manifest, files in found.folders:
        assert {*manifest["files"], "stepwell.json"} == files
    for screen in found.screens.values():
        # What is there to be copied is printed as it is; a path may be longer.
        lines = screen.partition("For a design file:")[0].split("\n")
        assert [line for line in lines if len(line) > _WIDE and " " in line.strip()] == []
    if found.records and case.name not in _OTHER_NUMBERS:
        assert _unknown_numbers(found) == {}


def _unknown_numbers(found: Outcome) -> dict[str, list[str]]:
    """Numbers on screens that no record holds, by command."""
    known = {
        abs(value * factor)
        for record in found.records
        for value in _numbers(record)
        for factor in (1.0, 100.0, 1e3)
    }
    # How far an anchor has been moved stands in JSON as a share of the whole way.
    known |= {
        one["fraction"] * record["distance_mm"]
        for record in found.records
        for one in record.get("way", ())
    }
    # Numbers of a design are printed as they were given, all others with four digits or fewer.
    printed = {number(value, digits) for value in known for digits in (2, 3, 4, 6)}
    printed |= {f"{value:.{digits}f}" for value in known for digits in (1, 2, 3)}
    unknown = {
        command: [text for text in _NUMBER.findall(screen) if text.lstrip("+-") not in printed]
        for command, screen in found.screens.items()
    }
    return {command: texts for command, texts in unknown.items() if texts}


def _numbers(value: Any) -> Iterator[float]:
    """Every number in a record, those in its sentences too."""
    if isinstance(value, dict):
        for part in value.values():
            yield from _numbers(part)
    elif isinstance(value, list):
        for part in value:
            yield from _numbers(part)
    elif isinstance(value, str):
        yield from map(float, _NUMBER.findall(value))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)


def test_every_command_has_the_options_that_were_frozen():
    frozen_options = read((FROZEN / "options.json").read_text("utf-8"))
    found = read(laid_out(options()))
    accept = "If this is better: python tests/golden/freeze.py options"
    assert [*differences(frozen_options, found, EXACT)] == [], accept


def test_every_help_page_names_its_options_and_fits_a_terminal():
    for name, command in commands():
        page = invoke(*name.split(), "--help").stdout
        assert [line for line in page.split("\n") if len(line) > _WIDE] == []
        assert [
            one.opts[0] for one in command.params if one.opts[0] not in page and _is_option(one)
        ] == []
        assert command.help and command.help.split("\n")[0] in " ".join(page.split()), name


def test_everything_that_is_frozen_belongs_to_a_case():
    texts = {file.name for file in FROZEN.glob("*.txt")}
    assert texts == {shown_in(case).name for case in CASES.values() if case.shown}
    kinds = {file.stem for file in FROZEN.glob("*.json")} - {"options"}
    names = {name for kind in kinds for name in entries_of(kind)}
    assert names == CASES.keys(), "run `python tests/golden/freeze.py` with the cases that differ"


def test_no_command_and_no_option_was_forgotten():
    asked = {
        word for case in CASES.values() for line in case.commands for word in _asked(line)
    } | _NOT_FROZEN
    there = set()
    for name, command in commands():
        if not hasattr(command, "commands"):
            there.add(name)
            there |= {_shared(f"{name} {one.opts[0]}") for one in command.params if _is_option(one)}
    asked = {_shared(word) for word in asked}
    assert sorted(there - asked) == [], "have each run by a case in tests/golden/cases.py"


def _shared(word: str) -> str:
    """What is computed of many designs is asked for by one function, whose options count once."""
    name, _, option = word.partition(" --")
    of_all = {"sweep " + what for what in WORKS} & {name}
    return f"sweep WHAT --{option}" if of_all and option else word


def _is_option(parameter: Any) -> bool:
    # What means the same to every command that writes is shown once.
    return parameter.param_type_name == "option" and parameter.opts[0] != "--force"


def _asked(line: str) -> set[str]:
    """The command of a command line, alone and with each of its options."""
    words = shlex.split(line)
    name = " ".join(words[: 2 if words[:1] in (["robot"], ["lab"], ["sweep"], ["atlas"]) else 1])
    if "--help" in words:
        return set()
    return {name} | {f"{name} {word}" for word in words if word.startswith("--")}
