"""Reading and writing robots: what their keys mean, what a wrong file is answered with."""

import math
from dataclasses import fields, replace

import pytest
from hypothesis import assume, given, strategies as st

from facts import says
from stepwell.files import DesignError, dumps, load, loads, preset, preset_text, presets, save
from stepwell.files.schema.keys import field_of
from stepwell.files.schema.robot import SOURCES, TABLES
from stepwell.mechanism import Band, Cell, Chain, Load
from stepwell.robot import Antenna, Blocks, Body, Drive, Floor, Foot, Leg, Profile, Robot

ROBOTS = [name for name in presets() if name.startswith("robot-")]
CELLS = """
[[chain.cell]]
p_mm = [-10, 0]
q_mm = [10, 0]
[[chain.cell]]
p_mm = [-10, 0]
q_mm = [20, 0]
"""
LEGS = """
[[leg]]
name = "left"
at_mm = [8, 57.5]
[[leg]]
name = "right"
at_mm = [8, -57.5]
"""
ANTENNA = """
[[antenna]]
name = "left"
pivot_mm = [110, -25]
length_mm = 130
angle_deg = 60
leg = "right"
moves_mm = [-10, 0]
"""
LEAST = CELLS + LEGS


def pair(qx: float, **chain) -> Chain:
    inner = Cell(Band((-0.01, 0), (0.01, 0)))
    return Chain((inner, inner.with_anchors(q=(qx, 0.0))), **chain)


def answer(text: str) -> str:
    with pytest.raises(DesignError) as caught:
        loads(text, "robot.toml")
    return str(caught.value)


def test_what_a_file_leaves_out_is_the_default():
    legs = (Leg("left", pair(0.02), (0.008, 0.0575)), Leg("right", pair(0.02), (0.008, -0.0575)))
    assert loads(LEAST).subject == Robot(legs)


def test_every_key_is_read_in_its_unit():
    text = f"""
    title = "Everything"
    [body]
    mass_g = 300
    centre_mm = [20, 1, 10]
    supports_mm = [[-60, 0], [40, 50], [40, -50]]
    length_mm = 110
    width_mm = 75
    wall_friction = 0.3
    [foot]
    link_mm = 36
    span_mm = 41
    mass_g = 7
    below_mm = 0.5
    radius_mm = 3
    [blocks]
    mass_g = 5
    carriage_g = 11
    damping_N_s_per_m = 0.7
    width_mm = 25
    length_mm = 18
    outer_g = 4
    rail_friction_N = 0.02
    [floor]
    drag_N = 0.79
    foot_friction = 0.6
    gravity_m_per_s2 = 9.8
    [drive]
    stroke_mm = 38
    period_s = 3
    profile = "sine"
    stiffness_N_per_m = 1500
    speed_mm_per_s = 60
    {LEAST}
    [[antenna]]
    name = "left"
    pivot_mm = [110, -25]
    length_mm = 130
    angle_deg = 60
    leg = "right"
    cell = "inner"
    moves_mm = [-10, 1]
    swing_deg = 45
    hook_mm = 12
    hook_deg = 90
    mass_g = 4
    damping_N_m_s_per_rad = 3e-4
    friction = 0.2
    connected = false
    [source]
    paper = ["chain", "foot.link_mm"]
    "authors' notes" = ["leg.left.at_mm[0]"]
    """
    legs = (Leg("left", pair(0.02), (0.008, 0.0575)), Leg("right", pair(0.02), (0.008, -0.0575)))
    antenna = Antenna(
        "left", (0.11, -0.025), 0.13, 1.0471975511965977462, "right", (-0.01, 0.001),
        cell="inner", swing=math.pi / 4, hook=0.012, hook_angle=math.pi / 2, mass=0.004,
        damping=3e-4, friction=0.2, connected=False,
    )  # fmt: skip
    assert loads(text).subject == Robot(
        legs,
        Body(0.3, (0.02, 0.001, 0.01), ((-0.06, 0), (0.04, 0.05), (0.04, -0.05)), 0.11, 0.075, 0.3),
        Foot(0.036, 0.041, 0.007, 0.0005, 0.003),
        Blocks(0.005, 0.011, 0.7, 0.025, 0.018, 0.004, 0.02),
        Floor(0.79, 0.6, 9.8),
        Drive(0.038, 3.0, Profile.SINE, 1500.0, 0.060),
        (antenna,),
        "Everything",
        {"chain": "paper", "foot.link_mm": "paper", "leg.left.at_mm[0]": "authors' notes"},
    )


