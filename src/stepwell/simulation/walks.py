"""A simulated walk: samples, and results per cycle."""

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from stepwell import base
from stepwell.robot import Arena, Robot, gait, states
from stepwell.simulation.arenas.surroundings import obstacle_names
from stepwell.simulation.engine import RunSamples, SimulatedRun
from stepwell.simulation.simulator import Settings

if TYPE_CHECKING:
    import xarray as xr

    from stepwell.simulation.comparison import GaitComparison


LOADED = 0.02  # a foot with a larger ground reaction force [N] is in stance
_MEAN = "mean since the previous sample"
_CARRIED = f"ground reaction force, {_MEAN}"
SAMPLES: base.Schema = (
    base.Quantity("x", "mm", doc="body's origin, along the start's x axis"),
    base.Quantity("y", "mm", doc="body's origin, to the left"),
    base.Quantity("z", "mm", doc="body's origin, above the floor"),
    base.Quantity("yaw", "deg", doc="heading"),
    base.Quantity("pitch", "deg", doc="nose down"),
    base.Quantity("roll", "deg", doc="right side down"),
    base.Quantity("command", "mm", doc="commanded stroke"),
    base.Quantity("stroke", "mm", doc="actual stroke"),
    base.Quantity("actuator_force", "N", doc="on the outermost blocks, positive outwards"),
    base.Quantity("travel", "mm", doc="of each cell", dims=("leg", "cell")),
    base.Quantity("foot_height", "mm", doc="lowest point above the floor", dims=("leg",)),
    base.Quantity("foot_force", "N", doc=_CARRIED, dims=("leg",)),
    base.Quantity("foot_speed", "mm_s", doc="along the floor", dims=("leg",)),
    base.Quantity("support_force", "N", doc=_CARRIED, dims=("support",)),
    base.Quantity("antenna", "deg", doc="rotation from rest", dims=("antennas",)),
    base.Quantity("touch", "N", doc=f"contact force on the antenna, {_MEAN}", dims=("antennas",)),
    base.Quantity("obstacle_force", "N", doc=f"on each obstacle, {_MEAN}", dims=("obstacle",)),
)


