"""Ctrl-C ends whatever goes on, with one line, and leaves nothing behind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sizes import SIZE, cases

COMMAND = Path(sys.executable).parent / "stepwell"
SLACK = """
[chain]
lever_mm = 14.142135623730951
limit_deg = 45
band = { stiffness_N_per_m = 28.5, rest_length_mm = 24 }

[[chain.cell]]
name = "inner"
p_mm = [-10, 0]
q_mm = [10, 0]

[[chain.cell]]
name = "outer"
p_mm = [-10, 0]
q_mm = [20, 0]
"""

pytestmark = pytest.mark.skipif(os.name != "posix", reason="a terminal's Ctrl-C goes to a group")


def long_chain() -> str:
    """Three thousand cells behind a spring, their bands slack at first: a minute of work."""
    head = SLACK.partition("[[chain.cell]]")[0].replace(
        "= 45\n", "= 45\nactuator_stiffness_N_per_m = 50\n"
    )
    cells = [
        f"[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [{i * 7 % 20}, {i * 11 % 30 - 15}]\n"
        for i in range(3000)
    ]
    return head.replace("24", "18") + "\n".join(cells)


def interrupted(
    after: float, *arguments: str, cwd: Path, begun: Path | None = None
) -> tuple[int, str]:
    """What a command ends with when its whole group hears Ctrl-C; "" if it was done before.

    It hears it `after` so many seconds, and not before there is what says that it has begun.
    """
    process = subprocess.Popen(
        [str(COMMAND), *arguments], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, start_new_session=True,
    )  # fmt: skip
    try:
        process.communicate(timeout=after)
    except subprocess.TimeoutExpired:
        while begun is not None and not begun.exists() and process.poll() is None:
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)
        _, message = process.communicate(timeout=60)
        return process.returncode, message
    pytest.fail(f"{arguments} was done within {after} s")


# One call of a kernel, many calls, a simulation, and many robots on all cores.
LONG = [
    ("run", "long.toml", "--out", "out"),
    ("map", "slack.toml", "--x", "0:20:400", "--out", "out"),
    ("maze", "robot-antennas", "three-walls", "--out", "out"),
    ("robot", "sweep", "robot-forward", "floor.foot_friction=0.3:0.8:400", "--out", "out"),
]
if SIZE == "full":
    LONG += [
        ("yield", "slack.toml", "--samples", "10000000", "--out", "out"),
        ("map", "slack.toml", "--across", "inner.friction=0:0.02:200", "--up",
         "inner.stiffness=20:40:200", "--out", "out"),
        ("design", "0000>0001>0011>0111>1111>1110>1100>1000>0000", "--holes", "1.5",
         "--samples", "10000000"),
    ]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("arguments", LONG, ids=lambda arguments: " ".join(arguments[:2]))
def test_ctrl_c_ends_long_work_with_one_line(tmp_path, arguments):
    (tmp_path / "long.toml").write_text(long_chain())
    (tmp_path / "slack.toml").write_text(SLACK)
    begun = tmp_path / "out" / "unfinished" if arguments[0] == "robot" else None
    code, message = interrupted(2.5, *arguments, cwd=tmp_path, begun=begun)
    assert code == 130, message
    assert len(message.splitlines()) == 1 and message.startswith("Interrupted"), message
    left = {path.name for path in tmp_path.rglob("*")} - {"long.toml", "slack.toml"}
    if arguments[0] == "robot":
        assert "run the same command again" in message
        assert "unfinished" in left
    else:
        # A busy machine may not have begun within that time.
        assert "nothing was written" in message or "before anything was done" in message
        assert left == set()


SWALLOWS = """
import os, signal
try:
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000): pass
except BaseException:
    pass
"""
OPENS = """
import signal, time
from stepwell.cli.screen import _interrupt
signal.signal(signal.SIGINT, _interrupt)
import swallows
try:
    time.sleep(30)
except KeyboardInterrupt:
    print("heard")
