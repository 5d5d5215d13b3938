"""Studies and atlases in the page: begun, watched, stopped and opened as a command would."""

from __future__ import annotations

import json
import os
import shlex
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from golden.running import invoke
from stepwell import base, files, studies
from stepwell.accounts import account
from stepwell.files import loads_tables, preset_text, tables_in
from stepwell.studies import Axis, How, Space, Study, Workshop, begun, planned_study
from stepwell.studio.aside import answered
from stepwell.studio.message import Message, unpacked
from stepwell.studio.panels.atlas import placed
from stepwell.studio.stores import end_studies
from studio.pages import FORWARD, Answer
from studio.stores import filled, plane, small_atlas

pytest.importorskip("zarr", reason="studies in the studio are not tested: zarr is not installed")

Asks = Callable[..., Answer]
VARY = [
    {"key": "2.q.x", "from": 0, "to": 20, "count": 3},
    {"key": "2.stiffness", "from": 20, "to": 40.5, "count": 2},
]
FOOT = [{"key": "foot.below_mm", "from": 0.1, "to": 1, "count": 2}]
DRAWN = [{key: one[key] for key in ("key", "from", "to")} for one in VARY]


@pytest.fixture
def ask(tmp_path: Path) -> Asks:
    """What a panel answers whose studies are in a folder of the test's own."""

    def asks(kind: str, design: Any = None, **keys: Any) -> Answer:
        sent = json.loads(json.dumps(keys, allow_nan=False))
        return Answer(*unpacked(answered(Message(kind, 1, design, sent, 0, tmp_path / "home"))))

    (tmp_path / "home").mkdir()
    return asks


def robot() -> dict[str, Any]:
    return tables_in(preset_text("robot-forward"))


@pytest.mark.slow
def test_an_open_study_is_what_the_command_says_of_it(ask: Asks, tmp_path: Path):
    study = filled(plane(tmp_path / "home", 60))
    header, blocks = ask("study", name=study.folder.name)
    record = json.loads(json.dumps(account(studies.status(study)).record))
    assert header["failures"] == record.pop("problems")
    del record["schema"]
    assert {key: header[key] for key in record} == record
    np.testing.assert_array_equal(blocks["rows"], np.arange(60))
    for one in header["columns"]:
        held, shown = study.values(one["name"]), blocks[one["block"]]
        _, factor = study.display_unit(one["name"])
        if one["words"] is None:
            np.testing.assert_array_equal(shown, held * factor)
        else:
            assert [one["words"][k] for k in shown] == [str(word) for word in held]


