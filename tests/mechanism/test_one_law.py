"""One definition of each formula: changed there, every engine, certificate and fit follows."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import stepwell
from mechanism.routes import ROUTES, answer

PACKAGE = Path(stepwell.__file__).parent
TESTS = Path(__file__).resolve().parents[1]
# Bands that hang 3 mm off the plane of the levers: ℓ² is larger by a constant. All that is derived
# from ℓ stays true, proofs included, so nothing but the numbers changes.
OFF_PLANE = {
    "mechanism/geometry.py": {
        "return np.sqrt(x * x + y * y + 1e-30)": "return np.sqrt(x * x + y * y + 9e-6)",
        "(length * length - lever": "(length * length - 9e-6 - lever",
    }
}
# All forces along travel are 1.25 times as large, and so are the energies that they are slopes of.
STRONGER = {
    "mechanism/geometry.py": {
        "return tension * first": "return 1.25 * tension * first",
        "return tension * extension": "return 1.25 * tension * extension",
    }
}
# What else only the law may write: a length from its two sides, g, and travel from a sine.
TELL_TALES = [
    r"(?:lever|\br) \* (?:np\.|math\.)?(?:cos|sin|c|t)\b[^,]* \+ [^,]*d",
    r"\bdx \* (?:.* / \(?c(?:os)?\b|(?:np|math)\.tan)",
    r"travel\w* / [\w.]*(?:lever|\br\b)",
    r"(?:lever|\br) \* \([^()]*sin[^()]* \+ ",
]
# Each of these has one of: what has none need not be parsed.
NAMED = r"lever|\br\b|\bdx\b"


@pytest.fixture(scope="module")
def numbers(tmp_path_factory):
    """What every route says under the law as it is, and under two others."""
    running = {}
    for name, changes in {"off plane": OFF_PLANE, "stronger": STRONGER}.items():
        place = tmp_path_factory.mktemp(name.replace(" ", "_"))
        # With what Python has compiled of the files that stay as they are.
        shutil.copytree(PACKAGE, place / "stepwell")
        for file, lines in changes.items():
            text = (place / "stepwell" / file).read_text("utf-8")
            for old, new in lines.items():
                assert text.count(old) == 1, old
                text = text.replace(old, new)
            (place / "stepwell" / file).write_text(text, "utf-8")
        paths = os.pathsep.join([str(place), str(TESTS)])
        running[name] = subprocess.Popen(
            [sys.executable, "-m", "mechanism.routes"], stdout=subprocess.PIPE, text=True,
            cwd=place, env={**os.environ, "PYTHONPATH": paths, "STEPWELL_KERNELS": "interpreted"},
        )  # fmt: skip
    answers = {"true": {name: answer(way) for name, (_, way) in ROUTES.items()}}
    for name, process in running.items():
        text, _ = process.communicate()
        assert process.returncode == 0
        answers[name] = json.loads(text)
    return answers


def of(numbers, law: str, route: str) -> np.ndarray:
    values = numbers[law][route]
    assert not isinstance(values, str), values
    return np.array(values)


@pytest.mark.slow
@pytest.mark.parametrize("route", ROUTES)
def test_every_route_follows_the_length_of_a_band(numbers, route):
    before, after = of(numbers, "true", route), of(numbers, "off plane", route)
    assert len(before) > 0 and np.all(np.isfinite(before))
    assert before.shape == after.shape
    assert np.all(np.abs(after - before) > 1e-7 * np.abs(before).max())


@pytest.mark.slow
@pytest.mark.parametrize("route", ROUTES)
def test_every_route_follows_the_force_along_travel(numbers, route):
    power, _ = ROUTES[route]
    before, after = of(numbers, "true", route), of(numbers, "stronger", route)
    if power is None:
        assert np.all(np.abs(after - before) > 1e-3 * np.abs(before).max())
    else:
        assert after == pytest.approx(before * 1.25**power, rel=1e-7, abs=1e-12)


@pytest.mark.slow
def test_routes_that_ask_the_same_say_the_same_under_another_law(numbers):
    for law in numbers:
        ends = of(numbers, law, "end forces in closed form, and their slopes by anchor")[:2]
        fields = of(numbers, law, "fields of the graph of relays")
        assert np.min(np.abs(fields[:, None] - ends), axis=0) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
def test_no_other_file_writes_the_formulas_of_a_band_again():
    elsewhere = []
    for file in sorted(PACKAGE.rglob("*.py")):
        name = file.relative_to(PACKAGE)
        # What draws a lever, builds one in another program, checks a paper's own equations or
        # proves the engine's numbers is no second home.
        if name.parts[0] in ("figures", "simulation", "paper", "proof"):
            continue
        text = file.read_text("utf-8")
        if not re.search(NAMED, text):
            continue
        # Without its comments.
        for line in ast.unparse(ast.parse(text)).splitlines():
            if any(re.search(tell_tale, line) for tell_tale in TELL_TALES):
                elsewhere.append(f"{name}: {line.strip()}")
    assert [line for line in elsewhere if not line.startswith("mechanism/geometry.py")] == []
    assert len(elsewhere) >= 4
