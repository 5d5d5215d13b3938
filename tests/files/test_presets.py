"""The designs that come with the package do what their names and titles say."""

import re

import pytest

from facts import says
from stepwell.files import DesignError, dumps, loads, preset, preset_text, presets
from stepwell.mechanism import LIBRARY, Cell
from stepwell.sequences import Pathway

NAMES = tuple(presets())
ROBOTS = tuple(name for name in NAMES if name.startswith("robot-"))
# What each name promises.
PATHWAYS = {
    "paper-forward": Pathway.CLOCKWISE,
    "paper-forward-double": Pathway.CLOCKWISE,
    "paper-outer-15": Pathway.CLOCKWISE,
    "paper-backward": Pathway.COUNTERCLOCKWISE,
    "paper-counterclockwise": Pathway.COUNTERCLOCKWISE,
    "paper-via-01": Pathway.VIA_01,
    "paper-via-10": Pathway.VIA_10,
    "antenna-leg": Pathway.CLOCKWISE,
    "compliant-actuator": Pathway.CLOCKWISE,
    "foot-weight": Pathway.CLOCKWISE,
    "force-control": Pathway.CLOCKWISE,
    "friction": Pathway.CLOCKWISE,
    "rubber": Pathway.CLOCKWISE,
    "slack": Pathway.COUNTERCLOCKWISE,
    "von-mises-truss": Pathway.COUNTERCLOCKWISE,
    "kresling": Pathway.CLOCKWISE,
    "balloon": Pathway.VIA_10,
    "dome": Pathway.VIA_10,
}
SEQUENCES = {
    "three-wave": "000>100>110>111>011>001>000",
    "trilinear": "000>100>110>111>011>001>000",
    "curved-beam": "000>100>110>111>011>001>000",
    "hopper": "00>01>11>10>00",
    "hopper-forward": "00>01>11>10>00",
    "three-stack": "000>100>110>111>110>100>000",
    "four-shuffle": "0000>1000>1100>1110>1111>1101>0101>0100>0000",
}


def unit_cell(qx: float, qy: float) -> Cell:
    (cell,) = preset(f"paper-cell-{qx}-{qy}".replace("--", "-m")).cells
    return cell


MACHINES = ("finger-selector", "combination-lock", "used-before", "countdown", "metachronal-wave")
# What these promise is held in tests/sequences/test_machines.py.
STATE_MACHINES = ("second-touch", "two-point-gate", "lock-with-alarm", "stiffness-gripper")
# And what these promise, in tests/docs/test_more_bodies.py.
MORE_BODIES = ("robot-four-legs", "robot-six-legs", "two-finger-gripper")


def test_every_preset_is_promised_something_here():
    cells = {name for name in NAMES if name.startswith("paper-cell-")}
    chains = cells | {"paper-identical"} | PATHWAYS.keys() | SEQUENCES.keys()
    # What the machines promise is held in tests/design/test_gallery.py.
    promised = chains | set(ROBOTS) | set(MACHINES)
    promised |= {*STATE_MACHINES, *MORE_BODIES}
    assert set(NAMES) == promised, "say above what the preset promises"


@pytest.mark.parametrize("name", PATHWAYS)
def test_two_cells_take_the_pathway_their_name_promises(name):
    cycle = preset(name).cycle()
    assert cycle.pathway is PATHWAYS[name]
    assert not cycle.degenerate


@pytest.mark.parametrize("name", PATHWAYS)
def test_the_title_says_the_pathway(name):
    said = presets()[name]
    label = PATHWAYS[name].label
    assert (label in said) if "via" not in label else (f"through {label[-2:]}" in said)


@pytest.mark.parametrize("name", SEQUENCES)
def test_longer_chains_take_the_sequence_their_title_promises(name):
    cycle = preset(name).cycle()
    assert cycle.sequence == SEQUENCES[name]
    assert not cycle.degenerate


def test_every_element_of_the_library_has_a_preset_of_its_name():
    for name, entry in LIBRARY.items():
        key = name.replace("-", "_")
        assert preset_text(name).count(f"\n{key} = {{") == len(preset(name).cells)
        assert all(cell.measure is entry.make().measure for cell in preset(name).cells)


def test_balloons_are_the_ones_whose_thin_one_gives_back():
    snap = preset("balloon").cycle().snaps[0]
    before, after = snap.before, snap.after
    assert after[0] < before[0]
    assert after[1] > before[1]


def test_titles_that_promise_no_snap_keep_it():
    quiet = [name for name, title in presets().items() if "no snap" in title]
    assert set(quiet) == {"paper-via-01", "paper-via-10", "three-stack"}
    for name in quiet:
        assert preset(name).cycle().snaps == ()


