"""A gripper closes on an object, holds it without its actuator and opens, by one stroke."""

from dataclasses import dataclass
from typing import Any

import mujoco as simulator
import numpy as np

import stepwell as sw

mujoco: Any = simulator  # its compiled modules have no types
GAP = 0.024  # between the pads with the first finger at its stop and the second one open [m]
FRICTION = 0.8  # between pads and object
OUT = 0.040  # command of the actuator at the end of loading [m]
HEIGHT, LIFT = 0.012, 0.040  # of the object's middle on the table, and of the lift [m]
CLOSED, FREE, RAISED, HELD, OPENED = 2.0, 2.2, 3.2, 5.2, 7.2  # ends of the stages [s]

MODEL = """
<mujoco>
  <option timestep="0.0005" integrator="implicitfast" cone="elliptic" impratio="100"/>
  <default>
    <geom type="box" solref="0.002 1" solimp="0.99 0.999 0.0001" friction="0.2"/>
    <joint type="slide" solreflimit="0.001 1" solimplimit="0.99 0.999 0.0001"/>
    <default class="pad">
      <geom size="0.006 0.002 0.008" mass="0.02" friction="{friction}" priority="1"/>
      <joint limited="true" range="0 {travel}" damping="1"/>
    </default>
  </default>
  <worldbody>
    <geom name="table" type="plane" size="1 1 0.1"/>
    <body name="palm" pos="0 0 {height}">
      <joint name="lift" axis="0 0 1"/>
      <geom size="0.005 0.03 0.005" pos="0 0 0.05" mass="0.1" contype="0" conaffinity="0"/>
      <body pos="0 {first} 0" childclass="pad">
        <joint name="first finger" axis="0 1 0"/>
        <geom name="first pad"/>
      </body>
      <body pos="0 {second} 0" childclass="pad">
        <joint name="second finger" axis="0 -1 0"/>
        <geom name="second pad"/>
      </body>
    </body>
    <body name="object" pos="0 {middle} {height}">
      <freejoint/>
      <geom name="object" size="0.006 {half} {height}" mass="{mass}"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="stroke">
      <joint joint="first finger" coef="1"/>
      <joint joint="second finger" coef="1"/>
    </fixed>
  </tendon>
  <actuator>
    <position name="drive" tendon="stroke" kp="{stiffness}"/>
    <position name="lift" joint="lift" kp="2000" dampratio="1"/>
  </actuator>
</mujoco>
"""


@dataclass(frozen=True)
class Grip:
    """What happened to an object: its slip while it was held [m], forces [N], and its release."""

    slip: float
    force: float
    opened: bool

    @property
    def held(self) -> bool:
        """Whether the object moved by less than 1 mm between the pads."""
        return bool(abs(self.slip) < 0.001)


def grip(chain: sw.Chain, width: float, mass: float) -> Grip:
    """Close on an object of this width [m] and mass [kg], let the actuator go, lift, hold, open."""
    travel = chain.full_travels[0]
    model = mujoco.MjModel.from_xml_string(
        MODEL.format(
            travel=travel, height=HEIGHT, friction=FRICTION, first=-travel - 0.002, mass=mass,
            second=GAP + 0.002, middle=width / 2 + 0.001, half=width / 2,
            stiffness=chain.actuator_stiffness,
        )
    )  # fmt: skip
    data = mujoco.MjData(model)
    fingers = [model.joint(name).qposadr[0] for name in chain.names]
    speeds = [model.joint(name).dofadr[0] for name in chain.names]
    # The bands act as the forces of the cells along their travels.
    grid = np.linspace(0.0, travel, 401)
    forces = [cell.force(cell.angle(grid)) for cell in chain.levers]
    drive = model.actuator("drive").id
    gain, bias = model.actuator_gainprm[drive].copy(), model.actuator_biasprm[drive].copy()

    def until(end, stroke, height=0.0, driven=True):
        """Move both commands to these values [m] by the end of a stage [s]."""
        model.actuator_gainprm[drive], model.actuator_biasprm[drive] = driven * gain, driven * bias
        begin, now = data.ctrl.copy(), data.time
        while data.time < end:
            data.ctrl[:] = begin + (np.array([stroke, height]) - begin) * (data.time - now) / (
                end - now
            )
            for at, speed, force in zip(fingers, speeds, forces, strict=True):
                data.qfrc_applied[speed] = -np.interp(data.qpos[at], grid, force)
            mujoco.mj_step(model, data)

    def above():
        """Height of the object between the pads [m]."""
        return data.body("object").xpos[2] - data.body("palm").xpos[2]

    def pressed():
        """Normal force of each pad on the object [N]."""
        found, part = dict.fromkeys(("first pad", "second pad"), 0.0), np.zeros(6)
        for k, contact in enumerate(data.contact):
            names = {model.geom(int(one)).name for one in contact.geom}
            for pad in names & found.keys():
                mujoco.mj_contactForce(model, data, k, part)
                found[pad] += part[0]
        return found

    until(CLOSED, OUT)
    until(FREE, OUT, driven=False)
    before = above()
    until(RAISED, OUT, LIFT, driven=False)
    until(HELD, OUT, LIFT, driven=False)
    slip, force = above() - before, min(pressed().values())
    data.ctrl[0] = sum(data.qpos[at] for at in fingers)
    until(OPENED, 0.0, LIFT)
    return Grip(slip, force, bool(not any(pressed().values()) and above() < -0.010))


chain = sw.preset("two-finger-gripper")
width = 0.009
second = chain.levers[1]
predicted = -float(second.force(second.angle(GAP - width)))
limit = 2 * FRICTION * predicted / 9.81
print(f"{width * 1e3:g} mm wide: {predicted:.3f} N on each side, enough for {limit * 1e3:.0f} g")
grips = {share: grip(chain, width, share * limit) for share in (0.8, 1.2)}
simulated = grips[0.8].force
for share, one in grips.items():
    words = "held" if one.held else "lost", "opens" if one.opened else "does not open"
    print(f"{share * limit * 1e3:.0f} g: {words[0]}, {one.force:.3f} N; {words[1]}")
