"""The notebooks run from a fresh kernel, show what they promise, and are stored without outputs."""

import os
import re
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from sizes import cases

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = ROOT / "examples" / "notebooks"
NAMES = ("maker", "researcher", "roboticist", "learner")
# In the quick run one of them; what the others show has tests of its own.
RUN = cases(NAMES, NAMES[:1])
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


def executed(notebook: Any, folder: Path) -> list[list[Any]]:
    """The outputs of each cell of code of a notebook that was run in an empty folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT / "src")]))
        # What a kernel opens is on this machine only; it says so on every start.
        patch.setenv("JUPYTER_PLATFORM_DIRS", "1")
        for name in ("IPYTHONDIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR"):
            patch.setenv(name, str(folder / name.lower()))
        resources = {"metadata": {"path": str(folder)}}
        NotebookClient(notebook, timeout=600, kernel_name="python3", resources=resources).execute()
    return [cell.outputs for cell in notebook.cells if cell.cell_type == "code"]


def shown(outputs: list[Any]) -> list[str]:
    """The HTML of what was shown, without bars that are gone."""
    told = (output.get("data", {}).get("text/html", "") for output in outputs)
    return [html for html in told if html]


DRAW = 'import stepwell as sw\nsw.preset("paper-forward").cycle().path.plot()'
BAR = """
from time import sleep
import stepwell as sw
for k in range(4):
    sw.bar(k, {})
    sleep(0.15)
"""
# A figure, another one after the magic, two bars.
MORE = (DRAW, f"%matplotlib inline\n{DRAW}", BAR.format(3), BAR.format(9))


@pytest.fixture(scope="module")
def first(tmp_path_factory) -> tuple[list[list[Any]], list[list[Any]]]:
    """The outputs of the first notebook, and of more cells in its kernel, which starts once."""
    notebook: Any = nbformat.read(NOTEBOOKS / f"{NAMES[0]}.ipynb", 4)
    notebook.cells += map(nbformat.v4.new_code_cell, MORE)
    found = executed(notebook, tmp_path_factory.mktemp("first"))
    return found[: -len(MORE)], found[-len(MORE) :]


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("name", RUN)
def test_a_notebook_runs_and_shows_cards_and_figures(name, first, tmp_path):
    cells = first[0]
    if name != NAMES[0]:
        cells = executed(nbformat.read(NOTEBOOKS / f"{name}.ipynb", 4), tmp_path)
    outputs = [out for cell in cells for out in cell]
    assert not [out for out in outputs if out.output_type == "error"]
    # Nothing warns, and a saved notebook holds no bar and no control character.
    assert not [out for out in outputs if out.get("name") == "stderr"]
    assert not CONTROL.search(str([out.get("text", out.get("data")) for out in outputs]))
    html = shown(outputs)
    assert "<progress" not in "".join(html)
    assert sum(one.startswith("<img") for one in html) >= 3
    assert sum("<strong>" in one for one in html) >= 2


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_figure_shows_once_and_a_bar_says_how_far_it_is_and_leaves_nothing(first):
    *figures, done, stopped = first[1]
    # One column of a page, 85 mm, at 144 pixels an inch.
    for outputs in figures:
        (html,) = shown(outputs)
        assert len(outputs) == 1
        assert 'width="482"' in html and "max-width:100%" in html
    assert [one["data"]["text/html"] for one in done] == [""]
    # Of what was not finished, how far it came.
    (last,) = stopped
    assert 'value="3" max="9"' in last["data"]["text/html"]
    assert re.search(r"33%, about \d+ s left", last["data"]["text/html"])


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_is_stored_as_it_was_written(name):
    file = NOTEBOOKS / f"{name}.ipynb"
    notebook: Any = nbformat.read(file, 4)
    nbformat.validate(notebook)
    for cell in notebook.cells:
        assert not cell.get("outputs") and cell.get("execution_count") is None
        assert set(cell.metadata) == set()
    # One layout, so that a change of a word is a change of a line.
    assert file.read_text("utf-8") == nbformat.writes(notebook, indent=1).rstrip() + "\n"
    assert notebook.cells[0].source.startswith("# ")


def test_every_notebook_is_run():
    assert sorted(file.stem for file in NOTEBOOKS.glob("*.ipynb")) == sorted(NAMES)
