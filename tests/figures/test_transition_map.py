"""The map over two parameters: regions by names or letters, curves by numbers, all explained."""

import re

import numpy as np
import pytest
import xarray as xr

import stepwell as sw
from figures.drawn import collisions, lines, points, says, untidy
from stepwell import figures, files
from stepwell.design import parameter_boundaries, parameter_map
from stepwell.figures.common.style import INK, LOADING, PATHWAY, UNLOADING, pale
from stepwell.figures.map_parts import PLACES

X = ("outer.q.x", np.linspace(0.0, 0.020, 41))
Y = ("outer.q.y", np.linspace(-0.015, 0.015, 61))
PLACE = ("two.q.x", np.linspace(0.0, 0.020, 41)), ("two.q.y", np.linspace(-0.015, 0.015, 61))


@pytest.fixture(scope="module")
def pair():
    chain = files.preset("paper-forward")
    return parameter_map(chain, X, Y), parameter_boundaries(chain, X, Y, search=31)


@pytest.fixture(scope="module")
def shuffle():
    chain = files.preset("four-shuffle")
    return parameter_map(chain, *PLACE), parameter_boundaries(chain, *PLACE, search=31)


@pytest.fixture(scope="module")
def drawn_pair(pair):
    """The map of two cells with its boundaries, at which several tests look."""
    return figures.transition_map(*pair)


@pytest.fixture(scope="module")
def drawn_shuffle(shuffle):
    return figures.transition_map(*shuffle)


@pytest.fixture(scope="module")
def without_boundaries(shuffle):
    return figures.transition_map(shuffle[0])


def key(figure) -> dict[str, str]:
    """What the letters and numbers in the column beside the map mean, pathways by themselves."""
    texts = iter(text.get_text() for text in figure.axes[1].texts)
    meanings = {}
    for text in texts:
        # Each row is a letter, a number or nothing, and what it means.
        meaning = next(texts) if re.fullmatch(r"[A-Z]|[0-9]*", text) else text
        meanings[text if text else meaning] = meaning
    return meanings


def codes(dataset) -> dict[str, int]:
    notes = dataset["sequence"].attrs
    return dict(zip(notes["flag_meanings"].split(), notes["flag_values"].tolist(), strict=True))


@pytest.mark.slow
def test_letters_stand_in_the_region_of_their_sequence(shuffle, drawn_shuffle):
    dataset, figure = shuffle[0], drawn_shuffle
    meaning, code = key(figure), codes(dataset)
    seen = set()
    for text in figure.axes[0].texts:
        letter = text.get_text()
        if letter.isalpha():
            x, y = text.get_position()
            here = dataset.sequence.sel(x=x * 1e-3, y=y * 1e-3, method="nearest")
            assert int(here) == code[meaning[letter]]
            seen.add(letter)
    assert "A" in seen
    assert len(seen) >= 8


@pytest.mark.slow
def test_the_key_names_every_sequence_that_occurs_and_no_other(shuffle, without_boundaries):
    dataset, _ = shuffle
    meaning = key(without_boundaries)
    code = codes(dataset)
    occurring = {name for name, value in code.items() if np.any(dataset.sequence == value)}
    del meaning["two monostable"]
    assert set(meaning.values()) == occurring
    # The largest region comes first.
    sizes = [int(np.sum(dataset.sequence == code[meaning[letter]])) for letter in sorted(meaning)]
    assert sizes == sorted(sizes, reverse=True)


@pytest.mark.slow
def test_pathways_of_two_cells_are_called_by_their_name_where_they_are(pair):
    dataset, _ = pair
    figure = figures.transition_map(
        pair[0], pair[1], {"forward": (0.020, 0.0), "backward": (0.005, 0.0)}
    )
    meaning, code = key(figure), codes(dataset)
    assert "clockwise: 00>10>11>01>00" in meaning.values()
    assert "via 10: 00>10>11>10>00" in meaning.values()
    four = {p.label: code[p.value] for p in sw.Pathway if p is not sw.Pathway.OTHER}
    named = []
    for text in figure.axes[0].texts:
        name = text.get_text().replace("-\n", "")
        if name in four:
            x, y = text.get_position()
            here = dataset.sequence.sel(x=x * 1e-3, y=y * 1e-3, method="nearest")
            assert int(here) == four[name]
            named.append(name)
    assert sorted(named) == sorted(four)


