"""`stepwell doctor`: what is installed, kept and missing."""

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from accounts.schemas import violations
from stepwell.accounts import account, card, page
from stepwell.base import install, installation, installed
from stepwell.base.extras import EXTRAS
from stepwell.cli import about
from stepwell.kernels import store

ROOT = Path(__file__).resolve().parents[2]


def test_it_says_what_is_here_and_ends_with_0(stepwell):
    result = stepwell("doctor", "--full")
    assert result.exit_code == 0
    assert "All packages that Stepwell needs are installed" in result.stdout
    for name in (*installed.NEEDED, *EXTRAS, "H.264 encoder", "OpenGL"):
        assert re.search(rf"^{re.escape(name)} ", result.stdout, re.M), name


@pytest.mark.slow
def test_the_json_says_all_that_the_screen_says(stepwell):
    record = json.loads(stepwell("doctor", "--json").stdout)
    assert violations(record) == []
    shown = " ".join(stepwell("doctor", "--full").stdout.split())
    for one in record["packages"]:
        assert f"{one['name']} {one['version']}" in shown
    assert f"{record['kernels']['compiled']} compiled" in shown
    assert record["ok"] is True


def test_it_knows_the_packages_and_extras_of_the_project():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    bare = [re.split(r"[><=\[]", text)[0] for text in project["dependencies"]]
    assert sorted(installed.NEEDED) == sorted(bare)
    extras = project["optional-dependencies"]
    assert extras.keys() - {"all", "docs", "dev"} == EXTRAS.keys()
    for name, extra in EXTRAS.items():
        own = [text for text in extras[name] if not text.startswith("stepwell[")]
        assert [re.split(r"[><=\[]", text)[0] for text in own] == list(extra.packages)
    # Packages for a GPU, and the large kernel of STEP files, are installed by name.
    own = sorted(EXTRAS.keys() - {"gpu", "step"})
    assert extras["all"] == [f"stepwell[{','.join(own)}]"]


def test_a_missing_extra_comes_with_the_command_that_adds_it(stepwell, monkeypatch):
    known = installed._version
    monkeypatch.setattr(installed, "_version", lambda name: None if name == "av" else known(name))
    result = stepwell("doctor", "--full")
    assert result.exit_code == 0
    assert install("video") in result.stdout
    assert re.search(r"^H\.264 encoder .* no$", result.stdout, re.M)


def test_a_missing_package_is_named_and_ends_with_1(stepwell, monkeypatch):
    known = installed._version
    monkeypatch.setattr(
        installed, "_version", lambda name: None if name == "scipy" else known(name)
    )
    result = stepwell("doctor", "--full")
    assert result.exit_code == 1
    assert re.search(r"^Missing +scipy$", result.stdout, re.M)
    assert "pip install" in result.stdout


def test_what_is_broken_is_listed_with_the_reason_and_the_rest_is_still_looked_at(
    stepwell, monkeypatch
):
    kept = installed.import_module

    def broken(name):
        if name in ("mujoco", "networkx", "av"):
            raise AttributeError(f"{name} has\nno such thing")
        return kept(name)

    def failing():
        raise RuntimeError("no kernels")

    monkeypatch.setattr(installed, "import_module", broken)
    monkeypatch.setattr(about, "_opengl", failing)
    monkeypatch.setenv("MUJOCO_GL", "bogus")
    result = stepwell("doctor", "--full")
    assert result.exit_code == 1  # for networkx, without which nothing goes
    assert "Packages are broken" in result.stdout
    record = json.loads(stepwell("doctor", "--json").stdout)
    assert [one["part"] for one in record["broken"]] == [
        "networkx", "mujoco with MUJOCO_GL=bogus", "av", "H.264 encoder", "OpenGL",
    ]  # fmt: skip
    assert record["broken"][0]["reason"] == "AttributeError: networkx has no such thing"
    monkeypatch.setattr(installed, "import_module", kept)
    assert stepwell("doctor", "--full").exit_code == 0  # drawing is no more than an extra


def test_an_installation_without_packages_keeps_to_the_schema_and_has_every_form(monkeypatch):
    monkeypatch.setattr(installed, "_version", lambda name: None)
    names: tuple[str, ...] = ("cores", "kernels", "OpenGL", "display")
    probes: dict[str, Callable[[], Any]] = dict.fromkeys(names, lambda: None)
    listed = account(installation(probes))
    assert violations(listed.record) == []
    assert listed.record["packages"][0]["version"] is None and listed.record["kernels"] is None
    for form in (card(listed), page(listed)):
        assert "Packages are missing" in form and "numpy" in form


@pytest.mark.slow
def test_what_is_missing_can_be_reported_without_any_package():
    # What the command imports before it examines anything.
    program = (
        "import sys, stepwell.cli.about;"
        f"print(*{{*sys.modules}} & {{*{installed.NEEDED}}} - {{'typer', 'rich', 'pydantic'}})"
    )
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ran.stdout.strip(), ran.returncode) == ("", 0), ran


@pytest.mark.parametrize("writable", [True, False])
def test_it_says_whether_compiled_kernels_can_be_kept(tmp_path, monkeypatch, writable):
    place = tmp_path / "cache"
    if not writable:
        place.write_text("a file where a folder should be", "utf-8")
    monkeypatch.setattr(store, "_GIVEN", [])
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(place))
    store.folder.cache_clear()
    try:
        if writable:
            store.write("advance-1-2", b"machine code")
        folder = store.kept()
    finally:
        store.folder.cache_clear()
    assert folder.folder == place / "stepwell"
    assert (folder.writable, folder.compiled) == (writable, int(writable))
    assert (folder.size > 0) == writable
