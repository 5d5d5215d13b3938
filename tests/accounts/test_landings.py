"""What runs and programs report of landings for other mobilities."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

import stepwell as sw
from accounts.forms import forms
from stepwell.accounts import account
from stepwell.accounts.events import event_sections, landing_words
from stepwell.accounts.parts import RecordTable
from stepwell.design import Run
from stepwell.statics import Landing


def element(name: str, peak: tuple[float, float], valley: tuple[float, float]) -> sw.Element:
    """Rising, falling and rising again, corners in mm and N."""
    (a, up), (b, down) = peak, valley
    return sw.Element.from_points(
        [0.0, a * 1e-3, b * 1e-3, (b + 4) * 1e-3], [0.0, up, down, down + 1.2], name
    )


# As `large` snaps through, `left` and `right` race to give way: what one gives holds the other.
RACE = sw.Chain(
    [
        element("large", (6, 1.3), (17, -0.7)),
        element("left", (3, 0.62), (11, 0.24)),
        element("right", (3, 0.73), (11, 0.15)),
    ],
    title="race",
)


@pytest.fixture(scope="module")
def race():
    return Run.of(RACE)


def elsewhere(chain: sw.Chain, events: Any, landings: Any) -> list[list[str]]:
    """The cells of the table of other landings."""
    *_, table = event_sections(chain, events, landings).values()
    assert isinstance(table, RecordTable) and callable(table.rows)
    return [[column.cell(row) for column in table.columns] for row in table.rows()]


@pytest.mark.slow
def test_every_snap_of_a_small_chain_has_its_landing(race):
    record, events = account(race).record, race.cycle.events
    snaps = [k for k, event in enumerate(record["events"]) if event["kind"] == "snap"]
    assert [one["event"] for one in record["landings"]] == snaps
    assert len(race.landings) == len(record["landings"]) == 4
    for landing, one in zip(race.landings, record["landings"], strict=True):
        assert events[one["event"]] == landing.event
        assert (one["holds"], one["ratio"]) == (landing.holds, 10.0)
        for key in ("samples", "corners", "bound"):
            assert one[key] == getattr(landing, key)
        assert one["proof"] == (landing.proof and landing.proof.name.lower())
        for place, other in zip(landing.elsewhere, one["elsewhere"], strict=True):
            assert tuple(other["mobility"]) == place.mobility
            assert other["travel_mm"] == [s / 1e-3 for s in place.travel]
            assert (other["state"], other["fraction"]) == (place.state, place.fraction)


def test_the_mobilities_of_another_landing_lead_there(race):
    found = [(landing.event, place) for landing in race.landings for place in landing.elsewhere]
    assert found
    for event, place in found:
        mobile = zip(RACE.cells, place.mobility, strict=True)
        cells = [replace(cell, mobility=m) for cell, m in mobile]
        there = replace(RACE, cells=tuple(cells)).cycle().snaps
        same = [one for one in there if one.stroke == pytest.approx(event.stroke)]
        after = {cell: s for one in same for cell, s in zip(one.cells, one.after, strict=True)}
        for cell, s in after.items():
            assert s == pytest.approx(place.travel[cell], abs=1e-9)


def chain_of(count: int) -> sw.Chain:
    return sw.Chain([sw.Cell(sw.Band((-0.01, 0.0), (0.01 + 1e-3 * i, 0.0))) for i in range(count)])


@pytest.mark.slow
def test_landings_are_checked_up_to_eight_cells_and_above_where_it_is_asked():
    eight, nine = chain_of(8).cycle(), chain_of(9).cycle()
    assert len(eight.path.checked_landings or ()) == len(eight.snaps) > 0
    assert nine.path.checked_landings is None
    asked = nine.path.landings(3.0)
    assert {landing.ratio for landing in asked} == {3.0}


def one(**changes) -> Any:
    landing = {"holds": True, "ratio": 10.0, "proof": None, "samples": 59, "bound": 0.0495}
    return SimpleNamespace(**(landing | changes))


PROVED = one(proof="freedom", samples=0, bound=0.0)


@pytest.mark.parametrize(
    ("landings", "numbers"),
    [
        ([], []),
        ([PROVED], ["1 of 1 hold", "10", "1 proved"]),
        ([one()], ["1 of 1 hold", "10", "1 sampled", "5 %", "95 %", "59"]),
        ([PROVED, PROVED], ["2 of 2 hold", "10", "2 proved"]),
        ([PROVED, PROVED, one()], ["3 of 3 hold", "10", "2 proved", "1 sampled", "5 %", "59"]),
        (
            [PROVED, one(), one(bound=0.0501, samples=57)],
            ["3 of 3 hold", "1 proved", "2 sampled", "5.1 %", "57"],
        ),
        ([PROVED, one(holds=False)], ["1 of 2 hold", "10", "1 proved"]),
        ([one(holds=False)], ["0 of 1 hold", "10"]),
        (None, ["not checked"]),
    ],
)
def test_one_line_has_how_many_landings_hold_and_how_that_is_known(landings, numbers):
    line = landing_words(landings)
    assert bool(line) == bool(numbers)
    at = 0
    for text in numbers:
        at = line.index(text, at)


def _with(landing: Landing, mobility: tuple[float, ...], state: str) -> Landing:
    place = replace(landing.elsewhere[0], mobility=mobility, state=state, fraction=0.125)
    return replace(landing, elsewhere=(place,))


@pytest.mark.parametrize(
    ("mobility", "words"),
    [
        ((1, 7, 1), "left 7, others 1"),
        ((10, 1, 10), "large 10, right 10, others 1"),
        ((1, 2.5, 10), "left 2.5, right 10, others 1"),
    ],
)
def test_mobilities_are_reported_by_names(race, mobility, words):
    landing = next(one for one in race.landings if one.elsewhere)
    (row,) = elsewhere(RACE, race.cycle.events, [_with(landing, mobility, "011")])
    assert row[2:] == [words, "011", "12 %"]


def test_every_form_has_the_landings_and_terminal_and_page_the_others(race):
    found = account(race)
    screen, small, made = forms(found)
    line = landing_words(race.landings)
    for form in (screen, small, made):
        assert line in " ".join(form.split())
    rows = elsewhere(RACE, race.cycle.events, race.landings)
    assert rows
    for row in rows:
        for text in row[2:]:
            assert text in " ".join(screen.split()) and text in made
