"""One definition of each formula: changed there, every engine, certificate and fit follows."""

import ast
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import stepwell
from mechanism.routes import ROUTES

PACKAGE = Path(stepwell.__file__).parent
TESTS = Path(__file__).resolve().parents[1]
LAW = Path("mechanism", "geometry.py")

# Bands that hang 3 mm off the plane of the levers: ℓ² is larger by a constant. All that is derived
# from ℓ stays true, proofs included, so nothing but the numbers changes.
OFF_PLANE = {
    "return np.sqrt(x * x + y * y)": "return np.sqrt(x * x + y * y + 9e-6)",
    "(length * length - lever": "(length * length - 9e-6 - lever",
}
# All forces along travel are 1.25 times as large.
STRONGER = {
    "return tension * first": "return 1.25 * tension * first",
    "return t1 * by * first + t0 * first_by": "return 1.25 * (t1 * by * first + t0 * first_by)",
    "t2 * first * first * first + 3.0 * t1 * first * second + t0 * third": (
        "1.25 * (t2 * first * first * first + 3.0 * t1 * first * second + t0 * third)"
    ),
}


@pytest.fixture(scope="module")
def numbers(tmp_path_factory):
    """What every route says under the law as it is, and under two others."""
    running = {}
    for name, changes in {"true": {}, "off plane": OFF_PLANE, "stronger": STRONGER}.items():
        place = tmp_path_factory.mktemp(name.replace(" ", "_"))
        # With what Python has compiled of the files that stay as they are.
        shutil.copytree(PACKAGE, place / "stepwell")
        text = (place / "stepwell" / LAW).read_text("utf-8")
        for old, new in changes.items():
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        (place / "stepwell" / LAW).write_text(text, "utf-8")
        paths = os.pathsep.join([str(place), str(TESTS)])
        running[name] = subprocess.Popen(
            [sys.executable, "-m", "mechanism.routes"], stdout=subprocess.PIPE, text=True,
            cwd=place, env={**os.environ, "PYTHONPATH": paths, "STEPWELL_KERNELS": "interpreted"},
        )  # fmt: skip
    told = {name: process.communicate()[0] for name, process in running.items()}
    assert [process.returncode for process in running.values()] == [0, 0, 0]
    return {
        name: {route: np.array(values) for route, values in json.loads(text).items()}
        for name, text in told.items()
    }


@pytest.mark.parametrize("route", ROUTES)
def test_every_route_follows_the_length_of_a_band(numbers, route):
    before, after = numbers["true"][route], numbers["off plane"][route]
    assert len(before) > 0 and np.all(np.isfinite(before))
    assert before.shape == after.shape
    # A length that is 5 % longer moves them all by far more than rounding.
    assert np.all(np.abs(after - before) > 1e-5 * np.abs(before).max())


@pytest.mark.parametrize("route", ROUTES)
def test_every_route_follows_the_force_along_travel(numbers, route):
    power, _ = ROUTES[route]
    before, after = numbers["true"][route], numbers["stronger"][route]
    if power is None:
        assert np.all(np.abs(after - before) > 1e-3 * np.abs(before).max())
    else:
        assert after == pytest.approx(before * 1.25**power, rel=1e-7, abs=1e-12)


def test_routes_that_ask_the_same_say_the_same_under_another_law(numbers):
    for told in numbers.values():
        ends = told["end forces in closed form, and their slopes by anchor"][:2]
        fields = told["fields of the graph of relays"]
        assert np.min(np.abs(fields[:, None] - ends), axis=0) == pytest.approx(0.0, abs=1e-12)


def test_no_other_file_writes_the_formulas_of_a_band_again():
    # The tell-tales: a length from two sums, a tangent or a sine over a cosine times d_x, and a
    # travel over a lever. Drawing, simulation and a paper's own equations are no second home.
    found = []
    for file in sorted(PACKAGE.rglob("*.py")):
        room = file.relative_to(PACKAGE).parts[0]
        if file == PACKAGE / LAW or room in ("figures", "simulation", "paper", "kernels"):
            continue
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if _tells(node):
                found.append(f"{file.relative_to(PACKAGE)}:{node.lineno}: {ast.unparse(node)}")
    assert found == []


def _tells(node: ast.AST) -> bool:
    if not isinstance(node, ast.BinOp):
        return False
    text = ast.unparse(node)
    if isinstance(node.op, ast.Div):
        return "travel" in ast.unparse(node.left) and "lever" in ast.unparse(node.right)
    turned = any(word in text for word in ("cos", "sin", "tan"))
    lever = any(word in ast.unparse(node.left) for word in ("lever", "r *"))
    anchor = "dx" in text or "d[" in text
    return isinstance(node.op, (ast.Add, ast.Sub)) and turned and (lever or anchor) and anchor
