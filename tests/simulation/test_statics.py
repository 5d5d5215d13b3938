"""The simulated robot at rest or slow, against statics that know nothing of the simulator."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from simulation.robots import cell, explorer, leg_of_three, robot
from sizes import SIZE
from stepwell.robot import Drive, Floor, Leg, Robot
from stepwell.simulation import Linkage, Settings, spec, walk
from stepwell.simulation.simulator import mujoco

AIR = Floor(gravity=0.0)


def of_any_bands() -> Robot:
    """Two bands in a cell, stiffening rubber, one that pushes, one that goes slack."""
    rubber = sw.Band((-0.010, 0.001), (0.015, 0.004), 25.0, 0.010, sw.Cubic(-20.0, 800.0))
    second = sw.Band((0.004, -0.012), (-0.003, 0.014), 20.0, 0.020)
    pushing = sw.Band((-0.010, 0.0), (0.020, 0.003), 30.0, 0.060, two_sided=True)
    slack = sw.Band((0.0, 0.0), (0.002, -0.010), 30.0, 0.016)
    chain = sw.Chain(
        [sw.Cell((rubber, second), name="inner"), sw.Cell((pushing, slack), name="outer")]
    )
    legs = [Leg("left", chain, (0.008, 0.0575)), Leg("right", chain, (0.008, -0.0575))]
    return Robot(legs, floor=AIR)


def with_other_cells() -> Robot:
    """Levers and limits that differ from cell to cell."""
    inner = replace(cell("inner", 0.012), lever=0.012, limit=math.radians(50))
    outer = replace(cell("outer", 0.016), lever=0.016, limit=math.radians(35))
    chain = sw.Chain([inner, outer])
    legs = [Leg("left", chain, (0.008, 0.0575)), Leg("right", chain, (0.008, -0.0575))]
    return Robot(legs, floor=AIR, drive=Drive(amplitude=chain.full_stroke))


def in_position(model, one: Robot, angles: dict[str, np.ndarray]) -> np.ndarray:
    """Joint positions with the levers of each leg at these angles; feet left where they are."""
    q = model.qpos0.copy()

    def place(joint: str, value: float) -> None:
        q[model.joint(joint).qposadr[0]] = value

    for leg in one.legs:
        stroke = sideways = 0.0
        for name, c, theta in zip(leg.chain.names, leg.chain.levers, angles[leg.name], strict=True):
            stroke += float(c.travel(theta))
            sideways += c.lever * (math.cos(theta) - 1.0)
            last = name == leg.chain.names[-1]
            place("stroke" if last else f"{leg.name}.{name}.block", stroke)
            place(f"{leg.name}.{name}.side", sideways)
    return q


@pytest.mark.parametrize("linkage", list(Linkage))
@pytest.mark.parametrize(
    "one",
    [
        robot(0.005, 0.020, floor=AIR),
        of_any_bands(),
        with_other_cells(),
        Robot([leg_of_three("left"), leg_of_three("right")], floor=AIR),
    ],
    ids=["paper", "any bands", "other cells", "three cells"],
)
def test_the_bands_store_what_the_cells_say(one, linkage):
    model = spec(one, settings=Settings(linkage=linkage)).compile()
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    for _ in range(50):
        # Both legs end at the carriage, so their last cells share what the others leave.
        angles = {
            leg.name: np.array([rng.uniform(-c.limit, c.limit) for c in leg.chain.cells])
            for leg in one.legs[:1]
        }
        angles |= {leg.name: angles[one.legs[0].name] for leg in one.legs[1:]}
        data.qpos[:] = in_position(model, one, angles)
        mujoco.mj_forward(model, data)
        wanted = sum(
            float(c.energy(theta))
            for leg in one.legs
            for c, theta in zip(leg.chain.levers, angles[leg.name], strict=True)
        )
        assert data.energy[0] == pytest.approx(wanted, rel=1e-9, abs=1e-12)


def test_a_pressed_antenna_puts_the_anchor_where_the_pressed_robot_has_it():
    one = replace(explorer(), floor=AIR)
    model = spec(one).compile()
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    angles = {leg.name: np.array([-0.3, 0.5]) for leg in one.legs}
    for swing in (0.0, 0.48, 1.2):
        data.qpos[:] = in_position(model, one, angles)
        gear = one.antennas[0].gear
        data.qpos[model.joint("left.antenna").qposadr[0]] = swing
        data.qpos[model.joint("left.anchor").qposadr[0]] = swing * gear
        mujoco.mj_forward(model, data)
        pressed = one.pressed({"left": swing})
        wanted = sum(
            float(c.energy(theta))
            for leg in pressed.legs
            for c, theta in zip(leg.chain.levers, angles[leg.name], strict=True)
        )
        assert data.energy[0] == pytest.approx(wanted, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("linkage", "friction"),
    [
        (Linkage.RODS, 0.05),
        (Linkage.HINGES, 0.0),
        *[(Linkage.RODS, 0.0), (Linkage.HINGES, 0.05)] * (SIZE == "full"),
    ],
)
def test_a_slow_stroke_in_the_air_needs_the_force_that_statics_says(linkage, friction):
    one = robot(0.005, 0.020, floor=AIR, drive=Drive(period=40.0))
    one = replace(one, legs=tuple(rubbing(leg, friction) for leg in one.legs))
    air = walk(one, 1, settings=Settings(linkage=linkage))
    assert air.cycles == 1
    out = (air.time > 0) & (air.time < 20.0)
    back = (air.time > 20.0) & (air.time < 40.0)
    for half, ends, start in ((out, [0.0, 0.040], "00"), (back, [0.040, 0.0], "11")):
        u = air.stroke[half]
        wanted, clear = np.zeros_like(u), (u > 0.0005) & (u < 0.0395)
        for leg in one.legs:
            path = leg.chain.path(ends, start=start)
            order = np.argsort(path.stroke, kind="stable")
            wanted += np.interp(u, path.stroke[order], path.force[order])
            # Where a cell arrives, leaves or snaps, the force jumps; give that 2 mm.
            for event in path.events:
                clear &= np.abs(u - event.stroke) > 0.002
        assert clear.mean() > 0.5
        error = np.abs(air.actuator_force[half] - wanted)[clear]
        # Damping of cells and guide at 2 mm/s makes 6 mN of it.
        assert error.max() < 0.02
        assert np.abs(wanted).max() > 1.0


def rubbing(leg: Leg, friction: float) -> Leg:
    """The same leg with Coulomb friction in every cell [N]."""
    cells = tuple(replace(one, friction=friction) for one in leg.chain.cells)
    return replace(leg, chain=replace(leg.chain, cells=cells))


@pytest.mark.parametrize("one", [robot(), robot(0.005, 0.005)], ids=["forward", "backward"])
def test_at_rest_feet_and_supports_carry_the_weight(one):
    rest = walk(one, 0.001, settings=Settings(settle=2.0))
    carried = rest.foot_force[-1].sum() + rest.support_force[-1].sum()
    assert carried == pytest.approx(one.weight, rel=1e-4)
    assert rest.foot_force[-1].min() > 0.1


@pytest.mark.parametrize("linkage", list(Linkage))
@pytest.mark.parametrize("drag", [0.39, 0.79])
def test_pulled_along_on_its_t_foot_alone_the_robot_drags_as_the_floor_says(linkage, drag):
    # Kamp et al. 2024: 0.39 N on MDF, 0.79 N on rubber, feet lifted.
    one = robot(floor=Floor(drag=drag))
    model = spec(one, settings=Settings(linkage=linkage)).compile()
    assert pulled(model, 0.97 * drag) < 1e-5
    # Half of a t², the force that is left over the mass.
    wanted = 0.10 * drag / one.mass * 0.5**2 / 2
    assert pulled(model, 1.10 * drag) == pytest.approx(wanted, rel=0.05)


def pulled(model, force: float) -> float:
    """How far a pull at the floor's height [N] moves the robot in half a second [m]."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    data.ctrl[0] = 0.040  # both feet in the air
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert data.sensor("left.sole").data[0] == data.sensor("right.sole").data[0] == 0.0
    begin = data.qpos[0]
    for _ in range(500):
        at = np.array([data.qpos[0], data.qpos[1], 0.0])
        data.qfrc_applied[:] = 0.0
        mujoco.mj_applyFT(
            model,
            data,
            [force, 0.0, 0.0],
            np.zeros(3),
            at,
            model.body("body").id,
            data.qfrc_applied,
        )
        mujoco.mj_step(model, data)
    return float(data.qpos[0] - begin)
