"""An atlas tells what a space of designs holds, how often, and what it cannot hold."""

import json
import shutil
from dataclasses import replace
from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from facts import refuses
from figures.drawn import untidy
from sizes import examples
from studies_bytes import bytes_of

pytest.importorskip("zarr", reason="atlases are not tested: zarr is not installed")

from stepwell import figures, reports
from stepwell.accounts import account
from stepwell.concave import DECIDED, FORCE, STROKE, classed, simple
from stepwell.design import Tolerances, parameter
from stepwell.studies import (
    Axis,
    IndependentBlocks,
    StudyError,
    atlas,
    canonical,
    changed,
    charted,
    class_boundaries,
    find,
    name_of,
    opened,
    packed,
    possible,
    proved_space,
    resumed,
    sweep,
)
from stepwell.studies.graph_classes import ways_of

pytestmark = pytest.mark.slow

CELL = sw.Cell(sw.Band(p=(-0.01, 0.0), q=(0.01, 0.0), stiffness=28.5, rest_length=0.01))


def axes_of(cells, low=0.0):
    """The paper's map for every cell, and one band up to two."""
    return tuple(
        axis
        for number in range(1, cells + 1)
        for axis in (
            Axis(f"{number}.q.x", low, 0.020),
            Axis(f"{number}.q.y", -0.015, 0.015),
            Axis(f"{number}.stiffness", 28.5, 57.0),
        )
    )


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    """Small atlases, each begun once."""
    home, made = tmp_path_factory.mktemp("atlas"), {}

    def store(cells, designs, drive="stroke", low=0.0):
        key = cells, designs, drive, low
        if key not in made:
            chain, folder = sw.Chain([CELL] * cells), home / f"{len(made)}.zarr"
            run_status = atlas(chain, axes_of(cells, low), designs, folder, drive=drive, workers=0)
            assert run_status.finished
            made[key] = run_status.study, charted(run_status.study, samples=100, checks=40)
        return made[key]

    return store


def test_of_two_cells_it_is_proved_that_no_other_graph_occurs(stores):
    _, catalogue = stores(2, 20_000)
    assert catalogue.whole and catalogue.possible == len(catalogue.graph_classes) == 3
    assert catalogue.closed_form == catalogue.designs == 20_000 and catalogue.space_proved
    assert sum(one.fraction.times for one in catalogue.graph_classes) == catalogue.closed_form
    assert sum(one.fraction.times for one in catalogue.cycles) == catalogue.closed_form


@pytest.mark.parametrize(
    ("cells", "designs", "drive"), [(2, 20_000, "force"), (3, 2_000, "stroke"), (3, 2_000, "force")]
)
def test_the_engine_finds_the_same_graphs(stores, cells, designs, drive):
    _, catalogue = stores(cells, designs, drive)
    assert all(one.agrees for one in catalogue.graph_classes)
    assert catalogue.checked > 30 and catalogue.agreed == catalogue.checked
    assert sum(one.fraction.times for one in catalogue.graph_classes) == catalogue.closed_form


def test_graph_classes_say_of_their_design_what_its_graph_says(stores):
    _, catalogue = stores(3, 2_000)
    for one in catalogue.graph_classes[:6]:
        graph = one.chain.graph()
        reading = graph.reading
        assert one.states == len(graph.vertices)
        assert one.remembers == reading.return_point_memory.holds
        assert one.latches == len(reading.latches)
        assert one.sub_loops == reading.sub_loop_count
        # Cells are numbered as they load.
        sequence = str(one.chain.cycle().sequence).split(">")
        order = [next(k for k in range(3) if b[k] != a[k]) for a, b in pairwise(sequence[:4])]
        assert one.cycle == ">".join("".join(s[k] for k in order) for s in sequence)


def test_cycles_are_those_of_their_designs(stores):
    _, catalogue = stores(3, 2_000)
    assert len(catalogue.cycles) == 36
    for one in catalogue.cycles[::6]:
        assert str(one.chain.cycle().sequence) == one.sequence


