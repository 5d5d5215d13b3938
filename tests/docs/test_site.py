"""The site as its visitors have it: built, served on this machine, and looked at in a browser."""

from __future__ import annotations

import json
import os
import re
import runpy
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest

from chromium import Opened, needed, nothing_found
from docs.pages import ROOT
from docs.screenshots import FOLDER, SCHEMES, labels, taken
from docs.site import lost, outside, read, shown
from docs.test_pages import difference
from sizes import SIZE, cases
from stepwell import files
from stepwell.accounts import schema_kinds, schema_of
from stepwell.files import preset_text

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect
pytest.importorskip("material", reason="the site is not tested: mkdocs-material is not installed")
pytestmark = pytest.mark.slow

HOOKS = SimpleNamespace(**runpy.run_path(str(ROOT / "docs" / "look" / "hooks.py")))

# What people type, and the pages of which one has to be among the first three.
ASKED = {
    "rubber band": {"glossary/", "tutorial/", "how-to/bands-loads-friction/"},
    "how do I cite": {""},
    "q_mm": {"design-files/", "tutorial/", "lessons/"},
    "stepwell maze": {"commands/robots/", "how-to/robots/"},
    "snap": {"glossary/", "tutorial/", "how-to/landings/", "how-to/masses/"},
    "friction": {"how-to/bands-loads-friction/", "tutorial/"},
    "turn the robot": {"how-to/robots/"},
    "unit cell": {"glossary/"},
    "yield": {"glossary/", "how-to/design-for-a-purpose/"},
    "lesson": {"lessons/"},
    "atlas": {"atlas/"},
    "sweep": {"commands/parameter-studies/", "how-to/many-designs/"},
    "which number decides": {"what-decides/", "how-to/many-designs/"},
}
# In the quick run a thing, a question, a key of a file and a command are asked for, and a chain and
# a robot are opened.
ASKED_NOW = cases(ASKED, list(ASKED)[:4])
MACHINES = ["countdown", "robot-explorer"]
if SIZE == "full":
    MACHINES += ["paper-forward", "dome"]
LOOKS: dict[str, dict[str, Any]] = {
    "light": {"viewport": {"width": 1280, "height": 800}, "color_scheme": "light"},
    "dark on a phone": {"viewport": {"width": 360, "height": 740}, "color_scheme": "dark"},
}


