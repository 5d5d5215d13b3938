"""The transition graph: every state in its column, every way in its colour, nothing on top."""

from functools import cache
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from matplotlib.patches import FancyBboxPatch

from facts import refuses
from figures.drawn import collisions, legend_of, lines, marks, points, says, untidy
from sizes import cases
from stepwell import figures, files
from stepwell.figures.common.style import LOADING, UNLOADING
from stepwell.figures.graph_layout import heights
from stepwell.mechanism import Band, Cell, Chain
from stepwell.sequences import Node, Transition, TransitionGraph, TransitionKind


def nested(count: int, stiffness: float = float("inf")) -> Chain:
    """Every loop of (F1, F0) inside the next one, so that all states can be reached."""
    reach = np.linspace(0.010, 0.030, count) - 0.010
    return Chain([Cell(Band((-0.010, 0.0), (q, 0.0))) for q in reach.tolist()], stiffness)


def stack(count: int) -> Chain:
    """Out the way they came: no snap, and no state but those on the way."""
    heights_ = np.linspace(-0.015, 0.015, count).tolist()
    return Chain([Cell(Band((-0.010, 0.0), (0.010, y))) for y in heights_])


CHAINS = {
    "forward": files.preset("paper-forward"),
    "undirected": files.preset("paper-via-10"),
    "identical": files.preset("paper-identical"),
    "one cell": files.preset("paper-cell-10-0"),
    "wave": files.preset("three-wave"),
    "stack": files.preset("three-stack"),
    "shuffle": files.preset("four-shuffle"),
    "force": files.preset("force-control"),
    "spring": files.preset("compliant-actuator"),
    "soft pair": Chain(files.preset("paper-backward").cells, 50.0),
    "soft wave": Chain(files.preset("three-wave").cells, 50.0),
    **{f"nested {n}": nested(n) for n in (2, 3, 4, 5, 6)},
    "force 3": nested(3, 0.0),
    "force 6": nested(6, 0.0),
    "spring 6": nested(6, 30.0),
}


LARGE = ["nested 6", "force 6", "spring 6", "shuffle"]
# Under each control, with and without states out of reach, one cell and the most states.
DRAWN = cases(
    CHAINS,
    ("forward", "undirected", "one cell", "wave", "shuffle", "force", "spring", "soft wave",
     "nested 4", "nested 6", "force 3"),
)  # fmt: skip


@cache
def graph_of(name: str):
    """Several tests draw the same graph."""
    return CHAINS[name].graph()


@cache
def figure_of(name: str):
    """Several tests look at the same figure."""
    return figures.transition_graph(graph_of(name))


def places(figure) -> dict[str, tuple[float, float]]:
    """Where every name stands [mm]."""
    return {text.get_text(): text.get_position() for text in figure.axes[0].texts}


