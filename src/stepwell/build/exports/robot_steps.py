"""Steps of a robot's assembly: posts, rails, Vs, sliders, carriage, blocks, antennas, bands."""

import re
from collections.abc import Iterator
from typing import NamedTuple

from stepwell.base import counted, grouped
from stepwell.build.contour import MM
from stepwell.build.exports.steps import AssemblyStep
from stepwell.build.part import Part
from stepwell.build.plates import Fastener
from stepwell.build.robots.robot_builds import RobotBuild


class _Rule(NamedTuple):
    """A step: its parts and fasteners by patterns of their names, the latter after their use."""

    title: str
    parts: str
    fasteners: str
    text: str


_NOTHING = "(?!)"
# The first rule that fits an item takes it.
_RULES = (
    _Rule(
        "T-foot",
        "t-foot",
        r"(screw|head|nut) support.*|standoff post.*|screw post-\d+-b",
        "Screw a support into each outer hole of the T-foot, between two nuts, and a post on each "
        "countersunk screw.",
    ),
    _Rule(
        "Body plate",
        "body-plate",
        r"screw post-\d+-a",
        "Screw the body plate on the posts, heads flush, or the carriage catches on them.",
    ),
    _Rule(
        "Vs with feet",
        r".*-link-.*|.*-foot-\d|.*-tab\d?",
        r"pin .*(?<!crank)-(pivot|foot-pin)",
        "Assemble both Vs on the table: one front link between two tabs, two rear links around "
        "one tab, two discs on the pin of the foot. Pins are pressed into tabs and discs; links "
        "turn without force.",
    ),
    _Rule(
        "Flanges and cores",
        r".*-(flange|core)",
        r"shim .*-(slider|carriage)-\d",
        "Put the tabs through their flanges from below, lay shims on, put the core into the rail "
        "over the tenons. Cores slide in the rail without force; if they do not, sand them.",
    ),
    _Rule(
        "Slider tops and carriage",
        r".*-slider-top|carriage-bar",
        r"pin .*-(slider|carriage)-\d",
        "Press two pins through top, shims, core and flange of each slider. A drop of glue holds "
        "them. Push the carriage from end to end: friction here acts on the inner cells alone.",
    ),
    _Rule(
        "Actuator",
        r"(holder|bracket)-\d",
        r"pin (holder|bracket)-pin",
        "Press the tenons of two cheeks into the body plate and of two into the carriage bar. Lay "
        "the actuator between the cheeks, rod to the rear, and push the pins through its holes. "
        "Fasten battery and board under the body plate with hook-and-loop tape, which counts in "
        "their height; cables pass through its windows.",
    ),
    _Rule(
        "Bottom plates",
        r".*-body-mount|.*-bottom",
        r"(screw|head) .*-mount-\d|pin .*-(a|b|slider-pin|carriage-pin)|"
        r"pin .*-(outer|middle-\w+)-\d",
        "Put screws through the body plate from below, mounts and bottom plates on them. Press all "
        "pins into the bottom plates of middle and outer blocks; the lower ends of the long pins "
        "run in the slots of sliders and carriage.",
    ),
    _Rule(
        "Levers and spacers",
        r".*-lever-.*|.*-spacer(?<!antenna-spacer)",
        r"shim .*(?<!crank-pivot)",
        "Put shims and levers on the pins of the joints, spacers and shims on all others. Each "
        "lever turns without force.",
    ),
    _Rule(
        "Top plates",
        r".*-top",
        r"nut .*-mount-\d",
        "Press the top plates on, marks up, and turn on the nuts until the plates do not move.",
    ),
    _Rule(
        "Antennas and cranks",
        r".*-antenna|.*-antenna-spacer|.*-crank",
        r"pin .*-(hub|crank-pivot)|stop .*|shim .*-crank-pivot",
        "Press hub pins and stops. Put spacer and antenna on each hub, one under the nose and one "
        "above it, and a crank on each pivot between its two stops. Tie a cord from each antenna "
        "to its crank, just not slack while both are at rest.",
    ),
    _Rule("Hooks", _NOTHING, r"hook .*", "Press the hooks into the named holes."),
    _Rule("Caps", _NOTHING, r"cap .*", "Push a cap on each hook, above its band."),
)
# Bands come before the caps.
_BEFORE_CAPS = len(_RULES) - 1


def robot_steps(build: RobotBuild) -> list[AssemblyStep]:
    """All steps; every part, fastener and band is in one of them."""
    layout = build.layout
    found: dict[int, list[Part | Fastener]] = {}
    for part in layout.parts:
        found.setdefault(_rule(part.name, fastener=False), []).append(part)
    for one in layout.fasteners:
        found.setdefault(_rule(f"{one.use} {one.name}", fastener=True), []).append(one)
    made = [_step(rule, found.get(i, [])) for i, rule in enumerate(_RULES)]
    made = [
        one._replace(new=(*one.new, *layout.boxes)) if one.title == "Actuator" else one
        for one in made
    ]
    lines = tuple(_band_lines(build))
    bands = AssemblyStep(
        "Bands",
        "band",
        f"Hook over two hooks each: {counted(len(lines), 'band')}.",
        lines,
        layout.bands,
    )
    made.insert(_BEFORE_CAPS, bands)
    return [one for one in made if one.new]


def _rule(name: str, *, fastener: bool) -> int:
    for number, rule in enumerate(_RULES):
        if re.fullmatch(rule.fasteners if fastener else rule.parts, name):
            return number
    raise AssertionError(f"{name}: no step of the assembly has it.")


def _step(rule: _Rule, items: list[Part | Fastener]) -> AssemblyStep:
    parts = [one for one in items if isinstance(one, Part)]
    shown = [one for one in items if isinstance(one, Fastener) and one.use != "head"]
    heads = tuple(one for one in items if isinstance(one, Fastener) and one.use == "head")
    names = ", ".join(f"{one.name} ({one.mark})" for one in parts)
    details = [f"Parts: {names}"] if names else []
    for size, same in grouped((one.size, one) for one in shown).items():
        holes = dict.fromkeys(one.name for one in same)
        listed = ", ".join([*holes][:6]) + (", ..." if len(holes) > 6 else "")
        details.append(f"{len(same)} x {size} ({listed})")
    return AssemblyStep(rule.title, "robot", rule.text, tuple(details), (*parts, *shown), heads)


def _band_lines(build: RobotBuild) -> Iterator[str]:
    for one in build.bands:
        cell, inner, outer = build.band_words(one)
        yield (
            f"Band {one.number + 1} of {cell}: {MM * one.rest_length:.4g} mm long when slack, from "
            f"{inner} to {outer}"
        )
