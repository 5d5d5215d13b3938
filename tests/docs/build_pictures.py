"""Pictures of the pages on parts: a mechanism or a robot, a step of its guide, its sheet.

`python tests/docs/build_pictures.py` writes docs/img/build; a test compares them.
"""

from pathlib import Path

import stepwell as sw
from stepwell.build import MotionSweep, layout, load_build_file
from stepwell.build.exports.guide import guide
from stepwell.build.exports.page import Page, Pen
from stepwell.build.exports.robot_guide import robot_guide
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
    shown |= _of_robot()
    return {f"{name}.svg": _framed(page).svg(name) for name, page in shown.items()}


def _of_robot() -> dict[str, Page]:
    """A robot with antennas, and the step of its guide that adds the Vs."""
    # The sweep has no part in the pictures.
    free = MotionSweep(True, (), (), (), 0, 0)
    made = sw.build(sw.preset("robot-antennas"), swept=free)
    content = robot_guide(made, ())
    (step,) = (one for one in content.steps if one.step.title == "Antennas and cranks")
    return {"robot-whole": content.whole, "robot-step": step.picture}


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, text in pictures().items():
        (FOLDER / name).write_text(text, "utf-8")
