"""A build: layout, sweep, limits, mass and yield of a chain made of one material."""

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from stepwell import base, sequences
from stepwell.build.build_file import BuildFile, load_build_file
from stepwell.build.freeing import collision_findings
from stepwell.build.layouts import Layout, layout as lay
from stepwell.build.limits import ExceededLimit, findings
from stepwell.build.loads import band_range
from stepwell.build.part import Part
from stepwell.build.plates import STEEL
from stepwell.build.sweeps import MotionSweep, sweep
from stepwell.build.tolerances import build_yield
from stepwell.design import Yield
from stepwell.mechanism import Cell, Chain
from stepwell.robot import Hopper, Robot
from stepwell.sequences import Cycle
from stepwell.statics import StaticsError

if TYPE_CHECKING:
    from stepwell.build.robots.hopper_parts import HopperParts
    from stepwell.build.robots.robot_builds import RobotBuild

# Samples of the yield of a build: each is followed by the engine if end forces do not decide.
SAMPLES = 2000


@dataclass(frozen=True, slots=True, eq=False)
class BandUse(base.ByValue):
    """A band of a build, for a parts list.

    Attributes:
        cell, number: of the cell and of the band in it, from 0.
        holes: names of the holes of its hooks, inner block first.
        rest_length, shortest, longest: free length, least and largest length in motion [m].
        lengths: length in state 0 and in state 1 of its cell [m].
        tensions: tension in state 0 and in state 1 [N].
        stretch: largest length over free length [1].
        shift: vector added to both anchors in the frame of the cell [m]; the motion is the same.
        fits: free lengths of the pack within the tolerance of its rest length [m].
    """

    cell: int
    number: int
    holes: tuple[str, str]
    rest_length: float
    shortest: float
    longest: float
    lengths: tuple[float, float]
    tensions: tuple[float, float]
    stretch: float
    shift: base.Vec2
    fits: tuple[float, ...]


