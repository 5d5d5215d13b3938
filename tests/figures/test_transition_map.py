"""The transition map: regions named, boundaries exact, designs in their place."""

import numpy as np
import pytest

from figures.drawn import legend_of, lines, points, says, untidy
from stepwell import figures, files
from stepwell.design import boundaries, transition_map

X = np.linspace(0.0, 0.020, 41)
Y = np.linspace(-0.015, 0.015, 61)
DESIGNS = {"forward": (0.020, 0.0), "backward": (0.005, 0.0)}


@pytest.fixture(scope="module")
def found():
    chain = files.preset("paper-forward")
    return transition_map(chain, 1, x=X, y=Y), boundaries(chain, 1, x=X, y=Y)


def test_each_pathway_is_named_in_its_region(found):
    figure = figures.transition_map(found[0], found[1], DESIGNS)
    said = says(figure)
    for name in ("clockwise", "via 01", "via 10"):
        assert said.count(name) == 1
    assert said.count("counterclockwise") + said.count("counter-\nclockwise") == 1

    dataset, _ = found
    codes = dict(
        zip(str(dataset.pathway.flag_meanings).split(), dataset.pathway.flag_values, strict=True)
    )
    ax = figure.axes[0]
    for text in ax.texts:
        name = text.get_text().replace("-\n", "").replace(" ", "_")
        if name in codes:
            x, y = text.get_position()
            here = dataset.pathway.sel(x=x * 1e-3, y=y * 1e-3, method="nearest")
            assert int(here) == codes[name]


def test_axes_are_the_anchor_in_millimetres_at_equal_scale(found):
    (ax,) = figures.transition_map(*found).axes
    assert ax.get_xlabel() == "$q_x$ of outer [mm]"
    assert ax.get_ylabel() == "$q_y$ of outer [mm]"
    assert ax.get_aspect() == 1.0
    assert (*ax.get_xlim(), *ax.get_ylim()) == pytest.approx((0, 20, -15, 15))


def test_boundaries_are_the_exact_curves(found):
    dataset, curves = found
    figure = figures.transition_map(dataset, curves)
    drawn = lines(figure, "boundary") + lines(figure, "stability edge")
    assert len(drawn) == len(curves) == 4
    lengths = sorted(len(points(line)) for line in drawn)
    assert lengths == sorted(len(curve.points) for curve in curves)
    assert len(lines(figure, "stability edge")) == 2


def test_designs_stand_at_their_anchor(found):
    figure = figures.transition_map(found[0], found[1], DESIGNS)
    drawn = np.concatenate([points(line) for line in lines(figure, "design")])
    assert drawn == pytest.approx(np.array([(20.0, 0.0), (5.0, 0.0)]))
    assert {"forward", "backward"} <= set(says(figure))


def test_monostable_ground_is_hatched_and_explained(found):
    figure = figures.transition_map(*found)
    found_hatches = [getattr(c, "hatches", [None])[0] for c in figure.axes[0].collections]
    assert any(found_hatches)
    assert "outer monostable" in legend_of(figure)
    bistable = figures.transition_map(found[0].sel(y=slice(-0.004, 0.004)))
    assert legend_of(bistable) == []


def test_words_stay_apart(found):
    for designs in (
        {},
        DESIGNS,
        {"right on the crossing": (0.010, 0.0), "in a corner": (0.0, -0.015)},
    ):
        figure = figures.transition_map(found[0], found[1], designs)
        assert untidy(figure) == []


def test_a_pathway_without_room_for_its_name_is_in_the_key(found):
    dataset = found[0].copy(deep=True)
    codes = dict(
        zip(str(dataset.pathway.flag_meanings).split(), dataset.pathway.flag_values, strict=True)
    )
    dataset.pathway[30, 20] = codes["other"]
    assert "other pathway" in legend_of(figures.transition_map(dataset))


def test_impossible_places_stay_white(found):
    dataset = found[0].copy(deep=True)
    dataset.pathway[:, :20] = -1
    mesh = figures.transition_map(dataset).axes[0].collections[0]
    shown = np.ma.asarray(mesh.get_array()).reshape(61, 41)
    assert np.ma.getmaskarray(shown)[:, :20].all()
    assert not np.ma.getmaskarray(shown)[:, 20:].any()
