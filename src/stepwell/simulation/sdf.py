"""A model of a robot as a world in SDF 1.11, the format of Gazebo.

Links are the bodies of the model, at their poses in its state; joint positions of 0 are this state.
A body with several joints hangs on links of 1 mg, one for each joint but the last. Loops are closed
by ball joints, so that a link may be the child of several joints.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as Xml

import numpy as np

from stepwell.base import Floats, InputError
from stepwell.simulation.simulator import Model, mujoco

GEOM, JOINT, EQUALITY = mujoco.mjtGeom, mujoco.mjtJoint, mujoco.mjtEq
WRAP = mujoco.mjtWrap
LIGHT = 1e-6  # mass of a link that only joins two joints [kg] ...
SLIGHT = 1e-10  # ... and its moments of inertia [kg m²]
FLOOR = 20.0  # side of the floor [m]
HEAD = """
  SDF has no element for these parts of the model:
  - Elastic bands. Each is an element stepwell:band: its rest length [m], its stiffness [N/m] with
    the next two coefficients of its force, and the frames and positions [m] of its ends. A slack
    band carries no force.
  - Damping and friction of the travel of a cell, which is the difference of two joint positions.
  - The actuator, which moves the joint "stroke".
  Joint positions are 0 in the pose of this file, with every cell in state 0. Units are SI.
"""


def sdf_text(model: Model, data: Any, meshes: Mapping[str, str], title: str) -> str:
    """A compiled model in a state as an SDF world; `meshes` maps each mesh's name to its file."""
    mujoco.mj_forward(model, data)
    root = Xml.Element("sdf", {"version": "1.11", "xmlns:stepwell": "urn:stepwell"})
    root.append(Xml.Comment(HEAD))
    world = _add(root, "world", name="stepwell")
    _add(world, "gravity", model.opt.gravity)
    physics = _add(world, "physics", name="default", type="ignored")
    _add(physics, "max_step_size", model.opt.timestep)
    _add(physics, "real_time_factor", 1.0)
    for i in range(model.nlight):
        light = _add(world, "light", name=f"light {i + 1}", type="directional")
        _add(light, "pose", [*model.light_pos[i], 0, 0, 0])
        _add(light, "cast_shadows", "true")
        _add(light, "direction", model.light_dir[i])
    writer = _Writer(model, data, meshes)
    writer.add_robot(world, title)
    writer.add_surroundings(world)
    Xml.indent(root)
    return '<?xml version="1.0"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def _add(parent: Xml.Element, tag: str, value: Any = None, **attributes: str) -> Xml.Element:
    """A new element with a number, several, or a text."""
    element = Xml.SubElement(parent, tag, attributes)
    if isinstance(value, str):
        element.text = value
    elif value is not None:
        # Adding 0 makes -0 into 0.
        element.text = " ".join(f"{number:.9g}" for number in np.atleast_1d(value) + 0.0)
    return element


@dataclass(frozen=True)
class _Frame:
    """A pose: position (3,) [m] and unit quaternion (w, x, y, z), both in an outer frame."""

    position: Floats
    turn: Floats

    def rotated(self, vector: Floats) -> Floats:
        """A vector (3,) of this frame, in the outer frame."""
        result = np.empty(3)
        mujoco.mju_rotVecQuat(result, vector, self.turn)
        return result

    @property
    def inverse(self) -> "_Frame":
        """The outer frame in this one."""
        back = _Frame(np.zeros(3), self.turn * [1.0, -1.0, -1.0, -1.0])
        return _Frame(-back.rotated(self.position), back.turn)

    def __matmul__(self, inner: "_Frame") -> "_Frame":
        """A pose of this frame, in the outer frame."""
        turn = np.empty(4)
        mujoco.mju_mulQuat(turn, self.turn, inner.turn)
        return _Frame(self.position + self.rotated(inner.position), turn)

    def add_to(self, element: Xml.Element) -> None:
        """Write it as the pose of an element."""
        w, *xyz = self.turn
        _add(element, "pose", [*self.position, *xyz, w], rotation_format="quat_xyzw")


