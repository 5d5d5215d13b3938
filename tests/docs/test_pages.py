"""The README and the pages say what is so: examples run, numbers hold, names and links exist."""

import csv
import importlib
import json
import re
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import docs.antennas_found as antennas
import docs.compiled as compiled
import docs.larger_atlases as larger
import docs.rough_ground as rough
import stepwell as sw
from docs.architecture import page as architecture_page, picture
from docs.pages import ROOT, run, unchecked
from docs.short_claims import replaced, short
from docs.what_decides import PAGE, PICTURES, commands, drawn, records, written
from sizes import SIZE

PAGES = [
    *("README.md", "docs/index.md", "docs/tutorial.md", "docs/gallery.md"),
    *("docs/theory.md", "docs/robot-theory.md", "docs/limits.md"),
    *("docs/lessons.md", "docs/glossary.md"),
]
HOW_TO = sorted(f"docs/how-to/{page.name}" for page in (ROOT / "docs" / "how-to").glob("*.md"))
ROOMS = (
    *("mechanism", "statics", "sequences", "design", "lab"),
    *("robot", "simulation", "files", "accounts", "figures", "paper"),
    "reports",
)


def read(page: str) -> str:
    return (ROOT / page).read_text("utf-8")


# What draws the pictures of the README and of the pages.
DRAWN = ("00_figures_of_the_pages", "00_pictures_of_the_front_page")

# In the quick run the tutorial walks a robot, plays a program and draws as these do, and the theory
# page has numbers in its sentences; tests of the statics land with masses.
FULL = [f"docs/{page}.md" for page in ("gallery", "robot-theory")]
FULL += [f"docs/how-to/{page}.md" for page in ("masses", "measured-data", "robots")]
FULL += ["docs/how-to/stroke-programs.md"]
# Its jumps are those of tests/simulation/test_jumps.py.
FULL += ["docs/how-to/jump.md"]
RUN = [page for page in (*PAGES, *HOW_TO) if SIZE == "full" or page not in FULL]
# Those that are not slow.
QUICK = ("README.md", "docs/index.md", "docs/how-to/read-a-result.md")


@pytest.mark.shown
@pytest.mark.parametrize(
    "page", [pytest.param(page, marks=[pytest.mark.slow] * (page not in QUICK)) for page in RUN]
)
def test_every_example_prints_what_the_page_shows(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = run(page, read(page))
    assert done > 0 or page in ("docs/index.md", "docs/glossary.md")


@pytest.mark.parametrize(
    "page",
    [
        *("docs/tutorial.md", "docs/gallery.md", "docs/theory.md", "docs/robot-theory.md"),
        *("docs/lessons.md", *HOW_TO),
    ],
)
def test_every_decimal_number_in_a_sentence_is_checked(page):
    assert unchecked(read(page)) == []


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("```python\nprint(1)\n#> 2\n```\n", "line 1"),
        ("```python\nprint(1)\n```\n", "line 1"),
        ("\nIt is 2.1 mm<!-- = 2.06 --> long and 2.2 mm<!-- = 2.1 -->.\n", "line 2"),
    ],
)
def test_a_page_that_shows_something_else_is_found_out(text, complaint):
    with pytest.raises(AssertionError, match=complaint):
        run("page", text)


def test_a_number_that_nothing_checks_is_found_out():
    text = "A 1.5 mm<!-- = 1.5 --> and a 2.5 mm, `3.5`, [x](y-4.5.md).\n\n    u = 5.5\n"
    assert unchecked(text) == ["2.5"]


def test_every_section_of_the_theory_that_the_code_names_exists():
    named = {
        section
        for file in (ROOT / "src").rglob("*.py")
        for section in re.findall(r"theory page,\s+[\"']([^\"']+)[\"']", file.read_text("utf-8"))
    }
    pages = read("docs/theory.md") + read("docs/robot-theory.md")
    sections = set(re.findall(r"^## (.+)$", pages, re.M))
    assert {"Landing", "Slack", "Sorting", "Stability", "Two cells"} <= named
    assert named <= sections


