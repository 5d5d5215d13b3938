"""The table [program] of a design file: read, refused, written, kept, played."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from facts import refuses, says
from stepwell.files import (
    DesignError,
    WrittenProgram,
    dumps,
    load,
    loads,
    preset,
    preset_text,
    presets,
    save,
    with_program,
)
from stepwell.mechanism import Chain
from stepwell.sequences import Program

WAVE = preset_text("three-wave")
TABLE = '[program]\nstart = "000"\nturning_points_mm = [0, 45, 20]\nends = "010"\n'
CHAINS = [name for name in presets() if not name.startswith("robot-")]


def answer(table: str, text: str = WAVE) -> str:
    with pytest.raises(DesignError) as caught:
        loads(f"{text}\n{table}", "wave.toml")
    with pytest.raises(DesignError) as again:
        loads(f"{text}\n{table}", "wave.toml")
    assert str(again.value) == str(caught.value)
    return str(caught.value)


def test_a_program_is_read_in_si():
    program = loads(f"{WAVE}\n{TABLE}").program
    assert program == WrittenProgram("000", (0.0, 0.045, 0.020), "010")


def test_start_is_all_at_0_and_ends_is_open_by_default():
    program = loads(f"{WAVE}\n[program]\nturning_points_mm = [0, 60, 0]").program
    assert program == WrittenProgram("000", (0.0, 0.060, 0.0), None)


def test_a_file_without_the_table_has_no_program(tmp_path):
    (tmp_path / "wave.toml").write_text(WAVE, "utf-8")
    assert load(tmp_path / "wave.toml").program is None


def test_the_chain_is_the_same_with_and_without_a_program():
    assert loads(f"{WAVE}\n{TABLE}").subject == loads(WAVE).subject


def test_under_force_control_turning_points_are_forces():
    text = preset_text("force-control") + "\n[program]\nturning_points_N = [0, 0.7, -0.5]\n"
    assert loads(text).program == WrittenProgram("00", (0.0, 0.7, -0.5))


def test_a_compliant_actuator_turns_at_positions_past_the_stops():
    text = preset_text("compliant-actuator") + "\n[program]\nturning_points_mm = [0, 70, -20]\n"
    assert loads(text).program == WrittenProgram("00", (0.0, 0.070, -0.020))


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("[program]\nstart = '000'", "program.turning_points_mm: is missing: strokes in mm, as in"),
        (
            "[program]\nturning_point_mm = [0]",
            "program.turning_point_mm: unknown key. Did you mean turning_points_mm?",
        ),
        (
            "[program]\nturning_points_mm = [0]\nspeed = 3",
            "program.speed: unknown key. Known here: start, turning_points_mm, turning_points_N, "
            "turning_points_mL, turning_points_kPa, turning_points_deg, turning_points_mNm, "
            "ends, unusual.",
        ),
        (
            "[program]\nturning_points_mm = []",
            "program.turning_points_mm = []: must be a list of 1 or more numbers, as in [0, 45, "
            "20].",
        ),
        ("[program]\nturning_points_mm = 45", "program.turning_points_mm = 45: must be a list of"),
        (
            "[program]\nturning_points_mm = [0, '45']",
            'program.turning_points_mm = [0, "45"]: must be numbers from -1e6 to 1e6, as in',
        ),
        (
            "[program]\nturning_points_mm = [0, inf]",
            "program.turning_points_mm = [0, inf]: must be numbers from -1e6 to 1e6",
        ),
        (
            "[program]\nturning_points_mm = [0, 61]",
            "program.turning_points_mm[1] = 61: must be from 0 to 60, the sum of all travels.",
        ),
        (
            "[program]\nstart = '010'\nturning_points_mm = [0, 60]",
            "program.turning_points_mm[0] = 0: must be 20, the stroke at state 010.",
        ),
        (
            "[program]\nturning_points_mm = [0]\nturning_points_N = [0]",
            "program.turning_points_N = [0]: cannot be combined with turning_points_mm: keep one "
            "of them.",
        ),
        (
            "[program]\nturning_points_N = [0, 1]",
            "program.turning_points_N = [0, 1]: the actuator moves, so it must be "
            "turning_points_mm.",
        ),
        (
            "[program]\nturning_points_mm = [0]\nends = 10",
            "program.ends = 10: must be 0 or 1 for each cell in quotes, inner first, as in",
        ),
        (
            "[program]\nturning_points_mm = [0]\nends = '0-0'",
            'program.ends = "0-0": must be 0 or 1 for each cell in quotes',
        ),
        (
            "[program]\nturning_points_mm = [0]\nstart = '00'\nends = '0100'",
            'program.start = "00": must be 3 characters 0 or 1, one for each cell, inner first.',
        ),
    ],
)
def test_a_wrong_table_is_answered_with_place_value_and_what_is_allowed(table, message):
    assert answer(table).startswith(f"wave.toml: {message}")


def test_every_wrong_state_is_reported():
    text = answer("[program]\nturning_points_mm = [0]\nstart = '00'\nends = '0100'")
    assert len(text.splitlines()) == 2


def test_a_table_that_is_none_is_refused():
    with refuses(DesignError, "program = 3", "a table", "[program]"):
        loads(f"program = 3\n{WAVE}")


def test_force_control_refuses_strokes():
    text = answer("[program]\nturning_points_mm = [0]", preset_text("force-control"))
    says(text, "turning_points_mm", "force", "turning_points_N")


def test_a_robot_holds_no_program():
    robot = preset_text("robot-forward")
    with pytest.raises(DesignError, match="program: unknown key"):
        loads(f"{robot}\n{TABLE}")
    with refuses(DesignError, "a robot", "a chain"):
        _ = loads(robot).chain


def test_a_program_is_written_and_reads_back(tmp_path):
    chain, program = preset("three-wave"), WrittenProgram("000", (0.0, 0.0451, 0.020), "010")
    save(chain, tmp_path / "wave.toml", program=program)
    assert load(tmp_path / "wave.toml").program == program
    assert loads(dumps(chain, program=program)).subject == chain


def test_only_a_chain_is_written_with_a_program():
    with refuses(ValueError, "design file", "a chain"):
        dumps(preset("robot-forward"), program=WrittenProgram("00", (0.0,)))


@pytest.mark.slow
@given(st.sampled_from(CHAINS).map(preset), st.lists(st.floats(-1, 1), max_size=5), st.data())
def test_any_program_reads_back_to_the_last_bit(chain, points, data):
    state = st.text("01", min_size=len(chain), max_size=len(chain))
    start, ends = data.draw(state), data.draw(st.none() | state)
    begin = math.fsum(c.full_travel for c, s in zip(chain.cells, start, strict=True) if s == "1")
    if math.isinf(chain.actuator_stiffness):
        points = [abs(point) * chain.full_stroke for point in points]
    program = WrittenProgram(start, (begin, *points), ends)
    assert loads(dumps(chain, program=program)).program == program


@pytest.mark.parametrize("name", CHAINS)
def test_another_program_leaves_the_rest_of_the_file_as_it_was(name):
    text, chain = preset_text(name), preset(name)
    first = WrittenProgram("0" * len(chain), (0.0,))
    second = replace(first, turning_points=(0.0, 0.001))
    once = with_program(text, first)
    assert once.startswith(text.partition("[program]")[0].rstrip("\n"))
    assert loads(once).program == first
    assert with_program(with_program(once, second), first) == once
    assert loads(once).subject == chain


@pytest.mark.parametrize(
    "old",
    [
        WAVE.replace("[chain]\n", f"{TABLE}\n[chain]\n"),
        WAVE.replace("[chain]\n", f"{TABLE}\n# what is said of the chain\n[chain]\n"),
        WAVE.replace("[[chain.cell]]\n", f"{TABLE}[[chain.cell]]\n", 1),
        f"{WAVE}\n[program] # aside\nturning_points_mm = [\n  0,\n  20,\n]\n\n# the end\n",
        f"program = {{ turning_points_mm = [0, 20] }}\n{WAVE}",
        f"program.turning_points_mm = [0, 20]\n{WAVE}",
        f"{WAVE}\n{TABLE}".replace("\n", "\r\n"),
    ],
)
def test_a_program_replaces_the_one_that_stood_there_in_whatever_form(old):
    program = WrittenProgram("000", (0.0, 0.040), "110")
    new = with_program(old, program)
    assert loads(new).program == program
    assert loads(new).subject == loads(WAVE).subject
    assert new.count("turning_points_mm") == 1
    assert ("what is said" in new) == ("what is said" in old)


def test_a_program_that_was_found_is_written_in_round_numbers_within_its_windows():
    for name, to in (("three-wave", "001"), ("force-control", "01"), ("compliant-actuator", "01")):
        found = preset(name).program(to)
        written = WrittenProgram.of(found)
        for turn, point in zip(found.turns, written.turning_points[1:-1], strict=True):
            assert abs(point - turn.drive) <= 0.01 * turn.slack
            assert len(f"{point:.9g}") < 9
        assert written.on(found.chain).arrives == to


def test_playing_a_program_finds_the_windows_that_the_search_gave():
    for name, to in (("paper-forward", "01"), ("three-wave", "001"), ("force-control", "01")):
        found = preset(name).program(to)
        given = WrittenProgram.of(found).on(found.chain)
        assert [turn.low for turn in given.turns] == pytest.approx([t.low for t in found.turns])
        assert [turn.high for turn in given.turns] == pytest.approx([t.high for t in found.turns])
        assert str(given.sequence) == str(found.sequence)
        assert not given.shortest


@given(st.sampled_from([0.02, 0.5, 0.98]), st.sampled_from([0.02, 0.5, 0.98]))
def test_turning_anywhere_in_the_windows_ends_alike(first, second):
    # Stroke 0 → 54 → 20 → 50 mm of a wave, a turn after each snap.
    chain = preset("three-wave")
    program = WrittenProgram("000", (0.0, 0.058, 0.024, 0.040)).on(chain)
    turns = [
        turn.low + part * (turn.high - turn.low)
        for turn, part in zip(program.turns, (first, second), strict=True)
    ]
    other = WrittenProgram("000", (0.0, *turns, 0.040)).on(chain)
    assert other.arrives == program.arrives


def test_with_friction_turns_have_no_windows():
    program = WrittenProgram("00", (0.0, 0.039, 0.020)).on(preset("friction"))
    assert program.slack == 0.0
    assert program.target == program.arrives == "01"


def test_a_cell_counts_as_at_a_stop_within_a_hundredth_of_its_travel():
    chain = preset("paper-forward")
    assert Program.given(chain, [0.0, 0.0199]).arrives == "10"
    assert Program.given(chain, [0.0, 0.0195]).arrives == "-0"
    assert Program.given(chain, [0.0, 0.0001]).arrives == "00"


def test_a_start_that_cannot_stand_is_refused_when_it_is_played():
    up = preset("paper-forward").cells[1].with_anchors(q=(0.0, 0.015))
    down = up.with_anchors(q=(0.0, -0.015))
    with refuses(
        ValueError, "start", "no equilibrium", "20 mm", "0.09799", "N", "0 mm", "-0.09799 N"
    ):
        WrittenProgram("10", (0.020, 0.0)).on(Chain([up, down]))