@pytest.mark.slow
def test_of_many_designs_some_are_shown_evenly_and_rare_words_together(
    ask: Asks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    from stepwell.studio.panels import studies as panels

    monkeypatch.setattr(panels, "_POINTS", 13)
    monkeypatch.setattr(panels, "_WORDS", 2)
    study = filled(plane(tmp_path / "home", 60))
    header, blocks = ask("study", name=study.folder.name)
    assert len(blocks["rows"]) == 13 and np.ptp(np.diff(blocks["rows"])) <= 1
    (words,) = [one for one in header["columns"] if one["name"] == "sequence"]
    said = [words["words"][k] for k in blocks[words["block"]]]
    held = [str(study.values("sequence")[row]) for row in blocks["rows"]]
    often = words["words"][:-1]
    assert len(often) == 2
    assert said == [word if word in often else "any other" for word in held]


@pytest.mark.parametrize(
    "designs",
    [
        Space((Axis("outer.q.x", 0.0, 0.02), Axis("outer.q.y", -0.01, 0.01)), How.LATIN, 5, 2),
        Workshop(sw.Tolerances(anchor=1e-3, stiffness=0.1), 5, seed=4),
    ],
    ids=["latin", "built"],
)
def test_any_design_of_a_study_comes_into_the_editor(ask: Asks, tmp_path: Path, designs: Any):
    leg = files.preset("paper-forward")
    study = begun(planned_study(leg, "cycle", designs, tmp_path / "home" / "a.zarr"))
    made = [design for _, design in study.designs.made(study.subject, 0, 5)]
    for number in (0, 3, 4):
        header, _ = ask("study_design", name="a.zarr", number=number)
        one = made[number]
        assert isinstance(one, sw.Chain)
        assert header["design"] == tables_in(files.dumps(one))
    assert (
        "from 0 to 4" in ask("study_design", name="a.zarr", number=5).header["problems"][0]["text"]
    )


def test_the_table_is_that_of_the_command(ask: Asks, tmp_path: Path):
    study = filled(plane(tmp_path / "home", 20))
    study.to_csv(tmp_path / "by-command.csv")
    _, blocks = ask("study_csv", name=study.folder.name)
    assert blocks["file"].tobytes() == (tmp_path / "by-command.csv").read_bytes()


ASKED: list[tuple[str, dict[str, Any]]] = [
    ("chain", {"what": "cycle", "vary": VARY}),
    ("chain", {"what": "margin", "how": "sobol", "count": 40, "seed": 3, "vary": DRAWN}),
    ("chain", {"what": "graph", "how": "latin", "count": 12, "vary": DRAWN}),
    ("chain", {"what": "program", "target": "01", "start": "00", "vary": VARY}),
    ("chain", {"what": "yield", "how": "built", "count": 9, "anchor_mm": 0.7, "seed": 1}),
    ("robot", {"what": "walk", "cycles": 3, "vary": FOOT}),
    ("robot", {"what": "maze", "limit_s": 90, "layouts": 2, "first": 7, "vary": FOOT}),
]


@pytest.mark.parametrize(("kind", "keys"), ASKED, ids=[keys["what"] for _, keys in ASKED])
def test_the_line_for_a_terminal_begins_the_same_study(
    ask: Asks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, keys: dict[str, Any]
):
    from stepwell.studio.panels import studies as panels

    design = FORWARD if kind == "chain" else robot()
    if keys["what"] == "maze":
        arena = files.loads_arena(files.arena_text("three-walls"))
        keys = keys | {"arena": files.arena_tables(arena)}
        (tmp_path / "arena.toml").write_text(files.dumps(arena))
    meant: list[Study] = []

    def kept(study: Study, *_more: Any) -> Any:
        meant.append(study)
        return study if len(meant) == 1 else studies.StudyEstimate(1, 1, 1.0, 1.0, 1, 1)

    # Nothing is computed: what would be is compared.
    monkeypatch.setattr(panels, "begun", kept)
    monkeypatch.setattr(panels, "begin", lambda _store: None)
    monkeypatch.setattr(panels, "estimate", kept)
    monkeypatch.setattr(studies, "estimate", kept)
    assert ask("study_begin", design, **keys).header["ok"]
    command = ask("study_estimate", design, **keys).header["command"]
    _, _, _, file, *_ = words = shlex.split(command)
    (tmp_path / file).write_text(files.dumps(loads_tables(design).subject))
    monkeypatch.chdir(tmp_path)
    printed = invoke(*words[1:], "--estimate")
    assert printed.exit_code == 0, printed.output
    page, _, terminal = meant
    assert terminal.identity == page.identity and terminal.count == page.count
    assert terminal.chunk == page.chunk and terminal.folder.name == page.folder.name


@pytest.mark.parametrize(
    "name",
    [
        "../elsewhere.zarr",
        "/etc",
        "..",
        ".",
        "",
        "a.zarr/../a.zarr",
        "a.zarr/",
        ".hidden.zarr",
        "b",
    ],
)
def test_no_path_comes_from_the_page(ask: Asks, tmp_path: Path, name: str):
    study = begun(plane(tmp_path / "home", 3))
    for other in ("elsewhere.zarr", "home/.hidden.zarr"):
        begun(plane(tmp_path, 3, tmp_path / other))
    assert [one["name"] for one in ask("studies").header["studies"]] == [study.folder.name]
    for kind in ("study", "study_begin", "study_stop", "study_csv", "study_design", "atlas"):
        more = {"number": 0} if kind == "study_design" else {}
        if kind == "atlas" and not name:
            continue  # the one that comes with Stepwell
        header, _ = ask(kind, FORWARD, name=name, **more)
        assert not header["ok"] and "no such study" in header["problems"][0]["text"]


@pytest.mark.parametrize("title", ["../../up", "/etc/passwd", "", "Ünïcode, " * 9, "con: x"])
def test_a_study_lies_in_the_servers_folder_whatever_its_design_is_called(
    ask: Asks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, title: str
):
    from stepwell.studio.panels import studies as panels

    monkeypatch.setattr(panels, "begin", lambda _store: None)
    header, _ = ask("study_begin", FORWARD | {"title": title}, what="cycle", vary=VARY)
    assert header["ok"], header
    assert [one.name for one in (tmp_path / "home").iterdir()] == [header["name"]]
    assert sorted(one.name for one in tmp_path.iterdir()) == ["home"]
    assert set(header["name"]) <= set("abcdefghijklmnopqrstuvwxyz0123456789-.")


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({}, "ask.what"),
        ({"what": "call", "vary": VARY}, "must be one of cycle"),
        ({"what": "atlas", "vary": VARY}, "must be one of cycle"),
        ({"what": "cycle"}, "ask.vary"),
        ({"what": "cycle", "vary": [{**VARY[0], "count": 1}]}, "from 2 to"),
        ({"what": "cycle", "vary": [{**VARY[0], "to": 0}]}, "must rise"),
        ({"what": "cycle", "vary": [{**VARY[0], "key": "2.q"}]}, "is a point"),
        ({"what": "cycle", "vary": [VARY[0], VARY[0]]}, "each name once"),
        ({"what": "cycle", "vary": [{**one, "count": 4000} for one in VARY]}, "at most 10000000"),
        ({"what": "cycle", "how": "drawn", "vary": VARY}, "ask.how"),
        ({"what": "cycle", "how": "sobol", "vary": DRAWN}, "ask.count"),
        ({"what": "cycle", "vary": VARY, "out": "/tmp/x"}, "ask.'out': unknown key"),
        ({"what": "program", "vary": VARY}, "ask.target"),
        ({"what": "walk", "vary": VARY}, "needs a robot"),
    ],
)  # fmt: skip
def test_what_cannot_be_a_study_is_refused_and_leaves_nothing(
    ask: Asks, tmp_path: Path, keys: dict[str, Any], said: str
):
    header, _ = ask("study_begin", FORWARD, **keys)
    assert not header["ok"] and said in header["problems"][0]["text"]
    assert not [*(tmp_path / "home").iterdir()]


