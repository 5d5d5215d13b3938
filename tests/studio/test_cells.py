"""Which numbers a cell may hold is what its design file is read by; its curve is the engine's."""

import json
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from stepwell.files import DesignError, loads_tables, preset_text, presets, tables_in
from stepwell.files.known import known_keys, new_cells
from stepwell.mechanism import LIBRARY, Element
from stepwell.studio.aside import answered
from stepwell.studio.message import Message, unpacked


def ask(kind: str, design: Any, leg: int = 0) -> Any:
    design = json.loads(json.dumps(design))
    return unpacked(answered(Message(kind, 1, design, {}, leg)))


def tables(name: str) -> dict[str, Any]:
    return tables_in(preset_text(name))


def with_value(table: Any, path: list[Any], value: Any) -> Any:
    step, *rest = path
    inner = table[step] if isinstance(table, list) else table.get(step, {})
    new = with_value(inner, rest, value) if rest else value
    if isinstance(table, list):
        return [new if k == step else one for k, one in enumerate(table)]
    return {**table, step: new}


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in presets() if not name.startswith("robot-")])
def test_a_key_at_its_default_says_what_leaving_it_out_says(name: str):
    design = tables(name)
    header, _ = ask("cells", design)
    every = header["chain"] + [key for cell in header["cells"] for key in cell]
    chain = design["chain"]
    for key in every:
        given: Any = chain
        for step in key["path"]:
            given = given[step] if isinstance(given, list) else given.get(step, {})
        if given == {} and key["default"] is not None:
            chain = with_value(chain, key["path"], key["default"])
    mine = loads_tables({**design, "chain": chain}).chain
    assert str(mine.cycle()) == str(sw.preset(name).cycle())


def test_a_number_past_the_bounds_that_are_reported_is_refused():
    design = tables("paper-forward")
    header, _ = ask("cells", design)
    bounded = [key for key in header["chain"] + header["cells"][1] if key["bounds"]]
    assert len(bounded) > 10
    for key in bounded:
        most = key["bounds"][1]
        chain = with_value(design["chain"], key["path"], 1.001 * most)
        with pytest.raises(DesignError):
            loads_tables({**design, "chain": chain})


def test_a_default_is_what_the_chain_says_and_else_the_papers():
    cells = known_keys(tables("rubber")["chain"])[1]
    stiffness = next(key for key in cells[0] if key.path[-1] == "stiffness_N_per_m")
    assert (stiffness.default, stiffness.units) == (70.7, ("N/m",))
    leg = tables("robot-left")["leg"][1]["chain"]
    common = tables("robot-left")["chain"]
    stiffness = next(
        key for key in known_keys(leg, common)[1][0] if key.path[-1] == "stiffness_N_per_m"
    )
    assert stiffness.default == 30


def test_a_refused_design_keeps_its_keys():
    design = tables("paper-forward")
    design["chain"]["cell"][0]["lever_mm"] = -3
    design["chain"]["cell"][1] = "nonsense"
    header, blocks = ask("cells", design)
    assert (header["units"], blocks) == (None, {})
    assert [len(cell) > 5 for cell in header["cells"]] == [True, True]


@pytest.mark.parametrize("design", [None, {}, {"chain": 3}, {"leg": [1]}, {"leg": 2}])
def test_what_has_no_cells_is_refused_in_words(design: Any):
    header, _ = ask("cells", design)
    assert not header["ok"]
    assert "failed on this" not in header["problems"][0]["text"]


def test_only_a_curve_by_points_has_columns():
    assert ask("cells", tables("trilinear"))[0]["columns"] == [None] * 3
    points = {"angle_deg": [0, 1, 2], "torque_mNm": [0, 1, 2]}
    design = {"chain": {"cell": [{"table": points}, {"points": {"travel_mm": [0]}}, 3]}}
    assert ask("cells", design)[0]["columns"] == [["table", "angle_deg", "torque_mNm"], None, None]


@pytest.mark.parametrize("kind", new_cells())
def test_a_cell_that_can_be_added_is_a_design(kind: str):
    loads_tables({"chain": {"cell": [new_cells()[kind]]}})


def test_every_element_of_the_library_can_be_added():
    assert {form.replace("-", " ") for form in LIBRARY} <= set(new_cells())


@pytest.mark.parametrize("name", ["von-mises-truss", "balloon", "trilinear", "paper-forward"])
def test_the_curves_of_elements_are_the_engines(name: str):
    chain = sw.preset(name)
    header, blocks = ask("cells", tables(name))
    of_travel, of_force = (1e6, 1e-3) if name == "balloon" else (1e3, 1.0)
    assert header["units"]["travel"] == ("mL" if name == "balloon" else "mm")
    elements = [i for i, cell in enumerate(chain.cells) if isinstance(cell, Element)]
    assert sorted(set(blocks["cell"])) == elements
    for i in elements:
        mine = blocks["cell"] == i
        travel = blocks["travel"][mine] / of_travel
        inside = slice(1, -1)
        np.testing.assert_allclose(
            blocks["force"][mine][inside],
            chain.cells[i].force_at(travel[inside]) * of_force,
            rtol=1e-9,
            atol=1e-9,
        )