@pytest.mark.slow
def test_every_boundary_is_drawn_in_the_colour_of_what_changes(pair, drawn_pair):
    (_, boundaries), figure = pair, drawn_pair
    drawn = lines(figure, "boundary") + lines(figure, "stability edge")
    assert len(drawn) == len(boundaries) == 6
    assert len(lines(figure, "stability edge")) == 2
    colours = {"LOADING_ORDER": LOADING, "UNLOADING_ORDER": UNLOADING, "BISTABLE": INK}
    for boundary in boundaries:
        (line,) = [
            line
            for line in drawn
            if len(points(line)) == len(boundary.points)
            and points(line) == pytest.approx(boundary.points * 1e3)
        ]
        assert line.get_color() == colours[boundary.kind.name]


@pytest.mark.slow
def test_curves_are_numbered_by_what_changes_across_them(drawn_pair):
    meaning = key(drawn_pair)
    assert meaning["1"] != meaning["2"]
    assert {meaning["1"], meaning["2"]} == {
        "inner and outer change order while loading",
        "inner and outer change order while unloading",
    }
    on_map = [t.get_text() for t in drawn_pair.axes[0].texts if t.get_gid() == "number"]
    assert sorted(on_map) == ["1", "1", "2", "2"]


@pytest.mark.slow
def test_axes_are_named_with_the_units_that_are_read(drawn_pair):
    (ax, _) = drawn_pair.axes
    assert ax.get_xlabel() == "$q_x$ of outer [mm]"
    assert ax.get_ylabel() == "$q_y$ of outer [mm]"
    assert (*ax.get_xlim(), *ax.get_ylim()) == pytest.approx((0, 20, -15, 15))
    box = ax.get_window_extent()
    assert box.height / box.width == pytest.approx(1.5, rel=0.02)


@pytest.mark.slow
def test_monostable_ground_is_hatched_and_explained(pair, drawn_pair):
    assert any(getattr(c, "hatches", [None])[0] for c in drawn_pair.axes[0].collections)
    assert {"outer monostable", "limit of bistability"} <= set(key(drawn_pair).values())
    bistable = figures.transition_map(pair[0].sel(y=slice(-0.004, 0.004)))
    assert not any(getattr(c, "hatches", [None])[0] for c in bistable.axes[0].collections)
    assert "outer monostable" not in key(bistable).values()


@pytest.mark.slow
def test_a_sequence_without_room_for_its_letter_is_in_the_key(pair):
    dataset = pair[0].copy(deep=True)
    other = dataset.sequence.attrs["flag_values"].max() + 1
    notes = dataset.sequence.attrs
    notes["flag_values"] = np.append(notes["flag_values"], other)
    notes["flag_meanings"] += " 00>11>00"
    dataset["sequence"][30, 20] = other
    assert key(figures.transition_map(dataset))["A"] == "00>11>00"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "label", "shown"),
    [
        ("outer.stiffness", (15.0, 45.0), "Stiffness of outer [N/m]", (15.0, 45.0)),
        ("outer.rest_length", (0.005, 0.012), "Rest length of outer [mm]", (5.0, 12.0)),
        ("outer.limit", (0.6, 0.8), "Angle limit of outer [deg]", (34.377, 45.837)),
        ("actuator_stiffness", (20.0, 200.0), "Actuator stiffness [N/m]", (20.0, 200.0)),
    ],
)
def test_other_parameters_have_their_own_units(name, values, label, shown):
    dataset = parameter_map(
        files.preset("paper-forward"), X, (name, np.linspace(values[0], values[1], 3))
    ).isel(x=slice(0, 3))
    (ax, _) = figures.transition_map(dataset).axes
    assert ax.get_ylabel() == label
    assert ax.get_ylim() == pytest.approx(shown, rel=1e-4)


