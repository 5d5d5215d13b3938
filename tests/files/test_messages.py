"""What a wrong design file is answered with: place, value, what is allowed, what was meant."""

import os

import pytest

from facts import refuses, says
from stepwell.files import DesignError, load, loads, preset, text_of
from stepwell.files.schema.chain import TABLES

CELL = "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"


def answer(text: str) -> str:
    with pytest.raises(DesignError) as caught:
        loads(text, "forward.toml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        # the two examples of the style sheet
        (
            f"[chain]\n{CELL}{CELL.replace('q_mm', 'q_mmm')}",
            "forward.toml: chain.cell[1].q_mmm: unknown key. Did you mean q_mm?",
        ),
        (
            f"[chain]\nband = {{ rest_length_mm = -3 }}\n{CELL}",
            "forward.toml: chain.band.rest_length_mm = -3: must be >= 0 (up to 1e6).",
        ),
        # structure
        ("", "forward.toml: is empty: a design file starts with a [chain] table."),
        ('title = "t"', "forward.toml: chain: is missing. A design file has a [chain] table."),
        (
            "[chain]",
            "forward.toml: chain.cell: is missing. A chain has one [[chain.cell]] or more, "
            "inner first.",
        ),
        (
            "[chain]\ncell = []",
            "forward.toml: chain.cell = []: must hold one cell or more, inner first.",
        ),
        (
            "[chain.cell]\np_mm = 1",
            "forward.toml: chain.cell = {p_mm}: must be a list of tables, each under "
            "[[chain.cell]].",
        ),
        ("chain = 3", "forward.toml: chain = 3: must be a table, as in [chain]."),
        (
            f"robot = 1\n[chain]\n{CELL}",
            "forward.toml: robot: unknown key. Known here: title, chain, program, hopper.",
        ),
        # keys in the wrong table or unit
        (
            f"[chain]\n{CELL}stiffness_N_per_m = 30",
            "forward.toml: chain.cell[0].stiffness_N_per_m: unknown key. It belongs in a band, as "
            "in band = { stiffness_N_per_m = ... }.",
        ),
        (
            f"[chain]\nlever_cm = 1\n{CELL}",
            "forward.toml: chain.lever_cm: unknown key. Did you mean lever_mm?",
        ),
        (
            f"friction_N = 1\n[chain]\n{CELL}",
            "forward.toml: friction_N: unknown key. It belongs in [chain.cell].",
        ),
        # values
        (
            f'[chain]\nlimit_deg = "45"\n{CELL}',
            'forward.toml: chain.limit_deg = "45": must be a number from 0.01 to 89.9.',
        ),
        (
            f"[chain]\nlimit_deg = 90.0\n{CELL}",
            "forward.toml: chain.limit_deg = 90.0: must be from 0.01 to 89.9.",
        ),
        (
            f"[chain]\nlever_mm = true\n{CELL}",
            "forward.toml: chain.lever_mm = true: must be a number from 0.001 to 1e6.",
        ),
        (
            f"[chain]\nlever_mm = nan\n{CELL}",
            "forward.toml: chain.lever_mm = nan: must be a finite number from 0.001 to 1e6.",
        ),
        (
            f"[chain]\nlever_mm = -inf\n{CELL}",
            "forward.toml: chain.lever_mm = -inf: must be a finite number from 0.001 to 1e6.",
        ),
        (
            f"[chain]\nlever_mm = 1e99999999999999999999\n{CELL}",
            "forward.toml: chain.lever_mm = inf: must be a finite number from 0.001 to 1e6.",
        ),
        (
            f"[chain]\nlever_mm = 1e400\n{CELL}",
            "forward.toml: chain.lever_mm = 1E+400: must be from 0.001 to 1e6.",
        ),
        (
            f"[chain]\nlever_mm = 0x{'f' * 40}\n{CELL}",
            "forward.toml: chain.lever_mm = an integer of 160 bits: must be a number from 0.001 "
            "to 1e6.",
        ),
        (
            f"[chain]\nlever_mm = {'9' * 5000}\n{CELL}",
            "forward.toml: holds an integer of thousands of digits.",
        ),
        (
            f"[chain]\nactuator_stiffness_N_per_m = inf\n{CELL}",
            "forward.toml: chain.actuator_stiffness_N_per_m = inf: must be a finite number from "
            '1e-6 to 1e12, 0, or "rigid".',
        ),
        (
            f"[chain]\nactuator_stiffness_N_per_m = 1e-7\n{CELL}",
            "forward.toml: chain.actuator_stiffness_N_per_m = 1E-7: must be from 1e-6 to 1e12, 0, "
            'or "rigid".',
        ),
        (
            f'title = "two\\nlines"\n[chain]\n{CELL}',
            'forward.toml: title = "two\\nlines": must be one line of at most 200 characters.',
        ),
        (f"title = 3\n[chain]\n{CELL}", "forward.toml: title = 3: must be text in quotes."),
        (
            f'[chain]\nband = {{ two_sided = "yes" }}\n{CELL}',
            'forward.toml: chain.band.two_sided = "yes": must be true or false, without quotes.',
        ),
        (
            "[chain]\n[[chain.cell]]\np_mm = [-10, 0, 0]\nq_mm = [1, nan]",
            "forward.toml: chain.cell[0].p_mm = [-10, 0, 0]: must be two numbers from -1e6 to 1e6, "
            "in mm, as in [10, 0].\n"
            "forward.toml: chain.cell[0].q_mm = [1, nan]: must be two numbers from -1e6 to 1e6, in "
            "mm, as in [10, 0].",
        ),
        # anchors, laws and loads that contradict each other
        (
            "[chain]\n[[chain.cell]]\np_mm = [-10, 0]",
            "forward.toml: chain.cell[0].q_mm: is missing in cell 1: two numbers in mm, as in "
            "[10, 0].",
        ),
        (
            f"[chain]\n{CELL}bands = []",
            "forward.toml: chain.cell[0].p_mm = [-10, 0]: cannot be combined with bands, "
            "which have their own anchors.",
        ),
        (
            "[chain]\n[[chain.cell]]\nbands = []",
            "forward.toml: chain.cell[0].bands = []: must hold one band or more.",
        ),
        (
            "[chain]\n[[chain.cell]]\nbands = [{ p_mm = [1, 2] }]",
            "forward.toml: chain.cell[0].bands[0].q_mm: is missing. Two numbers in mm, as in "
            "[10, 0].",
        ),
        (
            f"[chain]\n{CELL}load_N = 1\nload_mm_N = [[0, 1]]",
            "forward.toml: chain.cell[0].load_mm_N = [[0, 1]]: cannot be combined with load_N: a "
            "cell has one load.",
        ),
        (
            f"[chain]\n{CELL}load_mm_N = [[0, 1], [0, 2]]",
            "forward.toml: chain.cell[0].load_mm_N = [[0, 1], [0, 2]]: row 2 must be at least "
            "0.000001 mm above the row before it.",
        ),
        (
            f"[chain]\nband = {{ table_mm_N = [[1, 0], [2, 1]] }}\n{CELL}",
            "forward.toml: chain.band.table_mm_N = [[1, 0], [2, 1]]: row 1 must be [0, 0]: a band "
            "has no tension at its rest length.",
        ),
        (
            f"[chain]\nband = {{ table_mm_N = [[0, 0], [2, 0]] }}\n{CELL}",
            "forward.toml: chain.band.table_mm_N = [[0, 0], [2, 0]]: the last row must be a "
            "tension of 1e-9 N or more.",
        ),
        (
            f"[chain]\nband = {{ shape_mm = [[0, 0], 3] }}\n{CELL}",
            "forward.toml: chain.band.shape_mm = [[0, 0], 3]: row 2 must be two numbers from -1e6 "
            "to 1e6, as in [[0, 0], [10, 0.3], [30, 0.8]].",
        ),
        (
            f"[chain]\nband = {{ table_mm_N = [[0, 0], [2, 1]], cubic_per_mm2 = 1 }}\n{CELL}",
            "forward.toml: chain.band: gives quadratic_per_mm or cubic_per_mm2 and table_mm_N: a "
            "band has one law, keep one of them.",
        ),
        (
            f"[chain]\nband = {{ table_mm_N = [[0, 0], [2, 1]] }}\n{CELL}"
            "band = { stiffness_N_per_m = 3 }",
            "forward.toml: chain.cell[0].band.stiffness_N_per_m = 3: cannot be combined with "
            "table_mm_N, which sets the stiffness; leave it out, or give the law as shape_mm.",
        ),
        # TOML itself
        ("[chain]\nlever_mm = = 3", "forward.toml: line 2, column 12: Invalid value."),
        (
            "[chain]\nlever_mm = 14,14",
            "forward.toml: line 2, column 14: Expected newline or end of document after a "
            "statement. Numbers have a decimal point: 14.14.",
        ),
        (
            "[[chain.cell]]\nq_mm = [20 0]",
            "forward.toml: line 2, column 12: Unclosed array. A comma is missing between the "
            "numbers: 20, 0.",
        ),
        ("a.b = 1\na.b.c = 2", "forward.toml: line 2, at the end: Cannot overwrite a value."),
        ("a = " + "[" * 100_000, "forward.toml: is nested too deeply to be a design file."),
    ],
)
def test_the_message_names_the_place_the_value_and_the_remedy(text, message):
    assert answer(text) == message


