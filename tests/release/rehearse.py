"""A release rehearsed: built, checked, installed on every Python that is here; nothing is uploaded.

`make release`, or `python tests/release/rehearse.py [FOLDER]`, which keeps wheel and sdist there.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from release import trying

ROOT = trying.ROOT
SUPPORTED = [
    found[1]
    for found in re.finditer(
        r'"Programming Language :: Python :: (3\.\d+)"',
        (ROOT / "pyproject.toml").read_text("utf-8"),
    )
]


def pythons() -> dict[str, str]:
    """The first interpreter of each supported version that runs and can make an environment."""
    places = [Path(sys.executable)]
    for version in SUPPORTED:
        named = shutil.which(f"python{version}")
        places += [Path(named)] if named else []
        home = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
        places += sorted((home / "versions").glob(f"{version}.*/bin/python"))
    found: dict[str, str] = {}
    ask = "import sys, venv, ensurepip; print('{}.{}'.format(*sys.version_info))"
    for place in places:
        told = subprocess.run([str(place), "-c", ask], capture_output=True, text=True)
        if told.returncode == 0 and told.stdout.strip() in SUPPORTED:
            found.setdefault(told.stdout.strip(), str(place))
    return dict(sorted(found.items()))


def main() -> int:
    """Rehearse, and say what was tried and what could not be."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "dist")
    here, failed, untried = pythons(), list[str](), list[str]()
    print(f"Python here: {', '.join(here) or 'none'}")
    # A compiler that nobody waits for may still write there at the end.
    with tempfile.TemporaryDirectory(prefix="stepwell-", ignore_cleanup_errors=True) as draft:
        files = trying.build(Path(draft))
        for name, python in here.items():
            for extra in ("", *trying.CHECKS, "all"):
                label = f"Python {name}, {extra or 'core alone'}"
                try:
                    kernels = Path(draft, f"kernels-{name}")
                    size = trying.tried(files[0], extra, python, kernels)
                    print(f"{label}: {size}", flush=True)
                except trying.CannotInstall as why:
                    untried.append(f"{label}: {why}")
                except AssertionError as why:
                    failed.append(f"{label}: {why}")
                    print(f"{label}: FAILED", flush=True)
        folder.mkdir(parents=True, exist_ok=True)
        kept = [Path(shutil.copy(file, folder)) for file in files]
    absent = [version for version in SUPPORTED if version not in here]
    untried += [f"Python {version}: not on this machine" for version in absent]
    untried += [f"{system}: this is {sys.platform}" for system in _other_systems()]
    print("\nCould not be tried:", *untried, sep="\n  ")
    for file in kept:
        print(f"sha256 {hashlib.sha256(file.read_bytes()).hexdigest()}  {file}")
    if failed:
        print("\nFAILED:", *failed, sep="\n  ")
        return 1
    print("Nothing was uploaded. docs/releasing.md says what comes next.")
    return 0


def _other_systems() -> list[str]:
    known = {"linux": "Linux", "darwin": "macOS", "win32": "Windows"}
    return [name for system, name in known.items() if system != sys.platform]


if __name__ == "__main__":
    sys.exit(main())
