"""The simulator, or one line that says how to get it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from threading import Lock
from typing import Any, TypeAlias

from stepwell.base import need

# What type checkers can see of MuJoCo's compiled modules is not enough to check against.
Model: TypeAlias = Any  # mujoco.MjModel
Spec: TypeAlias = Any  # mujoco.MjSpec


def _simulator() -> Any:
    """MuJoCo, which brings what draws along: nothing here draws, so that may be broken."""
    try:
        return import_module("mujoco")
    except Exception:
        wanted = os.environ.get("MUJOCO_GL")
        if wanted is None:
            raise
        os.environ["MUJOCO_GL"] = "disable"  # read once, as the module opens
        try:
            return import_module("mujoco")
        finally:
            os.environ["MUJOCO_GL"] = wanted


need("robot")
mujoco: Any = _simulator()
rollout: Any = import_module("mujoco.rollout")

__all__ = ["Model", "Spec", "mujoco", "quietly", "rollout"]


_lock = Lock()
_quiet: list[Any] = []  # what stood before, once for every run in progress


@contextmanager
def quietly() -> Iterator[None]:
    """Keep MuJoCo's warnings out of a log file in the user's folder: a run tells them itself."""
    # There is one place for all threads, so the last run to end puts back what was there.
    with _lock:
        _quiet.append(_quiet[0] if _quiet else mujoco.get_mju_user_warning())
        mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        with _lock:
            before = _quiet.pop()
            if not _quiet:
                mujoco.set_mju_user_warning(before)
