"""What every command prints and writes stays as it is, unless a change is accepted.

A change that is meant is accepted with `python tests/golden/freeze.py [CASE…]`, and seen in the
diff of the files under frozen/.
"""

import shlex
from typing import Any

import pytest

from accounts.schemas import violations
from golden.cases import CASES, Case, commands
from golden.comparing import EXACT, differences, text_differences
from golden.options import options
from golden.promises import WIDE, page_faults, too_wide, unknown_numbers
from golden.reducing import laid_out, read
from golden.running import FROZEN, Outcome, entries_of, frozen, invoke, outcome, shown_in
from sizes import SIZE
from stepwell.files.curves import WORDS
from stepwell.studies import WORKS

# Digits and the places of ticks are those of the locked dependencies.
pytestmark = pytest.mark.shown
_SHOWN = 60
_EVERYWHERE = {"--force", "--full"}
# The claims that take minutes, what is said of this machine alone, what needs a cluster, and what
# has tests of its own: the demo, and the claims as JSON.
# Options of a reading beside the keys that a design has.
_READING = ("force_column", "save_reading")
_WITHIN = (
    *("anchor", "stiffness-tolerance", "rest-length-tolerance", "lever-tolerance", "friction"),
    *("travel-tolerance", "build"),
)
_NOT_FROZEN = {
    "build --step",  # needs build123d
    # Half a minute; tests/paper/test_buildable.py has two of the numbers.
    "robot ranges",
    "robot ranges --cycles",
    "robot ranges --json",
    "demo",
    "demo --out",
    "demo --no-open",
    "paper --all",
    "paper --json",
    "doctor",
    "doctor --json",
    # They need python-flint; tests/proof has their numbers.
    *("run --prove", "design --prove", "margin --prove"),
    # Read with --prove only; those of yield are frozen.
    *(f"margin --{one}" for one in _WITHIN),
    "sweep WHAT --estimate",
    "sweep WHAT --scheduler",
    "atlas build --scheduler",
}
# Their screens show numbers of what is no result of theirs: of a story, of a design file.
_OTHER_NUMBERS = {"files/presets", "help/pages"}
# The page of a run shows how many of those built do it, and the bands, which its record does not;
# that of a design the energy lost in its cycle; those of walks the settings of the simulation among
# the assumptions. The guide of a build has its own numbers.
_OTHER_PAGES = {"build", "run", "elements", "design", "walk", "maze"}


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=name, marks=[pytest.mark.slow] if case.slow else [])
        for name, case in CASES.items()
        if SIZE == "full" or not case.spare
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
    assert [line for screen in found.screens.values() for line in too_wide(screen)] == []
    assert [fault for page in found.pages.values() for fault in page_faults(page)] == []
    if found.records and case.name not in _OTHER_NUMBERS:
        texts = found.screens | ({} if case.kind in _OTHER_PAGES else found.words)
        unknown = {name: unknown_numbers(text, found.records) for name, text in texts.items()}
        assert {name: numbers for name, numbers in unknown.items() if numbers} == {}


def test_every_command_has_the_options_that_were_frozen():
    frozen_options = read((FROZEN / "options.json").read_text("utf-8"))
    found = read(laid_out(options()))
    accept = "If this is better: python tests/golden/freeze.py options"
    assert [*differences(frozen_options, found, EXACT)] == [], accept


def test_every_help_page_names_its_options_and_fits_a_terminal():
    for name, command in commands():
        page = invoke(*name.split(), "--help").stdout
        assert [line for line in page.split("\n") if len(line) > WIDE] == []
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
    if name.startswith("lab ") and option.replace("-", "_") in {*WORDS, *_READING}:
        return f"lab COMMAND --{option}"
    return f"sweep WHAT --{option}" if of_all and option else word


def _is_option(parameter: Any) -> bool:
    # What means the same to every command is shown once.
    return parameter.param_type_name == "option" and parameter.opts[0] not in _EVERYWHERE


def _asked(line: str) -> set[str]:
    """The command of a command line, alone and with each of its options."""
    words = shlex.split(line)
    name = " ".join(words[: 2 if words[:1] in (["robot"], ["lab"], ["sweep"], ["atlas"]) else 1])
    if "--help" in words:
        return set()
    return {name} | {f"{name} {word}" for word in words if word.startswith("--")}