@pytest.mark.parametrize(
    ("table", "value"),
    [
        ("body", Body),
        ("foot", Foot),
        ("blocks", Blocks),
        ("floor", Floor),
        ("drive", Drive),
        ("leg", Leg),
        ("antenna", Antenna),
    ],
)
def test_a_file_can_say_all_that_a_robot_is_made_of(table, value):
    assert {field_of(key) for key in TABLES[table].names()} == {one.name for one in fields(value)}


def test_a_leg_may_have_cells_of_its_own_and_takes_the_rest_from_the_chain():
    shared = "[chain]\nlever_mm = 15\nband = { stiffness_N_per_m = 30, rest_length_mm = 8 }\n"
    own = "\n[leg.chain]\nband = { rest_length_mm = 9 }\n" + CELLS.replace("[[chain", "[[leg.chain")
    left, right = loads(shared + CELLS + LEGS + own).robot.legs
    assert {cell.lever for cell in (*left.chain.levers, *right.chain.levers)} == {0.015}
    assert {cell.bands[0].stiffness for cell in right.chain.levers} == {30.0}
    assert left.chain.levers[0].bands[0].rest_length == 0.008
    assert right.chain.levers[0].bands[0].rest_length == 0.009


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            f"[foot]\nlink_mmm = 35\n{LEAST}",
            "robot.toml: foot.link_mmm: unknown key. Did you mean link_mm?",
        ),
        (
            f"[foot]\nlink_cm = 3.5\n{LEAST}",
            "robot.toml: foot.link_cm: unknown key. Did you mean link_mm?",
        ),
        (f"drag_N = 1\n{LEAST}", "robot.toml: drag_N: unknown key. It belongs in [floor]."),
        (
            f"[foot]\nlink_mm = -35\n{LEAST}",
            "robot.toml: foot.link_mm = -35: must be > 0 (1e-6 to 1e6).",
        ),
        (
            f"[body]\nsupports_mm = [[0, 0], [1, 1]]\n{LEAST}",
            "robot.toml: body.supports_mm = [[0, 0], [1, 1]]: must be three points or more from "
            "-1e6 to 1e6, in mm, as in [[-55, 0], [38, 45], [38, -45]].",
        ),
        (
            f"[body]\ncentre_mm = [0, 0]\n{LEAST}",
            "robot.toml: body.centre_mm = [0, 0]: must be three numbers from -1e6 to 1e6, in mm, "
            "as in [24, 0, 12].",
        ),
        (
            f'[drive]\nprofile = "sinus"\n{LEAST}',
            "robot.toml: drive.profile = \"sinus\": must be one of 'triangle', 'sine', "
            "'trapezoid'. Did you mean sine?",
        ),
        (
            f"[chain]\nactuator_stiffness_N_per_m = 40\n{LEAST}",
            "robot.toml: chain.actuator_stiffness_N_per_m: unknown key. A robot's legs share one "
            "actuator: stiffness_N_per_m in [drive].",
        ),
        (
            f"[foot]\nlink_mm = 35\n{CELLS}",
            "robot.toml: leg: is missing. A robot has two [[leg]] or more.",
        ),
        (LEAST.replace("[[leg]]", "[[legs]]"), "robot.toml: legs: unknown key. Did you mean leg?"),
        (
            LEAST.replace('name = "left"\n', ""),
            'robot.toml: leg[0].name: is missing. One line of text, as in "left".',
        ),
        (
            LEGS,
            "robot.toml: leg[0].chain: is missing. Give the cells of all legs under "
            "[[chain.cell]], or those of this leg under [[leg.chain.cell]].\n"
            "robot.toml: leg[1].chain: is missing. Give the cells of all legs under "
            "[[chain.cell]], or those of this leg under [[leg.chain.cell]].",
        ),
        (
            f"[chain]\ncell = []\n{LEGS}",
            "robot.toml: chain.cell = []: must hold two cells or more, inner first.",
        ),
        (
            f"[foot]\nspan_mm = 80\n{LEAST}",
            "robot.toml: foot: span = 80 mm: must be < 70 mm, the two links stretched out; use "
            "longer links.",
        ),
        # what only the whole robot can judge
        (
            LEAST.replace("-57.5", "57.5"),
            "robot.toml: legs 'left' and 'right' collide: their feet are 0 mm apart sideways and "
            "their blocks 30 mm wide; move one of them sideways.",
        ),
        (
            LEAST + ANTENNA.replace('"right"', '"rear"'),
            "robot.toml: antenna 'left': leg = 'rear': must be one of 'left', 'right'.",
        ),
        (
            LEAST + ANTENNA + 'cell = "iner"',
            "robot.toml: antenna 'left': leg 'right' has no cell 'iner': must be one of 'inner', "
            "'outer', or a number up to 2 (index 1 in Python).",
        ),
        (
            LEAST + ANTENNA + "cell = 3",
            "robot.toml: antenna 'left': leg 'right' has no cell 3 (index 2 in Python): must be "
            "one of 'inner', 'outer', or a number up to 2 (index 1 in Python).",
        ),
        (
            LEAST + ANTENNA + "cell = 1.5",
            "robot.toml: antenna[0].cell = 1.5: must be the name of a cell in quotes, or its "
            'number, 1 for the innermost, as in "inner" or 1.',
        ),
        (
            LEAST + ANTENNA.replace("length_mm = 130\n", ""),
            "robot.toml: antenna[0].length_mm: is missing. A length in mm, as in 130.",
        ),
        # sources
        (
            f'{LEAST}[source]\npapr = ["foot"]',
            "robot.toml: source.papr: unknown key. Did you mean paper?",
        ),
        (
            f'{LEAST}[source]\n"authors notes" = ["foot"]',
            'robot.toml: source."authors notes": unknown key. Did you mean authors\' notes?',
        ),
        (
            f"{LEAST}[source]\npaper = 3",
            "robot.toml: source.paper = 3: must be a list of keys in quotes, as in "
            '["chain", "foot.link_mm"].',
        ),
        (
            f'{LEAST}[source]\npaper = ["chain", "foot.link"]',
            'robot.toml: source.paper[1] = "foot.link": selects none of this robot\'s numbers. Did '
            "you mean foot.link_mm?",
        ),
        (
            f'{LEAST}[source]\nmeasured = ["leg.lft.at_mm[0]"]',
            'robot.toml: source.measured[0] = "leg.lft.at_mm[0]": selects none of this robot\'s '
            "numbers. Did you mean leg.left.at_mm[0]?",
        ),
        (
            f'{LEAST}[source]\npaper = ["chain"]\nassumed = ["leg.*.chain"]',
            'robot.toml: source.assumed[0] = "leg.*.chain": paper lists it too; keep one of them.',
        ),
    ],
)
def test_the_message_names_the_place_the_value_and_the_remedy(text, message):
    assert answer(text) == message