def test_the_papers_map_of_two_cells_has_its_shares(tmp_path):
    axes = (Axis("2.q.x", 0.0, 0.020), Axis("2.q.y", -0.015, 0.015))
    study = atlas(sw.Chain([CELL] * 2), axes, 100_000, tmp_path / "map.zarr", workers=0).study
    shares = {one.sequence: one.fraction for one in charted(study, samples=1, checks=1).cycles}
    # Kamp et al., Fig. 2: counterclockwise, via 01, via 10, clockwise.
    wanted = {
        "00>01>11>10>00": 0.261,
        "00>01>11>01>00": 0.262,
        "00>10>11>10>00": 0.262,
        "00>10>11>01>00": 0.215,
    }
    assert shares.keys() == wanted.keys()
    for sequence, share in wanted.items():
        assert shares[sequence].low - 0.0005 < share < shares[sequence].high + 0.0005


def test_what_is_not_proved_is_followed_by_the_engine_and_called_a_sample(stores):
    study, catalogue = stores(2, 20_000, low=-0.008)
    assert catalogue.not_proved > 0 and not catalogue.space_proved and not catalogue.whole
    assert (
        catalogue.closed_form + catalogue.not_proved + catalogue.ties + catalogue.wakes
        == catalogue.designs
    )
    assert catalogue.sampled.asked == 40
    assert sum(catalogue.sampled.graph_classes.values()) + catalogue.sampled.failed == 40
    for number in json.loads(str(study.values("asked")[0]))[:9]:
        chain = changed(
            study.subject,
            [axis.name for axis in catalogue.axes],
            study.designs.space.points(number, number + 1)[0].tolist(),
        )
        assert packed_certificate(chain) is False


def packed_certificate(chain):
    from stepwell.concave import certify

    return all((one := simple(cell)) and certify(one, 0.0) for cell in chain.cells)


def test_a_store_that_lost_blocks_is_filled_with_the_same_bytes(tmp_path):
    chain, axes = sw.Chain([CELL] * 2), axes_of(2)
    blocks = IndependentBlocks(axes, 500, 6, seed=3)
    whole = sweep(chain, "atlas", blocks, tmp_path / "a", chunk=1, workers=0).study
    shutil.copytree(tmp_path / "a", tmp_path / "b")
    (tmp_path / "b" / "graphs" / "c" / "2").unlink()
    torn = tmp_path / "b" / "told" / "c" / "4"
    torn.write_bytes(torn.read_bytes()[:-3])
    part = opened(tmp_path / "b")
    assert part.missing() == [2, 4]
    # What is done is an atlas already, of fewer designs.
    assert charted(part, samples=10, checks=0).designs == 2_000
    assert resumed(part, 0).finished
    assert bytes_of(tmp_path / "a") == bytes_of(tmp_path / "b")
    assert charted(part, samples=10, checks=5) == charted(whole, samples=10, checks=5)


def test_blocks_hold_the_designs_that_a_sweep_draws_one_by_one():
    blocks = IndependentBlocks(axes_of(1), 7, 3, seed=5)
    chain = sw.Chain([CELL])
    points = np.concatenate([block.points for _, block in blocks.made(chain, 0, 3)])
    assert np.array_equal(points, blocks.space.points(0, 21))


@given(st.integers(0, 2**32))
def test_numbers_of_many_designs_are_those_of_each(seed):
    chain, axes = sw.Chain([CELL, CELL.with_anchors(q=(0.02, 0.001))]), axes_of(2)
    names = [*(axis.name for axis in axes), "1.p.y", "2.lever", "2.rest_length"]
    low = [*(axis.low for axis in axes), -0.002, 0.01, 0.009]
    high = [*(axis.high for axis in axes), 0.002, 0.02, 0.012]
    point = np.random.default_rng(seed).uniform(low, high)
    made = changed(chain, names, point.tolist())
    assert isinstance(made, sw.Chain)
    wanted = np.array([simple(cell) for cell in made.cells], float)
    catalogue = packed(chain, names).at(point[None])[0]
    assert np.allclose(catalogue, wanted, rtol=1e-12, atol=1e-17)