@pytest.mark.slow
def test_geometric_values_give_a_logarithmic_axis():
    stiffness = ("actuator_stiffness", np.geomspace(20.0, 2000.0, 5))
    dataset = parameter_map(
        files.preset("paper-forward"), stiffness, ("outer.q.x", np.linspace(0.0, 0.020, 4))
    )
    (ax, _) = figures.transition_map(dataset).axes
    assert ax.get_xscale() == "log"
    assert ax.get_yscale() == "linear"


@pytest.mark.slow
def test_designs_stand_at_their_parameters(pair):
    designs = {"forward": (0.020, 0.0), "backward": (0.005, 0.0)}
    figure = figures.transition_map(pair[0], pair[1], designs)
    drawn = np.concatenate([points(line) for line in lines(figure, "design")])
    assert drawn == pytest.approx(np.array([(20.0, 0.0), (5.0, 0.0)]))
    assert set(designs) <= set(says(figure))
    assert collisions(figure) == []


@pytest.mark.slow
def test_names_of_designs_and_of_regions_are_not_read_as_one(pair):
    # Three of the paper's, all on the frame.
    at = {"(0, 0)": (0.0, 0.0), "(20, 0)": (0.020, 0.0), "(10, 15)": (0.010, 0.015)}
    figure = figures.transition_map(pair[0], pair[1], at)
    ax = figure.axes[0]
    shown = [text for text in ax.texts if text.get_text() and text.get_gid() != "number"]
    designs = [text.get_window_extent() for text in shown if text.get_text() in at]
    others = [text.get_window_extent() for text in shown if text.get_text() not in at]
    assert len(designs) == 3
    assert len(others) == 4
    point = figure.dpi / 72
    assert not any(a.padded(2.0 * point).overlaps(b) for a in designs for b in others)


@pytest.mark.slow
def test_neighbouring_regions_differ_in_colour(without_boundaries):
    mesh = without_boundaries.axes[0].collections[0]
    number = np.ma.asarray(mesh.get_array()).reshape(PLACES, PLACES).astype(int)
    colours = mesh.cmap(mesh.norm(number))
    for axis in (0, 1):
        changes = np.diff(number, axis=axis) != 0
        same = np.all(np.diff(colours, axis=axis) == 0, axis=-1)
        assert not np.any(changes & same)


@pytest.mark.slow
def test_places_without_a_mechanism_stay_white_and_are_explained(pair):
    dataset = pair[0].copy(deep=True)
    code = codes(dataset)
    dataset["sequence"][:, :5] = code["impossible"]
    figure = figures.transition_map(dataset)
    shown = np.ma.asarray(figure.axes[0].collections[0].get_array()).reshape(PLACES, PLACES)
    # Half-way between the last such node and the next one.
    edge = round(4.5 / 40 * PLACES)
    assert np.ma.getmaskarray(shown)[:, : edge - 1].all()
    assert not np.ma.getmaskarray(shown)[:, edge + 1 :].any()
    assert "no mechanism: the band's ends coincide" in says(figure)


@pytest.mark.slow
def test_regions_reach_to_their_exact_boundaries_however_few_nodes_there_are():
    chain = files.preset("paper-forward")
    few = ("outer.q.x", np.linspace(0.0, 0.020, 9)), ("outer.q.y", np.linspace(-0.015, 0.015, 11))
    many = tuple((name, np.linspace(ends[0], ends[-1], PLACES)) for name, ends in few)
    exact = parameter_map(chain, *many)
    dataset, borders = parameter_map(chain, *few), parameter_boundaries(chain, *few, search=31)

    def wrong(curves) -> float:
        figure = figures.transition_map(dataset, curves)
        mesh = figure.axes[0].collections[0]
        number = np.ma.asarray(mesh.get_array()).reshape(PLACES, PLACES).astype(int)
        shown = np.asarray(mesh.cmap(mesh.norm(number)))[..., :3]
        shade = {p.value: pale(PATHWAY[p.value]) for p in sw.Pathway if p.value in PATHWAY}
        names = {value: name for name, value in codes(exact).items()}
        wanted = np.array(
            [[shade[names[int(one)]] for one in row] for row in exact.sequence.values]
        )
        return float(np.mean(np.abs(shown - wanted).max(axis=-1) > 0.02))

    assert wrong(()) > 0.04
    assert wrong(borders) < 0.004


