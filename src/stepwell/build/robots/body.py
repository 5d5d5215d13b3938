"""Parts of the body and of the carriage: plate with rails, T-foot, mounts, holder, carriage bar."""

import math
from collections.abc import Iterator

from stepwell.base import Vec2
from stepwell.build.build_file import mm
from stepwell.build.contour import Contour
from stepwell.build.plates import Fastener
from stepwell.build.robots import plan as plans
from stepwell.build.robots.legs import LegMaker
from stepwell.build.robots.making import Bought, Maker, PartFrame, united
from stepwell.build.robots.plan import EDGE, GAP, LegPlan, RobotPlan
from stepwell.robot import PartRole

# Half the width of a bar of the T-foot, and from a support to the post beside it [m].
_BAR, _TO_POST = 7e-3, 17e-3
# Half the length of a cheek that holds the actuator, its edge above the pin, half its tenon [m].
_CHEEK, _ABOVE, _TENON = 4e-3, 4.5e-3, 3e-3
# Length of the countersunk screws in posts [m]; diameter of posts across their flats [m].
_SUNK, _POST = 8e-3, 5.5e-3
# Rear screw of a body's block whose crank needs room: from its row towards the midline [m].
_FAR = 18e-3
# From the joints of the body's block to its two screws [m].
_BESIDE, _AHEAD = 5e-3, 19.5e-3


def body_plate(make: Maker) -> None:
    """The plate with two rails, the nose and its windows."""
    plan = make.plan
    rear, front, half = plan.plate
    reach, narrow = plan.nose
    corners = [(rear, -half), (front, -half), (front, half), (rear, half)]
    if reach > front:
        corners[2:2] = [(front, -narrow), (reach, -narrow), (reach, narrow), (front, narrow)]
    make.now("body", PartRole.BODY)
    make.part(
        "body-plate",
        plan.heights.rail,
        Contour.rounded(corners, plan.build_file.sheet.corner),
        PartFrame(),
        cutouts=[*_rails(plan), *_windows(plan), *_mortises(plan)],
    )


def _rails(plan: RobotPlan) -> Iterator[Contour]:
    (x0, x1), half = plan.rail_ends, plan.build_file.robot.rail / 2.0
    for leg in plan.legs:
        y = leg.side * leg.row
        corners = [(x0, y - half), (x1, y - half), (x1, y + half), (x0, y + half)]
        yield Contour.rounded(corners, 1e-3)


def _windows(plan: RobotPlan) -> Iterator[Contour]:
    """Openings that save weight, and through which cables pass."""
    x0, x1 = plan.plate[0] + EDGE, min(leg.body for leg in plan.legs) - plan.half - EDGE
    near = 16e-3
    far = min(leg.row for leg in plan.legs) - plan.build_file.robot.rail / 2.0 - 6.5e-3
    if far - near < 5e-3 or x1 - x0 < 30e-3:
        return
    middle, rib = (x0 + x1) / 2.0, 4.5e-3
    for side in (-1.0, 1.0):
        for a, b in ((x0, middle - rib), (middle + rib, x1)):
            ends = sorted((side * near, side * far))
            corners = [(a, ends[0]), (b, ends[0]), (b, ends[1]), (a, ends[1])]
            yield Contour.rounded(corners, 3e-3)


def cheeks(plan: RobotPlan, width: float) -> list[float]:
    """y of the lower faces of two cheeks around something of this width [m]."""
    return [width / 2.0 + GAP, -(width / 2.0 + GAP + plan.thick)]


def _mortise(x: float, y: float, thick: float) -> Contour:
    corners = [(x - _TENON, y), (x + _TENON, y), (x + _TENON, y + thick), (x - _TENON, y + thick)]
    return Contour.of(corners)


def _mortises(plan: RobotPlan) -> Iterator[Contour]:
    for y in cheeks(plan, plan.build_file.linear_actuator.width):
        yield _mortise(plan.fixed_hole, y, plan.thick)


def t_foot(make: Maker) -> None:
    """The T-foot: a plate under posts, with an adjustable screw at each support."""
    plan, high = make.plan, make.plan.heights
    supports = [(float(x), float(y)) for x, y in plan.robot.body.supports]
    make.now("body", PartRole.SUPPORT)
    xs = [x for x, _ in supports]
    boxes = [(min(xs) - _BAR, -_BAR, max(xs) + _BAR, _BAR)]
    for x, y in supports:
        ends = sorted((y, 0.0))
        boxes.append((x - _BAR, ends[0] - _BAR, x + _BAR, ends[1] + _BAR))
    outline = united(boxes, plan.build_file.sheet.corner)
    make.part("t-foot", high.foot, outline, PartFrame())
    for number, (x, y) in enumerate(supports):
        at = (x, y - math.copysign(_TO_POST, y)) if abs(y) > _TO_POST else (x + _TO_POST - 5e-3, y)
        _post(make, f"post-{number + 1}", at)
        _nub(make, f"support-{number + 1}", (x, y))


