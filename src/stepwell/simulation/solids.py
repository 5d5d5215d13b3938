"""Parts that can be cut in the model of a robot: masses, shapes that collide, and meshes.

On rods, levers and links have no bodies: half of their mass is at each of their joints, and they
are drawn on bodies that `live.py` moves for every picture, as are the cranks of antennas.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from stepwell.base import Floats
from stepwell.robot import BodyMass, PartRole, Robot, Shape, joined_solids
from stepwell.simulation import parts
from stepwell.simulation.leg import band_height, cell_joints, in_body, sides
from stepwell.simulation.simulator import Linkage, Model, Settings, mujoco

# The colours of the figures, which a test compares: blocks, carriage and links differ, also for
# readers who do not see red or green.
COLOURS: dict[PartRole, parts.Colour] = {
    PartRole.BODY: (0.66, 0.66, 0.66, 1.0),
    PartRole.CARRIAGE: (0.84, 0.37, 0.00, 1.0),
    PartRole.MIDDLE_BLOCK: (0.00, 0.45, 0.70, 1.0),
    PartRole.OUTER_BLOCK: (0.00, 0.62, 0.45, 1.0),
    PartRole.LEVER: parts.LEVER,
    PartRole.LINK: (0.80, 0.47, 0.65, 1.0),
    PartRole.FOOT: parts.LEVER,
    PartRole.ANTENNA: parts.ANTENNA,
    PartRole.CRANK: parts.ANTENNA,
    PartRole.PIN: (0.54, 0.54, 0.54, 1.0),
    PartRole.ACTUATOR: (0.30, 0.30, 0.30, 1.0),
    PartRole.BATTERY: (0.30, 0.30, 0.30, 1.0),
    PartRole.SUPPORT: (0.66, 0.66, 0.66, 1.0),
}
CORD = 0.0005  # radius of a drawn cord [m]
STRAND = 0.0010  # radius of a drawn strand of a band [m]
LEVEL = 0.003  # distance of two bands of one cell [m]
FLOOR = parts.STANDS["conaffinity"]
# Beginning of the names of lines that only draw a strand of a band.
STRANDS = "strand of "
# A point mass has this radius of gyration [m], since MuJoCo refuses bodies without inertia.
POINT = 1e-3


@dataclass(frozen=True)
class Holder:
    """A body of the model that has a part of a mass, and where.

    The whole body lies there as it is, or `share` of its mass at a point (3,) [m] in the frame of
    the parts.
    """

    name: str
    share: float = 1.0
    at: Floats | None = None


def holders(robot: Robot, linkage: Linkage) -> dict[str, tuple[Holder, ...]]:
    """For each rigid body of the parts the bodies of the model that have its mass."""
    made = robot.made
    assert made is not None
    found: dict[str, tuple[Holder, ...]] = {name: (Holder(name),) for name in ("body", "carriage")}
    half = np.array([robot.foot.span / 2, 0.0, 0.0])
    for leg in robot.legs:
        tip = np.array([*leg.at, -float(robot.foot.depth(0.0))])
        pivot = np.array([*leg.at, 0.0])
        before = "body"
        for cell in leg.chain.names:
            side = f"{leg.name}.{cell}.side"
            found[f"{leg.name}.{cell}.block"] = (Holder(side),)
            for number, end in ((1, "front"), (2, "back")):
                name = f"{leg.name}.{cell}.lever {number}"
                near = np.array(made.hinges[name])
                far = 2 * made.of(name).centre - near
                found[name] = (Holder(before, 0.5, near), Holder(side, 0.5, far))
                if linkage is Linkage.HINGES:
                    found[name] = (Holder(f"{leg.name}.{cell}.lever.{end}"),)
            before = side
        slider = f"{leg.name}.{leg.chain.names[0]}.block"
        found[f"{leg.name}.slider"] = (Holder(slider),)
        foot = f"{leg.name}.foot"
        found[foot] = (Holder(foot),)
        for end, own, body, at in (
            ("front", "in", slider, pivot + half),
            ("rear", "out", "carriage", pivot - half),
        ):
            both = Holder(body, 0.5, at), Holder(foot, 0.5, tip)
            alone = (Holder(f"{leg.name}.link.{own}"),)
            found[f"{leg.name}.link {end}"] = alone if linkage is Linkage.HINGES else both
    for antenna in robot.antennas:
        name = f"{antenna.name}.antenna"
        found |= {
            name: (Holder(name),),
            f"{antenna.name}.crank": (Holder(f"{antenna.name}.anchor"),),
        }
    return found


@dataclass(frozen=True)
class _Poses:
    """Place of every body of a model in the frame of the parts, in their reference pose."""

    turn: dict[str, Floats]  # (3, 3) from the body's frame
    at: dict[str, Floats]  # (3,) [m]

    @classmethod
    def of(cls, model: Model, position: Floats) -> "_Poses":
        """The poses with joints at (nq,) positions."""
        data = mujoco.MjData(model)
        data.qpos[:] = position
        mujoco.mj_kinematics(model, data)
        root = model.body("body").id
        back, origin = data.xmat[root].reshape(3, 3).T, data.xpos[root]
        names = {model.body(i).name: i for i in range(1, model.nbody)}
        turn = {name: back @ data.xmat[i].reshape(3, 3) for name, i in names.items()}
        return cls(turn, {name: back @ (data.xpos[i] - origin) for name, i in names.items()})

    def inside(self, body: str, points: Floats) -> Floats:
        """Points (..., 3) of the frame of the parts in the frame of a body."""
        return (points - self.at[body]) @ self.turn[body]


def add_parts(
    spec: Any, robot: Robot, start: tuple[Model, Floats], settings: Settings, drawn: bool
) -> None:
    """Replace plain shapes and masses of a model by those of the robot's parts.

    Arguments: the model to change, the robot, the same model compiled with its joint positions
    (nq,) with every cell at 0, the settings, and whether parts are also drawn.
    """
    if robot.made is None:
        return
    poses, where = _Poses.of(*start), holders(robot, settings.linkage)
    _set_masses(spec, robot, poses, where)
    # Shapes of levers and links stay within those of the blocks beside them.
    solid = [shape for shape in robot.made.shapes if shape.collides and len(where[shape.body]) == 1]
    _clear(spec, robot, {where[shape.body][0].name for shape in solid})
    for number, shape in enumerate(solid):
        name = where[shape.body][0].name
        touch = parts.OUTLINE if name in ("body", "carriage") else parts.BLOCKS
        rubs = {"priority": 2, "condim": 3, "friction": (robot.body.wall_friction, 0.0, 0.0)}
        vertices = poses.inside(name, shape.vertices)
        _add_mesh(spec, spec.body(name), f"solid {number + 1}", shape, vertices, **touch, **rubs)
    if drawn:
        _draw(spec, robot, poses, where, settings)


def _draw(
    spec: Any, robot: Robot, poses: _Poses, where: dict[str, tuple[Holder, ...]], settings: Settings
) -> None:
    """Add the shapes that are looked at."""
    assert robot.made is not None
    followers = _followers(spec, robot, poses, settings)
    drawn = (shape for shape in robot.made.shapes if not shape.collides)
    for number, shape in enumerate(drawn):
        name = followers.get(shape.body) or where[shape.body][0].name
        body = spec.body(name)
        vertices = (
            shape.vertices - _near(robot, shape.body)
            if shape.body in followers
            else poses.inside(name, shape.vertices)
        )
        look = {"rgba": COLOURS[shape.colour], "mass": 0.0, **parts.SEEN}
        _add_mesh(spec, body, f"part {number + 1}", shape, vertices, **look)
    for antenna, ends in robot.made.cords.items():
        for number, (name, point) in enumerate(ends):
            at = np.array(point) - _near(robot, name) if name in followers else None
            holder = followers.get(name) or where[name][0].name
            x, y, z = poses.inside(holder, np.array(point)) if at is None else at
            parts.site(spec.body(holder), f"drawn cord {antenna} {number + 1}", (x, y, z))
        sites = [f"drawn cord {antenna} {number}" for number in (1, 2)]
        parts.between(spec, f"drawn cord {antenna}", sites, width=CORD, rgba=parts.LEVER)
    _add_strands(spec, robot)


def _add_strands(spec: Any, robot: Robot) -> None:
    """Draw each band as the two strands of a loop around its hooks, below their caps.

    The strands lie beside the hooks along the stroke, since bands are across it midway.
    """
    assert robot.made is not None
    hooks = [shape for shape in robot.made.shapes if shape.part.startswith("hook ")]
    caps = [shape for shape in robot.made.shapes if shape.part.startswith("cap ")]
    if not hooks or not caps:
        return
    below = min(float(shape.vertices[:, 2].min()) for shape in caps)
    beside = float(np.ptp(hooks[0].vertices[:, 0])) / 2.0 + STRAND
    bands = {tendon.name: tendon for tendon in spec.tendons if ".band" in tendon.name}
    # Bands of one cell, which have numbers, lie one above the other.
    levels = {name: int(name.rpartition(".band")[2] or 1) for name in bands}
    for band in bands.values():
        under = (max(levels.values()) - levels[band.name]) * LEVEL
        down = below - STRAND - under - band_height(robot)
        for number, side in enumerate((beside, -beside)):
            _add_strand(spec, band, f"{STRANDS}{band.name} {number + 1}", (side, 0.0, down))
        band.rgba = parts.HIDDEN


def _add_strand(spec: Any, band: Any, name: str, shift: tuple[float, float, float]) -> None:
    """A line of the colour of a band, shifted from it by (x, y, z) [m]."""
    for end in "pq":
        own = spec.site(f"{band.name}.{end}")
        x, y, z = own.pos + np.array(shift)
        parts.site(own.parent, f"{name}.{end}", (x, y, z))
    parts.between(spec, name, [f"{name}.p", f"{name}.q"], width=STRAND, rgba=band.rgba)


def _set_masses(
    spec: Any, robot: Robot, poses: _Poses, where: dict[str, tuple[Holder, ...]]
) -> None:
    held: dict[str, list[BodyMass]] = {}
    assert robot.made is not None
    for one in robot.made.masses:
        for holder in where[one.body]:
            mass = holder.share * one.mass
            lump = one
            if holder.at is not None:
                point = np.eye(3) * mass * POINT**2
                lump = BodyMass(one.body, mass, holder.at, point)
            held.setdefault(holder.name, []).append(lump)
    for name, lumps in held.items():
        whole = joined_solids(lumps)
        turn, body = poses.turn[name], spec.body(name)
        body.explicitinertial = True
        body.mass = whole.mass
        body.ipos = poses.inside(name, whole.centre)
        inertia = turn.T @ whole.inertia @ turn
        body.fullinertia = [*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]]


def _is_of_robot(body: str) -> bool:
    others = ("wall ", "cylinder ", "plate ")
    return bool(body) and body != "world" and not body.startswith(others)


def _clear(spec: Any, robot: Robot, replaced: set[str]) -> None:
    """Remove what the parts replace: plain shapes, and the lines of levers and links.

    Balls under feet and supports still carry the robot, unseen; so do outlines and antennas that
    have no shape of their own.
    """
    for body in [body for body in spec.bodies if body.geoms and _is_of_robot(body.name)]:
        for geom in list(body.geoms):
            touches = bool(geom.contype or geom.conaffinity)
            on_floor = touches and bool(geom.conaffinity & FLOOR)
            if on_floor or (touches and body.name not in replaced):
                geom.rgba, geom.group = parts.HIDDEN, 4
            else:
                spec.delete(geom)
    for tendon in spec.tendons:
        if tendon.name.endswith(".lever") or ".link." in tendon.name:
            tendon.rgba = parts.HIDDEN


def _near(robot: Robot, name: str) -> Floats:
    """(3,) the joint of a lever, a link or a crank on the body it turns on [m]."""
    assert robot.made is not None
    if name in robot.made.hinges:
        return np.array(robot.made.hinges[name])
    leg = next(leg for leg in robot.legs if name.startswith(f"{leg.name}.link "))
    half = robot.foot.span / 2 * (1 if name.endswith("front") else -1)
    return np.array([leg.at[0] + half, leg.at[1], 0.0])


def _followers(spec: Any, robot: Robot, poses: _Poses, settings: Settings) -> dict[str, str]:
    """Bodies that only draw a lever, a link or a crank, with the points that they follow.

    Two sites, "near {body}" and "far {body}", are its joints; the name of the parts' body is the
    key.
    """
    assert robot.made is not None
    found: dict[str, str] = {}
    for name, near, far in _ends(robot, settings):
        found[name] = f"drawn {name}"
        spec.worldbody.add_body(name=found[name], mocap=True)
        for label, (body, at) in (("near", near), ("far", far)):
            x, y, z = poses.inside(body, at)
            parts.site(spec.body(body), f"{label} {name}", (x, y, z))
    return found


def _ends(
    robot: Robot, settings: Settings
) -> Iterator[tuple[str, tuple[str, Floats], tuple[str, Floats]]]:
    """Name of each follower, and the body and the place of its two joints."""
    for name, both in holders(robot, Linkage.RODS).items():
        if len(both) == 2 and settings.linkage is Linkage.RODS:
            near, far = both
            assert near.at is not None and far.at is not None
            yield name, (near.name, near.at), (far.name, far.at)
    for antenna in robot.antennas:
        leg, name = robot.leg(antenna.leg), f"{antenna.name}.crank"
        pivot, (joint, _) = _near(robot, name), cell_joints(robot, leg, 0)
        # The anchor p, at the height of the crank.
        p = np.add(joint, in_body(sides(robot, leg)[0], leg.chain.levers[0].bands[0].p)) * (1, 1, 0)
        yield name, ("body", pivot), (f"{antenna.name}.anchor", p + pivot * (0, 0, 1))


def _add_mesh(spec: Any, body: Any, name: str, shape: Shape, vertices: Floats, **look: Any) -> None:
    """Add a shape; one that is drawn has flat faces and sharp edges."""
    if shape.collides:
        points, faces = vertices, shape.faces
        given: dict[str, Any] = {}
        look |= {"rgba": parts.HIDDEN, "group": 4}
    else:
        points = vertices[shape.faces].reshape(-1, 3)
        faces = np.arange(len(points)).reshape(-1, 3)
        a, b, c = points[0::3], points[1::3], points[2::3]
        normals = np.repeat(np.cross(b - a, c - a), 3, axis=0)
        size = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.where(size > 0, normals / np.maximum(size, 1e-30), (0.0, 0.0, 1.0))
        given = {"usernormal": normals.ravel(), "userfacenormal": faces.ravel()}
    spec.add_mesh(
        name=name,
        uservert=points.ravel(),
        userface=faces.ravel(),
        # A thin sheet has hardly any volume; masses are given.
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        **given,
    )
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, name=f"{name} {shape.part}", **look
    )
