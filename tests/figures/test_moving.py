"""The moving SVG: true to the path, small, a picture like any other, whole or not written."""

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest

from figures.drawn import PRESETS
from stepwell import figures, files
from stepwell.mechanism import Chain, layout

SVG = "{http://www.w3.org/2000/svg}"


def drawn(result, tmp_path, **how) -> ElementTree.Element:
    return ElementTree.parse(figures.moving(result, tmp_path / "a.svg", **how)).getroot()


def numbers(text: str) -> np.ndarray:
    return np.array([float(one) for one in re.findall(r"-?\d+\.?\d*", text)])


def at(path: ElementTree.Element, share: float) -> np.ndarray:
    """The numbers of a path at a share of the round, as whoever plays it finds them."""
    (animate,) = path.findall(f"{SVG}animate")
    times = [float(one) for one in animate.attrib["keyTimes"].split(";")]
    values = np.array([numbers(one) for one in animate.attrib["values"].split(";")])
    return np.array([np.interp(share, times, column) for column in values.T])


def levers(root: ElementTree.Element) -> ElementTree.Element:
    (path,) = (one for one in root.iter(f"{SVG}path") if "#joint" in one.get("marker-start", ""))
    return path


def test_levers_keep_their_length_and_are_where_the_path_has_them(tmp_path):
    chain = files.preset("paper-forward")
    cycle = chain.cycle()
    root = drawn(cycle, tmp_path)
    linkage = layout.ChainLayout(chain)
    path = levers(root)
    first = numbers(path.attrib["d"]).reshape(-1, 2, 2)
    scale = np.hypot(*(first[0, 1] - first[0, 0])) / chain.cells[0].lever
    for share in np.linspace(0, 1, 41):
        lengths = np.hypot(*np.diff(at(path, share).reshape(-1, 2, 2), axis=1)[:, 0].T)
        assert lengths == pytest.approx(scale * chain.cells[0].lever, abs=1.5)
    # Half-way through the round the actuator is at its far end.
    full = linkage.pose(chain.full_travels).levers
    across = np.ptp(at(path, 0.5).reshape(-1, 2)[:, 0])
    assert across == pytest.approx(scale * np.ptp(full[..., 0]), abs=1.0)


def test_a_cycle_ends_as_it_begins_and_a_program_where_it_leads(tmp_path):
    chain = files.preset("paper-forward")
    path = levers(drawn(chain.cycle(), tmp_path))
    assert at(path, 1.0) == pytest.approx(at(path, 0.0))
    path = levers(drawn(chain.program("01"), tmp_path))
    assert np.abs(at(path, 1.0) - at(path, 0.0)).max() > 10


def test_a_snap_has_its_word_while_it_lasts(tmp_path):
    def words(name: str) -> list[ElementTree.Element]:
        root = drawn(files.preset(name).cycle(), tmp_path)
        return [one for one in root.iter(f"{SVG}animate") if one.get("calcMode") == "discrete"]

    assert words("paper-via-01") == []
    (seen,) = words("paper-forward")
    # Two snaps, each of which comes and goes.
    assert seen.attrib["values"].split(";") == ["0", "1", "0", "1", "0"]


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_every_machine_of_the_gallery_moves_in_a_small_file(tmp_path, name):
    chain = files.preset(name)
    root = drawn(chain.cycle(), tmp_path)
    assert (tmp_path / "a.svg").stat().st_size < 100_000
    moves = {animate.tag.removeprefix(SVG) for animate in root.iter() if "animate" in animate.tag}
    assert moves
    left, top, wide, high = numbers(root.attrib["viewBox"])
    for path in root.iter(f"{SVG}path"):
        for animate in path.findall(f"{SVG}animate[@attributeName='d']"):
            points = np.concatenate(
                [numbers(re.sub("h0", "", one)) for one in animate.attrib["values"].split(";")]
            ).reshape(-1, 2)
            assert (points >= (left - 1, top - 1)).all() and (points <= (wide + 1, high + 1)).all()
    # Nothing in it is run or fetched.
    text = (tmp_path / "a.svg").read_text("utf-8")
    assert not re.search(r"<script|<image|href|@import|javascript", text)


def test_a_title_of_any_letters_is_text(tmp_path):
    chain = files.preset("paper-cell-10-0")
    assert isinstance(chain, Chain)
    title = '<script>&"\x1b\x00\ud800'
    root = drawn(replace(chain, title=title).cycle(), tmp_path)
    assert root.findtext(f"{SVG}title") == '<script>&"\\x1b\\x00\\ud800'


@pytest.mark.parametrize(
    ("how", "words"),
    [({"seconds": 0}, "seconds = 0"), ({"seconds": 61}, "at most 60"), ({}, "must end in .svg")],
)
def test_what_cannot_be_written_is_refused_and_leaves_nothing(tmp_path, how, words):
    cycle = files.preset("paper-forward").cycle()
    name = "a.svg" if how else "a.gif"
    with pytest.raises(ValueError, match=words):
        figures.moving(cycle, tmp_path / name, **how)
    assert not [*tmp_path.iterdir()]
