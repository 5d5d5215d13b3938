"""Promises about the folder of a build: all files or none, drafts that say so, holes read back."""

import io
import json
import math
from dataclasses import replace

import pytest
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.filemanagement import read as read_dxf
from matplotlib.text import Text

import stepwell as sw
from build import chains
from facts import refuses, says
from stepwell import figures, reports
from stepwell.base import InputError
from stepwell.build import FileOptions, Layout, build, build_files, layout, load_build_file
from stepwell.build.exports.cutting import cutting
from stepwell.build.exports.dxf import dxf_text
from stepwell.build.exports.parts_list import bands_csv
from stepwell.design import BandType
from stepwell.mechanism import Cell

ROWS = FileOptions(nest=0)


@pytest.fixture(scope="module")
def pair():
    return build(chains.pair(), samples=200)


@pytest.fixture(scope="module")
def files(pair):
    return build_files(pair, ROWS)


@pytest.mark.slow
def test_a_build_has_every_kind_of_file(pair, files):
    for part in pair.layout.parts:
        assert {f"parts/{part.name}.{end}" for end in ("dxf", "svg", "stl")} <= files.keys()
    assert {f"sheets/acrylic-3mm-1.{end}" for end in ("dxf", "svg", "3mf")} <= files.keys()
    assert {"coupon.dxf", "coupon.svg", "coupon.txt", "parts.csv", "bands.csv"} <= files.keys()
    assert {"template-A4.pdf", "template-letter.pdf", "guide.html", "guide.pdf"} <= files.keys()
    assert all(files.values())


@pytest.mark.slow
def test_equal_builds_have_equal_files(pair, files):
    assert build_files(pair, ROWS) == files


@pytest.mark.slow
def test_files_are_written_together_and_replaced(pair, files, tmp_path):
    folder = tmp_path / "parts"
    names = reports.write(pair, folder, files=files)
    assert files.keys() < set(names)
    for name, content in files.items():
        data = content.encode() if isinstance(content, str) else content
        assert (folder / name).read_bytes() == data
    manifest = json.loads((folder / "stepwell.json").read_text())
    assert manifest["command"] == "build"
    assert set(manifest["files"]) >= files.keys()


@pytest.mark.slow
def test_drawings_of_r12_are_of_r12():
    made = build(chains.pair(), samples=50)
    text = str(build_files(made, replace(ROWS, dxf="R12"))["parts/lever-1a.dxf"])
    assert read_dxf(io.StringIO(text)).dxfversion == "AC1009"


@pytest.mark.slow
def test_there_are_no_files_while_a_finding_is_left():
    made = build(chains.steep(), samples=50)
    with refuses(InputError, "nothing is written", "--draft"):
        build_files(made, ROWS)


@pytest.mark.slow
def test_every_draft_says_so_in_its_name_and_in_itself():
    made = build(chains.steep(), samples=50)
    drafts = build_files(made, replace(ROWS, draft=True))
    assert all(name.rpartition("/")[2].startswith("DRAFT-") for name in drafts)
    for name, content in drafts.items():
        if name.endswith((".pdf", ".3mf", ".csv")):
            continue
        data = content if isinstance(content, bytes) else content.encode()
        assert b"DRAFT" in data, name
    audit = read_dxf(io.StringIO(str(drafts["parts/DRAFT-lever-1a.dxf"]))).audit()
    assert audit.errors == []
    words = [text.get_text() for text in figures.layers(made).findobj(Text)]
    assert any(word.startswith("DRAFT: ") for word in words)


def test_the_parts_list_counts_every_part_and_fastener(pair, files):
    rows = [line.split(",") for line in str(files["parts.csv"]).splitlines()[1:]]
    count = sum(int(row[3]) for row in rows if row[0] == "cut part")
    assert count == len(pair.layout.parts)
    text = str(files["parts.csv"])
    assert "pin,ISO 8734 3 x 10,,9," in text
    assert sum("acrylic-3mm-1" in row[-1] for row in rows) == count


