"""The drawings with letters: every letter measures what the cell's value says."""

import math

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from figures.drawn import Array, lines, points, says, untidy
from sizes import cases
from stepwell import figures

CELLS = {
    "the paper's": sw.Cell(sw.Band((-0.010, 0.0), (0.010, -0.015))),
    "level": sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0))),
    "upwards": sw.Cell(sw.Band((-0.010, 0.0), (0.020, 0.015))),
    "on the midpoint": sw.Cell(sw.Band((-0.010, 0.0), (0.0, 0.0))),
    "folded back": sw.Cell(sw.Band((0.005, 0.003), (-0.003, 0.012))),
    "large": sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)), lever=0.030, limit=1.2),
}


def vector(figure, gid: str) -> Array:
    """From where to where a line with this mark goes [page mm]."""
    (line,) = lines(figure, gid)
    xy = points(line)
    return xy[-1] - xy[0]


def apart(figure, gid: str, axis: int = 1) -> float:
    """How far the two feet of a dimension are apart [page mm]."""
    one, other = (points(line) for line in lines(figure, gid))
    return float(abs(other[0, axis] - one[0, axis]))


@pytest.mark.parametrize("name", CELLS)
def test_every_letter_measures_what_the_value_says(name):
    cell = CELLS[name]
    figure = figures.labelled_cell(cell)
    lever = points(lines(figure, "lever")[0])
    along = lever[1] - lever[0]
    page = np.hypot(*along) / cell.lever
    theta = math.atan2(along[1], along[0])
    (band,) = cell.bands
    assert vector(figure, "p") / page == pytest.approx(band.p)
    assert vector(figure, "q") / page == pytest.approx(band.q)
    assert vector(figure, "d") / page == pytest.approx(band.d)
    assert vector(figure, "r") / page == pytest.approx(along / page)
    assert apart(figure, "S") / page == pytest.approx(cell.full_travel)
    assert apart(figure, "s") / page == pytest.approx(float(cell.travel(theta)))
    # Both drawings have the band, as long as Eq. 2 says.
    length = float(band.length(theta, cell.lever))
    for drawn in (vector(figure, "band"), vector(figure, "l")):
        assert np.hypot(*drawn) / page == pytest.approx(length)
    stops = [points(line)[1] - points(line)[0] for line in lines(figure, "stop")]
    angles = [math.atan2(y, x) for x, y in stops]
    assert angles == pytest.approx([-cell.limit, cell.limit])
    for arc in map(points, lines(figure, "theta")):
        start = arc[0] - [arc[0, 0] - 0.0, 0.0]
        x, y = arc[-1] - start
        assert math.atan2(y, x) == pytest.approx(theta)


@pytest.mark.slow
@pytest.mark.parametrize("name", cases(CELLS, ["the paper's", "folded back", "large"]))
def test_letters_can_be_read(name):
    figure = figures.labelled_cell(CELLS[name])
    assert untidy(figure, 7.0) == []
    wide, tall = 25.4 * figure.get_size_inches()
    assert wide == pytest.approx(85.0)
    assert tall < 220.0


def test_the_drawing_of_the_pages_is_of_the_papers_cell():
    said = says(figures.labelled_cell())
    assert "$p$ = (−10, 0) mm" in said
    assert "$q$ = (10, −15) mm" in said
    assert "$d = q - p$\n= (20, −15) mm" in said
    assert "$S$ = 20 mm" in said
    assert {"state 0", "state 1", "inner block,\nheld", "outer block,\npulled"} <= set(said)


@pytest.mark.slow
@pytest.mark.parametrize(
    "preset",
    cases(
        ["paper-cell-10-0", "paper-forward", "three-wave", "four-shuffle"],
        ["paper-forward", "four-shuffle"],
    ),
)
def test_travels_add_up_to_the_stroke(preset):
    chain = sw.preset(preset)
    figure = figures.labelled_chain(chain)
    assert untidy(figure, 7.0) == []
    each = [apart(figure, f"s{i + 1}", 0) for i in range(len(chain))]
    assert sum(each) == pytest.approx(apart(figure, "u", 0))
    assert each[0] / sum(each) == pytest.approx(
        chain.full_travels[0]
        / sum(np.array(chain.full_travels) * (1.0, 0.5, 0.75, 0.5)[: len(each)])
    )
    assert {"held", "pulled"} <= set(says(figure))


@pytest.mark.slow
def test_what_has_no_letters_is_refused():
    two = sw.Band((-0.010, 0.0), (0.010, 0.0)), sw.Band((-0.010, 0.0), (0.020, 0.0))
    with pytest.raises(ValueError, match="cell has 2 bands"):
        figures.labelled_cell(sw.Cell(two))
    with pytest.raises(ValueError, match="cell is an Element"):
        figures.labelled_cell(sw.elements.curved_beam(thickness=0.0005))  # pyright: ignore[reportArgumentType]
    with refuses(ValueError, "5 cells", "at most 4"):
        figures.labelled_chain(sw.Chain((CELLS["level"],) * 5))
    with pytest.raises(ValueError, match="the chain has elements"):
        figures.labelled_chain(sw.preset("curved-beam"))
