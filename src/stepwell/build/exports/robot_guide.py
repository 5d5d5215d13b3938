"""The assembly guide of a robot: a picture for each step, and what to measure at the end."""

from collections.abc import Iterator, Sequence

from stepwell.base import percent
from stepwell.build.contour import MM
from stepwell.build.exports.before import Expected, expected
from stepwell.build.exports.guide import Guide, PicturedStep, full_size, sheet_map
from stepwell.build.exports.page import Page
from stepwell.build.exports.robot_picture import RobotView
from stepwell.build.exports.robot_steps import robot_steps
from stepwell.build.exports.sheets import CutSheet
from stepwell.build.exports.steps import AssemblyStep
from stepwell.build.layouts import layout as chain_layout
from stepwell.build.part import Part
from stepwell.build.plates import Fastener
from stepwell.build.robots.robot_builds import RobotBuild

# Size of a step's picture at most [mm].
_PICTURE = (186.0, 118.0)
_INTRO = (
    "Measure each leg with the rod of the actuator taken off: first the travels without bands, "
    "then hook the bands in and measure the rest. A kitchen scale shows grams."
)
_MARKS = (
    "Marks are engraved: the initials of a part's name, as in LMB for left-middle-bottom. Left and "
    "right parts are mirror images."
)
_ORDER = "supports and rails first, bands last"


def robot_guide(build: RobotBuild, sheets: Sequence[CutSheet], *, draft: str = "") -> Guide:
    """The guide to assemble a robot.

    Args:
        build: of the robot.
        sheets: on which the parts are cut.
        draft: why it is a draft, for every page; empty if it is none.
    """
    layout = build.layout
    view = RobotView(layout, _PICTURE)
    before: list[object] = []
    shown = []
    for step in robot_steps(build):
        picture = view.picture(before, step.new)
        shown.append(PicturedStep(step, picture, tuple(_maps(step, sheets))))
        before += [*step.new, *step.hidden]
    sheet = build.build_file.sheet
    about = (
        f"{len(layout.parts)} parts of {MM * sheet.thickness:g} mm {sheet.material}, "
        f"{sum(one.use != 'head' for one in layout.fasteners)} fasteners, {len(layout.bands)} "
        f"bands, {build.build_file.linear_actuator.name}"
    )
    whole, checks = view.picture(before, ()), tuple(_checks(build))
    return Guide(build.title, about, tuple(shown), whole, checks, _INTRO, draft, _MARKS, _ORDER, "")


def _maps(step: AssemblyStep, sheets: Sequence[CutSheet]) -> Iterator[tuple[Page, str]]:
    """Where the new parts are on their sheets, and the new fasteners at full size."""
    names = {one.name for one in step.new if isinstance(one, Part)}
    for sheet in sheets:
        if names & {part.name for part in sheet.parts}:
            yield sheet_map(sheet, names), f"Lower left corner of sheet {sheet.name}"
    sizes = {one.size: one for one in step.new if isinstance(one, Fastener)}
    for size, one in sizes.items():
        yield full_size(one), f"{size}, at full size"


def _checks(build: RobotBuild) -> Iterator[Expected]:
    """What to measure: of each leg as of a chain, then feet, rails, antennas and actuator."""
    robot = build.drawing
    for leg in robot.legs:
        plan = chain_layout(leg.chain, build.build_file)
        for one in expected(plan, None):
            yield one._replace(what=f"{leg.name} leg: {one.what}")
    errors, foot = build.build_file.tolerance, robot.foot
    yield Expected(
        "Depth of both feet below the plane of the supports, all cells at 0",
        _mm(foot.below),
        f"±\u00a0{_mm(errors.hole)}",
        "Turn the screws of the supports between their nuts.",
    )
    yield Expected(
        "Force that moves a middle slider along its rail, bands off",
        "as small as possible",
        "none",
        "It acts on the inner cell alone. Enter it as blocks.rail_friction_N and compute the gait "
        "again; sand the rail or glue PTFE tape in.",
    )
    for antenna in build.layout.plan.antennas:
        yield Expected(
            f"Displacement of the anchor by antenna {antenna.antenna.name}, from stop to stop",
            _mm(antenna.move),
            f"±\u00a0{_mm(errors.stop)}",
            "Shorter: the cord is too long, or a stop is in the wrong hole.",
        )
    speed = build.build_file.linear_actuator.speed
    yield Expected(
        "Time of the actuator for a full cycle under load",
        f"{build.least_period:.2f}\u00a0s",
        f"±\u00a0{percent(0.1)}",
        f"Longer: set linear_actuator.speed_mm_per_s, now {MM * speed:.3g}, and build again.",
    )


def _mm(value: float) -> str:
    return f"{MM * value:.2f}\u00a0mm"
