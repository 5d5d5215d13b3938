"""Panels of parts: shapes, checks and files are those of Python's build."""

import io
import json
import math
import zipfile
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import stepwell as sw
from build import chains
from facts import says
from stepwell.accounts import account
from stepwell.build import (
    FileOptions,
    build_files,
    layout,
    loads_build_file,
    preset_text as build_text,
)
from stepwell.files import dumps, preset_text, presets, tables_in
from stepwell.studio.aside import answered
from stepwell.studio.ask import Ask, View
from stepwell.studio.message import Message, unpacked
from studio.pages import Answer

ACRYLIC = loads_build_file(build_text("acrylic-3mm"))


def ask(kind: str, chain: sw.Chain, **keys: Any) -> Answer:
    design = json.loads(json.dumps(tables_in(dumps(chain))))
    return Answer(*unpacked(answered(Message(kind, 1, design, keys))))


def refusal(kind: str, chain: sw.Chain, **keys: Any) -> str:
    return " ".join(one["text"] for one in ask(kind, chain, **keys).header["problems"])


def test_the_shapes_are_those_of_the_layout():
    header, blocks = ask("parts", chains.slotted())
    made = layout(chains.slotted(), ACRYLIC)
    assert [one["role"] for one in header["layers"]] == ["stop", "bottom", "middle", "top"]
    assert [one["name"] for one in header["parts"]] == [part.name for part in made.parts]
    rows = iter(blocks["holes"])
    for number, (one, part) in enumerate(zip(header["parts"], made.parts, strict=True)):
        assert one["mass_g"] == pytest.approx(1e3 * part.mass(ACRYLIC.sheet.density))
        assert one["path"].count("Z") == 1 + len(part.cutouts)
        for hole in part.holes:
            x, y = hole.centre
            expected = (number, 1e3 * x, 1e3 * y, 1e3 * hole.diameter)
            np.testing.assert_allclose(next(rows), expected, atol=1e-9)
    assert next(rows, None) is None
    drawn = {one["name"] for one in header["fasteners"]}
    assert not {one.use for one in made.fasteners if one.use != "shim"} - {
        name.split()[0] for name in drawn
    }


@cache
def box(name: str) -> list[float]:
    return ask("parts", getattr(chains, name)()).header["box_mm"]


@settings(max_examples=30, deadline=None)
@given(st.sampled_from(["pair", "mixed"]), st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_the_box_holds_all_parts_at_any_angles(name: str, parts: list[float]):
    made = layout(getattr(chains, name)(), ACRYLIC)
    frames = made.frames([k * c.cell.limit for k, c in zip(parts, made.cells, strict=False)])
    left, bottom, right, top = box(name)
    for part in made.parts:
        x, y, angle = frames[part.name]
        x0, y0, x1, y1 = (1e3 * one for one in part.outline.moved(x, y, angle).bounds)
        assert min(x0 - left, y0 - bottom, right - x1, top - y1) > -1e-6


def test_the_sweep_comes_first_and_then_the_record_of_the_command():
    shown: list[View] = []
    chain = chains.pair()
    design = tables_in(dumps(chain))
    data = answered(Message("build", 1, design), Ask({}, show=shown.append))
    header, _ = unpacked(data)
    (first,) = shown
    assert first.header == {"sweep": {"free": True}, "overlaps": []}
    made = account(sw.build(chain))
    record = json.loads(json.dumps(made.record))
    for key in ("can_be_built", "parts", "bands", "findings", "sweep", "yield", "notes"):
        assert header[key] == record[key], key
    assert header["answer"] == made.answer


def test_a_collision_has_a_pose_at_which_its_parts_overlap():
    chain = chains.steep()
    header = ask("build", chain).header
    (one,) = header["overlaps"]
    assert header["can_be_built"] is False
    assert header["findings"][0]["parts"] == one["parts"] == ["lever-1a", "lever-1b"]
    made = layout(chain, ACRYLIC)
    frames = made.frames(np.radians(one["angles_deg"]))
    (ax, ay, angle), (bx, by, _) = (frames[name] for name in one["parts"])
    # The distance of two parallel levers, below their width.
    apart = abs((bx - ax) * math.sin(angle) - (by - ay) * math.cos(angle))
    assert apart < ACRYLIC.lever.width - 1e-3


def names_in(answer: Answer) -> list[str]:
    with zipfile.ZipFile(io.BytesIO(answer.blocks["file"].tobytes())) as packed:
        assert packed.testzip() is None
        return packed.namelist()


def test_the_files_are_those_of_the_command_and_drafts_need_the_word():
    chain = chains.pair()
    made = sw.build(chain, ACRYLIC)
    files = build_files(made, FileOptions(nest=0.0))
    own = {"design.toml", "build.toml", "build.json", "report.html"}
    assert {*names_in(ask("parts_files", chain, seconds=0))} == own | {*files}
    says(refusal("parts_files", chains.steep(), seconds=0), "lever-1a", "1.16 mm", "draft")
    drafts = names_in(ask("parts_files", chains.steep(), seconds=0, draft=True))
    marked = {name for name in drafts if name.rpartition("/")[2].startswith("DRAFT-")}
    assert marked and {*drafts} - marked == own


@pytest.mark.parametrize("kind", ["parts", "build", "parts_files"])
def test_elements_long_chains_and_paths_are_refused(kind: str):
    element = sw.preset("balloon")
    assert isinstance(element, sw.Chain)
    says(refusal(kind, element), "Element", "no levers")
    nine = sw.Chain([chains.cell((-10, 0), (2 * i, 0)) for i in range(1, 10)])
    says(refusal(kind, nine), "9 cells", "at most 8")
    for name in ("acrylic", "/etc/passwd"):
        says(refusal(kind, chains.pair(), material=name), name, "acrylic-3mm")


def test_the_gallery_marks_the_chains_that_have_parts():
    designs = unpacked(answered(Message("gallery", 1)))[0]["designs"]
    marked = {one["name"] for one in designs if one["parts"]}
    chosen = {name for name in presets() if not name.startswith("robot-")}
    layouts = {
        name
        for name in chosen
        if unpacked(answered(Message("parts", 1, tables_in(preset_text(name)))))[0]["ok"]
    }
    assert marked == layouts
