"""Messages between page and server: what is understood, and what is refused in words."""

import ast
import asyncio
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from stepwell.crash import report
from stepwell.studio import aside, panels, session
from stepwell.studio.aside import answered, types
from stepwell.studio.ask import View
from stepwell.studio.message import Message, WireError, in_steps, message_of, packed, unpacked
from studio.pages import FORWARD

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=12,
)


def test_every_type_has_a_function_that_answers_it_and_every_such_function_a_type():
    functions = {
        (file.stem, node.name)
        for file in Path(panels.__path__[0]).glob("*.py")
        for node in ast.parse(file.read_text("utf-8")).body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("answer")
    }
    assert functions == {(file, f"answer_{kind}") for kind, file in aside._PANELS.items()}
    assert {*types()} >= aside.LONG


def test_a_message_is_read():
    text = json.dumps({"v": 1, "type": "evaluate", "seq": 7, "design": {"a": 1}, "ask": {"b": 2}})
    assert message_of(text, types()) == Message("evaluate", 7, {"a": 1}, {"b": 2})


@pytest.mark.parametrize(
    ("text", "seq", "words"),
    [
        ("", 0, "not JSON"),
        ("{", 0, "not JSON"),
        ("[1]", 0, "must be an object"),
        ("[" * 100_000, 0, "nested too deeply"),
        ('{"v": 1, "seq": 3}', 3, "type = None: no such type"),
        ('{"v": 1, "seq": 3, "type": "evalute"}', 3, "Did you mean evaluate"),
        ('{"v": 1, "seq": 3, "type": ["evaluate"]}', 3, "no such type"),
        ('{"v": 2, "seq": 3, "type": "evaluate"}', 3, "v = 2: must be 1"),
        ('{"v": true, "seq": 3, "type": "evaluate"}', 3, "v = True: must be 1"),
        ('{"v": 1, "seq": -1, "type": "evaluate"}', 0, "seq = -1"),
        ('{"v": 1, "seq": NaN, "type": "evaluate"}', 0, "seq = nan"),
        ('{"v": 1, "seq": true, "type": "evaluate"}', 0, "seq = True"),
        ('{"v": 1, "type": "evaluate"}', 0, "seq = None"),
        ('{"v": 1, "seq": 3, "type": "evaluate", "design": []}', 3, "design = []"),
        ('{"v": 1, "seq": 3, "type": "evaluate", "ask": "x"}', 3, "ask = 'x'"),
        ('{"v": 1, "seq": 3, "type": "evaluate", "leg": -1}', 3, "leg = -1: must be a whole"),
        ('{"v": 1, "seq": 3, "type": "evaluate", "leg": true}', 3, "leg = True: must be a whole"),
        ('{"v": 1, "seq": 3, "type": "evaluate", "path": "x"}', 3, "'path': unknown key"),
        ('{"v": 1, "seq": 3, "type": "../evaluate"}', 3, "no such type"),
        ('{"v": 1, "seq": 3, "type": "_known"}', 3, "no such type"),
        ("9" * 10_000, 0, "not JSON"),
    ],
)
def test_a_message_that_cannot_be_understood_is_refused_with_its_number(
    text: str, seq: int, words: str
):
    with pytest.raises(WireError) as error:
        message_of(text, types())
    assert error.value.seq == seq
    assert words in str(error.value)


@given(st.text() | JSON.map(json.dumps))
def test_any_text_is_a_message_or_refused(text: str):
    with pytest.raises(WireError) as error:
        message_of(text, types())
    assert str(error.value).isprintable()


@pytest.mark.slow
@given(
    kind=st.sampled_from(
        [name for name in types() if name not in ("arenas", "gallery", "thumbnails")]
    ),
    design=st.none() | st.dictionaries(st.text(max_size=8), JSON, max_size=4),
    ask=st.dictionaries(st.sampled_from(["preset", "toml", "x"]), JSON, max_size=2),
)
def test_whatever_is_asked_there_is_an_answer_with_words(kind: str, design: Any, ask: Any):
    header, blocks = unpacked(answered(Message(kind, 5, design, ask)))
    assert (header["v"], header["type"], header["seq"]) == (1, kind, 5)
    assert header["ok"] is False and header["problems"] and not blocks
    assert "failed on this" not in header["problems"][0]["text"]


