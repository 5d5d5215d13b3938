"""`stepwell lab as-built`."""

import pytest

import stepwell as sw
from stepwell.design import parameters


@pytest.mark.slow
def test_the_command_writes_the_build_and_the_move(stepwell):
    line = ("lab", "as-built", "preset:paper-forward", "--seen", "00>01>11>10>00", "--samples", 100)
    result = stepwell(*line, "--out", "out")
    assert result.exit_code == 0, result.output
    built, moved = (sw.load(f"out/{name}.toml") for name in ("built", "moved"))
    assert str(built.cycle().sequence) == "00>01>11>10>00"
    changed = [one.name for one in parameters(built) if one.value(built) != one.value(moved)]
    assert len({name.rpartition(".")[0] for name in changed if name.count(".") > 1}) == 1
    assert "Move q of" in result.stdout
    nothing = stepwell(*line[:3])
    assert nothing.exit_code == 2 and "no observation is given" in nothing.stderr
    for option, text in (("--pulls", "3"), ("--snaps-loading", "a,b")):
        wrong = stepwell(*line[:3], option, text)
        assert wrong.exit_code == 2 and "must be" in wrong.stderr
