"""Arguments that several commands share, what they name, and what a shell completes."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, dataclass_transform, get_type_hints

import typer

import stepwell as sw
from stepwell.base import need, refuse_address
from stepwell.cli.screen import EXIT_CODES, report, usable, warn, wrong


def designs(incomplete: str) -> list[str]:
    """Presets that begin so, behind `preset:`, and design files."""
    names = (f"preset:{name}" for name in sw.presets())
    return [*_begun(names, incomplete), *_files(incomplete, ".toml")]


def robots(incomplete: str) -> list[str]:
    """The robots among the presets, by their names alone or behind `preset:`, and files."""
    before = "preset:" if incomplete.startswith("preset:") else ""
    names = (f"{before}{name}" for name in sw.presets() if name.startswith("robot-"))
    return [*_begun(names, incomplete), *_files(incomplete, ".toml")]


def presets(incomplete: str) -> list[str]:
    """Presets that begin so."""
    return _begun(sw.files.presets(), incomplete)


def arenas(incomplete: str) -> list[str]:
    """Arenas that begin so, and files of arenas."""
    return [*_begun(sw.files.arenas(), incomplete), *_files(incomplete, ".toml", ".txt")]


def results(incomplete: str) -> list[str]:
    """Results that have a JSON Schema."""
    return _begun(sw.accounts.schema_kinds(), incomplete)


def _begun(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]


def _files(incomplete: str, *endings: str) -> list[str]:
    folder = incomplete.rpartition("/")[0]
    place = Path(f"{folder}/" if folder or incomplete.startswith("/") else ".")
    try:
        found = sorted(place.iterdir())
    except OSError:
        return []
    before = "".join(incomplete.rpartition("/")[:2])
    names = (
        f"{before}{one.name}{'/' * one.is_dir()}"
        for one in found
        if one.suffix in endings or one.is_dir()
    )
    return _begun(names, incomplete)


Design = Annotated[
    str,
    typer.Argument(
        metavar="DESIGN",
        help="A design file (TOML), or preset:NAME for a design of `stepwell presets`.",
        autocompletion=designs,
    ),
]
Robot = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        help="A robot's design file (TOML), or the name of one of `stepwell presets`.",
        autocompletion=robots,
    ),
]
Arena = Annotated[
    str | None,
    typer.Option(
        metavar="ARENA", help="Put it there; see `stepwell maze --list`.", autocompletion=arenas
    ),
]


def local(out: Path | None) -> Path | None:
    """Where results go, if it is a place on this machine."""
    if out is not None:
        with usable():
            refuse_address(out)
    return out


_OUT = typer.Option(
    "--out",
    "-o",
    metavar="DIR",
    help="Write the results into this folder.",
    file_okay=False,
    callback=local,
)
Out = Annotated[Path | None, _OUT]
Force = Annotated[bool, typer.Option("--force", help="Overwrite existing files.")]
ForceFile = Annotated[bool, typer.Option("--force", help="Overwrite the file if it exists.")]
Json = Annotated[
    bool, typer.Option("--json", help="Print JSON and nothing else; docs/commands.md describes it.")
]


def option(help: str, spelled: str = "", *, default: Any = None, **how: Any) -> Any:
    """An option, as a field of a group or the default of a parameter; required where `...` is its.

    `spelled` is how a user writes it, such as "--out -o FILE": names other than its own, metavar.
    """
    names = [word for word in spelled.split() if word.startswith("-")]
    metavar = " ".join(word for word in spelled.split() if word not in names) or None
    return _declared(default, typer.Option(*names, metavar=metavar, help=help, **how))


def flag(help: str, name: str, **how: Any) -> Any:
    """The same of a switch, which is off by default."""
    return _declared(False, typer.Option(name, help=help, **how))


def argument(help: str, metavar: str, *, default: Any = ..., **how: Any) -> Any:
    """The same of an argument."""
    return _declared(default, typer.Argument(metavar=metavar, help=help, **how))


def _declared(default: Any, told: Any) -> Any:
    given = MISSING if default is ... else default
    return field(default=given, kw_only=True, metadata={"typer": told})


@dataclass_transform(frozen_default=True)
@dataclass(frozen=True)
class Group:
    """Options that belong together, as one value: a dataclass of options."""

    def __init_subclass__(cls) -> None:
        dataclass(frozen=True)(cls)


def grouped(command: Callable[..., None]) -> Callable[..., None]:
    """The same command with its options as Typer reads them, those of a group one by one.

    A parameter is a group if its type is one; its default, or else the fields' own, are theirs.
    """
    groups: dict[str, type[Group]] = {}
    options: dict[str, inspect.Parameter] = {}

    def add(name: str, kind: Any, default: Any, told: Any) -> None:
        options[name] = inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if default is MISSING else default,
            annotation=Annotated[kind, told] if told else kind,
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


def command(into: typer.Typer) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add a command to a group of commands, with its options as `grouped` gives them."""
    return lambda one: into.command(epilog=EXIT_CODES)(grouped(one))