@given(
    path=st.sampled_from([("chain",), ("chain", "cell"), ("chain", "cell", 1), ("title",)])
    | st.tuples(
        st.just("chain"),
        st.just("cell"),
        st.sampled_from([0, 1]),
        st.sampled_from(["p_mm", "q_mm", "name", "band", "bands", "lever_mm", "load_mm_N"]),
    ),
    value=JSON,
)
def test_a_design_with_anything_in_it_is_evaluated_or_refused(path: Any, value: Any):
    design = json.loads(json.dumps(FORWARD))
    place = design
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    header, _ = unpacked(answered(Message("evaluate", 1, design, {})))
    assert header["ok"] or "failed on this" not in str(header["problems"])


def test_blocks_come_back_as_they_were():
    blocks = {
        "a": np.arange(6.0).reshape(3, 2)[:, ::-1],
        "b": np.array([1, -2, 3]),
        "none": np.empty((0, 2)),
        "c": np.array([np.nan, np.inf, -0.0]),
        "d": np.array([True]),
        "e": np.array([0.1, np.nan], np.float32),
    }
    data = packed("x", 3, View({"words": "ü → λ"}, blocks))
    assert len(data) % 8 == 0
    header, arrays = unpacked(data)
    assert header["words"] == "ü → λ" and header["ok"] is True
    for name, block in blocks.items():
        np.testing.assert_array_equal(arrays[name], block)
    assert [b["dtype"] for b in header["blocks"]] == ["f8", "i4", "f8", "f8", "i4", "f4"]


@pytest.mark.parametrize("rows", [1, 2, 400])
def test_a_drawn_table_comes_back_within_half_a_step_of_each_column(rows: int):
    # Columns from far apart to equal: a small cell beside a large one, and one that stays.
    table = np.random.default_rng(7).normal(size=(rows, 5)) * [1e-9, 1.0, 1e6, 0.0, 1.0]
    table[:, 4] += 1e12
    steps, entry = in_steps(table)
    header, arrays = unpacked(packed("x", 1, View({"steps": {"t": entry}}, {"t": steps})))
    assert [block["dtype"] for block in header["blocks"]] == ["u2"]
    half = 0.5 * np.ptp(table, axis=0) / (2**16 - 1) + np.spacing(np.abs(table).max(axis=0))
    assert (np.abs(arrays["t"] - table) <= half).all()


def test_an_unexpected_error_is_a_line_on_the_page_and_a_report_in_the_terminal(
    tmp_path, monkeypatch, capsys
):
    def broken(*_):
        raise KeyError("bug")

    monkeypatch.setattr(report, "_folders", lambda: iter([tmp_path]))
    monkeypatch.setattr(aside, "answer", broken)
    header, _ = unpacked(answered(Message("evaluate", 7, FORWARD)))
    (problem,) = header["problems"]
    assert (header["ok"], header["seq"]) == (False, 7)
    assert problem["text"].startswith("The studio failed on this.")
    (file,) = tmp_path.iterdir()
    line = f"KeyError: 'bug' (unexpected). To report this error, attach {file}\n"
    assert capsys.readouterr().err == line
    assert FORWARD["chain"]["cell"][0]["name"] in file.read_text("utf-8")


def test_a_session_answers_without_its_process(monkeypatch):
    def unable(_self: Any):
        raise OSError("no more processes")

    monkeypatch.setattr(aside.WorkerProcess, "_started", unable)
    sent: asyncio.Queue[bytes] = asyncio.Queue()

    async def answers() -> list[dict[str, Any]]:
        with ThreadPoolExecutor(1) as threads:
            one = session.Session(sent.put, threads, aside.Workers(), None)
            answering = asyncio.create_task(one.answer())
            headers: list[dict[str, Any]] = []
            for kind in ("evaluate", "graph"):
                message = {"v": 1, "type": kind, "seq": 3, "design": FORWARD}
                await one.hear(json.dumps(message))
                headers.append(unpacked(await asyncio.wait_for(sent.get(), 60))[0])
            answering.cancel()
        return headers

    # A browser of other tests has a running loop in this thread.
    with ThreadPoolExecutor(1) as apart:
        evaluated, drawn = apart.submit(asyncio.run, answers()).result()
    assert evaluated["sequence"] == "00>10>11>01>00"
    assert drawn["ended"]


def test_a_process_that_waits_is_left_to_the_next_page_and_one_that_works_is_ended(monkeypatch):
    ended: list[aside.WorkerProcess] = []
    monkeypatch.setattr(aside.WorkerProcess, "close", lambda self: ended.append(self))
    workers = aside.Workers()
    waiting, working = workers.take("yield"), workers.take("yield")
    monkeypatch.setattr(aside.WorkerProcess, "waits", property(lambda self: self is waiting))
    for worker in (working, waiting):
        workers.leave("yield", worker)
    assert ended == [working]
    assert workers.take("yield") is waiting
    assert workers.take("yield") not in (waiting, working)
