"""Names of all files that each command may write into the folder of --out."""

from pathlib import Path
from types import MappingProxyType


def pictures(*names: str) -> tuple[str, ...]:
    """File names of figures."""
    return tuple(f"{name}{suffix}" for name in names for suffix in (".png", ".svg"))


# Of every command except one with another page, and one for other programs.
_PAGE, _WITHOUT_PAGE = "report.html", ("demo", "export")
# By command: files, and figures by their names.
_OF_COMMANDS = {
    "paper": ("claims.json", "fig1 fig2 fig2c fig3 fig4 robot-tornado"),
    "demo": (
        "index.html leg.toml leg-reversed.toml wish.toml fingers.toml robot.toml "
        "robot-turning.toml robot-antennas.toml",
        "",
    ),
    "run": (
        "design.toml path.csv result.json",
        "mechanism landscape force-stroke travel-stroke element-curves margins around yield",
    ),
    "map": ("map.nc map.json boundaries.csv", "map"),
    "program": ("design.toml program.csv program.json machine.json", "program"),
    "design": ("design.toml design.json yield.csv", "holes force-plane"),
    # The folders parts, sheets and template have files of their own names.
    "build": (
        "design.toml build.toml build.json parts.csv bands.csv coupon.dxf coupon.svg coupon.txt "
        "guide.html guide.pdf template-A4.pdf template-letter.pdf",
        "layers parts",
    ),
    "check": ("design.toml copy.toml check.json", ""),
    "yield": ("design.toml yield.json yield.csv survival.json", "yield force-plane"),
    "reprogram": ("design.toml reprogram.json way.csv", ""),
    "robot show": ("robot.toml robot.json", "robot prediction"),
    "robot sweep": ("sweep.csv sweep.nc sweep.json", "sweep"),
    "sweep report": ("study.csv study.json", "outcomes influences"),
    "atlas show": ("atlas.json", "graph_classes"),
    "compile": ("behaviour.toml robot.toml compile.json", "gait-plane robot"),
    "walk": (
        "robot.toml walk.json walk.nc walk.mp4 walk.gif still.png",
        "gait trajectory contacts",
    ),
    "maze": (
        "robot.toml arena.toml maze.json walk.nc maze.mp4 maze.gif still.png",
        "maze timeline",
    ),
    "jump": ("design.toml jump.json jump.csv jump.mp4 jump.gif", "energy-flow flight"),
    # The folder meshes has files of its own names.
    "export": ("robot.toml arena.toml robot.xml robot.sdf walk.py", ""),
    "lab read": ("recordings.csv recordings.nc recordings.parquet recordings.json", "recordings"),
    "lab band": ("band.toml band.json", "laws"),
    "lab element": ("element.csv design.toml element.json", "element"),
    "lab compare": ("compare.json curves.csv", "forces energies pairs chains"),
    "lab as-built": ("built.toml moved.toml built.json", ""),
    "lab calibrate": (
        "band.toml pair.toml rig.toml calibration.json calibration.nc",
        "calibration",
    ),
}
# Extra that is necessary for a file, by suffix. An MP4 is left out without its encoder.
_EXTRAS = {".png": "figures", ".svg": "figures", ".gif": "figures", ".nc": "tables"}
OUTPUTS: MappingProxyType[str, tuple[str, ...]] = MappingProxyType(
    {
        command: (
            *files.split(),
            *([] if command in _WITHOUT_PAGE else [_PAGE]),
            *pictures(*figures.split()),
        )
        for command, (files, figures) in _OF_COMMANDS.items()
    }
)


def extras_of(command: str) -> tuple[str, ...]:
    """Extras that are necessary for the files of a command, such as ("figures",)."""
    ends = [Path(name).suffix for name in OUTPUTS[command]]
    return tuple(dict.fromkeys(_EXTRAS[end] for end in sorted(ends) if end in _EXTRAS))
