"""Promises about the house itself: what it imports, what it names, what it calls its version."""

import ast
import inspect
import os
import re
import subprocess
import sys
from contextlib import suppress
from fnmatch import fnmatch
from functools import cache
from importlib import import_module
from pathlib import Path

import networkx
import pytest

import stepwell

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "stepwell"
# All that is asked of the sources parses them once, which takes seconds.
pytestmark = pytest.mark.slow
HEAVY = {"matplotlib", "numba", "pandas", "pydantic", "scipy", "xarray"}

# Written as patterns, so that this file does not name what it forbids.
INDEX_HOST = re.compile(r"pypi\.(?:org|python)|python(?:hosted)\.org|npm(?:js)\.(?:org|com)", re.I)
MACHINE_PATH = re.compile(r"(?<![\w.}])/(?:home|root|work|Users)/\w|[A-Z]:\\Users\b|\.\./shared\b")


@cache
def repository_texts() -> dict[Path, str]:
    """Text files that are, or would be, committed."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout, so there is no list of the repository's files")
    listing = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    texts = {}
    for file in (ROOT / name for name in listing.split("\0") if name):
        with suppress(UnicodeDecodeError, FileNotFoundError):  # a picture; a file that is gone
            texts[file] = file.read_text("utf-8")
    return texts


def mentions(pattern: re.Pattern[str]) -> list[str]:
    """Places where a text file says what the pattern forbids, as "file:line: text"."""
    return [
        f"{file.relative_to(ROOT)}:{number}: {line.strip()[:100]}"
        for file, text in repository_texts().items()
        if pattern.search(text)
        for number, line in enumerate(text.splitlines(), 1)
        if pattern.search(line)
    ]


@cache
def tree_of(file: Path) -> ast.Module:
    """What Python reads in a file."""
    return ast.parse(file.read_text("utf-8"))


@cache
def nodes_of(file: Path) -> list[ast.AST]:
    """All parts of what Python reads in a file."""
    return [*ast.walk(tree_of(file))]


# Each is run after what comes before it, which opens less.
STEPS = {
    "import": "import stepwell",
    "help": "command('--help')",
    "run": "command('run', 'preset:paper-forward')",
    "graph": """
for drive in ("stroke", "force"):
    print(stepwell.preset("three-wave").graph(drive).reading)
""",
}
RUN = """
import sys

def command(*words):
    from stepwell.cli import main
    sys.argv = ["stepwell", *words]
    try:
        main()
    except SystemExit as end:
        assert not end.code, end.code

for name, step in {steps!r}.items():
    exec(step)
    print("<opened>", name, *sys.modules)
