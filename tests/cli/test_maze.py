"""`stepwell maze`: a robot among walls, and the controls."""

import json

import pytest
import xarray

from cli.folders import written
from facts import says
from stepwell.files import arenas, load, load_arena, preset_text

WRITTEN = {"arena.toml", "maze.json", "report.html", "robot.toml", "walk.nc"} | {
    f"{name}{kind}" for name in ("maze", "timeline") for kind in (".png", ".svg")
}


@pytest.mark.slow
def test_a_contact_is_reported_with_the_leg_that_it_reprograms(stepwell, tmp_path):
    result = stepwell(
        "maze", "robot-explorer", "cylinder", "--limit", 36, "--out", "out", "--no-video"
    )
    assert result.exit_code == 0
    assert written(tmp_path / "out") == WRITTEN
    record = json.loads((tmp_path / "out" / "maze.json").read_text("utf-8"))
    assert record["outcome"] == "timed_out" and record["duration_s"] == 36
    says(result.stdout.splitlines(), "36 s", "limit 36 s", "no goal")
    says(result.stdout.splitlines(), "show robot-explorer --full`")
    (contact,) = record["contacts"]
    assert contact["antenna"] == "left"
    assert {change["leg"] for change in record["changes"]} == {"right"}
    assert "00>01>11>10>00" in {change["after"] for change in record["changes"]}
    assert (tmp_path / "out" / "robot.toml").read_text("utf-8") == preset_text("robot-explorer")
    assert load_arena(tmp_path / "out" / "arena.toml") == load_arena("cylinder")
    assert xarray.load_dataset(tmp_path / "out" / "walk.nc").sizes["antennas"] == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("option", "limit", "out"),
    # One folder of the two.
    [("--disconnect", 36, ("--out", "out", "--no-video")), ("--no-antennas", 60, ())],
)
def test_the_controls_touch_and_change_nothing(stepwell, tmp_path, option, limit, out):
    result = stepwell(
        "maze", "robot-explorer", "cylinder", "--limit", limit, option, "--json", *out
    )
    record = json.loads(result.stdout)
    assert record["touched"][0]["time_s"] is not None
    assert all(change["after"] != "00>01>11>10>00" for change in record["changes"])
    assert not any(antenna["connected"] for antenna in record["antennas"])
    if out:  # the design beside the results is the one that was simulated
        kept = load(tmp_path / "out" / "robot.toml").robot
        assert [one.connected for one in kept.antennas] == [False] * len(record["antennas"])


@pytest.mark.slow
def test_seeds_move_start_and_walls_and_nothing_else_does(stepwell):
    def ended(*options):
        result = stepwell("maze", "robot-forward", "three-walls", "--limit", 1, "--json", *options)
        return json.loads(result.stdout)

    plain, again = ended(), ended()
    assert again == plain
    moved = ended("--start-seed", 1)
    assert moved["start_mm"] != plain["start_mm"] == [0, 0]
    assert moved["heading_deg"] != plain["heading_deg"] == 0
    assert abs(moved["heading_deg"]) <= 10
    assert max(map(abs, moved["start_mm"])) <= 40
    walls = ended("--layout-seed", 1)
    assert walls["start_mm"] == plain["start_mm"]


@pytest.mark.slow
def test_an_arena_of_the_users_own_is_drawn_or_written(stepwell, tmp_path):
    (tmp_path / "yard.txt").write_text("cell 100 mm\n######\n#....#\n#>..G#\n#....#\n######\n")
    record = json.loads(
        stepwell("maze", "robot-forward", "yard.txt", "--limit", 30, "--json").stdout
    )
    assert record["outcome"] == "reached"


def test_list_shows_every_arena_with_its_title(stepwell):
    result = stepwell("maze", "--list")
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    for name, title in arenas().items():
        assert any(line.split(maxsplit=1) == [name, title] for line in lines)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("robot-explorer", "three-wall"), "Did you mean three-walls?"),
        (("robot-forward", "open", "--disconnect"), "this robot has no antennas."),
        (
            ("robot-explorer", "open", "--disconnect", "--no-antennas"),
            "give only one of the options",
        ),
        (("robot-explorer",), "ARENA"),
    ],
)
def test_wrong_usage_is_reported_in_a_line(stepwell, arguments, message):
    result = stepwell("maze", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr
