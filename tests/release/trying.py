"""Wheel and sdist built, installed into fresh environments, and used there as a user would."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement

from stepwell.base import install

ROOT = Path(__file__).resolve().parents[2]
# What pip and venv bring is no part of what Stepwell asks for.
NOT_OURS = ("pip", "setuptools", "pkg_resources", "_distutils_hack", "distutils-precedence.pth")
# The compiled core, llvmlite, Numba, NumPy and SciPy, takes nine tenths of it.
MOST_MB = 500
# The same without what Python compiles of it, which takes as long as all that is installed.
MOST_UNCOMPILED_MB = 410


class CannotInstall(Exception):
    """pip could not fetch packages here; the text is what it said."""


def build(folder: Path) -> tuple[Path, Path]:
    """Build wheel and sdist with the pinned builder, with no network and no isolation."""
    told = subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-d", str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert told.returncode == 0, told.stderr
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    return wheel, sdist


def locked() -> str:
    """The lock's versions as constraints: without hashes, which would be asked of the wheel too."""
    lines = (ROOT / "requirements.lock").read_text("utf-8").splitlines()
    pinned = (re.match(r"([a-z0-9][\w.-]*==\S+(?: ;[^\\]*)?)", line) for line in lines)
    return "\n".join(found[1].strip() for found in pinned if found) + "\n"


# Codes and words of commands that are given as JSON, one after another.
EACH = """
import json, sys
from typer.testing import CliRunner
from stepwell.cli import app
told = []
for words in json.loads(sys.argv[1]):
    done = CliRunner().invoke(app, words)
    told.append((done.exit_code, done.output))
print(json.dumps(told))
"""


@dataclass(frozen=True)
class Fresh:
    """A virtual environment of its own."""

    folder: Path
    kernels: Path

    @classmethod
    def made(cls, folder: Path, kernels: Path, python: str = sys.executable) -> Fresh:
        """Make it with an interpreter; what it compiles is kept in a folder beside it.

        Without a pip of its own, which takes as long as all of ours: this one's installs there.
        """
        words = [python, "-m", "venv", "--without-pip", str(folder)]
        subprocess.run(words, check=True, capture_output=True)
        return cls(folder, kernels)

    @property
    def python(self) -> Path:
        return self.folder / ("Scripts" if os.name == "nt" else "bin") / "python"

    @property
    def environment(self) -> dict[str, str]:
        """Nothing of this checkout, and nothing that it compiled."""
        own = {"NUMBA_CACHE_DIR": str(self.kernels), "COLUMNS": "250"}
        kept = {name: text for name, text in os.environ.items() if not _of_tests(name)}
        return kept | own

    def install(self, what: str, *, compiled: bool = True) -> None:
        """Install it with what it needs, in the versions of the lock.

        Compiled as people have it, or without, which is quicker and smaller.
        """
        limits = self.folder / "constraints.txt"
        limits.write_text(locked(), "utf-8")
        pip = [sys.executable, "-m", "pip", "--python", str(self.python), "install"]
        pip += ["--disable-pip-version-check", "--quiet"]
        pip += [] if compiled else ["--no-compile"]
        told = subprocess.run(
            [*pip, "--only-binary", ":all:", "--constraint", str(limits), what],
            capture_output=True,
            text=True,
            env=self.environment,
            cwd=self.folder,
        )
        if told.returncode:
            raise CannotInstall(told.stderr.strip().splitlines()[-1])

    def link(self, what: str) -> None:
        """Install a wheel; link what it needs, by what it says itself, from this environment.

        In a fraction of the time, and in the versions of the lock, which are those here.

        Args:
            what: the wheel's file, with extras in brackets where they are wanted.
        """
        name, end, extras = what.partition(".whl")
        target = Path(self.run("-c", _PACKAGES).strip())
        if not (target / "stepwell").exists():
            # What pip does with a wheel but for its commands; `install` asks pip itself.
            with zipfile.ZipFile(name + end) as wheel:
                wheel.extractall(target)
        (asking,) = metadata.distributions(name="stepwell", path=[str(target)])
        for needed in _needed(asking, tuple(extras.strip("[]").split(","))):
            # Commands lie outside of the folder of packages, and are left out.
            for top in {file.parts[0] for file in needed.files or ()} - {"..", "__pycache__"}:
                source, link = Path(str(needed.locate_file(top))), target / top
                if source.exists() and not link.exists():
                    link.symlink_to(source)

    def run(self, *words: str, code: int = 0) -> str:
        """What a command prints on both streams; it must end with this code."""
        told = subprocess.run(
            [str(self.python), *words],
            capture_output=True,
            text=True,
            env=self.environment,
            cwd=self.folder,
        )
        said = told.stdout + told.stderr
        assert told.returncode == code, f"{' '.join(words)} ended with {told.returncode}:\n{said}"
        assert "Traceback" not in said, said
        return said

    def stepwell(self, *words: str, code: int = 0) -> str:
        """What the command `stepwell` prints."""
        return self.run("-m", "stepwell", *words, code=code)

    def each(self, *commands: Sequence[str], codes: Sequence[int] = (0,)) -> list[str]:
        """What each of several commands prints, run by one process.

        Starting takes most of the time of a small one.

        Args:
            commands: the commands.
            codes: what each must end with; the last is that of all that follow.
        """
        told: list[tuple[int, str]] = json.loads(self.run("-c", EACH, json.dumps(commands)))
        for k, (words, (found, said)) in enumerate(zip(commands, told, strict=True)):
            code = codes[min(k, len(codes) - 1)]
            assert found == code, f"{' '.join(words)} ended with {found}:\n{said}"
            assert "Traceback" not in said, said
        return [said for _, said in told]

    def sizes(self) -> dict[str, float]:
        """What each package takes on the disk [MB], the largest first, compiled files included."""
        packages = Path(self.run("-c", _PACKAGES).strip())
        found: dict[str, int] = {}
        # With what is linked, whose compiled files are not counted.
        for folder, _, names in os.walk(packages, followlinks=True):
            for file in (Path(folder, name) for name in names):
                name = file.relative_to(packages).parts[0]
                if name.startswith(NOT_OURS) or _is_linked_bytecode(packages / name, file):
                    continue
                # numpy.libs is NumPy's, and so is numpy-2.4.dist-info.
                own = re.split(r"[.-]", name)[0].lower()
                found[own] = found.get(own, 0) + file.stat().st_size
        return {name: found[name] / 1e6 for name in sorted(found, key=lambda one: -found[one])}


