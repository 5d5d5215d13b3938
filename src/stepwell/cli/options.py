"""Arguments and options that several commands share, and completions for a shell."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, dataclass_transform, get_type_hints

import typer
from typer.core import TyperCommand

import stepwell as sw
from stepwell.base import need, refuse_address
from stepwell.cli.screen import EXIT_CODES, progress, report, silence, usable, warn, wrong


def designs(incomplete: str) -> list[str]:
    """Presets with this beginning, after `preset:`, and design files."""
    names = (f"preset:{name}" for name in sw.presets())
    return [*_begun(names, incomplete), *_files(incomplete, ".toml")]


def robots(incomplete: str) -> list[str]:
    """Robots among the presets, by name or after `preset:`, and files."""
    before = "preset:" if incomplete.startswith("preset:") else ""
    names = (f"{before}{name}" for name in sw.presets() if name.startswith("robot-"))
    return [*_begun(names, incomplete), *_files(incomplete, ".toml")]


def presets(incomplete: str) -> list[str]:
    """Presets with this beginning."""
    return _begun(sw.files.presets(), incomplete)


def arenas(incomplete: str) -> list[str]:
    """Arenas with this beginning, and files of arenas."""
    return [*_begun(sw.files.arenas(), incomplete), *_files(incomplete, ".toml", ".txt")]


def behaviours(incomplete: str) -> list[str]:
    """Behaviours with this beginning, and files."""
    return [*_begun(sw.files.behaviours(), incomplete), *_files(incomplete, ".toml")]


def machines(incomplete: str) -> list[str]:
    """State machines with this beginning, and files."""
    return [*_begun(sw.files.machines(), incomplete), *_files(incomplete, ".toml")]


def results(incomplete: str) -> list[str]:
    """Kinds of results with a JSON Schema."""
    return _begun(sw.accounts.schema_kinds(), incomplete)


def _begun(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]


def _files(incomplete: str, *endings: str) -> list[str]:
    folder = incomplete.rpartition("/")[0]
    place = Path(f"{folder}/" if folder or incomplete.startswith("/") else ".")
    try:
        entries = sorted(place.iterdir())
    except OSError:
        return []
    before = "".join(incomplete.rpartition("/")[:2])
    names = (
        f"{before}{one.name}{'/' * one.is_dir()}"
        for one in entries
        if one.suffix in endings or one.is_dir()
    )
    return _begun(names, incomplete)


DESIGN_HELP = "Design file (TOML), or the name of a preset; see `stepwell presets`."


def by_name(design: str | None) -> str | None:
    """The same design, with "preset:" before the name of a preset that is no file here."""
    if design and design in sw.files.presets() and not Path(design).exists():
        return f"preset:{design}"
    return design


Design = Annotated[
    str,
    typer.Argument(metavar="DESIGN", help=DESIGN_HELP, autocompletion=designs, callback=by_name),
]
Robot = Annotated[str, typer.Argument(metavar="ROBOT", help=DESIGN_HELP, autocompletion=robots)]
ARENA_HELP = "Arena: a name of `stepwell maze --list`, or a file (.toml, .txt)."
Arena = Annotated[str | None, typer.Option(metavar="ARENA", help=ARENA_HELP, autocompletion=arenas)]


def local(out: Path | None) -> Path | None:
    """The path of an output, or a refusal where it is an address on a network."""
    if out is not None:
        with usable():
            refuse_address(out)
    return out


def folder(out: Path | None) -> Path | None:
    """The path of a folder, or a refusal where its name is that of a figure."""
    if out is not None and out.suffix.lower() in (".pdf", ".svg", ".png"):
        how = f"is a folder here, with several files: omit {out.suffix}"
        raise wrong(None, f"{out}: {how}. `stepwell figure` writes one figure.")
    return local(out)


_OUT = typer.Option(
    "--out",
    "-o",
    metavar="DIR",
    help="Write the results into this folder. Results of the same command in it are replaced.",
    file_okay=False,
    callback=folder,
)
Out = Annotated[Path | None, _OUT]
Force = Annotated[bool, typer.Option("--force", help="Overwrite existing files.")]
Json = Annotated[
    bool,
    typer.Option(
        "--json", callback=silence, help="Print the result as JSON only; see docs/commands/."
    ),
]
Full = Annotated[bool, typer.Option("--full", help="Print all lines, not only the first screen.")]
NO_OPEN = "Do not open a browser."
CYCLES = "Number of drive cycles."
TIME_LIMIT = "Time limit of a simulation [s]."


def option(help: str, spelled: str = "", *, default: Any = None, **how: Any) -> Any:
    """An option: a field of a group or the default of a parameter; required with default `...`.

    `spelled` is how a user writes it, such as "--out -o FILE": names other than its own, metavar.
    """
    names = [word for word in spelled.split() if word.startswith("-")]
    metavar = " ".join(word for word in spelled.split() if word not in names) or None
    return _declared(default, typer.Option(*names, metavar=metavar, help=help, **how))


def flag(help: str, name: str, **how: Any) -> Any:
    """A flag, off by default; a field or a parameter as in `option`."""
    return _declared(False, typer.Option(name, help=help, **how))


def argument(help: str, metavar: str, *, default: Any = ..., **how: Any) -> Any:
    """A positional argument; a field or a parameter as in `option`."""
    return _declared(default, typer.Argument(metavar=metavar, help=help, **how))


def _declared(default: Any, parameter: Any) -> Any:
    given = MISSING if default is ... else default
    return field(default=given, kw_only=True, metadata={"typer": parameter})


@dataclass_transform(frozen_default=True)
@dataclass(frozen=True)
class Group:
    """Base of dataclasses whose fields are options of a command."""

    def __init_subclass__(cls) -> None:
        dataclass(frozen=True)(cls)


def grouped(command: Callable[..., None]) -> Callable[..., None]:
    """The command with one parameter for every option of its groups, as Typer reads it.

    A parameter is a group if its type is a `Group`. Defaults are those of the parameter's default,
    or else those of the fields.
    """
    groups: dict[str, type[Group]] = {}
    options: dict[str, inspect.Parameter] = {}

    def add(name: str, kind: Any, default: Any, parameter: Any) -> None:
        options[name] = inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if default is MISSING else default,
            annotation=Annotated[kind, parameter] if parameter else kind,
        )

    for name, one in inspect.signature(command, eval_str=True).parameters.items():
        kind, own = one.annotation, one.default
        if isinstance(kind, type) and issubclass(kind, Group):
            groups[name] = kind
            hints = get_type_hints(kind, include_extras=True)
            for part in fields(kind):  # type: ignore[arg-type]
                default = getattr(own, part.name, part.default)
                add(part.name, hints[part.name], default, part.metadata.get("typer"))
        elif isinstance(own, Field):
            add(name, kind, own.default, own.metadata["typer"])
        else:
            add(name, kind, own, None)

    @wraps(command)
    def run(**given: Any) -> None:
        for name, kind in groups.items():
            given[name] = kind(**{one.name: given.pop(one.name) for one in fields(kind)})  # type: ignore[arg-type]
        command(**given)

    run.__signature__ = inspect.Signature([*options.values()])  # type: ignore[attr-defined]
    run.__annotations__ = {name: one.annotation for name, one in options.items()}
    return run


def command(
    into: typer.Typer, cls: type[TyperCommand] | None = None
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add a command to a group of commands, with its options as `grouped` gives them."""
    return lambda one: into.command(epilog=EXIT_CODES, cls=cls)(grouped(one))