@dataclass(frozen=True)
class _Writer:
    """A model in a state, and the files of its meshes."""

    model: Model
    data: Any
    meshes: Mapping[str, str]

    def name(self, body: int) -> str:
        return self.model.body(body).name if body else "floor"

    def frame(self, body: int) -> _Frame:
        """Pose of a body in the world."""
        return _Frame(self.data.xpos[body].copy(), self.data.xquat[body].copy())

    def add_robot(self, world: Xml.Element, title: str) -> None:
        """Add the bodies that move, their joints and bands."""
        m = self.model
        base = int(m.jnt_bodyid[np.flatnonzero(m.jnt_type == JOINT.mjJNT_FREE)[0]])
        robot = _add(world, "model", name=title.replace("::", " "))
        # The bit masks of the shapes decide which links touch each other.
        _add(robot, "self_collide", "true")
        root = self.frame(base)
        root.add_to(robot)
        for body in np.flatnonzero(m.body_rootid == base).tolist():
            where = root.inverse @ self.frame(body)
            link = _add(robot, "link", name=self.name(body))
            where.add_to(link)
            inertial = _Frame(m.body_ipos[body], m.body_iquat[body])
            _add_inertia(link, inertial, m.body_mass[body], m.body_inertia[body])
            self.add_shapes(link, body)
            for follower in self.followers(body):
                self.add_shapes(link, follower, self.frame(body).inverse @ self.frame(follower))
            if body != base:
                self.add_joints(robot, body, where)
        self.add_loops(robot)
        self.add_bands(robot)

    def add_surroundings(self, world: Xml.Element) -> None:
        """Add the floor and all obstacles as a model that does not move, and loose plates."""
        m = self.model
        free = m.jnt_bodyid[np.flatnonzero(m.jnt_type == JOINT.mjJNT_FREE)]
        # The first body that moves freely is the robot's.
        for body in free[1:].tolist():
            plate = _add(world, "model", name=self.name(body))
            self.frame(body).add_to(plate)
            link = _add(plate, "link", name=self.name(body))
            inertial = _Frame(m.body_ipos[body], m.body_iquat[body])
            _add_inertia(link, inertial, m.body_mass[body], m.body_inertia[body])
            self.add_shapes(link, body)
        still = _add(world, "model", name="surroundings")
        _add(still, "static", "true")
        drawn = (m.body_mocapid >= 0) | (m.body_geomnum == 0)
        for body in np.flatnonzero((m.body_weldid == 0) & ~drawn).tolist():
            link = _add(still, "link", name=self.name(body))
            self.frame(body).add_to(link)
            self.add_shapes(link, body)

    def followers(self, body: int) -> list[int]:
        """Bodies that are only drawn, from a joint on this one: here they stay as they are."""
        m = self.model
        names = [(int(i), m.body(i).name) for i in np.flatnonzero(m.body_mocapid >= 0)]
        near = [(i, m.site(name.replace("drawn ", "near ", 1)).id) for i, name in names]
        return [i for i, site in near if m.site_bodyid[site] == body]

    def add_shapes(self, link: Xml.Element, body: int, within: _Frame | None = None) -> None:
        """Add what is seen of a body, and what collides; `within` is its frame in the link."""
        within = within or _Frame(np.zeros(3), _LEVEL)
        m, first = self.model, self.model.body_geomadr[body]
        for geom in range(first, first + m.body_geomnum[body]):
            label = m.geom(geom).name or f"shape {geom - first + 1}"
            plain = m.geom_matid[geom] < 0
            colour = m.geom_rgba[geom] if plain else m.mat_rgba[m.geom_matid[geom]]
            colour = np.round(colour.astype(float), 4)
            if colour[3] > 0:
                visual = self.add_shape((link, "visual", label), geom, within)
                _add(visual, "transparency", 1.0 - colour[3])
                material = _add(visual, "material")
                for part in ("ambient", "diffuse"):
                    _add(material, part, [*colour[:3], 1.0])
            if m.geom_contype[geom] or m.geom_conaffinity[geom]:
                surface = _add(self.add_shape((link, "collision", label), geom, within), "surface")
                friction = _add(_add(surface, "friction"), "ode")
                for part in ("mu", "mu2"):
                    _add(friction, part, m.geom_friction[geom, 0])
                contact = _add(surface, "contact")
                _add(contact, "category_bitmask", str(m.geom_contype[geom]))
                _add(contact, "collide_bitmask", str(m.geom_conaffinity[geom]))

    def add_shape(
        self, element: tuple[Xml.Element, str, str], geom: int, within: _Frame
    ) -> Xml.Element:
        """Add a shape that is seen or that collides; `element` has its link, tag and name."""
        link, tag, label = element
        m, shape = self.model, _add(link, tag, name=label)
        where = within @ _Frame(m.geom_pos[geom], m.geom_quat[geom])
        if m.geom_type[geom] == GEOM.mjGEOM_MESH:
            # The file has the mesh in the frame in which it was given to the model.
            mesh = m.geom_dataid[geom]
            where = where @ _Frame(m.mesh_pos[mesh], m.mesh_quat[mesh]).inverse
        where.add_to(shape)
        kind, sizes = self.shape(geom)
        solid = _add(_add(shape, "geometry"), kind)
        for key, size in sizes.items():
            _add(solid, key, size)
        return shape

    def shape(self, geom: int) -> tuple[str, dict[str, Any]]:
        """Kind of a shape, and its full sizes [m]."""
        m, size, kind = self.model, self.model.geom_size[geom], self.model.geom_type[geom]
        along = {"radius": size[0], "length": 2 * size[1]}
        match GEOM(kind):
            case GEOM.mjGEOM_BOX:
                return "box", {"size": 2 * size}
            case GEOM.mjGEOM_SPHERE:
                return "sphere", {"radius": size[0]}
            case GEOM.mjGEOM_ELLIPSOID:
                return "ellipsoid", {"radii": size}
            case GEOM.mjGEOM_CAPSULE:
                return "capsule", along
            case GEOM.mjGEOM_CYLINDER:
                return "cylinder", along
            case GEOM.mjGEOM_PLANE:
                sides = np.where(size[:2] > 0, 2 * size[:2], FLOOR)
                return "plane", {"normal": [0, 0, 1], "size": sides}
            case GEOM.mjGEOM_MESH:
                return "mesh", {"uri": self.meshes[m.mesh(m.geom_dataid[geom]).name]}
        raise InputError(f"a shape of kind {GEOM(kind).name}: SDF has none like it.")

    def add_joints(self, robot: Xml.Element, body: int, where: _Frame) -> None:
        """Add the joints of a body, from its parent; a body without one is fixed."""
        m, name = self.model, self.name(body)
        parent = self.name(m.body_parentid[body])
        joints = range(m.body_jntadr[body], m.body_jntadr[body] + m.body_jntnum[body])
        if not joints:
            fixed = _add(robot, "joint", name=f"{name}.fixed", type="fixed")
            _add(fixed, "parent", parent)
            _add(fixed, "child", name)
        for joint in joints:
            child = name
            if joint != joints[-1]:
                child = f"{m.joint(joint).name}.carrier"
                link = _add(robot, "link", name=child)
                where.add_to(link)
                _add_inertia(link, _Frame(np.zeros(3), _LEVEL), LIGHT, np.full(3, SLIGHT))
            self.add_joint(robot, joint, parent, child)
            parent = child

    def add_joint(self, robot: Xml.Element, joint: int, parent: str, child: str) -> None:
        """Add a slide or a hinge between two links."""
        m, adr, dof = self.model, self.model.jnt_qposadr[joint], self.model.jnt_dofadr[joint]
        slides, limited = m.jnt_type[joint] == JOINT.mjJNT_SLIDE, m.jnt_limited[joint]
        kind = "prismatic" if slides else "revolute" if limited else "continuous"
        one = _add(robot, "joint", name=self.joint_name(joint), type=kind)
        _add(one, "parent", parent)
        _add(one, "child", child)
        own = self.frame(m.jnt_bodyid[joint]).inverse
        at = own @ _Frame(self.data.xanchor[joint], _LEVEL)
        _Frame(at.position, _LEVEL).add_to(one)
        axis = _add(one, "axis")
        _add(axis, "xyz", np.round(own.rotated(self.data.xaxis[joint]), 12))
        if limited:
            limit, ends = _add(axis, "limit"), m.jnt_range[joint] - self.data.qpos[adr]
            _add(limit, "lower", min(ends[0], 0.0))
            _add(limit, "upper", max(ends[1], 0.0))
        dynamics = _add(axis, "dynamics")
        _add(dynamics, "damping", np.ravel(m.dof_damping[dof])[0])
        _add(dynamics, "friction", m.dof_frictionloss[dof])
        _add(dynamics, "spring_stiffness", np.ravel(m.jnt_stiffness[joint])[0])
        _add(dynamics, "spring_reference", m.qpos_spring[adr] - self.data.qpos[adr])
        for leader, factor in self.leaders(joint):
            mimic = _add(axis, "mimic", joint=self.joint_name(leader))
            _add(mimic, "multiplier", factor)
            _add(mimic, "offset", 0.0)
            _add(mimic, "reference", 0.0)

    def joint_name(self, joint: int) -> str:
        """Name of a joint, which no link has."""
        name = self.model.joint(joint).name
        taken = {self.name(body) for body in range(self.model.nbody)}
        return f"{name}.joint" if name in taken else name

    def leaders(self, joint: int) -> Iterator[tuple[int, float]]:
        """Joints that a joint follows, each with the ratio of the two motions."""
        m = self.model
        for equality in np.flatnonzero(m.eq_type == EQUALITY.mjEQ_TENDON):
            tendon = m.eq_obj1id[equality]
            wraps = range(m.tendon_adr[tendon], m.tendon_adr[tendon] + m.tendon_num[tendon])
            ends = [(int(m.wrap_objid[i]), float(m.wrap_prm[i])) for i in wraps]
            if len(ends) == 2 and m.wrap_type[wraps[0]] == WRAP.mjWRAP_JOINT:
                (follower, own), (leader, other) = ends
                if follower == joint:
                    yield leader, -other / own

    def add_loops(self, robot: Xml.Element) -> None:
        """Add a ball joint for every pair of points that the model holds together."""
        m = self.model
        for i in np.flatnonzero(m.eq_type == EQUALITY.mjEQ_CONNECT):
            child, parent = m.eq_obj1id[i], m.eq_obj2id[i]
            loop = _add(robot, "joint", name=f"{m.equality(i).name}.loop", type="ball")
            _add(loop, "parent", self.name(m.site_bodyid[parent]))
            _add(loop, "child", self.name(m.site_bodyid[child]))
            _Frame(m.site_pos[child], _LEVEL).add_to(loop)

    def add_bands(self, robot: Xml.Element) -> None:
        """Add every elastic band as an element of Stepwell's own."""
        m = self.model
        for i in range(m.ntendon):
            sites = m.wrap_objid[m.tendon_adr[i] : m.tendon_adr[i] + m.tendon_num[i]]
            elastic = m.tendon_stiffness[i] > 0
            if not elastic or m.wrap_type[m.tendon_adr[i]] != WRAP.mjWRAP_SITE:
                continue
            band = _add(robot, "stepwell:band", name=m.tendon(i).name)
            law = [m.tendon_stiffness[i], *np.ravel(m.tendon_stiffnesspoly[i])]
            _add(band, "stepwell:stiffness", law)
            _add(band, "stepwell:rest_length", m.tendon_lengthspring[i, 1])
            for site in sites:
                link = self.name(m.site_bodyid[site])
                _add(band, "stepwell:end", m.site_pos[site], link=link)


_LEVEL = np.array([1.0, 0.0, 0.0, 0.0])


def _add_inertia(link: Xml.Element, frame: _Frame, mass: float, moments: Floats) -> None:
    """Add the mass of a link [kg], and its moments about the axes of a frame [kg m²]."""
    inertial = _add(link, "inertial")
    frame.add_to(inertial)
    _add(inertial, "mass", mass)
    inertia = _add(inertial, "inertia")
    for key, value in zip(("ixx", "iyy", "izz"), moments, strict=True):
        _add(inertia, key, value)
    for key in ("ixy", "ixz", "iyz"):
        _add(inertia, key, 0.0)