@dataclass(frozen=True, eq=False, repr=False)
class Build(base.ByValue, base.Drawn):
    """The solid parts of a chain, whether they move free of each other, and what limits them.

    Attributes:
        chain, build_file: the design, and the sizes and material.
        layout: parts, fasteners and bands with their places.
        sweep: collisions and clearances over all angles of all cells.
        findings: exceeded limits, collisions first; empty if it can be built.
        cycle: a full cycle of the design; None if it cannot be followed.
        yield_: the fraction of builds with the errors of the build file that keep the sequence;
            None without a cycle or a sweep free of collisions.
        of_hopper: parts besides the chain, if it is built for a hopper.
    """

    chain: Chain
    build_file: BuildFile
    layout: Layout
    sweep: MotionSweep
    findings: tuple[ExceededLimit, ...]
    cycle: Cycle | None
    yield_: Yield | None
    of_hopper: "HopperParts | None" = None

    def __repr__(self):
        verdict = "can be built" if self.can_be_built else f"{len(self.findings)} findings"
        return f"Build({self.layout!r}, {self.build_file.sheet.material}, {verdict})"

    @property
    def can_be_built(self) -> bool:
        """Whether its parts move free of each other and no limit is exceeded."""
        return self.sweep.free and not self.findings

    @property
    def parts(self) -> tuple[Part, ...]:
        """All cut parts: of the chain, then the plates of a hopper."""
        return (*self.layout.parts, *(self.of_hopper.plates if self.of_hopper else ()))

    @cached_property
    def mass(self) -> float:
        """Mass of all cut parts [kg], without fasteners."""
        return sum(part.mass(self.build_file.sheet.density) for part in self.parts)

    @cached_property
    def fastener_mass(self) -> float:
        """Mass of pins, hooks, screws, nuts and shims as steel cylinders [kg]."""
        volume = sum(
            np.pi / 4.0 * one.diameter**2 * (one.high - one.low)
            for one in self.layout.fasteners
            if one.use != "cap"
        )
        return float(volume) * STEEL

    @cached_property
    def block_masses(self) -> tuple[float, ...]:
        """Mass of the cut parts of each block [kg], the fixed one first; levers are not in it."""
        masses = [0.0] * len(self.layout.blocks)
        for part in self.layout.parts:
            kind, *number = self.layout.body[part.name]
            if kind == "block":
                masses[int(number[0])] += part.mass(self.build_file.sheet.density)
        return tuple(masses)

    @cached_property
    def bands(self) -> tuple[BandUse, ...]:
        """The bands with their hooks, lengths and tensions."""
        return tuple(self._band(index) for index in range(len(self.layout.bands)))

    def _band(self, index: int) -> BandUse:
        path = self.layout.bands[index]
        return band_use(self.layout.cells[path.cell].cell, path, self.build_file)

    def band_cell(self, one: BandUse) -> Cell:
        """The cell of a band."""
        return self.layout.cells[one.cell].cell

    def band_words(self, one: BandUse) -> tuple[str, str, str]:
        """Name of a band's cell, and of its two hooks."""
        inner, outer = one.holes
        return str(one.cell + 1), f"{inner} of block {one.cell}", f"{outer} of block {one.cell + 1}"

    @property
    def title(self) -> str:
        """Of the design."""
        return self.chain.title or "Chain"

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader has to know of this build, a sentence each."""
        notes: list[str] = []
        for one in self.bands:
            name = f"Band {one.number + 1} of cell {one.cell + 1}"
            if one.shift != (0.0, 0.0):
                dx, dy = (f"{base.to_unit(part, 'mm'):.4g}" for part in one.shift)
                notes.append(
                    f"{name}: both anchors are shifted by ({dx}, {dy}) mm to clear pins and edges; "
                    f"q - p and the motion stay the same."
                )
            if not one.fits:
                packs = ", ".join(
                    f"{base.to_unit(length, 'mm'):.4g}"
                    for length in self.build_file.band.free_lengths
                )
                notes.append(
                    f"{name}: no band of the pack ({packs} mm) has its rest length of "
                    f"{base.to_unit(one.rest_length, 'mm'):.4g} mm."
                )
        loaded = [
            n
            for n, one in zip(self.chain.names, self.layout.cells, strict=True)
            if one.cell.load is not None
        ]
        if loaded:
            notes.append(f"The load of {', '.join(loaded)} is no part of the build: attach it.")
        return (*notes, *(self.of_hopper.notes if self.of_hopper else ()))


def band_use(cell: Cell, path: Any, build_file: BuildFile) -> BandUse:
    """A band of a cell for a parts list; `path` has its `cell`, `number`, `holes` and `shift`."""
    band, reach = cell.bands[path.number], band_range(cell, path.number)
    ends = band.length(np.array([-cell.limit, cell.limit]), cell.lever)
    rest = band.rest_length
    first, last = (float(one) for one in band.tension(ends))
    within = max(build_file.tolerance.rest_length * rest, 1e-5)
    return BandUse(
        cell=path.cell,
        number=path.number,
        holes=path.holes,
        rest_length=rest,
        shortest=reach.shortest,
        longest=reach.longest,
        lengths=(float(ends[0]), float(ends[1])),
        tensions=(first, last),
        stretch=reach.longest / rest if rest > 0.0 else np.inf,
        shift=path.shift,
        fits=tuple(one for one in build_file.band.free_lengths if abs(one - rest) <= within),
    )


@overload
def build(
    mechanism: Robot,
    material: str | os.PathLike[str] | BuildFile = "acrylic-3mm",
    *,
    progress: base.Progress = None,
    swept: MotionSweep | None = None,
) -> "RobotBuild": ...


@overload
def build(
    mechanism: Chain | Hopper,
    material: str | os.PathLike[str] | BuildFile = "acrylic-3mm",
    *,
    samples: int = SAMPLES,
    target: str | Iterable[str] | None = None,
    progress: base.Progress = None,
    swept: MotionSweep | None = None,
) -> Build: ...


def build(
    mechanism: Chain | Hopper | Robot,
    material: str | os.PathLike[str] | BuildFile = "acrylic-3mm",
    *,
    samples: int = SAMPLES,
    target: str | Iterable[str] | None = None,
    progress: base.Progress = None,
    swept: MotionSweep | None = None,
) -> "Build | RobotBuild":
    """The solid parts of a chain of lever cells, of a hopper, or of a robot, in layers.

    Args:
        mechanism: a chain of 1 to 8 lever cells; a hopper, of which one of the equal chains, the
            frame, the foot bar and the sole are built; or a robot of two legs with two cells each.
        material: a preset such as "acrylic-3mm", a build file, or its value.
        samples: number of samples of the yield, of a chain.
        target: sequence or states that count as success; by default the sequence of the design.
        progress: called with (done, total) pairs of parts of the sweep.
        swept: the sweep of this chain and material, if it is known.

    Returns:
        The build; its `findings` contain collisions and exceeded limits, each with a way out.

    Raises:
        ValueError: an element, more than 8 cells, or levers too short for any plate.
        DesignError: an invalid build file.
        ExtraError: the packages of the extra `build` are missing.
    """
    base.need("build")
    build_file = material if isinstance(material, BuildFile) else load_build_file(material)
    if isinstance(mechanism, Robot):
        from stepwell.build.robots.robot_builds import build_robot

        return build_robot(mechanism, build_file, progress=progress, swept=swept)
    chain = mechanism.chain if isinstance(mechanism, Hopper) else mechanism
    layout = lay(chain, build_file)
    swept = swept or sweep(layout, progress)
    try:
        cycle: Cycle | None = sequences.cycle(chain)
        path = cycle.path
    except StaticsError:
        cycle = path = None
    found = (*collision_findings(layout, swept), *findings(layout, path))
    sampled = None
    if swept.free and (cycle is not None or target is not None):
        sampled = build_yield(layout, samples=samples, target=target)
    made = Build(chain, build_file, layout, swept, found, cycle, sampled)
    if not isinstance(mechanism, Hopper):
        return made
    from stepwell.build.robots.hopper_parts import hopper_parts, plate_findings

    others = hopper_parts(made, mechanism)
    found = (*found, *plate_findings(others, build_file))
    return replace(made, of_hopper=others, findings=found)
