"""The answer of every command fits a screen of 25 lines of 80 letters, and is its first line."""

import shlex

import pytest

import stepwell as sw
from facts import says
from golden.cases import commands
from golden.running import invoke
from sizes import cases
from stepwell.accounts.rendering.terminal import SCREEN

TWO_CELLS = [
    name for name in sw.presets() if not name.startswith("robot-") and len(sw.preset(name)) == 2
]
# Command lines, and a part of their first line.
QUICK = {
    "run paper-forward": "00>10>11>01>00",
    "run paper-identical": "00>10>11>01>00",
    "map paper-forward --x 0:20:5 --y -15:15:3": "sequences",
    "graph paper-forward": "00>10>11>01>00",
    "graph paper-identical": "loop",
    "program paper-forward --target 01": "2 strokes",
    "program paper-via-10 --target 01": "01",
    "design '00>10>11>01>00' --samples 200": "inner q (",
    "design 00,10,11 --samples 20": "inner q (",
    "design '00>10>11>01>00' --holes 40": "impossible",
    "design '00>10>00>01>00' --actuators 2 --samples 20": "after cell 1",
    "design jump --holes 10 --samples 20": "in one snap",
    "reprogram paper-forward --by inner.p": "inner.p moved",
    "check paper-forward --samples 200": "Robust",
    "check paper-identical --samples 200": "Marginal",
    "yield paper-forward --sensitivity --samples 200": "100 %",
    "yield paper-identical --samples 200": "%",
    "yield used-before --program --samples 20": "%",
    "margin paper-forward": "8.002 mm",
    "build paper-forward --samples 200": "can be built",
    "doctor": "installed",
}
ROBOTS = {
    "walk robot-forward --cycles 2": "mm in 2 cycles",
    "maze robot-explorer three-walls --limit 4": "4 s",
    "jump hopper": "mm high",
    "compile turn-away --walks 1 --samples 50": "all rows",
    "robot show robot-forward": "forward",
    "robot show robot-explorer": "forward",
    "robot sweep robot-forward foot.below_mm=0.6:1:3 --cycles 1 --out feet": "3 of 3",
    "robot converge robot-forward": "d/u_max",
}
GRID = "paper-forward --vary outer.q.x=0:20:5 --workers 0 --out"
WALKED = "robot-forward --vary foot.below_mm=0.6:1:2 --workers 0 --out"
STUDIES = {
    f"sweep cycle {GRID} cycle": "% of the designs",
    f"sweep margin {GRID} margin": "% of the designs",
    f"sweep yield {GRID} yield": "% of the designs",
    f"sweep graph {GRID} graph": "median",
    f"sweep program --target 01 {GRID} program": "median",
    f"sweep call --function own.py:measure {GRID} call": "median",
    f"sweep walk --cycles 1 {WALKED} walk": "%",
    f"sweep maze --arena pen --limit 1 {WALKED} maze": "%",
    "sweep cycle paper-forward --vary outer.q.x=0:20 --random 4 --workers 0 --out drawn": "%",
    "sweep extend drawn --count 6 --workers 0": "%",
    "sweep resume cycle --workers 0": "% of the designs",
    "sweep status cycle": "% of the designs",
    "sweep report cycle --out report": "% of the designs",
    "atlas build --designs 2000 --workers 0 --out two": "graphs",
    "atlas show two": "graphs",
    "atlas find 'reaches every state' two": "2 of the graphs",
}
# Claims take minutes: tests/accounts/test_paper.py has those that are committed. Ranges take half a
# minute: tests/paper/test_buildable.py has two of the numbers.
CLAIMS = {"paper", "validate", "robot ranges"}
# What these print is a list, a story or the name of a file.
NO_ANSWER = {
    *("new", "presets", "schema", "export", "view", "studio", "figure", "animate", "replay"),
    *("demo", "sweep cancel", "sweep export"),
}


def _fits(line: str, part: str) -> str:
    result = invoke(*shlex.split(line))
    assert result.exit_code in (0, 3), result.stderr
    lines = result.stdout.partition("\nWritten into")[0].rstrip("\n").split("\n")
    assert len(lines) <= SCREEN, result.stdout
    assert [one for one in lines if len(one) > 80] == []
    says(lines[0], part)
    return lines[0]


def test_every_command_with_an_answer_is_run_here():
    there = {name for name, one in commands() if not hasattr(one, "commands")}
    run = {
        name
        for line in (*QUICK, *ROBOTS, *STUDIES)
        for name in there
        if shlex.split(line)[: len(name.split())] == name.split()
    }
    labs = {name for name in there if name.startswith("lab ")}
    assert there == run | CLAIMS | NO_ANSWER | labs


@pytest.mark.slow
@pytest.mark.parametrize("line", QUICK)
def test_an_answer_for_two_cells_fits_a_screen_and_full_has_more_lines(line):
    first = _fits(line, QUICK[line])
    whole = invoke(*shlex.split(line), "--full").stdout
    assert whole.startswith(first)
    assert "--full" not in whole.split("\n")[-2]


@pytest.mark.slow
@pytest.mark.parametrize("name", cases(TWO_CELLS, ["friction", "kresling", "balloon"]))
def test_cycle_graph_and_yield_of_each_pair_fit_a_screen(name):
    _fits(f"run {name}", "0>")
    _fits(f"yield {name} --samples 20", "%")
    if name != "friction":  # Its graph is not finite.
        _fits(f"graph {name}", "0>")


@pytest.mark.slow
@pytest.mark.parametrize("line", ROBOTS)
def test_an_answer_for_a_robot_fits_a_screen(line, tmp_path, monkeypatch):
    pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)
    _fits(line, ROBOTS[line])


@pytest.mark.slow
def test_answers_of_studies_fit_a_screen(tmp_path, monkeypatch):
    pytest.importorskip("mujoco")
    pytest.importorskip("zarr")
    monkeypatch.chdir(tmp_path)
    own = "def measure(chain, seed):\n    return {'cells': len(chain)}\n"
    (tmp_path / "own.py").write_text(own, "utf-8")
    for line, part in STUDIES.items():
        _fits(line, part)
