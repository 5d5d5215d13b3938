"""`stepwell sweep`: parameter studies, written to a store from which they can be resumed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

import stepwell as sw
from stepwell.base import Measure
from stepwell.cli import options as opts, screen, tolerances as parts
from stepwell.cli.driving import From
from stepwell.cli.options import Design, Display, Folder, Group
from stepwell.cli.ranges import length, read_range

commands = screen.subcommands("Compute a parameter study in parallel; it can be resumed.")

_Partial = Annotated[
    bool, typer.Option("--partial", help="Skip missing designs instead of failing.")
]
_Store = Annotated[
    Path, typer.Argument(metavar="STORE", help="Path of the study: the value given to --out.")
]

_Engine = Annotated[
    str,
    typer.Option(
        metavar="ENGINE",
        help="cpu: compute every design on the CPU. warp: evaluate all designs on a GPU in single "
        "precision, then recompute on the CPU all designs that behave like the reference design, "
        "all undecided ones, and a random 10 %.",
    ),
]


class _Program(Group):
    start: From = None
    target: str = opts.option(
        "Target: the state to end in, such as 01.", "--target TARGET", default=...
    )


class _Walk(Group):
    cycles: int = opts.option(opts.CYCLES, "N", default=4, min=1)
    engine: _Engine = "cpu"


class _Maze(Group):
    arena: str = opts.option(opts.ARENA_HELP, "ARENA", default=..., autocompletion=opts.arenas)
    limit: float = opts.option(opts.TIME_LIMIT, "S", default=600.0, min=1)
    layouts: int = opts.option(
        "Number of random layouts, with walls and start shifted; the same for every design. 0: the "
        "arena itself.",
        "N",
        default=0,
        min=0,
    )
    first: int = opts.option(
        "Number of the first layout. For an independent test of a design that was selected with "
        "some layouts, use others.",
        "N",
        default=0,
        min=0,
    )
    place: float | None = opts.option(
        "Maximum shift of each wall in a layout [mm]; 40 by default.", "LENGTH", parser=length()
    )
    angle: float | None = opts.option(
        "Maximum rotation of each wall in a layout [deg]; 8 by default.", "DEG", min=0
    )
    engine: _Engine = "cpu"


class _Call(Group):
    function: str = opts.option(
        "Function of a design and a seed that returns numbers and texts by name.",
        "FILE.py:NAME",
        default=...,
    )


class Effort(Group):
    """The processes that compute a study."""

    workers: int | None = opts.option(
        "Number of worker processes; one per core by default, 0 for none.", "N", min=0
    )
    scheduler: str | None = opts.option(
        "Dask scheduler to use instead of local processes, such as tcp://10.0.0.1:8786.", "ADDRESS"
    )


class _Study(Effort):
    seed: parts.Seed = 0
    chunk: int | None = opts.option("Number of designs per chunk of the store.", "N", min=1)
    estimate: bool = opts.flag(
        "Print the estimated run time and disk space, then exit.", "--estimate"
    )


class _Drawn(Group):
    vary: list[str] | None = opts.option(
        "Parameter to vary, such as outer.q.x=0:20:41 or 1.stiffness=20:40:9, in the units of "
        "`stepwell map`, or a key of a robot such as foot.below_mm. Append :log for equal ratios; "
        "omit COUNT with --sobol, --latin or --random. May be repeated.",
        "--vary NAME=FROM:TO:COUNT",
    )
    table: Path | None = opts.option("List of designs: one row of a CSV file per design.", "FILE")
    sobol: int | None = opts.option("N designs of a scrambled Sobol' sequence.", "N", min=1)
    latin: int | None = opts.option("N designs of a Latin hypercube.", "N", min=1)
    random: int | None = opts.option("N independent random designs.", "N", min=1)

    monte_carlo = None  # an option of chains

    def of(self, subject: Any, seed: int) -> sw.studies.Designs:
        """The designs of the study."""
        ways = ("table", "sobol", "latin", "random", "monte_carlo")
        chosen = [name for name in ways if getattr(self, name) is not None]
        _refuse_two([name.replace("_", "-") for name in chosen], bool(self.vary))
        if self.table is not None:
            with screen.usable("--table"):
                return sw.studies.read_table(self.table, subject)
        if isinstance(self, _Chosen) and self.monte_carlo is not None:
            measure = getattr(subject, "measure", Measure.TRAVEL)
            with screen.usable("--monte-carlo"):
                return sw.studies.Workshop(self.tolerances(measure), self.monte_carlo, seed)
        count = self.sobol or self.latin or self.random or 0
        with screen.usable("--vary"):
            axes = read_axes(self.vary or [], subject, drawn=bool(count))
            how = sw.studies.How(chosen[0] if chosen else "grid")
            return sw.studies.Space(axes, how, count, seed)


class _Sampled(_Drawn):
    """Designs of a chain, or Monte Carlo samples of one chain."""

    monte_carlo: int | None = opts.option(
        "N Monte Carlo samples of the design, within the tolerances given by the options below.",
        "N",
        min=1,
    )


class _Chosen(parts.ToleranceOptions, _Sampled):
    """Designs of a chain, with the tolerances of samples."""


_GRID = "preset:paper-forward --vary outer.q.x=0:20:41"
_FEET = "robot-forward --vary foot.below_mm=0.6:1.0:5"
# Options of single kinds of studies, with an example.
_OWN: dict[str, tuple[type[Group], str]] = {
    "program": (_Program, f"{_GRID} --target 01"),
    "call": (_Call, f"{_GRID} --function mine.py:count"),
    "walk": (_Walk, _FEET),
    "maze": (_Maze, f"{_FEET} --arena three-walls"),
}


def _command(what: str, doc: str) -> None:

    def run(
        *,
        design: Design,
        own: Group,
        out: Path = opts.option(
            "Write the results into this folder, a Zarr store.",
            "--out -o DIR",
            default=...,
            callback=opts.folder,
        ),
        designs: _Drawn,
        how: _Study,
        display: Display,
    ) -> None:
        from stepwell.kernels import cores

        _, subject = opts.read_design(design)
        chosen = designs.of(subject, how.seed)
        with screen.usable(what):
            given = _given(own, subject)
            study = sw.studies.planned_study(
                subject, what, chosen, out, given=given, chunk=how.chunk
            )
        if how.estimate:
            workers = cores() if how.workers is None else max(how.workers, 1)
            _show_estimate(sw.studies.estimate(study, workers))
            return
        with screen.usable(design):
            begun = sw.studies.begun(study)
        _resumed(begun, how, display)

    kind, example = _OWN.get(what, (Group, _GRID))
    run.__annotations__ |= {"own": kind, "designs": _Drawn if kind in (_Walk, _Maze) else _Chosen}
    run.__doc__ = (
        f"{doc}\n\nThe designs are a grid, random, listed, or samples of one design. Results are "
        f"written to a store in chunks. To resume after an interruption, run the same command "
        f"again; the result is identical. If a design fails, its row contains the error message."
        f"\n\nExample: stepwell sweep {what} {example} --out store"
    )
    commands.command(what, epilog=screen.EXIT_CODES)(opts.grouped(run))


for _what, _doc in {
    "cycle": "Compute the full cycle of every design: sequence, snaps, peak force, energy.",
    "margin": "Compute the margin of every design: smallest change of an anchor or a stiffness.",
    "yield": "Compute the yield of every design with the default tolerances.",
    "graph": "Compute the number of reachable states and transitions of every design.",
    "program": "Search the fewest turning points of every design from one state to another.",
    "walk": "Simulate a walk of every robot: advance, turn, work and gaits.",
    "maze": "Simulate every robot in an arena: fraction of layouts in which it reaches the goal.",
    "call": "Compute a function of your own for every design.",
}.items():
    _command(_what, _doc)


@opts.command(commands)
def resume(store: _Store, effort: Effort, display: Display) -> None:
    """Compute the missing designs of a store.

    Example: stepwell sweep resume store
    """
    _resumed(sw.studies.opened(store), effort, display)


@opts.command(commands)
def extend(
    *,
    store: _Store,
    count: int = opts.option("Total number of designs.", "N", default=..., min=1),
    effort: Effort,
    display: Display,
) -> None:
    """Add random designs to a store; existing designs are kept.

    Example: stepwell sweep extend store --count 2048
    """
    with screen.usable("--count"):
        study = sw.studies.extended(sw.studies.opened(store), count)
    _resumed(study, effort, display)


@opts.command(commands)
def cancel(store: _Store) -> None:
    """Stop all workers of a study after their current chunk; finished chunks are kept.

    Example: stepwell sweep cancel store
    """
    sw.studies.cancel(sw.studies.opened(store))
    screen.show_lines(
        f"{store}: stops after the current chunks. To resume: stepwell sweep resume {store}"
    )


@opts.command(commands)
def status(store: _Store, display: Display) -> None:
    """List the progress of a study and its preliminary results.

    Example: stepwell sweep status store
    """
    with screen.progress("status"):
        status = sw.studies.status(store)
    display.report(status)
    if any(gap.damaged for gap in status.gaps):
        raise typer.Exit(screen.FAILED)


@opts.command(commands)
def export(
    *,
    store: _Store,
    out: Path = opts.option(
        "Write this file (.csv or .parquet).",
        "--out -o FILE",
        default=...,
        dir_okay=False,
        callback=opts.local,
    ),
    best: int | None = opts.option(
        "Export the varied parameters of the N best designs, best first: input for --table of "
        "another study.",
        "N",
        min=1,
    ),
    by: list[str] | None = opts.option(
        "Column to rank designs by: largest value first, or smallest with - before the name. May "
        "be repeated to break ties.",
        "--rank-by COLUMN",
    ),
    partial: _Partial = False,
) -> None:
    """Export the designs of a store as a table with units.

    Example: stepwell sweep export store --out table.csv
    """
    if bool(best) != bool(by):
        raise screen.wrong("--best, --rank-by", "must both be given, or neither.")
    if out.suffix not in ((".csv",) if best else (".csv", ".parquet")):
        ends = ".csv" if best else ".csv or .parquet"
        raise screen.wrong("--out", f"{out}: must end in {ends}.")
    study = sw.studies.opened(store)
    if best and by:
        with screen.usable("--rank-by"):
            table = study.best(best, by, partial=partial)
        table.to_csv(out, study.subject)
        screen.show_lines(f"Written into {out}: the best {table.count} of {study.count} designs.")
        return
    write = study.to_parquet if out.suffix == ".parquet" else study.to_csv
    with screen.progress(screen.WRITING):
        count = write(out, partial=partial)
    of = "" if count == study.count else f" of {study.count}"
    screen.show_lines(f"Written into {out}: {count}{of} designs.")


@opts.command(commands)
def report(store: _Store, partial: _Partial = False, *, output: Folder) -> None:
    """Plot the results of a study as an HTML report, and compute the most influential parameter.

    Example: stepwell sweep report store --out report
    """
    output.check_output_folder("sweep report")
    with screen.progress("status"):
        status = sw.studies.status(store)
    if not partial:
        status.study.require_whole()
    output.report(status, how={"partial": partial})


def _resumed(study: sw.studies.Study, effort: Effort, display: Display) -> None:
    if study.work.screen and effort.scheduler is None and not sw.simulation.device()[1]:
        slow = "No GPU available: Warp runs on the CPU, where --engine cpu is much faster."
        screen.warn(slow)
    kinds, begun, where = Counter[str](), sw.studies.begun(study), effort.scheduler
    with going_on(study.folder, where, lambda: _so_far(kinds)) as tell:
        status = sw.studies.resumed(
            begun, effort.workers, scheduler=where, progress=tell, problems=kinds.update
        )
    display.report(status)


def _so_far(kinds: Counter[str]) -> str:
    return "".join(f", {count} {kind}" for kind, count in sorted(kinds.items()))


def _refuse_two(chosen: Sequence[str], varied: bool) -> None:
    if len(chosen) > 1:
        raise screen.wrong(f"--{chosen[0]}", f"cannot be combined with --{chosen[1]}.")
    listed = chosen in (["table"], ["monte-carlo"])
    if not varied and not listed:
        raise screen.wrong("--vary", "is needed, or --table, or --monte-carlo.")
    if varied and listed:
        raise screen.wrong(f"--{chosen[0]}", "cannot be combined with --vary.")


def _given(options: Group, subject: Any) -> dict[str, Any]:
    if isinstance(options, _Call):
        with screen.usable("--function"):
            return sw.studies.function_of(options.function, subject)
    own = dict(vars(options))
    if own.get("engine") == "cpu":
        del own["engine"]  # as in stores that were begun when there was no other
    if isinstance(options, _Maze):
        own["arena"] = sw.files.dumps(sw.files.load_arena(options.arena))
        for name, unit in (("place", 1e-3), ("angle", math.pi / 180)):
            value = own.pop(name)
            own |= {} if value is None else {name: value * unit}
    return own


def _show_estimate(estimate: sw.studies.StudyEstimate) -> None:
    minutes = estimate.seconds / 60
    took = f"{estimate.seconds:.0f} s" if minutes < 2 else f"{minutes:.0f} min"
    if minutes > 120:
        took = f"{minutes / 60:.0f} h"
    screen.show_lines(
        f"{estimate.designs} designs: about {took} on "
        f"{sw.base.counted(estimate.workers, 'core')} ({sw.base.to_unit(estimate.each, 'ms'):.3g} "
        f"ms each, measured on {estimate.sample}), and at most {estimate.disk / 1e6:.3g} MB."
    )


@contextmanager
def going_on(store: Path, scheduler: str | None, note: Callable[[], str] = str) -> Iterator[Any]:
    """Show the progress of a study, and after an interruption the command that resumes it."""
    if scheduler is not None:
        screen.warn(f"Dask's dashboard: {sw.studies.dashboard(scheduler)}")
    kept = f"finished chunks are kept; to resume: `stepwell sweep resume {store}`"
    with screen.progress("chunks", kept=kept, note=note) as tell:
        yield tell


def read_axes(texts: Sequence[str], subject: Any, *, drawn: bool) -> tuple[sw.studies.Axis, ...]:
    """The axes of a study, in SI for chains."""
    form = "NAME=FROM:TO" if drawn else "NAME=FROM:TO:COUNT"
    example = "outer.q.x=0:20" + ("" if drawn else ":41")
    axes: list[sw.studies.Axis] = []
    for text in texts:
        one = read_range(text, form, example)
        if not one.start < one.stop:
            raise typer.BadParameter(f"{text!r}: must rise, as {example} does.")
        unit = sw.studies.unit_in(subject, one.name)
        factor = 1.0 if isinstance(subject, sw.Robot) else sw.base.display_unit(unit)[1]
        ends = one.start / factor, one.stop / factor
        axes.append(sw.studies.Axis(one.name, *ends, one.count or 2, one.log))
    return tuple(axes)
