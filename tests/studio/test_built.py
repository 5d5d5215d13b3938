"""The page that is shipped is what its sources give: nobody who installs it needs Node."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from sizes import SIZE

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "src" / "stepwell" / "studio" / "page"


def run(npm: str, sources: Path, *words: str) -> None:
    done = subprocess.run([npm, *words], cwd=sources, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def add_the_panel_of_the_docs(sources: Path) -> None:
    text = (ROOT / "docs" / "how-to" / "studio.md").read_text("utf-8")
    pieces = re.findall(r'```\w+ title="studio/(src/panels/[^"]*)"\n(.*?)```', text, re.DOTALL)
    assert [name for name, _ in pieces] == ["src/panels/stops.ts", "src/panels/Stops.svelte"]
    for name, content in pieces:
        (sources / name).write_text(content, "utf-8")
    index = sources / "src" / "panels" / "index.ts"
    listed = index.read_text("utf-8").replace("Panel[] = [", "Panel[] = [stops, ")
    index.write_text('import stops from "./stops";\n' + listed, "utf-8")


@pytest.mark.slow
def test_the_shipped_page_is_what_its_sources_give_and_the_docs_panel_fits_in(
    sources: Path, tmp_path: Path
):
    npm = shutil.which("npm")
    assert npm is not None
    run(npm, sources, "run", "build", "--", "--outDir", str(tmp_path / "page"))
    built = {file.name: file.read_bytes() for file in (tmp_path / "page").iterdir()}
    assert built == {file.name: file.read_bytes() for file in SHIPPED.iterdir()}, (
        "the page is not that of its sources: run `make page` and commit what it changes"
    )
    others = tmp_path / "studio"
    shutil.copytree(sources, others, ignore=shutil.ignore_patterns("node_modules"))
    (others / "node_modules").symlink_to(sources / "node_modules")
    add_the_panel_of_the_docs(others)
    # The types of all that is shipped and of that panel, which is compiled for them.
    run(npm, others, "run", "check")
    if SIZE == "ci":
        return
    run(npm, others, "run", "build", "--", "--outDir", str(tmp_path / "other"))
    assert "stops" in (tmp_path / "other" / "studio.js").read_text("utf-8")