@pytest.mark.parametrize(
    ("chain", "names", "said"),
    [
        (sw.Chain([CELL] * 2), ["1.limit"], "needs a linear dependence"),
        (sw.Chain([CELL] * 2), ["1.friction"], "closed form needs cells of one linear band"),
        (sw.Chain([CELL] * 7), ["1.q.x"], "7 cells: must be at most 6"),
        (sw.Chain([CELL], actuator_stiffness=50.0), ["1.q.x"], "no spring behind the actuator"),
        (sw.preset("dome"), [], "closed form needs cells of one linear band"),
    ],
)
def test_what_closed_form_does_not_take_is_refused(chain, names, said):
    with pytest.raises(sw.InputError, match=said):
        packed(chain, names)


def test_a_refused_space_leaves_no_store(tmp_path):
    axes = (Axis("1.limit", 0.5, 0.8),)
    with pytest.raises(sw.InputError, match="linear dependence"):
        atlas(sw.Chain([CELL] * 2), axes, 100, tmp_path / "a")
    with refuses(sw.InputError, "drive = 'pull'", "stroke, force"):
        atlas(sw.Chain([CELL] * 2), axes_of(2), 100, tmp_path / "a", drive="pull")
    assert not (tmp_path / "a").exists()


def test_another_study_is_no_atlas(tmp_path):
    study = sweep(
        sw.Chain([CELL]), "graph", IndependentBlocks(axes_of(1), 2, 1), tmp_path / "a", workers=0
    )
    with pytest.raises(sw.InputError, match="must contain an atlas"):
        charted(study.study)
    with pytest.raises(StudyError):
        opened(tmp_path)


def test_tolerances_of_what_no_cell_has_are_refused(stores):
    study, _ = stores(2, 20_000)
    with refuses(sw.InputError, "tolerances", "friction", "0"):
        charted(study, tolerances=Tolerances(friction=0.1))


def test_a_yield_is_that_of_mechanisms_built_one_by_one(stores):
    study, catalogue = stores(2, 20_000)
    graph_class = min(catalogue.graph_classes, key=lambda one: one.gap)
    wide, many = Tolerances(anchor=0.006, stiffness=0.2), examples(80, full=200)
    (one,) = (
        m
        for m in charted(study, tolerances=wide, samples=many).graph_classes
        if m.name == graph_class.name
    )
    from stepwell.design import Draws
    from stepwell.studies.graph_classes import name_of, ways_of

    draws = Draws(one.chain, wide, 0)
    names = [name_of(canonical(ways_of(draws.sample(k).graph()), 2)) for k in range(many)]
    assert one.kept.times == names.count(one.name)
    assert 0.1 * many < one.kept.times < 0.9 * many


@pytest.mark.parametrize(
    ("cells", "drive", "count"), [(1, STROKE, 1), (2, STROKE, 3), (2, FORCE, 3), (3, FORCE, 15)]
)
def test_possible_graphs_are_listed_where_forces_alone_tell_them(cells, drive, count):
    catalogue = possible(cells, drive)
    assert catalogue is not None and len(catalogue) == count


def test_no_list_of_possible_graphs_is_claimed_where_landings_tell_them():
    assert possible(3, STROKE) is None and possible(5, FORCE) is None


def test_a_space_is_proved_only_where_every_cell_is():
    chain = sw.Chain([CELL] * 2)
    assert proved_space(chain, axes_of(2))
    assert not proved_space(chain, axes_of(2, low=-0.012))
    assert not proved_space(chain, (Axis("1.lever", 0.012, 0.016),))
    assert not proved_space(chain, (Axis("1.stiffness", -1.0, 28.5),))


@given(st.permutations(range(3)), st.integers(0, 10))
def test_a_canonical_text_does_not_know_which_cell_is_which(order, seed):
    states = [f"{k:03b}" for k in range(8)]
    rng = np.random.default_rng(seed)
    ways = [
        (states[a], states[b], 1 if up else -1, bool(snaps))
        for a, b, up, snaps in rng.integers([8, 8, 2, 2], size=(12, 4))
    ]
    moved = [
        ("".join(a[k] for k in order), "".join(b[k] for k in order), up, snaps)
        for a, b, up, snaps in ways
    ]
    assert canonical(ways, 3) == canonical(moved, 3)


def test_canonical_texts_of_other_graphs_differ():
    texts = {
        canonical([("00", "10", 1, True), (a, b, 1, False)], 2)
        for a, b in permutations(["00", "10", "01", "11"], 2)
    }
    assert len(texts) == 12


