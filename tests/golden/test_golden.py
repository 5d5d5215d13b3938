"""What every command shows and writes stays as it is, unless somebody says so.

A change that is meant is accepted with `python tests/golden/freeze.py [CASE…]`, and seen in the
diff of the files under frozen/.
"""

import shlex
from typing import Any

import pytest

from golden.cases import CASES, Case, commands
from golden.comparing import differences
from golden.running import FROZEN, told
from stepwell.results.json_schema import violations
from stepwell.studies import WORKS

# Digits and the places of ticks are those of the locked dependencies.
pytestmark = pytest.mark.shown
_SHOWN = 60
# The claims that take minutes, what is said of this machine alone, and what needs a cluster.
_NOT_FROZEN = {
    "paper --all",
    "doctor",
    "doctor --json",
    "sweep WHAT --estimate",
    "sweep WHAT --scheduler",
    "atlas build --scheduler",
}


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=name, marks=[pytest.mark.slow] if case.slow else [])
        for name, case in CASES.items()
    ],
)
def test_a_user_sees_what_was_frozen(case: Case, tmp_path):
    file = FROZEN / f"{case.name}.txt"
    frozen = file.read_text("utf-8") if file.exists() else ""
    records: list[dict[str, Any]] = []
    found = told(case, tmp_path, records)
    lines = differences(frozen, found, case.within)
    more = [f"and {len(lines) - _SHOWN} more lines"] if len(lines) > _SHOWN else []
    accept = f"If this is better: python tests/golden/freeze.py {case.name}"
    assert not lines, "\n".join([*lines[:_SHOWN], *more, accept])
    unsaid = [problem for record in records for problem in violations(record)]
    assert not unsaid, "\n".join([*unsaid[:_SHOWN], accept])


def test_every_file_that_is_frozen_belongs_to_a_case():
    files = {file.relative_to(FROZEN).with_suffix("").as_posix() for file in FROZEN.rglob("*.txt")}
    assert files == CASES.keys(), "run `python tests/golden/freeze.py` with the cases that differ"


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
