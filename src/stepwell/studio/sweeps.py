"""The study of a request, and the command that starts the same study."""

import hashlib
import json
import re
import shlex
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

from stepwell import files, mechanism, robot
from stepwell.base import InputError, display_unit, to_unit
from stepwell.design import parameter
from stepwell.studies import Axis, Designs, How, Space, Study, Workshop, planned_study
from stepwell.studio.ask import Ask, PageDesign
from stepwell.studio.panels.maps import unit_of

OF_CHAINS = ("cycle", "margin", "yield", "graph", "program")
OF_ROBOTS = ("walk", "maze")
BUILT = "built"

_MOST, _MOST_AXES, _FARTHEST = 10_000_000, 12, 1e9
_STEM = 24  # letters of the title in the name of a store
_LAYOUTS, _CYCLES, _LIMIT = 1000, 1000, 3600.0


def asked_study(design: PageDesign, ask: Ask, folder: Path) -> Study:
    """The study of a request, with a name in the folder chosen by the server."""
    what = ask.text("what", 20)
    if what not in (*OF_CHAINS, *OF_ROBOTS):
        known = ", ".join((*OF_CHAINS, *OF_ROBOTS))
        raise InputError(f"ask.what = {what[:40]!r}: must be one of {known}.")
    subject = design.robot if what in OF_ROBOTS else design.chain
    given, designs = _given(what, ask), _designs(subject, ask)
    ask.close()
    study = planned_study(subject, what, designs, folder, given=given)
    digest = hashlib.sha256(json.dumps(study.asked(), sort_keys=True).encode()).hexdigest()
    # The first words of the title, in letters that are valid in every file system.
    words = re.findall(r"[a-z0-9]+", subject.title.lower().partition(":")[0])
    stem = "-".join(words)[:_STEM].strip("-") or "design"
    return replace(study, folder=folder / f"{stem}-{what}-{digest[:8]}.zarr")


def _given(what: str, ask: Ask) -> dict[str, Any]:
    if what == "program":
        start = ask.text("start", 64) if ask.has("start") else None
        return {"start": start, "target": ask.text("target", 64)}
    if what == "walk":
        return {"cycles": ask.whole("cycles", 1, _CYCLES, 4)}
    if what == "maze":
        if not ask.has("arena"):
            raise InputError("ask.arena: is missing; open or draw an arena first.")
        arena = files.loads_arena_tables(ask.table("arena"))
        return {
            "arena": files.dumps(arena),
            "limit": ask.number("limit_s", 1.0, _LIMIT, 600.0),
            "layouts": ask.whole("layouts", 0, _LAYOUTS, 0),
            "first": ask.whole("first", 0, 2**31, 0),
        }
    return {}


def _designs(subject: mechanism.Chain | robot.Robot, ask: Ask) -> Designs:
    how, seed = ask.text("how", 20, How.GRID), ask.whole("seed", 0, 2**32 - 1, 0)
    if how == BUILT:
        if isinstance(subject, robot.Robot):
            raise InputError("ask.how = 'built': robots have no tolerances; let a number vary.")
        return Workshop(ask.tolerances(), ask.whole("count", 1, _MOST), seed)
    if how not in [*How]:
        raise InputError(f"ask.how = {how!r}: must be one of {', '.join(How)}, {BUILT}.")
    axes = tuple(_asked_axis(subject, one, how) for one in ask.parts("vary", _MOST_AXES))
    space = Space(axes, How(how), 0 if how == How.GRID else ask.whole("count", 1, _MOST), seed)
    if space.count > _MOST:
        raise InputError(f"ask.vary: {space.count} designs: must be at most {_MOST}.")
    return space


def _asked_axis(subject: mechanism.Chain | robot.Robot, one: Ask, how: str) -> Axis:
    name, factor = one.text("key", 200), 1.0
    if isinstance(subject, mechanism.Chain):
        _, factor = unit_of(parameter(subject, name))
    else:
        files.key_unit(subject, name)  # or refused
    low, high = (one.number(end, -_FARTHEST, _FARTHEST) for end in ("from", "to"))
    count = one.whole("count", 2, _MOST, 2) if how == How.GRID else 2
    one.close()
    return Axis(name, low / factor, high / factor, count)


def command_of(study: Study) -> str:
    """`stepwell sweep ...` on files that the page's Save writes, and a list of designs if any."""
    subject, given = study.subject, study.given
    # As the page's Save names it.
    stem = re.sub(r"[^a-z0-9]+", "-", subject.title.lower()).strip("-")[:40] or "design"
    words = ["stepwell", "sweep", study.what, f"{stem}.toml"]
    if study.what == "program":
        words += ["--from", str(given["start"])] if given.get("start") else []
        words += ["--target", str(given["target"])]
    elif study.what == "walk":
        words += ["--cycles", str(given.get("cycles", 4))]
    elif study.what == "maze":
        words += ["--arena", "arena.toml", "--limit", f"{given['limit']:g}"]
        for name in ("layouts", "first"):
            words += [f"--{name}", str(given[name])] if given.get(name) else []
    elif study.what == "call":
        words += ["--function", f"{Path(str(given['file'])).name}:{given['name']}"]
    words += _words_of(study)
    usual = planned_study(subject, study.what, study.designs, study.folder, given=given).chunk
    words += ["--chunk", str(study.chunk)] if study.chunk != usual else []
    return shlex.join([*words, "--out", study.folder.name])


def _words_of(study: Study) -> list[str]:
    designs = study.designs
    seed = ["--seed", str(designs.seed)] if designs.seed else []
    if isinstance(designs, Workshop):
        within = designs.tolerances
        spread = {
            "--anchor": (within.anchor, "mm"),
            "--stiffness-tolerance": (within.stiffness, "percent"),
            "--rest-length-tolerance": (within.rest_length, "percent"),
            "--lever-tolerance": (within.lever, "mm"),
            "--travel-tolerance": (within.travel, "percent"),
        }
        given: dict[str, str] = {}
        for name, (value, unit) in spread.items():
            each = value if isinstance(value, tuple) else (value,)
            if any(each) or name in ("--anchor", "--stiffness-tolerance"):
                given[name] = ",".join(f"{to_unit(one, unit):.12g}" for one in each)
        return ["--monte-carlo", str(designs.count), *chain.from_iterable(given.items()), *seed]
    if not isinstance(designs, Space):
        return ["--table", "designs.csv"]
    gridded, words = designs.how is How.GRID, list[str]()
    for axis in designs.axes:
        of_chain = isinstance(study.subject, mechanism.Chain)
        factor = display_unit(study.varied[axis.name])[1] if of_chain else 1.0
        ends = ":".join(f"{value * factor:.12g}" for value in (axis.low, axis.high))
        count = f":{axis.count}" * gridded
        words += ["--vary", f"{axis.name}={ends}{count}{':log' * axis.log}"]
    return words if gridded else [*words, f"--{designs.how}", str(designs.count), *seed]
