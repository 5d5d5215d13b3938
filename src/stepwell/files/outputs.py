"""The names of all files that each command may write into the folder of --out."""

from __future__ import annotations

from types import MappingProxyType


def pictures(*names: str) -> tuple[str, ...]:
    """The files of figures, each by its name."""
    return tuple(f"{name}{suffix}" for name in names for suffix in (".png", ".svg"))


_DESIGN, _ROBOT = "design.toml", "robot.toml"
OUTPUTS: MappingProxyType[str, tuple[str, ...]] = MappingProxyType(
    {
        "run": (
            _DESIGN,
            "path.csv",
            "result.json",
            "report.html",
            *pictures("mechanism", "landscape", "force-stroke", "travel-stroke"),
        ),
        "map": ("map.nc", "map.json", "boundaries.csv", *pictures("map")),
        "program": (_DESIGN, "program.csv", "program.json", *pictures("program")),
        "design": (_DESIGN, "design.json", "yield.csv", *pictures("force-plane")),
        "yield": (
            _DESIGN,
            "yield.json",
            "yield.csv",
            "survival.json",
            *pictures("yield", "force-plane"),
        ),
        "reprogram": (_DESIGN, "reprogram.json", "way.csv"),
        "robot show": (_ROBOT, "robot.json", *pictures("robot", "prediction")),
        "robot sweep": ("sweep.csv", "sweep.nc", "sweep.json", *pictures("sweep")),
        "walk": (
            _ROBOT,
            "walk.json",
            "walk.nc",
            "walk.mp4",
            "walk.gif",
            *pictures("gait", "trajectory", "contacts"),
        ),
        "maze": (
            _ROBOT,
            "arena.toml",
            "maze.json",
            "walk.nc",
            "maze.mp4",
            "maze.gif",
            *pictures("maze", "timeline"),
        ),
        "lab read": ("recordings.csv", "recordings.nc", "recordings.json"),
        "lab band": ("band.toml", "band.json", *pictures("laws")),
        "lab compare": ("compare.json", "curves.csv", *pictures("forces", "energies", "pairs")),
        "lab calibrate": (
            "band.toml",
            "calibration.json",
            "calibration.nc",
            *pictures("calibration"),
        ),
    }
)
