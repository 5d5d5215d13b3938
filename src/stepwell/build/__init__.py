"""Solid parts of a mechanism, and the files for cutting and assembling them."""

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from stepwell.base import late

if TYPE_CHECKING:
    from stepwell.build.build_file import (
        BuildFile,
        build_presets,
        dumps_build_file,
        load_build_file,
        loads_build_file,
        preset_text,
    )
    from stepwell.build.builds import BandUse, Build, build
    from stepwell.build.contour import Contour
    from stepwell.build.exports.folder import FileOptions, build_files, draft_comment
    from stepwell.build.exports.svg import contour_path
    from stepwell.build.layouts import BandPath, Layout, layout
    from stepwell.build.limits import ExceededLimit
    from stepwell.build.part import Hole, Part
    from stepwell.build.plates import Fastener
    from stepwell.build.robots.hopper_parts import HopperParts, ImpactLoad
    from stepwell.build.robots.robot_builds import RobotBuild
    from stepwell.build.robots.robot_layout import RobotLayout, robot_layout
    from stepwell.build.robots.robot_sweep import RobotOverlap, robot_sweep
    from stepwell.build.sweeps import Clearance, Collision, MotionSweep, sweep
    from stepwell.build.tolerances import build_yield, tolerances_of

__all__ = [
    "BandPath",
    "BandUse",
    "Build",
    "BuildFile",
    "Clearance",
    "Collision",
    "Contour",
    "Fastener",
    "FileOptions",
    "ExceededLimit",
    "Hole",
    "HopperParts",
    "ImpactLoad",
    "Layout",
    "Part",
    "MotionSweep",
    "RobotBuild",
    "RobotLayout",
    "RobotOverlap",
    "build",
    "build_files",
    "build_presets",
    "build_yield",
    "contour_path",
    "draft_comment",
    "dumps_build_file",
    "layout",
    "load_build_file",
    "loads_build_file",
    "preset_text",
    "robot_layout",
    "robot_sweep",
    "sweep",
    "tolerances_of",
]


class _CallablePackage(ModuleType):
    """A module that can be called, since the package and its function share a name."""

    def __call__(self, *args: Any, **kwargs: Any) -> "Build | RobotBuild":
        return self.build(*args, **kwargs)


sys.modules[__name__].__class__ = _CallablePackage

_LATE = {
    "build_file": (
        "BuildFile",
        "build_presets",
        "dumps_build_file",
        "load_build_file",
        "loads_build_file",
        "preset_text",
    ),
    "builds": ("BandUse", "Build", "build"),
    "contour": ("Contour",),
    "exports.folder": ("FileOptions", "build_files", "draft_comment"),
    "exports.svg": ("contour_path",),
    "layouts": ("BandPath", "Layout", "layout"),
    "limits": ("ExceededLimit",),
    "part": ("Hole", "Part"),
    "plates": ("Fastener",),
    "robots.hopper_parts": ("HopperParts", "ImpactLoad"),
    "robots.robot_builds": ("RobotBuild",),
    "robots.robot_layout": ("RobotLayout", "robot_layout"),
    "robots.robot_sweep": ("RobotOverlap", "robot_sweep"),
    "sweeps": ("Clearance", "Collision", "MotionSweep", "sweep"),
    "tolerances": ("build_yield", "tolerances_of"),
}


__getattr__, __dir__ = late(__name__, _LATE, __all__)
