"""The line for a terminal that begins the same study."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from stepwell.base import told_in
from stepwell.mechanism import Chain
from stepwell.studies import Axis, How, Space, Study, Workshop, asked


def command_of(study: Study) -> str:
    """`stepwell sweep ...` on files that the page's Save writes, and a list of designs if any."""
    subject, given = study.subject, study.given
    # As the page's Save names it.
    stem = re.sub(r"[^a-z0-9]+", "-", subject.title.lower()).strip("-")[:40] or "design"
    words = ["stepwell", "sweep", study.what, f"{stem}.toml"]
    if study.what == "program":
        words += ["--from", str(given["start"])] if given.get("start") else []
        words += ["--to", str(given["to"])]
    elif study.what == "walk":
        words += ["--cycles", str(given.get("cycles", 4))]
    elif study.what == "maze":
        words += ["--arena", "arena.toml", "--limit", f"{given['limit']:g}"]
        for name in ("layouts", "first"):
            words += [f"--{name}", str(given[name])] if given.get(name) else []
    elif study.what == "call":
        words += ["--function", f"{Path(str(given['file'])).name}:{given['name']}"]
    words += _designs(study)
    usual = asked(subject, study.what, study.designs, study.folder, given=given).chunk
    words += ["--chunk", str(study.chunk)] if study.chunk != usual else []
    return shlex.join([*words, "--out", study.folder.name])


def _designs(study: Study) -> list[str]:
    designs = study.designs
    seed = ["--seed", str(designs.seed)] if designs.seed else []
    if isinstance(designs, Workshop):
        within = designs.tolerances
        spread = {
            "--anchor": within.anchor * 1e3,
            "--stiffness": within.stiffness * 100,
            "--rest-length": within.rest_length * 100,
            "--lever": within.lever * 1e3,
            "--travel": within.travel * 100,
        }
        told = [
            word
            for name, value in spread.items()
            if value or name in ("--anchor", "--stiffness")
            for word in (name, f"{value:.12g}")
        ]
        return ["--built", str(designs.count), *told, *seed]
    if not isinstance(designs, Space):
        return ["--table", "designs.csv"]
    words = [word for axis in designs.axes for word in ("--vary", _axis(study, axis))]
    if designs.how is How.GRID:
        return words
    return [*words, f"--{designs.how}", str(designs.count), *seed]


def _axis(study: Study, axis: Axis) -> str:
    factor = 1.0
    if isinstance(study.subject, Chain):
        factor = told_in(study.varied[axis.name])[1]
    ends = ":".join(f"{value * factor:.12g}" for value in (axis.low, axis.high))
    assert isinstance(study.designs, Space)
    count = f":{axis.count}" if study.designs.how is How.GRID else ""
    return f"{axis.name}={ends}{count}{':log' * axis.log}"