class Display(Group):
    """Options for the display of a result: a screen of text, all of its lines, or JSON."""

    as_json: Json = False
    full: Full = False

    def report(
        self, result: Any, *about: Any, how: Mapping[str, Any] | None = None, **more: Any
    ) -> sw.accounts.Account:
        """Write, print or show a result or its account, and return the account.

        `about` and `more` are the inputs of the computation, `how` options of `reports.write`.
        """
        if not isinstance(result, sw.accounts.Account):
            given = sw.accounts.About(*about, **more) if about or more else None
            with progress("results"):
                result = sw.accounts.account(result, given)
        report(result, self.as_json, self.full, **self.writing, **(how or {}))
        return result

    @property
    def writing(self) -> dict[str, Any]:
        """The options of `reports.write` that are options of the command too."""
        return {}


class Output(Display):
    """Options for the output of a result: text, JSON, files in a folder."""

    out: Out = None
    force: Force = False

    def check_output_folder(self, command: str, **texts: str) -> None:
        """Refuse an output folder that is not usable, see the function of this name."""
        check_output_folder(self.out, command, self.force, **texts)

    @property
    def writing(self) -> dict[str, Any]:
        """The folder, and whether its files may be replaced."""
        return {"out": self.out, "force": self.force}


class Folder(Output):
    """Output options of a command that always writes into a folder."""

    out: Annotated[Path, _OUT] = field(kw_only=True)