"""


@pytest.fixture(scope="module")
def opened(tmp_path_factory) -> dict[str, set[str]]:
    """Modules in memory after each step of a fresh interpreter."""
    done = subprocess.run(
        [sys.executable, "-c", RUN.format(steps=STEPS)],
        cwd=tmp_path_factory.mktemp("fresh"),
        # The compiler is loaded after half a second of interpreted work, sooner on a slow machine.
        env={**os.environ, "STEPWELL_KERNELS": "interpreted"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    lines = [line.split() for line in done.stdout.splitlines() if line.startswith("<opened>")]
    return {name: set(modules) for _, name, *modules in lines}


def heavy(modules: set[str]) -> set[str]:
    return HEAVY & {name.partition(".")[0] for name in modules}


def test_importing_stepwell_costs_numpy_and_no_more(opened):
    assert heavy(opened["import"]) == set()


def test_asking_the_command_for_help_opens_no_numerical_library(opened):
    assert heavy(opened["help"]) <= {"pydantic"}


def test_a_run_of_a_chain_opens_what_it_needs_and_no_more(opened):
    assert heavy(opened["run"]) <= {"pydantic"}
    rooms = "lab", "reports", "robot", "simulation", "studies", "studio"
    others = "design.maps", "design.synthesis", "files.schema.robot", "sequences.transition_graph"
    assert opened["run"] & {f"stepwell.{name}" for name in (*rooms, *others)} == set()


def test_a_graph_and_its_reading_open_no_networkx(opened):
    assert heavy(opened["graph"]) <= {"pydantic", "scipy"}
    assert "networkx" not in opened["graph"]


def test_every_public_name_can_be_had_from_the_root():
    missing = [name for name in stepwell.__all__ if not hasattr(stepwell, name)]
    assert missing == []


def test_dir_lists_every_name_that_a_room_offers():
    assert len(dir(stepwell)) <= 64
    for room in ("design", "files", "sequences", "studies"):
        door = import_module(f"stepwell.{room}")
        assert set(dir(door)) == set(door.__all__)
        assert all(hasattr(door, name) for name in door.__all__)


def test_one_class_has_one_name():
    homes: dict[str, list[str]] = {}
    for file in SOURCE.rglob("*.py"):
        for node in tree_of(file).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes.setdefault(node.name, []).append(str(file.relative_to(SOURCE)))
    assert {name: files for name, files in homes.items() if len(files) > 1} == {}


def module_of(file: Path) -> str:
    parts = file.relative_to(SOURCE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def room_of(module: str) -> str:
    return module.split(".")[1] if "." in module else ""


@cache
def own_imports(file: Path) -> list[tuple[str, tuple[str, ...], bool]]:
    """What a file takes from Stepwell: the module, the names, and whether at once."""
    tree = tree_of(file)
    at_once = set(map(id, tree.body))
    return [
        (node.module, tuple(alias.name for alias in node.names), id(node) in at_once)
        for node in nodes_of(file)
        if isinstance(node, ast.ImportFrom)
        and not node.level
        and node.module
        and node.module.partition(".")[0] == "stepwell"
    ] + read_off_rooms(file)


def read_off_rooms(file: Path) -> list[tuple[str, tuple[str, ...], bool]]:
    """What a file takes from rooms that it imports whole, as `base.number`, or `sw.base.number`."""
    rooms = {}
    for node in nodes_of(file):
        if isinstance(node, ast.ImportFrom) and node.module == "stepwell":
            rooms |= {one.asname or one.name: f"stepwell.{one.name}" for one in node.names}
        elif isinstance(node, ast.Import):
            rooms |= {one.asname: one.name for one in node.names if one.asname}
    doors = {f"stepwell.{one.parent.name}" for one in SOURCE.glob("*/__init__.py")}
    found = []
    for node in nodes_of(file):
        if isinstance(node, ast.Attribute):
            first, *rest = dotted(node.value)
            module = ".".join(filter(None, (rooms.get(first), *rest)))
            if module in doors:
                found.append((module, (node.attr,), False))
    return found


def dotted(node: ast.expr) -> list[str]:
    """The parts of a name such as `sw.base`; "" for what is none before the first point."""
    parts = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    return [node.id if isinstance(node, ast.Name) else "", *reversed(parts)]


@cache
def offers(room: str, *, own: bool = False) -> set[str]:
    """The names that the door of a room binds, or only those from files of its own.

    The house itself offers its rooms.
    """
    if not room:
        return {one.parent.name for one in SOURCE.glob("*/__init__.py")} | set(stepwell.__all__)
    nodes = nodes_of(SOURCE / room / "__init__.py")
    names = {
        alias.asname or alias.name
        for node in nodes
        if isinstance(node, ast.ImportFrom)
        and f"{node.module}.".startswith(f"stepwell.{room}." if own else "stepwell.")
        for alias in node.names
    }
    for node in () if own else nodes:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
    return names


def test_a_file_takes_from_other_rooms_only_what_their_doors_offer():
    """Within its own room a file may take from any file; private names stay in their room."""
    trespassers = []
    for file in SOURCE.rglob("*.py"):
        own = room_of(module_of(file))
        for module, names, _ in own_imports(file):
            room = room_of(module)
            if room == own and module != "stepwell":
                continue
            inside = module.count(".") > 1
            trespassers += [
                f"{file.relative_to(SOURCE)} takes {name} from {module}"
                for name in names
                if inside
                or (module.count(".") < 2 and name not in offers(room))
                or (name.startswith("_") and name != "__version__")
            ]
    assert trespassers == []


def test_only_rooms_have_doors():
    """The `__init__` of a folder in a room holds its description and nothing else."""
    doors = [
        str(file.relative_to(SOURCE))
        for file in SOURCE.glob("*/**/__init__.py")
        if file.parent.parent != SOURCE and len(tree_of(file).body) > 1
    ]
    assert doors == []


def test_rooms_offer_to_other_rooms_only_what_these_take():
    """What a door offers beyond its `__all__` is for other rooms: one of them takes it."""
    files = [*SOURCE.rglob("*.py")]
    unwanted = []
    for door in SOURCE.glob("*/__init__.py"):
        room = door.parent.name
        listed = {
            value
            for node in nodes_of(door)
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
            for value in ast.literal_eval(node.value)
        }
        taken = {
            name
            for file in files
            if file == SOURCE / "__init__.py" or room_of(module_of(file)) != room
            for module, names, _ in own_imports(file)
            if module == f"stepwell.{room}"
            for name in names
        }
        hidden = offers(room, own=True) - listed - taken
        unwanted += [f"{room} offers {name}" for name in sorted(hidden)]
    assert unwanted == []


def test_no_two_files_stand_on_each_other():
    graph = networkx.DiGraph()
    files = {module_of(file): file for file in SOURCE.rglob("*.py")}
    for name, file in files.items():
        for module, names, at_once in own_imports(file):
            if at_once:
                for one in names:
                    taken = f"{module}.{one}" if f"{module}.{one}" in files else module
                    graph.add_edges_from([(name, taken)] if taken != name else [])
    rings = [ring for ring in networkx.strongly_connected_components(graph) if len(ring) > 1]
    assert rings == []


def test_no_folder_holds_more_files_than_one_can_see_at_once():
    crowded = {
        str(folder.relative_to(SOURCE)): len(files)
        for folder in [SOURCE, *SOURCE.rglob("*/")]
        if len(files := [*folder.glob("*.py")]) > 20
    }
    assert crowded == {}


def test_no_file_is_there_for_a_dozen_lines():
    small = [
        str(file.relative_to(SOURCE))
        for file in SOURCE.rglob("*.py")
        if file.name not in ("__init__.py", "__main__.py")
        and len(file.read_text("utf-8").splitlines()) < 60
    ]
    # The version is read by what builds the package.
    assert set(small) <= {"base/version.py"}


@pytest.mark.parametrize("value", [stepwell.Chain, stepwell.Robot])
def test_what_a_door_leads_to_is_described_once(value):
    """A method that opens a higher room has the description; the function there names it."""
    twice, doors = [], 0
    for name_of_room in ("statics", "sequences", "design", "robot", "simulation"):
        room = import_module(f"stepwell.{name_of_room}")
        for name in set(room.__all__) & set(vars(value)):
            doors += 1
            told = inspect.getdoc(getattr(room, name)) or ""
            if f"All else as for `{value.__name__}.{name}`." not in told or "Args:" in told:
                twice.append(name)
    assert twice == []
    assert doors > 2


def test_what_is_refused_is_refused_by_an_error_of_ours():
    """Whoever catches `StepwellError` catches all that is said to users on purpose."""
    bare = [
        f"{file.relative_to(SOURCE)}:{node.lineno}"
        for file in SOURCE.rglob("*.py")
        for node in nodes_of(file)
        if isinstance(node, ast.Raise)
        and isinstance(node.exc, ast.Call)
        and ast.unparse(node.exc.func) in ("ValueError", "RuntimeError", "Exception")
    ]
    assert bare == []


def test_every_module_says_what_a_reader_finds_there():
    silent = [
        str(file.relative_to(ROOT))
        for file in SOURCE.rglob("*.py")
        if not ast.get_docstring(tree_of(file))
    ]
    assert silent == []


def test_no_file_names_a_package_index():
    assert mentions(INDEX_HOST) == []


def test_the_package_holds_sources_and_data_that_it_reads_and_nothing_else():
    package = ROOT / "src" / "stepwell"
    data = ("build/presets/", "files/", "studies/three.zarr/", "studio/page/", "py.typed")
    strays = [
        name
        for file in repository_texts()
        if file.is_relative_to(package) and file.suffix not in (".py", ".html")
        if not (name := file.relative_to(package).as_posix()).startswith(data)
    ]
    assert strays == []


def test_no_file_names_a_path_of_somebodys_machine():
    assert mentions(MACHINE_PATH) == []


@pytest.mark.parametrize("lock", ["requirements.lock", "requirements-lowest.lock"])
def test_a_lock_file_holds_pins_and_hashes_and_no_address(lock):
    text = (ROOT / lock).read_text("utf-8")
    assert not re.search(r"://|--(?:extra-)?index-url|--find-links|--trusted-host| @ ", text)
    pins = re.split(r"\n(?=\w)", re.sub(r"^#.*\n", "", text, flags=re.M))
    unpinned = [pin for pin in pins if not re.match(r"[\w.-]+==\S+ .*--hash=sha256:", pin, re.S)]
    assert unpinned == []


def test_the_lock_pins_what_builds_the_package():
    text = (ROOT / "requirements.lock").read_text("utf-8")
    assert {"hatchling", "editables"} <= set(re.findall(r"^([\w.-]+)==", text, re.M))


def test_changelog_and_citation_speak_of_this_version():
    changelog = (ROOT / "CHANGELOG.md").read_text("utf-8")
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    newest = re.search(r"^## (\S+)", changelog, re.M)
    cited = re.search(r"^version: (\S+)$", citation, re.M)
    assert newest is not None
    assert cited is not None
    assert newest[1] == cited[1] == stepwell.__version__


def test_pytest_opens_every_folder_that_has_tests(pytestconfig):
    left_out = pytestconfig.getini("norecursedirs")
    names = {file.parent.name for file in (ROOT / "tests").rglob("test_*.py")}
    assert len(names) > 20
    assert [name for name in names if any(fnmatch(name, one) for one in left_out)] == []