def _post(make: Maker, name: str, at: Vec2) -> None:
    plan, high = make.plan, make.plan.heights
    low, top = high.foot + plan.thick, high.rail
    d = plan.build_file.screw.diameter
    post = f"standoff M{mm(d)} x {mm(top - low)}"
    make.add(Fastener(name, "standoff", post, _POST, make.body, at, low, top))
    size = f"ISO 10642 M{mm(d)} x {mm(_SUNK)}"
    ends = (top + plan.thick - _SUNK, top + plan.thick), (high.foot, high.foot + _SUNK)
    for number, (a, b) in enumerate(ends):
        make.add(Fastener(f"{name}-{'ab'[number]}", "screw", size, d, make.body, at, a, b))


def _nub(make: Maker, name: str, at: Vec2) -> None:
    """A screw whose head stands on the floor, with a nut on either side of the plate."""
    plan, high, screw = make.plan, make.plan.heights, make.plan.build_file.screw
    d = screw.diameter
    low, top = high.floor + screw.head, high.foot + plan.thick + screw.nut
    length = plan.clamp_length(low, top - screw.nut)
    size = f"ISO 7380-1 M{mm(d)} x {mm(length)}"
    make.add(Fastener(name, "screw", size, d, make.body, at, low, low + length))
    make.add(Fastener(name, "head", "", screw.head_width, make.body, at, high.floor, low))
    for base in (high.foot - screw.nut, high.foot + plan.thick):
        if base >= low - 1e-6:
            nut = f"ISO 4032 M{mm(d)}"
            end = base + screw.nut
            make.add(Fastener(name, "nut", nut, screw.nut_width, make.body, at, base, end))


def body_block(one: LegMaker) -> None:
    """The body's block of a leg, on a mount that reaches over no slider."""
    plan, leg, high, make = one.plan, one.leg, one.plan.heights, one.make
    make.now("body", PartRole.BODY)
    crank = plan.antenna_of(leg)
    edge = plan.build_file.screw.hole / 2.0 + plan.build_file.sheet.bridge
    row = plan.spacer + edge
    reach = max(plan.back, row + edge) if crank is None else _FAR + edge
    clear = leg.front + plan.core + 0.5e-3 + plan.build_file.robot.gap
    x0, x1 = leg.body - plan.half, leg.body + _AHEAD + edge
    face = leg.row + plans.near(leg.cells[0]) / 2.0
    plate = (x0, leg.row - reach, x1, face)
    joints = (leg.body, leg.row)
    hooks = [] if crank is not None else one.hooks(0, "p")
    tabs = one.hook_tab(hooks, joints, -1.0) if crank is None else []
    spares = one.spares(0, "p", joints, -1.0, tabs) if crank is None else []
    one.plate("body-mount", high.slide, [(clear, leg.row - reach, x1, face)])
    one.plate("body-bottom", high.bottom, [plate])
    one.plate("body-spacer", high.middle, [(x0, leg.row - reach, x1, leg.row - plan.spacer)])
    one.plate("body-top", high.top, [plate, *tabs], holes=spares)
    one.joint_pins(0, joints)
    # Screws clear of the hooks, or of the crank.
    first = (leg.body + _BESIDE, row) if crank is None else (clear + edge, _FAR)
    _mount(one, "mount-1", one.at(first[0], leg.row - first[1]))
    _mount(one, "mount-2", one.at(leg.body + _AHEAD, leg.row - row))
    if crank is None:
        one.hook_pins(0, "p", joints, -1.0)


def _mount(one: LegMaker, name: str, at: Vec2) -> None:
    """A screw from below through the body plate and all plates of a block."""
    plan, high, screw = one.plan, one.plan.heights, one.plan.build_file.screw
    make, d, label = one.make, one.plan.build_file.screw.diameter, one.name(name)
    length = plan.clamp_length(high.rail, high.roof)
    size = f"ISO 7380-1 M{mm(d)} x {mm(length)}"
    make.add(Fastener(label, "screw", size, d, make.body, at, high.rail, high.rail + length))
    head = high.rail - screw.head
    make.add(Fastener(label, "head", "", screw.head_width, make.body, at, head, high.rail))
    nut, end = f"ISO 4032 M{mm(d)}", high.roof + screw.nut
    make.add(Fastener(label, "nut", nut, screw.nut_width, make.body, at, high.roof, end))
    shim = plan.build_file.lever.shim
    bases = [one - shim for one in (high.slide, high.bottom, high.middle, high.top)]
    make.shims(label, at, bases)


