"""One of every result that a user can hold, small, by the name of its class."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import numpy as np

import stepwell as sw
from claims import committed
from hoppers import hopper, jumped
from lab.values import of_recordings
from stepwell import simulation
from stepwell.accounts import account
from stepwell.base import Installation, StepwellError, have, installation
from stepwell.design import (
    DEFAULT_TOLERANCES,
    Design,
    Impossible,
    Run,
    Tolerances,
    design_tapped,
    fraction_of,
)
from stepwell.paper import AssumedRange, AssumedRanges
from stepwell.proof import ProvedRun
from stepwell.sequences import Machine, realise
from stepwell.studies import Atlas, Axis, GraphClass, SampledGraphs, Space, Status, sweep

_AXES = (Axis("outer.q.x", 0.0, 0.02),)


def _refused(ask: Any) -> StepwellError:
    try:
        ask()
    except StepwellError as why:
        return why
    raise AssertionError("it was to be refused")


def _atlas(chain: sw.Chain) -> Atlas:
    """Of one graph class, as `charted` would give it."""
    one = GraphClass(
        "0a1b2c3d", fraction_of(60, 100), 7, chain, 0.1, fraction_of(9, 10), True, "00>10>11>01>00",
        *(4, 4, 2, 0), True, *(0, 0, 0, 0, 0), ways=(),
    )  # fmt: skip
    counts = (100, 60, 0, 40, 0)
    return Atlas(
        chain, _AXES, "stroke", 0, *counts, DEFAULT_TOLERANCES, (one,), (),
        fraction_of(1, 50), SampledGraphs(0, 0, {}), 0, 0, None, False,
    )  # fmt: skip


def _proofs(cycle: sw.Cycle, design: Design, why: StepwellError) -> tuple[Any, ...]:
    """Of a path, of a run with it, of a margin, a box, a design and a refusal."""
    proof = cycle.path.prove()
    margin = cycle.chain.margin().prove(Tolerances(anchor=0.0001))
    run = ProvedRun.proved(Run.of(cycle.chain), proof)
    assert isinstance(why, Impossible)
    return proof, run, margin, margin.within, design.prove(), why.prove()


def _installation() -> Installation:
    """Of no cores."""
    # A card shows which packages there are; importing them all takes ten seconds.
    with patch("stepwell.base.installed.import_module"):
        return installation(dict.fromkeys(("cores", "kernels", "OpenGL", "display"), lambda: None))


def _study(chain: sw.Chain) -> Status:
    """Of two designs."""
    with TemporaryDirectory() as folder:
        found = sweep(chain, "graph", Space(_AXES), Path(folder) / "few.zarr", workers=0)
        account(found).record  # noqa: B018  reads the store, which is gone after this
    return found


def _compiled() -> simulation.CompiledRobot:
    """Of a small choice, without walks."""
    table = sw.files.load_behaviour("turn-away")
    few = replace(table.choice, inner_bands=(2,), below=(0.0008,), moves=(0.004,))
    found = sw.robot.compile_behaviour(replace(table, choice=few), samples=20)
    return simulation.verified(found, most=0)


@cache
def of_chains() -> dict[str, Any]:
    """Of chains, of what they do and of designs."""
    chain = sw.preset("paper-forward")
    cycle, graph = chain.cycle(), chain.graph()
    axis = np.linspace(0.0, 0.020, 4)
    designed = sw.design("00>01>11>10>00", samples=40)
    impossible = _refused(lambda: sw.design("00>01>11>10>00", holes=0.040))
    values = (
        chain,
        chain.cells[0],
        sw.elements.trilinear(name="snap"),
        cycle,
        cycle.path,
        cycle.sequence,
        cycle.snaps[0],
        cycle.path.landings()[0],
        chain.program("01"),
        _refused(lambda: sw.preset("used-before").program("01")),
        realise(chain, Machine.of_language("(up | down)* up")),
        graph,
        graph.reading,
        chain.implicit_graph(),
        chain.implicit_graph().walked(most=4),
        Run.of(chain),
        chain.margin(),
        chain.robustness(),
        chain.yields(samples=60),
        sw.check(chain, samples=60),
        sw.build(chain, samples=20),
        chain.survival([0.0, 0.040, 0.0], "00", samples=20),
        chain.reprogram("00>01>11>10>00", by="inner.p"),
        _atlas(chain),
        _study(chain),
        committed(),
        sw.presets(),
        _installation(),
        designed,
        impossible,
        design_tapped("00>10>00>01>00", samples=20),
        sw.transition_map(chain, "outer", x=axis, y=axis).stepwell,
        *(_proofs(cycle, designed, impossible) if have("proof") else ()),
    )
    return {type(value).__name__: value for value in values}


def _designed_jump() -> sw.robot.JumpDesign:
    """Of a few holes."""
    means = sw.robot.usual_means(hopper(), hopper().chain.levers[0].lever)
    return sw.robot.design_jump(hopper(), means=means._replace(pitch=0.02), sampling=(20, 0))


@cache
def of_robots() -> dict[str, Any]:
    """Of robots and their runs."""
    robot, arena = sw.preset("robot-explorer"), sw.load_arena("cylinder")
    walk = robot.walk(cycles=1)
    sweep = simulation.sweep([robot], values={"foot.below_mm": [0.3]}, cycles=1)
    values = (
        robot,
        arena,
        sw.preset("robot-left").predict(),  # without antennas it takes half as long
        sw.build(sw.preset("robot-forward")),
        hopper(),
        jumped(),
        _designed_jump(),
        walk,
        robot.maze(arena, limit=4),
        sweep,
        _compiled(),
        simulation.convergence(robot, [0.001, 0.0005], cycles=2),
        AssumedRanges(
            robot, ("00>10>11>01>00",) * 2, (AssumedRange("a", ("b",), 1.0, 1.0, 1.0, "", ""),)
        ),
    )
    return {type(value).__name__: value for value in values}


def every() -> dict[str, Any]:
    """All of them."""
    return {**of_chains(), **of_robots(), **of_recordings()}