class Output(Group):
    """What becomes of a result: shown, printed as JSON, written into a folder."""

    out: Out = None
    force: Force = False
    as_json: Json = False

    def check_output_folder(self, command: str, **texts: str) -> None:
        """Refuse a folder where the results of a command may not be written, see `free`."""
        check_output_folder(self.out, command, self.force, **texts)

    def report(
        self, found: Any, *about: Any, how: Mapping[str, Any] | None = None, **more: Any
    ) -> sw.accounts.Account:
        """Write, print or show a result or its account, and return that.

        `about` and `more` say from what it was computed, `how` are options of `reports.write`.
        """
        if not isinstance(found, sw.accounts.Account):
            given = sw.accounts.About(*about, **more) if about or more else None
            found = sw.accounts.account(found, given)
        report(found, self.as_json, self.out, self.force, **self.writing, **(how or {}))
        return found

    @property
    def writing(self) -> dict[str, Any]:
        """The options of `reports.write` that are options of the command too."""
        return {}


class Folder(Output):
    """The same where a result is always written into a folder."""

    out: Annotated[Path, _OUT] = field(kw_only=True)


class FilmedOutput(Output):
    """The same of a simulation, whose folder holds a video too."""

    no_video: bool = flag("Write the figures alone.", "--no-video")

    @property
    def writing(self) -> dict[str, Any]:
        """Whether there is a video; what is odd about it is a warning."""
        return {"video": not self.no_video, "warn": warn}


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
        metavar="R",
        help="Check that every snap has one landing for all ratios of cell mobilities up to R; by "
        "default 10, for up to 8 cells.",
    ),
]

WITHOUT = "Without --out the result is shown, and --json prints all of it."


def read_chain(design: str) -> tuple[str, sw.Chain]:
    """The text of a design file, and the chain that it describes."""
    file = sw.files.load(design)
    return file.text, file.chain


def read_design(design: str) -> tuple[str, sw.Chain | sw.robot.Robot]:
    """The text of a design file, and the chain or the robot that it describes."""
    text, design = _by_name(design)
    return text, sw.files.loads(text, design).subject


def read_robot(robot: str) -> tuple[str, sw.robot.Robot]:
    """The text of a robot's design file, and the robot; a preset goes by its name alone too."""
    text, robot = _by_name(robot)
    return text, sw.files.loads(text, robot).robot


def _by_name(design: str) -> tuple[str, str]:
    if design in sw.files.presets() and not Path(design).exists():
        design = f"preset:{design}"
    return sw.files.text_of(design), design


def check_output_folder(out: Path | None, command: str, force: bool, **texts: str) -> None:
    """Refuse a folder where results would replace others' work, or cannot be written here.

    `texts` are those of files whose content is known, by their names without .toml.
    """
    if out is not None:
        need(*sw.files.extras_of(command), note=WITHOUT)
        known = {f"{name}.toml": text for name, text in texts.items()}
        sw.files.check_folder(out, command, force=force, texts=known)


def free_file(file: Path | None, force: bool) -> None:
    """Refuse a file that exists, unless it may be replaced."""
    if file is not None and file.exists() and not force:
        raise wrong(str(file), "exists: choose another name, or pass --force to replace it.")
