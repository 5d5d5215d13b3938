"""What a screen says in numbers, the JSON of the same command says too."""

import json
import re
import shlex
from collections.abc import Iterator
from typing import Any

import pytest

from golden.cases import CASES
from golden.recordings import bands, cells, rubber
from golden.running import invoke
from stepwell.base import number

# A number with a point: counts and the digits of states are too many to mean one thing.
_NUMBER = re.compile(r"(?<![\w.>])[-+]?\d+\.\d+(?![\w.>])")
COMMANDS = (
    "run preset:three-wave",
    "run preset:compliant-actuator",
    "run preset:trilinear",
    "program preset:paper-forward --from 10 --to 01",
    "map preset:paper-forward --x 0:20:5 --y -15:15:5",
    "graph preset:three-wave",
    "yield preset:paper-forward --samples 40 --sensitivity",
    "reprogram preset:paper-forward --by inner.p",
    "robot show robot-left",
    "robot show robot-explorer",
    "robot sweep robot-forward chain.cell.outer.q_mm[0]=5:20:2 foot.below_mm=-1:1:2 --cycles 1 "
    "--out out",
    "robot converge robot-forward --cycles 2",
    "walk robot-explorer --cycles 2",
    "maze robot-explorer cylinder --limit 12",
    "design '00>01>11>10>00' --samples 100 --seed 3",
    "design 00,10,11 --samples 20 --drive 200",
    "design '00>10>11>10>00' --element trilinear --drive force --force-scale 0.5:4",
    "lab read data",
    "lab band bands --gauge-mm 15",
    "lab compare data",
    "lab calibrate rubber",
)
# What makes the files that a command reads.
PREPARED = {"data": cells, "bands": bands, "rubber": rubber}


def numbers(value: Any) -> Iterator[float]:
    """Every number in a record, those in its sentences too."""
    if isinstance(value, dict):
        for part in value.values():
            yield from numbers(part)
    elif isinstance(value, list):
        for part in value:
            yield from numbers(part)
    elif isinstance(value, str):
        yield from map(float, _NUMBER.findall(value))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_every_number_on_a_screen_is_in_the_json(command, tmp_path, monkeypatch):
    words = shlex.split(command)
    assert any(line.startswith(words[0]) for case in CASES.values() for line in case.commands)
    monkeypatch.chdir(tmp_path)
    for word in words:
        PREPARED.get(word, lambda _: None)(tmp_path)
    record = json.loads(invoke(*words, "--json").stdout)
    shown = _NUMBER.findall(invoke(*words).stdout)
    assert shown
    known = {abs(value * factor) for value in numbers(record) for factor in (1.0, 100.0, 1e3)}
    # How far an anchor has been moved stands in JSON as a share of the whole way.
    known |= {one["fraction"] * record["distance_mm"] for one in record.get("way", ())}
    # Numbers of a design are told as they were given, all others with four digits or fewer.
    told = {number(value, digits) for value in known for digits in (2, 3, 4, 6)}
    told |= {f"{value:.{digits}f}" for value in known for digits in (1, 2, 3)}
    assert [text for text in shown if text.lstrip("+-") not in told] == []