def test_identical_cells_are_reported_as_a_tie():
    assert preset("paper-identical").cycle().degenerate


def test_the_six_unit_cells_have_the_forces_of_the_paper():
    # Kamp et al. 2024, Fig. 1E at its two ends: F0/(kr) and F1/(kr).
    forces = {
        (10, 0): (0.967, -0.967),
        (20, 0): (1.607, -1.607),
        (0, 0): (0.391, -0.391),
        (10, -15): (0.263, -1.661),
        (20, 15): (2.393, -0.836),
        (0, -15): (-0.243, -0.910),
    }
    for q, expected in forces.items():
        cell = unit_cell(*q)
        scale = cell.bands[0].stiffness * cell.lever
        assert (cell.force_0 / scale, cell.force_1 / scale) == pytest.approx(expected, abs=5e-4)


def test_the_title_of_a_unit_cell_says_its_anchor_and_whether_it_is_bistable():
    for name in (name for name in NAMES if name.startswith("paper-cell-")):
        (cell,) = preset(name).cells
        qx, qy = (round(x * 1e3) for x in cell.bands[0].q)
        assert f"q = ({qx}, {qy}) mm" in presets()[name]
        assert ("bistable" in presets()[name]) == cell.is_bistable
        assert ("monostable" in presets()[name]) == (not cell.is_bistable)


def test_titles_say_which_state_is_deeper():
    for q in [(10, -15), (20, 15)]:
        cell = unit_cell(*q)
        deeper = 1 if cell.energy(cell.limit) < cell.energy(-cell.limit) else 0
        title = presets()[f"paper-cell-{q[0]}-{q[1]}".replace("--", "-m")]
        assert f"state {deeper} far deeper" in title


def test_a_spring_in_the_actuator_makes_larger_snaps_as_promised():
    stiff, soft = (preset(name).cycle() for name in ("paper-forward", "compliant-actuator"))
    assert len(soft.snaps) > len(stiff.snaps)
    assert max(snap.released for snap in soft.snaps) > max(snap.released for snap in stiff.snaps)


def test_under_force_control_every_switch_is_a_snap_as_promised():
    cycle = preset("force-control").cycle()
    assert cycle.switches == ()
    assert [snap.cells for snap in cycle.snaps] == [(0,), (1,), (0,), (1,)]


def test_two_bands_double_every_force_and_keep_the_sequence():
    one, two = preset("paper-forward").cycle(), preset("paper-forward-double").cycle()
    assert two.peak_force == pytest.approx(2 * one.peak_force, rel=1e-12)
    assert two.sequence == one.sequence


def test_the_slack_band_is_slack_where_its_title_says():
    band = (cell := preset("slack").cells[1]).bands[0]
    assert band.length(cell.limit, cell.lever) < band.rest_length
    assert band.length(-cell.limit, cell.lever) > band.rest_length


def test_the_rubber_has_the_tangent_stiffnesses_its_comment_names():
    band = preset("rubber").cells[0].bands[0]
    for extension, tangent in [(0.005, 47.0), (0.015, 22.5), (0.035, 65.0)]:
        length = band.rest_length + extension
        slope = (band.tension(length + 1e-6) - band.tension(length - 1e-6)) / 2e-6
        assert slope == pytest.approx(tangent, abs=0.5)


def test_the_foot_weighs_what_its_comment_says():
    # m g dh/ds of the apex of a V of 35 mm links, 40 mm apart in state 0 and 60 mm in state 1.
    load = preset("foot-weight").cells[1].load
    assert load is not None
    for travel, force in zip(load.travel, load.force, strict=True):
        half = (0.040 + travel) / 2
        assert force == pytest.approx(
            0.0066 * 9.81 * half / (2 * (0.035**2 - half**2) ** 0.5), abs=1e-4
        )


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_presets_are_files_a_newcomer_can_copy(name):
    text = preset_text(name)
    first, *_ = text.splitlines()
    assert first.startswith("# ")
    assert re.search(r"Kamp et al\. 2024|Not in", text)
    found = preset(name)
    assert presets()[name] == found.title
    assert max(map(len, text.splitlines())) <= 100
    assert loads(dumps(found)).subject == found


def test_the_papers_designs_come_first_and_the_robots_last():
    def turn(name: str) -> int:
        return 2 if name in ROBOTS else not name.startswith("paper-")

    assert tuple(sorted(NAMES, key=lambda name: (turn(name), name))) == NAMES


def test_a_wrong_name_is_answered_with_the_nearest():
    with pytest.raises(DesignError) as caught:
        preset("paper-foward")
    says(str(caught.value), "paper-foward: ", "no such design", "Did you mean", "paper-forward?")
