"""The table of how surely chains make any cycle is that of its file, and the file of the search."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from facts import refuses
from sizes import examples
from stepwell.paper import any_cycle
from stepwell.sequences import Sequence

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "any-cycle.md"
ROWS = json.loads((ROOT / "docs" / "any-cycle.json").read_text("utf-8"))


def test_the_page_shows_what_the_file_holds():
    page = PAGE.read_text("utf-8")
    assert f"{any_cycle.BEGIN}\n\n{any_cycle.table(ROWS)}\n\n{any_cycle.END}" in page


def test_all_cycles_of_six_cells_are_looked_at_once_each():
    row = ROWS[0]
    assert row["cells"] == 6 and len(row["fractions"]) == math.factorial(6)
    assert len({any_cycle.cycle_of(6, k) for k in range(720)}) == 720
    # The one that goes back the way it came is that of the claims.
    back = [k for k in range(720) if _goes_back(any_cycle.cycle_of(6, k))]
    assert len(back) == 1
    assert row["fractions"][back[0]] >= any_cycle.WANTED


def _goes_back(text: str) -> bool:
    orders = Sequence.parse(text).orders
    assert orders is not None
    return orders[0] == orders[1][::-1]


@pytest.mark.slow
@pytest.mark.shown
def test_shares_in_the_file_are_those_of_designs_made_now():
    rng = np.random.default_rng(0)
    for row, (anchor, cells) in zip(ROWS, any_cycle.LENGTHS, strict=True):
        assert (row["anchor_mm"], row["cells"]) == (anchor * 1e3, cells)
        some = [int(np.argmin(row["fractions"]))] if cells == 6 else []
        known = len(row["fractions"])
        some += rng.permutation(known)[: examples(1)].tolist()
        for number in some:
            assert any_cycle.fraction(anchor, cells, number) == pytest.approx(
                row["fractions"][number], abs=0.002
            )


def test_a_table_calls_a_sample_a_sample(tmp_path):
    rows = [
        {"anchor_mm": 1.0, "cells": 3, "fractions": [1.0, 0.9, 0.99, 0.98, 1.0, 0.97]},
        {"anchor_mm": 0.3, "cells": 10, "fractions": [0.5, 0.25]},
    ]
    text = any_cycle.table(rows).splitlines()
    assert text[2] == "| ±1 mm | 3 | all 6 | 100.0 % | 98.5 % | 90.0 % | 3 of 6 |"
    assert text[3] == "| ±0.3 mm | 10 | a sample of 2 | 50.0 % | 37.5 % | 25.0 % | 0 of 2 |"


def test_what_a_file_holds_is_kept_and_the_rest_added(tmp_path, monkeypatch):
    monkeypatch.setattr(any_cycle, "LENGTHS", ((0.001, 2),))
    monkeypatch.setattr(any_cycle, "MADE", 100)
    file, page = tmp_path / "any.json", tmp_path / "page.md"
    file.write_text(json.dumps([{"anchor_mm": 1.0, "cells": 2, "fractions": [0.125]}]))
    page.write_text(f"{any_cycle.BEGIN}\n{any_cycle.END}\n")
    any_cycle.main(file, [page])
    (row,) = json.loads(file.read_text())
    assert row["fractions"][0] == 0.125 and len(row["fractions"]) == 2
    assert "| all 2 |" in page.read_text()
    page.write_text("a page")
    with refuses(ValueError, "no place", "table"):
        any_cycle.main(file, [page])