@pytest.mark.parametrize("room", ROOMS)
def test_every_public_name_has_a_place_in_the_reference(room):
    text = "".join(page.read_text("utf-8") for page in (ROOT / "docs" / "api").glob("*.md"))
    module = importlib.import_module(f"stepwell.{room}")
    for name in module.__all__:
        found = re.search(rf"^::: stepwell\.{room}\.(\w+\.)?{name}$|`{name}`", text, re.M)
        assert found, f"docs/api/ has no line `::: stepwell.{room}.{name}`"


@pytest.mark.parametrize("page", ["README.md", *PAGES[1:], *HOW_TO])
def test_every_link_to_a_file_leads_somewhere(page):
    text = read(page)
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text) + re.findall(
        r'src="([^"]+)"', text
    ):
        if not target.startswith("https://"):
            assert ((ROOT / page).parent / target).exists(), target


def test_the_readmes_count_of_claims_is_that_of_the_claims_file():
    claims = json.loads(read("docs/claims.json"))
    text = read("README.md")
    assert replaced(text, short(claims)) == text, "run `python tests/docs/short_claims.py`"


@pytest.mark.slow
@pytest.mark.shown
def test_the_pictures_are_those_of_the_model(tmp_path):
    home = ROOT / "docs" / "img"
    for script in DRAWN:
        runpy.run_path(str(ROOT / "examples" / f"{script}.py"))["draw"](tmp_path)
    drawn = sorted(file.name for file in tmp_path.iterdir())
    shown = [file.name for kind in ("*.png", "*.svg") for file in home.glob(kind)]
    # These are drawn elsewhere, and compared there.
    elsewhere = {
        "architecture.svg",
        *("antennas-found.svg", "jump-scaling.svg", "rates.svg"),
        "atlas.svg",
        "many-designs.svg",
        *(one.name for one in PICTURES.values()),
    }
    assert drawn == sorted({*shown} - elsewhere)
    for name in drawn:
        again = "run `python examples/{}.py`".format("` and `".join(DRAWN))
        if name.endswith(".svg"):
            assert (tmp_path / name).read_text("utf-8") == (home / name).read_text("utf-8"), again
        else:
            assert difference(tmp_path / name, home / name) < 2.0, f"{name}: {again}"


def test_the_four_pictures_of_the_readme_are_of_one_size():
    sizes = set()
    for name in ("see", "want", "real", "build"):
        with Image.open(ROOT / "docs" / "img" / f"{name}.png") as picture:
            sizes.add(picture.size)
    assert sizes == {(640, 400)}


@pytest.mark.slow
def test_the_moving_picture_repeats_and_is_small_enough_to_be_waited_for():
    file = ROOT / "docs" / "img" / "stepwell.gif"
    with Image.open(file) as movie:
        assert movie.size == (800, 430)
        assert movie.info["loop"] == 0
        frames = getattr(movie, "n_frames", 1)
        time = 0
        for k in range(frames):
            movie.seek(k)
            time += movie.info["duration"]
            assert movie.convert("RGB").getpixel((799, 429)) == (255, 255, 255)
    assert 100 < frames < 200
    assert 10_000 <= time <= 15_000
    assert file.stat().st_size < 1_500_000


@pytest.mark.slow
def test_what_the_moving_picture_says_is_so():
    told = runpy.run_path(str(ROOT / "examples" / "00_moving_picture.py"))
    before, after = told["acts"]()
    assert str(before.cycle().sequence) == "00>10>11>01>00"
    assert str(after.cycle().sequence) == "00>01>11>10>00"
    # "15 mm" stands beside the arrow.
    moved = np.subtract(told["ANCHOR_AFTER"], told["ANCHOR_BEFORE"])
    assert np.hypot(*moved) == pytest.approx(0.015)
    maze = sw.preset(told["ROBOT"]).maze(told["arena"](), limit=told["UNTIL"])
    walk = maze.walk
    # "both legs step forward", then one antenna alone is pressed, that of the left leg.
    assert {gaits[1] for gaits in walk.gaits.values()} == {"00>10>11>01>00"}
    (contact,) = maze.contacts
    (pressed,) = (one for one in walk.robot.antennas if one.name == contact.antenna)
    assert pressed.leg == "left"
    # "which steps backward: the robot turns", and the other leg goes on forward.
    backward = [k for k, gait in enumerate(walk.gaits["left"]) if gait == told["REVERSED"]]
    assert contact.begin < backward[0] * walk.robot.drive.period < contact.end
    assert set(walk.gaits["right"]) == {"00>10>11>01>00"}
    # "and, free again, walks on".
    assert contact.end < told["UNTIL"] - walk.robot.drive.period
    assert walk.gaits["left"][-1] == "00>10>11>01>00"
    assert np.degrees(walk.yaw[-1]) > 45.0


