"""`stepwell doctor`: what is installed, what is kept, what is missing here."""

from __future__ import annotations

import os
import platform
import shutil
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any, TypeVar

import typer

from stepwell.base import EXTRAS, Column, Extra, Quantity, Schema, __version__, printable
from stepwell.cli.options import Json
from stepwell.cli.screen import (
    FAILED,
    finish,
    has_display,
    show_facts,
    show_lines,
    show_records,
    show_verbatim,
)

T = TypeVar("T")

# As pyproject.toml has them, of which a test makes sure; a checkout that is not installed knows
# nothing of it. What extras bring is in `base`.
NEEDED = (
    "filelock", "networkx", "numba", "numpy", "platformdirs", "pydantic", "rich", "scipy",
    "tomli-w", "typer",
)  # fmt: skip
_PACKAGE: Schema = (
    Quantity("name", head="package"),
    Quantity("version", head="version", none="missing"),
)
_EXTRA: Schema = (
    Quantity("name", head="extra"),
    Quantity("used_for", head="used for"),
    Quantity("present"),
    Quantity("install"),
)
_TOOL: Schema = (
    Quantity("name", head="tool"),
    Quantity("used_for", head="used for"),
    Quantity("found", head="here", none="no"),
)
_VERDICTS = ("packages are broken", "packages are missing")
_BROKEN: Schema = (Quantity("part", head="broken"), Quantity("reason", head="why"))


def doctor(as_json: Json = False) -> None:
    """Say what is installed, what is kept and what is missing.

    Packages and extras with the command that adds each, compiled kernels and where they are kept,
    browser, video encoder and OpenGL, cores. What is there and does not work is listed with the
    reason. It ends with 0 where all that Stepwell needs is there, extras or not.
    """
    record = examined()
    finish(record, _show, as_json)
    if not record["ok"]:
        raise typer.Exit(FAILED)


def examined() -> dict[str, Any]:
    """What `stepwell doctor --json` prints."""
    broken: list[dict[str, str]] = []
    packages = [{"name": name, "version": _version(name)} for name in NEEDED]
    whole = all(one["version"] for one in packages)
    for name in NEEDED if whole else ():
        _checked(name, partial(import_module, name.replace("-", "_")), broken)
    whole = whole and not broken
    extras = [_extra(name, one) for name, one in EXTRAS.items()]
    for one in extras:
        for package in one["versions"]:
            module = EXTRAS[one["name"]].packages[package]
            system = os.environ.get("MUJOCO_GL") if "mujoco" in package else None
            part = f"{package} with MUJOCO_GL={system}" if system else package
            _checked(part, partial(import_module, module), broken)
    return {
        "schema": "stepwell.doctor/1",
        "stepwell": __version__,
        "ok": whole,
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "cores": _checked("cores", _cores, broken) if whole else None,
        "packages": packages,
        "extras": extras,
        "kernels": _checked("kernels", _kernels, broken) if whole else None,
        "tools": _tools({one["name"] for one in extras if one["present"]}, broken),
        "broken": broken,
    }


def _checked(part: str, check: Callable[[], T], broken: list[dict[str, str]]) -> T | None:
    """What a check finds; None, and a line among what is broken, where it fails."""
    try:
        return check()
    except Exception as error:  # whatever a package that is broken raises
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        broken.append({"part": part, "reason": printable(reason)})
        return None


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _extra(name: str, extra: Extra) -> dict[str, Any]:
    found = {package: _version(package) for package in extra.packages}
    return {
        "name": name,
        "used_for": extra.used_for,
        "present": all(found.values()),
        "versions": {package: told for package, told in found.items() if told},
        "install": f"pip install 'stepwell[{name}]'",
    }


def _cores() -> int:
    from stepwell.kernels import cores

    return cores()


def _kernels() -> dict[str, Any]:
    from stepwell.kernels import kept

    found = kept()
    return {
        "folder": str(found.folder),
        "writable": found.writable,
        "compiled": found.compiled,
        "size_MB": found.size / 1e6,
    }


def _tools(extras: set[str], broken: list[dict[str, str]]) -> list[dict[str, Any]]:
    chromium = partial(_path, "chromium", "chromium-browser", "google-chrome")
    tools: tuple[tuple[str, str, Callable[[], str | None] | None], ...] = (
        ("browser", "opening the studio's page", _browser),
        ("Chromium", "the tests of the page", chromium),
        ("H.264 encoder", "videos as MP4", _encoder if "video" in extras else None),
        ("OpenGL", "drawing robots off screen", _opengl if "robot" in extras else None),
        ("display", "`stepwell view`", _display),
    )
    return [
        {"name": name, "used_for": what, "found": find and _checked(name, find, broken)}
        for name, what, find in tools
    ]


def _path(*names: str) -> str | None:
    return next((found for name in names if (found := shutil.which(name))), None)


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


def _opengl() -> str | None:
    from stepwell.simulation import drawing_system

    return drawing_system()


def _display() -> str | None:
    return "yes" if has_display() else None


def _show(record: dict[str, Any]) -> None:
    kernels = record["kernels"]
    missing = [one["name"] for one in record["packages"] if one["version"] is None]
    found = {
        "Verdict": "all that Stepwell needs is here" if record["ok"] else _VERDICTS[bool(missing)],
        "Missing": ", ".join(missing),
        "Repair": not record["ok"] and "pip install --upgrade --force-reinstall stepwell",
        "Stepwell": f"{record['stepwell']}, Python {record['python']}, {record['system']}",
        "Cores": record["cores"],
        "Kernels": kernels and f"{kernels['compiled']} compiled, {kernels['size_MB']:.0f} MB",
        "Kept in": kernels and kernels["folder"],
        "Writable": kernels
        and ("yes" if kernels["writable"] else "no: name a folder with NUMBA_CACHE_DIR"),
    }
    show_facts({"title": ""}, found, 10)
    show_records("Packages", _PACKAGE, record["packages"], most=None)
    name, used_for, *_ = _EXTRA
    here = Column("here", lambda one: _versions(one) if one["present"] else "no")
    show_records("Extras", [name, used_for, here], record["extras"], most=None)
    lacking = [one["install"] for one in record["extras"] if not one["present"]]
    if lacking:
        show_lines("", "What is missing comes with:")
        show_verbatim("\n".join(lacking))
    show_records("Tools", _TOOL, record["tools"], most=None)
    show_records("Broken", _BROKEN, record["broken"], most=None)
    if missing:
        show_lines("", "Nothing else was looked at before the packages are there.")


def _versions(extra: Any) -> str:
    return ", ".join(f"{name} {told}" for name, told in extra["versions"].items())
