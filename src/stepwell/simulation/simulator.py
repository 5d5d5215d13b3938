"""Import of MuJoCo, or one line on its installation; settings of the simulation."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from threading import Lock
from typing import Any, TypeAlias

from stepwell.base import ByValue, InputError, check, need


class Integrator(StrEnum):
    """MuJoCo's integrators."""

    EULER = "euler"
    IMPLICIT = "implicit"
    IMPLICIT_FAST = "implicitfast"
    RK4 = "rk4"


class Linkage(StrEnum):
    """Model of levers and links."""

    RODS = "rods"
    HINGES = "hinges"


@dataclass(frozen=True, slots=True, eq=False)
class Settings(ByValue):
    """Numerical parameters of the simulation; a `ValueError` refuses values out of range.

    Args:
        time_step: [s], > 0.
        integrator: one of MuJoCo's.
        contact_time: time constant of contacts, stops and rods [s]; at least twice the time step.
        sample: time between recorded samples [s]; at least the time step.
        settle: time to come to rest before the first cycle [s], >= 0.
        linkage: rods of fixed length between points (fast), or every lever and link a hinged
            body (slower; the check on the former).
    """

    time_step: float = 1e-3
    integrator: Integrator = Integrator.IMPLICIT_FAST
    contact_time: float = 2e-3
    sample: float = 0.02
    settle: float = 0.5
    linkage: Linkage = Linkage.RODS

    def __post_init__(self):
        check.fields(self, check.positive, time_step="s", contact_time="s", sample="s")
        check.fields(self, check.not_negative, settle="s")
        check.fields(self, check.one_of, integrator=Integrator, linkage=Linkage)
        if self.contact_time < 2 * self.time_step:
            raise InputError(
                f"contact_time = {self.contact_time:g} s: must be >= {2 * self.time_step:g} s, "
                f"twice the time step, or contacts ring."
            )
        if self.sample < self.time_step:
            raise InputError(
                f"sample = {self.sample:g} s: must be >= {self.time_step:g} s, the time step."
            )


# MuJoCo's compiled modules have too few types to check against.
Model: TypeAlias = Any  # mujoco.MjModel
Spec: TypeAlias = Any  # mujoco.MjSpec


def _simulator() -> Any:
    """Import MuJoCo, also if its graphics system is broken, since nothing here draws."""
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


_lock = Lock()
_quiet: list[Any] = []  # the previous handler, once for every run in progress


@contextmanager
def quietly() -> Iterator[None]:
    """Keep MuJoCo's warnings out of a log file in the user's folder: runs report them."""
    # All threads share one handler, so the last run to end restores it.
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