def test_the_architecture_page_shows_the_packages():
    text = read("docs/architecture.md")
    assert architecture_page(text) == text, "run `python tests/docs/architecture.py`"
    assert read("docs/img/architecture.svg") == picture(), "run `python tests/docs/architecture.py`"


def test_the_architecture_page_names_files_that_exist():
    named = re.findall(r"`((?:\w+/)+(?:\w+\.(?:py|md))?)`", read("docs/architecture.md"))
    assert len(named) > 20
    roots = (ROOT, ROOT / "src" / "stepwell")
    assert [name for name in named if not any((root / name).exists() for root in roots)] == []


def test_names_in_a_row_of_the_architecture_page_are_in_the_files_of_that_row():
    text = read("docs/architecture.md").partition("## Where to change what")[2]
    roots = (ROOT, ROOT / "src" / "stepwell")
    lost, looked = [], 0
    for row in re.findall(r"^\| (?!change \|)\w.* \|$", text, re.M):
        terms = re.findall(r"`([^`]+)`", row)
        places = [root / term for root in roots for term in terms if "/" in term]
        files = {file for place in places for file in [place, *place.glob("*.*")] if file.is_file()}
        held = "".join(file.read_text("utf-8") for file in files)
        for term in terms:
            if re.fullmatch(r"@?\w+(\(\))?", term):
                looked += 1
                name = term.strip("@()")
                lost += [] if re.search(rf"\b{name}\b", held) else [(term, row[:40])]
    assert lost == []
    assert looked > 15


def difference(one: Path, other: Path) -> float:
    """Mean difference of two pictures, 0 to 255, seen through glass that blurs single pixels."""
    seen = []
    for file in (one, other):
        with Image.open(file) as picture:
            seen.append(np.asarray(picture.convert("L").resize((240, 160)), float))
    return float(np.mean(np.abs(seen[0] - seen[1])))


@pytest.mark.slow
@pytest.mark.shown
def test_the_page_of_what_decides_shows_the_studies_that_its_commands_make():
    """A record has the identity of the study that the command on the page begins."""
    pytest.importorskip("zarr", reason="studies are not tested: zarr is not installed")
    from stepwell.cli.sweep import read_axes
    from stepwell.studies import How, Space, planned_study

    told, made = commands(), list(records().values())
    assert len(told) == len(made) == 4
    for words, record in zip(told, made, strict=True):
        robot = sw.preset(words[2].removeprefix("preset:"))
        after = {name: words[k + 1] for k, name in enumerate(words) if name.startswith("--")}
        ranges = [words[k + 1] for k, name in enumerate(words) if name == "--vary"]
        space = Space(read_axes(ranges, robot, drawn=True), How.SOBOL, int(after["--sobol"]), 0)
        study = planned_study(
            robot, "walk", space, after["--out"], given={"cycles": 4}, chunk=int(after["--chunk"])
        )
        assert study.identity == record["identity"]
        assert record["finished"]
        assert record["problems"] == {}
    page = PAGE.read_text("utf-8")
    assert written(page) == page
    for name, file in PICTURES.items():
        assert drawn(name) == file.read_text("utf-8"), name


