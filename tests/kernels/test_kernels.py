"""Interpreted or compiled, on a sound cache, a damaged one or none: the same answers."""

import itertools
import math
import os
import shutil
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

import stepwell as sw
from facts import refuses, says
from sizes import examples
from stepwell.kernels import beside, compiler, entry, in_blocks, kernel, store, threads
from stepwell.kernels.entry import Entry
from stepwell.kernels.fingerprint import fingerprint
from stepwell.statics.following.flow import _smooth_rates

SOURCE = Path(sw.__file__).parents[1]
MODULES = [
    ".".join(file.relative_to(SOURCE).with_suffix("").parts)
    for file in sorted(SOURCE.glob("stepwell/**/*.py"))
    if "\n@entry(" in file.read_text("utf-8")
]
SMALL = """
    from stepwell.concave import Simple, end_forces
    print(end_forces(Simple(0.02, 0.0, 28.5, 0.01, 0.0141, 0.7)))
"""

TINY = """
    import numpy as np
    from stepwell.kernels import entry, kernel

    STEP = 0.5

    @kernel
    def halved(x):
        return x * STEP

    @entry()
    def walk(values):
        total = 0.0
        for value in values:
            total += halved(value)
        return total
"""


def entries() -> dict[str, Entry]:
    by_name = {}
    for module in MODULES:
        for name, value in vars(import_module(module)).items():
            if isinstance(value, Entry) and value.function.__module__ == module:
                by_name[f"{module}.{name}"] = value
    return by_name


def said(script: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    """A fresh Python that runs a script; what it writes."""
    paths = os.pathsep.join([str(SOURCE), environment.pop("PYTHONPATH", "")])
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": paths, **environment},
    )


@pytest.fixture
def each_way(monkeypatch):
    """Runs something interpreted and compiled."""

    def both(run):
        monkeypatch.setenv("STEPWELL_KERNELS", "compiled")
        compiled = run()
        with monkeypatch.context() as patch:
            patch.setenv("STEPWELL_KERNELS", "interpreted")
            for one in entries().values():
                patch.setattr(one, "_machine", None)
            return run(), compiled

    return both


def some_chain(rng: np.random.Generator) -> sw.Chain:
    drive = [math.inf, math.inf, 0.0, float(rng.uniform(20, 500))][rng.integers(4)]
    rubs = rng.random() < 0.4

    def band() -> sw.Band:
        q = rng.uniform((-0.015, -0.02), (0.03, 0.02))
        law = sw.Linear()
        if rng.random() < 0.3:
            law = sw.Table((0.0, 0.004, 0.011), (0.0, float(rng.uniform(0.05, 0.3)), 0.4))
        return sw.Band(
            (-0.01, 0.0), (float(q[0]), float(q[1])), float(rng.uniform(10, 60)),
            float(rng.uniform(0.005, 0.02)), law,
        )  # fmt: skip

    cells = [
        sw.Cell(
            [band() for _ in range(1 + (rng.random() < 0.2))],
            lever=float(rng.uniform(0.01, 0.02)),
            limit=float(rng.uniform(0.4, 1.0)),
            friction=float(rng.uniform(0, 0.02)) if rubs else 0.0,
        )
        for _ in range(int(rng.integers(1, 10)))
    ]
    return sw.Chain(cells, actuator_stiffness=drive)


@pytest.mark.slow
def test_a_path_has_the_same_bits_interpreted_and_compiled(each_way):
    def paths():
        rng = np.random.default_rng(11)
        parts = []
        for _ in range(examples(2, full=160)):
            path = some_chain(rng).cycle().path
            parts.append((path.stroke, path.travel, path.force, path.energy, path.residual))
            parts.append((np.frombuffer(repr(path.events).encode(), np.uint8),))
        return parts

    for one, other in zip(*each_way(paths), strict=True):
        for a, b in zip(one, other, strict=True):
            assert a.shape == b.shape
            assert a.tobytes() == b.tobytes()


