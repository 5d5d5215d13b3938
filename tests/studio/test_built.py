"""The page that is shipped is what its sources give: nobody who installs it needs Node."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "src" / "stepwell" / "studio" / "page"


@pytest.mark.slow
def test_the_shipped_page_is_what_its_sources_give_and_they_are_typed(tmp_path):
    npm = shutil.which("npm")
    if npm is None and os.environ.get("STEPWELL_REQUIRE_BROWSER") != "1":
        pytest.skip("npm is not installed: the studio's page is not built anew")
    assert npm is not None, "STEPWELL_REQUIRE_BROWSER=1, and npm is not installed"
    sources = tmp_path / "studio"
    shutil.copytree(ROOT / "studio", sources, ignore=shutil.ignore_patterns("node_modules"))
    for words in (
        ["ci", "--no-audit", "--no-fund", "--ignore-scripts"],
        ["run", "check"],
        ["run", "build", "--", "--outDir", str(tmp_path / "page")],
    ):
        done = subprocess.run(
            [npm, *words], cwd=sources, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
    built = {file.name: file.read_bytes() for file in (tmp_path / "page").iterdir()}
    assert built == {file.name: file.read_bytes() for file in SHIPPED.iterdir()}, (
        "the page is not that of its sources: run `make page` and commit what it changes"
    )
