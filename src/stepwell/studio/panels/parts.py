"""Panels of the solid parts of a chain: their shapes, the checks of a build, its files."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np

from stepwell import accounts
from stepwell.base import InputError, Vec2, need, to_unit
from stepwell.build import (
    BuildFile,
    Layout,
    Part,
    RobotBuild,
    build,
    build_presets,
    contour_path,
    dumps_build_file,
    layout as layout_of,
    loads_build_file,
    preset_text,
    sweep,
)
from stepwell.files import dumps
from stepwell.mechanism import Chain
from stepwell.robot import Robot, body_names
from stepwell.studio.ask import Ask, PageDesign, View

USUAL = "acrylic-3mm"
# Names of the layers of a stack by their fields.
_LAYERS = {
    "stop": "Stop plates",
    "bottom": "Bottom plates",
    "middle": "Levers and spacers",
    "top": "Top plates",
}


def answer_parts(design: PageDesign, ask: Ask) -> View:
    """The shapes of all parts, fasteners and bands, and what their places depend on.

    Each path of SVG [mm], y down, is in the frame of the part's `body`: ["block", i],
    ["lever", cell, 0 or 1] or ["bar"]. At angles θ, block i + 1 is (offset + lever sin θ,
    side lever cos θ) from block i, y up, with the numbers of `joints`. Levers turn around the
    joints of their inner block, at `half_mm` on either side of the offset. The bar is at `bar_mm`:
    x from the last block, y from the fixed one.
    """
    build_file = material(ask)
    ask.close()
    layout = layout_of(design.chain, build_file)
    # At angles of 0 a lever points across the stroke: the step to the next block is the offset.
    blocks = layout.positions(np.zeros(len(layout.cells)))
    header = {
        "materials": materials(),
        "layers": _layers(layout),
        "parts": [_part(layout, part) for part in layout.parts],
        "fasteners": list(_fasteners(layout)),
        "bands": [
            {
                "name": f"band {one.number + 1} of cell {one.cell + 1}",
                "cell": one.cell,
                "p_mm": _mm(one.p),
                "q_mm": _mm(one.q),
                "width_mm": to_unit(one.width, "mm"),
                "holes": one.holes,
            }
            for one in layout.bands
        ],
        "joints": [
            {
                "offset_mm": to_unit(float(offset), "mm"),
                "lever_mm": to_unit(one.cell.lever, "mm"),
                "side": one.side,
            }
            for one, offset in zip(layout.cells, np.diff(blocks[:, 0]), strict=True)
        ],
        "half_mm": to_unit(build_file.lever.spacing / 2.0, "mm"),
        "bar_mm": _mm((_bar(layout), layout.bar_y)),
        "box_mm": _box(layout),
    }
    holes = [
        (number, *_mm(hole.centre), to_unit(hole.diameter, "mm"))
        for number, part in enumerate(layout.parts)
        for hole in part.holes
    ]
    return View(header, {"holes": np.array(holes)})


def answer_build(design: PageDesign, ask: Ask) -> View:
    """The record of `stepwell build --json`, its `answer`, and `overlaps` with angles.

    A first part has the sweep alone; ways out of collisions and the yield take longer. With `whole`
    the record is that of the robot, whose overlaps have `moved`, the table of panel `robot_parts`
    at the deepest pose, instead of angles; of the first ones, as many as there are findings.
    """
    subject, build_file = _subject(design, ask), material(ask)
    ask.close()
    need("build")
    if isinstance(subject, Robot):
        made = build(subject, build_file, progress=ask.report)
        assert isinstance(made, RobotBuild)
        swept = made.sweep
        overlaps = list(_robot_overlaps(made))
    else:
        swept = sweep(layout_of(subject, build_file), ask.report)
        overlaps = [
            {"parts": one.parts, "angles_deg": np.degrees(one.angles).tolist()}
            for one in swept.collisions
        ]
    ask.show(View({"sweep": {"free": swept.free}, "overlaps": overlaps}))
    account = accounts.account(build(subject, build_file, swept=swept))
    return View({**account.record, "answer": account.answer, "overlaps": overlaps})


# Overlaps with a pose: a robot of wrong sizes has hundreds.
_SHOWN = 12


def _robot_overlaps(made: RobotBuild) -> Iterator[dict[str, Any]]:
    names = body_names(made.drawing)
    for number, one in enumerate(made.sweep.collisions):
        found: dict[str, Any] = {"parts": one.parts}
        if number < _SHOWN:
            values = {key: np.array([value]) for key, value in one.pose}
            moved = made.layout.motions.table(names, values)[0]
            moved[:, :3] = to_unit(moved[:, :3], "mm")
            found["moved"] = moved.tolist()
        yield found


def _subject(design: PageDesign, ask: Ask) -> Chain | Robot:
    """The robot if its parts are asked as a `whole`, else the chain that is shown."""
    return design.robot if ask.switch("whole", default=False) else design.chain


_LONGEST_NESTING = 60.0


def answer_parts_files(design: PageDesign, ask: Ask) -> View:
    """The bytes of a ZIP file with the files of `stepwell build --out`, its page without pictures.

    If checks failed, `draft` is needed; each file then says so. `seconds` limits the nesting.
    """
    from stepwell.build import FileOptions, build_files, draft_comment

    subject, build_file = _subject(design, ask), material(ask)
    seconds = ask.number("seconds", 0.0, _LONGEST_NESTING, 10.0)
    draft = ask.switch("draft", default=False)
    ask.close()
    made = build(subject, build_file)
    options = FileOptions(nest=seconds, draft=draft)
    account, parts = accounts.account(made), build_files(made, options, progress=ask.report)
    comment = draft_comment(made)
    every = {
        "report.html": accounts.page(account),
        "build.json": json.dumps(account.record, indent=2, allow_nan=False) + "\n",
        "build.toml": comment + dumps_build_file(build_file),
        "design.toml": comment + dumps(subject),
        **parts,
    }
    return View({"suffix": "zip"}, {"file": np.frombuffer(_zipped(every), np.uint8)})


def _zipped(every: Mapping[str, str | bytes]) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in every.items():
            # Without a time, so that equal builds are equal
            packed.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return file.getvalue()


def material(ask: Ask) -> BuildFile:
    """The requested preset of a build file; a path is none."""
    name, presets = ask.text("material", 100, USUAL), build_presets()
    if name not in presets:
        raise InputError(f"ask.material = {name!r}: must be {', '.join(presets)}.")
    return _preset(name)


@cache
def _preset(name: str) -> BuildFile:
    return loads_build_file(preset_text(name), name)


def materials() -> list[dict[str, str]]:
    """Name and title of every preset of a build file."""
    return [{"name": name, "title": _preset(name).title} for name in build_presets()]


def _mm(place: Vec2) -> list[float]:
    return [to_unit(one, "mm") for one in place]


def _layers(layout: Layout) -> list[dict[str, Any]]:
    """Role, name and z of each layer, from below."""
    stack, used = layout.stack, {part.layer: part for part in layout.parts}
    roles = [role for role in _LAYERS if getattr(stack, role) is not None]
    return [
        {
            "role": role,
            "name": _LAYERS[role],
            "low_mm": to_unit(used[number].base, "mm"),
            "high_mm": to_unit(used[number].top, "mm"),
        }
        for number, role in enumerate(roles)
    ]


def _part(layout: Layout, part: Part) -> dict[str, Any]:
    left, bottom, right, top = part.outline.bounds
    return {
        "name": part.name,
        "mark": part.mark,
        "layer": part.layer,
        "body": layout.body[part.name],
        "width_mm": to_unit(right - left, "mm"),
        "height_mm": to_unit(top - bottom, "mm"),
        "mass_g": to_unit(part.mass(layout.build_file.sheet.density), "g"),
        # Round holes apart: in the sweep they count as solid.
        "path": "".join(map(contour_path, (part.outline, *part.cutouts))),
    }


def _fasteners(layout: Layout) -> Iterator[dict[str, Any]]:
    for one in layout.fasteners:
        if one.use != "shim":
            yield {
                "name": f"{one.use} {one.name} of block {one.block}",
                "use": one.use,
                "size": one.size,
                "block": one.block,
                "at_mm": _mm(one.centre),
                "diameter_mm": to_unit(one.diameter, "mm"),
            }


def _bar(layout: Layout) -> float:
    """x of the drive bar from the last block [m], the same at all angles."""
    still = [0.0] * len(layout.cells)
    return layout.frames(still)["drive-bar"][0] - float(layout.positions(still)[-1, 0])


def _box(layout: Layout) -> list[float]:
    """Left, bottom, right, top [mm] of all parts over all angles of all cells."""
    limits = np.array([one.cell.limit for one in layout.cells])
    # A block is farthest along the stroke at stops, across it at stops or midway.
    steps = np.diff([layout.positions(k * limits) for k in (-1.0, 0.0, 1.0)], axis=1)
    origin = np.zeros((1, 2))
    low = np.concatenate([origin, np.cumsum(steps.min(axis=0), axis=0)])
    high = np.concatenate([origin, np.cumsum(steps.max(axis=0), axis=0)])
    bar = _bar(layout)
    corners: list[Vec2] = []
    for part in layout.parts:
        kind, *number = layout.body[part.name]
        left, bottom, right, top = part.outline.bounds
        if kind == "block":
            (x0, y0), (x1, y1) = low[int(number[0])], high[int(number[0])]
        elif kind == "bar":
            (x0, y0), (x1, y1) = (low[-1, 0] + bar, layout.bar_y), (high[-1, 0] + bar, layout.bar_y)
        else:  # levers lie between blocks
            continue
        corners += [(x0 + left, y0 + bottom), (x1 + right, y1 + top)]
    return [*_mm(np.min(corners, axis=0)), *_mm(np.max(corners, axis=0))]
