"""The wheel in a fresh environment: the core alone, what it says it lacks, and all of it."""

import os
from functools import partial
from pathlib import Path

import pytest

from release import trying
from sizes import SIZE
from stepwell.kernels import store

REQUIRED = os.environ.get("STEPWELL_REQUIRE_INSTALL")


@pytest.mark.slow
def test_the_core_is_small_and_says_what_it_lacks_and_extras_can_be_added(
    built: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    # One environment, as a user has it: first the core, then everything on top of it.
    # In the quick run what the wheel asks for is linked from here. `make release` fetches it, and
    # tries each extra alone, compiled, on every Python that is here.
    # Kernels are those that the other tests run; `make release` compiles them anew.
    kernels = store.folder()
    assert kernels is not None
    env = trying.Fresh.made(tmp_path / "env", kernels.parent)
    install = env.link if SIZE == "ci" else partial(env.install, compiled=False)
    try:
        install(str(built[0]))
    except trying.CannotInstall as why:
        if REQUIRED:
            raise
        pytest.skip(f"SKIPPED, pip cannot fetch packages here: {why}")
    sizes = env.sizes()
    with capsys.disabled():
        print(f"\nThe core takes, not compiled, {trying.told(sizes)}")
    assert sum(sizes.values()) <= trying.MOST_UNCOMPILED_MB, trying.told(sizes)
    assert not sizes.keys() & {"matplotlib", "pil", "pillow", "pandas", "xarray", "mujoco"}
    trying.core(env)
    trying.without(env, *trying.CHECKS)

    install(f"{built[0]}[all]")
    # A map and a walk draw, label and simulate; each extra by itself is rehearsed. That all of what
    # is linked opens tests/cli finds here, with `doctor`.
    if SIZE == "ci":
        trying.map_and_walk(env)
        return
    with capsys.disabled():
        print(f"With all extras, not compiled, {trying.told(env.sizes())}")
    trying.everything(env)
    trying.studio(env)
