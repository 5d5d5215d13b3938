"""The pages about jumps and rates: their tables and figures are of their records, which hold."""

import re

import numpy as np
import pytest

import docs.jump_scaling as scaling
import docs.rates as rates
import docs.snap_cells as cells
from docs.pages import ROOT, run
from hoppers import jumped

PAGES = (scaling, rates, cells)


def words(page: str) -> str:
    return " ".join((ROOT / "docs" / page).read_text("utf-8").split())


@pytest.mark.parametrize("made", PAGES, ids=lambda made: made.__name__.rpartition(".")[2])
def test_tables_are_those_of_their_records(made):
    text = made.PAGE.read_text("utf-8")
    assert text == made.written(text), f"run `python {made.__name__.replace('.', '/')}.py`"


@pytest.mark.parametrize("made", [scaling, rates])
def test_figures_are_those_of_their_records(made):
    assert made.PICTURE.read_text("utf-8") == made.drawn()


def test_points_and_curves_are_of_the_model_today():
    found = scaling.record()
    for point in found["points"][::4]:
        one = scaling.changed(point["varied"], point["times"], point["springs"])
        bound, model = scaling.heights(one)
        made = 1e3 * scaling.limit(one), 1e3 * bound, 1e3 * model
        was = [point[f"{name}_mm"] for name in ("limit", "bound", "model")]
        assert made == pytest.approx(was, rel=1e-6)
    for what, rows in found["curves"].items():
        by, *heights = rows[len(rows) // 3]
        one = scaling.changed(what, by)
        made = [1e3 * scaling.limit(one), *(1e3 * height for height in scaling.heights(one))]
        assert heights[:3] == pytest.approx(made, rel=1e-4)


def test_simulated_points_are_below_the_bound_and_near_the_model():
    points = scaling.record()["points"]
    for point in points:
        assert point["height_mm"] < point["bound_mm"] < point["limit_mm"]
        assert point["height_mm"] == pytest.approx(point["model_mm"], rel=0.025)
        assert point["balance"] < 0.01
    (same,) = (p for p in points if (p["varied"], p["times"], p["springs"]) == ("mass", 1, "steel"))
    assert same["height_mm"] == pytest.approx(1e3 * jumped().first.height, rel=1e-6)


def test_the_numbers_of_the_page_of_scaling_are_those_of_its_record():
    found = scaling.record()
    heights = {(p["varied"], p["times"], p["springs"]): p["height_mm"] for p in found["points"]}
    own = heights["mass", 1.0, "steel"]
    curves = {what: np.array(rows) for what, rows in found["curves"].items()}
    share = {what: rows[:, 3] / rows[:, 2] for what, rows in curves.items() if what != "mass"}
    light, size = curves["mass"][0], curves["size"][-1]
    facts = (
        f"{heights['mass', 0.25, 'steel'] / own:.1f} times the height",
        f"{heights['stiffness', 4.0, 'steel'] / own:.1f} times. At 30",
        f"{light[3] / light[2]:.0%}".replace("%", " %") + " of the bound at a tenth",
        f"{share['stiffness'][-1]:.0%}".replace("%", " %") + " at ten times the stiffness",
        f"leaves {heights['mass', 1.0, 'rubber'] / own:.0%}".replace("%", " %"),
        f"{size[4] / size[3]:.0%}".replace("%", " %") + " at ten times the size",
    )
    text = words("jump-scaling.md")
    assert [fact for fact in facts if fact not in text] == []
    assert curves["mass"][-1, 0] == 30.0 and curves["mass"][-1, 2] == 0.0


def test_the_rates_of_the_page_hold_for_the_pair_today():
    found, path = rates.record(), rates.pair()
    (at,) = (row for row in found["motions"] if row["rate_Hz"] == 1.0)
    assert rates.motion(path, 1.0) == at
    below, above = (rates.motion(path, by * found["critical_Hz"]) for by in (0.95, 1.0))
    assert below["keeps_order"] and not above["keeps_order"]
    assert path.safe_rate().rate == pytest.approx(found["safe_rate_Hz"])
    assert f"| {found['critical_Hz'] / found['safe_rate_Hz']:.1f} |" in words("rates.md")
    late = {row["rate_Hz"]: row["snaps_mm"][0] - found["snaps_mm"][0] for row in found["motions"]}
    assert max(delay for rate, delay in late.items() if rate <= 0.0316) <= 0.1
    assert max(late.values()) == pytest.approx(1.4, abs=0.05)


def test_the_page_of_jumps_prints_what_it_shows_where_nothing_is_simulated(tmp_path, monkeypatch):
    # The whole page is run with STEPWELL_TESTS=full.
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs/how-to/jump.md").read_text("utf-8")
    blocks = re.findall(r"^```python\n.*?^```$|<!-- = .*? -->", text, re.M | re.S)
    kept = text
    for block in blocks:
        if "simulation.jump(" in block or "jump.factors" in block:
            kept = kept.replace(block, "")
    assert run("jump.md", kept) >= 8


def test_the_best_chains_have_their_cells_and_stay_below_the_proved_bound():
    # The energies of the table are computed from these anchors.
    shown = re.findall(
        r"^\| (\d) \| \d+ \| (\d\.\d\d) \| (\d+)% \|$", cells.PAGE.read_text("utf-8"), re.M
    )
    found = cells.record()
    assert [int(count) for count, *_ in shown] == [row["cells"] for row in found]
    assert all(len(row["d_mm"]) == row["cells"] for row in found)
    assert all(int(share) <= 100 for *_, share in shown)
    # A search from the best pair, and hardly better than it.
    assert float(shown[0][1]) <= max(float(ratio) for _, ratio, _ in shown) < 1.7
