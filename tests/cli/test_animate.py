"""`stepwell animate`: the GIF and its refusals."""

from PIL import Image


def test_it_writes_a_gif_of_the_asked_length(stepwell, tmp_path):
    result = stepwell("animate", "forward.toml", "-o", "c.gif", "--seconds", 2, "--fps", 5)
    assert (result.exit_code, result.stdout) == (0, "Wrote c.gif\n")
    with Image.open(tmp_path / "c.gif") as gif:
        assert getattr(gif, "n_frames") == 10  # noqa: B009 -- a GIF has it, other images do not
        assert gif.info["duration"] == 200
    assert {file.name for file in tmp_path.iterdir()} == {"forward.toml", "c.gif"}


def test_wrong_input_ends_in_code_2_and_writes_nothing(stepwell, tmp_path):
    many = "[chain]\n" + "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n" * 13
    (tmp_path / "many.toml").write_text(many)
    for arguments in (
        ("many.toml",),
        ("forward.toml", "-o", "c.png"),
        ("forward.toml", "--seconds", "0"),
        ("forward.toml", "--fps", "99"),
    ):
        result = stepwell("animate", *arguments)
        assert result.exit_code == 2
        assert "Error: Invalid value" in result.output
    assert {file.name for file in tmp_path.iterdir()} == {"forward.toml", "many.toml"}
