"""Whatever a table holds, `lab band` gives a band or one line that says why not."""

import numpy as np
import pytest
from typer.testing import CliRunner

from sizes import examples
from stepwell import lab
from stepwell.accounts import account
from stepwell.base import InputError
from stepwell.cli import app

SEVEN = "length (mm),weight (g)\n62,0\n66.5,20\n71,40\n77,60\n84.5,80\n91.5,100\n96.5,120\n"
ROWS = SEVEN.splitlines()


def banded(text: str) -> str:
    """The table for a design file, or the line that says why there is none."""
    try:
        test = lab.band_test([lab.read_bytes(text.encode(), "pull.csv")])
        return account(lab.fit_bands(test, lab.choose_law(test))).record["table"]
    except InputError as error:
        return str(error)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("length (mm),weight (g)\n", "holds no row of two or more numbers"),
        ("\n\n\n", "is empty"),
        ("length (mm),weight (g)\n62,0\n", "holds 1 row of numbers"),
        ("length (mm),weight (g)\n62,0\n62,0\n62,0\n", "no loading half at all"),
        ("length (mm),weight (g)\n62,0\n62,20\n62,40\n", "no loading half at all"),
        ("length (mm),weight (g)\n62,50\n70,50\n80,50\n", "changes by 0 N/m of stroke"),
        ("length (mm),weight (g)\n62,0\n70,0\n80,0\n", "changes by 0 N/m of stroke"),
        ("length (mm),weight (g)\n62,0\n70,-20\n80,-50\n", "check the sign"),
        ("length (mm),weight (g)\n62,0\n70,20\n", "fewer than 2 readings"),
        ("length (mm),weight (g)\n" + "nan,nan\n" * 5, "holds no row of two or more numbers"),
        ("length (mm),weight (g)\n1e400,2\n1e400,3\n", "'length' [mm] holds no numbers"),
    ],
)
def test_a_table_without_a_band_gets_one_line(text, problem, tmp_path):
    told = banded(text)
    assert problem in told.replace("Check", "check")
    assert "\n" not in told
    file = tmp_path / "pull.csv"
    file.write_text(text, "utf-8")
    found = CliRunner().invoke(app, ["lab", "band", str(file)], prog_name="stepwell")
    assert found.exit_code == 2
    assert isinstance(found.exception, SystemExit)
    assert "Traceback" not in found.output and found.stdout == ""


@pytest.mark.slow
def test_swapped_columns_text_in_a_cell_empty_lines_and_nan_give_a_band_or_a_line():
    swapped = "weight (g),length (mm)\n" + "\n".join(ROWS[1:])
    assert banded(swapped)
    spaced = "\n\n".join(ROWS)
    assert "7 readings" in banded(spaced) or "band = {" in banded(spaced)
    for cell in ("nan", "about 90", "", "-", "inf"):
        left = banded(SEVEN.replace("91.5", cell))
        assert "band = {" in left, left
        found = lab.band_test([lab.read_bytes(SEVEN.replace("91.5", cell).encode(), "pull.csv")])
        assert any("1 row" in line and "left out" in line for line in found.notes), cell


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(examples(40)))
def test_no_change_to_a_table_makes_a_traceback(seed):
    rng = np.random.default_rng(seed)
    text = list(SEVEN)
    alphabet = '0123456789.,;-eE \t\n"abgmN()nan'
    for _ in range(rng.integers(1, 8)):
        at = int(rng.integers(len(text)))
        what = alphabet[rng.integers(len(alphabet))]
        (text.insert, text.__setitem__)[rng.integers(2)](at, what)
    if rng.random() < 0.3:
        rows = "".join(text).splitlines()
        rng.shuffle(rows)
        text = list("\n".join(rows))
    told = banded("".join(text))
    assert "band = {" in told or "\n" not in told, told


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(examples(15)))
def test_any_numbers_in_a_table_give_a_band_or_a_line(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 12))
    size = 10.0 ** rng.integers(-6, 7, 2)
    rows = np.round(rng.normal(0.0, 1.0, (n, 2)) * size, int(rng.integers(0, 6)))
    told = banded("length (mm),weight (g)\n" + "".join(f"{a!r},{b!r}\n" for a, b in rows.tolist()))
    assert "band = {" in told or "\n" not in told, told


@pytest.mark.slow
def test_a_million_rows_are_read_like_seven():
    up = np.linspace(0.0, 0.040, 1000)
    rows = (f"{1e3 * u:.4f},{30 * u + 0.1:.4f}\n" * 1000 for u in up)
    test = lab.band_test([lab.read_bytes(f"stroke_mm,force_N\n{''.join(rows)}".encode(), "a.csv")])
    assert lab.stiffness(test).value == pytest.approx(30.0, rel=1e-4)
    assert lab.choose_law(test).chosen.law.name == "linear"