def view_of(view: str | None) -> str | None:
    """The view of a video, or a refusal of a view that does not exist."""
    if view is not None:
        with usable("--view"):
            sw.simulation.view_angles(view)
    return view


class FilmedOutput(Output):
    """Output options of a simulation, whose folder contains a video too."""

    no_video: bool = flag("Write no video.", "--no-video")
    view: str | None = option(
        "View of the video: above, side, front, three-quarter, or azimuth and elevation [deg].",
        "--view VIEW",
        callback=view_of,
    )

    @property
    def writing(self) -> dict[str, Any]:
        """Whether a video is written too; problems with it are warnings."""
        return {**super().writing, "video": not self.no_video, "view": self.view, "warn": warn}


Robust = Annotated[
    float | None,
    typer.Option(
        "--robust",
        metavar="RATIO",
        help="Require the result for every ratio of cell mobilities up to RATIO, such as 10.",
        min=1,
        max=1e3,
    ),
]
MobilityRatio = Annotated[
    float | None,
    typer.Option(
        "--mobility-ratio",
        metavar="RATIO",
        help="Check that every snap has one landing for all ratios of cell mobilities up to RATIO; "
        "10 by default, for up to 8 cells.",
    ),
]
Prove = Annotated[
    bool,
    typer.Option(
        "--prove",
        help="Prove the result in ball arithmetic: errors of all events, and what is not proved.",
    ),
]

WITHOUT = "Without --out the result is shown, and --json prints all of it."


def read_chain(design: str) -> tuple[str, sw.Chain]:
    """The text of a design file, and the chain that it describes."""
    name = by_name(design) or design
    text = sw.files.text_of(name, robots=False)
    return text, sw.files.loads(text, name).chain


def read_design(design: str) -> tuple[str, sw.Chain | sw.robot.Robot]:
    """The text of a design file, and the chain or the robot that it describes."""
    text = sw.files.text_of(design)
    return text, sw.files.loads(text, design).subject


def read_buildable(design: str) -> tuple[str, sw.Chain | sw.robot.Robot | sw.robot.Hopper]:
    """The text of a design file, and the chain, hopper or robot that it describes."""
    text = sw.files.text_of(design)
    return text, sw.files.loads(text, design).value


def read_robot(robot: str) -> tuple[str, sw.robot.Robot]:
    """The text of a robot's design file, and the robot."""
    name = by_name(robot) or robot
    text = sw.files.text_of(name, robots=True)
    return text, sw.files.loads(text, name).robot


def read_hopper(design: str) -> tuple[str, sw.robot.Hopper]:
    """The text of a design file, and the hopper that it describes."""
    text = sw.files.text_of(design, robots=False)
    return text, sw.files.loads(text, design).hopper


def check_output_folder(out: Path | None, command: str, force: bool, **texts: str) -> None:
    """Refuse a folder that contains files of other origin, or that cannot be written.

    `texts` are contents of files that may stand there already, by their names without .toml.
    """
    if out is not None:
        need(*sw.files.extras_of(command), note=WITHOUT)
        known = {f"{name}.toml": text for name, text in texts.items()}
        sw.files.check_folder(out, command, force=force, texts=known)


def free_file(file: Path | None, force: bool) -> None:
    """Refuse a file that exists, unless `force` allows to replace it."""
    if file is not None and file.exists() and not force:
        raise wrong(str(file), "exists: choose another name, or pass --force to replace it.")