def test_what_is_wrong_with_a_chain_that_both_legs_have_is_said_once():
    folded = CELLS.replace("[10, 0]", "[-24.142135623730951, 0]")
    band = "band = { rest_length_mm = 5, two_sided = true }"
    (line,) = answer(f"[chain]\n{band}\n{folded}{LEGS}").splitlines()
    says(line, "robot.toml: chain.cell[0]: ", "band", "q - p", "-14.14", "mm")


@pytest.mark.slow
def test_every_misspelt_key_of_a_robot_is_recognised():
    places = {"": "", "antenna": LEAST + ANTENNA, "leg": LEAST, "source": f"{LEAST}[source]\n"}
    for table in ("", "chain", "body", "foot", "blocks", "floor", "drive", "leg", "antenna"):
        for key in TABLES[table].names():
            near = key + key[-1]
            place = places.get(table, f"[{table}]\n")
            text = f"{place}{near} = 1\n" + ("" if place.startswith(LEAST) else LEAST)
            says(answer(text).splitlines(), f"{near}: unknown key", f"{key}?")


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_of_the_package_survives_its_file(name):
    robot = preset(name)
    assert isinstance(robot, Robot)
    assert loads(dumps(robot)).subject == robot
    assert dumps(loads(dumps(robot)).subject) == dumps(robot)


def near(value: float) -> st.SearchStrategy[float]:
    return st.floats(0.97 * value, 1.03 * value) if value > 0 else st.just(value)


