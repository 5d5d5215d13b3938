"""The gallery's machines, computed: `python tests/docs/machines.py [NAME...]` writes docs/gallery.

Of every preset, or of those named: what moves on its card (NAME.svg), what its replay plays
(NAME.motion) and its entry in machines.json. The pages are made of them by docs/look/machines.py.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import re
import sys
import time
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import stepwell as sw
from docs.moving_robot import moving_robot
from stepwell import figures, files
from stepwell.mechanism import Chain
from stepwell.sequences import Cycle, Program
from stepwell.simulation import Walk
from stepwell.studio.standalone import replay

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "gallery"
LIST = FOLDER / "machines.json"
# How often a robot goes out and back, and where one with antennas does.
CYCLES, CYCLES_AT_A_WALL = 8, 20
# Six legs have three times the lines of two.
_FEWER_CYCLES = MappingProxyType({"robot-six-legs": 5})
_WALKS = MappingProxyType({"robot-antennas": "wall", "robot-explorer": "wall"})

_CHAIN = """chain = sw.preset("{name}")
print(chain.cycle())
"""
_PLAN = """plan = sw.files.load("preset:{name}").program
print(plan.on(chain))
"""
_ROBOT = """robot = sw.preset("{name}")
walk = robot.walk({cycles})
print(walk)
"""
_ARENA = """robot = sw.preset("{name}")
wall = sw.files.load_arena("{arena}")
walk = robot.walk({cycles}, arena=wall)
print(walk)
"""


class Machine(NamedTuple):
    """A preset as it is now.

    Attributes:
        entry: its entry in machines.json.
        motion: what its card and its replay show.
    """

    entry: dict[str, Any]
    motion: Cycle | Program | Walk


def computed(name: str) -> Machine:
    """What a preset does: its lines of Python are run, and what they print is kept."""
    text = files.preset_text(name)
    design = sw.preset(name)
    plan = files.load(f"preset:{name}").program if isinstance(design, Chain) else None
    if isinstance(design, Chain):
        kind = "chain"
        code, options = _CHAIN + (_PLAN if plan else ""), ""
    else:
        kind, arena = "robot", _WALKS.get(name)
        cycles = CYCLES_AT_A_WALL if arena else _FEWER_CYCLES.get(name, CYCLES)
        code = (_ARENA if arena else _ROBOT).replace("{cycles}", str(cycles))
        code = code.replace("{arena}", arena or "")
        at = f" --arena {arena}" if arena else ""
        options = f"{at} --cycles {cycles}" if cycles != CYCLES else ""
    python, names = _run("import stepwell as sw\n\n" + code.replace("{name}", name))
    motion: Cycle | Program | Walk
    if kind == "robot":
        motion = names["walk"]
    else:
        motion = names["chain"].cycle() if plan is None else plan.on(names["chain"])
    entry = {
        "name": name,
        "title": files.presets()[name],
        "kind": kind,
        "element": name in sw.elements.LIBRARY,
        "program": plan is not None,
        "design": hashlib.sha256(text.encode()).hexdigest(),
        "version": sw.__version__,
        "options": options,
        "python": python,
    }
    return Machine(entry, motion)


def _run(code: str) -> tuple[str, dict[str, Any]]:
    """Code with what each of its prints says below it, and the names it leaves behind."""
    shown: list[str] = []
    names: dict[str, Any] = {}
    for line in code.splitlines():
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(line, names)
        shown += [line, *(f"#> {said}" for said in printed.getvalue().splitlines())]
    return "\n".join(shown) + "\n", names


def draw(motion: Cycle | Program | Walk, file: Path) -> None:
    """The picture of a card."""
    if isinstance(motion, Walk):
        moving_robot(motion, file)
    else:
        figures.moving(motion, file)


def played(motion: Cycle | Program | Walk) -> str:
    """What a replay plays, as it stands in its page."""
    page = replay(motion.path.chain if isinstance(motion, Cycle) else motion)
    (data,) = re.findall(r'id="motion">([^<]*)<', page)
    return data


def entries() -> dict[str, dict[str, Any]]:
    """What machines.json has, by name."""
    if not LIST.exists():
        return {}
    return {one["name"]: one for one in json.loads(LIST.read_text("utf-8"))}


def main() -> None:
    """Compute machines and keep what they do; how long each took is printed."""
    FOLDER.mkdir(exist_ok=True)
    known, presets = entries(), files.presets()
    for name in sys.argv[1:] or presets:
        began = time.perf_counter()
        machine = computed(name)
        draw(machine.motion, FOLDER / f"{name}.svg")
        files.write_atomic(FOLDER / f"{name}.motion", played(machine.motion) + "\n")
        known[name] = machine.entry
        listed = [known[one] for one in presets if one in known]
        files.write_atomic(LIST, json.dumps(listed, indent=1, ensure_ascii=False) + "\n")
        print(f"{name}: {time.perf_counter() - began:.1f} s", flush=True)
    for file in [*FOLDER.glob("*.svg"), *FOLDER.glob("*.motion")]:
        if file.stem not in presets:
            file.unlink()


if __name__ == "__main__":
    main()