def test_graph_classes_are_found_by_what_they_do(stores):
    _, catalogue = stores(3, 2_000)
    everything = set(catalogue.graph_classes)
    remembering, forgetting = (
        set(find(catalogue, "remembers")),
        set(find(catalogue, "not remembers")),
    )
    assert remembering | forgetting == everything and not remembering & forgetting
    assert set(find(catalogue, "forgets")) == forgetting
    counting = find(catalogue, "counts to one by hand")
    assert counting and all(one.counts_by_hand >= 1 for one in counting)
    assert set(find(catalogue, "counts by hand")) == set(counting)
    assert find(catalogue, "counts to 9") == ()
    one = catalogue.graph_classes[0]
    assert find(catalogue, one.name) == (one,) and one in find(catalogue, one.cycle)
    both = find(catalogue, "Reaches every state and not remembers, has loops")
    assert all(m.reached == m.states and not m.remembers and m.sub_loops for m in both)
    sure = find(catalogue, "snaps", 0.95)
    assert sure and all(m.kept.low >= 0.95 for m in sure)
    assert [m.kept.estimate for m in sure] == sorted((m.kept.estimate for m in sure), reverse=True)


def test_a_phrase_that_means_nothing_is_answered_with_the_nearest(stores):
    _, catalogue = stores(2, 20_000)
    with refuses(sw.InputError, "'remember'", "'remembers'"):
        find(catalogue, "remember")
    with pytest.raises(sw.InputError, match="00>10>11>01>00"):
        find(catalogue, "counts to nothing")


def test_the_status_of_an_atlas_is_a_few_numbers(stores):
    from stepwell.studies import status

    study, _ = stores(2, 20_000)
    record = account(status(study)).record
    assert record["outcomes"] == [] and record["finished"]
    largest = {one["column"]: one["most"] for one in record["numbers"]}
    assert largest == {"told": 20_000, "not_proved": 0, "ties": 0, "wakes": 0}


def test_the_atlas_that_comes_with_stepwell_is_what_its_command_makes(tmp_path):
    """A block of it, taken away and computed again, has the same bytes."""
    from stepwell.studies import THREE

    shutil.copytree(THREE, tmp_path / "three.zarr")
    for name in opened(THREE).columns:
        (tmp_path / "three.zarr" / name / "c" / "1").unlink()
    assert resumed(opened(tmp_path / "three.zarr"), workers=0).finished
    assert bytes_of(tmp_path / "three.zarr") == bytes_of(THREE)


def test_graph_classes_are_drawn_with_their_states_in_one_place_and_their_own_way_back(stores):
    _, catalogue = stores(3, 2_000)
    figure = catalogue.plot(most=5)
    assert untidy(figure, 7.0) == []
    *panels, shares, yields = figure.axes
    places = set()
    for ax, graph_class in zip(panels, catalogue.graph_classes[:5], strict=True):
        states = {text.get_text(): text for text in ax.texts if text.get_text().isdigit()}
        places |= {(name, text.get_position()) for name, text in states.items()}
        bold = {name for name, text in states.items() if text.get_fontweight() == "bold"}
        assert bold == set(graph_class.cycle.split(">")), graph_class
    assert len(places) == 8
    for ax, attribute in ((shares, "fraction"), (yields, "kept")):
        (line,) = (line for line in ax.lines if line.get_gid() == "classes")
        wanted = [100.0 * getattr(one, attribute).estimate for one in catalogue.graph_classes]
        assert list(line.get_ydata()) == pytest.approx(wanted)
    with pytest.raises(ValueError, match="5 cells"):
        figures.graph_classes(replace(catalogue, chain=sw.Chain([CELL] * 5)))


def test_an_atlas_fills_a_folder_of_which_the_page_tells_all_graph_classes(stores, tmp_path):
    _, catalogue = stores(2, 20_000)
    names = reports.write(catalogue, tmp_path)
    assert set(names) == {"atlas.json", "graph_classes.png", "graph_classes.svg", "report.html"}
    page = (tmp_path / "report.html").read_text("utf-8")
    assert "3 graphs and 4 cycles" in page
    assert all(one.name in page for one in catalogue.graph_classes)
    record = json.loads((tmp_path / "atlas.json").read_text("utf-8"))
    assert record["graph_classes"] == account(catalogue).record["graph_classes"]