def test_the_numbers_of_a_robot_are_offered_as_its_file_has_them(ask: Asks):
    parameters = ask("robot_numbers", robot()).header["parameters"]
    held = {one.path: one for one in files.parameters(files.preset("robot-forward"))}
    assert "foot.below_mm" in {one["key"] for one in parameters}
    for one in parameters:
        assert one["value"] == held[one["key"]].values[0]
        assert one["range"][0] < one["value"] < one["range"][1]


def test_without_zarr_the_page_says_what_is_missing(ask: Asks, monkeypatch: pytest.MonkeyPatch):
    real = base.extras.find_spec
    monkeypatch.setattr(
        base.extras, "find_spec", lambda name: None if name == "zarr" else real(name)
    )
    header, _ = ask("studies")
    assert header["ok"] and base.install("studies") in header["missing"]
    for kind, keys in (
        ("study", {"name": "a"}),
        ("study_begin", {"what": "cycle", "vary": VARY}),
        ("study_estimate", {"what": "cycle", "vary": VARY}),
        ("atlas", {"name": ""}),
    ):
        (problem,) = ask(kind, FORWARD, **keys).header["problems"]
        assert problem["text"] == header["missing"]


def until(ready: Callable[[], bool]) -> None:
    """Wait for something that other processes do."""
    last = time.monotonic() + 120
    while not ready():
        assert time.monotonic() < last, "it did not come"
        time.sleep(0.05)


GATED = """
import pathlib, time

def gated(chain, seed):
    gate = pathlib.Path({gate!r})
    while chain.cells[1].band.q[0] > 0.008 and not gate.exists():
        time.sleep(0.02)
    return {{"x": chain.cells[1].band.q[0]}}
"""


@pytest.mark.slow
def test_a_study_is_watched_stopped_and_goes_on_and_one_that_fails_says_why(
    ask: Asks, tmp_path: Path
):
    gate, function = tmp_path / "gate", tmp_path / "gated.py"
    function.write_text(GATED.format(gate=str(gate)))
    leg = files.preset("paper-forward")
    for name in ("a.zarr", "b.zarr"):
        space = Space((Axis("outer.q.x", 0.0, 0.02, 5),))
        place = tmp_path / "home" / name
        begun(planned_study(leg, "call", space, place, given=_given(function), chunk=1))

    def listed(name: str) -> dict[str, Any]:
        (one,) = [one for one in ask("studies").header["studies"] if one["name"] == name]
        return one

    try:
        assert ask("study_begin", name="a.zarr").header["ok"]
        # Twice is once, and two at a time would take each other's cores.
        assert ask("study_begin", name="a.zarr").header["ok"]
        assert (
            "is being computed" in ask("study_begin", name="b.zarr").header["problems"][0]["text"]
        )
        until(lambda: ask("study", name="a.zarr").header["done"] >= 2)
        assert listed("a.zarr")["running"]
        assert ask("study_stop", name="a.zarr").header["at_once"]
        assert listed("a.zarr") | {"running": False, "problem": ""} == listed("a.zarr")
        done = ask("study", name="a.zarr").header["done"]
        assert 2 <= done < 5
        gate.touch()
        assert ask("study_begin", name="a.zarr").header["ok"]
        until(lambda: not listed("a.zarr")["running"])
        assert ask("study", name="a.zarr").header["finished"]
        # Nobody of ours is at work there now: whoever is stops after its chunk.
        assert not ask("study_stop", name="a.zarr").header["at_once"]
        function.write_text("def gated(chain, seed):\n    return {}\n")
        assert ask("study_begin", name="b.zarr").header["ok"]
        until(lambda: not listed("b.zarr")["running"])
        assert "differs from the file" in listed("b.zarr")["problem"]
    finally:
        end_studies()


