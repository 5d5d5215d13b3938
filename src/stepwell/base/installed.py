"""Report on the installation: packages, extras, tools, and parts that do not work."""

import os
import platform
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any, NamedTuple, TypeVar

from stepwell.base.errors import printable
from stepwell.base.extras import EXTRAS, Extra, install
from stepwell.base.shown import Shown
from stepwell.base.value import ByValue

T = TypeVar("T")
Probes = Mapping[str, Callable[[], Any]]

# As in pyproject.toml; a test compares both. A checkout that is not installed has no metadata to
# read. Packages of the extras are in `extras`.
NEEDED = (
    "charset-normalizer", "filelock", "networkx", "numba", "numpy", "platformdirs", "pydantic",
    "rich", "scipy", "tomli-w", "typer",
)  # fmt: skip


class Package(NamedTuple):
    """A package that Stepwell needs, and its version; None if it is missing."""

    name: str
    version: str | None


class InstalledExtra(NamedTuple):
    """An extra, whether all of its packages are installed, and the versions of those that are."""

    name: str
    used_for: str
    present: bool
    versions: dict[str, str]

    @property
    def install(self) -> str:
        """The command that adds it."""
        return install(self.name)


class Tool(NamedTuple):
    """A program or a device, and its path or name; None if it is missing."""

    name: str
    used_for: str
    found: str | None


class Broken(NamedTuple):
    """A part that is installed but does not work."""

    part: str
    reason: str


@dataclass(frozen=True, eq=False)
class Installation(ByValue, Shown):
    """Installed packages and tools; cores and kernels are None if a needed package is missing.

    Attributes:
        ok: whether all needed packages are installed and work.
        python, system: version, and operating system with processor.
        packages: the needed ones.
        extras: the optional ones, installed or not.
        tools: programs and devices.
        broken: parts that do not work.
        cores: number of usable cores.
        kernels: compiled kernels, as in `kernels.kept`.
    """

    ok: bool
    python: str
    system: str
    packages: tuple[Package, ...] = field(repr=False)
    extras: tuple[InstalledExtra, ...] = field(repr=False)
    tools: tuple[Tool, ...] = field(repr=False)
    broken: tuple[Broken, ...]
    cores: int | None
    kernels: Any = field(repr=False)

    @property
    def missing(self) -> list[str]:
        """Names of the packages that are missing."""
        return [one.name for one in self.packages if one.version is None]


def installation(probes: Probes) -> Installation:
    """Examine each part by itself; a part that fails is listed as broken.

    `probes` are functions of higher layers: `cores`, `kernels`, `OpenGL` and `display`.
    """
    broken: list[Broken] = []
    packages = tuple(Package(name, _version(name)) for name in NEEDED)
    whole = all(one.version for one in packages)
    for name in NEEDED if whole else ():
        _checked(name, partial(import_module, name.replace("-", "_")), broken)
    whole = whole and not broken
    extras = tuple(_extra(name, one) for name, one in EXTRAS.items())
    for one in extras:
        for package in one.versions:
            module = EXTRAS[one.name].packages[package]
            system = os.environ.get("MUJOCO_GL") if "mujoco" in package else None
            part = f"{package} with MUJOCO_GL={system}" if system else package
            _checked(part, partial(import_module, module), broken)
    return Installation(
        whole,
        platform.python_version(),
        f"{platform.system()} {platform.machine()}",
        packages,
        extras,
        cores=_checked("cores", probes["cores"], broken) if whole else None,
        kernels=_checked("kernels", probes["kernels"], broken) if whole else None,
        tools=_tools({one.name for one in extras if one.present}, probes, broken),
        broken=tuple(broken),
    )


def _checked(part: str, check: Callable[[], T], broken: list[Broken]) -> T | None:
    """The result of a check; None, and an entry in `broken`, if it fails."""
    try:
        return check()
    except Exception as error:  # a broken package may raise any error
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        broken.append(Broken(part, printable(reason)))
        return None


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _extra(name: str, extra: Extra) -> InstalledExtra:
    versions = {package: _version(package) for package in extra.packages}
    installed = {package: text for package, text in versions.items() if text}
    return InstalledExtra(name, extra.used_for, len(installed) == len(versions), installed)


def _tools(extras: set[str], probes: Probes, broken: list[Broken]) -> tuple[Tool, ...]:
    chromium = partial(
        _path, "chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"
    )
    tools: tuple[tuple[str, str, Callable[[], str | None] | None], ...] = (
        ("browser", "opening the studio's page", _browser),
        ("Chromium", "the tests of the page", chromium),
        ("H.264 encoder", "videos as MP4", _encoder if "video" in extras else None),
        ("OpenGL", "drawing robots off screen", probes["OpenGL"] if "robot" in extras else None),
        ("display", "`stepwell view`", probes["display"]),
    )
    return tuple(
        Tool(name, what, find and _checked(name, find, broken)) for name, what, find in tools
    )


def _path(*names: str) -> str | None:
    return next((path for name in names if (path := shutil.which(name))), None)


def _browser() -> str | None:
    import webbrowser

    try:
        return getattr(webbrowser.get(), "name", "yes")
    except webbrowser.Error:
        return None


def _encoder() -> str | None:
    try:
        return import_module("av").Codec("libx264", "w").name
    except (ImportError, ValueError):
        return None
