"""`stepwell map`: regions, boundaries and their files."""

import csv
import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import typer
import xarray as xr
from typer.testing import CliRunner

import stepwell as sw
from cli.folders import written
from stepwell.cli import app
from stepwell.cli.motion import cell_of, marks
from stepwell.cli.ranges import Range, grid
from stepwell.design import parameter_boundaries, parameter_map

FOUR = [pathway for pathway in sw.Pathway if pathway is not sw.Pathway.OTHER]
SMALL = ("--x", "0:20:41", "--y", "-15:15:41")
TWO = ("--across", "outer.q.x=0:20:11", "--up", "inner.stiffness=20:40:9")
NAMES = {"map.nc", "map.json", "map.png", "map.svg", "boundaries.csv", "report.html"}


class Made(NamedTuple):
    """A map in a folder, and what the screen said."""

    folder: Path
    record: dict[str, Any]


def made(folder: Path, *axes: str) -> Made:
    words = ["map", "preset:paper-forward", *axes, "--out", str(folder), "--json"]
    return Made(
        folder, json.loads(CliRunner().invoke(app, words).stdout, parse_constant=pytest.fail)
    )


@pytest.fixture(scope="module")
def small(tmp_path_factory) -> Made:
    return made(tmp_path_factory.mktemp("small") / "out", *SMALL)


@pytest.fixture(scope="module")
def two(tmp_path_factory) -> Made:
    return made(tmp_path_factory.mktemp("two") / "out", *TWO)


def test_the_papers_map_has_the_papers_areas(stepwell):
    # Physics of the two-cell map, q_out over x 0..20, y -15..15 mm.
    record = json.loads(stepwell("map", "forward.toml", "--json").stdout)
    expected = {"counterclockwise": 0.261, "via_01": 0.262, "via_10": 0.262, "clockwise": 0.215}
    fractions = {name: record["pathway_fractions"][name] for name in expected}
    assert fractions == pytest.approx(expected, abs=2e-3)
    assert sum(record["pathway_fractions"].values()) == pytest.approx(1.0)
    by_sequence = {pathway.name.lower(): record["fractions"][pathway.value] for pathway in FOUR}
    assert by_sequence == fractions


@pytest.mark.slow
def test_the_same_shares_are_printed(stepwell):
    record = json.loads(stepwell("map", "forward.toml", *SMALL, "--json").stdout)
    text = stepwell("map", "forward.toml", *SMALL).stdout
    for name, share in record["pathway_fractions"].items():
        assert (f"{100 * share:.1f} %" in text) == (share > 0)
        assert (name.replace("_", " ") in text) == (share > 0)
    assert "outer.q.x 0 to 20 mm, 41 values" in text
    assert "outer.q.y -15 to 15 mm, 41 values" in text
    assert f"{100 * record['monostable_fraction']:.1f} %" in text


