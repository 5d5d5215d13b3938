"""`stepwell sweep`: one thing computed of many designs, into a store that loses nothing."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

import stepwell as sw
from stepwell.accounts import account
from stepwell.base import Measure
from stepwell.cli import options as opts, screen, tolerances as parts
from stepwell.cli.options import Design, Folder, Group, Json
from stepwell.cli.ranges import read_range

commands = screen.subcommands("Compute a parameter study on all cores; it can be resumed.")

_Partial = Annotated[
    bool, typer.Option("--partial", help="Go without designs that are missing, instead of failing.")
]
_There = Annotated[
    Path, typer.Argument(metavar="STORE", help="Path of the study: the value given to --out.")
]

_Engine = Annotated[
    str,
    typer.Option(
        metavar="ENGINE",
        help="cpu computes every design; warp screens all of them at once on a GPU, in single "
        "precision; cpu then recomputes all designs that behave like the design itself, all "
        "undecided ones, and a random 10 %.",
    ),
]


class _Program(Group):
    start: str | None = opts.option("As in 00.", "--from STATE")
    target: str = opts.option("As in 01.", "STATE", default=...)


class _Walk(Group):
    cycles: int = opts.option("How many cycles each walks.", default=4, min=1)
    engine: _Engine = "cpu"


class _Maze(Group):
    arena: str = opts.option("A name, or a file of your own.", "ARENA", default=...)
    limit: float = opts.option("Time it is given [s].", default=600.0, min=1)
    layouts: int = opts.option(
        "So many layouts with walls and start a little elsewhere, the same for "
        "every design; 0 takes the arena as it is.",
        default=0,
        min=0,
    )
    first: int = opts.option(
        "Number of the first of these layouts; another range than the one by "
        "which a design was chosen is an independent test of it.",
        default=0,
        min=0,
    )
    place: float | None = opts.option(
        "How far a layout shifts each wall at most [mm]; 40 by default.", "MM", min=0
    )
    angle: float | None = opts.option(
        "How far a layout turns each wall at most [deg]; 8 by default.", "DEG", min=0
    )
    engine: _Engine = "cpu"


class _Call(Group):
    function: str = opts.option(
        "A function of a design and a seed that gives numbers and texts by name.",
        "FILE.py:NAME",
        default=...,
    )


class Effort(Group):
    """On which processes the work is done."""

    workers: int | None = opts.option(
        "Processes at once; one for every core by default, 0 to do without any.", "N", min=0
    )
    scheduler: str | None = opts.option(
        "A running Dask scheduler, such as tcp://10.0.0.1:8786, instead.", "ADDRESS"
    )


class _Study(Effort):
    seed: parts.Seed = 0
    chunk: int | None = opts.option("Designs that are computed and written together.", "N", min=1)
    estimate: bool = opts.flag(
        "Print the estimated run time and disk space, then exit.", "--estimate"
    )
    as_json: Json = False


class _Drawn(Group):
    vary: list[str] | None = opts.option(
        "What varies, such as outer.q.x=0:20:41 or 1.stiffness=20:40:9, in the units of "
        "`stepwell map`; of a robot a key such as foot.below_mm; :log for equal ratios; without "
        "COUNT with --sobol, --latin or --random. May be given again.",
        "--vary NAME=FROM:TO:COUNT",
    )
    table: Path | None = opts.option("Designs one by one, a line of a CSV file each.", "FILE")
    sobol: int | None = opts.option("N designs of a Sobol' sequence, scrambled.", "N", min=1)
    latin: int | None = opts.option("N designs of a Latin hypercube.", "N", min=1)
    random: int | None = opts.option("N designs drawn independently.", "N", min=1)

    built = None  # an option of chains

    def of(self, subject: Any, seed: int) -> sw.studies.Designs:
        """The designs, as a study takes them."""
        ways = ("table", "sobol", "latin", "random", "built")
        chosen = [name for name in ways if getattr(self, name) is not None]
        _refuse_two(chosen, bool(self.vary))
        if self.table is not None:
            with screen.usable("--table"):
                return sw.studies.read_table(self.table, subject)
        if isinstance(self, _Chosen) and self.built is not None:
            measure = getattr(subject, "measure", Measure.TRAVEL)
            with screen.usable("--built"):
                return sw.studies.Workshop(self.tolerances(measure), self.built, seed)
        count = self.sobol or self.latin or self.random or 0
        with screen.usable("--vary"):
            axes = read_axes(self.vary or [], subject, drawn=bool(count))
            how = sw.studies.How(chosen[0] if chosen else "grid")
            return sw.studies.Space(axes, how, count, seed)


class _Sampled(_Drawn):
    """The same of chains, which can be sampled too."""

    built: int | None = opts.option(
        "N random samples of the design within these tolerances:", "N", min=1
    )


class _Chosen(parts.ToleranceOptions, _Sampled):
    """The same with the tolerances of the samples."""


_GRID = "preset:paper-forward --vary outer.q.x=0:20:41"
_FEET = "robot-forward --vary foot.below_mm=0.6:1.0:5"
# What else a study asks for, with an example; the others ask for nothing more.
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
            "The store, a folder that xarray opens as Zarr.",
            "--out -o STORE",
            default=...,
            callback=opts.local,
        ),
        designs: _Drawn,
        how: _Study,
    ) -> None:
        from stepwell.kernels import cores

        _, subject = opts.read_design(design)
        chosen = designs.of(subject, how.seed)
        with screen.usable(what):
            given = _given(own, subject)
            study = sw.studies.asked(subject, what, chosen, out, given=given, chunk=how.chunk)
        if how.estimate:
            workers = cores() if how.workers is None else max(how.workers, 1)
            _show_estimate(sw.studies.estimate(study, workers))
            return
        with screen.usable(design):
            begun = sw.studies.begun(study)
        _resumed(begun, how, how.as_json)

    kind, example = _OWN.get(what, (Group, _GRID))
    run.__annotations__ |= {"own": kind, "designs": _Drawn if kind in (_Walk, _Maze) else _Chosen}
    run.__doc__ = (
        f"{doc}\n\nThe designs are a grid, drawn, listed, or samples of one design. Results are "
        f"written to a store in chunks. To resume after an interruption, run the same command "
        f"again; the finished store is the same. If a design fails, its row contains the problem."
        f"\n\nExample: stepwell sweep {what} {example} --out store"
    )
    commands.command(what, epilog=screen.EXIT_CODES)(opts.grouped(run))


for _what, _doc in {
    "cycle": "Compute the full cycle of every design: sequence, snaps, peak force, energy lost.",
    "margin": "Compute how far every design is from another sequence, by an anchor or a stiffness.",
    "yield": "Compute the yield of every design with the usual tolerances.",
    "graph": "Compute the number of states and transitions that every design reaches.",
    "program": "Search the fewest turning points of every design from one state to another.",
    "walk": "Simulate a walk of every robot: advance, turn, work and gaits.",
    "maze": "Simulate every robot in an arena: whether it reaches the goal.",
    "call": "Compute a function of your own for every design.",
}.items():
    _command(_what, _doc)


@opts.command(commands)
def resume(store: _There, effort: Effort, as_json: Json = False) -> None:
    """Compute what is missing in a store.

    Example: stepwell sweep resume store
    """
    _resumed(sw.studies.opened(store), effort, as_json)


@opts.command(commands)
def extend(
    *,
    store: _There,
    count: int = opts.option("Designs in all.", "N", default=..., min=1),
    effort: Effort,
    as_json: Json = False,
) -> None:
    """Add designs to a store whose designs were drawn; those that there are stay.

    Example: stepwell sweep extend store --count 2048
    """
    with screen.usable("--count"):
        study = sw.studies.extended(sw.studies.opened(store), count)
    _resumed(study, effort, as_json)


@opts.command(commands)
def cancel(store: _There) -> None:
    """Stop all workers of a study after their current chunk; finished chunks are kept.

    Example: stepwell sweep cancel store
    """
    sw.studies.cancel(sw.studies.opened(store))
    screen.show_lines(f"{store}: stops soon. Go on with: stepwell sweep resume {store}")


@opts.command(commands)
def status(store: _There, as_json: Json = False) -> None:
    """List the progress of a study, and its results so far.

    Example: stepwell sweep status store
    """
    found = sw.studies.status(store)
    screen.report(account(found), as_json)
    if any(gap.damaged for gap in found.gaps):
        raise typer.Exit(screen.FAILED)


@opts.command(commands)
def export(
    *,
    store: _There,
    out: Path = opts.option(
        "The table: .csv, or .parquet.",
        "--out -o FILE",
        default=...,
        dir_okay=False,
        callback=opts.local,
    ),
    best: int | None = opts.option(
        "Only the N best designs, best first, and only what varies: a list that another "
        "study takes as --table.",
        "N",
        min=1,
    ),
    by: list[str] | None = opts.option(
        "What makes them the best: the largest values of a column, or the least with - "
        "before it; given again, what decides between ties.",
        "COLUMN",
    ),
    partial: _Partial = False,
) -> None:
    """Export the designs of a store as a table, units in the headings.

    Example: stepwell sweep export store --out table.csv
    """
    if bool(best) != bool(by):
        raise screen.wrong("--best, --by", "must both be given, or neither.")
    if out.suffix not in ((".csv",) if best else (".csv", ".parquet")):
        ends = ".csv" if best else ".csv or .parquet"
        raise screen.wrong("--out", f"{out}: must end in {ends}.")
    study = sw.studies.opened(store)
    if best and by:
        with screen.usable("--by"):
            table = study.best(best, by, partial=partial)
        table.to_csv(out, study.subject)
        screen.show_lines(f"Written into {out}: the best {table.count} of {study.count} designs.")
        return
    write = study.to_parquet if out.suffix == ".parquet" else study.to_csv
    count = write(out, partial=partial)
    of = "" if count == study.count else f" of {study.count}"
    screen.show_lines(f"Written into {out}: {count}{of} designs.")


@opts.command(commands)
def report(store: _There, partial: _Partial = False, *, output: Folder) -> None:
    """Plot the results of a study on one page, and compute which number decides them.

    Example: stepwell sweep report store --out report
    """
    output.check_output_folder("sweep report")
    found = sw.studies.status(store)
    if not partial:
        found.study.require_whole()
    output.report(found, how={"partial": partial})


def _resumed(study: sw.studies.Study, effort: Effort, as_json: bool) -> None:
    if study.work.screen and effort.scheduler is None and not sw.simulation.device()[1]:
        slow = "No GPU here: Warp screens on the processor, where --engine cpu is much faster."
        screen.warn(slow)
    kinds, begun, where = Counter[str](), sw.studies.begun(study), effort.scheduler
    with going_on(study.folder, where, lambda: _so_far(kinds)) as tell:
        found = sw.studies.resumed(
            begun, effort.workers, scheduler=where, progress=tell, problems=kinds.update
        )
    screen.report(account(found), as_json)


def _so_far(kinds: Counter[str]) -> str:
    return "".join(f", {count} {kind}" for kind, count in sorted(kinds.items()))


def _refuse_two(chosen: Sequence[str], varied: bool) -> None:
    if len(chosen) > 1:
        raise screen.wrong(f"--{chosen[0]}", f"cannot stand with --{chosen[1]}.")
    listed = chosen in (["table"], ["built"])
    if not varied and not listed:
        raise screen.wrong("--vary", "is needed, or --table, or --built.")
    if varied and listed:
        raise screen.wrong(f"--{chosen[0]}", "cannot stand with --vary.")


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


def _show_estimate(found: sw.studies.StudyEstimate) -> None:
    minutes = found.seconds / 60
    took = f"{found.seconds:.0f} s" if minutes < 2 else f"{minutes:.0f} min"
    if minutes > 120:
        took = f"{minutes / 60:.0f} h"
    screen.show_lines(
        f"{found.designs} designs: about {took} on {sw.base.counted(found.workers, 'core')} "
        f"({sw.base.to_unit(found.each, 'ms'):.3g} ms each, from {found.sample} of them), and at "
        f"most {found.disk / 1e6:.3g} MB."
    )


@contextmanager
def going_on(store: Path, scheduler: str | None, note: Callable[[], str] = str) -> Iterator[Any]:
    """Show how far the work on a store is, and say how it goes on where it is interrupted."""
    if scheduler is not None:
        screen.warn(f"Dask's dashboard: {sw.studies.dashboard(scheduler)}")
    kept = f"what is done stays, and `stepwell sweep resume {store}` goes on"
    with screen.progress("chunks", kept=kept, note=note) as tell:
        yield tell


def read_axes(texts: Sequence[str], subject: Any, *, drawn: bool) -> tuple[sw.studies.Axis, ...]:
    """What varies, as a store keeps it."""
    form = "NAME=FROM:TO" if drawn else "NAME=FROM:TO:COUNT"
    example = "outer.q.x=0:20" + ("" if drawn else ":41")
    found: list[sw.studies.Axis] = []
    for text in texts:
        one = read_range(text, form, example)
        if not one.start < one.stop:
            raise typer.BadParameter(f"{text!r}: must rise, as {example} does.")
        unit = sw.studies.unit_in(subject, one.name)
        factor = 1.0 if isinstance(subject, sw.Robot) else sw.base.display_unit(unit)[1]
        ends = one.start / factor, one.stop / factor
        found.append(sw.studies.Axis(one.name, *ends, one.count or 2, one.log))
    return tuple(found)