def holder(make: Maker) -> None:
    """The actuator, its two cheeks on the body plate, battery and board."""
    plan, high = make.plan, make.plan.heights
    own, robot = plan.build_file.linear_actuator, plan.build_file.robot
    make.now("body", PartRole.BODY)
    axis = high.rail + plan.thick + GAP + own.height / 2.0
    _cheek_pair(make, "holder", (plan.fixed_hole, high.rail, axis), own.width)
    front = plan.fixed_hole + own.behind
    bottom = high.rail + plan.thick + GAP
    make.boxes.append(
        Bought(
            "actuator",
            own.name,
            "body",
            PartRole.ACTUATOR,
            (front - own.length, -own.width / 2.0, bottom),
            (front, own.width / 2.0, bottom + own.height),
            own.mass,
        )
    )
    for name, ahead, size, mass, role in (
        (
            "battery",
            plan.legs[0].body - plan.half + 3.5e-3,
            robot.battery,
            robot.battery_mass,
            PartRole.BATTERY,
        ),
        ("board", plan.legs[0].rear - 26e-3, robot.board, robot.board_mass, PartRole.BATTERY),
    ):
        length, width, height = size
        make.boxes.append(
            Bought(
                name,
                f"{name} of at most {mm(length)} x {mm(width)} x {mm(height)} mm",
                "body",
                role,
                (ahead, -width / 2.0, high.rail - height),
                (ahead + length, width / 2.0, high.rail),
                mass,
            )
        )


def _cheek_pair(make: Maker, name: str, at: tuple[float, float, float], width: float) -> None:
    """Two upright cheeks with a pin: `at` is x of the pin, z of the tenons' ends, z of the pin."""
    plan, (x, low, axis) = make.plan, at
    stand = low + plan.thick
    corners = [
        (-_TENON, low),
        (_TENON, low),
        (_TENON, stand),
        (_CHEEK, stand),
        (_CHEEK, axis + _ABOVE),
        (-_CHEEK, axis + _ABOVE),
        (-_CHEEK, stand),
        (-_TENON, stand),
    ]
    radii = [0.0] * 4 + [plan.build_file.sheet.corner] * 2 + [0.0] * 2
    bases = cheeks(plan, width)
    for number, base in enumerate(bases):
        outline = Contour.rounded(corners, radii)
        make.part(f"{name}-{number + 1}", base, outline, PartFrame(x, 0.0, 0.0, upright=True))
    reach = bases[0] + plan.thick
    make.pin(f"{name}-pin", (x, axis), (-reach, reach), upright=True)


def carriage(make: Maker, legs: list[LegMaker]) -> None:
    """The carriage: a slider on either side, the bar across both legs, the bracket of the rod."""
    plan, high = make.plan, make.plan.heights
    own, actuator = plan.build_file.robot, plan.build_file.linear_actuator
    make.now("carriage", PartRole.CARRIAGE)
    rear, front = plan.bar
    wide = own.rail / 2.0 + own.flange
    boxes, slots = [], []
    far = max(leg.row for leg in plan.legs) + wide
    boxes.append((rear, -far, front, far))
    for one in legs:
        leg = one.leg
        one.rider("carriage", leg.rear, (0.0,))
        ends = sorted((leg.side * (leg.row - wide), leg.side * (leg.row + wide)))
        boxes.append((rear, ends[0], leg.rear + plan.lead, ends[1]))
        slots.append(_carriage_slot(one, leg))
    mortises = [_mortise(plan.bar_middle, y, plan.thick) for y in cheeks(plan, actuator.rod)]
    outline = united(boxes, plan.build_file.sheet.corner)
    make.part("carriage-bar", high.slide, outline, PartFrame(), cutouts=[*slots, *mortises])
    axis = high.rail + plan.thick + GAP + actuator.height / 2.0
    _cheek_pair(make, "bracket", (plan.bar_middle, high.slide, axis), actuator.rod)
    half = actuator.rod / 2.0
    inside = plan.fixed_hole + actuator.behind - actuator.length + plan.stroke
    make.boxes.append(
        Bought(
            "rod",
            "",
            "carriage",
            PartRole.PIN,
            (plan.bar_middle - 4e-3, -half, axis - half),
            (inside, half, axis + half),
            actuator.rod_mass,
        )
    )


def _carriage_slot(one: LegMaker, leg: LegPlan) -> Contour:
    """The slot for the pin of the outer block, which swings sideways."""
    first, second = leg.cells
    near = leg.row + plans.near(first) - second.lever
    far = leg.row + first.lever - plans.near(second)
    return Contour.slot(one.at(leg.last, near), one.at(leg.last, far), one.plan.slot)