def test_all_problems_are_said_at_once_one_line_each():
    text = "x = 1\n[chain]\nlever_mm = 0\n[[chain.cell]]\np_mm = 3\nq_mm = [0, 0]\nload_N = inf"
    lines = answer(text).splitlines()
    assert len(lines) == 4
    for line, place in zip(
        sorted(lines), ("cell[0].load_N", "cell[0].p_mm", "lever_mm"), strict=False
    ):
        assert line.startswith(f"forward.toml: chain.{place} = ")


def test_what_only_the_mechanism_can_judge_is_reported_with_its_place():
    text = (
        "[chain]\nband = { rest_length_mm = 5, two_sided = true }\n"
        f"{CELL}[[chain.cell]]\np_mm = [0, 0]\nq_mm = [-14.142135623730951, 0]"
    )
    message = answer(text)
    says(
        message, "forward.toml: chain.cell[1]: ", "band", "q - p", "-14.14", "mm", "move an anchor"
    )


def test_a_flood_of_problems_is_cut_short():
    message = answer("[chain]\n" + "[[chain.cell]]\nq_mm = 1\np_mm = 1\n" * 500)
    assert len(message.splitlines()) == 41
    says(message.splitlines()[-1], "forward.toml: ", "960 more")


def test_the_error_keeps_the_problems_apart_for_programs():
    with pytest.raises(DesignError) as caught:
        loads("x = 1\ny = 2\n[chain]\n" + CELL, "forward.toml")
    assert caught.value.name == "forward.toml"
    assert [problem.split(":")[0] for problem in caught.value.problems] == ["x", "y"]


