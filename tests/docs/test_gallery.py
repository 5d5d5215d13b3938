"""The gallery: every preset is in it, and what is kept of each is what the engine says now."""

import base64
import hashlib
import json
import re
import zlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mkdocs", reason="the gallery's pages are not tested: mkdocs is not installed")
pytest.importorskip("mujoco", reason="the gallery's robots are not tested: mujoco is not installed")

import runpy

import stepwell as sw
from docs.machines import FOLDER, computed, draw, entries
from docs.pages import ROOT
from sizes import cases
from stepwell import files
from stepwell.simulation import Walk
from stepwell.studio.message import unpacked
from stepwell.studio.motion import arrays_of, drawn

LOOK = SimpleNamespace(**runpy.run_path(str(ROOT / "docs" / "look" / "machines.py")))
PRESETS = list(files.presets())
# Frozen runs guard the engine for every preset; what is kept of each follows from that.
OF_EACH_KIND = ["three-wave", "kresling", "countdown", "robot-left"]
AGAIN = "run `python tests/docs/machines.py {}`"


def kept(name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the replay of a machine plays: its header and its arrays."""
    text = (FOLDER / f"{name}.motion").read_text("utf-8")
    return unpacked(zlib.decompress(base64.b64decode(text)))


def stale(entry: dict[str, Any]) -> list[str]:
    """What of an entry is not of today's preset and today's engine, at first sight."""
    name = entry["name"]
    now = {
        "title": files.presets().get(name),
        "design": hashlib.sha256(files.preset_text(name).encode()).hexdigest(),
        "version": sw.__version__,
    }
    return [key for key, value in now.items() if entry[key] != value]


def along(arrays: dict[str, Any], block: str) -> np.ndarray[Any, Any]:
    """A block at even shares of the way through travels and forces.

    Another processor may round a sample more or less into a way.
    """
    parts = [np.column_stack([arrays[name]]) for name in ("travel", "force")]
    steps = [np.sum(np.diff(part, axis=0) ** 2, axis=1) / np.ptp(part) ** 2 for part in parts]
    way = np.concatenate([[0.0], np.cumsum(np.sqrt(np.sum(steps, axis=0)))])
    at = np.linspace(0.0, way[-1], 2001)
    return np.array([np.interp(at, way, column) for column in np.column_stack([arrays[block]]).T])


def values(svg: str) -> list[list[str]]:
    """What each moving part of a picture goes through."""
    return [one.split(";") for one in re.findall(r'<animate[^>]* values="([^"]*)"', svg)]


def test_every_preset_is_in_the_gallery_and_nothing_else():
    assert list(entries()) == PRESETS
    kinds = ("svg", "motion")
    wanted = {f"{name}.{kind}" for name in PRESETS for kind in kinds} | {"machines.json"}
    assert {file.name for file in FOLDER.iterdir()} == wanted


@pytest.mark.parametrize("name", PRESETS)
def test_what_is_kept_is_of_todays_design_and_version(name):
    assert stale(entries()[name]) == [], AGAIN.format(name)


def test_another_design_and_another_version_are_found_out():
    entry = entries()["dome"] | {"design": "0" * 64, "version": "0.0"}
    assert stale(entry) == ["design", "version"]


@pytest.mark.slow
@pytest.mark.shown
@pytest.mark.parametrize("name", cases(PRESETS, OF_EACH_KIND))
def test_what_is_kept_is_what_the_engine_says_now(name, tmp_path):
    machine = computed(name)
    assert machine.entry == entries()[name], AGAIN.format(name)
    draw(machine.motion, tmp_path / "now.svg")
    same = (tmp_path / "now.svg").read_text("utf-8") == (FOLDER / f"{name}.svg").read_text("utf-8")
    assert same, AGAIN.format(name)
    header, arrays = kept(name)
    assert header["title"] == entries()[name]["title"]
    assert header["version"] == sw.__version__
    if isinstance(machine.motion, Walk):
        walk = machine.motion
        begin = int(np.searchsorted(walk.time, 0.0))
        time = np.cumsum(arrays["time"].ravel()) * header["steps"]["time"]
        for axis in ("x", "y"):
            told = np.cumsum(arrays[axis].ravel()) * header["steps"][axis]
            now = np.interp(time, walk.time[begin:], getattr(walk, axis)[begin:] * 1e3)
            assert told == pytest.approx(now, abs=0.1), AGAIN.format(name)
    else:
        now = arrays_of(drawn(machine.motion.path))
        for block in ("drive", "stroke", "force", "travel"):
            told, size = along(now, block), np.ptp(now[block])
            assert along(arrays, block) == pytest.approx(told, rel=1e-4, abs=1e-4 * size), block


def test_all_is_small():
    heavy = [file.name for file in FOLDER.iterdir() if file.stat().st_size > 170_000]
    assert heavy == []
    assert sum(file.stat().st_size for file in FOLDER.iterdir()) < 4_000_000
    # Three cards stand beside each other, and those below wait until they are looked for.
    cards = "".join(LOOK.cards(LOOK.machines()))
    assert cards.count("<img") == cards.count('loading="lazy"') == 2 * len(PRESETS)


@pytest.mark.parametrize("name", PRESETS)
def test_pictures_move_and_their_stills_do_not(name):
    moving = (FOLDER / f"{name}.svg").read_text("utf-8")
    through = values(moving)
    assert len(through) >= 3
    assert all(len(set(frames)) > 1 for frames in through)
    # A band that is not slack has no dashes: "none" is no number.
    counts = [{len(numbers(one)) for one in frames if one != "none"} for frames in through]
    assert all(len(count) == 1 for count in counts)
    still = LOOK.still(moving)
    assert "<animate" not in still
    assert len(still) < 25_000
    # It is not the first instant but one in the middle of it all.
    assert still != re.sub(r"<animate\w* [^>]*/>", "", moving)
    assert not re.search(r"<script|<image|href|@import|javascript", moving)


def numbers(text: str) -> list[str]:
    return re.findall(r"-?\d+(?:\.\d+)?", text)


def test_a_still_is_between_the_frames_around_it():
    part = (
        '<path d="M0 0"><animate attributeName="d" keyTimes="0;0.2;0.4;1" '
        'values="M0 0;M10 2;M30 -2;M0 0"/></path><g opacity="0"><animate attributeName="opacity" '
        'calcMode="discrete" keyTimes="0;0.25" values="0;1"/>snap</g><path d="M1 1">'
        '<animateTransform attributeName="transform" type="translate" keyTimes="0;1" '
        'values="0 0;10 -10"/></path>'
    )
    assert LOOK.still(part) == (
        '<path d="M20.0 0.0"></path><g opacity="1">snap</g>'
        '<path d="M1 1" transform="translate(3.0 -3.0)"></path>'
    )


@pytest.mark.parametrize("name", PRESETS)
def test_a_card_and_a_page_have_all_there_is_to_each_machine(name):
    cards = "\n".join(LOOK.cards(LOOK.machines()))
    assert cards.count(f'id="{name}-card"') == 1
    for link in (f"{name}/", f"{name}.html", f"{name}/#studio", f"{name}/#design-file"):
        assert f'href="{link}"' in cards
    page = LOOK.page(entries()[name])
    assert f"$ stepwell studio preset:{name}\n" in page
    assert f"$ stepwell replay preset:{name}" in page
    assert f"```toml\n{files.preset_text(name)}```" in page
    assert f"```python\n{entries()[name]['python']}```" in page
    assert "\n#> " in entries()[name]["python"]


def test_the_lines_of_a_page_run_as_they_stand():
    from docs.pages import run

    assert run("gallery/dome.md", LOOK.page(entries()["dome"])) == 1


def test_the_list_is_readable():
    text = (FOLDER / "machines.json").read_text("utf-8")
    assert text == json.dumps(list(entries().values()), indent=1, ensure_ascii=False) + "\n"


def test_a_page_that_lost_its_cards_is_refused():
    page: Any = SimpleNamespace(file=SimpleNamespace(src_uri="gallery.md"))
    text = Path(ROOT / "docs" / "gallery.md").read_text("utf-8")
    assert LOOK.on_page_markdown(text, page=page).count('class="card"') == len(PRESETS)
    with pytest.raises(Exception, match=r"docs/gallery\.md has lost its line"):
        LOOK.on_page_markdown("# Gallery", page=page)