"""


RUNS = """
import sys
from stepwell.cli import main
sys.argv = ["stepwell", "run", "long.toml"]
print("begins", flush=True)
main()
"""


@pytest.mark.slow
def test_ctrl_c_is_heard_though_a_module_that_opens_drops_all_exceptions(tmp_path):
    (tmp_path / "swallows.py").write_text(SWALLOWS)
    (tmp_path / "opens.py").write_text(OPENS)
    done = subprocess.run(
        [sys.executable, "opens.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout == "heard\n"


COMPILES = """
import os, signal, time
from llvmlite import binding as llvm
from stepwell.cli.screen import _interrupt
llvm.initialize_native_target()
llvm.initialize_native_asmprinter()
machine = llvm.Target.from_default_triple().create_target_machine()
engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
engine.set_object_cache(lambda *_: os.kill(os.getpid(), signal.SIGINT), lambda *_: None)
signal.signal(signal.SIGINT, _interrupt)
try:
    engine.add_module(llvm.parse_assembly("define i32 @one() { ret i32 1 }"))
    engine.finalize_object()
    time.sleep(30)
except KeyboardInterrupt:
    print("heard")
"""


@pytest.mark.slow
def test_ctrl_c_is_heard_though_the_compiler_drops_exceptions(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", COMPILES], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert done.stdout == "heard\n", done.stderr
    assert "ignored" not in done.stderr


@pytest.mark.slow
def test_ctrl_c_is_heard_where_a_script_runs_a_command_as_it_opens(tmp_path):
    (tmp_path / "long.toml").write_text(long_chain())
    (tmp_path / "runs.py").write_text(RUNS)
    process = subprocess.Popen(
        [sys.executable, "-c", "import runs"], cwd=tmp_path, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None and process.stdout.readline() == "begins\n"
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(1.5)
    process.send_signal(signal.SIGINT)
    _, message = process.communicate(timeout=30)
    assert process.returncode == 130 and message.startswith("Interrupted"), message


PARSES = """
import os, signal, sys
from stepwell.cli import app, main
def interrupted(context, value):
    os.kill(os.getpid(), signal.SIGINT)
app.registered_callback.callback.__annotations__["version"].__metadata__[0].callback = interrupted
sys.argv = ["stepwell", "doctor"]
main()
"""


def test_ctrl_c_before_a_command_begins_ends_with_one_line():
    done = subprocess.run(
        [sys.executable, "-c", PARSES], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 130, done.stderr
    assert done.stderr == "Interrupted before anything was done.\n"


@pytest.mark.slow
@pytest.mark.parametrize("after", cases([0.05, 0.1, 0.15, 0.25, 0.4, 0.7], [0.05, 0.15, 0.4]))
def test_ctrl_c_while_the_program_opens_shows_no_traceback(tmp_path, after):
    (tmp_path / "slack.toml").write_text(SLACK)
    code, message = interrupted(after, "yield", "slack.toml", "--samples", "500000", cwd=tmp_path)
    # Before Python has read the first line of ours, Ctrl-C is Python's own; on a machine with much
    # else to do that takes a while.
    ours = f"stepwell{os.sep}"
    assert code in (130, -signal.SIGINT) or (code == 1 and ours not in message), message
    if code == 130:
        assert len(message.splitlines()) == 1 and message.startswith("Interrupted"), message


# In the quick run one is interrupted above, and another one goes on, in tests/cli/test_robot.py.
@pytest.mark.slow
@pytest.mark.skipif(SIZE == "ci", reason="forty robots, twice")
def test_an_interrupted_sweep_goes_on_where_it_was(tmp_path):
    values = "floor.foot_friction=0.3:0.8:40"
    sweep = [
        str(COMMAND),
        "robot",
        "sweep",
        "robot-forward",
        values,
        "--cycles",
        "1",
        "--out",
        "out",
    ]
    process = subprocess.Popen(
        sweep, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    )  # fmt: skip
    parts = tmp_path / "out" / "unfinished"
    while process.poll() is None and not list(parts.glob("part-*.json")):
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 130 and "run the same command again" in message
    kept = {path.name: path.stat().st_mtime_ns for path in parts.glob("part-*.json")}
    assert kept
    done = subprocess.run(sweep, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert len((tmp_path / "out" / "sweep.csv").read_text().splitlines()) == 41
    assert not parts.exists()


def test_an_interruption_in_a_decoder_is_reported_as_any_other(stepwell, monkeypatch):
    # What Python makes of one there.
    words = "decoding with 'utf-8-sig' codec failed (KeyboardInterrupt: )"

    def read(*_):
        raise KeyboardInterrupt(words)

    monkeypatch.setattr("stepwell.cli.options.read_chain", read)
    result = stepwell("run", "forward.toml")
    assert (result.exit_code, result.stderr) == (130, "Interrupted; nothing was written.\n")
