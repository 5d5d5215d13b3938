"""Pictures of docs/how-to/cut-and-assemble.md: the mechanism, a step of its guide, its sheet.

`python tests/docs/build_pictures.py` writes docs/img/build; a test compares them.
"""

from pathlib import Path

import stepwell as sw
from stepwell.build import layout, load_build_file
from stepwell.build.exports.guide import guide
from stepwell.build.exports.page import Page, Pen
from stepwell.build.exports.sheets import sheets
from stepwell.mechanism import Chain

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "img" / "build"
_EDGE = 3.0  # white around a picture [mm]


def _framed(page: Page) -> Page:
    """The picture on white, for pages with a dark background."""
    framed = Page(page.width + 2.0 * _EDGE, page.height + 2.0 * _EDGE)
    corners = [(0.0, 0.0), (framed.width, 0.0), (framed.width, framed.height), (0.0, framed.height)]
    framed.line(corners, Pen(None, "#ffffff"), closed=True)
    framed.insert(page, (_EDGE, _EDGE))
    return framed


def pictures() -> dict[str, str]:
    """Names and contents of the pictures."""
    chain = sw.preset("paper-forward")
    assert isinstance(chain, Chain)
    made = layout(chain, load_build_file("acrylic-3mm"))
    # In rows, which are the same every time.
    nested = sheets(made.parts, (0.30, 0.20), seconds=0)
    content = guide(made, nested, title=chain.title)
    (step,) = (one for one in content.steps if one.step.kind == "lever")
    ((sheet, _),) = step.maps
    shown = {"whole": content.whole, "step": step.picture, "sheet": sheet}
    return {f"{name}.svg": _framed(page).svg(name) for name, page in shown.items()}


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, text in pictures().items():
        (FOLDER / name).write_text(text, "utf-8")
