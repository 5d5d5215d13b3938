"""`stepwell sweep`: one thing computed of many designs, into a store that loses nothing."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

import stepwell as sw
from stepwell.accounts import account
from stepwell.base import Measure
from stepwell.cli import screen, tolerances as parts
from stepwell.cli.options import (
    Design,
    Folder,
    Group,
    Json,
    command,
    grouped,
    local,
    option,
    read_design,
)
from stepwell.cli.ranges import read_range

commands = screen.subcommands("Compute a parameter study on all cores; it can be resumed.")

_Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="NAME=FROM:TO:COUNT",
        help="What varies, such as outer.q.x=0:20:41 or 1.stiffness=20:40:9, in the units of "
        "`stepwell map`; of a robot a key such as foot.below_mm; :log for equal ratios; without "
        "COUNT with --sobol, --latin or --random. May be given again.",
    ),
]
_Table = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Designs one by one, a line of a CSV file each.")
]
_Store = Annotated[
    Path,
    typer.Option(
        "--out",
        "-o",
        metavar="STORE",
        help="The store, a folder that xarray opens as Zarr.",
        callback=local,
    ),
]
_Sobol = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="N designs of a Sobol' sequence, scrambled.")
]
_Latin = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="N designs of a Latin hypercube.")
]
_Random = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="N designs drawn independently.")
]
_Chunk = Annotated[
    int | None,
    typer.Option(metavar="N", min=1, help="Designs that are computed and written together."),
]
_Estimate = Annotated[
    bool, typer.Option("--estimate", help="Print the estimated run time and disk space, then exit.")
]
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


@dataclass(frozen=True)
class _Program(Group):
    """What a program is searched for."""

    start: str | None = option(None, "As in 00.", "--from STATE")
    target: str = option(..., "As in 01.", "STATE")


@dataclass(frozen=True)
class _Walk(Group):
    """How every robot walks."""

    cycles: int = option(4, "How many cycles each walks.", min=1)
    engine: _Engine = "cpu"


@dataclass(frozen=True)
class _Maze(Group):
    """Where every robot walks."""

    arena: str = option(..., "A name, or a file of your own.", "ARENA")
    limit: float = option(600.0, "Time it is given [s].", min=1)
    layouts: int = option(
        0,
        "So many layouts with walls and start a little elsewhere, the same for "
        "every design; 0 takes the arena as it is.",
        min=0,
    )
    first: int = option(
        0,
        "Number of the first of these layouts; another range than the one by "
        "which a design was chosen is an independent test of it.",
        min=0,
    )
    place: float | None = option(
        None, "How far a layout shifts each wall at most [mm]; 40 by default.", "MM", min=0
    )
    angle: float | None = option(
        None, "How far a layout turns each wall at most [deg]; 8 by default.", "DEG", min=0
    )
    engine: _Engine = "cpu"


@dataclass(frozen=True)
class _Call(Group):
    """What is computed of every design."""

    function: str = option(
        ...,
        "A function of a design and a seed that gives numbers and texts by name.",
        "FILE.py:NAME",
    )


@dataclass(frozen=True)
class Effort(Group):
    """On which processes the work is done."""

    workers: int | None = option(
        None, "Processes at once; one for every core by default, 0 to do without any.", "N", min=0
    )
    scheduler: str | None = option(
        None, "A running Dask scheduler, such as tcp://10.0.0.1:8786, instead.", "ADDRESS"
    )


@dataclass(frozen=True)
class _Study(Effort):
    """How the designs of a study are computed."""

    seed: parts.Seed = 0
    chunk: _Chunk = None
    estimate: _Estimate = False
    as_json: Json = False


@dataclass(frozen=True)
class _Drawn(Group):
    """Which designs are computed."""

    vary: _Vary = None
    table: _Table = None
    sobol: _Sobol = None
    latin: _Latin = None
    random: _Random = None

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
            return sw.studies.Space(
                axes, sw.studies.How(chosen[0] if chosen else "grid"), count, seed
            )


@dataclass(frozen=True)
class _Sampled(_Drawn):
    """The same of chains, which can be sampled too."""

    built: int | None = option(
        None, "N random samples of the design within these tolerances:", "N", min=1
    )


@dataclass(frozen=True)
class _Chosen(parts.ToleranceOptions, _Sampled):
    """The same with the tolerances of the samples."""


def _command(what: str, doc: str, own: type[Group], chains: bool) -> None:
    """A command for something that is computed of chains, or of robots."""

    def run(design: Design, own: Group, out: _Store, designs: _Drawn, how: _Study) -> None:
        from stepwell.kernels import cores

        _, subject = read_design(design)
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

    run.__annotations__ |= {"own": own, "designs": _Chosen if chains else _Drawn}
    run.__doc__ = doc
    commands.command(what, epilog=screen.EXIT_CODES)(grouped(run))


_GRID = "preset:paper-forward --vary outer.q.x=0:20:41"
_FEET = "robot-forward --vary foot.below_mm=0.6:1.0:5"
_EXAMPLES = {
    "cycle": _GRID,
    "margin": _GRID,
    "yield": _GRID,
    "graph": _GRID,
    "program": f"{_GRID} --target 01",
    "walk": _FEET,
    "maze": f"{_FEET} --arena three-walls",
    "call": f"{_GRID} --function mine.py:count",
}
_OF_ROBOTS = {"walk": _Walk, "maze": _Maze}
_OF_CHAINS = {"program": _Program, "call": _Call}
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
    _command(
        _what,
        f"{_doc}\n\nThe designs are a grid, drawn, listed, or samples of one design. Results are "
        f"written to a store in chunks. To resume after an interruption, run the same command "
        f"again; the finished store is the same. If a design fails, its row contains the problem."
        f"\n\nExample: stepwell sweep {_what} {_EXAMPLES[_what]} --out store",
        (_OF_ROBOTS | _OF_CHAINS).get(_what, Group),
        _what not in _OF_ROBOTS,
    )


@command(commands)
def resume(store: _There, effort: Effort, as_json: Json = False) -> None:
    """Compute what is missing in a store.

    Example: stepwell sweep resume store
    """
    _resumed(sw.studies.opened(store), effort, as_json)


@command(commands)
def extend(
    *,
    store: _There,
    count: int = option(..., "Designs in all.", "N", min=1),
    effort: Effort,
    as_json: Json = False,
) -> None:
    """Add designs to a store whose designs were drawn; those that there are stay.

    Example: stepwell sweep extend store --count 2048
    """
    with screen.usable("--count"):
        study = sw.studies.extended(sw.studies.opened(store), count)
    _resumed(study, effort, as_json)


@command(commands)
def cancel(store: _There) -> None:
    """Stop all workers of a study after their current chunk; finished chunks are kept.

    Example: stepwell sweep cancel store
    """
    sw.studies.cancel(sw.studies.opened(store))
    screen.show_lines(f"{store}: stops soon. Go on with: stepwell sweep resume {store}")


@command(commands)
def status(store: _There, as_json: Json = False) -> None:
    """List the progress of a study, and its results so far.

    Example: stepwell sweep status store
    """
    found = sw.studies.status(store)
    screen.report(account(found), as_json)
    if any(gap.damaged for gap in found.gaps):
        raise typer.Exit(screen.FAILED)


@command(commands)
def export(
    *,
    store: _There,
    out: Path = option(
        ..., "The table: .csv, or .parquet.", "--out -o FILE", dir_okay=False, callback=local
    ),
    best: int | None = option(
        None,
        "Only the N best designs, best first, and only what varies: a list that another "
        "study takes as --table.",
        "N",
        min=1,
    ),
    by: list[str] | None = option(
        None,
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
        raise typer.BadParameter("must both be given, or neither.", param_hint="--best, --by")
    if out.suffix not in ((".csv",) if best else (".csv", ".parquet")):
        ends = ".csv" if best else ".csv or .parquet"
        raise typer.BadParameter(f"{out}: must end in {ends}.", param_hint="--out")
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


@command(commands)
def report(store: _There, partial: _Partial = False, *, output: Folder) -> None:
    """Plot the results of a study on one page, and compute which number decides them.

    Example: stepwell sweep report store --out report
    """
    output.free("sweep report")
    found = sw.studies.status(store)
    if not partial:
        found.study.require_whole()
    output.report(account(found), partial=partial)


def _resumed(study: sw.studies.Study, effort: Effort, as_json: bool) -> None:
    if study.work.screen and effort.scheduler is None:
        _warn_without_gpu()
    kinds = Counter[str]()
    with going_on(study.folder, effort.scheduler, lambda: _so_far(kinds)) as tell:
        found = sw.studies.resumed(
            sw.studies.begun(study),
            effort.workers,
            scheduler=effort.scheduler,
            progress=tell,
            problems=kinds.update,
        )
    screen.report(account(found), as_json)


def _warn_without_gpu() -> None:
    _, is_gpu = sw.simulation.device()
    if not is_gpu:
        screen.warn(
            "No GPU here: Warp screens on the processor, where --engine cpu is much faster."
        )


def _so_far(kinds: Mapping[str, int]) -> str:
    """Designs that could not be computed, by the kind of their problem, for a line."""
    return "".join(f", {count} {kind}" for kind, count in sorted(kinds.items()))


def _refuse_two(chosen: Sequence[str], varied: bool) -> None:
    """Designs come about in one way."""
    if len(chosen) > 1:
        raise typer.BadParameter(f"cannot stand with --{chosen[1]}.", param_hint=f"--{chosen[0]}")
    if not varied and not {"table", "built"} & set(chosen):
        raise typer.BadParameter("is needed, or --table, or --built.", param_hint="--vary")
    if varied and {"table", "built"} & set(chosen):
        raise typer.BadParameter("cannot stand with --vary.", param_hint=f"--{chosen[0]}")


def _given(options: Group, subject: Any) -> dict[str, Any]:
    """What a study is given of these options."""
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
        factor = 1.0 if isinstance(subject, sw.Robot) else sw.base.told_in(unit)[1]
        found.append(
            sw.studies.Axis(
                one.name, one.start / factor, one.stop / factor, one.count or 2, one.log
            )
        )
    return tuple(found)
