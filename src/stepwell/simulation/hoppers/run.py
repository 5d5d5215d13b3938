"""A run of a hopper in MuJoCo: stepping, the work of every force, and what is read off its log."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from stepwell import base
from stepwell.base import Floats, InputError, check
from stepwell.mechanism import Cell
from stepwell.robot import Hopper, JumpBound, Release, Task, flight, moving_force, onset
from stepwell.simulation.hoppers.model import hopper_spec, out_of
from stepwell.simulation.simulator import Model, mujoco, quietly

Progress = Callable[[float, float], None]

COARSEST = 1e-4  # largest time step [s]
FALLEN, STANDS = math.radians(45.0), math.radians(5.0)  # pitch of the body
BEFORE = 3e-4  # stroke before the predicted snap at which a run begins [m]
OVER = 1e-3  # stroke behind the predicted snap at which the rod stops [m]
SETTLE = 0.02  # time at rest before the rod moves [s]
LANDED = 0.25  # time after the predicted landing before the rod returns [s]
AT_ZERO = 0.05  # time of the rod at stroke 0 before the next jump [s]
ALOFT = 0.1  # time of a throw or a blow after the rod stops [s]
CREEP = 5e-3  # speed from which a contracting band has its full loss [m/s]
_LOOKS = 2001


@dataclass(frozen=True, slots=True, eq=False)
class JumpSettings(base.ByValue):
    """Numerical parameters of the simulation of a hopper; a `ValueError` refuses other values.

    Args:
        time_step: [s], > 0 to 0.1 ms: with larger ones a snap gains energy.
        contact_time: time constant of stops and contacts [s], 0.2 to 0.5 ms and at least twice the
            time step: slower ones stop the snap in the floor.
        sample: time between recorded samples [s].
    """

    time_step: float = COARSEST
    contact_time: float = 3e-4
    sample: float = 1e-3

    def __post_init__(self):
        check.fields(self, check.positive, time_step="s", contact_time="s", sample="s")
        if self.time_step > COARSEST:
            raise InputError(f"time_step = {self.time_step:g} s: must be <= {COARSEST:g} s.")
        least = max(2e-4, 2 * self.time_step)
        if not least <= self.contact_time <= 5e-4:
            raise InputError(
                f"contact_time = {self.contact_time:g} s: must be from {least:g} to 0.0005 s."
            )


@dataclass(frozen=True, slots=True, eq=False)
class EnergyFlow(base.ByValue):
    """Balance of energy [J] from the beginning of a snap to lift-off.

    Attributes:
        stored: energy of the springs when the snap begins.
        released: part of it that the springs set free until lift-off.
        actuator: work of the actuator in that time.
        dampers, friction, stops, foot: taken by dampers, by friction, by the stops of the cells,
            and by the contact of foot and floor, or of pusher and ball.
        springs: lost in the material of the springs.
        lift: work against gravity before lift-off.
        flight: kinetic energy of the centre of mass at lift-off, of the ball, or of the hammer.
        inner: kinetic energy of parts that move against the centre of mass, which their stops take
            in flight.
    """

    stored: float
    released: float
    actuator: float
    dampers: float
    springs: float
    friction: float
    stops: float
    foot: float
    lift: float
    flight: float
    inner: float

    @property
    def residual(self) -> float:
        """Input less output [J]: the error of the integration."""
        names = ("dampers", "springs", "friction", "stops", "foot", "lift", "flight", "inner")
        return self.released + self.actuator - math.fsum(getattr(self, one) for one in names)

    @property
    def error(self) -> float:
        """The residual over the input, in size [1]."""
        return abs(self.residual) / (self.released + max(self.actuator, 0.0))

    @property
    def efficiency(self) -> float:
        """Energy of the flight over the energy that the springs set free [1]."""
        return self.flight / self.released


@dataclass(frozen=True, slots=True, eq=False)
class Hop(base.ByValue):
    """One simulated jump, throw or blow.

    Attributes:
        snap: time at which the energy of the springs is largest [s].
        lift_off: time of the last contact before the apex [s]; of a blow, of reaching the stop.
        speed: of the centre of mass, the ball or the hammer at lift-off [m/s].
        height: from lift-off to the apex [m]; of a throw along its ballistic flight.
        distance: of the foot's middle from stand to stand, or of the ball on level ground [m].
        flow: balance of energy until lift-off.
        peak_force: largest force of the actuator until the snap, in size [N].
        blow: largest force of the actuator from the snap to lift-off, in size [N]; it depends on
            the stiffness of the actuator and on the contact time, and is no design number.
        stop_speed: of the foot against the body just before its stop [m/s].
        pitch: of the body after the landing [rad].
        landed: whether it stands on its foot after the landing; True for a throw or a blow.
    """

    snap: float
    lift_off: float
    speed: float
    height: float
    distance: float
    flow: EnergyFlow
    peak_force: float
    blow: float
    stop_speed: float
    pitch: float
    landed: bool

    @property
    def delay(self) -> float:
        """Time from the beginning of the snap to lift-off [s]."""
        return self.lift_off - self.snap


class _Law:
    """Force and energy of a cell by its travel, straight between close points, also past stops."""

    def __init__(self, cell: Cell, loss: float):
        grid = np.linspace(0.0, cell.full_travel, _LOOKS)
        elastic = moving_force(cell, grid, 0.0, 1)
        self.step, self.last = cell.full_travel / (_LOOKS - 1), _LOOKS - 2
        self.scale, self.lossy = 1.0 / self.step, loss > 0.0
        stored = np.cumsum(elastic[:-1] + elastic[1:]) * self.step / 2.0 + cell.energy_at(0.0)
        self.force, self.energy = elastic.tolist(), [float(cell.energy_at(0.0)), *stored.tolist()]
        # What a contracting band lacks, for rising and for falling travel.
        self.rising = (elastic - moving_force(cell, grid, loss, 1)).tolist()
        self.falling = (elastic - moving_force(cell, grid, loss, -1)).tolist()

    def at(self, travel: float, speed: float) -> tuple[float, float, float]:
        """Elastic force [N], what the losses take from it [N], and energy [J]."""
        i = min(max(int(travel * self.scale), 0), self.last)
        x = travel - i * self.step
        f0 = self.force[i]
        slope = (self.force[i + 1] - f0) * self.scale
        energy = self.energy[i] + x * (f0 + slope * x / 2.0)
        lacks = 0.0
        if self.lossy:
            rows = self.rising if speed > 0.0 else self.falling
            full = rows[i] + (rows[i + 1] - rows[i]) * x * self.scale
            lacks = full * min(abs(speed) / CREEP, 1.0)
        return f0 + slope * x, lacks, energy


class _Row(NamedTuple):
    """The state of a run before a step, and the work of each force until then [J]."""

    time: Any
    stored: Any
    actuator: Any
    dampers: Any
    springs: Any
    friction: Any
    stops: Any
    foot: Any
    gravity: Any  # potential and kinetic energy of all bodies [J]
    kinetic: Any
    contacts: Any
    x: Any  # of the centre of mass, or of the ball [m]
    z: Any
    out: Any  # travel and speed of the foot against the body [m], [m/s]
    speed: Any
    force: Any  # of the actuator [N]
    pitch: Any
    place: Any  # of the foot's middle along the way [m]


# The work of each kind of constraint of MuJoCo, by its place among the works.
_WORKS = ("actuator", "dampers", "springs", "friction", "stops", "foot")
_KIND = mujoco.mjtConstraint
_KINDS = {
    int(_KIND.mjCNSTR_FRICTION_TENDON): 3,
    int(_KIND.mjCNSTR_LIMIT_TENDON): 4,
    int(_KIND.mjCNSTR_CONTACT_FRICTIONLESS): 5,
    int(_KIND.mjCNSTR_CONTACT_PYRAMIDAL): 5,
    int(_KIND.mjCNSTR_CONTACT_ELLIPTIC): 5,
}


class HopperRun:
    """A run of one model: stepping, work of every force, and what is read off the log."""

    def __init__(self, hopper: Hopper, snap: Release, bound: JumpBound, settings: JumpSettings):
        self.hopper, self.snap, self.bound, self.settings = hopper, snap, bound, settings
        spec = hopper_spec(hopper, settings.time_step, settings.contact_time)
        self.model: Model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.laws = [_Law(cell, hopper.springs.loss) for cell in hopper.whole.levers]
        self.first = self.model.joint("block 1").qposadr[0]
        self.body = self.model.body("ball" if hopper.task is Task.THROW else "body").id
        self.jumps = hopper.task is Task.JUMP
        stiffness, rod = hopper.actuator.stiffness, hopper.block_mass
        self.damper = 2.0 * math.sqrt(stiffness * rod)
        # Critically damped, but not more than a step can resolve.
        self.damper = min(self.damper, 0.5 * rod / settings.time_step)
        self.log: list[_Row] = []
        self.seen: list[tuple[float, ...]] = []
        self.starts: list[float] = []

    def _begin(self) -> list[tuple[float, float]]:
        """Set the start, in equilibrium just before the snap."""
        hopper = self.hopper
        begin = max(self.snap.stroke - BEFORE, 0.0)
        path = hopper.loaded.path([0.0, begin])
        blocks = np.cumsum(path.end)
        position = self.data.qpos
        position[self.first : self.first + len(blocks)] = blocks
        foot = float(blocks[hopper.foot_after - 1])
        if hopper.task is Task.THROW:
            position[-1] = foot
        if self.jumps:
            position[0], position[1] = foot * math.sin(hopper.tilt), foot * math.cos(hopper.tilt)
        # The spring of the actuator is compressed or stretched from the beginning.
        give = float(path.end_force) / hopper.actuator.stiffness
        return [(0.0, begin + give), (SETTLE, begin + give)]

    def _command(self, count: int) -> list[tuple[float, float]]:
        """Corners (time, stroke) of the command of the rod [s], [m]."""
        corners, speed = self._begin(), self.hopper.actuator.speed
        # Losses delay the snap.
        late = onset(self.hopper, self.snap) - self.snap.before[0] if len(self.laws) == 2 else 0.0
        top = min(self.snap.stroke + late + OVER, self.hopper.chain.full_stroke)
        top += self.snap.largest_force / self.hopper.actuator.stiffness
        up = self.bound.speed * math.cos(self.hopper.tilt)
        aloft = 2.0 * up / self.hopper.gravity if self.jumps else ALOFT
        for k in range(count):
            time, at = corners[-1]
            self.starts.append(time)
            corners.append((time + abs(top - at) / speed, top))
            corners.append((corners[-1][0] + aloft + LANDED * self.jumps, top))
            if k < count - 1:
                corners.append((corners[-1][0] + top / speed, 0.0))
                corners.append((corners[-1][0] + AT_ZERO, 0.0))
        return corners

    def simulate(self, count: int, progress: Progress | None) -> None:
        """Step through all jumps."""
        if self.jumps and not self.hopper.gravity > 0.0:
            raise InputError("gravity = 0 m/s²: must be > 0 for a jump, which else has no end.")
        corners = self._command(count)
        step, end = self.settings.time_step, corners[-1][0]
        base.require("steps", round(end / step), f"{end:.6g} s in steps of {step:g} s are")
        times, strokes = (np.array(one) for one in zip(*corners, strict=True))
        grid = np.arange(round(end / step)) * step
        wanted = np.interp(grid, times, strokes)
        rates = np.diff(wanted, append=wanted[-1]) / step
        every = max(1, round(self.settings.sample / step))
        works = [0.0] * 6
        with quietly():
            for i, (at, rate) in enumerate(zip(wanted.tolist(), rates.tolist(), strict=True)):
                self._step(i * step, at, rate, works, keep=i % every == 0)
                if abs(self.log[-1].pitch) > FALLEN:
                    break
                if i % 2000 == 0:
                    base.notify(progress, i * step, end)

    def _step(
        self, time: float, wanted: float, rate: float, works: list[float], keep: bool
    ) -> None:
        """Apply the forces of cells and actuator for one step, and log the state before it."""
        data, first, n = self.data, self.first, len(self.laws)
        position, before = data.qpos.tolist(), data.qvel.tolist()
        blocks, speeds = position[first : first + n], before[first : first + n]
        forces, lacking, damped, stored = [0.0] * n, [0.0] * n, [0.0] * n, 0.0
        past = moves = 0.0
        for j, law in enumerate(self.laws):
            speed = speeds[j] - moves
            elastic, lacks, energy = law.at(blocks[j] - past, speed)
            past, moves = blocks[j], speeds[j]
            stored += energy
            lacking[j], damped[j] = lacks, self.hopper.damping * speed
            pull = elastic - lacks + damped[j]
            forces[j] -= pull
            if j:
                forces[j - 1] += pull
        push = self.hopper.actuator.stiffness * (wanted - past) + self.damper * (rate - moves)
        forces[-1] += push
        data.qfrc_applied[first : first + n] = forces
        mujoco.mj_step(self.model, data)
        x, _, z = data.subtree_com[self.body].tolist()
        foot = self.hopper.foot_after - 1
        out, pitch = blocks[foot], position[2] if self.jumps else 0.0
        place = position[0] - out * math.sin(self.hopper.tilt)
        state = (*data.energy.tolist(), data.ncon, x, z, out, speeds[foot], push, pitch, place)
        self.log.append(_Row._make((time, stored, *works, *state)))
        if keep:
            self.seen.append((time, x, z, *position))
        self._work(works, before, (push, lacking, damped))

    def _work(
        self, works: list[float], before: list[float], given: tuple[float, list[float], list[float]]
    ) -> None:
        """Add the work of every force in the last step, by the mean speed of the step.

        With it the works of a step sum up to the change of kinetic energy, whatever the step.
        """
        data, (push, lacking, damped) = self.data, given
        mean = [(a + b) / 2.0 for a, b in zip(before, data.qvel.tolist(), strict=True)]
        step, past = self.settings.time_step, 0.0
        works[0] += push * mean[self.first + len(damped) - 1] * step
        for j, (lacks, damper) in enumerate(zip(lacking, damped, strict=True)):
            rate, past = mean[self.first + j] - past, mean[self.first + j]
            works[1] += damper * rate * step
            works[2] -= lacks * rate * step
        if data.nefc:
            along = data.efc_J.reshape(data.nefc, -1) @ np.array(mean)
            power = (data.efc_force * along * -step).tolist()
            for kind, one in zip(data.efc_type.tolist(), power, strict=True):
                works[_KINDS[kind]] += one

    def _rows(self) -> _Row:
        """The log by columns, each (n,), with speeds and works at the times of the positions.

        The integrator computes speeds half a step before the positions, as leapfrog does; what
        follows from them is the mean of two rows. Without it, the energies of fast parts do not
        match.
        """
        rows = _Row(*np.array(self.log).T)
        halved = ("kinetic", "speed", *_WORKS)
        return rows._replace(**{name: _centred(getattr(rows, name)) for name in halved})

    def samples(self) -> tuple[float, Floats, Floats, Floats, Floats]:
        """Balance of the whole run, and time, centre, travels and positions of the samples."""
        rows, seen = self._rows(), np.array(self.seen)
        taken = rows.dampers + rows.springs + rows.friction + rows.stops + rows.foot
        held = rows.stored + rows.gravity + rows.kinetic
        residual = rows.actuator - taken - (held - held[0])
        balance = float(np.max(np.abs(residual))) / self.snap.of_springs
        blocks = seen[:, 3 + self.first : 3 + self.first + len(self.laws)]
        travels = np.diff(blocks, axis=1, prepend=0.0)
        return balance, seen[:, 0], seen[:, 1:3], travels, seen[:, 3:]

    def hops(self) -> tuple[Hop, ...]:
        """What is read off the log for each jump that began."""
        rows, step = self._rows(), self.settings.time_step
        ends = [round(one / step) for one in self.starts[1:]] + [len(self.log)]
        parts = [
            _Row(*(one[round(begin / step) : end] for one in rows))
            for begin, end in zip(self.starts, ends, strict=True)
        ]
        return tuple(self._hop(one) for one in parts if len(one.time) > 2)

    def _hop(self, own: _Row) -> Hop:
        hopper, step = self.hopper, self.settings.time_step
        last = self._lift_off(own)
        start = int(np.argmax(own.stored[: last + 1]))
        moved = [one[last + 1] - one[last - 1] for one in (own.x, own.z)]
        rate = np.array(moved) / (2.0 * step)
        speed = float(own.speed[last] if hopper.task is Task.STRIKE else np.hypot(*rate))
        flying = flight(hopper, self.snap, speed)
        height, distance = flying.height, flying.distance
        if self.jumps:
            height = float(own.z.max() - own.z[last])
            distance = float(own.place[-1] - own.place[0])
        pitch = float(own.pitch[-1])
        return Hop(
            snap=float(own.time[start]),
            lift_off=float(own.time[last]),
            speed=speed,
            height=height,
            distance=distance,
            flow=self._flow(own, start, last, flying.energy),
            peak_force=float(np.abs(own.force[: start + 1]).max()),
            blow=float(np.abs(own.force[start : last + 1]).max()),
            stop_speed=float(own.speed[start : last + 1].max()),
            pitch=pitch,
            landed=abs(pitch) < STANDS,
        )

    def _lift_off(self, own: _Row) -> int:
        """The step after the last contact before the apex; of a blow, the one before its stop."""
        if self.hopper.task is Task.STRIKE:
            stop = math.fsum(self.snap.after[: self.hopper.foot_after])
            last = int(np.argmax(own.out >= min(stop, own.out.max()))) - 1
        else:
            # The apex first: contacts are lost many times before the lift-off.
            dx, _, dz = out_of(self.hopper)
            high = own.z if self.jumps else own.x * dx + own.z * dz
            touching = own.contacts[: int(np.argmax(high)) + 1] > 0
            last = int(np.flatnonzero(touching).max(initial=0)) + 1
        return min(max(last, 1), len(own.time) - 2)

    def _flow(self, own: _Row, start: int, end: int, flying: float) -> EnergyFlow:
        change = _Row(*(one[end] - one[start] for one in own))
        works = {name: float(getattr(change, name)) for name in _WORKS}
        return EnergyFlow(
            stored=float(own.stored[start]),
            released=-float(change.stored),
            lift=float(change.gravity),
            flight=flying,
            inner=float(change.kinetic) - flying,
            **works,
        )


def _centred(values: Floats) -> Floats:
    """(n,) mean of each value and the next one."""
    return np.append((values[:-1] + values[1:]) / 2.0, values[-1:])