def test_every_misspelt_key_is_recognised():
    for table, keys in TABLES.items():
        for key in keys.model_fields:
            near = key + key[-1]
            before = "[chain]\n" + CELL if table.startswith("chain.cell") else ""
            alone = table in ("chain", "chain.band", "program") or table.startswith("hopper")
            place = f"[{table}]\n" if alone else ""
            inside = table.removeprefix("chain.cell").strip(".")
            if table.startswith("chain.cell") and inside:
                value = f"{near} = 1"
                for name in reversed(inside.split(".")):
                    several = name in ("bands", "beside", "inside", "sheets")
                    value = f"{name} = " + ("[{ %s }]" if several else "{ %s }") % value
                alone = "[chain]\n[[chain.cell]]\n"
                text = f"{before if inside == 'band' else alone}{value}"
            else:
                text = f"{before}{place}{near} = 1"
            says(answer(text).splitlines(), f"{near}: unknown key", f"{key}?")


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"\xff\xfe[\x00c\x00", "line 1: byte 0xff is not UTF-8: save the file as UTF-8 text."),
        (b"# ok\n# \xe9", "line 2: byte 0xe9 is not UTF-8: save the file as UTF-8 text."),
        (b"  \n", "is empty: a design file starts with a [chain] table."),
        (b"\x00\x01", "line 1, column 1: Invalid statement."),
    ],
)
def test_files_that_are_no_text_are_refused_in_one_line(tmp_path, content, problem):
    file = tmp_path / "leg.toml"
    file.write_bytes(content)
    with pytest.raises(DesignError) as caught:
        load(file)
    assert str(caught.value) == f"{file}: {problem}"


def test_a_missing_file_is_answered_with_the_nearest_one(tmp_path):
    (tmp_path / "forward.toml").write_text("")
    with pytest.raises(DesignError) as caught:
        load(tmp_path / "foward.toml")
    near = tmp_path / "forward.toml"
    says(str(caught.value), "foward.toml: no such", "Did you mean", f"{near}?")
    with refuses(DesignError, "x.toml", "no such file") as refused:
        load(tmp_path / "nowhere" / "x.toml")
    assert "Did you mean" not in str(refused.value)


def test_folders_devices_and_impossible_names_are_refused(tmp_path):
    with refuses(DesignError, str(tmp_path), "a folder"):
        load(tmp_path)
    with refuses(DesignError, "a\\x00b", "file name"):
        load("a\0b")
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        with refuses(DesignError, "pipe", "ordinary file"):
            load(tmp_path / "pipe")


def test_a_file_far_too_long_is_not_read(tmp_path):
    with open(tmp_path / "long.toml", "wb") as file:
        file.truncate(10**9)
    with pytest.raises(DesignError, match=r"1000000000 bytes.*at most 4194304"):
        load(tmp_path / "long.toml")


def test_names_that_a_terminal_cannot_show_are_escaped():
    with pytest.raises(DesignError) as caught:
        loads('"\x1b[31mred" = 1\n[chain]\n' + CELL, "we\udcffird\n.toml")
    message = str(caught.value)
    assert message.isprintable()
    assert message.startswith("we\\udcffird\\n.toml: ")


def test_a_preset_is_a_design_too_and_a_wrong_name_is_answered_with_the_nearest():
    assert load("preset:paper-forward").subject == preset("paper-forward")
    with pytest.raises(DesignError) as caught:
        load("preset:paper-foward")
    says(str(caught.value), "paper-foward: ", "no such design", "Did you mean", "paper-forward?")


def test_a_preset_asked_for_like_a_file_is_answered_with_its_name():
    with pytest.raises(DesignError) as caught:
        load("robot-forward")
    says(str(caught.value), "robot-forward: ", "no such file", "preset:robot-forward?")


@pytest.mark.parametrize("name", ["forward", "preset:forward"])
def test_a_wrong_name_is_answered_with_presets_that_the_command_takes(name):
    for robots, kept, left in ((False, "paper", "robot"), (True, "robot", "paper")):
        with refuses(DesignError, f"{kept}-forward", "stepwell presets") as refused:
            text_of(name, robots=robots)
        assert f"{left}-forward" not in str(refused.value)
