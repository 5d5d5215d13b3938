"""Simulated jumps, throws and blows of a hopper beside those predicted by statics."""

import os
from dataclasses import dataclass, replace

from stepwell import base
from stepwell.base import Floats, check
from stepwell.robot import Hopper, JumpBound, Task, after_stop, bound_of, predicted_stop, snap_of
from stepwell.simulation.hoppers.run import Hop, HopperRun, JumpSettings, Progress

# The highest jump of an engineered jumper and the specific energy of its spring [m], [J/kg]:
# Hawkes et al. 2022, Nature 604, 657 (32.9 m; 1,075 J/kg of spring).
RECORD_HEIGHT, RECORD_SPRING = 32.9, 1075.0


@dataclass(frozen=True, slots=True, eq=False)
class HalvedStep(base.ByValue):
    """The first jump at one time step.

    Attributes:
        time_step: [s].
        speed, height: as of the jump [m/s], [m].
        error: of the balance of energy [1].
    """

    time_step: float
    speed: float
    height: float
    error: float


@dataclass(frozen=True, slots=True, eq=False)
class RecordFactor(base.ByValue):
    """A factor of a jump's energy beside that of the highest one of an engineered jumper.

    Attributes:
        name: the factor.
        ours: its value, in the unit of its name.
        record: that of Hawkes et al. 2022; None if not published.
    """

    name: str
    ours: float
    record: float | None = None

    @property
    def ratio(self) -> float | None:
        """Record over ours [1]; None without a record."""
        return None if self.record is None else self.record / self.ours


@dataclass(frozen=True, eq=False)
class Jump(base.ByValue, base.Drawn):
    """Jumps, throws or blows of a hopper, predicted and simulated.

    Attributes:
        hopper, settings: what was simulated, and how.
        bound: by statics, without losses.
        model: with dampers, friction and losses of springs; None for more than two cells.
        hops: each simulated one, in order.
        halved: the first one at several time steps, the finest last; empty if not computed.
        balance: largest error of the energy balance over the whole run, over the energy that the
            springs set free in a jump [1].
        time: (n,) of the samples [s].
        centre: (n, 2) forward and upward place of the centre of mass, or of the ball [m].
        travels: (n, N) of the cells [m].
        positions: (n, nq) of the joints of the MuJoCo model.
    """

    hopper: Hopper
    settings: JumpSettings
    bound: JumpBound
    model: JumpBound | None
    hops: tuple[Hop, ...]
    halved: tuple[HalvedStep, ...]
    balance: float
    time: Floats
    centre: Floats
    travels: Floats
    positions: Floats

    def __repr__(self):
        high = base.to_unit(self.first.height, "mm")
        return (
            f"Jump({self.hopper!r}: {len(self.hops)} times, {high:.3g} mm high, "
            f"{self.first.speed:.3g} m/s; bound {base.to_unit(self.bound.height, 'mm'):.3g} mm)"
        )

    @property
    def first(self) -> Hop:
        """The first jump."""
        return self.hops[0]

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the samples as CSV: time, place of the centre of mass, and travels of the cells."""
        names = self.hopper.chain.names
        columns = [
            (base.Quantity("time", "s"), self.time),
            (base.Quantity("forward", "mm"), self.centre[:, 0]),
            (base.Quantity("height", "mm"), self.centre[:, 1]),
            *(
                (base.Quantity(f"travel_{name}", "mm"), travel)
                for name, travel in zip(names, self.travels.T, strict=True)
            ),
        ]
        base.write_csv(file, columns)

    @property
    def model_reason(self) -> str:
        """Why there is no model; empty if there is one."""
        if self.model is not None:
            return ""
        return (
            f"none for {len(self.hopper.chain)} cells: further blocks have masses of their own, "
            f"which the bound leaves out too"
        )

    @property
    def speed_change(self) -> float | None:
        """Change of the speed from the largest time step to the smallest [1]; None for one step."""
        if len(self.halved) < 2:
            return None
        first, *_, last = self.halved
        return abs(first.speed - last.speed) / last.speed

    @property
    def stored_per_spring(self) -> float:
        """Energy stored at the snap over the mass of the springs [J/kg]."""
        return self.first.flow.stored / self.hopper.springs.mass

    @property
    def released_per_spring(self) -> float:
        """Energy set free over the mass of the springs [J/kg]."""
        return self.first.flow.released / self.hopper.springs.mass

    @property
    def released_per_robot(self) -> float:
        """Energy set free over the mass of body and foot [J/kg]."""
        return self.first.flow.released / self.hopper.mass

    @property
    def factors(self) -> tuple["RecordFactor", ...]:
        """What separates a jump from the highest one of an engineered jumper, factor by factor.

        The product of ours is v²/2 at lift-off [J/kg]. The record is g h without the drag of air;
        of its factors only the spring's is published, the others are given by their product.
        """
        if self.hopper.task is not Task.JUMP:
            return ()
        flow, hopper = self.first.flow, self.hopper
        flown = flow.flight / hopper.mass
        return (
            RecordFactor(
                "energy stored in the springs [J/kg]", self.stored_per_spring, RECORD_SPRING
            ),
            RecordFactor("mass of the springs over all mass", hopper.springs.mass / hopper.mass),
            RecordFactor("set free in one snap, over stored", flow.released / flow.stored),
            RecordFactor("flown, over set free", flow.efficiency),
            RecordFactor(
                "flown, over stored, times mass of the springs over all mass",
                flown / self.stored_per_spring,
                base.GRAVITY * RECORD_HEIGHT / RECORD_SPRING,
            ),
            RecordFactor("flown [J/kg]", flown, base.GRAVITY * RECORD_HEIGHT),
        )


def jump(
    hopper: Hopper,
    jumps: int = 1,
    *,
    settings: JumpSettings | None = None,
    halve: int = 1,
    progress: Progress | None = None,
) -> Jump:
    """Simulate jumps of a hopper, and compare them with statics.

    The rod of the actuator is the only input: it moves slowly past the predicted snap, waits for
    the landing and returns. The force of each cell is that of its bands at every step.

    Args:
        hopper: with its task.
        jumps: number of jumps in a row, 1 to 100.
        settings: of the simulation.
        halve: number of times that the time step is halved for the convergence of the first jump.
        progress: called with (done, total) [s].

    Raises:
        ValueError: the hopper cannot do its task, with every reason, before the simulation.
        StaticsError: the path of the chain could not be computed.
        ModuleNotFoundError: MuJoCo is not installed.
    """
    settings = settings or JumpSettings()
    count = check.whole("jumps", jumps, 1)
    snap = snap_of(hopper)
    bound = bound_of(hopper, snap)
    model = None
    if len(hopper.chain) == 2:
        model = after_stop(hopper, snap, predicted_stop(hopper, snap))
    run = HopperRun(hopper, snap, bound, settings)
    run.simulate(count, progress)
    hops = run.hops()
    halved = [_row(settings, hops[0])]
    for k in range(1, 1 + halve):
        finer = replace(settings, time_step=settings.time_step / 2**k)
        again = HopperRun(hopper, snap, bound, finer)
        again.simulate(1, None)
        halved.append(_row(finer, again.hops()[0]))
    return Jump(
        hopper, settings, bound, model, hops, tuple(halved) if halve else (), *run.samples()
    )


def _row(settings: JumpSettings, hop: Hop) -> HalvedStep:
    return HalvedStep(settings.time_step, hop.speed, hop.height, hop.flow.error)
