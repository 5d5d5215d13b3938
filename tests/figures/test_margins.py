"""The margins figure: a bar per parameter, the smallest on top, with its tolerance."""

import math

import pytest

from facts import says
from stepwell import figures, files
from stepwell.design import Tolerances, margin


def bars(figure, gid: str) -> list[float]:
    return [p.get_width() for ax in figure.axes for p in ax.patches if p.get_gid() == gid]


def words(figure) -> str:
    return "\n".join(text.get_text() for ax in figure.axes for text in ax.texts)


@pytest.fixture(scope="module")
def forward():
    return margin(files.preset("paper-forward"))


def test_every_change_has_a_bar_of_its_length(forward):
    drawn = figures.margins(forward)
    anchors = sorted(forward.anchors * 1e3)
    shares = sorted(forward.stiffness * 1e2)
    assert bars(drawn, "margins") == pytest.approx([*anchors, *shares])


def test_the_sequence_past_a_change_stands_above_its_bar(forward):
    text = words(figures.margins(forward))
    for change in forward.changes:
        assert f"then {change.becomes}" in text


def test_tolerances_are_drawn_beside_the_margins(forward):
    given = Tolerances(anchor=0.0005, stiffness=0.04)
    assert bars(figures.margins(forward, given), "off") == pytest.approx([0.5, 0.5, 4.0, 4.0])


def test_a_margin_within_the_tolerance_looks_unlike_the_others(forward):
    wide = Tolerances(anchor=0.0005, stiffness=0.249)
    nearest = float(min(forward.anchors))
    for given, kinds in ((wide, 1), (Tolerances(anchor=2 * nearest), 2)):
        drawn = figures.margins(forward, given)
        looks = {
            p.get_facecolor() for ax in drawn.axes for p in ax.patches if p.get_gid() == "margins"
        }
        assert len(looks) == kinds


def test_where_nothing_changes_it_that_is_said():
    limits = margin(files.preset("paper-cell-10-0"))
    assert all(math.isinf(change.distance) for change in limits.changes)
    drawn = figures.margins(limits)
    assert bars(drawn, "margins") == []
    says(words(drawn), "no other sequence", "20 mm")


def test_of_long_chains_the_nearest_are_shown():
    limits = margin(files.preset("metachronal-wave"))
    assert len(bars(figures.margins(limits), "margins")) == 12
    assert "more, no nearer" not in words(figures.margins(limits))
