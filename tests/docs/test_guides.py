"""Guides for contributors, and the draft of the paper with the numbers of the claims."""

import json
import re
import tomllib

import pytest

from docs.pages import ROOT


def read(file: str) -> str:
    return (ROOT / file).read_text("utf-8")


@pytest.mark.parametrize("file", ["CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md"])
def test_guides_link_to_files_that_exist(file):
    for target in re.findall(r"\]\(([^)#]+)", read(file)):
        assert (ROOT / target).exists(), target


def test_the_contribution_guide_names_targets_of_make_and_folders_that_exist():
    text = read("CONTRIBUTING.md")
    makefile = read("Makefile")
    targets = re.findall(r"\bmake (\w+)", text)
    assert len(set(targets)) >= 4
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.M), target
    for place in re.findall(r"`((?:src|tests|docs)/[\w./]+)`", text):
        assert (ROOT / place).exists(), place


def test_issue_forms_ask_for_the_design_and_the_installation():
    form = read(".github/ISSUE_TEMPLATE/bug.yml")
    assert "stepwell doctor" in form and "Design file" in form


def test_the_counts_in_the_draft_of_the_paper_are_those_of_the_claims():
    text = " ".join(read("joss/paper.md").partition("<!-- counts")[2].split())
    claims = json.loads(read("docs/claims.json"))["claims"]
    others = json.loads(read("docs/others.json"))["claims"]
    count = {v: sum(one["verdict"] == v for one in claims) for v in ("agrees", "differs")}
    open_, data = (
        sum(one["verdict"] == verdict for one in claims)
        for verdict in ("undetermined", "needs data")
    )
    assert f"recomputes {len(claims)} claims" in text
    assert f"{count['agrees']} agree, {count['differs']} differ, {open_} cannot be decided" in text
    assert f"and {data} need recordings" in text
    assert f"recomputes {len(others)} results" in text


def test_every_citation_of_the_draft_is_in_its_bibliography_and_every_entry_is_cited():
    cited = set(re.findall(r"@(\w+\d{4})", read("joss/paper.md")))
    entries = set(re.findall(r"^@\w+\{(\w+),", read("joss/paper.bib"), re.M))
    assert cited == entries


def test_the_titles_of_citation_file_and_site_agree_with_the_version():
    version = tomllib.loads(read("pyproject.toml"))["project"].get("version")
    assert version is None or f"version: {version}" in read("CITATION.cff")
