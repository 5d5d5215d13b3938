"""The page that is shipped is what its sources give: nobody who installs it needs Node."""

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "src" / "stepwell" / "studio" / "page"


@pytest.mark.slow
def test_the_shipped_page_is_what_its_sources_give_and_they_are_typed(
    sources: Path, tmp_path: Path
):
    npm = shutil.which("npm")
    assert npm is not None
    for words in (["run", "check"], ["run", "build", "--", "--outDir", str(tmp_path / "page")]):
        done = subprocess.run(
            [npm, *words], cwd=sources, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
    built = {file.name: file.read_bytes() for file in (tmp_path / "page").iterdir()}
    assert built == {file.name: file.read_bytes() for file in SHIPPED.iterdir()}, (
        "the page is not that of its sources: run `make page` and commit what it changes"
    )
