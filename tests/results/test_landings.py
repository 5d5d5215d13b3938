"""What runs, programs, screens and pages tell of landings for other mobilities."""

import json
from dataclasses import replace

import pytest

import stepwell as sw
from stepwell import results
from stepwell.cli.text import chains as texts
from stepwell.reports import report
from stepwell.results.landings import checked, elsewhere_rows, landings_told
from stepwell.statics import EventKind, Path


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
    cycle = RACE.cycle()
    return cycle, results.run_record(cycle, sw.margin(RACE))


def snaps(record):
    return [k for k, event in enumerate(record["events"]) if event["kind"] == "snap"]


def test_every_snap_of_a_small_chain_says_whether_its_landing_holds(race):
    cycle, record = race
    wanted = cycle.path.landings()
    assert [told["event"] for told in record["landings"]] == snaps(record)
    assert len(wanted) == len(record["landings"]) == 4
    for landing, told in zip(wanted, record["landings"], strict=True):
        assert told["holds"] is landing.holds
        assert told["ratio"] == 10.0
        assert told["samples"] == landing.samples
        assert (told["corners"], told["bound"]) == (landing.corners, landing.bound)
        assert told["proof"] == (landing.proof and landing.proof.name.lower())
        for place, one in zip(landing.elsewhere, told["elsewhere"], strict=True):
            assert tuple(one["mobility"]) == place.mobility
            assert one["travel_mm"] == [s / 1e-3 for s in place.travel]
            assert (one["state"], one["share"]) == (place.state, place.share)
    json.dumps(record, allow_nan=False)


def test_the_mobilities_that_are_told_lead_where_it_is_told(race):
    _, record = race
    found = elsewhere_rows(record["landings"], record["events"])
    assert found
    for place in found:
        mobile = zip(RACE.cells, place["mobility"], strict=True)
        cells = [replace(cell, mobility=m) for cell, m in mobile]
        there = replace(RACE, cells=tuple(cells)).cycle().snaps
        same = [one for one in there if one.stroke * 1e3 == pytest.approx(place["stroke_mm"])]
        after = {cell: s for one in same for cell, s in zip(one.cells, one.after, strict=True)}
        for cell, s in after.items():
            assert s * 1e3 == pytest.approx(place["travel_mm"][cell], abs=1e-6)


def chain_of(count: int) -> sw.Chain:
    return sw.Chain([sw.Cell(sw.Band((-0.01, 0.0), (0.01 + 1e-3 * i, 0.0))) for i in range(count)])


def test_landings_are_checked_up_to_eight_cells_and_above_where_it_is_asked():
    eight, nine = chain_of(8).cycle(), chain_of(9).cycle()
    assert len(checked(eight.path)) == len(eight.snaps) > 0
    assert checked(nine.path) == ()
    assert {landing.ratio for landing in checked(nine.path, 3.0)} == {3.0}
    record = results.run_record(nine, None)
    assert record["landings"] is None


def told(**changes) -> dict:
    landing = {"event": 0, "holds": True, "ratio": 10.0, "proof": None, "samples": 59}
    landing |= {"corners": 6, "bound": 0.0495}
    return landing | {"elsewhere": []} | changes


PROVED = told(proof="freedom", samples=0, corners=0, bound=0.0)
AT_MOST = "at most 5 % of mobilities lead elsewhere (95 % confidence, 59 samples"


@pytest.mark.parametrize(
    ("landings", "line"),
    [
        ([], ""),
        (None, "not checked for other mobilities"),
        ([PROVED], "holds for mobility ratios up to 10: proved"),
        ([told()], f"holds for mobility ratios up to 10: {AT_MOST})"),
        ([PROVED, PROVED], "all hold for mobility ratios up to 10: proved"),
        (
            [PROVED, PROVED, told()],
            f"all hold for mobility ratios up to 10: 2 proved, in 1 {AT_MOST})",
        ),
        (
            [PROVED, told(), told(bound=0.0501, samples=57)],
            "all hold for mobility ratios up to 10: 1 proved, in 2 at most 5.1 % of mobilities "
            "lead elsewhere (95 % confidence, 57 samples each)",
        ),
        ([PROVED, told(holds=False)], "1 of 2 hold for mobility ratios up to 10: proved"),
        ([told(holds=False)], "no landing holds for mobility ratios up to 10"),
    ],
)
def test_one_line_says_how_many_landings_hold_and_how_that_is_known(landings, line):
    assert landings_told(landings) == line


@pytest.mark.parametrize(
    ("mobility", "words"),
    [
        ((1, 7, 1), "left is 7 times faster"),
        ((10, 1, 10), "left is 10 times slower"),
        ((1, 2.5, 10), "as fast as large 1, left 2.5, right 10"),
    ],
)
def test_mobilities_are_told_by_names(mobility, words):
    place = {"mobility": mobility, "state": "011", "share": 0.125}
    event = {"direction": "loading", "stroke_mm": 1.0}
    (row,) = elsewhere_rows([told(holds=False, elsewhere=[place])], [event])
    _, _, how, state, share = (one.cell(row) for one in results.elsewhere_of(RACE))
    assert (how, state, share) == (words, "011", "12 %")


def test_of_two_cells_the_one_that_is_faster_is_named():
    pair = sw.Chain(RACE.cells[:2])
    place = {"mobility": (1.0, 4.0), "state": "01", "share": 0.5}
    (row,) = elsewhere_rows([told(holds=False, elsewhere=[place])], [{}])
    assert results.elsewhere_of(pair)[2].cell(row) == "left is 4 times faster"


def test_screen_and_page_tell_the_landings_of_the_record(race, capsys):
    cycle, record = race
    texts.run(record, RACE)
    screen, line = capsys.readouterr().out, landings_told(record["landings"])
    page = report(cycle, sw.margin(RACE), {})
    assert f"Landings    {line}\n" in screen
    assert f"<p>Landings: {line}.</p>" in page
    rows = elsewhere_rows(record["landings"], record["events"])
    assert rows
    for row in rows:
        for column in results.elsewhere_of(RACE):
            assert column.cell(row) in screen
            assert f">{column.cell(row)}<" in page


def test_a_long_chain_is_told_how_to_ask(capsys):
    chain = chain_of(9)
    texts.run(results.run_record(chain.cycle(), sw.margin(chain), ()), chain)
    screen = capsys.readouterr().out
    assert "Landings    not checked for other mobilities; --mobility-ratio 10 does\n" in screen


def test_a_program_tells_its_landings_too(capsys):
    program = sw.preset("paper-forward").program("01")
    record = results.program_record(program)
    kinds = [event.kind for event in program.path.events]
    assert kinds.count(EventKind.SNAP) == len(snaps(record)) > 0
    assert [landing["holds"] for landing in record["landings"]] == [True] * len(snaps(record))
    texts.program(record, program.chain)
    assert f"Landings  {landings_told(record['landings'])}\n" in capsys.readouterr().out


def test_known_landings_are_not_looked_for_again(race, monkeypatch):
    cycle, record = race
    known = cycle.path.landings()
    monkeypatch.setattr(Path, "landings", lambda *_, **__: pytest.fail("asked again"))
    again = results.run_record(cycle, sw.margin(RACE), known)
    assert again["landings"] == record["landings"]
    report(cycle, None, {}, None, known)