def build(folder: Path, **environment: str) -> Path:
    """The pages, built strictly; told to be quiet it would not count warnings."""
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "-d", str(folder)]
    done = subprocess.run(
        words,
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1", **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


# The path of the site on its server: it need not be the only site there.
UNDER = "/sub/path/"

# What does not fold as prose does, each with how wide it may be.
_WIDE: dict[str, tuple[str, Callable[[str], int]]] = {
    "word": (r">([^<]+)<", lambda text: max(map(len, text.split()), default=0)),
    "table": (r"<tr>(.*?)</tr>", lambda row: row.count("<t")),
    "lines": (r"<pre\b.*?</pre>", lambda text: max(map(len, text.splitlines()))),
    "formula": (r"<math\b.*?</math>", len),
    "picture": (r'<img\b[^>]* width="(\d+)"', int),
    "frame": (r"<iframe\b.*?>", len),
}


def _widest(site: Path) -> set[str]:
    """The pages that have the widest of each kind, and the first of the whole site."""
    found = {"/"}
    articles = {
        path: (site / path.lstrip("/") / "index.html").read_text("utf-8").partition("<article")[2]
        for path in paths(site)
    }
    for pattern, wide in _WIDE.values():
        widths = {
            path: max(map(wide, re.findall(pattern, text, re.S)), default=0)
            for path, text in articles.items()
        }
        found.add(max(widths, key=widths.__getitem__))
    return found


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    addresses = {
        "STEPWELL_REPOSITORY": "https://forge.example/us/stepwell/",
        "STEPWELL_SITE": f"https://pages.example{UNDER}",
    }
    return build(tmp_path_factory.mktemp("site"), **addresses)


@pytest.fixture(scope="module")
def home(site: Path) -> Iterator[str]:
    with shown(site, UNDER) as address:
        yield address


@pytest.fixture(scope="module")
def chromium(request: pytest.FixtureRequest) -> Browser:
    needed()
    return request.getfixturevalue("browser")


@pytest.fixture(scope="module")
def windows(chromium: Browser) -> Iterator[dict[str, Opened]]:
    """A page of each look for all that does not ask what comes when a site is first visited."""
    contexts = {look: chromium.new_context(**how) for look, how in LOOKS.items()}
    yield {look: Opened(context.new_page()) for look, context in contexts.items()}
    for context in contexts.values():
        context.close()


@pytest.fixture
def window(windows: dict[str, Opened]) -> Iterator[Page]:
    page = windows["light"].page
    yield page
    # Pictures that move keep a core busy.
    page.goto("about:blank")


@pytest.fixture(scope="module")
def offline(chromium: Browser) -> Iterator[Opened]:
    context = chromium.new_context(offline=True, **LOOKS["light"])
    yield Opened(context.new_page())
    context.close()


def paths(site: Path) -> list[str]:
    """Every page, as its address has it."""
    return sorted(
        str(file.parent.relative_to(site)).replace(".", "", 1) + "/"
        for file in site.rglob("index.html")
    )


def test_every_link_anchor_and_picture_leads_somewhere(site):
    assert len(paths(site)) > 50
    assert lost(site, UNDER) == []


def test_the_schema_of_every_result_is_served_and_committed_nowhere(site):
    served = {file.stem: file.read_text("utf-8") for file in (site / "schema").glob("*.json")}
    assert served == {kind: json.dumps(schema_of(kind), indent=2) + "\n" for kind in schema_kinds()}
    assert not [*(ROOT / "docs").rglob("schema/*.json"), *(ROOT / "src").rglob("schemas/*.json")]


def test_a_link_to_nowhere_is_found_out(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "index.html").write_text('<p id="here">')
    text = '<a href="there/#here"></a><a href="there/#gone"></a><img src="no.png"><a href="#x"></a>'
    (tmp_path / "index.html").write_text(text + '<a href="../../"></a><a href="/there"></a>')
    wrong = ["there/#gone", "#x", "../../", "no.png"]
    assert lost(tmp_path) == [f"index.html: {link}" for link in wrong]


def test_links_that_leave_the_site_are_addresses_of_the_web_by_https(site):
    found = {link for file in site.rglob("*.html") for link in read(file).links if outside(link)}
    assert "https://arxiv.org/abs/2409.03737" in found
    for link in sorted(found):
        parts = urlsplit(link)
        assert parts.scheme == "https", link
        assert re.fullmatch(r"[a-z0-9-]+(\.[a-z0-9-]+)+", parts.netloc), link
        assert not re.search(r"[\s<>\"{}|\\^`]", link), link


def test_every_picture_says_in_words_what_it_shows(site):
    assert [one for file in site.rglob("*.html") for one in read(file).silent] == []


def test_pages_name_no_file_of_another_host(site):
    for file in site.rglob("*.html"):
        assert [one for one in read(file).loads if outside(one) and "data:" not in one] == []
    for file in site.rglob("*.css"):
        assert not re.search(r"url\([\"']?(https?:)?//|@import", file.read_text("utf-8")), file


def test_displayed_formulas_are_typeset_and_none_is_left_as_source(site):
    for name, least in (("theory", 25), ("robot-theory", 4)):
        text = (site / name / "index.html").read_text("utf-8")
        assert text.count('<div class="formula"') >= least
        typeset = re.sub(r' alttext="[^"]*"', "", text)
        assert not re.search(r"\\(frac|sum|left|text|qquad|cos)|```", typeset)
        assert re.search(r"\w<sub>\w</sub>", text)


def test_the_link_to_the_sources_comes_from_one_place(site, monkeypatch):
    text = (site / "index.html").read_text("utf-8")
    assert re.search(r'href="https://forge\.example/us/stepwell"[^>]*class="md-source"', text)
    assert "us/stepwell" in re.sub(r"<[^>]*>", " ", text)
    told = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    monkeypatch.delenv("STEPWELL_REPOSITORY", raising=False)
    known = told["project"].get("urls", {}).get("Repository", "")
    assert HOOKS.repository() == known.rstrip("/")
    config = SimpleNamespace(mdx_configs={}, repo_url=None, repo_name=None)
    assert bool(HOOKS.on_config(config).repo_url) == bool(known)


# Every kind of page; in the quick run each in one of the looks.
KINDS = ["", "tutorial/", "theory/", "commands/analysis/", "gallery/", "gallery/countdown/"]
LIGHT, DARK = (cases(KINDS, KINDS[k::2]) for k in range(2))


def test_on_a_phone_no_page_scrolls_sideways_keeps_anybody_out_or_asks_another_host(
    windows, site, home, axe
):
    opened = windows["dark on a phone"]
    wide = {}
    known = {path.lstrip("/") for path in (paths(site) if SIZE == "full" else _widest(site))}
    for path in sorted(known | {*DARK}):
        opened.page.goto(home + path, wait_until="load")
        width = opened.page.evaluate(
            "() => { scrollTo(9999, 0); return [document.documentElement.scrollWidth, scrollX]; }"
        )
        if width != [360, 0]:
            wide[path] = width
        if path in DARK:
            nothing_found(opened.page, axe)
    opened.page.goto("about:blank")
    assert wide == {}
    assert not opened.wrong
    assert [url for url in opened.asked if not url.startswith((home, "data:", "blob:"))] == []


# Whether each of these is on one line.
WHOLE = "(all) => all.every((one) => one.getClientRects().length === 1)"


def test_the_table_of_claims_fits_a_desktop_and_options_stay_whole(window, home):
    window.set_viewport_size({"width": 1440, "height": 900})
    window.goto(home + "claims/")
    wide = window.locator(".md-typeset__scrollwrap")
    assert wide.evaluate("(one) => one.scrollWidth <= one.clientWidth")
    window.goto(home + "commands/")
    options = window.locator("p code .whole")
    assert {"--help", "'.[robot]'"} <= {*options.all_inner_texts()}
    assert options.evaluate_all(WHOLE)
    window.set_viewport_size({"width": 390, "height": 844})
    window.goto(home + "commands/robots/")
    names = window.locator("td:first-child code", has_not_text=re.compile(r"\s"))
    assert {"--cycles", "stepwell"} <= {*names.all_inner_texts()}
    assert names.evaluate_all(WHOLE)
    window.set_viewport_size(LOOKS["light"]["viewport"])


@pytest.fixture(scope="module")
def searching(windows: dict[str, Opened], home: str) -> Iterator[Page]:
    """A page whose search is open, and has read its index."""
    page = windows["light"].page.context.new_page()
    page.goto(home + "decisions/")
    page.keyboard.press("s")
    yield page
    page.close()


@pytest.mark.parametrize("words", ASKED_NOW)
def test_a_search_finds_first_what_one_wants_to_do(searching, words):
    results = searching.locator("li.md-search-result__item > a.md-search-result__link")
    box = searching.get_by_role("textbox", name="Search")
    box.fill("")
    expect(results).to_have_count(0)
    # Typed key by key: the page listens to keys, and a value that is put in after it is ready
    # is never asked for.
    box.press_sequentially(words)
    results.first.wait_for()
    searching.wait_for_timeout(500)
    found = [one.get_attribute("href") or "" for one in results.all()[:5]]
    pages = [urlsplit(link).path.removeprefix(UNDER) for link in found]
    assert set(pages[:3]) & ASKED[words], pages
    assert not any(page.startswith("decisions/") for page in pages[:3]), pages


def test_an_address_without_a_page_shows_links_and_a_search_at_any_depth(chromium, home, axe):
    context = chromium.new_context(**LOOKS["dark on a phone"])
    page = context.new_page()
    missing: list[str] = []
    page.on("response", lambda one: missing.append(one.url) if one.status == 404 else None)
    address = home + "how-to/no/such/page/"
    page.goto(address, wait_until="load")
    assert missing == [address]
    expect(page.get_by_role("heading", level=1)).to_have_text("Page not found")
    assert page.evaluate("document.documentElement.scrollWidth") == 360
    nothing_found(page, axe)
    page.get_by_role("article").get_by_role("link", name="Tutorial").click()
    assert page.url == home + "tutorial/"
    page.go_back()
    page.get_by_role("searchbox", name="Search all pages").fill("rubber band")
    page.get_by_role("article").get_by_role("button", name="Search").click()
    first = page.locator("li.md-search-result__item > a.md-search-result__link").first
    expect(first).to_be_visible()
    assert (first.get_attribute("href") or "").startswith(home)
    assert {*missing} == {address}
    context.close()


@pytest.mark.parametrize("path", LIGHT)
def test_the_pages_are_accessible(window, home, axe, path):
    window.goto(home + path)
    nothing_found(window, axe)


@pytest.mark.parametrize("name", MACHINES)
def test_a_machine_of_the_gallery_has_its_file_its_lines_and_its_replay(
    site, home, window, offline, name, tmp_path
):
    """One of every kind; its replay is opened from a file, with no network."""
    assert (site / "gallery" / f"{name}.toml").read_text("utf-8") == preset_text(name)
    window.goto(f"{home}gallery/{name}/")
    # Who copies a block takes what is in its element "code".
    blocks = window.locator("article pre > code").all_inner_texts()
    assert blocks[0].strip() == f"$ stepwell studio preset:{name}"
    assert f"stepwell replay preset:{name}" in blocks[1]
    assert f'sw.preset("{name}")' in blocks[2]
    assert files.tables_in(blocks[3], name) == files.tables_in(preset_text(name), name)
    saved = tmp_path / "saved.html"
    saved.write_bytes((site / "gallery" / f"{name}.html").read_bytes())
    offline.asked.clear()
    offline.page.goto(saved.as_uri())
    slider = offline.page.get_by_role("slider").first
    began = slider.input_value()
    offline.page.get_by_role("button", name=re.compile("^Play")).first.click()
    expect(slider).not_to_have_value(began)
    offline.page.goto("about:blank")
    assert not offline.wrong
    assert [url for url in offline.asked if not url.startswith("data:")] == [saved.as_uri()]


def shots(page: Page, name: str) -> tuple[bytes, bytes]:
    """The card of a machine, twice, half a second apart."""
    card = page.locator(f"#{name}-card a").first
    card.scroll_into_view_if_needed()
    expect(card.locator("img:visible")).to_have_js_property("complete", True)
    first = card.screenshot()
    page.wait_for_timeout(500)
    return first, card.screenshot()


def test_pictures_of_the_gallery_move_unless_they_are_asked_not_to(chromium, window, home):
    names = cases(("robot-left", "metachronal-wave"), ("robot-left",))
    window.goto(home + "gallery/")
    for name in names:
        first, second = shots(window, name)
        assert first != second
    window.get_by_role("checkbox", name="Hold all pictures still").check()
    for name in names:
        first, second = shots(window, name)
        assert first == second
    window.goto("about:blank")
    context = chromium.new_context(reduced_motion="reduce", **LOOKS["light"])
    opened = Opened(context.new_page())
    opened.page.goto(home + "gallery/")
    for name in names:
        first, second = shots(opened.page, name)
        assert first == second
        assert not [url for url in opened.asked if url.endswith(f"/{name}.svg")]
    context.close()


# From the left [px], of all at once: each word to a browser takes as long as all of them.
PLACES = "(all) => all.map((one) => Math.round(one.getBoundingClientRect().x))"


def test_the_gallery_on_a_phone_has_one_card_beside_another_and_loads_few_at_first(chromium, home):
    context = chromium.new_context(**LOOKS["dark on a phone"])
    opened = Opened(context.new_page())
    sizes: list[int] = []
    opened.page.on("response", lambda one: sizes.append(len(one.body())) if one.ok else None)
    opened.page.goto(home + "gallery/", wait_until="load")
    places = opened.page.locator(".machines > .card").evaluate_all(PLACES)
    assert len(places) == len(files.presets())
    assert len({*places}) == 1
    pictures = [url for url in opened.asked if url.endswith(".svg") and "/gallery/" in url]
    assert 0 < len(pictures) < len(places) / 2
    context.close()
    # As they come, before anybody packs them.
    assert sum(sizes) < 3_000_000


@pytest.mark.parametrize(("path", "columns"), [("", 2), ("gallery/", 3)])
def test_cards_stand_side_by_side_on_paper(window, home, path, columns):
    window.set_viewport_size({"width": 794, "height": 1123})
    window.emulate_media(media="print")
    window.goto(home + path)
    assert len({*window.locator(".cards > .card").evaluate_all(PLACES)}) == columns
    window.set_viewport_size(LOOKS["light"]["viewport"])
    window.emulate_media(media="null")


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    needed("starlette", "uvicorn", "websockets")
    from studio.browser import served

    with served(tmp_path_factory.mktemp("studio"), "paper-forward") as address:
        yield address


@pytest.mark.parametrize("scheme", cases(SCHEMES, SCHEMES[1:]))
def test_pictures_of_the_studio_show_what_it_is_now(chromium, studio, tmp_path, scheme):
    kept = FOLDER / f"{scheme}.png"
    now = taken(chromium, studio, scheme)
    (tmp_path / "now.png").write_bytes(now)
    again = "run `python tests/docs/screenshots.py`"
    assert labels(now) == labels(kept.read_bytes()), again
    assert difference(tmp_path / "now.png", kept) < 4.0, again
    other = FOLDER / f"{SCHEMES[1 - SCHEMES.index(scheme)]}.png"
    # But for the button that leads from one to the other, both say the same.
    here, there = (
        [one for one in labels(file.read_bytes()) if not one.endswith(" colours")]
        for file in (kept, other)
    )
    assert here == there, again
    assert difference(kept, other) > 40.0, "one of the two is in the other's colours"
