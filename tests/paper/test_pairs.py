"""Graphs of two hysterons: all are enumerated, and the committed designs make theirs."""

import itertools
import json
from itertools import pairwise

import numpy as np
import pytest

from claims import ROOT
from facts import refuses
from stepwell import Chain, Element
from stepwell.paper.others import __main__ as designs
from stepwell.paper.others.elements import straight
from stepwell.paper.others.pairs import (
    canonical,
    graph_of,
    graphs,
    possible,
    reached,
    stations,
    way_to,
)

ROWS = json.loads((ROOT / "docs" / "pairs.json").read_text("utf-8"))
MADE = [row for row in ROWS if row["elements"]]


def test_two_hysterons_have_35_graphs_and_13_without_gardens_of_eden():
    all_graphs = graphs()
    assert len(set(all_graphs)) == len(all_graphs) == 35
    assert len({canonical(reached(graph)) for graph in all_graphs}) == 13


def test_a_graph_with_its_cells_renumbered_is_the_same_graph():
    for graph in graphs():
        other = tuple(
            sorted(
                way[1::-1] + way[2] + way[3:].translate(str.maketrans("12", "21")) for way in graph
            )
        )
        assert canonical(other) == canonical(graph) == graph


def test_where_a_way_ends_and_which_cell_begins_tell_the_way():
    for way in {way for graph in graphs() for way in graph}:
        states = stations(way)
        assert len(states) == len(way) - 2
        assert all(sum(x != y for x, y in zip(a, b, strict=True)) == 1 for a, b in pairwise(states))
        assert way_to(way[:2], way[2], int(way[3]) - 1, states[-1]) == way


def test_every_order_of_fields_has_the_graph_of_hysteron_tgraphs():
    """Another program's avalanches: all orders, those that it refuses left out."""
    model = pytest.importorskip("hysteron_tgraphs.model")
    others: set[tuple[str, ...]] = set()
    states = list(itertools.product((0, 1), repeat=2))
    for order in itertools.permutations(range(8)):
        if not (order[3] < order[2] and order[4] < order[5]):
            continue  # a state that stands at no drive
        fields = model.SwitchingFields(2)
        for k, state in enumerate(states):
            fields[state] = order[2 * k : 2 * k + 2]
        try:
            graph = model.make_graph(fields)
        except Exception:  # theirs refuses with bare exceptions
            continue
        ways = (
            "".join(map(str, state))
            + ("+" if direction > 0 else "-")
            + "".join(str(int(cell) + 1) for cell in graph[state, direction].flipped)
            for state, direction in graph
        )
        others.add(canonical(tuple(sorted(ways))))
    assert others == set(graphs())


def test_elements_with_one_force_for_each_travel_make_only_avalanches_of_opposite_ways():
    """The linear inequalities say what the argument on the page says."""
    for graph in graphs():
        flips = [(way, stations(way)) for way in graph]
        opposite = all(
            len(states) == 2 or (len(states) == 3 and states[0].count("1") == states[2].count("1"))
            for _, states in flips
        )
        assert possible(graph, plain=True) == opposite


def test_the_file_of_designs_knows_every_graph_once():
    assert [row["graph"] for row in ROWS] == [" ".join(graph) for graph in graphs()]
    assert len(MADE) == 18
    assert sum(row["under_force"] for row in ROWS) == 2
    under_length = [row["under_length"] for row in ROWS]
    assert (under_length.count("impossible"), under_length.count("undecided")) == (6, 11)
    assert len({row["reached"] for row in MADE}) >= 13


def test_the_page_shows_the_file_of_designs():
    page = (ROOT / "docs" / "others.md").read_text("utf-8")
    assert f"{designs.BEGIN}\n\n{designs.table(ROWS)}\n\n{designs.END}" in page


@pytest.mark.slow
@pytest.mark.parametrize("row", MADE, ids=lambda row: row["graph"].replace(" ", ","))
def test_a_committed_design_makes_its_graph(row):
    elements = [
        straight(list(zip(one["travel_mm"], one["force_N"], strict=True)))
        for one in row["elements"]
    ]
    folds = sum(len(element.laws) > 1 for element in elements)
    assert designs._HOW[folds] == row["under_length"]
    assert " ".join(canonical(graph_of(Chain(elements)))) == row["graph"]


def test_a_curve_by_corners_is_straight_between_them():
    plain = straight([(0.0, 0.0), (1.0, 2.0), (3.0, -2.0), (5.0, 4.0)])
    assert plain == Element.from_points([0.0, 1e-3, 3e-3, 5e-3], [0.0, 2.0, -2.0, 4.0])
    folded = straight([(0.0, 0.0), (10.0, 1.0), (8.0, -0.6), (12.0, 1.4)], 2.0)
    assert len(folded.laws) == 2
    np.testing.assert_allclose(folded.force_at([0.0025, 0.0075]), [0.5, 1.5], atol=1e-12)


def test_designs_are_written_into_file_and_page(tmp_path, monkeypatch):
    monkeypatch.setattr(designs, "rows", lambda: ROWS[:2])
    file, page = tmp_path / "pairs.json", tmp_path / "page.md"
    page.write_text(f"before\n{designs.BEGIN}\n{designs.END}\nafter\n", "utf-8")
    designs.main(file, [page])
    assert json.loads(file.read_text("utf-8")) == ROWS[:2]
    assert designs.table(ROWS[:2]) in page.read_text("utf-8")
    page.write_text("a page", "utf-8")
    with refuses(ValueError, "no place", "table"):
        designs.main(file, [page])