def _given(function: Path) -> dict[str, Any]:
    import hashlib

    digest = hashlib.sha256(function.read_bytes()).hexdigest()
    return {"file": str(function), "name": "gated", "sha256": digest, "units": {"x": "m"}}


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="no groups of processes here")
@pytest.mark.slow
def test_the_end_of_the_server_ends_all_of_a_study(ask: Asks, tmp_path: Path):
    from stepwell.studio import stores

    function = tmp_path / "gated.py"
    function.write_text(GATED.format(gate=str(tmp_path / "gate")))
    axis = Axis("outer.q.x", 0.01, 0.02, 3)
    begun(
        planned_study(
            files.preset("paper-forward"), "call", Space((axis,)), tmp_path / "home" / "a.zarr",
            given=_given(function), chunk=1,
        )
    )  # fmt: skip
    assert ask("study_begin", name="a.zarr").header["ok"]
    run = stores._RUNS[tmp_path / "home" / "a.zarr"]
    group = run.process.pid
    end_studies()
    assert run.process.returncode is not None
    # A zombie that nobody has waited for yet is no process at work.
    until(lambda: not _alive(group))


def _alive(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except (ProcessLookupError, PermissionError):
        return False
    return True


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an atlas of two cells."""
    home = tmp_path_factory.mktemp("atlases") / "home"
    home.mkdir()
    small_atlas(home / "two.zarr")
    return home


@pytest.mark.slow
def test_an_atlas_is_what_the_command_says_of_it(two: Path):
    header, _ = unpacked(answered(Message("atlas", 1, None, {"name": "two.zarr"}, 0, two)))
    study = studies.opened(two / "two.zarr")
    chart = studies.charted(study)
    record = json.loads(
        json.dumps(account(chart, class_boundaries=studies.class_boundaries(study, chart)).record)
    )
    del record["cycles"], record["schema"]
    shown = header["graph_classes"]
    for one, of in zip(shown, record.pop("graph_classes"), strict=True):
        assert {key: one[key] for key in of} == of
    assert {key: header[key] for key in record} == record
    for one, graph_class in zip(shown, chart.graph_classes, strict=True):
        assert one["design_tables"] == tables_in(files.dumps(graph_class.chain))
        assert {(w["from"], w["to"], w["direction"], w["snaps"]) for w in one["ways"]} == {
            *graph_class.ways
        }
    query = {"name": "two.zarr", "query": "reaches every state and not snaps", "yield_percent": 90}
    answer, _ = unpacked(answered(Message("atlas", 2, None, query, 0, two)))
    assert answer["matches"] == [
        one.name for one in studies.find(chart, "reaches every state and not snaps", 0.9)
    ]
    wrong, _ = unpacked(answered(Message("atlas", 3, None, query | {"query": "count"}, 0, two)))
    assert "Did you mean 'counts'?" in wrong["problems"][0]["text"]


@pytest.mark.slow
def test_graph_classes_lie_within_the_picture_and_on_none_other(two: Path):
    study = studies.opened(two / "two.zarr")
    chart = studies.charted(study, samples=2, checks=0)
    names = [f"{k:08x}" for k in range(60)]
    renamed = [replace(chart.graph_classes[k % 3], name=name) for k, name in enumerate(names)]
    parameter = chart.axes[0].name
    near = [
        studies.ClassBoundary(names[k], parameter, 0.0, 1e-3 * (1 + k % 5), names[(k * k + 1) % 60])
        for k in range(50)
    ]
    places = np.array([*placed(chart, near, renamed).values()])
    xy, radius = places[:, :2], places[:, 2]
    assert np.all(xy - radius[:, None] > 0) and np.all(xy + radius[:, None] < [1.0, 0.64])
    apart = np.hypot(*(xy[:, None] - xy[None, :]).T) + 9 * np.eye(60)
    assert np.all(apart > (radius[:, None] + radius[None, :]) * 0.98)
