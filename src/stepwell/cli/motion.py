"""`stepwell run`, `map`, `graph`, `program` and `animate`: quasi-static behaviour of a chain."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import stepwell as sw
from stepwell.cli import options, screen
from stepwell.cli.driving import Drive, From, Target, drive_of, planned, program_in_file
from stepwell.cli.options import flag, option
from stepwell.cli.ranges import EXAMPLE, Range, grid, parameter_range

if TYPE_CHECKING:
    from stepwell.base import Floats
    from stepwell.design import Run
    from stepwell.mechanism import Chain
    from stepwell.proof import ProvedRun
    from stepwell.sequences import Cycle, Program, Realisation


def run(
    design: options.Design,
    mobility_ratio: options.MobilityRatio = None,
    prove: options.Prove = False,
    *,
    output: options.Output,
) -> None:
    """Compute a full cycle: sequence, snaps, forces, dissipated energy, margin.

    The margin is the smallest change that leads to another sequence. Snaps are checked for landings
    that depend on the mobilities of the cells.
    With --out, figures, the path as CSV, the result as JSON and an HTML report are written into a
    folder, together with the design.

    Example: stepwell run preset:paper-forward
    """
    from stepwell.design import Run, margin

    text, chain = options.read_chain(design)
    output.check_output_folder("run", design=text)
    with screen.progress("following") as tell:
        path = (cycle := chain.cycle(progress=tell)).path
    with screen.usable("--mobility-ratio"), screen.progress("landings"):
        asked = mobility_ratio is not None
        landings = path.landings(mobility_ratio) if asked else path.checked_landings
    with screen.progress("margin") as tell:
        result = Run(cycle, margin(chain, progress=tell), landings)
    if prove:
        result = _proved(result, mobility_ratio)
    output.report(result, text, design)


def _proved(result: Run, mobility_ratio: float | None) -> ProvedRun:
    """A run with the proof of its cycle."""
    from stepwell.proof import ProvedRun

    with screen.usable("--prove"), screen.progress("proof") as tell:
        ratio = 1.0 if mobility_ratio is None else mobility_ratio
        return ProvedRun.proved(
            result, result.cycle.path.prove(mobility_ratio=ratio, progress=tell)
        )


def graph(
    design: options.Design,
    drive: Drive = None,
    start: str | None = option(
        "Start state, such as 000: restrict the graph to states reachable from it; all states by "
        "default.",
        "--from STATE",
    ),
    out: Path | None = option(
        "Write this file: .svg, .png or .pdf (figure), .graphml, .dot or .json (graph).",
        "--out -o FILE",
        dir_okay=False,
        callback=options.local,
    ),
    force: options.Force = False,
    *,
    display: options.Display,
) -> None:
    """Compute the transition graph of a chain with one actuator.

    The result contains main loop and sub-loops, Garden-of-Eden states, return-point memory,
    scrambling, accumulators, latches and unreachable states. With --out, the graph is plotted, or
    exported for other programs. If the graph has too many states for a list, its states are
    counted, and followed from all cells at 0 or from the state of --from.

    Example: stepwell graph preset:three-wave
    """
    text, chain = options.read_chain(design)
    options.free_file(out, force)
    if out is not None:
        with screen.usable("--out"):
            sw.reports.checked_suffix(out)
    with screen.usable(design), screen.progress("graph") as tell:
        implicit = chain.implicit_graph(drive_of(drive, chain))
        if out is None and not implicit.is_listable and (start is None or implicit.by_fields):
            result = implicit.walked(start, progress=tell)
        else:
            result = chain.graph(drive_of(drive, chain), start=start, progress=tell)
        reported = sw.accounts.account(result, sw.accounts.About(text, design))
    if out is None:
        display.report(reported)
        return
    with screen.usable("--out"), screen.progress(screen.WRITING):
        sw.reports.write_graph(result, out)  # type: ignore[arg-type]
    if display.as_json:
        screen.show_json(reported.record, out)
        return
    display.report(reported)
    screen.show_lines("")
    screen.show_verbatim(f"Wrote {out}")


def program(
    design: options.Design,
    start: From = None,
    target: Target = None,
    robust: options.Robust = None,
    machine: str | None = option(
        "State machine or regular language (TOML), or one of the package, such as second-touch: "
        "search turning points of its inputs instead.",
        "--machine FILE|NAME",
        autocompletion=options.machines,
    ),
    *,
    output: options.Output,
) -> None:
    """Search the fewest turning points from one state to another.

    Each turning point has a tolerance interval. If no program reaches the target, the result is the
    proof. Without --target, the program of the design file is simulated and checked against its own
    target state. With --robust, the landing of every snap must be independent of the mobilities.
    With --out, a figure, the turning points as CSV, the result as JSON and the design with the
    program are written into a folder. With --machine, the chain is searched for strokes that behave
    as a state machine, and the result is the table of what every input does.

    Example: stepwell program preset:paper-forward --target 01
    """
    text, chain = options.read_chain(design)
    output.check_output_folder("program")
    try:
        if machine is not None:
            if start or target or robust:
                raise screen.wrong(
                    "--machine", "cannot be combined with --from, --target or --robust."
                )
            result = realised(chain, machine)
        elif start or target:
            result = planned(chain, start, target, robust)
        else:
            result = replace(program_in_file(sw.files.loads(text, design)), robust=robust)
    except sw.Unreachable as why:
        result, output = why, replace(output, out=None)
    record = output.report(result, text, design).record
    screen.answered(record.get("meets_target", True))


def realised(chain: sw.Chain, machine: str) -> Realisation:
    """The realisation of the machine in a file; raises `Unreachable` if there is none."""
    from stepwell.sequences import realise

    with screen.usable("--machine", sw.Unreachable):
        return realise(chain, sw.files.load_machine(machine))


class MotionOptions(options.Group):
    """The motion of a design that is animated."""

    program: bool = flag(
        "Program of the design: animate it, or one planned to --target, instead of a full cycle.",
        "--program",
    )
    start: From = None
    target: Target = None

    def of(self, design: str) -> Cycle | Program:
        """This motion of a design file."""
        if not self.program:
            if self.start or self.target:
                option = "--target" if self.target else "--from"
                raise screen.wrong(option, "needs --program.")
            with screen.progress("following") as tell:
                return sw.files.load(design).chain.cycle(progress=tell)
        if self.start or self.target:
            return planned(sw.files.load(design).chain, self.start, self.target)
        return program_in_file(sw.files.load(design))


def animate(
    design: options.Design,
    out: Path = option(
        "Write this file (.gif).",
        "--out -o FILE",
        default=Path("cycle.gif"),
        callback=options.local,
    ),
    seconds: float = option("Duration of one cycle [s].", "S", default=8.0, min=0.5),
    fps: float = option("Frames per second.", "HZ", default=20.0, min=1, max=50),
    *,
    motion: MotionOptions,
    force: options.Force = False,
) -> None:
    """Write an animation of a design as a GIF.

    It shows the mechanism, and the energy landscape of two cells or the force of more cells.

    Example: stepwell animate preset:paper-forward --out leg.gif
    """
    options.free_file(out, force)
    result = motion.of(design)
    with screen.usable(), screen.progress("frames") as tell:
        sw.figures.animation(result, out, seconds=seconds, fps=fps, progress=tell)
    screen.show_verbatim(f"Wrote {out}")


CELL, ACROSS, UP = "outer", Range(0, 20, 200), Range(-15, 15, 200)


def _axis_of(axis: str, usual: Range) -> Any:
    text = f"Anchor positions: grid along {axis} [mm]."
    return option(text, "FROM:TO:COUNT", default=usual, parser=grid)


def _parameter_on(axis: str) -> Any:
    text = (
        f"Parameter on the {axis} axis instead of the anchor [mm, deg, N or N/m], as in {EXAMPLE}."
    )
    return option(text, "NAME=FROM:TO:COUNT", parser=parameter_range)


class PlaneOptions(options.Group):
    """The axes of a map: the position of an anchor, or two parameters."""

    cell: str = option(
        "Cell whose anchor q is varied: its name, inner, outer, or its number from 1 (innermost).",
        "CELL",
        default=CELL,
    )
    x: Range = _axis_of("x", ACROSS)
    y: Range = _axis_of("y", UP)
    across: Range | None = _parameter_on("horizontal")
    up: Range | None = _parameter_on("vertical")

    def parameters(self) -> tuple[Range, Range] | None:
        """The two parameters; None if the position of an anchor is varied."""
        if self.across is None and self.up is None:
            return None
        if self.across is None or self.up is None:
            names = ("--across", "--up") if self.across is None else ("--up", "--across")
            raise screen.wrong(names[1], f"needs {names[0]} NAME=FROM:TO:COUNT too.")
        if (self.cell, self.x, self.y) != (CELL, ACROSS, UP):
            raise screen.wrong("--across", "cannot be combined with --cell, --x or --y.")
        return self.across, self.up


def map_(design: options.Design, plane: PlaneOptions, output: options.Output) -> None:
    """Compute the design map over an anchor, or over two parameters.

    The map contains the sequence for every position of one anchor, and the exact boundaries between
    sequences; with --across and --up, for all values of two parameters of the chain. With
    --out, the figure, its data as NetCDF and the boundaries as CSV are written into a folder.

    Example: stepwell map preset:paper-forward --out map
    """
    import stepwell.design as maps

    text, chain = options.read_chain(design)
    output.check_output_folder("map")
    with screen.usable(design):
        both = plane.parameters()
        if both is None:
            index = cell_of(chain, plane.cell)
            designs = marks(chain, index)
            places = {"x": plane.x.values(1e3), "y": plane.y.values(1e3)}
            nodes = partial(maps.transition_map, chain, index, **places)
            curves = partial(maps.boundaries, chain, index, **places)
        else:
            (across, here_across), (up, here_up) = (_axis(one, chain) for one in both)
            nodes = partial(maps.parameter_map, chain, across, up)
            curves = partial(maps.parameter_boundaries, chain, across, up)
            designs = {"this design": (here_across, here_up)}
        with screen.progress("map") as tell:
            dataset = nodes(progress=tell)
        with screen.progress("boundaries") as tell:
            lines = curves(progress=tell)
        output.report(maps.MapView(dataset, lines, designs), text, design)


def _axis(given: Range, chain: Chain) -> tuple[tuple[str, Floats], float]:
    """Name and values of a parameter in SI, and its value in the chain."""
    from stepwell.design import parameter

    one = parameter(chain, given.name)
    values = one.values(given.values(sw.base.display_unit(one.unit)[1]), 2)
    here = one.value(chain)
    assert not isinstance(here, tuple)
    return (given.name, values), here


def cell_of(chain: Chain, text: str) -> int:
    """Index of the cell with a name, inner, outer or a number from 1."""
    names = chain.names
    if names.count(text) == 1:
        return names.index(text)
    ends = {"inner": 0, "outer": len(chain) - 1}
    if text in ends and text not in names:
        return ends[text]
    if text.isdecimal() and text.isascii() and 1 <= int(text) <= len(chain) and text not in names:
        return int(text) - 1
    known = ", ".join(f"{name} ({number})" for number, name in enumerate(names[:12], 1))
    raise screen.wrong("--cell", f"{text!r}: must be one of {known}.")


def marks(chain: Chain, cell: int) -> dict[str, tuple[float, float]]:
    """Position of the design itself on its map [m]; empty if the bands of the cell differ in q."""
    subject = chain.cells[cell]
    if isinstance(subject, sw.Element):
        raise screen.wrong(
            "--cell",
            f"{chain.names[cell]} is an element and has no anchor: pass --across "
            f"NAME=FROM:TO:COUNT and --up NAME=FROM:TO:COUNT.",
        )
    anchors = {band.q for band in subject.bands}
    return {"this design": anchors.pop()} if len(anchors) == 1 else {}
