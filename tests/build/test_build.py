"""Promises about builds as a whole: `sw.build` of every gallery design of lever cells."""

import numpy as np
import pytest

import stepwell as sw
from build import chains
from facts import refuses, says
from stepwell.build import Build, load_build_file
from stepwell.mechanism import Cell, Chain

LEVERS = [
    name
    for name in sw.presets()
    if isinstance(design := sw.load(f"preset:{name}"), Chain)
    and all(isinstance(cell, Cell) for cell in design.cells)
]


# Bands stretched to more than 5 times their rest length, and a stroke of more than 140 mm.
BEYOND = {"lock-with-alarm": {"stretch"}, "stiffness-gripper": {"travel"}}


@pytest.mark.parametrize("name", LEVERS)
def test_every_preset_of_lever_cells_but_two_can_be_built_in_acrylic(name):
    made = sw.build(sw.load(f"preset:{name}"), samples=50)
    assert {one.check for one in made.findings} == BEYOND.get(name, set()), made.findings
    assert made.can_be_built == (name not in BEYOND)


@pytest.mark.parametrize("material", ["plywood-3mm", "pla-3mm"])
def test_the_papers_pair_can_be_built_in_every_material(material):
    made = sw.build(chains.pair(), material, samples=50)
    assert made.can_be_built, made.findings
    assert material.startswith(made.layout.parts[0].material)


def test_a_build_knows_its_masses_bands_and_yield():
    made = sw.build(chains.pair(), samples=200)
    assert isinstance(made, Build)
    assert sum(made.block_masses) < made.mass < 0.1
    # The area of the sheet that is left, by shapely.
    of_areas = sum(part.polygon().area * part.thickness * 1190.0 for part in made.layout.parts)
    assert made.mass == pytest.approx(of_areas, rel=1e-4)
    inner, outer = made.bands
    assert inner.holes == ("pD3", "qD3")
    assert outer.stretch == pytest.approx(4.414, abs=1e-3)
    assert np.allclose(inner.lengths, np.hypot(0.030, 0.010))
    assert inner.fits == (0.010,)
    assert made.yield_ is not None
    assert made.yield_.samples == 200
    assert made.yield_.target == "00>10>11>01>00"


def test_a_design_that_cannot_be_built_says_which_parts_meet_and_has_no_yield():
    made = sw.build(chains.steep(), load_build_file("acrylic-3mm"), samples=50)
    assert not made.can_be_built
    assert made.yield_ is None
    first = made.findings[0]
    assert first.check == "collision"
    says(str(first), "lever-1a", "lever-1b", "1.16 mm", "lever.width_mm = 6.8")
    assert sw.build(
        chains.steep(), made.build_file.with_lengths(**first.change), samples=50
    ).sweep.free


def test_notes_name_shifted_anchors_missing_bands_and_loads():
    made = sw.build(sw.load("preset:slack"), samples=50)
    says(made.notes, "Band 1 of cell 2", "(1, 2) mm")
    says(made.notes, "Band 1 of cell 2", "24 mm")
    says(sw.build(sw.load("preset:foot-weight"), samples=50).notes, "outer")


def test_elements_cannot_be_built():
    with refuses(ValueError, "cells[0]", "Cell"):
        sw.build(sw.load("preset:dome"))


def test_a_build_equals_the_build_of_the_same_design():
    one, other = (sw.build(chains.pair(), samples=50) for _ in range(2))
    assert one == other
    assert hash(one) == hash(other)