@pytest.mark.slow
@pytest.mark.parametrize("which", ["small", "two"])
def test_the_folder_holds_picture_data_and_boundaries(which, request):
    out, record = request.getfixturevalue(which)
    assert written(out) == NAMES
    assert {*map(Path, record["files"])} == {out / name for name in NAMES}
    kept = json.loads((out / "map.json").read_text())
    assert kept == {name: value for name, value in record.items() if name != "files"}
    assert (out / "map.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_the_netcdf_reads_back_as_the_map(small):
    again = xr.load_dataset(small.folder / "map.nc")
    xs, ys = np.linspace(0, 0.02, 41), np.linspace(-0.015, 0.015, 41)
    expected = sw.transition_map(sw.preset("paper-forward"), 1, x=xs, y=ys)
    assert again.equals(expected)
    assert again["pathway"].attrs["flag_meanings"] == expected["pathway"].attrs["flag_meanings"]
    assert again.attrs.keys() == expected.attrs.keys()


@pytest.mark.slow
def test_the_boundaries_are_where_forces_are_equal_and_not_pixel_edges(small):
    inner, outer = sw.preset("paper-forward").cells
    with open(small.folder / "boundaries.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["kind"].endswith("_order")]
    assert {row["kind"] for row in rows} == {"loading_order", "unloading_order"}
    assert len(rows) > 100
    for row in rows[::10]:
        q = float(row["outer.q.x_mm"]) / 1e3, float(row["outer.q.y_mm"]) / 1e3
        moved = outer.with_anchors(q=q)
        force = "force_0" if row["kind"] == "loading_order" else "force_1"
        assert getattr(moved, force) == pytest.approx(getattr(inner, force), abs=1e-8)


@pytest.mark.parametrize("cell", ["inner", "1"])
def test_the_inner_cell_can_move_too(stepwell, cell):
    record = json.loads(stepwell("map", "forward.toml", *SMALL, "--cell", cell, "--json").stdout)
    assert record["moved_cell"] == "inner"
    assert [record[name]["parameter"] for name in ("across", "up")] == ["inner.q.x", "inner.q.y"]
    assert [record[name]["design"] for name in ("across", "up")] == [10, 0]


def test_bands_with_anchors_of_their_own_have_no_single_place_on_the_map():
    inner, outer = sw.preset("paper-forward").cells
    other = outer.with_anchors(q=(0.02, 0.005)).bands
    assert marks(sw.Chain((inner, outer)), 1) == {"this design": (0.02, 0.0)}
    assert marks(sw.Chain((inner, sw.Cell(outer.bands + outer.bands))), 1).keys() == {"this design"}
    assert marks(sw.Chain((inner, sw.Cell(outer.bands + other))), 1) == {}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--cell", "oter"), "'oter': must be one of inner (1), outer (2)."),
        (("--cell", "3"), "'3': must be one of inner (1), outer (2)."),
        (("--x", "0:20"), "'0:20': must be FROM:TO:COUNT in mm, as in 0:20:200."),
        (("--x", "a:b:c"), "'a:b:c': must be FROM:TO:COUNT in mm"),
        (("--y", "20:0:200"), "'20:0:200': must rise"),
        (("--y", "nan:0:200"), "'nan:0:200': must rise"),
        (("--y", "0:inf:200"), "'0:inf:200': must rise"),
        (("--y", "0:20:1"), "'0:20:1': the count must be 2 or more."),
        (("--y", "0:20:999999999"), "'0:20:999999999': 999999999 places of a map: at most"),
        (("--x", "0:20:5001", "--y", "0:20:5000"), "5001 x 5000, which take 1.4 GiB, are 25005000"),
    ],
)
def test_wrong_options_end_in_code_2_with_what_is_allowed(stepwell, arguments, message):
    result = stepwell("map", "forward.toml", *arguments)
    assert result.exit_code == 2
    assert message in result.output


@pytest.mark.slow
def test_any_two_parameters_span_a_map(two):
    out, record = two
    assert record["schema"] == "stepwell.map/3"
    assert record["across"] == {
        "parameter": "outer.q.x",
        "unit": "mm",
        "from": 0,
        "to": 20,
        "count": 11,
        "design": 20,
    }
    assert record["up"]["design"] == pytest.approx(28.5)
    assert sum(record["fractions"].values()) == pytest.approx(1.0)
    again = xr.load_dataset(out / "map.nc")
    xs, ys = np.linspace(0, 0.02, 11), np.linspace(20, 40, 9)
    chain = sw.preset("paper-forward")
    assert again.equals(parameter_map(chain, ("outer.q.x", xs), ("inner.stiffness", ys)))


