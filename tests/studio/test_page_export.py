"""What is exported from the page in a browser."""

import stepwell as sw
from stepwell.studio.standalone import replay
from studio.browser import output

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
    assert downloaded(page, "Replay as HTML")[1].decode() == replay(sw.preset("paper-forward"))