# Prints where packages of an environment lie.
_PACKAGES = "import sysconfig; print(sysconfig.get_path('purelib'))"


def _needed(asking: metadata.Distribution, extras: tuple[str, ...]) -> list[metadata.Distribution]:
    """All that a distribution asks for with some of its extras, as it is here, and so on."""
    found: dict[str, metadata.Distribution] = {}
    seen: set[tuple[str, tuple[str, ...]]] = set()
    left = [(asking, extras)]
    while left:
        one, wanted = left.pop()
        if (one.name, wanted) in seen:
            continue
        seen.add((one.name, wanted))
        for text in one.requires or ():
            need = Requirement(text)
            if need.marker and not any(need.marker.evaluate({"extra": name}) for name in wanted):
                continue
            # An extra of ours may ask for others of ours, of the wheel and not of this checkout.
            there = asking if need.name == asking.name else metadata.distribution(need.name)
            assert need.specifier.contains(there.version, prereleases=True), (text, there.version)
            left.append((there, tuple(sorted(need.extras)) or ("",)))
            if there is not asking:
                found[there.name] = there
    return list(found.values())


def _is_linked_bytecode(package: Path, file: Path) -> bool:
    return package.is_symlink() and file.suffix == ".pyc"


def _of_tests(name: str) -> bool:
    return name.startswith(("STEPWELL_", "PYTEST_", "COV_", "PYTHONPATH", "VIRTUAL_ENV"))


def told(sizes: dict[str, float], most: int = 8) -> str:
    """Sizes in a line."""
    parts = [f"{name} {size:.0f}" for name, size in list(sizes.items())[:most]]
    rest = sum(list(sizes.values())[most:])
    return f"{sum(sizes.values()):.0f} MB: {', '.join(parts)}, the rest {rest:.0f}"