@pytest.mark.slow
def test_the_boundary_of_two_parameters_is_where_forces_are_equal(two):
    inner, outer = sw.preset("paper-forward").cells
    with open(two.folder / "boundaries.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["kind"] != "bistable"]
    assert len(rows) > 20
    for row in rows:
        stiff = replace(inner.bands[0], stiffness=float(row["inner.stiffness_N_per_m"]))
        moved = outer.with_anchors(q=(float(row["outer.q.x_mm"]) / 1e3, 0.0))
        assert replace(inner, band=stiff).force_0 == pytest.approx(moved.force_0, abs=1e-7)


def test_angles_are_in_degrees_and_ratios_may_be_equal(stepwell, monkeypatch):
    # The engine has to follow every node, and the numbers asked for below do not hang on how many.
    coarse = partial(parameter_boundaries, search=5)
    monkeypatch.setattr("stepwell.design.parameter_boundaries", coarse)
    axes = ("--across", "inner.limit=40:50:3", "--up", "actuator_stiffness=10:1000:3:log")
    record = json.loads(stepwell("map", "forward.toml", *axes, "--json").stdout)
    assert (record["across"]["unit"], record["across"]["from"]) == ("deg", pytest.approx(40))
    assert record["across"]["design"] == pytest.approx(45)
    assert (record["up"]["unit"], record["up"]["to"]) == ("N/m", pytest.approx(1000))
    assert record["up"]["design"] is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--across", "outer.q.x=0:20:5"), "--across: needs --up NAME=FROM:TO:COUNT too."),
        (("--up", "outer.q.x=0:20:5"), "--up: needs --across NAME=FROM:TO:COUNT too."),
        (("--across", "outer.q.x"), "'outer.q.x': must be NAME=FROM:TO:COUNT"),
        (("--across", "outer.q.x=0:20:1"), "the count must be 2 or more."),
        (("--across", "outer.q.x=20:0:5"), "must rise"),
        (("--across", "outer.q.x=0:20:5:log"), "must start above 0 for equal ratios."),
    ],
)
def test_a_wrong_parameter_ends_in_code_2_with_what_is_allowed(stepwell, arguments, message):
    result = stepwell("map", "forward.toml", *arguments)
    assert result.exit_code == 2
    assert message in result.output


@pytest.mark.parametrize(
    ("across", "options", "message"),
    [
        ("outer.qx=0:20:5", (), "Did you mean 'outer.q.x'?"),
        ("outer.q=0:20:5", (), "use outer.q.x or outer.q.y."),
        ("inner.stiffness=20:40:5", (), "use two different parameters."),
        ("outer.lever=-5:5:5", (), "lever"),
        ("outer.q.x=0:20:5", ("--cell", "inner"), "cannot be combined with --cell, --x or --y."),
    ],
)
def test_two_parameters_have_to_go_together(stepwell, across, options, message):
    arguments = ("--across", across, "--up", "inner.stiffness=20:40:5", *options)
    result = stepwell("map", "forward.toml", *arguments)
    assert result.exit_code == 2
    assert message in result.output


@pytest.mark.slow
def test_a_chain_of_any_length_has_a_map_over_an_anchor(stepwell):
    axes = ("--x", "0:20:5", "--y", "-15:15:5", "--cell", "2")
    record = json.loads(stepwell("map", "preset:three-wave", *axes, "--json").stdout)
    assert record["closed_form_designs"] == 25
    assert record["pathway_fractions"] is None
    assert sum(record["fractions"].values()) == pytest.approx(1.0)
    (own,) = {band.q for band in sw.preset("three-wave").cells[1].bands}
    assert [record[name]["design"] for name in ("across", "up")] == pytest.approx(
        [1e3 * place for place in own]
    )


def test_negative_numbers_are_no_options(stepwell):
    assert grid("-15:-1.5:7") == Range(-15.0, -1.5, 7)
    assert stepwell("map", "forward.toml", "--x", "1:2:2", "--y", "-3:-1:2").exit_code == 0


def test_a_grid_is_in_metres_and_holds_both_ends():
    assert list(grid("0:20:3").values(1e3)) == [0.0, 0.01, 0.02]


def test_a_cell_is_found_by_name_before_place_and_number():
    cell = sw.preset("paper-cell-10-0").cells[0]
    named = [sw.Cell(cell.band, name=name) for name in ("outer", "1", "leg")]
    chain = sw.Chain(tuple(named))
    assert [cell_of(chain, text) for text in ("outer", "1", "leg", "inner", "2", "3")] == [
        *(0, 1, 2, 0, 1, 2)
    ]
    twice = sw.Chain((named[2], named[2]))
    with pytest.raises(typer.BadParameter, match=r"leg \(1\), leg \(2\)"):
        cell_of(twice, "leg")
    assert cell_of(twice, "1") == 0
