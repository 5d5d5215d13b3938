"""What moves and changes colour in a picture of a robot made of parts.

Levers, links and cranks follow their joints, bands have the colour of their tension, and the block
of a cell that snaps is lit for a moment.
"""

from typing import Any

import numpy as np

from stepwell.base import Floats
from stepwell.simulation.simulator import Model, mujoco
from stepwell.simulation.solids import STRANDS

# Slack to the largest tension: dark blue, grey, yellow of "cividis", the shades of the figures,
# which also readers who do not see red or green can order.
SHADES = np.array([(0.00, 0.14, 0.30), (0.49, 0.48, 0.47), (1.00, 0.91, 0.22)])
SLACK = (0.75, 0.75, 0.75, 1.0)
LIT = np.array((1.0, 0.95, 0.55, 1.0))
FRAMES = 5  # pictures in which a block that snapped is lit, ever less
# A cell that moves further than the stroke between two pictures, by this fraction of its travel,
# snaps: another one moves back meanwhile.
SNAPS = 0.01


def tension_colour(share: float) -> tuple[float, float, float, float]:
    """The colour of a band at a fraction of the largest tension, 0 .. 1; grey if slack."""
    if share <= 0.0:
        return SLACK
    places = np.linspace(0.0, 1.0, len(SHADES))
    r, g, b = (float(np.interp(share, places, channel)) for channel in SHADES.T)
    return r, g, b, 1.0


class LiveParts:
    """The changing parts of a model, for pictures in the order of time.

    Call `update` after the joints of a picture are set, before the scene is drawn. A robot without
    parts is left as it is.
    """

    def __init__(self, model: Model):
        self.model = model
        self.made = bool(model.nmesh)
        if not self.made:
            return
        data = mujoco.MjData(model)
        # The reference position has every lever at θ = 0, where bands of bistable cells pull most.
        mujoco.mj_kinematics(model, data)
        mujoco.mj_tendon(model, data)
        names = [model.tendon(i).name for i in range(model.ntendon)]
        self.bands, self.drawn = _bands_and_strands(names)
        self.most = max((self.tension(i, data) for i in self.bands), default=0.0) or 1.0
        mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_kinematics(model, data)
        self.followers = _followers(model)
        self.root = model.body("body").id
        back = data.xmat[self.root].reshape(3, 3).T
        # The vector between the joints of each follower in the body's frame, with cells at 0 [m].
        self.rest = [back @ (data.site_xpos[b] - data.site_xpos[a]) for _, a, b in self.followers]
        self.cells = [i for i, name in enumerate(names) if name.endswith(".travel")]
        self.full = np.array([np.ptp(model.tendon_range[i]) for i in self.cells])
        blocks = [model.body(f"{names[i].removesuffix('.travel')}.side").id for i in self.cells]
        self.lights = [np.flatnonzero(model.geom_bodyid == block) for block in blocks]
        self.colours = model.geom_rgba.copy()
        self.stroke = int(model.joint("stroke").qposadr[0])
        self.lit = np.zeros(len(self.cells))
        self.last: tuple[Floats, float] | None = None

    def tension(self, band: int, data: Any) -> float:
        """Tension of a band [N] at the lengths of `data`."""
        stretch = float(data.ten_length[band] - self.model.tendon_lengthspring[band, 1])
        poly = np.atleast_1d(self.model.tendon_stiffness[band])
        more = np.atleast_1d(getattr(self.model, "tendon_stiffnesspoly", np.zeros((1, 1)))[band])
        each = [*poly, *more]
        return sum(k * stretch ** (i + 1) for i, k in enumerate(each)) if stretch > 0 else 0.0

    def update(self, data: Any) -> None:
        """Move and colour the parts for the joint positions in `data`."""
        if not self.made:
            return
        model = self.model
        mujoco.mj_kinematics(model, data)
        mujoco.mj_tendon(model, data)
        root = data.xmat[self.root].reshape(3, 3)
        for (mocap, near, far), rest in zip(self.followers, self.rest, strict=True):
            at = data.site_xpos[near]
            turn = np.zeros(4)
            mujoco.mju_mat2Quat(
                turn, (root @ turned(rest, root.T @ (data.site_xpos[far] - at))).ravel()
            )
            data.mocap_pos[mocap], data.mocap_quat[mocap] = at, turn
        mujoco.mj_kinematics(model, data)
        for band, strands in zip(self.bands, self.drawn, strict=True):
            colour = tension_colour(self.tension(band, data) / self.most)
            model.tendon_rgba[strands or band] = colour
        self._light(data)

    def _light(self, data: Any) -> None:
        travel = np.array([data.ten_length[i] for i in self.cells])
        stroke = float(data.qpos[self.stroke])
        if self.last is not None:
            before, at = self.last
            beyond = np.abs(travel - before) - abs(stroke - at)
            self.lit = np.where(beyond > SNAPS * self.full, 1.0, self.lit - 1.0 / FRAMES)
        self.last = travel, stroke
        for share, geoms in zip(np.clip(self.lit, 0.0, 1.0), self.lights, strict=True):
            own = self.colours[geoms]
            shown = own[:, 3:] > 0
            self.model.geom_rgba[geoms] = np.where(shown, own + share * (LIT - own), own)


def _bands_and_strands(names: list[str]) -> tuple[list[int], list[list[int]]]:
    """The tendons that are bands, and for each the strands that have its colour, if drawn."""
    strands = {i: name for i, name in enumerate(names) if name.startswith(STRANDS)}
    bands = [i for i, name in enumerate(names) if ".band" in name and i not in strands]
    of = {i: one[len(STRANDS) :].rpartition(" ")[0] for i, one in strands.items()}
    return bands, [[i for i, band in of.items() if band == names[k]] for k in bands]


def _followers(model: Model) -> list[tuple[int, int, int]]:
    """The body that follows two joints, and the sites of the near and the far one."""
    bodies = [model.body(i) for i in range(model.nbody)]
    return [
        (int(body.mocapid[0]), model.site(f"near {name}").id, model.site(f"far {name}").id)
        for body in bodies
        if body.mocapid[0] >= 0
        for name in [body.name.removeprefix("drawn ")]
    ]


def turned(rest: Floats, now: Floats) -> Floats:
    """(3, 3) the smallest rotation from the direction of one vector (3,) to that of another."""
    a, b = rest / np.linalg.norm(rest), now / np.linalg.norm(now)
    axis, cosine = np.cross(a, b), float(a @ b)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + cross + cross @ cross / (1.0 + cosine)
