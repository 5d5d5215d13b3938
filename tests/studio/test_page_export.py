"""What is exported from the page in a browser."""

import json

import stepwell as sw
from stepwell import files
from stepwell.accounts import account
from stepwell.studio.standalone import replay
from studio.browser import Opened, output

from playwright.sync_api import Page, expect  # isort: skip


def downloaded(page: Page, name: str) -> tuple[str, bytes]:
    with page.expect_download(timeout=60_000) as saved:
        page.get_by_role("button", name=name, exact=True).click()
    return saved.value.suggested_filename, saved.value.path().read_bytes()


def test_a_figure_the_samples_and_the_replay_are_saved(page: Page):
    page.get_by_role("button", name="Export").click()
    name, data = downloaded(page, "Force as PDF")
    assert name.startswith("forward-leg") and name.endswith("-force.pdf")
    assert data.startswith(b"%PDF-")
    expect(output(page, "export")).to_have_text("")
    assert b"branch" in downloaded(page, "Samples as CSV")[1].splitlines()[0]
    record = account(sw.preset("paper-forward").cycle()).record
    assert json.loads(downloaded(page, "Result as JSON")[1]) == record
    saved = downloaded(page, "Save page of the motion")[1].decode()
    assert saved == replay(sw.preset("paper-forward"))


def test_a_copied_link_opens_without_a_server_and_holds_the_design(page: Page, beside: Opened):
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Export").click()
    page.get_by_role("button", name="Copy link of the motion").click()
    expect(output(page, "link")).to_contain_text("Copied")
    beside.page.goto(page.evaluate("navigator.clipboard.readText()"))
    expect(output(beside.page, "sequence")).to_have_attribute("data-value", "00>10>11>01>00")
    expect(beside.page.get_by_text("stepwell studio forward-leg")).to_be_visible()
    name, text = downloaded(beside.page, "Save design file")
    assert name.startswith("forward-leg") and name.endswith(".toml")
    assert files.loads(text.decode()).chain == sw.preset("paper-forward")