def core(env: Fresh) -> None:
    """All that returns values or stands on the screen; what is missing comes with its command."""
    # Once as people start it; the others in one process.
    assert "00>10>11>01>00" in env.stepwell("run", "preset:paper-forward")
    said = env.each(
        ("run", "preset:paper-forward", "--json"),
        ("graph", "preset:paper-forward"),
        ("graph", "preset:paper-forward", "--out", "graph.graphml"),
        ("program", "preset:finger-selector", "--full"),
        ("design", "00>10>11>01>00", "--samples", "5000"),
        ("yield", "preset:paper-forward", "--samples", "1000"),
        ("replay", "preset:paper-forward"),
    )
    for words, wanted in (
        (said[0], '"sequence"'),
        (said[1], "return-point memory"),
        (said[3], "As it was given."),
        (said[4], "5000"),
        (said[5], "%"),
    ):
        assert wanted in words
    env.run(
        "-c",
        "import stepwell as sw\ncycle = sw.preset('paper-forward').cycle()\n"
        "cycle.path.to_csv('path.csv')\nassert 'stroke_mm' in open('path.csv').readline()",
    )


# What says that it is missing, and by which extra it comes.
LACKS = {
    "figures": [
        ("run", "preset:paper-forward", "--out", "forward"),
        ("graph", "preset:paper-forward", "--out", "graph.svg"),
        ("animate", "preset:paper-forward"),
    ],
    "tables": [("map", "preset:paper-forward"), ("paper",)],
    "robot": [("walk", "robot-forward")],
    "studio": [("studio", "--no-open")],
    "studies": [("sweep", "status", "study.zarr")],
    # These are lacked only where a robot or a study is there.
    "video": [],
    "parquet": [],
    "cluster": [],
    "gpu": [],
    "env": [],
}


def without(env: Fresh, *extras: str) -> None:
    """Every command that lacks an extra ends in one line that says which; `doctor` lists them."""
    lacked = [(extra, words) for extra in extras for words in LACKS[extra]]
    listed, *told = env.each(("doctor", "--full"), *(words for _, words in lacked), codes=(0, 1))
    for extra in extras:
        assert install(extra) in listed
    for (extra, _), said in zip(lacked, told, strict=True):
        assert len(said.splitlines()) == 1, said
        assert install(extra) in said
    assert not (env.folder / "forward").exists()


def figures(env: Fresh) -> None:
    """Folders of figures, drawings and GIFs."""
    env.stepwell("run", "preset:paper-forward", "--out", "run")
    assert (env.folder / "run" / "force-stroke.png").stat().st_size > 1000
    env.stepwell("graph", "preset:paper-forward", "--out", "graph.svg", "--force")
    env.stepwell("animate", "preset:paper-forward", "--seconds", "1", "--fps", "5")
    assert (env.folder / "cycle.gif").read_bytes()[:4] == b"GIF8"


def tables(env: Fresh) -> None:
    """Maps, and what is called to_xarray."""
    places = "--x", "0:20:20", "--y", "-15:15:20"
    assert "clockwise" in env.stepwell("map", "preset:paper-forward", *places)
    env.run(
        "-c",
        "import stepwell as sw\npath = sw.preset('paper-forward').path([0.0, 0.04])\n"
        "assert path.to_xarray().sizes['cell'] == 2",
    )


def robot(env: Fresh) -> None:
    """A walk on the screen."""
    assert "u_max" in env.stepwell("walk", "robot-forward", "--cycles", "1")


_ENCODER = re.compile(r"^H\.264 encoder .*libx264", re.M)


def video(env: Fresh) -> None:
    """The encoder is found; what is drawn needs a robot too."""
    assert _ENCODER.search(env.stepwell("doctor"))


def studio(env: Fresh) -> None:
    """The page is served, and Ctrl-C ends it."""
    words = [str(env.python), "-u", "-m", "stepwell", "studio", "--no-open"]
    process = subprocess.Popen(
        words, stdout=subprocess.PIPE, text=True, env=env.environment, cwd=env.folder
    )
    try:
        assert process.stdout is not None
        lines = iter(process.stdout.readline, "")
        address = next(found[0] for line in lines if (found := re.search(r"http://\S+", line)))
        with urllib.request.urlopen(address, timeout=60) as answer:
            assert b"<html" in answer.read()
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)