@st.composite
def robots(draw) -> Robot:
    """Robots in the neighbourhood of the defaults, every number drawn."""
    text = st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"]), max_size=6)
    lever, limit = draw(near(0.0142)), draw(near(math.pi / 4))
    names = draw(st.lists(text, min_size=2, max_size=2, unique=True))
    cells = st.builds(
        lambda p, q, k, rest, friction, name, load, mobility: Cell(
            Band((-p, 0.0), (q, 0.001), k, rest), lever, limit, load, friction, name,
            mobility=mobility,
        ),
        near(0.01), near(0.015), near(30.0), near(0.01), st.just(0.0) | near(0.01), text,
        st.none() | near(0.02).map(Load.constant), st.just(1.0) | near(2.0),
    )  # fmt: skip
    chains = [Chain(draw(st.tuples(cells, cells)), title=draw(text)) for _ in names]
    if draw(st.booleans()):
        chains[1] = chains[0]
    sides = [(draw(near(0.008)), sign * draw(near(0.0575))) for sign in (1, -1)]
    legs = [Leg(n, c, at) for n, c, at in zip(names, chains, sides, strict=True)]
    body = Body(draw(near(0.26)), (draw(near(0.024)), -draw(near(1e-3)), draw(near(0.012))))
    antennas = [
        Antenna(
            draw(text), (draw(near(0.11)), -draw(near(0.025))), draw(near(0.13)),
            draw(st.floats(0.1, 3.0) | st.floats(-3.0, -0.1)), names[0], (-draw(near(0.004)), 0.0),
            cell=draw(st.integers(0, 1)), swing=draw(near(1.2)), hook=draw(near(0.01)),
            hook_angle=draw(st.floats(-3.0, 3.0)), connected=draw(st.booleans()),
        )
        for _ in range(draw(st.integers(0, 1)))
    ]  # fmt: skip
    paths = ["chain", "foot.link_mm", "leg.*.at_mm", "body", "chain.band.stiffness_N_per_m"]
    said = draw(st.dictionaries(st.sampled_from(paths), st.sampled_from(SOURCES)))
    try:
        return Robot(
            legs,
            body,
            Foot(draw(near(0.035)), draw(near(0.04)), draw(near(0.0066)), draw(near(0.0009))),
            Blocks(
                draw(near(0.006)),
                draw(near(0.01)),
                draw(near(0.6)),
                outer=draw(st.none() | near(0.007)),
                rail_friction=draw(st.just(0.0) | near(0.02)),
            ),
            Floor(draw(near(0.39)), draw(near(0.55)), draw(st.just(0.0) | near(9.81))),
            Drive(
                draw(near(0.039)),
                draw(near(2.0)),
                draw(st.sampled_from(Profile)),
                speed=draw(st.just(math.inf) | near(0.1)),
            ),
            antennas,
            draw(text),
            said,
        )
    except ValueError:  # a robot that cannot stand
        assume(False)
        raise


@pytest.mark.slow
@given(robots())
def test_a_robot_survives_its_file_to_the_last_bit(robot):
    again = loads(dumps(robot)).robot
    assert again == robot
    assert repr(again.legs) == repr(robot.legs)
    assert dumps(again) == dumps(robot)


def test_a_robot_is_written_as_a_person_would_write_it():
    text = dumps(preset("robot-forward"))
    assert text.count("[[chain.cell]]") == 2
    assert "[[leg.chain" not in text
    assert 'profile = "triangle"' in text
    assert "supports_mm = [[-55, 0], [38, 45], [38, -45]]" in text
    assert dumps(preset("robot-left")).count("[[leg.chain.cell]]") == 4


def test_what_no_file_may_hold_is_refused_before_anything_is_written(tmp_path):
    robot = preset("robot-forward")
    wrong = [
        (replace(robot, title="two\nlines"), "title"),
        (replace(robot, sources={"foot.lnk_mm": "paper"}), "Did you mean foot.link_mm"),
        (replace(robot, sources={"foot.link_mm": "hearsay"}), "hearsay: unknown key"),
    ]
    for robot, said in wrong:
        with pytest.raises(DesignError, match=said):
            save(robot, tmp_path / "robot.toml")
    assert list(tmp_path.iterdir()) == []


def test_sources_of_removed_antennas_are_ignored():
    bare = replace(preset("robot-antennas"), antennas=())
    assert loads(dumps(bare)).subject == bare


def test_load_and_save_take_robots_too(tmp_path):
    robot = preset("robot-right")
    save(robot, tmp_path / "robot.toml")
    assert load(tmp_path / "robot.toml").subject == load(tmp_path / "robot.toml").robot == robot
    assert load("preset:robot-right").subject == robot


