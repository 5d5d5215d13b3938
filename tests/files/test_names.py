"""Names are text: in tables, on the terminal, in reports."""

import csv
import io
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from stepwell import lab
from stepwell.design import Tolerances, parameter_boundaries, yields
from stepwell.lab.recordings.recording import Recording
from stepwell.reports import boundary_rows
from stepwell.simulation.sweeps import Sweep, Trial

HOSTILE = ["a,b", 'say "x"', "two\nlines", "=1+1", "a_b", "a b", "'", "\r", "; |", "$\\frac$", ""]


def rows(text: str) -> list[list[str]]:
    found = list(csv.reader(io.StringIO(text, newline="")))
    assert len({len(row) for row in found}) == 1
    return found


def named(*names: str) -> sw.Chain:
    chain = sw.preset("paper-forward")
    cells = [replace(cell, name=name) for cell, name in zip(chain.cells, names, strict=True)]
    return replace(chain, cells=tuple(cells))


@pytest.mark.parametrize("name", HOSTILE)
def test_a_path_has_a_column_for_every_cell_whatever_its_name(tmp_path, name):
    chain = named(name, "b")
    path = chain.path([0.0, chain.full_stroke])
    path.to_csv(tmp_path / "path.csv")
    head, *found = rows((tmp_path / "path.csv").read_bytes().decode())
    assert len(head) == 10
    assert head[2:4] == [f"travel_{n.replace(' ', '_')}_mm" for n in chain.names]
    assert np.array(found, float)[:, 3] == pytest.approx(path.travel[:, 1] * 1e3)


def test_two_names_that_differ_in_a_blank_keep_their_columns(tmp_path):
    chain = named("a b", "a_b")
    path = chain.path([0.0, chain.full_stroke])
    path.to_csv(tmp_path / "path.csv")
    head, *found = rows((tmp_path / "path.csv").read_text("utf-8"))
    assert head[2:4] == ["travel_a_b_mm"] * 2
    assert np.array(found, float)[:, 2:4] == pytest.approx(path.travel * 1e3)


@pytest.mark.parametrize("name", HOSTILE)
def test_other_tables_keep_a_name_in_its_cell(tmp_path, name):
    sweep = Sweep({f'leg."{name}".x': [1.0]}, (Trial(0.1, 0.0, 0.0, ("00",), 0.0, name),))
    sweep.to_csv(tmp_path / "sweep.csv")
    head, row = rows((tmp_path / "sweep.csv").read_bytes().decode())
    assert (head[0], row[-1]) == (f'leg."{name}".x', name)
    way = np.array([0.0, 0.001, 0.002])
    recording = Recording(f"{name}.txt", way, way, way)
    lab.to_csv([recording], tmp_path / "recordings.csv")
    head, *found = rows((tmp_path / "recordings.csv").read_bytes().decode())
    assert {row[0] for row in found} == {recording.name}


def test_a_map_of_parameters_names_them_in_its_head(tmp_path):
    chain = named("a,b", "c")
    parameters = ("a,b.q.x", [0.0, 0.01, 0.02]), ("c.stiffness", [20.0, 30.0])
    head, *found = rows(boundary_rows(parameter_boundaries(chain, *parameters)))
    assert head == ["curve", "kind", "a,b.q.x_mm", "c.stiffness_N_per_m"]
    assert found


def test_outcomes_are_counted_in_a_table_of_three_columns(tmp_path):
    found = yields(sw.preset("paper-forward"), Tolerances(anchor=0.003), samples=200)
    found.to_csv(tmp_path / "yield.csv")
    head, *counts = rows((tmp_path / "yield.csv").read_text("utf-8"))
    assert head == ["outcome", "count", "fraction_1"]
    assert sum(int(row[1]) for row in counts) == 200