@pytest.mark.slow
def test_maps_yields_and_choices_have_the_same_bits_interpreted_and_compiled(each_way):
    leg = sw.preset("paper-forward")
    assert isinstance(leg, sw.Chain)

    def results():
        x, y = np.linspace(0, 0.02, 12), np.linspace(-0.015, 0.015, 12)
        design_map = sw.transition_map(leg, cell=1, x=x, y=y)
        texts = [repr(design_map[name].values.tolist()) for name in design_map]
        usual = sw.Tolerances(anchor=3e-4, stiffness=0.05)
        texts.append(repr(leg.yields(usual, samples=400)))
        texts.append(repr(leg.margin()))
        texts.append(repr(sw.design("00>10>11>01>00", holes=0.005, samples=500)))
        return texts

    interpreted, compiled = each_way(results)
    assert interpreted == compiled


@pytest.mark.slow
def test_the_first_answer_needs_no_compiler(tmp_path):
    result = said(
        """
        import sys, stepwell as sw
        leg = sw.preset("paper-forward")
        print(leg.cycle().sequence, leg.cycle().path.force[0])
        sw.margin(leg), sw.Tolerances
        print(sorted({"numba", "llvmlite", "scipy.stats", "scipy.optimize"} & set(sys.modules)))
        """,
        NUMBA_CACHE_DIR=str(tmp_path / "cache"),
    )
    assert result.stdout.splitlines()[0].startswith("00>10>11>01>00")
    assert result.stdout.splitlines()[-1] == "[]"
    assert result.stderr == "" and list(tmp_path.rglob("*.kernel")) == []


@pytest.mark.slow
def test_an_edited_formula_gives_new_answers_wherever_the_compiled_ones_are_kept(tmp_path):
    shutil.copytree(SOURCE / "stepwell", tmp_path / "copy" / "stepwell")
    settings = {"NUMBA_CACHE_DIR": str(tmp_path / "kept"), "STEPWELL_KERNELS": "compiled"}

    # In that process itself, which takes half as long.
    script = "from stepwell.kernels import compiler\ncompiler.here = True\n"
    script += textwrap.dedent(SMALL)

    def answer() -> str:
        result = subprocess.run(
            [sys.executable, "-c", script], capture_output=True, text=True,
            env={**os.environ, **settings, "PYTHONPATH": str(tmp_path / "copy")},
        )  # fmt: skip
        assert result.returncode == 0, result.stderr
        return result.stdout

    before = answer()
    geometry = tmp_path / "copy" / "stepwell" / "mechanism" / "geometry.py"
    old = "return np.sqrt(x * x + y * y + 1e-30)"
    text = geometry.read_text()
    assert old in text
    geometry.write_text(text.replace(old, "return np.sqrt(x * x + 2 * y)"))
    assert answer() != before
    geometry.write_text(text)
    files = sorted(tmp_path.glob("kept/stepwell/*.kernel"))
    assert answer() == before
    assert sorted(tmp_path.glob("kept/stepwell/*.kernel")) == files


@pytest.fixture
def tiny(tmp_path, monkeypatch):
    """Makes a new module of two kernels, as a process that opens finds it."""
    (tmp_path / "tiny.py").write_text(textwrap.dedent(TINY))
    monkeypatch.syspath_prepend(tmp_path)

    def made():
        monkeypatch.delitem(sys.modules, "tiny", raising=False)
        return import_module("tiny")

    return made


