"""Yields: bars as long as the shares, the interval on the wanted one, parts by what they cause."""

import numpy as np
import pytest

from figures.drawn import lines, points, says, untidy, words
from figures.shapes import boxes
from stepwell import figures, files
from stepwell.design import Tolerances, yields
from stepwell.figures.common.words import sequence_words, shortened, wrapped

LOOSE = Tolerances(anchor=0.002, stiffness=0.15)


@pytest.fixture(scope="module")
def yield_result():
    return yields(files.preset("paper-forward"), LOOSE, samples=20_000, sensitivity=True)


def test_bars_are_as_long_as_the_shares(yield_result):
    bars = boxes(figures.yield_bars(yield_result), "outcomes")
    shares = [
        yield_result.fraction,
        *(count / yield_result.samples for count in yield_result.outcomes.values()),
    ]
    assert [bar.get_width() for bar in bars] == pytest.approx([100 * share for share in shares])
    assert sum(bar.get_width() for bar in bars) == pytest.approx(100.0)


def test_the_interval_is_drawn_and_stated(yield_result):
    figure = figures.yield_bars(yield_result)
    (interval,) = lines(figure, "interval")
    assert points(interval)[:, 0] == pytest.approx(100 * np.array(yield_result.interval))
    low, high = (f"{100 * bound:.1f} %" for bound in yield_result.interval)
    assert f"{100 * yield_result.fraction:.1f} % ({low} to {high}) reach the target" in says(figure)


@pytest.mark.parametrize("anchor", [0.0003, 0.002, 0.0035])
@pytest.mark.parametrize("name", ["paper-forward", "three-wave"])
def test_the_interval_strikes_through_no_word(name, anchor):
    figure = figures.yield_bars(yields(files.preset(name), Tolerances(anchor), samples=2000))
    (interval,) = lines(figure, "interval")
    box = interval.get_window_extent()
    assert not [t.get_text() for t in words(figure) if t.get_window_extent().overlaps(box)]


def test_parts_are_sorted_by_what_their_tolerance_causes(yield_result):
    figure = figures.yield_bars(yield_result)
    table = yield_result.sensitivities
    order = [i for i in np.argsort(-table.total, kind="stable") if table.total[i] >= 0.01]
    names = [label.get_text() for label in figure.axes[1].get_yticklabels()]
    assert names == [table.parameters[i] for i in order]
    total = [bar.get_width() for bar in boxes(figure, "total")]
    alone = [bar.get_width() for bar in boxes(figure, "first order")]
    assert total == pytest.approx(table.total[order])
    assert alone == pytest.approx(np.maximum(table.first_order[order], 0.0))


@pytest.mark.slow
def test_words_stay_apart_and_on_the_page(yield_result):
    shuffle = yields(files.preset("four-shuffle"), LOOSE, samples=20_000, sensitivity=True)
    plain = yields(files.preset("three-wave"), Tolerances(anchor=0.0003), samples=1000)
    for result, width in ((yield_result, 180.0), (shuffle, 180.0), (plain, 85.0)):
        figure = figures.yield_bars(result)
        assert untidy(figure, 7.0) == []
        assert 25.4 * figure.get_size_inches()[0] == pytest.approx(width)


def test_rare_outcomes_are_counted_together(yield_result):
    shuffle = yields(files.preset("four-shuffle"), LOOSE, samples=20_000)
    figure = figures.yield_bars(shuffle)
    assert f"{len(shuffle.outcomes) - 6} other outcomes" in says(figure)
    assert sum(bar.get_width() for bar in boxes(figure, "outcomes")) == pytest.approx(100.0)


def test_axes_say_what_is_counted(yield_result):
    left, right = figures.yield_bars(yield_result).axes
    assert left.get_xlabel() == "Fraction of 20\N{THIN SPACE}000 samples [%]"
    assert right.get_xlabel() == "Variance fraction of the smallest force gap"


def test_a_share_near_one_does_not_look_certain():
    nearly = yields(
        files.preset("paper-forward"), Tolerances(anchor=0.0021, stiffness=0.05), samples=20_000
    )
    assert 0.99 < nearly.fraction < 1.0
    (line,) = [one for one in says(figures.yield_bars(nearly)) if one.endswith("reach the target")]
    assert line.startswith("99.")


def test_long_sequences_are_reported_by_what_moves():
    assert sequence_words("00>10>11>01>00", 50) == "00>10>11>01>00"
    assert sequence_words("000>100>111>011>000", 10) == "loads 1 2+3, unloads 1 2+3"
    assert sequence_words("cannot be built", 5) == "cannot be built"


def test_texts_are_broken_and_shortened():
    assert wrapped("00>10>11>01>00", 6) == ["00>10>", "11>01>", "00"]
    assert wrapped("turned away at 40 s", 17) == ["turned away at", "40 s"]
    assert shortened("one", 5) == "one"
    assert shortened("a long name", 6) == "a lon…"
    assert shortened("a long name", 6, 2) == "a long\nname"
    assert shortened("unbreakable", 6) == "unbre…"
