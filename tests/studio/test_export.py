"""What the page exports opens elsewhere, and holds what Python says."""

import csv
import io
import json
import xml.etree.ElementTree as ET
from itertools import pairwise, product
from typing import Any

import pytest
from PIL import Image

import stepwell as sw
from sizes import cases
from stepwell.studio.aside import answered
from stepwell.studio.message import Message, unpacked
from stepwell.studio.standalone import replay
from studio.pages import FORWARD


def ask(panel: str, **keys: Any) -> tuple[dict[str, Any], bytes]:
    header, blocks = unpacked(answered(Message(panel, 1, json.loads(json.dumps(FORWARD)), keys)))
    return header, blocks["file"].tobytes() if header["ok"] else b""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "kind"),
    cases(
        product(("overview", "mechanism", "force", "travel"), ("svg", "png", "pdf")),
        (("overview", "png"), ("mechanism", "svg"), ("force", "pdf"), ("travel", "svg")),
    ),
)
def test_a_figure_opens_as_svg_png_and_pdf(what: str, kind: str):
    _, data = ask("export", what=what, kind=kind)
    if kind == "svg":
        assert ET.fromstring(data).tag.endswith("svg")
    elif kind == "png":
        with Image.open(io.BytesIO(data)) as image:
            assert image.format == "PNG"
            assert image.info["dpi"][0] == pytest.approx(600, abs=1)
    else:
        assert data.startswith(b"%PDF-")


def test_the_samples_are_those_of_the_command(tmp_path):
    _, text = ask("export", what="samples", kind="csv")
    sw.preset("paper-forward").cycle().path.to_csv(tmp_path / "path.csv")
    assert text == (tmp_path / "path.csv").read_bytes()
    rows = list(csv.DictReader(io.StringIO(text.decode())))
    # A snap is a leap of travels, and there the branch has another number.
    leaps = [
        (a, b)
        for a, b in pairwise(rows)
        if abs(float(a["travel_outer_mm"]) - float(b["travel_outer_mm"])) > 2
    ]
    assert leaps
    assert all(a["branch"] != b["branch"] for a, b in leaps)


def test_the_replay_is_pythons():
    _, page = ask("replay")
    assert page.decode() == replay(sw.preset("paper-forward"))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"what": "../x", "kind": "svg"}, "ask.what"),
        ({"what": "force", "kind": "/x"}, "ask.kind"),
        ({"what": "samples", "kind": "svg"}, "must be csv"),
        ({"what": "force"}, "ask.kind"),
    ],
)
def test_what_cannot_be_exported_is_refused(keys: Any, words: str):
    header, _ = ask("export", **keys)
    assert words in header["problems"][0]["text"]
