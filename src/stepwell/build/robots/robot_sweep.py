"""Bodies of a robot for a sweep: in plan, layer by layer, and each V in its vertical plane."""

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from stepwell.base import Floats, Progress
from stepwell.build import sweeps
from stepwell.build.contour import Contour
from stepwell.build.part import Part
from stepwell.build.plates import Fastener
from stepwell.build.rigid import Freedom, Overlap, Piece, RigidBody
from stepwell.build.robots.antennas import CORD, Cord
from stepwell.build.robots.making import PartFrame
from stepwell.build.robots.motion import ALONG, ARC, STROKE, TURN, UPRIGHT, Parameter
from stepwell.build.robots.plan import LegPlan
from stepwell.build.robots.robot_layout import RobotBand, RobotLayout
from stepwell.robot import body_names

# Straight pieces of a cord that stand for it, each between its two heights.
_PIECES = 8
# The lower rank stands; it has the slots.
_RANKS = {"crank": 0.0, "body": 1.0, "carriage": 2.0, "slider": 2.0, "block": 3.0}
_LAST, _BANDS = 10.0, 100.0
Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class RobotOverlap(Overlap):
    """Two parts of a robot that overlap at some pose.

    Attributes:
        ranges: least and largest value of each parameter that decides, while they overlap: angle
            of a cell, as ("left", 0), or swing of an antenna, as ("antenna", "left") [rad].
        states: states of the legs, such as "left 1?", at which they overlap; "?" for cells that do
            not matter.
        pose: all parameters at the deepest overlap, as for `RobotLayout.frames`.
    """

    ranges: tuple[tuple[Parameter, float, float], ...]
    states: tuple[str, ...]
    pose: tuple[tuple[Parameter, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFreedom(Freedom):
    """What moves two bodies of a robot relative to each other.

    Attributes:
        names: of the parameters.
        driver: leg whose cells move the carriage.
    """

    names: tuple[Parameter, ...]
    driver: str = ""


@dataclass(frozen=True, slots=True)
class BodyLine:
    """A band, or a piece of a cord, between points of two bodies.

    Attributes:
        ends: body and point [m] of either end, in the reference pose.
        share: places of its own ends on the line between these points, from 0 to 1.
        low, high, width: its z, and its width in plan [m].
    """

    ends: tuple[tuple[str, tuple[float, float]], tuple[str, tuple[float, float]]]
    share: tuple[float, float]
    low: float
    high: float
    width: float


@dataclass(eq=False, kw_only=True)
class RobotBody(RigidBody):
    """A rigid body of a robot; `moves_as` is the body of the layout with its motion."""

    moves_as: str
    extent: float = 0.0


@dataclass(frozen=True)
class SweptRobot:
    """The bodies of a robot in one plane.

    Args:
        layout: of the robot.
        leg: whose V is swept in its vertical plane; None for all parts in plan.
    """

    layout: RobotLayout
    leg: LegPlan | None = None

    def bodies(self) -> list[RobotBody]:
        """All rigid bodies, bands and cords in this plane."""
        return list(self._upright() if self.leg else self._flat())

    def some(self, names: Collection[str]) -> list[RobotBody]:
        """The bodies of these names in plan."""
        return [body for body in self._flat(names) if body.name in names]

    @cached_property
    def _ranges(self) -> dict[Parameter, tuple[float, float]]:
        return self.layout.motions.ranges()

    def _flat(self, wanted: Collection[str] | None = None) -> Iterator[RobotBody]:
        """All bodies, or at least those of the wanted names: pieces of parts take longest."""
        layout = self.layout
        names = [*body_names(layout.robot), "rod"]
        for name in names:
            kind = name.rpartition(".")[2]
            if kind.startswith("link") or kind == "foot":
                continue
            if wanted is None or name in wanted:
                pieces = list(flat_pieces(layout, name))
                yield self._body(name, kind, pieces)
        for leg in layout.plan.legs:
            if wanted is None or _name_of_v(leg) in wanted:
                yield _room_of_v(layout, leg)
        for band in layout.bands:
            ends = tuple(zip(band.bodies, (band.p, band.q), strict=True))
            line = BodyLine((ends[0], ends[1]), (0.0, 1.0), band.low, band.high, band.width)
            held = frozenset(f"{use} {hole}" for hole in band.holes for use in ("hook", "pin"))
            name = f"band {band.number + 1} of {band.leg}.{_cell(layout, band)}"
            yield RobotBody(name=name, moves_as=name, path=line, rank=_BANDS, hooks=held)
        for cord in layout.cords:
            yield from _cord_bodies(cord)

    def _body(self, name: str, kind: str, pieces: Sequence[Piece]) -> RobotBody:
        rank = _RANKS.get(kind if kind in _RANKS else name, _LAST)
        joints: list[tuple[str, int]] = []
        if ".lever " in name:
            cell, _, number = name.rpartition(".lever ")
            joints = [(cell, int(number) - 1)]
        elif kind in ("antenna", "crank"):
            joints = [(name, 0)]
        elif name == "rod":
            joints = [("actuator", 0)]
        moved = self.layout.motions.of(name, {})
        here = tuple(_shifted(one, moved.hinge) for one in pieces)
        extent = max((_extent(one) for one in here), default=0.0)
        return RobotBody(
            name=name,
            moves_as=name,
            pieces=here,
            rank=rank,
            joints=frozenset(joints),
            extent=extent,
        )

    def _upright(self) -> Iterator[RobotBody]:
        assert self.leg is not None
        leg, name = self.leg, self.leg.leg.name
        ranks = {f"{name}.slider": 2.0, "carriage": 2.0, "body": 1.0}
        joints = {"link front": (0, 2), "link rear": (1, 2)}
        for body in ("body", "carriage", *(f"{name}.{kind}" for kind in _V_BODIES)):
            pieces = tuple(upright_pieces(self.layout, body, leg))
            kind = body.rpartition(".")[2]
            moved = self.layout.motions.of(body, {})
            here = tuple(_shifted(one, moved.hinge) for one in pieces)
            yield RobotBody(
                name=body,
                moves_as=body,
                pieces=here,
                rank=ranks.get(body, _LAST),
                joints=frozenset((f"{name}.V", one) for one in joints.get(kind, ())),
                extent=max((_extent(one) for one in here), default=0.0),
            )

    def freedom(self, a: RobotBody, b: RobotBody) -> RobotFreedom:
        """The parameters of two bodies."""
        owners = [self._owner(one) for one in (a, b)]
        driver = owners[0] or owners[1]
        slides = [one.moves_as in ("carriage", "rod") for one in (a, b)]
        if any(slides):
            other = (b if slides[0] else a).moves_as
            leg = next((one for one in self.layout.plan.legs if one.leg.name == driver), None)
            # One parameter instead of the two angles that together move the bodies.
            if leg is None:
                amount, end = (0.0 if all(slides) else 1.0), self.layout.plan.stroke
                return _single(STROKE, amount, (0.0, end))
            if other == f"{driver}.{leg.leg.chain.names[1]}.block":
                return _single(("across", driver), 1.0, self.layout.motions.across(leg), driver)
        first, second = self._reach(a, driver), self._reach(b, driver)
        names, reach = [], []
        for name in self._ranges:
            amount = _relative(first.get(name), second.get(name))
            if amount > 0.0:
                names.append(name)
                reach.append(amount)
        low, high = (np.array([self._ranges[n][end] for n in names]) for end in (0, 1))
        return RobotFreedom(np.array(reach), low, high, names=tuple(names), driver=driver)

    def _owner(self, body: RobotBody) -> str:
        """The leg of a body; empty for all others."""
        names = [body.moves_as]
        if isinstance(body.path, BodyLine):
            names = [one for one, _ in body.path.ends]
        owners = [self.layout.motions.split(one) for one in names]
        return next((owner for owner, kind in owners if owner and kind not in _SWUNG), "")

    def _reach(self, body: RobotBody, driver: str) -> dict[Parameter, tuple[str, float]]:
        motions = self.layout.motions
        if not isinstance(body.path, BodyLine):
            return motions.reach(body.moves_as, body.extent, driver)
        both = []
        for owner, point in body.path.ends:
            hinge = motions.of(owner, {}).hinge
            both.append(motions.reach(owner, math.dist(point, hinge), driver))
        found = {}
        for name in (*both[0], *both[1]):
            one, other = (each.get(name) for each in both)
            if one is not None and other is not None and one[0] == other[0] and one[0] != TURN:
                found[name] = one
            else:
                found[name] = ("own", max(each[1] for each in (one, other) if each is not None))
        return found

    def poses(self, moves: RobotFreedom, parameters: Floats) -> "RobotPoses":
        """Places of all bodies at parameters (n, k); others are at rest."""
        count = len(parameters)
        rest = {name: np.full(count, low) for name, (low, _) in self._ranges.items()}
        values = {name: parameters[:, i] for i, name in enumerate(moves.names)}
        return RobotPoses(self.layout, {**rest, **values}, moves.driver)

    def collision(
        self,
        moves: RobotFreedom,
        rows: Floats,
        worst: Floats,
        overlap: float,
        parts: tuple[str, str],
    ) -> RobotOverlap:
        """The collision of two parts that overlap at `rows`, deepest at `worst`."""
        ranges = tuple(
            (name, float(rows[:, i].min()), float(rows[:, i].max()))
            for i, name in enumerate(moves.names)
        )
        pose = {name: low for name, (low, _) in self._ranges.items()}
        pose |= {name: float(worst[i]) for i, name in enumerate(moves.names)}
        if STROKE in pose:
            pose |= self._at_stroke(pose.pop(STROKE))
        states = dict.fromkeys(state for row in rows for state in self._states(moves, row))
        return RobotOverlap(parts, overlap, ranges, tuple(states), tuple(pose.items()))

    def _at_stroke(self, stroke: float) -> dict[Parameter, float]:
        """Angles of all cells at a stroke, the inner ones first."""
        found: dict[Parameter, float] = {}
        for leg in self.layout.plan.legs:
            left = stroke
            for number, cell in enumerate(leg.cells):
                travel = min(max(left, 0.0), cell.full_travel)
                found[leg.leg.name, number] = float(cell.angle(travel))
                left -= travel
        return found

    def _states(self, moves: RobotFreedom, row: Floats) -> Iterator[str]:
        """The states of the legs of a row, if all their cells are at a stop."""
        for leg in self.layout.plan.legs:
            digits = ["?", "?"]
            for name, value in zip(moves.names, row, strict=True):
                if name[0] != leg.leg.name:
                    continue
                low, high = self._ranges[name]
                if min(abs(value - low), abs(value - high)) > 1e-9:
                    break
                digits[int(name[1])] = "0" if abs(value - low) < 1e-9 else "1"
            else:
                if digits != ["?", "?"]:
                    yield f"{leg.leg.name} {''.join(digits)}"


# Bodies of an antenna, which may have the name of a leg.
_SWUNG = ("antenna", "crank")
_V_BODIES = ("slider", *UPRIGHT)


@dataclass(frozen=True)
class RobotPoses:
    """Places of a robot's bodies at n sets of parameters."""

    layout: RobotLayout
    values: dict[Parameter, Floats]
    driver: str = ""

    def of(self, body: RobotBody) -> tuple[Floats, Floats]:
        """(n, 2) places [m] and (n,) angles [rad] of a body's frame."""
        moved = self.layout.motions.of(body.moves_as, self.values, self.driver)
        return moved.shift + np.array(moved.hinge), moved.turn

    def line(self, body: RobotBody) -> Floats:
        """(n, 2, 2) ends of a band [m]."""
        line = body.path
        ends = []
        for owner, point in line.ends:
            ends.append(self.layout.motions.of(owner, self.values, self.driver).of(point))
        start, way = ends[0], ends[1] - ends[0]
        return np.stack([start + share * way for share in line.share], axis=1)


def _single(
    name: Parameter, amount: float, ends: tuple[float, float], driver: str = ""
) -> RobotFreedom:
    """A freedom of one parameter, or of none for an amount of 0."""
    if amount == 0.0:
        return RobotFreedom(np.zeros(0), np.zeros(0), np.zeros(0), names=())
    low, high = (np.array([end]) for end in ends)
    return RobotFreedom(np.array([amount]), low, high, names=(name,), driver=driver)


def _relative(a: tuple[str, float] | None, b: tuple[str, float] | None) -> float:
    """Largest relative displacement of two bodies per unit of a parameter of either."""
    if a is None or b is None:
        return (a or b or ("", 0.0))[1]
    kinds = {a[0], b[0]}
    if len(kinds) == 1 and kinds <= {ARC, ALONG}:
        return 0.0
    # Across the travel a swinging block moves at most as fast as along it.
    if kinds == {ARC, ALONG}:
        return max(a[1], b[1])
    # Seen from the block that a lever drives, the lever turns about that block's pin.
    if kinds == {ARC, TURN}:
        return max(a[1], b[1])
    return a[1] + b[1]


def _cell(layout: RobotLayout, band: RobotBand) -> str:
    return layout.robot.leg(band.leg).chain.names[band.cell % 2]


def _shifted(piece: Piece, hinge: tuple[float, float]) -> Piece:
    """A piece in the frame of a body that turns about `hinge`."""
    x, y = -hinge[0], -hinge[1]
    if x == y == 0.0:
        return piece
    moved = tuple(one.moved(x, y) for one in piece.cutouts)
    return replace(piece, outline=piece.outline.moved(x, y), cutouts=moved)


def _extent(piece: Piece) -> float:
    """Largest distance of a piece from the origin [m]."""
    x0, y0, x1, y1 = piece.outline.bounds
    return max(math.hypot(x, y) for x in (x0, x1) for y in (y0, y1))


def _placed(part: Part, place: PartFrame) -> tuple[Contour, tuple[Contour, ...]]:
    at = place.x, place.y, place.angle
    return part.outline.moved(*at), tuple(one.moved(*at) for one in part.cutouts)


def _rectangle(box: Box) -> Contour:
    x0, y0, x1, y1 = box
    return Contour.of([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def flat_pieces(layout: RobotLayout, body: str) -> Iterator[Piece]:
    """The pieces of a body in plan; upright parts are rectangles between their heights."""
    owner = "carriage" if body == "rod" else body
    for box in layout.boxes:
        if box.body == owner and (box.name == "rod") == (body == "rod"):
            (x0, y0, z0), (x1, y1, z1) = box.low, box.high
            joint = ("actuator", 0) if box.name == "actuator" else None
            yield Piece(box.name, _rectangle((x0, y0, x1, y1)), (), z0, z1, joint)
    if body == "rod":
        return
    for part in layout.parts:
        if layout.body[part.name] != body:
            continue
        place = layout.places[part.name]
        if place.upright:
            yield from _of_upright(part, place)
        else:
            outline, cutouts = _placed(part, place)
            yield Piece(part.name, outline, cutouts, part.base, part.top)
    for one in layout.fasteners:
        if one.block == body:
            yield from _of_fastener(layout, one)


def _of_fastener(layout: RobotLayout, one: Fastener) -> Iterator[Piece]:
    # Shims of joints have the room of their lever.
    narrow = one.diameter <= layout.build_file.lever.width
    if one.use == "shim" and one.joint is not None and narrow:
        return
    name, half = f"{one.use} {one.name}", one.diameter / 2.0
    if not one.upright:
        yield Piece(name, Contour.circle(one.centre, half), (), one.low, one.high, one.joint)
        return
    x, z = one.centre
    box = (x - half, one.low, x + half, one.high)
    joint = ("actuator", 0) if one.name in ("holder-pin", "bracket-pin") else one.joint
    yield Piece(name, _rectangle(box), (), z - half, z + half, joint)


def _of_upright(part: Part, place: PartFrame) -> Iterator[Piece]:
    """An upright part as rectangles in plan, one for each range of heights between its corners."""
    import shapely

    outline, _ = _placed(part, place)
    shape = outline.polygon(1e-5)
    heights = sorted({round(y, 7) for _, y in part.outline.points} if not place.angle else ())
    if not heights:
        _, low, _, high = outline.bounds
        heights = [low, high]
    for low, high in pairwise(heights):
        if high - low < 1e-5:
            continue
        strip = shapely.intersection(shape, shapely.box(-1.0, low + 1e-6, 1.0, high - 1e-6))
        x0, _, x1, _ = strip.bounds
        box = (x0, part.base, x1, part.top)
        yield Piece(part.name, _rectangle(box), (), place.y + low, place.y + high)


def _name_of_v(leg: LegPlan) -> str:
    return f"{leg.leg.name}.V"


def _room_of_v(layout: RobotLayout, leg: LegPlan) -> RobotBody:
    """All places of a V as one box: nothing but its own leg, the body and the carriage meets it."""
    plan = layout.plan
    half = plan.build_file.robot.link_width / 2.0
    foot = max(half, plan.build_file.robot.foot_radius)
    x0, x1 = leg.rear - plan.stroke - foot, leg.front + half
    reach = 3.0 * plan.thick + 3e-3
    y0, y1 = sorted((leg.side * (leg.row - reach), leg.side * (leg.row + reach)))
    name = _name_of_v(leg)
    piece = Piece(name, _rectangle((x0, y0, x1, y1)), (), plan.heights.floor, half)
    # These are compared in the vertical plane.
    own = (f"{leg.leg.name}.slider", "carriage", "body")
    held = frozenset(one.name for body in own for one in flat_pieces(layout, body))
    return RobotBody(name=name, moves_as="body", pieces=(piece,), rank=0.5, hooks=held)


def upright_pieces(layout: RobotLayout, body: str, leg: LegPlan) -> Iterator[Piece]:
    """The pieces of a body in the vertical plane of a leg's V; their `low` and `high` are y."""
    reach = 3.0 * layout.plan.thick + 3e-3
    y0, y1 = sorted((leg.side * (leg.row - reach), leg.side * (leg.row + reach)))
    for part in layout.parts:
        if layout.body[part.name] != body:
            continue
        place = layout.places[part.name]
        if not place.upright:
            yield from _cut(part, place, (y0, y1))
        elif y0 <= part.base and part.top <= y1:
            outline, cutouts = _placed(part, place)
            yield Piece(part.name, outline, cutouts, part.base, part.top)
    for one in layout.fasteners:
        if one.block != body:
            continue
        name, half = f"{one.use} {one.name}", one.diameter / 2.0
        if one.upright and y0 <= one.low and one.high <= y1:
            yield Piece(name, Contour.circle(one.centre, half), (), one.low, one.high, one.joint)
        elif not one.upright and y0 < one.centre[1] + half and one.centre[1] - half < y1:
            x, y = one.centre
            box = (x - half, one.low, x + half, one.high)
            yield Piece(name, _rectangle(box), (), y - half, y + half)


def _cut(part: Part, place: PartFrame, ends: tuple[float, float]) -> Iterator[Piece]:
    """A flat part in the strip of y between `ends`, as boxes."""
    import shapely

    outline, cutouts = _placed(part, place)
    shape = shapely.Polygon(outline.ring(1e-5), [one.ring(1e-5) for one in cutouts])
    # At each y between corners the part is there at some ranges of x.
    ys = sorted({min(max(y, ends[0]), ends[1]) for y in shapely.get_coordinates(shape)[:, 1]})
    for low, high in pairwise([ends[0], *ys, ends[1]]):
        if high - low < 2e-4:
            continue
        strip = shapely.intersection(shape, shapely.box(-1.0, low, 1.0, high))
        for one in shapely.get_parts(strip):
            if one.geom_type == "Polygon" and one.area > 1e-9:
                x0, _, x1, _ = one.bounds
                box = (x0, part.base, x1, part.top)
                yield Piece(part.name, _rectangle(box), (), low, high)


def _cord_bodies(cord: Cord) -> Iterator[RobotBody]:
    """A cord as straight pieces, each as high as its two ends are apart."""
    ends = ((cord.hub, cord.start[:2]), (cord.crank, cord.end[:2]))
    for i in range(_PIECES):
        share = i / _PIECES, (i + 1) / _PIECES
        z = [cord.start[2] + one * (cord.end[2] - cord.start[2]) for one in share]
        line = BodyLine(ends, share, min(z) - CORD, max(z) + CORD, 2.0 * CORD)
        name = f"cord of {cord.antenna}"
        yield RobotBody(
            name=name, moves_as=name, path=line, rank=_BANDS + i, hooks=frozenset(cord.parts)
        )


def robot_sweep(layout: RobotLayout, progress: Progress = None) -> sweeps.MotionSweep:
    """Compare all bodies of a robot at all angles of its cells and antennas.

    All parameters are independent here, so every state of every gait and every antenna position is
    among them. Parts are compared in plan, layer by layer, and each V in its vertical plane.

    Args:
        layout: of the robot.
        progress: called with (done, total) pairs of bodies.
    """
    found = [sweeps.sweep(SweptRobot(layout), progress)]
    found += [sweeps.sweep(SweptRobot(layout, leg)) for leg in layout.plan.legs]
    nearest = sorted(
        (one for each in found for one in each.clearances), key=lambda one: one.distance
    )
    deepest = sorted((one for each in found for one in each.collisions), key=lambda c: -c.overlap)
    return sweeps.MotionSweep(
        free=all(one.free for one in found),
        collisions=tuple(deepest),
        undecided=tuple(one for each in found for one in each.undecided),
        clearances=tuple(nearest),
        pairs=sum(one.pairs for one in found),
        poses=sum(one.poses for one in found),
    )
