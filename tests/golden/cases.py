"""What is frozen: command lines, with the results that each prints and writes.

A case is an entry of frozen/KIND.json, where KIND is what its name begins with. Its commands run
one after another in one new folder, which holds `given` files. One case of a kind is shown: its
screens and its page are frozen too, in a text of that name beside the JSON.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import typer

from golden.comparing import EXACT, FITTED, SIMULATED, Tolerance
from golden.elements import DESIGNS
from golden.recordings import bands, cells, clip, on_a_rig, rubber, unclear
from stepwell.cli import app
from stepwell.files import preset_text, presets


@dataclass(frozen=True)
class Case:
    """Commands that run in one folder.

    Args:
        name: its kind, a slash and its own name.
        commands: command lines without `stepwell`, run in this order.
        given: texts of files that are there before.
        prepare: makes other files in a folder.
        within: how closely numbers are compared.
        shown: its screens, its page and the words in its figures are frozen too.
        slow: takes about half a second or more, or differs little from a case that does not.
        spare: another case is of its kind, so that it runs with STEPWELL_TESTS=full alone, and
            lists of records in its result are frozen by their sums.
    """

    name: str
    commands: tuple[str, ...]
    given: Mapping[str, str] = field(default_factory=dict)
    prepare: Callable[[Path], None] = lambda folder: None
    within: Tolerance = EXACT
    shown: bool = False
    slow: bool = False
    spare: bool = False

    @property
    def kind(self) -> str:
        return self.name.partition("/")[0]


def commands(group: Any = None, name: str = "") -> Iterator[tuple[str, Any]]:
    """Every command by its name, and what it takes; the groups of them too."""
    group = group or typer.main.get_command(app)
    yield name, group
    for word, command in getattr(group, "commands", {}).items():
        yield from commands(command, f"{name} {word}".strip())


def _one(name: str, command: str, **rest: Any) -> Case:
    """A result in JSON."""
    return Case(name, (f"{command} --json",), **rest)


def _folder(name: str, command: str, **rest: Any) -> Case:
    """A screen, and a folder with the result in JSON, its figures and its page."""
    return Case(name, (f"{command} --out out",), **rest)


_FORWARD = preset_text("paper-forward")
_BACK = "00>01>11>10>00"
_TOLERANCES = (
    "--anchor 0.5 --stiffness-tolerance 4 --rest-length-tolerance 3 --lever-tolerance 0.2"
    " --friction 0.01"
)
_QUICK = {"paper-forward"}
# Of a cell, chains, other drives, friction, an element and a program; the others differ from them
# in their numbers.
_KINDS = {
    "paper-forward",
    "paper-cell-0-m15",
    "three-wave",
    "force-control",
    "used-before",
    "compliant-actuator",
    "friction",
    "kresling",
    "paper-identical",
}
# What is written hangs on whether there is one cell, on the drive and on the program.
_WRITTEN = {"paper-cell-0-m15", "three-wave", "force-control"}

# Few choices, one of which is the best of the preset.
_TABLE = """
row = [
    { contact = "free", motion = "forward" },
    { contact = "left", motion = "turn right" },
    { contact = "right", motion = "turn left" },
    { contact = "both", motion = "backward" },
]
[choice]
inner_bands = [2]
below_mm = [0.8]
moves_mm = [4]
"""

RUNS = [
    *(
        (_folder if name in _WRITTEN else _one)(
            f"run/{name}",
            f"run preset:{name}",
            slow=name not in _QUICK,
            shown=name == "three-wave",
            spare=name not in _KINDS,
        )
        for name in presets()
        if not name.startswith("robot-")
    ),
    # Its map round an anchor is followed by the engine, which takes half of all that of the others.
    _folder("run/program", "run preset:used-before", slow=True, spare=True),
    _one("run/mobility", "run preset:three-wave --mobility-ratio 100"),
    Case("run/no-mobility", ("run preset:three-wave --mobility-ratio 0",)),
]

MAPS = [
    _folder(
        "map/anchor", "map preset:paper-forward --x 0:20:9 --y -15:15:7", shown=True, slow=True
    ),
    _one("map/inner", "map preset:paper-via-01 --cell inner --x 0:20:5 --y -15:15:5"),
    _folder(
        "map/parameters",
        "map preset:paper-forward --across outer.q.x=0:20:7 --up inner.q.y=-5:5:5",
        slow=True,
    ),
    _one(
        "map/three-cells",
        "map preset:three-wave --across 1.q.x=2:20:5 --up 3.stiffness=15:40:4:log",
        slow=True,
    ),
]

# Too long for a graph that is listed.
_LONG = "[chain]\nactuator_stiffness_N_per_m = 0\n" + "".join(
    f"[[chain.cell]]\np_mm = [0, 0]\nq_mm = [{10 + 0.4 * (7 * k % 24):.1f}, {5 * k % 24 / 5 - 3}]\n"
    for k in range(24)
)

GRAPHS = [
    Case(
        "graph/three-wave",
        ("graph preset:three-wave", "graph preset:three-wave --json"),
        shown=True,
    ),
    Case(
        "graph/files",
        tuple(
            f"graph preset:paper-forward --out forward.{suffix}"
            for suffix in ("svg", "png", "dot", "graphml", "json")
        ),
    ),
    Case(
        "graph/start-and-drive",
        (
            "graph preset:used-before --json",
            "graph preset:used-before --from 00 --json",
            "graph preset:paper-forward --drive force --json",
            "graph preset:paper-forward --drive 100 --json",
            "graph preset:countdown --from 000 --json",
        ),
    ),
    Case(
        "graph/not-listed",
        (
            "graph long.toml --json",
            f"graph long.toml --from {'1' * 24} --json",
            "graph long.toml --drive stroke --json",
            "graph long.toml --out long.svg",
        ),
        given={"long.toml": _LONG},
        slow=True,
    ),
]

PROGRAMS = [
    _folder(
        "program/planned",
        "program preset:paper-forward --from 10 --target 01",
        shown=True,
        slow=True,
    ),
    _one("program/robust", "program preset:three-wave --target 011 --robust 10"),
    _one("program/own", "program preset:combination-lock"),
    _one("program/force", "program preset:force-control --target 01"),
    Case(
        "program/machine",
        (
            "program preset:three-wave --machine touch.toml --out out",
            "program preset:paper-forward --machine parity.toml --json",
        ),
        given={
            "touch.toml": 'inputs = ["touch", "reset"]\nstart = "fresh"\n'
            '[states.fresh]\ntouch = "once"\nreset = "fresh"\n'
            '[states.once]\ntouch = "twice"\nreset = "fresh"\n'
            '[states.twice]\ntouch = "twice"\nreset = "fresh"\n',
            "parity.toml": 'language = "(one one)*"\n',
        },
    ),
    _folder("program/unreachable", "program preset:used-before --target 01"),
]

DESIGNED = [
    _folder("design/cycle", f"design '{_BACK}' --samples 100 --seed 3", shown=True, slow=True),
    _one("design/all", "design all:3 --samples 50", slow=True),
    _one(
        "design/requirements",
        "design '3 before 1 loading; state 101; 2 never without 3' --samples 50 "
        "--weight window=1 --weight yield=2",
        slow=True,
    ),
    _folder("design/states", "design 00,10,11 --samples 20 --drive 200", slow=True),
    _one("design/tapped", "design '000>100>000>001>011>001>000' --actuators 2", slow=True),
    Case(
        "design/options",
        (
            f"design '{_BACK}' --samples 50 --holes 5 --band antennas --band 30:10:2 --lever 14 "
            f"--lever 20 --mixed-levers --most-bands 1 --unusual --x 0:25 --y -10:10 "
            f"{_TOLERANCES} --json",
            f"design '{_BACK}' --samples 20 --objective worst --force-limit 0.6 --json",
            f"design '{_BACK}' --samples 20 --holes 5 --origin 5:0 --free p --json",
            f"design '{_BACK}' --samples 20 --holes 5 --free both --band preset:paper-forward "
            "--json",
        ),
        slow=True,
    ),
    _one(
        "design/jump",
        "design jump --hopper preset:hopper --stretch 2.4 --holes 10 --samples 20",
        slow=True,
    ),
    Case(
        "design/impossible",
        (
            "design '00>10>11>10>00' --element trilinear --drive force --force-scale 0.5:4 "
            "--travel-scale 1:1 --json",
            f"design '{_BACK}' --holes 40 --json",
        ),
    ),
]

YIELDS = [
    _folder(
        "yield/cycle",
        "yield preset:paper-forward --anchor 6 --stiffness-tolerance 20 --samples 100 --seed 2",
        shown=True,
        slow=True,
    ),
    _folder(
        "yield/sensitivity",
        f"yield preset:paper-forward --sensitivity --samples 20 {_TOLERANCES}",
        slow=True,
    ),
    _one("yield/states", "yield preset:paper-via-01 --target 00,01,11 --samples 100", slow=True),
    _one("yield/robust", "yield preset:three-wave --robust 10 --samples 20"),
    _one("yield/other", "yield preset:paper-forward --target '00>11>00' --samples 50"),
    _one("yield/program", "yield preset:finger-selector --program --samples 10"),
    _folder(
        "yield/calibrated",
        "yield preset:paper-cell-20-0 --data rubber --samples 50",
        prepare=rubber,
        within=FITTED,
        slow=True,
    ),
]

CHECKS = [
    _one("check/margin-of-cell", "margin preset:paper-cell-10-0"),
    _one("check/robust", "check preset:paper-forward --samples 100"),
    _one("check/fails", "check preset:paper-forward --target '00>01>11>10>00' --samples 50"),
    _folder(
        "check/marginal",
        "check preset:three-wave --anchor 0.5 --stiffness-tolerance 20 --rest-length-tolerance 3 "
        "--lever-tolerance 0.2 --friction 0.01 --travel-tolerance 0 --samples 100 --seed 2",
        shown=True,
        slow=True,
    ),
    _one("check/tie", "check preset:paper-identical --samples 100"),
    _one("check/program", "check preset:finger-selector --samples 10", slow=True),
    _one(
        "check/calibrated",
        "check preset:paper-cell-20-0 --data rubber --samples 50",
        prepare=rubber,
        within=FITTED,
        slow=True,
        spare=True,
    ),
    _folder("check/pressures", "check preset:balloon --samples 10", slow=True),
]

REPROGRAMS = [
    _folder(
        "reprogram/target",
        f"reprogram preset:paper-forward --by inner.p --target '{_BACK}'",
        shown=True,
    ),
    _one("reprogram/any", "reprogram preset:three-wave --by 2.q"),
    Case(
        "reprogram/along",
        (
            "reprogram preset:paper-forward --by inner.p --along -1:0 --one-way --reach 30 --json",
            "reprogram preset:paper-forward --by outer.q --along 90 --json",
        ),
    ),
    _one(
        "reprogram/none",
        f"reprogram preset:paper-forward --by inner.p --target '{_BACK}' --reach 0.5",
    ),
]

ELEMENTS = [
    *(
        (_folder if name == "balloons" else _one)(
            f"elements/{name}",
            f"run {name}.toml",
            given=DESIGNS,
            slow=True,
            shown=name == "balloons",
            spare=name in ("trilinear", "twisting", "mixed", "folded"),
        )
        for name in ("trilinear", "balloons", "twisting", "mixed", "three", "folded", "race")
    ),
    Case(
        "elements/graph",
        (
            "graph three.toml --json",
            "graph balloons.toml --drive 0.05 --json",
            "graph balloons.toml --drive force --json",
        ),
        given=DESIGNS,
    ),
    Case(
        "elements/program",
        (
            "program trilinear.toml --from 10 --target 01 --json",
            "program three.toml --target 21 --json",
            "program three.toml --from 11 --target 20 --json",
            "program balloons.toml --json",
        ),
        given=DESIGNS,
    ),
    Case(
        "elements/yield",
        (
            "yield mixed.toml --stiffness-tolerance 12 --sensitivity --samples 8 --json",
            "yield balloons.toml --stiffness-tolerance 12 --travel-tolerance 8 --samples 40 --json",
        ),
        given=DESIGNS,
        slow=True,
        # What elements are sensitive to is held in tests/design/test_elements.py.
        spare=True,
    ),
    _folder("elements/reprogram", "reprogram balloons.toml --by thick.force_scale", given=DESIGNS),
    Case(
        "elements/wrong",
        (
            "map mixed.toml --cell dome",
            "map mixed.toml --across dome.q.x=0:20:3 --up dome.force_scale=0.5:2:3",
            "program three.toml --target 30",
            "program three.toml --from 2- --target 00",
            "graph twisting.toml",
            "reprogram balloons.toml --by thick.q",
            "reprogram balloons.toml --by thick.travel_scale",
        ),
        given=DESIGNS,
    ),
]

FILES = [
    Case("files/new", ("new mine.toml", "new other.toml --preset robot-forward")),
    Case(
        "files/presets",
        ("presets", "schema", "figure preset:paper-forward --panels help"),
        shown=True,
    ),
    Case("files/schema", ("presets --json", "schema presets", "schema ru")),
    Case(
        "files/replay",
        (
            "replay preset:paper-forward",
            "replay preset:combination-lock --out lock.html",
            "replay preset:paper-forward",
            "replay robot-left --cycles 1 --out left.html",
        ),
        slow=True,
    ),
    Case(
        "files/figure",
        (
            "figure preset:paper-forward --panels force,travel --width 88mm --out f.svg",
            "figure preset:paper-forward --panels force/landscape --letters (a) --format png",
            "figure preset:paper-forward --panels snap,force --mass 0.02 --damping 0.5 --columns 1 "
            "--height 110mm --measured data/2unit_00_11/x/2unit_MMT_1.txt --out g.svg",
            "figure preset:paper-forward --panels forse",
            "figure preset:paper-forward --panels gait",
            "figure preset:paper-forward --panels elements",
            "figure preset:paper-forward --panels snap",
            "figure preset:paper-forward --width 88ft",
            "figure preset:paper-forward --width nature",
            "figure preset:paper-forward --out f.txt",
            "figure preset:paper-forward --out f.svg --format pdf",
            "figure preset:paper-forward --out f.svg",
            "figure paper:fig9",
            "figure paper:fig1 --panels force",
        ),
        prepare=cells,
        slow=True,
    ),
    Case(
        "files/animate",
        (
            "animate preset:paper-forward --seconds 0.5 --fps 4 --out cycle.gif",
            "animate preset:finger-selector --program --seconds 0.5 --fps 4",
            "animate preset:paper-forward --program --from 10 --target 01 --seconds 0.5 --fps 4 "
            "--force",
        ),
        slow=True,
    ),
]

LABS = [
    Case(
        "lab/read",
        ("lab read data --out out", "lab read data/1unit/friction --json"),
        prepare=cells,
        shown=True,
        slow=True,
    ),
    Case(
        "lab/read-options",
        (
            "lab read log.csv",
            "lab read log.csv --stroke 2 --force-column 3 --unit mm,N --flip none --half loading "
            "--cycle 1 --skip 0 --sample 1 --decimal . --save-reading --json",
        ),
        prepare=unclear,
    ),
    _folder(
        "lab/band", "lab band bands --gauge 15", prepare=bands, within=FITTED, shown=True, slow=True
    ),
    Case(
        "lab/band-options",
        ("lab band bands --window 5:40 --fit-cycles 6:6 --drop 2 --law cubic --json",),
        prepare=bands,
        # Of two samples, whose intervals are 13 standard errors wide: their ends are differences.
        within=Tolerance(1e-4, 1e-6),
        slow=True,
    ),
    _one(
        "lab/band-pairs",
        "lab band bands --cycles-per-sample 2",
        prepare=bands,
        within=Tolerance(1e-4, 1e-6),
        slow=True,
        spare=True,
    ),
    _folder("lab/compare", "lab compare data", prepare=cells, shown=True, slow=True),
    Case(
        "lab/as-built",
        (
            "lab as-built preset:paper-forward --data data/2unit_00_11/x/2unit_MMT_1.txt "
            "--scale 0.05 --anchor 0.5 --stiffness-tolerance 5 --rest-length-tolerance 2 "
            "--friction 0.02 --travel-tolerance 0 --samples 100 --seed 1 --out out",
            "lab as-built preset:paper-cell-20-0 --pulls 5:0.3,15:-0.3 --snaps-loading none "
            "--wrong-hole 2 --holes 4 --target '0>1>0' --samples 100 --json",
        ),
        prepare=cells,
        within=FITTED,
        shown=True,
        slow=True,
    ),
    _one(
        "lab/as-built-seen",
        "lab as-built preset:paper-forward --seen '00>10>11>01>00' --snaps-loading 37 "
        "--snaps-unloading 3 --ruler 2 --samples 100 --anchor 0.3 --stiffness-tolerance 2",
        prepare=cells,
        within=FITTED,
        slow=True,
        # The same from a recording is shown above.
        spare=True,
    ),
    Case(
        "lab/element",
        (
            "lab element clip.csv --out out",
            "lab element clip.csv --half loading --noise 0.02 --least-drop 0.3 --stops both "
            "--name clip --json",
        ),
        prepare=clip,
        # Another processor orders sums otherwise; the fit's rounds enlarge this to 3e-5 of a force.
        within=Tolerance(1e-4, 1e-5),
    ),
    Case(
        "lab/compare-options",
        (
            "lab compare data/1unit preset:paper-cell-20-0 --as-designed --bar inf --json",
            "lab compare data/1unit --baseline data/1unit/friction --json",
            "lab compare data/2unit_00_11 --no-baseline --json",
            "lab compare data/2unit_00_11 --rig rig.toml --json",
            "lab compare data/2unit_00_11 --rig odd.toml",
            "lab compare data/2unit_00_11 --rig rig.toml --bar 80",
        ),
        prepare=on_a_rig,
        slow=True,
    ),
    _folder(
        "lab/calibrate",
        "lab calibrate rubber",
        prepare=rubber,
        within=FITTED,
        shown=True,
        slow=True,
    ),
    Case(
        "lab/calibrate-options",
        (
            "lab calibrate rubber/out --no-baseline --law cubic --json",
            "lab calibrate rubber --law linear --baseline rubber/out --json",
        ),
        prepare=rubber,
        # Another processor orders sums otherwise, and intervals are differences of fits.
        within=Tolerance(1e-4, 1e-6),
        slow=True,
    ),
]

ROBOTS = [
    Case(
        "robot/show",
        ("robot show robot-forward --out out", "robot show robot-forward --json"),
        shown=True,
        slow=True,
    ),
    Case(
        "robot/sweep",
        (
            "robot sweep robot-forward 'chain.cell.outer.q_mm[0]=5:20:2' foot.below_mm=-1:1:2 "
            "--cycles 1 --out out",
            "robot sweep robot-forward foot.below_mm=0:0.5 --random 2 --seed 4 --cycles 1 "
            "--out drawn --json",
            "robot sweep robot-forward arena.slope.angle_deg=0:5:2 arena.start_seed=0:1:2 "
            "--cycles 1 --arena open --out slopes --json",
        ),
        within=SIMULATED,
        shown=True,
        slow=True,
    ),
    Case(
        "robot/converge",
        ("robot converge robot-forward", "robot converge robot-forward --cycles 2 --json"),
        within=SIMULATED,
        slow=True,
        # The page of the commands shows its screen.
        spare=True,
    ),
    Case(
        "walk/antennas",
        ("walk robot-explorer --cycles 1 --json",),
        within=SIMULATED,
        slow=True,
        spare=True,
    ),
    Case(
        "walk/written",
        (
            "walk robot-forward --cycles 2 --no-video --out out",
            "walk preset:robot-left --cycles 0.3 --json",
        ),
        within=SIMULATED,
        shown=True,
        slow=True,
    ),
    Case(
        "jump/written",
        (
            "jump hopper --no-video --view side --out out",
            "jump hopper-forward --jumps 2 --json",
            "jump weak.toml",
            "jump preset:paper-forward",
        ),
        given={"weak.toml": preset_text("hopper").replace("force_N = 40", "force_N = 20")},
        within=SIMULATED,
        shown=True,
        slow=True,
    ),
    Case(
        "maze/contact",
        ("maze robot-explorer cylinder --limit 36 --no-video --out out",),
        within=SIMULATED,
        shown=True,
        slow=True,
        # tests/cli/test_maze.py runs the same, and the page of the commands shows such a screen.
        spare=True,
    ),
    Case(
        "maze/options",
        (
            "maze --list",
            "maze robot-explorer three-walls --limit 1 --start-seed 1 --layout-seed 2 --disconnect "
            "--json",
            "maze robot-explorer pen --limit 1 --no-antennas --json",
            "maze robot-forward yard.txt --limit 4 --json",
        ),
        given={"yard.txt": "#####\n#S.G#\n#####\n"},
        within=SIMULATED,
        slow=True,
    ),
    Case(
        "compile/turn-away",
        ("compile table.toml --walks 1 --arena wall --limit 2 --out out",),
        given={"table.toml": _TABLE},
        within=SIMULATED,
        shown=True,
        slow=True,
    ),
    Case(
        "compile/none",
        (
            "compile stop.toml --json",
            "compile stop.toml --most 9 --json",
            "compile twice.toml",
            "compile table.toml --samples 20 --seed 3 --anchor 0.5 --stiffness-tolerance 3 "
            "--rest-length-tolerance 1 --walks 0 --build acrylic-3mm --json",
        ),
        given={
            "table.toml": _TABLE,
            "stop.toml": _TABLE.replace('"backward"', '"stop"'),
            "twice.toml": _TABLE.replace('"both"', '"free"'),
        },
        within=SIMULATED,
        slow=True,
    ),
    Case(
        "maze/video",
        (
            "maze robot-forward open --limit 1 --view above --out out",
            "walk robot-forward --cycles 0.2 --view 30,-20 --out walked",
            "walk robot-explorer --material acrylic-3mm",
            "maze robot-antennas open --limit 1 --material acrylic-3mm --json",
        ),
        within=SIMULATED,
        slow=True,
    ),
    Case(
        "robot/export",
        (
            "export robot-explorer --arena cylinder --out model.xml",
            "export robot-forward --material acrylic-3mm --out cut",
        ),
        within=SIMULATED,
    ),
]

STUDIES = [
    Case(
        "sweep/cycle",
        (
            "sweep cycle preset:paper-forward --vary outer.q.x=0:20:5 --vary outer.q.y=-15:15:3 "
            "--chunk 4 --workers 0 --out study.zarr",
            "sweep cycle preset:paper-forward --vary outer.q.x=0:20:5 --vary outer.q.y=-15:15:3 "
            "--chunk 4 --workers 0 --out study.zarr --json",
            "sweep status study.zarr --json",
            "sweep report study.zarr --out report",
            "sweep report study.zarr --out again --json --partial --force",
            "sweep resume study.zarr --workers 0",
            "sweep export study.zarr --out table.csv --partial",
            "figure study.zarr --panels snaps --partial --out study.svg",
            "sweep export study.zarr --best 3 --rank-by snaps --rank-by -peak_force --out best.csv",
            "sweep cycle preset:paper-forward --table best.csv --workers 0 --out best.zarr --json",
        ),
        shown=True,
        slow=True,
    ),
    Case(
        "sweep/drawn",
        (
            "sweep margin preset:paper-forward --vary outer.q.x=15:20 --sobol 4 --seed 2 "
            "--chunk 4 --workers 0 --out sobol.zarr --json",
            "sweep yield preset:paper-forward --vary 2.stiffness=20:40 --latin 2 --seed 2 "
            "--workers 0 --chunk 2 --out latin.zarr --json",
            "sweep graph preset:paper-forward --vary 2.stiffness=20:40 --random 2 --seed 2 "
            "--workers 0 --chunk 2 --out random.zarr --json",
            "sweep cycle preset:paper-forward --vary outer.lever=-5:20:2 --chunk 2 --workers 0 "
            "--out poisoned.zarr --json",
        ),
        slow=True,
    ),
    Case(
        "sweep/json",
        (
            "sweep margin preset:paper-forward --vary outer.q.x=15:20 --random 2 --workers 0 "
            "--out margin.zarr --json",
            "sweep extend margin.zarr --count 3 --workers 0 --json",
            "sweep cancel margin.zarr",
            "sweep resume margin.zarr --workers 0 --json",
            "sweep cycle preset:paper-forward --table list.csv --workers 0 --out list.zarr --json",
            "sweep cycle preset:paper-forward --monte-carlo 2 --anchor 0.5 --stiffness-tolerance 4 "
            "--rest-length-tolerance 2 --lever-tolerance 0.1 --friction 0.01 --travel-tolerance 1 "
            "--workers 0 --out built.zarr --json",
            "sweep program preset:paper-forward --from 00 --target 11 --vary outer.q.x=10:20:2 "
            "--workers 0 --out program.zarr --json",
            "sweep call preset:paper-forward --function own.py:measure --vary outer.q.x=10:20:2 "
            "--workers 0 --out call.zarr --json",
        ),
        given={
            "list.csv": "outer.q.x_mm,outer.stiffness_N_per_m\n12,28\n18,30\n",
            "own.py": "def measure(chain, seed):\n    return {'cells': len(chain)}\n",
        },
        slow=True,
    ),
    Case(
        "sweep/robots",
        (
            "sweep walk robot-forward --cycles 1 --vary foot.below_mm=0.3:0.6:2 --workers 0 "
            "--engine cpu --out walk.zarr --json",
            "sweep maze robot-antennas --arena pen --limit 1 --layouts 1 --first 2 --place 60 "
            "--angle 20 --vary antenna.left.angle_deg,-antenna.right.angle_deg=62:63:2 "
            "--workers 0 --out maze.zarr --json",
        ),
        within=SIMULATED,
        slow=True,
    ),
    Case(
        "atlas/two",
        (
            "atlas build --cells 2 --designs 2e4 --workers 0 --out two.zarr",
            "atlas build preset:paper-forward --vary outer.q.x=-8:20 --vary inner.stiffness=28:57 "
            "--designs 5000 --seed 3 --workers 0 --drive force --out leg.zarr --json",
            "atlas show two.zarr --anchor 0.5 --stiffness-tolerance 8 --rest-length-tolerance 2 "
            "--json",
            "atlas show leg.zarr --out leg",
            "atlas find 'reaches every state' two.zarr --yield 99% --anchor 1 "
            "--stiffness-tolerance 5 --rest-length-tolerance 1 --out pair.toml --json",
            "atlas find 'counts to two and not remembers' two.zarr --json",
        ),
        shown=True,
        slow=True,
    ),
    Case(
        "atlas/errors",
        (
            "atlas build --cells 7 --out a.zarr",
            "atlas build preset:paper-forward --out a.zarr",
            "atlas build robot-forward --vary 1.q.x=0:20 --out a.zarr",
            "atlas build --vary 1.limit=30:60 --out a.zarr",
            "atlas build --drive pull --out a.zarr",
            "atlas show gone.zarr",
            "sweep cycle preset:paper-forward --vary outer.q.x=0:20:2 --workers 0 --out b.zarr",
            "atlas show b.zarr",
            "atlas find counts b.zarr --yield most",
            "atlas find counts b.zarr --out a.txt",
            "atlas find remember",
        ),
    ),
    Case(
        "sweep/errors",
        (
            "sweep cycle preset:paper-forward --vary outer.q=0:20:5 --out a.zarr",
            "sweep cycle preset:paper-forward --vary outer.q.x=0:20 --out a.zarr",
            "sweep cycle preset:paper-forward --vary outer.q.x=20:0:3 --out a.zarr",
            "sweep cycle preset:paper-forward --vary other.q.x=0:20:3 --out a.zarr",
            "sweep cycle preset:paper-forward --vary outer.q.x=0:20 --sobol 2 --latin 2 "
            "--out a.zarr",
            "sweep status gone.zarr",
            "sweep cycle preset:paper-forward --out a.zarr",
            "sweep cycle preset:paper-forward --monte-carlo 2 --vary outer.q.x=0:20 --out a.zarr",
            "sweep walk preset:paper-forward --vary outer.q.x=0:20:2 --out a.zarr",
            "sweep walk robot-forward --vary foot.below_mm=0:1:2 --engine gpu --out a.zarr",
            "sweep cycle preset:paper-forward --table gone.csv --out a.zarr",
            "sweep call preset:paper-forward --function gone.py:f --vary outer.q.x=0:20:2 "
            "--out a.zarr",
            "sweep maze robot-forward --arena nowhere --vary foot.below_mm=0.3:0.6:2 --out a.zarr",
            "sweep export gone.zarr --out table.xls",
            "sweep export gone.zarr --best 2 --out table.csv",
            "sweep export gone.zarr --best 2 --rank-by reached --out table.parquet",
            "sweep walk robot-antennas --vary antenna.*.swing_deg,antenna.*.hook_mm=10:20:2 "
            "--out a.zarr",
            "sweep resume gone.zarr --scheduler tcp://127.0.0.1:9",
            "sweep extend gone.zarr --count 3 --scheduler tcp://127.0.0.1:9",
        ),
    ),
]

PAPER = [
    Case(
        "paper/claims",
        ("paper --out out", "paper --data gone"),
        within=SIMULATED,
        shown=True,
        slow=True,
    ),
    Case("paper/validate", ("validate --json",), within=SIMULATED, slow=True),
]

HELP = [Case("help/pages", ("--help", "check --help"), shown=True)]

WRONG = [
    Case(
        "wrong/designs",
        (
            "run slip.toml",
            "run range.toml",
            "run many.toml",
            "run toml.toml",
            "run gone.toml",
            "run preset:paper-foward",
            "run preset:robot-forward",
            "walk preset:paper-forward",
            "walk robot.toml",
            "check preset:robot-forward --recording slip.toml --holes 4 --leg left",
            "maze robot-forward wal",
            "view preset:paper-forward --arena open --material acrylic-3mm",
            "studio range.toml.gone --port 0 --demo --no-open --studies here",
            "export preset:paper-forward",
        ),
        given={
            "slip.toml": _FORWARD.replace("q_mm", "q_mmm", 1),
            "range.toml": _FORWARD.replace("rest_length_mm = 10", "rest_length_mm = -3", 1),
            "many.toml": _FORWARD.replace("lever_mm", "lever", 1).replace("limit_deg", "limit", 1),
            "toml.toml": "[chain\n",
            "robot.toml": preset_text("robot-forward").replace("mass_g", "mas_g", 1),
        },
    ),
    Case(
        "wrong/options",
        (
            "",
            "--version",
            "rum",
            "run",
            "run preset:paper-forward --jsn",
            "map preset:three-wave --cell 4",
            "map preset:paper-forward --x 0:20",
            "map preset:paper-forward --across outer.q.x=0:20:3",
            "map preset:paper-forward --across outer.q.z=0:20:3 --up inner.q.y=0:1:2",
            "graph preset:three-wave --from 00",
            "graph preset:three-wave --drive -1",
            "graph preset:three-wave --out wave.bmp",
            "program preset:paper-forward",
            "program preset:paper-forward --from 10",
            "program preset:paper-forward --target 012",
            "design banana",
            "design '00>11>00' --samples 10",
            "yield preset:paper-forward --anchor -1",
            "reprogram preset:paper-forward --by inner",
            "reprogram preset:paper-forward --by inner.p --along 0:0",
            "animate preset:paper-forward --target 01",
            "replay preset:paper-forward --cycles 3",
            "replay robot-left --arena nowhere",
            "replay preset:paper-forward --out replay.txt",
            "new mine.txt",
            "new mine.toml --preset nothing",
            "robot sweep robot-forward foot.belw_mm=0:1:2 --out out",
            "robot sweep robot-forward foot.below_mm=0:1 --out out",
            "lab band gone",
            "lab read gone.txt",
            "lab compare gone",
        ),
    ),
    Case(
        "wrong/folders",
        (
            "reprogram preset:paper-forward --by inner.p --reach 1 --out out",
            "program preset:paper-forward --target 01 --out out",
            "run preset:paper-cell-0-0 --out out",
            "run preset:paper-cell-0-0 --out forward.toml",
            "new forward.toml",
            "new forward.toml --preset paper-backward --force",
        ),
        given={"forward.toml": _FORWARD},
    ),
]

_STEEP = "[chain]\nlever_mm = 30\nlimit_deg = 70\n[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"
# Of the folder, the files of parts and sheets are read by tests/build.
BUILDS = [
    Case(
        "build/pair",
        (
            "build preset:paper-forward --samples 50",
            "build preset:paper-forward --samples 50 --json",
        ),
        shown=True,
        slow=True,
    ),
    Case(
        "build/robot",
        ("build robot-forward --material weak.toml", "build robot-forward --json"),
        given={"weak.toml": "[linear_actuator]\ntravel_mm = 30\nforce_N = 1\n"},
        shown=True,
        slow=True,
    ),
    Case(
        "build/collides",
        ("build steep.toml --json", "build steep.toml --nest 0 --out out"),
        given={"steep.toml": _STEEP},
        slow=True,
    ),
    Case(
        "build/written",
        (
            "build preset:paper-cell-10-0 --material own.toml --samples 20 --target '0>1>0' --r12 "
            "--draft --nest 0 --band paper --out out",
        ),
        given={"own.toml": 'base = "plywood-3mm"\n[lever]\nwidth_mm = 9\n'},
        slow=True,
    ),
    Case(
        "build/errors",
        (
            "yield preset:paper-outer-15 --build plywood-3mm --samples 100 --json",
            "check preset:paper-outer-15 --build plywood-3mm --samples 100 --json",
            f"design '{_BACK}' --build acrylic-3mm --samples 20 --json",
        ),
        slow=True,
    ),
]

CASES: dict[str, Case] = {
    case.name: case
    for case in (
        *RUNS, *MAPS, *GRAPHS, *PROGRAMS, *DESIGNED, *YIELDS, *CHECKS, *REPROGRAMS, *ELEMENTS,
        *FILES, *LABS, *ROBOTS, *STUDIES, *PAPER, *HELP, *WRONG, *BUILDS,
    )
}  # fmt: skip