def test_who_needs_a_chain_or_a_robot_is_reported_in_one_line_when_it_is_the_other():
    with pytest.raises(DesignError) as caught:
        _ = load("preset:robot-forward").chain
    (line,) = str(caught.value).splitlines()
    says(
        line,
        "preset:robot-forward: ",
        "a robot",
        "a chain",
        "show preset:robot-forward --full`",
        "`stepwell walk preset:robot-forward`",
    )
    with pytest.raises(DesignError) as caught:
        _ = load("preset:paper-forward").robot
    (line,) = str(caught.value).splitlines()
    says(line, "preset:paper-forward: ", "a chain", "a robot", "[[leg]]")
    says(line, "`stepwell new robot.toml", "--preset robot-forward`", "docs/how-to/robots.md")
    assert loads(LEAST).robot == loads(LEAST).subject
    assert loads(CELLS).chain == loads(CELLS).subject


def test_the_walking_robots_of_the_package_have_the_papers_anchors():
    # Kamp et al. 2024, Fig. 3: only q of the outer cells differs, and k = 30 N/m, l0 = 10 mm.
    outer = {
        "robot-forward": (20, 20),
        "robot-backward": (5, 5),
        "robot-left": (5, 20),
        "robot-right": (20, 5),
        "robot-15": (15, 15),
    }
    for name, (left, right) in outer.items():
        robot = preset(name)
        q = [robot.leg(side).chain.cells[1].bands[0].q for side in ("left", "right")]
        assert q == [(left / 1e3, 0.0), (right / 1e3, 0.0)]
        expected = {"left": left, "right": right}
        for leg in robot.legs:
            inner, last = (cell.bands[0] for cell in leg.chain.cells)
            assert (inner.p, inner.q, last.p) == ((-0.01, 0.0), (0.01, 0.0), (-0.01, 0.0))
            assert {(b.stiffness, b.rest_length) for b in (inner, last)} == {(30.0, 0.01)}
            # Forward is clockwise, backward counterclockwise (Kamp et al. 2024, Fig. 2).
            way = leg.chain.cycle().pathway.name
            assert way == ("COUNTERCLOCKWISE" if expected[leg.name] == 5 else "CLOCKWISE")


def test_all_the_papers_robots_share_one_set_of_assumed_numbers():
    first, *others = (preset(name) for name in ROBOTS if "legs" not in name)
    for name in ("body", "foot", "blocks", "floor", "drive"):
        assert all(getattr(other, name) == getattr(first, name) for other in others)


def test_an_antenna_of_the_paper_pushes_the_inner_anchor_of_the_opposite_leg_to_11_mm():
    # Kamp et al. 2024, Fig. 4: p_in from (-7, 0) to about (-11, 0) mm, opposite side.
    robot = preset("robot-antennas")
    for antenna in robot.antennas:
        leg = robot.leg(antenna.leg)
        assert leg.side == -antenna.side
        pressed = robot.pressed({antenna.name: antenna.swing}).leg(antenna.leg)
        assert leg.chain.cells[0].bands[0].p == (-0.007, 0.0)
        assert pressed.chain.cells[0].bands[0].p == pytest.approx((-0.011, 0.0))


def test_the_robot_with_the_papers_antennas_has_two_inner_bands():
    # The paper gives no number; 47 N/m is one band.
    for leg in preset("robot-antennas").legs:
        inner, outer = (cell.bands[0] for cell in leg.chain.cells)
        assert (inner.stiffness, outer.stiffness) == (94.0, 47.0)
        assert (inner.q, outer.p, outer.q) == ((0.010, 0.0), (-0.010, 0.0), (0.020, 0.0))


def test_the_explorer_differs_from_the_papers_robot_in_what_its_comment_says():
    paper, ours = preset("robot-antennas"), preset("robot-explorer")
    assert ours.foot == paper.foot
    assert [leg.chain.cells[0].bands[0].stiffness for leg in ours.legs] == [1.25 * 47.0] * 2
    assert [leg.chain.cells[1].bands[0].q for leg in ours.legs] == [(0.014, 0.0)] * 2
    assert [leg.chain.cells[0].bands[0].p[0] for leg in ours.legs] == [-0.007, -0.0078]
    moved = tuple(replace(one, moves=(-0.01, 0.0), swing=1.2) for one in paper.antennas)
    assert ours.antennas == moved
    # The anchor goes as far for the same swing; only the stop is another.
    assert ours.antennas[0].gear == pytest.approx(paper.antennas[0].gear, rel=1e-3)
    assert "0.8 mm further in" in preset_text("robot-explorer")
