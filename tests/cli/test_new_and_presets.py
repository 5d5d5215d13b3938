"""`stepwell new` and `stepwell presets`: designs to start from."""

import json

import pytest

from stepwell.files import load, preset, preset_text, presets


def test_new_copies_a_design_with_its_comments(stepwell, tmp_path):
    result = stepwell("new", "leg.toml", "--preset", "paper-via-10")
    assert result.exit_code == 0
    assert result.stdout == "Wrote leg.toml. Next: stepwell run leg.toml\n"
    assert (tmp_path / "leg.toml").read_text("utf-8") == preset_text("paper-via-10")
    assert load(tmp_path / "leg.toml").subject == preset("paper-via-10")


def test_new_starts_from_the_forward_leg_by_default(stepwell, tmp_path):
    stepwell("new", "leg.toml")
    assert load(tmp_path / "leg.toml").subject == preset("paper-forward")


def test_new_replaces_a_file_only_by_force(stepwell, tmp_path):
    (tmp_path / "leg.toml").write_text("mine")
    result = stepwell("new", "leg.toml")
    assert result.exit_code == 2
    assert "leg.toml: exists: choose another name, or pass --force" in result.output
    assert (tmp_path / "leg.toml").read_text() == "mine"
    assert stepwell("new", "leg.toml", "--force").exit_code == 0
    assert load(tmp_path / "leg.toml").subject == preset("paper-forward")


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("leg",), 2, "must end in .toml, as in leg.toml."),
        (
            ("leg.toml", "--preset", "paper-foward"),
            2,
            "preset paper-foward: no such design. Did you mean paper-forward?",
        ),
        (("no/leg.toml",), 1, "no/leg.toml: there is no folder no: make it"),
    ],
)
def test_new_refuses_what_it_cannot_write(stepwell, tmp_path, arguments, code, message):
    result = stepwell("new", *arguments)
    assert result.exit_code == code
    assert message in result.output
    assert [file.name for file in tmp_path.iterdir()] == ["forward.toml"]


def test_presets_lists_every_design_with_its_title(stepwell):
    lines = stepwell("presets").stdout.splitlines()
    for name, title in presets().items():
        assert any(line.split(maxsplit=1) == [name, title] for line in lines)


def test_presets_as_json(stepwell):
    record = json.loads(stepwell("presets", "--json").stdout)
    assert record["schema"] == "stepwell.presets/1"
    assert {row["name"]: row["title"] for row in record["presets"]} == presets()