@dataclass(frozen=True, slots=True, eq=False)
class Walk(base.ByValue, base.Drawn):
    """A simulated walk of a robot.

    Contact forces are means since the previous sample, since they change within a sample; all other
    values are those at the sample.

    Attributes:
        robot, settings, arena: the robot (at the end), the simulation, and the arena if any.
        time: (n,) from the start of the first cycle [s].
        x, y, z: (n,) of the body's origin [m].
        yaw, pitch, roll: (n,) of the body [rad]; yaw continues beyond a full turn.
        command, stroke: (n,) of the actuator, commanded and actual [m].
        travel: (n, legs, cells) of every cell [m].
        foot_height: (n, legs) of the lowest point of each foot above the floor [m].
        foot_force: (n, legs) ground reaction force of each foot [N].
        foot_speed: (n, legs) of each foot along the floor [m/s].
        support_force: (n, supports) ground reaction force of each support [N].
        actuator_force: (n,) on the outermost blocks, positive outwards [N].
        antenna, touch: (n, antennas) rotation from rest [rad], and contact force on each [N].
        obstacle_force: (n, obstacles) on each wall, then each cylinder of the arena [N].
        stopped: reason of an early end, "" without one.
    """

    robot: Robot
    settings: Settings
    arena: Arena | None
    time: base.Floats
    x: base.Floats
    y: base.Floats
    z: base.Floats
    yaw: base.Floats
    pitch: base.Floats
    roll: base.Floats
    command: base.Floats
    stroke: base.Floats
    travel: base.Floats
    foot_height: base.Floats
    foot_force: base.Floats
    foot_speed: base.Floats
    support_force: base.Floats
    actuator_force: base.Floats
    antenna: base.Floats
    touch: base.Floats
    obstacle_force: base.Floats
    stopped: str
    _samples: RunSamples = field(repr=False)
    # Computed on first access.
    _kept: "list[GaitComparison]" = field(
        default_factory=list, init=False, repr=False, compare=False
    )

    @property
    def positions(self) -> base.Floats:
        """(n, nq) of the joints of its model, in MuJoCo's order and units."""
        return self._samples.positions

    @property
    def duration(self) -> float:
        """Time from the start of the first cycle to the last sample [s]."""
        return max(0.0, float(self.time[-1])) if len(self.time) else 0.0

    @property
    def cycles(self) -> int:
        """Number of whole cycles."""
        if len(self.time) == 0:
            return 0
        # A whole number of steps may end up to half a step early.
        last = (self._end + 0.51 * self.settings.time_step) / self.robot.drive.period
        return max(0, int(last) - self._first)

    @property
    def starts(self) -> base.Floats:
        """(cycles + 1,) start of each whole cycle, and end of the last [s]; empty without one."""
        if not self.cycles:
            return np.empty(0)
        return self.robot.drive.period * (self._first + np.arange(self.cycles + 1.0))

    @property
    def gaits(self) -> dict[str, tuple[str, ...]]:
        """For each leg the sequence of states of each cycle.

        A cell within a fifth of its travel from a stop counts as at the stop.
        """
        return {
            leg.name: tuple(self.gait(leg.name, cycle) for cycle in range(self.cycles))
            for leg in self.robot.legs
        }

    def gait(self, leg: str, cycle: int) -> str:
        """The states of one leg in a cycle, as "00>10>11>01>00"; `ValueError` for no such cycle."""
        if not 0 <= cycle < self.cycles:
            raise base.InputError(f"cycle = {cycle}: must be from 0 to {self.cycles - 1}.")
        begin, end = np.searchsorted(self.time, self.starts[cycle : cycle + 2] - 1e-9)
        return gait(self._share(leg)[begin : end + 1])

    def state(self, leg: str, time: float) -> str | None:
        """State of one leg at a time [s], as "01"; None while a cell is in transit.

        A `ValueError` refuses an unknown leg, and a walk without samples.
        """
        if len(self.time) == 0:
            raise base.InputError(f"time = {time:g} s: the walk has no samples. {self.stopped}")
        sample = min(int(np.searchsorted(self.time, time)), len(self.time) - 1)
        return states(self._share(leg)[sample : sample + 1])[0]

    @property
    def advance(self) -> base.Floats:
        """(cycles,) displacement along the heading at each cycle's start, over u_max [1].

        u_max is the largest step that the legs can make: the travel of their stepping cells.
        """
        return self._displacement()[0]

    @property
    def sideways(self) -> base.Floats:
        """(cycles,) displacement to the left of that heading, over u_max [1]."""
        return self._displacement()[1]

    @property
    def turn(self) -> base.Floats:
        """(cycles,) rotation to the left [rad]."""
        return np.diff(self._at_starts(self.yaw))

    @property
    def work(self) -> float:
        """Work of the actuator [J], both ways."""
        return float(np.trapezoid(self.actuator_force, self.stroke))

    @property
    def distance(self) -> float:
        """Straight distance from start to end [m]."""
        return float(np.hypot(self.x[-1:] - self.x[:1], self.y[-1:] - self.y[:1]).sum())

    @property
    def cost_of_transport(self) -> float:
        """Cost of transport: work over weight and distance [1]; infinite without advance."""
        carried = self.robot.weight * self.distance
        return self.work / carried if carried > 0 else float("inf")

    @property
    def slip(self) -> base.Floats:
        """(legs,) sliding distance of each foot in stance, per cycle [m]."""
        loaded = self.foot_force > LOADED
        slid = np.trapezoid(np.where(loaded, self.foot_speed, 0.0), self.time, axis=0)
        return slid / max(self.cycles, 1)

    @property
    def comparison(self) -> "GaitComparison":
        """Comparison of the last cycle with the predicted gait, see `compare_gaits`.

        Computed on first access, in about the time of a prediction.
        """
        from stepwell.simulation.comparison import compare_gaits

        if not self._kept:
            self._kept.append(compare_gaits(self))
        return self._kept[0]

    def to_xarray(self) -> "xr.Dataset":
        """The samples as an xarray data set, with units."""
        base.need("tables")
        import xarray as xr

        about = {"units": "s", "long_name": "time from the start of the first cycle"}
        coordinates = {
            "time": ("time", self.time, about),
            "leg": [leg.name for leg in self.robot.legs],
            "support": np.arange(1, self.support_force.shape[1] + 1),
            "antennas": np.array([antenna.name for antenna in self.robot.antennas], dtype=str),
        }
        attributes = {
            "title": self.robot.title,
            "stepwell": base.__version__,
            "stopped": self.stopped,
            "time_step_s": self.settings.time_step,
            "integrator": str(self.settings.integrator),
            "linkage": str(self.settings.linkage),
        }
        return xr.Dataset(base.variables(SAMPLES, self, "time"), coordinates, attributes)

    def to_netcdf(self, path: str | os.PathLike[str]) -> None:
        """Write the samples as NetCDF, atomically; raises `OSError` on failure."""
        data = self.to_xarray()
        # Readers of NetCDF 3 fail on a dimension of length 0, which they take for an unlimited
        # one: a robot without antennas, an arena without obstacles.
        empty = [name for name, size in data.sizes.items() if not size and name != "time"]
        base.write_netcdf(path, data.drop_dims(empty))

    def _share(self, name: str) -> base.Floats:
        """(n, cells) travel of each cell of a leg over its full travel [1]."""
        leg = self.robot.leg(name)
        full = leg.chain.full_travels
        return self.travel[:, self.robot.legs.index(leg), : len(full)] / np.array(full)

    @property
    def _first(self) -> int:
        """Number of the first whole cycle; a walk that continues another one begins late."""
        late = self.time[0] - self.settings.sample
        return max(0, int(np.ceil(late / self.robot.drive.period - 1e-9)))

    @property
    def _end(self) -> float:
        """Time at the end of the run [s]; the last sample may be earlier."""
        return float(self.time[-1]) if self.stopped else self._samples.end

    def _at_starts(self, values: base.Floats) -> base.Floats:
        """Values (cycles + 1,) at the start of every cycle and the end of the last, from (n,)."""
        return np.interp(self.starts, self.time, values) if self.cycles else np.empty(0)

    def _displacement(self) -> tuple[base.Floats, base.Floats]:
        dx, dy = np.diff(self._at_starts(self.x)), np.diff(self._at_starts(self.y))
        yaw = self._at_starts(self.yaw)[:-1]
        most = self.robot.u_max
        along = dx * np.cos(yaw) + dy * np.sin(yaw)
        across = dy * np.cos(yaw) - dx * np.sin(yaw)
        return along / most, across / most

    def __repr__(self):
        title = f"{self.robot.title!r}, " if self.robot.title else ""
        if not self.cycles:
            return f"Walk({title}no whole cycle{'; ' + self.stopped if self.stopped else ''})"
        late = slice(min(1, self.cycles - 1), None)
        return (
            f"Walk({title}{self.cycles} cycles, d/u_max {self.advance[late].mean():z.2f}, "
            f"turn {np.degrees(self.turn[late].mean()):z.1f}° per cycle"
            f"{'; ' + self.stopped if self.stopped else ''})"
        )


