"""Every example's picture, drawn from what the example computed.

`python tests/docs/example_pictures.py [NAME...]` runs the examples, all of them or those named, and
writes docs/img/examples; examples/README.md shows the pictures.
"""

from __future__ import annotations

import contextlib
import io
import runpy
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell import figures
from stepwell.design import boundaries

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES, PICTURES = ROOT / "examples", ROOT / "docs" / "img" / "examples"
DPI = 130
Names = dict[str, Any]


def _map(of: Names) -> Figure:
    curves = boundaries(of["leg"], "outer", x=of["x"], y=of["y"])
    design = {"this leg": of["leg"].cells[1].bands[0].q}
    return figures.transition_map(of["found"], curves, design)


def _counting(of: Names) -> Figure:
    return figures.travel_stroke(of["counter"].path([0.040, *[0.068, 0.040] * 3], start="01001"))


def _placed(of: Names) -> Figure:
    made = of["made"]
    return figures.force_plane(
        made.chain,
        loading=made.loading,
        unloading=made.unloading,
        places=np.concatenate(made.region),
        clouds=made.yield_.end_forces(400),
    )


# What is drawn of the names that an example leaves behind.
DRAWN: MappingProxyType[str, Callable[[Names], Figure]] = MappingProxyType(
    {
        "01_sequence_of_a_leg": lambda of: figures.force_stroke(of["cycle"]),
        "02_transition_map": _map,
        "03_turning_back_early": lambda of: figures.landscape(of["past"]),
        "04_between_stroke_and_force": lambda of: figures.force_stroke(of["cycle"]),
        "05_friction_and_weight": lambda of: figures.force_stroke(of["rubbing"][0]),
        "06_ten_cells": lambda of: figures.travel_stroke(of["cycle"]),
        "07_when_order_does_not_say_it_all": lambda of: figures.travel_stroke(of["cycle"]),
        "08_walk": lambda of: figures.gait(of["walk"]),
        "09_turn_by_one_anchor": lambda of: figures.trajectories(
            {"one anchor moved": of["around"]}
        ),
        "10_antennas_in_the_three_wall_arena": lambda of: figures.maze(of["way"]),
        "11_calibrate_a_rubber": lambda of: figures.calibration(of["fitted"]),
        "12_turning_points": lambda of: figures.stroke_program(of["program"]),
        "13_countdown": _counting,
        "14_design_a_cycle": _placed,
        "15_what_an_antenna_must_deliver": lambda of: figures.force_stroke(
            of["pushed"].chain_after.cycle()
        ),
        "16_six_legs_on_one_actuator": lambda of: figures.gait(of["walks"]["six"], cycles=1),
        "17_two_finger_gripper": lambda of: figures.travel_stroke(
            of["chain"].path([0.0, 0.048, 0.040, 0.0])
        ),
    }
)


def main() -> None:
    """Run examples and draw them; how long each took is printed."""
    PICTURES.mkdir(exist_ok=True)
    for name in sys.argv[1:] or DRAWN:
        began = time.perf_counter()
        with contextlib.redirect_stdout(io.StringIO()):
            names = runpy.run_path(str(EXAMPLES / f"{name}.py"))
        print(f"{name}: {time.perf_counter() - began:.1f} s", flush=True)
        figures.save(DRAWN[name](names), PICTURES / f"{name}.png", dpi=DPI)


if __name__ == "__main__":
    main()
