"""`stepwell animate`: the GIF and its refusals."""

import pytest
from PIL import Image


@pytest.mark.slow
def test_it_writes_a_gif_of_the_asked_length(stepwell, tmp_path):
    result = stepwell("animate", "forward.toml", "-o", "c.gif", "--seconds", 2, "--fps", 5)
    assert (result.exit_code, result.stdout) == (0, "Wrote c.gif\n")
    with Image.open(tmp_path / "c.gif") as gif:
        assert getattr(gif, "n_frames") == 10  # noqa: B009 -- a GIF has it, other images do not
        assert gif.info["duration"] == 200
    assert {file.name for file in tmp_path.iterdir()} == {"forward.toml", "c.gif"}


@pytest.mark.slow
def test_it_plays_the_designs_own_program_or_a_planned_one(stepwell, tmp_path):
    short = ("--seconds", 1, "--fps", 4)
    result = stepwell("animate", "preset:finger-selector", "--program", "-o", "own.gif", *short)
    assert (result.exit_code, result.stdout) == (0, "Wrote own.gif\n")
    way = ("--program", "--from", "10", "--target", "01")
    result = stepwell("animate", "forward.toml", *way, "-o", "planned.gif", *short)
    assert (result.exit_code, result.stdout) == (0, "Wrote planned.gif\n")
    for name in ("own.gif", "planned.gif"):
        with Image.open(tmp_path / name) as gif:
            assert getattr(gif, "n_frames") == 4  # noqa: B009 -- a GIF has it


def test_a_program_that_cannot_be_had_is_a_line_and_code_3(stepwell, tmp_path):
    result = stepwell("animate", "preset:used-before", "--program", "--target", "01")
    assert result.exit_code == 3
    assert result.output.startswith("no program leads from 00 to 01")
    assert {file.name for file in tmp_path.iterdir()} == {"forward.toml"}


def test_wrong_input_ends_in_code_2_and_writes_nothing(stepwell, tmp_path):
    many = "[chain]\n" + "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n" * 13
    (tmp_path / "many.toml").write_text(many)
    for arguments in (
        ("many.toml",),
        ("forward.toml", "-o", "c.png"),
        ("forward.toml", "--seconds", "0"),
        ("forward.toml", "--fps", "99"),
        ("forward.toml", "--target", "01"),
        ("forward.toml", "--program", "--from", "01"),
    ):
        result = stepwell("animate", *arguments)
        assert result.exit_code == 2
        assert "Error: Invalid value" in result.output
    assert {file.name for file in tmp_path.iterdir()} == {"forward.toml", "many.toml"}