def walk(
    robot: Robot,
    cycles: float = 8,
    *,
    arena: Arena | None = None,
    settings: Settings | None = None,
    start: Walk | None = None,
    progress: Callable[[float, float], None] | None = None,
    look: Callable[[Callable[[], Walk]], None] | None = None,
) -> Walk:
    """Simulate a walk, driven by loading and unloading of the actuator.

    `look` is called after every half second of the run with a function that returns the walk so
    far. All else as for `Robot.walk`.
    """
    if not cycles > 0:
        raise base.InputError(f"cycles = {cycles}: must be > 0.")
    if start is not None and start.stopped:
        raise base.InputError(f"start: the earlier walk ended early. {start.stopped}")
    samples = None if start is None else start._samples
    run = SimulatedRun(robot, arena, settings or Settings(), start=samples)
    begin, end = run.now, max(run.now, 0.0) + cycles * robot.drive.period
    for now in run.chunks(end):
        base.notify(progress, now - begin, end - begin)
        if look is not None:
            look(lambda: recorded(run))
    return recorded(run)


def recorded(run: SimulatedRun) -> Walk:
    """The walk of a run, from its readings."""
    robot, arena, samples = run.robot, run.arena, run.samples()
    data, where = samples.data, samples.where

    def read(*names: str) -> base.Floats:
        chosen = [data[:, where[name]] for name in names]
        return np.concatenate(chosen, axis=1) if chosen else np.empty((len(data), 0))

    pose = [*read("body.position").T, *_angles(read("body.attitude"))]
    legs, antennas = robot.legs, robot.antennas
    travel = np.full((len(data), len(legs), max(len(leg.chain) for leg in legs)), np.nan)
    for i, leg in enumerate(legs):
        names = (f"{leg.name}.{cell}.travel" for cell in leg.chain.names)
        travel[:, i, : len(leg.chain)] = read(*names)
    tips = [read(f"{leg.name}.tip.position") for leg in legs]
    speeds = [read(f"{leg.name}.tip.velocity") for leg in legs]
    return Walk(
        robot,
        run.settings,
        arena,
        samples.time,
        *pose,
        command=robot.drive.stroke(samples.time),
        stroke=read("stroke")[:, 0],
        travel=travel,
        foot_height=np.stack([tip[:, 2] for tip in tips], axis=1),
        foot_force=read(*(f"{leg.name}.sole" for leg in legs)),
        foot_speed=np.stack([np.hypot(speed[:, 0], speed[:, 1]) for speed in speeds], axis=1),
        support_force=read(*(f"support {i + 1}" for i in range(len(robot.body.supports)))),
        actuator_force=read("drive")[:, 0],
        antenna=read(*(f"{antenna.name}.antenna" for antenna in antennas)),
        touch=read(*(f"{antenna.name}.feeler" for antenna in antennas)),
        obstacle_force=read(*(obstacle_names(arena) if arena is not None else ())),
        stopped=samples.stopped,
        _samples=samples,
    )


def _angles(attitude: base.Floats) -> tuple[base.Floats, base.Floats, base.Floats]:
    """Yaw, pitch and roll [rad] from (n, 4) quaternions."""
    w, x, y, z = attitude.T
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y**2 + z**2))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x**2 + y**2))
    return np.unwrap(yaw), pitch, roll
