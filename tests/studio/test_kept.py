"""Answers to a drag reuse numbers of earlier ones, and no number depends on the history."""

import json
import random
import subprocess
import sys
import zlib
from copy import deepcopy
from typing import Any

import numpy as np

from chains import any_chain
from facts import refuses
from stepwell.base import InputError
from stepwell.files import preset_text, tables_in
from stepwell.mechanism.levers import Levers
from stepwell.studio.aside import answered
from stepwell.studio.message import Message, unpacked
from studio.pages import long_chain

# Answers every design of its input in a process that has answered nothing before.
FRESH = """
import json, sys, zlib
from stepwell.studio.aside import answered
from stepwell.studio.message import Message, unpacked
for seq, design in json.load(sys.stdin):
    print(zlib.crc32(answered(Message("evaluate", seq, design))))
"""


EDITS = "move", "move", "move", "copy", "remove", "swap"


def edited(design: dict[str, Any], source: random.Random, kinds: Any = EDITS) -> dict[str, Any]:
    """The design with one cell moved, copied or removed, or two cells in another order."""
    design = deepcopy(design)
    cells = design["chain"]["cell"]
    at = source.randrange(len(cells))
    kind = source.choice(kinds)
    if kind == "move" and "q_mm" in cells[at]:
        cells[at]["q_mm"] = [mm + round(source.uniform(-1, 1), 3) for mm in cells[at]["q_mm"]]
    elif kind == "copy" and len(cells) < 7:
        cells.insert(at, deepcopy(cells[at]) | {"name": f"copy {source.random()}"})
    elif kind == "remove" and len(cells) > 2:
        del cells[at]
    else:
        cells[0], cells[at] = cells[at], cells[0]
    return design


def test_answers_after_random_edits_are_those_of_a_fresh_process_in_reverse_order():
    source = random.Random(36)
    designs: list[dict[str, Any]] = []
    for name in ("metachronal-wave", "finger-selector", "kresling"):
        design = tables_in(preset_text(name), name)
        if "chain" not in design:
            continue
        for _ in range(12):
            designs.append(design)
            design = edited(design, source)
    asked = list(enumerate(designs))
    own = [zlib.crc32(answered(Message("evaluate", seq, design))) for seq, design in asked]
    done = subprocess.run(
        [sys.executable, "-c", FRESH],
        input=json.dumps(asked[::-1]),
        capture_output=True,
        text=True,
        check=True,
    )
    assert [int(line) for line in done.stdout.split()][::-1] == own
    assert len(set(own)) > 20


def evaluated(design: dict[str, Any], **ask: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Header and arrays of an answer, without what describes its bytes."""
    header, blocks = unpacked(answered(Message("evaluate", 1, design, ask)))
    assert header["ok"], header
    return {key: value for key, value in header.items() if key != "blocks"}, blocks


def test_a_move_of_some_cells_completes_the_view_before_to_the_answer_for_all_cells():
    source, drags = random.Random(12), 0
    designs = [tables_in(preset_text(name), name) for name in ("finger-selector", "three-wave")]
    for design in (*designs, long_chain(20)):
        begin = design["chain"]["cell"]
        header, _ = evaluated(design)
        cells, layout = header["cells"], header["layout"]
        for _ in range(8):
            design = edited(design, source, ["move"])
            both = enumerate(zip(begin, design["chain"]["cell"], strict=True))
            moved = [i for i, (old, new) in both if old != new]
            whole, wanted = evaluated(design, moves=True)
            k = source.randrange(len(wanted["drive"]))
            cursor = {"drive": float(wanted["drive"][k]), "direction": int(wanted["direction"][k])}
            part, blocks = evaluated(design, moves=True, cells=moved, **cursor)
            for i, cell in zip(moved, part["cells"], strict=True):
                cells[i] = cell
            assert {"layout": layout, **part, "cells": cells} == whole
            for key in ("landscape_travel", "landscape_energy"):
                np.testing.assert_array_equal(blocks.pop(key), wanted.pop(key)[:, moved])
            # The first sample at this drive, as the page chooses it.
            same = (wanted["drive"] == wanted["drive"][k]) & (
                wanted["direction"] == wanted["direction"][k]
            )
            now = wanted.pop("tension")[np.flatnonzero(same)[0]]
            np.testing.assert_array_equal(blocks.pop("tension_now"), now)
            np.testing.assert_equal(blocks, wanted)
            drags += 1
    assert drags == 24


def test_cells_that_a_chain_does_not_have_are_refused_with_what_is_allowed():
    design = long_chain(3)
    for cells in ([], [3], [-1], [0.5], [True], "0", [0, 1, 2, 0], None):
        ask = {"moves": True, "cells": cells}
        header, _ = unpacked(answered(Message("evaluate", 1, design, ask)))
        assert not header["ok"] and "ask.cells = " in header["problems"][0]["text"], cells
    for bad in ({"drive": 1.0}, {"drive": 1e9, "direction": 1}, {"drive": 1.0, "direction": 2}):
        header, _ = unpacked(answered(Message("evaluate", 1, design, {"moves": True, **bad})))
        assert not header["ok"] and header["problems"][0]["text"].startswith("ask."), bad


def test_the_lever_cells_of_a_chain_have_together_the_numbers_of_each_alone():
    source = np.random.default_rng(36)
    for _ in range(20):
        chain = any_chain(source, 4)
        travel = source.uniform(0.0, chain.full_travels, (50, 4))
        levers = Levers(chain.cells, travel)
        angle = [cell.angle(s) for cell, s in zip(chain.levers, travel.T, strict=True)]
        energy = [cell.energy_at(s) for cell, s in zip(chain.cells, travel.T, strict=True)]
        bands = [
            (band, band.length(theta, cell.lever))
            for cell, theta in zip(chain.levers, angle, strict=True)
            for band in cell.bands
        ]
        tension = [band.tension(length) for band, length in bands]
        slack = [(length <= band.rest_length) & (not band.two_sided) for band, length in bands]
        np.testing.assert_allclose(levers.angle, np.transpose(angle), rtol=1e-14)
        largest = np.max(np.abs(energy))
        np.testing.assert_allclose(levers.energy(), np.transpose(energy), atol=1e-14 * largest)
        largest = np.max(np.abs(tension))
        np.testing.assert_allclose(levers.tension(), np.transpose(tension), atol=1e-14 * largest)
        assert np.array_equal(levers.slack, np.transpose(slack))


def test_a_travel_past_a_stop_is_refused_with_the_text_of_its_cell():
    chain = any_chain(np.random.default_rng(1), 3)
    travel = np.array([chain.full_travels])
    travel[0, 1] *= 1.01
    with refuses(InputError, "between 0 and"):
        Levers(chain.cells, travel)