@pytest.mark.slow
def test_every_large_blank_region_is_named_where_it_is(pair):
    dataset = pair[0].copy(deep=True)
    code = codes(dataset)
    dataset["sequence"][:, :14] = code["impossible"]
    dataset["sequence"][:20, 24:] = code["unsolved"]
    texts = figures.transition_map(dataset).axes[0].texts
    at = {text.get_text().replace("\n", " "): text.get_position() for text in texts}
    assert at["no mechanism"][0] < 7.0
    assert at["no result"][0] > 12.0
    assert at["no result"][1] < -5.0


def test_names_lie_inside_the_frame_on_coarse_maps_too():
    chain = files.preset("paper-forward")
    axes = ("outer.q.x", np.linspace(0.0, 0.020, 7)), ("outer.rest_length", np.linspace(0, 0.02, 7))
    figure = figures.transition_map(parameter_map(chain, *axes))
    frame = figure.axes[0].get_window_extent()
    names = [text for text in figure.axes[0].texts if text.get_text()]
    assert names
    for text in names:
        box = text.get_window_extent()
        assert frame.y0 < box.y0
        assert box.y1 < frame.y1
        assert frame.x0 < box.x0
        assert box.x1 < frame.x1


@pytest.mark.slow
def test_words_stay_apart_and_on_the_page(pair, drawn_pair, drawn_shuffle):
    crossing = {"right on the crossing": (0.010, 0.0), "in a corner": (0.0, -0.015)}
    # Two columns for a long key, one for a short key, which stands below the map.
    crowded = figures.transition_map(pair[0], pair[1], crossing)
    for figure, wide in ((drawn_pair, 85.0), (drawn_shuffle, 180.0), (crowded, 85.0)):
        assert untidy(figure, 7.0) == []
        assert 25.4 * figure.get_size_inches()[0] == pytest.approx(wide)


@pytest.mark.slow
def test_a_map_read_back_from_a_file_looks_the_same(pair, tmp_path):
    dataset, boundaries = pair
    dataset.to_netcdf(tmp_path / "map.nc")
    with xr.open_dataset(tmp_path / "map.nc") as again:
        first = figures.svg(figures.transition_map(dataset, boundaries))
        assert figures.svg(figures.transition_map(again, boundaries)) == first


@pytest.mark.slow
def test_a_long_key_stands_beside_the_map_and_below_it():
    """Beside it alone it would leave half of the page empty."""
    cells = [
        sw.Cell(sw.Band((-0.010, 0.0), (0.004 + 0.0013 * k, -0.006 + 0.001 * (5 * k % 12))))
        for k in range(5)
    ]
    chain = sw.Chain(cells)
    place = ("2.q.x", np.linspace(0.0, 0.020, 15)), ("1.stiffness", np.linspace(15, 45, 15))
    figure = figures.transition_map(
        parameter_map(chain, *place), parameter_boundaries(chain, *place, search=15)
    )
    assert untidy(figure) == []
    ax, beside, below = figure.axes
    assert beside.get_position().x0 > ax.get_position().x1
    assert below.get_position().y1 < ax.get_position().y0
    rows = [text.get_text() for text in below.texts if not text.get_text().isdigit()]
    assert len(rows) > 5 and all("change order" in row for row in rows)
    assert not any("change order" in text.get_text() for text in beside.texts)
