"""Several cycles on one page: each is there, under its name, and everything can be read."""

import pytest

from figures.drawn import marks, says, untidy
from stepwell import figures, files

NAMES = ("paper-forward", "paper-via-01", "slack", "rubber")


@pytest.fixture(scope="module")
def cycles():
    return {name: files.preset(name).cycle() for name in NAMES}


@pytest.mark.slow
@pytest.mark.parametrize(("draw", "panels"), [(figures.landscapes, 4), (figures.strokes, 8)])
@pytest.mark.parametrize("count", [1, 4])
def test_every_cycle_has_its_panels_and_its_name(draw, panels, count, cycles):
    shown = dict(list(cycles.items())[:count])
    figure = draw(shown)
    assert len(figure.axes) == panels * count / 4
    assert set(shown) <= set(says(figure))
    assert untidy(figure) == []


def test_snaps_of_all_panels_are_marked(cycles):
    snaps = sum(len(cycle.snaps) for cycle in cycles.values())
    assert snaps > 0
    assert marks(figures.landscapes(cycles), "snap starts") == snaps


@pytest.mark.parametrize("draw", [figures.landscapes, figures.strokes])
def test_nothing_to_show_is_refused(draw):
    with pytest.raises(ValueError, match="cycles is empty"):
        draw({})
