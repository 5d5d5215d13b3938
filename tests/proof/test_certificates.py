"""Certificates that a script without Stepwell checks."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import stepwell as sw
from docs.proofs import RECORD, random_chains, shown, table
from facts import says
from stepwell.proof import certificate, check_certificate as checker
from stepwell.proof.certificates import digest

SCRIPT = Path(sw.__file__).parent / "proof" / "check_certificate.py"
CHECKED = "paper-forward", "paper-backward", "paper-via-01", "rubber", "three-wave", "countdown"


def certificate_of(name: str) -> str:
    return certificate(sw.preset(name).cycle().path.prove())


@pytest.mark.parametrize("name", CHECKED)
def test_the_script_proves_the_certificate_of_a_preset(name):
    assert checker.check(certificate_of(name)).startswith("proved: ")


@pytest.mark.parametrize(("name", "taken"), [("four-shuffle", 1), ("lock-with-alarm", 3)])
def test_the_script_names_the_landings_that_it_does_not_check(name, taken):
    said = checker.check(certificate_of(name))
    says(said, "not checked", str(taken))
    assert "not checked" not in checker.check(certificate_of("three-wave"))


@pytest.mark.parametrize("what", ["travel", "cell", "stop", "released"])
def test_a_false_landing_that_is_taken_from_the_file_fails(what):
    data = json.loads(certificate_of("four-shuffle"))
    (snap,) = [event for event in data["events"] if event.get("taken")]
    between = [k for k, cell in enumerate(snap["cells"]) if not at_stop(data, cell, snap, k)]
    assert len(between) == 1
    k, other = between[0], 1 - between[0]
    if what == "travel":
        snap["after"][k][0] += 1e-12
    elif what == "cell":
        snap["after"][k], snap["after"][other] = snap["after"][other], snap["after"][k]
    elif what == "stop":
        snap["after"][other][0] = data["cells"][snap["cells"][other]]["low"]
    else:
        snap["taken"] = False
    with pytest.raises(checker.NotProved):
        checker.check(json.dumps({**data, "sha256": digest(data)}))


def at_stop(data, cell: int, snap, k: int) -> bool:
    own = data["cells"][cell]
    return snap["after"][k][0] in (own["low"], own["high"])


def test_the_script_runs_alone(tmp_path):
    (tmp_path / "one.json").write_text(certificate_of("paper-forward"), "utf-8")
    command = [sys.executable, str(SCRIPT), str(tmp_path / "one.json")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == "proved: 6 events of 2 cells, and no others\n"


def test_the_script_is_short_and_imports_nothing_of_stepwell():
    text = SCRIPT.read_text("utf-8")
    imports = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import)]
    froms = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]
    names = {name.name for node in imports for name in node.names} | {f.module for f in froms}
    assert names - set(sys.stdlib_module_names) == {"flint"}
    assert len(text.splitlines()) <= 250


def test_a_certificate_with_one_digit_changed_fails():
    text = certificate_of("paper-forward")
    places = [k for k, letter in enumerate(text) if letter.isdigit()]
    rng = np.random.default_rng(0)
    for k in rng.choice(places, 200, replace=False):
        digit = str((int(text[k]) + 1 + int(rng.integers(9))) % 10)
        if digit == text[k]:
            continue
        with pytest.raises((checker.NotProved, KeyError, ValueError)):
            checker.check(text[:k] + digit + text[k + 1 :])


@pytest.mark.parametrize("what", ["stiffness", "stroke", "travel", "order", "event"])
def test_a_false_claim_with_the_right_digest_fails(what):
    data = json.loads(certificate_of("three-wave"))
    events = data["events"]
    if what == "stiffness":
        data["cells"][0]["laws"][0]["k"] *= 1.0 + 1e-9
    elif what == "stroke":
        events[1]["stroke"][0] += 1e-12
    elif what == "travel":
        events[1]["after"][0][0] += 1e-12
    elif what == "order":
        events[0], events[1] = events[1], events[0]
    else:
        del events[2]
    with pytest.raises(checker.NotProved):
        checker.check(json.dumps({**data, "sha256": digest(data)}))


@pytest.mark.parametrize("name", ["friction", "force-control", "paper-identical"])
def test_a_path_that_the_script_cannot_check_is_refused(name):
    with pytest.raises(ValueError, match="no certificate"):
        certificate_of(name)


def test_the_page_shows_the_record_of_random_chains_without_a_contradiction():
    assert shown("random chains") == random_chains()
    rows = [json.loads(line) for line in RECORD.read_text("utf-8").splitlines()]
    assert [row["chain"] for row in rows] == list(range(1100))
    free = [row for row in rows if row["outcome"] != "tie"]
    assert sum(row["outcome"] == "proved" for row in free) >= 0.95 * len(free)
    assert not any(row["outcome"] == "contradicted" for row in rows)
    assert all(row["caught"] for row in rows if row["outcome"] == "proved")


def test_the_page_shows_what_is_proved_of_each_preset():
    assert shown() == table()
    assert shown().count("| proved |") >= 30