def map_and_walk(env: Fresh) -> None:
    """A map in a folder, and a walk on the screen."""
    places = "--x", "0:20:20", "--y", "-15:15:20"
    *_, walked = env.each(
        ("map", "preset:paper-forward", *places, "--out", "map"),
        ("walk", "robot-forward", "--cycles", "1"),
    )
    assert "u_max" in walked
    assert (env.folder / "map" / "map.nc").is_file()


def everything(env: Fresh) -> None:
    """A map and a walk in folders of their own; the encoder of videos is found."""
    places = "--x", "0:20:20", "--y", "-15:15:20"
    *_, listed = env.each(
        ("map", "preset:paper-forward", *places, "--out", "map"),
        ("walk", "robot-forward", "--cycles", "1", "--no-video", "--out", "walk"),
        ("doctor",),
    )
    assert _ENCODER.search(listed)
    assert (env.folder / "map" / "map.nc").is_file()
    assert (env.folder / "walk" / "walk.nc").is_file()


def studies(env: Fresh) -> None:
    """Designs are computed by processes of their own, and the store is read again."""
    varied = "--vary", "outer.q.x=10:20:2", "--workers", "1"
    env.stepwell("sweep", "cycle", "preset:paper-forward", *varied, "--out", "study.zarr")
    env.stepwell("sweep", "export", "study.zarr", "--out", "study.csv")
    assert len((env.folder / "study.csv").read_text().splitlines()) == 3


def parquet(env: Fresh) -> None:
    """A store as Parquet."""
    studies(env)
    env.stepwell("sweep", "export", "study.zarr", "--out", "study.parquet")
    env.run(
        "-c",
        "from pyarrow import parquet\nassert parquet.read_table('study.parquet').num_rows == 2",
    )


def cluster(env: Fresh) -> None:
    """A study on the worker of a scheduler, both of this installation."""
    file = env.folder / "scheduler.json"
    local = ["--no-dashboard", "--scheduler-file", str(file)]
    parts = (
        ("scheduler", ["--host", "127.0.0.1", "--port", "0"]),
        ("worker", ["--nthreads", "1", "--no-nanny", "--local-directory", str(env.folder)]),
    )
    going = [
        subprocess.Popen(
            [str(env.python), "-m", f"distributed.cli.dask_{name}", *local, *more],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env=env.environment,
            cwd=env.folder,
        )
        for name, more in parts
    ]
    try:
        while not file.exists():
            assert all(one.poll() is None for one in going), "no scheduler or no worker begins"
            time.sleep(0.1)
        address = json.loads(file.read_text("utf-8"))["address"]
        varied = "--vary", "outer.q.x=10:20:2", "--scheduler", address
        env.stepwell("sweep", "cycle", "preset:paper-forward", *varied, "--out", "spread.zarr")
    finally:
        for one in going:
            one.kill()
            one.wait()


def gpu(env: Fresh) -> None:
    """MuJoCo Warp goes with the MuJoCo that is there."""
    env.run("-c", "import mujoco, mujoco_warp\nmujoco_warp.put_model")
    assert install("gpu") not in env.stepwell("doctor")


# What each installation must be able to do, besides what the core does.
CHECKS: dict[str, Callable[[Fresh], None]] = {
    "figures": figures,
    "tables": tables,
    "robot": robot,
    "video": video,
    "studio": studio,
    "studies": studies,
    "parquet": parquet,
    "cluster": cluster,
    "gpu": gpu,
}
# Not in `all`, for it is heavy.
_APART = "gpu"


def tried(wheel: Path, extra: str, python: str, kernels: Path) -> str:
    """Install the core, an extra or all into a fresh environment, and use it; its size."""
    with tempfile.TemporaryDirectory(prefix="stepwell-") as folder:
        env = Fresh.made(Path(folder), kernels, python)
        env.install(f"{wheel}[{extra}]" if extra else str(wheel))
        sizes = env.sizes()
        size = told(sizes)
        assert extra or sum(sizes.values()) <= MOST_MB, size
        core(env)
        if not extra:
            without(env, *CHECKS)
        for name, check in CHECKS.items():
            if extra == name or (extra == "all" and name != _APART):
                check(env)
        if extra == "all":
            everything(env)
        return size