@pytest.mark.slow
@pytest.mark.shown
def test_the_page_of_the_search_shows_the_studies_that_its_commands_make(tmp_path, monkeypatch):
    """The page's commands begin the studies of the records, and hand on the best of each."""
    pytest.importorskip("zarr", reason="studies are not tested: zarr is not installed")
    from typer.testing import CliRunner

    from stepwell import studies
    from stepwell.cli import sweep
    from stepwell.studies.screen import ranked

    record, page = antennas.records(), antennas.PAGE.read_text("utf-8")
    monkeypatch.chdir(tmp_path)
    Path("two-walls.toml").write_text(antennas.arena_text(), "utf-8")
    for name, lines in record["lists"].items():
        Path(name).write_text("\n".join(lines) + "\n", "utf-8")
    begun = []
    monkeypatch.setattr(studies, "begun", lambda study: begun.append(study) or 1 / 0)
    told = antennas.commands()
    for words in (one for one in told if one[0] == "maze"):
        CliRunner().invoke(sweep.commands, words)
    assert [one.folder.stem for one in begun] == list(record["studies"])
    for one in begun:
        found = record["studies"][one.folder.stem]
        assert (one.identity, one.count) == (found["identity"], found["count"])
        assert found["finished"] and found["problems"] == {}
    for words in (one for one in told if one[0] == "export"):
        rows = antennas.rows(words[1].removesuffix(".zarr"))
        by = [words[k + 1] for k, word in enumerate(words) if word == "--rank-by"]
        heads = {"reached": "reached", "time": "time_s"}
        columns = {
            name: np.array([float(row[head]) for row in rows]) for name, head in heads.items()
        }
        best = ranked(columns, by)[: int(antennas.option(words, "--best"))]
        varied = record["lists"][antennas.option(words, "--out")]
        handed = [list(row.values())[1:] for row in csv.DictReader(varied)]
        assert handed == [list(rows[k].values())[1 : len(handed[0]) + 1] for k in best]
    # What judges has not been seen by the search, and is the same for both.
    seen = {k for name in antennas.ROUNDS for k in antennas.layouts(name)}
    ours, today = (antennas.layouts(name) for name in antennas.LAST)
    assert ours == today and len(seen) >= 50 <= len(ours) and not seen & {*ours}
    assert antennas.robot("today").antennas == sw.preset("robot-antennas").antennas
    assert antennas.written(page) == page
    assert antennas.drawn() == antennas.PICTURE.read_text("utf-8")


@pytest.mark.slow
def test_the_page_of_compiled_robots_shows_its_records_and_the_robot_that_is_found():
    text = compiled.PAGE.read_text("utf-8")
    assert compiled.page(text) == text
    record = json.loads(compiled.FILE.read_text("utf-8"))
    assert [run["arena"] for run in record["arenas"]] == [*compiled.ARENAS]
    found = sw.robot.compile_behaviour(sw.files.load_behaviour("turn-away"))
    assert sw.files.dumps(found.designs[0].robot) == record["robot"]
    assert 1e3 * found.designs[0].margin == pytest.approx(record["margin_mN"])


def test_the_page_of_rough_ground_shows_its_record_and_the_walks_are_those_of_today():
    text = rough.PAGE.read_text("utf-8")
    assert rough.page(text) == text
    record = json.loads(rough.FILE.read_text("utf-8"))
    assert f"beyond\n  {record['limit_deg']:.1f}°" in text
    robot = sw.preset("robot-forward")
    (again,) = rough.trials(robot, [rough.slope(5)], rough.SHORT, [0])
    (row,) = [row for row in record["grounds"]["uphill"] if row["value"] == 5]
    assert again[0].advance == pytest.approx(row["advance"][0], abs=0.01)


def test_the_larger_atlases_are_those_that_the_page_s_commands_make(monkeypatch):
    """A summary has the identity of the study that the command on the page begins."""
    pytest.importorskip("zarr", reason="studies are not tested: zarr is not installed")
    from typer.testing import CliRunner

    from stepwell.cli import app
    from stepwell.studies import atlas as rooms, planned_study

    begun = []

    def sweep(chain, what, of, folder, *, given, chunk, **_):
        begun.append(planned_study(chain, what, of, folder, given=given, chunk=chunk))
        raise sw.InputError("that is enough")

    monkeypatch.setattr(sys.modules[rooms.__module__], "sweep", sweep)
    for words in larger.commands():
        assert CliRunner().invoke(app, words).exit_code != 0
    found = larger.records()
    assert [one.identity for one in begun] == [one["identity"] for one in found]
    assert [one.designs.size * one.count for one in begun] == [one["designs"] for one in found]
    assert all(one["classes_agree"] == one["graphs"] for one in found)
    assert all(one["agreed"] == one["checked"] == 100 for one in found)
    # Only four cells count by themselves, in two graphs.
    assert [one["does"]["counts"]["graphs"] for one in found] == [0, 0, 2]
    page = larger.PAGE.read_text("utf-8")
    assert larger.written(page) == page
