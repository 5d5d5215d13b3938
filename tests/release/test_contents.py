"""What wheel and sdist hold, and what they say of themselves."""

import re
import tarfile
import zipfile
from email.message import Message
from email.parser import Parser
from pathlib import Path

import pytest

import stepwell as sw
from release.trying import ROOT
from stepwell.base.extras import EXTRAS

Built = tuple[Path, Path]


@pytest.fixture(scope="module")
def metadata(built: Built) -> Message:
    with zipfile.ZipFile(built[0]) as wheel:
        (name,) = [one for one in wheel.namelist() if one.endswith(".dist-info/METADATA")]
        return Parser().parsestr(wheel.read(name).decode())


def held(sdist: Path) -> set[str]:
    with tarfile.open(sdist) as files:
        return {name.partition("/")[2] for name in files.getnames()}


def sources() -> set[str]:
    found = (one for one in (ROOT / "src").rglob("*") if one.is_file())
    kept = (one for one in found if "__pycache__" not in one.parts)
    return {one.relative_to(ROOT / "src").as_posix() for one in kept}


def test_the_wheel_holds_the_package_whole_and_nothing_else(built: Built):
    with zipfile.ZipFile(built[0]) as wheel:
        names = set(wheel.namelist())
        assert wheel.testzip() is None
    own = {name for name in names if ".dist-info/" not in name}
    assert own == sources()
    for name in ("py.typed", "studio/page/index.html", "files/presets/paper-forward.toml"):
        assert f"stepwell/{name}" in own
    assert {name.partition("/")[2] for name in names - own} == {
        "METADATA", "WHEEL", "RECORD", "entry_points.txt", "licenses/LICENSE",
    }  # fmt: skip


def test_the_sdist_holds_what_building_and_testing_it_takes(built: Built):
    names = held(built[1])
    assert {f"src/{name}" for name in sources()} <= names
    for folder in ("tests", "docs", "examples", "benchmarks", "studio/src"):
        ours = (one for one in (ROOT / folder).rglob("*") if one.is_file())
        kept = {one.relative_to(ROOT).as_posix() for one in ours if "__pycache__" not in one.parts}
        assert kept <= names, sorted(kept - names)
    for name in (
        "pyproject.toml", "LICENSE", "README.md", "CHANGELOG.md", "CITATION.cff", "Makefile",
        "mkdocs.yml", "requirements.lock", "requirements-lowest.lock", "studio/package-lock.json",
    ):  # fmt: skip
        assert name in names, name
    assert not [name for name in names if "node_modules" in name or "__pycache__" in name]


def test_the_metadata_says_what_a_package_index_shows(metadata: Message):
    assert (metadata["Name"], metadata["Version"]) == ("stepwell", sw.__version__)
    assert metadata["License-Expression"] == "Apache-2.0"
    assert metadata["License-File"] == "LICENSE"
    assert metadata["Requires-Python"] == ">=3.11"
    # One that installers and indexes of today know.
    assert tuple(map(int, metadata["Metadata-Version"].split("."))) <= (2, 4)
    assert 20 < len(metadata["Summary"]) <= 512 and "\n" not in metadata["Summary"]
    assert {*metadata.get_all("Provides-Extra", [])} == {*EXTRAS, "all", "dev", "docs"}
    classifiers = metadata.get_all("Classifier", [])
    assert "Typing :: Typed" in classifiers
    # An index refuses an upload with a licence told twice.
    assert not [one for one in classifiers if one.startswith("License ::")]


def test_the_first_page_goes_along_as_markdown(metadata: Message):
    assert metadata["Description-Content-Type"] == "text/markdown"
    text = str(metadata.get_payload())
    assert text.strip() == (ROOT / "README.md").read_text("utf-8").strip()
    assert text.startswith("# Stepwell") and text.count("```") % 2 == 0


def test_the_core_asks_for_no_more_than_it_opens(metadata: Message):
    asked = [one for one in metadata.get_all("Requires-Dist", []) if "extra ==" not in one]
    names = {re.split(r"[^\w-]", one)[0] for one in asked}
    assert not names & {package for extra in EXTRAS.values() for package in extra.packages}


def test_the_version_is_one_in_package_citation_and_changelog():
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    (version,) = re.findall(r"^version: (\S+)$", citation, re.M)
    dates = re.findall(r"^date-released: (\S+)$", citation, re.M)
    newest, *older = re.findall(
        r"^## (\S+)(?: \((.*)\))?$", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.M
    )
    assert version == sw.__version__ == newest[0]
    # A date is told once the version is out, and then it is the same in both.
    assert dates == ([] if newest[1] == "unreleased" else [newest[1]])
    assert all(re.fullmatch(r"\d{4}-\d\d-\d\d", date) for _, date in older)
    assert all(re.fullmatch(r"\d{4}-\d\d-\d\d", date) for date in dates)