def boxes(figure, gid: str) -> int:
    """How many states have this mark."""
    patches = figure.axes[0].patches
    return sum(isinstance(p, FancyBboxPatch) and p.get_gid() == gid for p in patches)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * name.endswith("6")) for name in DRAWN]
)
def test_every_state_has_its_name_and_no_word_covers_another(name):
    graph, figure = graph_of(name), figure_of(name)
    said = says(figure)
    for state in graph.vertices:
        assert said.count(state) == 1
    assert untidy(figure, 7.0) == []
    assert 25.4 * figure.get_size_inches()[0] == pytest.approx(85.0 if graph.cells <= 3 else 180.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", cases(LARGE, ["nested 6", "shuffle"]))
def test_boxes_do_not_touch(name):
    ax = figure_of(name).axes[0]
    drawn = [p.get_window_extent() for p in ax.patches if isinstance(p, FancyBboxPatch)]
    for k, box in enumerate(drawn):
        assert not any(box.overlaps(other) for other in drawn[:k])


def test_states_stand_by_their_number_of_cells_at_1():
    graph = graph_of("nested 4")
    at = places(figure_of("nested 4"))
    columns = {
        ones: {at[v][0] for v in graph.vertices if v.count("1") == ones} for ones in range(5)
    }
    assert all(len(column) == 1 for column in columns.values())
    x = [column.pop() for column in columns.values()]
    assert np.diff(x) == pytest.approx(x[1] - x[0])
    assert x[1] > x[0]


def test_loading_and_unloading_differ_in_colour_and_line():
    figure = figure_of("nested 3")
    up, down = lines(figure, "loading"), lines(figure, "unloading")
    assert {line.get_color() for line in up} == {LOADING}
    assert {line.get_color() for line in down} == {UNLOADING}
    assert {line.get_linestyle() for line in up} == {"-"}
    assert {line.get_linestyle() for line in down} == {"--"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    cases(
        ["forward", "wave", "shuffle", "nested 4", "nested 6", "force 6"],
        ["forward", "shuffle", "nested 6"],
    ),
)
def test_every_snap_is_marked(name):
    graph = graph_of(name)
    snaps = sum(one.kind is TransitionKind.SNAP for *_, one in graph.transitions())
    assert marks(figure_of(name), "snaps") == snaps > 0


@pytest.mark.parametrize(
    ("name", "half_way"),
    [
        # Turning back there leads to a state that the chain did not come from.
        ("forward", {"-0", "-1"}),
        ("nested 3", {"-00", "-10", "-01", "-11"}),
        ("undirected", {"-0", "1-"}),
        # Where it only leads back, the way goes over it.
        ("spring", set()),
        ("one cell", set()),
        ("force 3", set()),
    ],
)
def test_half_way_states_are_shown_where_they_offer_another_way(name, half_way):
    assert {word for word in says(figure_of(name)) if "-" in word} - {"cell half-way"} == half_way


def test_in_long_chains_half_way_states_are_dots():
    figure = figure_of("nested 4")
    assert marks(figure, "half") == 8
    assert "half-way state" in legend_of(figure)


def test_states_out_of_reach_and_gardens_of_eden_are_set_apart():
    graph, figure = graph_of("shuffle"), figure_of("shuffle")
    aside = set(graph.reading.unreachable)
    gardens = set(graph.reading.garden_of_eden)
    assert boxes(figure, "garden") == len(gardens) > 0
    assert boxes(figure, "unreachable") == len(aside - gardens) > 0
    assert boxes(figure, "state") == 16 - len(aside | gardens)
    assert {"Garden of Eden", "unreachable from 0000"} <= set(legend_of(figure))


def test_where_all_is_reached_nothing_is_set_apart():
    figure = figure_of("nested 3")
    assert legend_of(figure) == ["loading", "unloading", "main loop", "snap", "cell half-way"]


@pytest.mark.parametrize(
    "name",
    ["forward", "wave", "shuffle", pytest.param("nested 6", marks=pytest.mark.slow), "force 3"],
)
def test_the_main_loop_is_the_cycle_and_bold(name):
    chain = CHAINS[name]
    figure = figure_of(name)
    bold = {text.get_text() for text in figure.axes[0].texts if text.get_fontweight() == "bold"}
    assert bold == set(chain.cycle().sequence)


def test_a_program_is_highlighted_from_start_to_end():
    chain = files.preset("paper-forward")
    program = chain.program("01", start="10")
    figure = figures.transition_graph(chain.graph(), program=program)
    # Past the snap, and back down to 01.
    assert len(lines(figure, "program")) == 2
    numbers = [t.get_text() for t in figure.axes[0].texts if t.get_gid() == "turn"]
    assert numbers == ["1"]
    assert legend_of(figure)[-1] == "program, 10 to 01"
    assert collisions(figure) == []


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", cases([float("inf"), 30.0, 0.0], [30.0]))
def test_every_turn_of_a_long_program_has_its_number(stiffness):
    chain = nested(5, stiffness)
    program = chain.program("01010")
    figure = figures.transition_graph(chain.graph(), program=program)
    said = [t.get_text() for t in figure.axes[0].texts if t.get_gid() == "turn"]
    numbers = [int(number) for text in said for number in text.split(",")]
    assert sorted(numbers) == list(range(1, len(program.turns) + 1))
    assert collisions(figure) == []


@pytest.mark.slow
def test_the_highlighted_way_is_connected():
    chain = nested(4)
    program = chain.program("0101")
    drawn = lines(figures.transition_graph(chain.graph(), program=program), "program")
    ends = [points(line)[[0, -1]] for line in drawn]
    net = nx.Graph()
    net.add_nodes_from(range(len(ends)))
    for i, a in enumerate(ends):
        for j, b in enumerate(ends[:i]):
            # Ways end at the two sides of a box.
            near = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1)).min() < 9.0
            net.add_edges_from([(i, j)] if near else [])
    assert nx.is_connected(net)


def test_a_program_of_another_chain_is_refused():
    program = files.preset("paper-forward").program("01", start="10")
    with pytest.raises(ValueError, match=r"another chain.*program.chain.graph"):
        figures.transition_graph(files.preset("paper-backward").graph(), program=program)


@pytest.mark.slow
def test_more_states_than_can_be_read_are_refused_with_advice():
    with refuses(ValueError, "128 states", "at most 64", "Graphviz"):
        figures.transition_graph(nested(7).graph())


def test_a_long_chain_can_be_drawn_from_one_state():
    graph = stack(14).graph(start="0" * 14)
    figure = figures.transition_graph(graph)
    assert boxes(figure, "state") == 15
    assert untidy(figure) == []


@pytest.mark.slow
def test_the_same_graph_gives_the_same_figure():
    graph = nested(4).graph()
    assert figures.svg(figures.transition_graph(graph)) == figures.svg(
        figures.transition_graph(graph)
    )


def test_a_way_past_a_whole_column_goes_round_the_states_in_it():
    # Made by hand: 00 jumps to 11 past 10, which stands half-way between them.
    states = ("00", "10", "11")
    ways = [("00", "11", 1), ("11", "10", -1), ("10", "00", -1), ("10", "11", 1)]
    graph = TransitionGraph.of(
        [Node(s, s, k - 1.0, k + 1.0, 0, 0, (), (), k) for k, s in enumerate(states)],
        [(a, b, Transition(TransitionKind.SNAP, way, 0.5, (0,))) for a, b, way in ways],
        chain=None, names=("a", "b"), actuator="field", unit="", start=None, method="",
    )  # fmt: skip
    figure = figures.transition_graph(graph)
    at = np.array(places(figure)["10"])
    drawn = [points(line) for line in lines(figure, "loading")]
    (jump,) = [xy for xy in drawn if np.ptp(xy[:, 0]) > 40.0]
    assert np.hypot(*(jump - at).T).min() > 2.0


def test_joined_nodes_are_put_side_by_side():
    columns = {"a": 0.0, "b": 0.0, "c": 0.0, "x": 1.0, "y": 1.0, "z": 1.0, "half": 0.5}
    lines_ = [("a", "z", 1.0), ("b", "x", 1.0), ("c", "half", 1.0), ("half", "y", 1.0)]
    y = heights(columns, [name for name in columns if name != "half"], lines_)
    pairs = sorted((y[a], y[b]) for a, b in (("a", "z"), ("b", "x"), ("c", "y")))
    assert all(a[1] < b[1] for a, b in pairwise(pairs))
    assert y["half"] == pytest.approx((y["c"] + y["y"]) / 2)