def test_the_bands_list_has_forces_for_a_kitchen_scale(pair, files):
    head, *rows = (line.split(",") for line in str(files["bands.csv"]).splitlines())
    for row, cell in zip(rows, chains.pair().cells, strict=True):
        assert isinstance(cell, Cell)
        named = dict(zip(head, row, strict=True))
        length = float(cell.bands[0].length(-cell.limit, cell.lever))
        force = float(cell.bands[0].tension(length))
        assert float(named["length_state_0_mm"]) == pytest.approx(1e3 * length, abs=0.01)
        assert float(named["force_state_0_N"]) == pytest.approx(force, abs=1e-3)
        assert float(named["pull_state_0_g"]) == pytest.approx(force / 9.80665e-3, abs=0.1)


def test_available_bands_that_pull_as_the_design_are_named(pair):
    kinds = (
        BandType(28.5 * 1.04, 0.010, name="stiff.toml"),
        BandType(28.5, 0.012, name="long.toml"),
        BandType(28.5 * 1.3, 0.010, name="hard.toml"),
    )
    head, *rows = bands_csv(pair, kinds).splitlines()
    assert head.endswith(",available")
    # 2 mm of 21.6 mm of extension are 9 %, within two standard deviations of 5 %.
    says(rows[0], "stiff.toml (+4.0 %)", "long.toml (-9.2 %)")
    assert "hard.toml" not in rows[0]


def circles(text: str) -> list[tuple[float, float]]:
    """Centres of all circles of a drawing, in the order of the file [m]."""
    found = read_dxf(io.StringIO(text)).modelspace().query("CIRCLE")
    return [(one.dxf.center.x / 1e3, one.dxf.center.y / 1e3) for one in found]


def lowest_and_highest(text: str) -> tuple[float, float]:
    """Least and greatest y of the outline of a drawing [m]."""
    (outline,) = read_dxf(io.StringIO(text)).modelspace().query("LWPOLYLINE")
    assert isinstance(outline, LWPolyline)
    ys = [y / 1e3 for _, y in outline.get_points("xy")]
    return min(ys), max(ys)


def read_back(plan: Layout) -> list[Cell]:
    """The cells whose levers, limits and anchors are measured in the DXF files."""
    drawn = {part.name: dxf_text(cutting(part)) for part in plan.parts}
    cells = []
    for number, one in enumerate(plan.cells):
        lever = math.dist(*circles(drawn[f"lever-{number + 1}a"]))
        fronts, places = [], []
        for block in (number, number + 1):
            name = f"block-{block}-top"
            holes = [hole.name for hole in plan.part(name).holes]
            at = dict(zip(holes, circles(drawn[name]), strict=True))
            (xa, y), (xb, _) = at[f"{number + 1}a"], at[f"{number + 1}b"]
            low, high = lowest_and_highest(drawn[name])
            # The plate reaches far to the back, and a little to the front.
            away = 1.0 if high - y > y - low else -1.0
            fronts.append(min(high - y, y - low))
            places.append((at, (xa + xb) / 2.0, y, away))
        bands = []
        for path in (path for path in plan.bands if path.cell == number):
            anchors = []
            for (at, x, y, away), hole in zip(places, path.holes, strict=True):
                anchors.append((away * (at[hole][1] - y), at[hole][0] - x))
            (out_p, along_p), (out_q, along_q) = anchors
            band = one.cell.bands[path.number]
            bands.append(replace(band, p=(-out_p, along_p), q=(out_q, along_q)))
        cells.append(Cell(bands, lever=lever, limit=math.acos(sum(fronts) / lever)))
    return cells


@pytest.mark.parametrize("name", ["paper-forward", "paper-backward", "three-wave", "four-shuffle"])
def test_the_holes_of_the_drawings_read_back_give_the_same_sequence(name):
    chain = sw.preset(name)
    assert isinstance(chain, sw.Chain)
    plan = layout(chain, load_build_file("acrylic-3mm"))
    again = read_back(plan)
    for cell, one in zip(again, plan.cells, strict=True):
        assert cell.lever == pytest.approx(one.cell.lever, abs=1e-6)
        assert cell.limit == pytest.approx(one.cell.limit, abs=1e-4)
        for band, wanted in zip(cell.bands, one.cell.bands, strict=True):
            assert band.d == pytest.approx(wanted.d, abs=1e-6)
    assert str(sw.Chain(again).cycle().sequence) == str(chain.cycle().sequence)
