"""The position command is the only input: no force, spring or script beside it."""

import numpy as np
import pytest

from simulation.robots import explorer, robot
from stepwell.robot import Arena, Cylinder, Wall
from stepwell.simulation import Linkage, Settings, engine, spec, walk
from stepwell.simulation.simulator import mujoco

ARENA = Arena([Wall((0.5, -0.5), (0.5, 0.5))], [Cylinder((0.3, 0.3))])


@pytest.fixture(params=list(Linkage))
def settings(request) -> Settings:
    return Settings(linkage=request.param)


def test_the_one_actuator_is_the_drive_and_it_holds_a_position(settings):
    for one in (robot(), explorer()):
        model = spec(one, ARENA, settings).compile()
        assert [model.actuator(i).name for i in range(model.nu)] == ["drive"]
        assert model.actuator("drive").trnid[0] == model.joint("stroke").id
        assert model.actuator("drive").gainprm[0] == one.drive.stiffness
        assert model.actuator("drive").biasprm[1] == -one.drive.stiffness
        assert model.na == model.nmocap == model.nplugin == 0


def test_nothing_stores_energy_but_bands_and_weight(settings):
    for one in (robot(), explorer()):
        model = spec(one, ARENA, settings).compile()
        springs = {model.tendon(i).name for i in np.flatnonzero(model.tendon_stiffness)}
        bands = {f"{leg.name}.{cell}.band" for leg in one.legs for cell in leg.chain.names}
        assert springs == bands
        assert not model.jnt_stiffness.any()
        assert not model.body_gravcomp.any()
        assert not model.opt.wind.any()


def test_the_weak_spring_of_a_disconnected_antenna_is_the_one_exception():
    model = spec(explorer(connected=False)).compile()
    sprung = {model.joint(i).name for i in np.flatnonzero(model.jnt_stiffness)}
    assert sprung == {"left.antenna", "right.antenna"}


def test_a_walk_hands_over_the_drives_command_and_nothing_else(monkeypatch):
    handed = []
    real = engine.rollout.rollout

    def watched(model, data, state, control, **more):
        handed.append((control.copy(), set(more)))
        assert not data.qfrc_applied.any()
        assert not data.xfrc_applied.any()
        return real(model, data, state, control, **more)

    monkeypatch.setattr(engine.rollout, "rollout", watched)
    one, settings = robot(), Settings()
    walk(one, 1.3, settings=settings)
    # Without a control_spec MuJoCo takes the numbers for actuator commands.
    assert {frozenset(more) for _, more in handed} == {frozenset({"initial_warmstart"})}
    command = np.concatenate([control[0] for control, _ in handed])
    time = np.arange(len(command)) * settings.time_step - settings.settle
    assert command.shape[1] == 1
    assert command[:, 0] == pytest.approx(one.drive.stroke(time), abs=1e-12)


def test_the_model_calls_no_code_of_ours_while_it_steps():
    walk(robot(), 0.1)
    for hook in ("control", "passive", "contactfilter", "act_bias", "act_dyn", "act_gain"):
        assert getattr(mujoco, f"get_mjcb_{hook}")() is None