@pytest.mark.slow
@pytest.mark.parametrize("damage", ["half", "empty", "bit"])
def test_a_damaged_kernel_is_made_again_with_one_line(tmp_path, damage, tiny, monkeypatch, capsys):
    monkeypatch.setattr(store, "folder", lambda: tmp_path)
    monkeypatch.setattr(compiler, "here", True)  # no process of its own for so little

    def answer() -> tuple[float, list[str]]:
        total = tiny().walk.compiled()(np.arange(4.0))
        return total, capsys.readouterr().err.splitlines()

    assert answer() == (3.0, [])
    (file,) = tmp_path.glob("walk-*.kernel")
    whole = file.read_bytes()
    flipped = whole[:-9] + bytes([whole[-9] ^ 4]) + whole[-8:]
    file.write_bytes({"half": whole[: len(whole) // 2], "empty": b"", "bit": flipped}[damage])
    again, lines = answer()
    assert again == 3.0
    (line,) = lines
    says(line, "walk-", "damaged", "made again")
    assert file.exists() and answer() == (3.0, [])


@pytest.mark.slow
def test_where_nothing_can_be_kept_one_line_names_the_setting(tmp_path):
    (tmp_path / "file").write_text("in the way")
    settings = {"NUMBA_CACHE_DIR": str(tmp_path / "file"), "STEPWELL_KERNELS": "compiled"}
    result = said(SMALL, **settings)
    assert result.returncode == 0 and result.stdout.startswith("(")
    lines = [line for line in result.stderr.splitlines() if "compiling" not in line]
    assert len(lines) == 1 and "NUMBA_CACHE_DIR" in lines[0] and "for this run" in lines[0]
    nowhere = "import tempfile\ntempfile.tempdir = '/nowhere'\n" + textwrap.dedent(SMALL)
    bare = said(nowhere, **settings)
    assert (bare.returncode, bare.stdout) == (0, result.stdout)
    says(bare.stderr, "no compiled kernels")


def test_where_the_users_own_folder_cannot_be_made_a_private_one_is_used(
    tmp_path, monkeypatch, capsys
):
    (tmp_path / "file").write_text("in the way")
    for name, value in (("NUMBA_CACHE_DIR", ""), ("XDG_CACHE_HOME", str(tmp_path / "file"))):
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    private = store.folder.__wrapped__()
    assert private is not None and private.parent == tmp_path
    message = capsys.readouterr().err
    assert "NUMBA_CACHE_DIR" in message and len(message.splitlines()) == 1


def test_a_mode_that_is_none_is_refused(monkeypatch):
    monkeypatch.setenv("STEPWELL_KERNELS", "fast")
    with refuses(ValueError, "STEPWELL_KERNELS = 'fast'", "auto", "interpreted or compiled"):
        entry()(kernel(lambda x: x))(1.0)


@pytest.mark.slow
def test_kernels_are_compiled_in_the_background(tmp_path):
    (tmp_path / "tiny.py").write_text(textwrap.dedent(TINY))
    script = """
        import time, numpy as np, tiny
        values = np.arange(200_000.0)
        end = time.monotonic() + 120
        answers = set()
        while tiny.walk.interpreted and time.monotonic() < end:
            answers.add(tiny.walk(values))
            time.sleep(0.1)  # the compilers may have the cores
        answers.add(tiny.walk(values))
        print(tiny.walk.interpreted, len(answers))
    """
    settings = {"NUMBA_CACHE_DIR": str(tmp_path / "kept"), "PYTHONPATH": str(tmp_path)}
    # Two at once, as when a class begins.
    runs: list[subprocess.CompletedProcess[str]] = []
    threads = [
        threading.Thread(target=lambda: runs.append(said(script, **settings))) for _ in range(2)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [run.stdout for run in runs] == ["False 1\n"] * 2
    assert [run.stderr for run in runs] == [""] * 2
    kept = sorted(path.name.split("-")[0] for path in tmp_path.glob("kept/stepwell/*.kernel"))
    assert kept == ["halved", "walk"]


@pytest.mark.slow
def test_what_stays_takes_machine_code_that_is_on_disk_at_once(tmp_path):
    (tmp_path / "tiny.py").write_text(textwrap.dedent(TINY))
    script = """
        import sys, numpy as np, tiny
        from stepwell.kernels import stay
        if "stays" in sys.argv: stay()
        tiny.walk(np.arange(3.0))
        print(tiny.walk.interpreted)
    """
    settings = {"NUMBA_CACHE_DIR": str(tmp_path / "kept"), "PYTHONPATH": str(tmp_path)}
    staying = script.replace('if "stays" in sys.argv: ', "")
    # Nothing is on disk yet, and nobody waits for a compiler; then it is put there.
    first = textwrap.dedent(staying) + (
        "from stepwell.kernels import compiler\ncompiler.here = True\n"
        "tiny.walk.compiled()(np.arange(3.0))\n"
    )
    assert said(first, **settings).stdout == "True\n"
    assert said(script, **settings).stdout == "True\n"
    assert said(staying, **settings).stdout == "False\n"


@pytest.fixture
def on_disk(monkeypatch):
    """An entry whose machine code is on disk, in a process that has interpreted nothing yet."""
    rules = import_module("stepwell.kernels.entry")
    monkeypatch.setenv("STEPWELL_KERNELS", "auto")
    monkeypatch.setattr(rules, "_interpreted_for", 0.0)
    monkeypatch.delitem(sys.modules, "stepwell.kernels.machine", raising=False)

    def made(function, clock=None) -> Entry:
        one = entry()(function)
        monkeypatch.setattr(one, "ready", lambda: True)
        monkeypatch.setattr(one, "compiled", lambda: lambda *_: "compiled")
        if clock is not None:
            monkeypatch.setattr(rules, "thread_time", clock)
        return one

    return made


def test_a_busy_machine_loads_no_compiler_for_milliseconds_of_work(on_disk):
    # The clock on the wall runs on while another process has the core.
    waits = on_disk(lambda: time.sleep(0.3))
    assert [waits() for _ in range(3)] == [None] * 3


def test_the_compiler_is_loaded_after_as_much_work_as_loading_it_takes(on_disk):
    clock = itertools.count(step=0.1).__next__
    one, other = on_disk(lambda: 1, clock), on_disk(lambda: 2, clock)
    answers = [kernel() for _ in range(4) for kernel in (one, other)]
    # Two clock readings a call: five calls of a tenth of a second each, whichever entry it is.
    assert answers == [1, 2, 1, 2, 1, "compiled", "compiled", "compiled"]


def test_once_the_compiler_is_loaded_an_entry_goes_over_sooner(on_disk, monkeypatch):
    monkeypatch.setitem(sys.modules, "stepwell.kernels.machine", None)
    one = on_disk(lambda: 1, itertools.count(step=0.06).__next__)
    assert [one() for _ in range(3)] == [1, 1, "compiled"]


def test_a_fingerprint_tells_what_is_computed_and_not_where_or_when(tmp_path, monkeypatch):
    def made(text: str) -> str:
        place = tmp_path / str(len(list(tmp_path.iterdir())))
        place.mkdir()
        (place / "tiny.py").write_text(textwrap.dedent(text))
        monkeypatch.syspath_prepend(place)
        monkeypatch.delitem(sys.modules, "tiny", raising=False)
        return fingerprint(import_module("tiny").walk.function)

    first = made(TINY)
    assert made("# moved down\n" + textwrap.dedent(TINY)) == first
    assert made(TINY.replace("STEP = 0.5", "STEP = 0.25")) != first
    assert made(TINY.replace("x * STEP", "x / STEP")) != first
    assert made(TINY.replace("total = 0.0", "total = 1.0")) != first
    with refuses(TypeError, "a kernel uses", "function", "kernels, entries, numbers"):
        made(TINY.replace("    @kernel\n", ""))


def test_old_versions_of_a_kernel_do_not_pile_up(tmp_path, monkeypatch):
    monkeypatch.setattr(store, "folder", lambda: tmp_path)
    for i in range(30):
        store.write(f"law-{i:02}-0", b"code")
        os.utime(tmp_path / f"law-{i:02}-0.kernel", (i, i))
    store.write("follow-0-0", b"code")
    assert len(list(tmp_path.glob("law-*"))) <= 13
    assert store.read("law-29-0") == b"code" and store.read("follow-0-0") == b"code"


def test_a_full_disk_costs_one_line_and_no_answer(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(store, "folder", lambda: tmp_path)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    store.write("law-0-0", b"code")
    says(capsys.readouterr().err, "No space left")
    assert list(tmp_path.iterdir()) == []


def test_a_compiler_that_fails_is_replaced_by_this_process(monkeypatch, tmp_path):
    monkeypatch.setattr(store, "folder", lambda: tmp_path)
    monkeypatch.setattr(compiler, "here", False)
    monkeypatch.setattr(sys, "executable", "/bin/false")
    assert not compiler.compile_elsewhere(fingerprint, b"")
    assert compiler.here


def test_an_interrupted_wait_ends_the_work_before_it_goes_on():
    stopped = threading.Event()
    ended = []

    def work():
        stopped.wait(60)
        ended.append(True)

    def look():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        beside(work, stopped.set, look)
    assert ended == [True]


@pytest.mark.slow
def test_blocks_cover_everything_once_and_stop_at_the_first_failure():
    seen = np.zeros(1000, int)
    calls = []

    def mark(begin, end):
        seen[begin:end] += 1

    in_blocks(mark, 1000, 7, lambda done, total: calls.append((done, total)))
    assert (seen == 1).all() and calls[-1] == (1000, 1000)
    begun, which = [], itertools.count(1)

    def fail(begin, end):
        begun.append(begin)
        if next(which) == 3:  # one call only, also where several run at once
            raise TimeoutError("its own")
        time.sleep(0.01)

    with pytest.raises(TimeoutError, match="its own"):
        in_blocks(fail, 100_000, 7)
    assert len(begun) < 1000


@pytest.mark.parametrize("count", [20_000, 40_000, 1_000_000])
def test_every_core_has_a_block_at_once_also_where_few_would_do(monkeypatch, count):
    monkeypatch.setattr(threads, "cores", lambda: 3)
    first: list[int] = []
    together, met = threading.Barrier(3), threading.Event()

    def meet(begin, end):
        if not first:
            first.append(end)
        elif not met.is_set():
            together.wait(20)  # BrokenBarrierError where no three of them run at once
            met.set()

    in_blocks(meet, count, 20_000)
    assert met.is_set() and first == [1250]


def test_a_flow_in_which_no_cell_moves_divides_by_nothing():
    # Machine code would go on with what is not a number; the interpreter would stop here.
    cell, where = np.ones((21, 2)), np.zeros((4, 2), np.int64)
    _smooth_rates((1.0, 0.0, 0.0, 0.0), cell, where, 2, 0)
    assert cell[0].tolist() == [0.0, 0.0]


def test_every_kernel_can_be_compiled_from_what_it_names():
    marked = entries()
    assert len(marked) >= 20
    prints = {name: fingerprint(one.function) for name, one in marked.items()}
    assert len(set(prints.values())) == len(prints)


@pytest.mark.slow
def test_every_array_that_machine_code_gets_is_whole_so_that_it_is_made_once(monkeypatch):
    asked, call = {}, Entry.__call__

    def parts(value):
        if isinstance(value, np.ndarray):
            yield value
        elif isinstance(value, tuple):
            for item in value:
                yield from parts(item)

    def checked(self, *args):
        for array in parts(args):
            asked[self.__name__] = asked.get(self.__name__, True) and array.flags.c_contiguous
        return call(self, *args)

    monkeypatch.setattr(Entry, "__call__", checked)
    for name in ("paper-forward", "kresling"):
        chain = sw.preset(name)
        assert isinstance(chain, sw.Chain)
        cycle, ones = chain.cycle(), [0.01] * len(chain)
        for snap in cycle.snaps[:1]:
            cycle.path.inertial_landing(snap, masses=ones, damping=ones)
        chain.margin()
        chain.graph()
    leg = sw.preset("paper-forward")
    assert isinstance(leg, sw.Chain)
    axis = np.linspace(0, 0.02, 3)
    sw.transition_map(leg, cell=1, x=axis, y=axis)
    # Blocks of many designs are parts of what they fill.
    many = np.linspace(0, 0.02, 160)
    sw.transition_map(leg, cell=1, x=many, y=many)
    sw.design("00>10>11>01>00", holes=0.005, samples=500)
    assert len(asked) >= 8
    assert not [name for name, whole in asked.items() if not whole]


@pytest.mark.slow
def test_two_that_wait_for_the_same_kernel_have_it_made_once(tmp_path):
    (tmp_path / "tiny.py").write_text(textwrap.dedent(TINY))
    script = """
        import numpy as np, tiny
        print(tiny.walk(np.arange(5.0)))
    """
    # Every file that a compiler writes is named in a list.
    (tmp_path / "sitecustomize.py").write_text(
        textwrap.dedent(f"""
        import sys
        if sys.argv[0] == "-c" and len(sys.argv) > 1:
            from stepwell.kernels import store
            write = store.write
            def listed(name, payload):
                with open({str(tmp_path / "made")!r}, "a") as file:
                    file.write(name + "\\n")
                write(name, payload)
            store.write = listed
        """)
    )
    kept = tmp_path / "kept" / "stepwell"
    kept.mkdir(parents=True)
    paths = os.pathsep.join([str(SOURCE), str(tmp_path)])
    settings = {"NUMBA_CACHE_DIR": str(kept.parent), "STEPWELL_KERNELS": "compiled"}
    with FileLock(kept / "compiling"):
        runs = [
            subprocess.Popen(
                [sys.executable, "-c", textwrap.dedent(script)],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                env={**os.environ, "PYTHONPATH": paths, **settings},
            )
            for _ in range(2)
        ]
        for run in runs:
            assert run.stderr is not None
            assert "compiling walk, once" in run.stderr.readline()
        assert not (tmp_path / "made").exists()
    assert [run.communicate()[0] for run in runs] == ["5.0\n"] * 2
    made = (tmp_path / "made").read_text().split()
    assert sorted(name.split("-")[0] for name in made) == ["halved", "walk"]