def chain_at(chain: sw.Chain, name: str, value: float) -> sw.Chain:
    catalogue = changed(chain, [name], [value])
    assert isinstance(catalogue, sw.Chain)
    return catalogue


@pytest.mark.parametrize(("cells", "designs", "low"), [(2, 20_000, -0.008), (3, 2_000, 0.0)])
def test_the_engine_finds_another_graph_on_either_side_of_a_boundary(stores, cells, designs, low):
    study, catalogue = stores(cells, designs, low=low)
    near = class_boundaries(study, catalogue)
    known = {one.name: one for one in catalogue.graph_classes}
    assert {one.graph_class for one in near} == known.keys()
    span = {axis.name: (axis.low, axis.high) for axis in catalogue.axes}
    for one in near[:: 1 if cells == 2 else 17]:
        chain = known[one.graph_class].chain
        first, last = span[one.parameter]
        start = float(parameter(chain, one.parameter).value(chain))  # type: ignore[arg-type]
        assert one.value == pytest.approx(start + one.step, rel=1e-12)
        assert first <= one.value <= last
        wanted, past = [one.graph_class, one.beyond], np.sign(one.step) * (last - first)
        assert one.graph_class != one.beyond

        def names(before, behind, one=one, chain=chain, past=past):
            return [
                name_of(canonical(ways_of(chain_at(chain, one.parameter, x).graph()), cells))
                for x in (one.value - before * past, one.value + behind * past)
            ]

        # Where a snap lands by a flow of three cells, the two know that to some micrometres.
        assert names(4e-5, 0.0) == wanted or names(5e-4, 5e-4) == wanted


def test_a_graph_class_that_is_passed_over_is_looked_for_by_brute_force(stores):
    # Shares nothing with the search but the closed form: the first change on 4000 places a way.
    study, catalogue = stores(2, 20_000)
    near = {
        (one.graph_class, one.parameter, one.step > 0): one
        for one in class_boundaries(study, catalogue)
    }
    names, places = [axis.name for axis in catalogue.axes], 4000
    numbers = packed(catalogue.chain, names)
    for graph_class in catalogue.graph_classes:
        (start,) = study.designs.space.points(graph_class.design, graph_class.design + 1)
        for k, axis in enumerate(catalogue.axes):
            for end in (axis.low, axis.high):
                points = np.tile(start, (places, 1))
                points[:, k] = np.linspace(start[k], end, places)
                key, _, _, verdict = classed(numbers.at(points), STROKE)
                other = np.flatnonzero((key != key[0]) & (verdict == DECIDED))
                one = near.get((graph_class.name, axis.name, end > start[k]))
                assert (one is None) == (not len(other))
                if one is not None:
                    step = abs(end - start[k]) / (places - 1)
                    assert abs(one.value - points[other[0], k]) <= step


def test_what_was_not_seen_is_bounded_by_what_the_second_half_adds(tmp_path):
    chain, axes = sw.Chain([CELL] * 3), axes_of(3)
    each = examples(10, full=30)
    blocks = IndependentBlocks(axes, each, 5)
    study = sweep(chain, "atlas", blocks, tmp_path / "a", chunk=1, workers=0).study
    catalogue = charted(study, samples=1, checks=0)
    names, space = [], blocks.space
    for number in range(5 * each):
        (point,) = space.points(number, number + 1).tolist()
        made = changed(chain, [axis.name for axis in axes], point)
        assert isinstance(made, sw.Chain)
        names.append(canonical(ways_of(made.graph()), 3))
    first = set(names[: 2 * each])
    new = sum(name not in first for name in names[2 * each :])
    assert catalogue.unseen is not None
    assert 0 < new == catalogue.unseen.times
    assert catalogue.unseen.of == 3 * each == catalogue.closed_form - 2 * each
    assert new / (3 * each) < catalogue.unseen.high < 1
    one = sweep(
        chain, "atlas", IndependentBlocks(axes, each, 1), tmp_path / "b", chunk=1, workers=0
    ).study
    assert charted(one, samples=1, checks=0).unseen is None
