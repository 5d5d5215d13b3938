"""The comparison with a learned policy: its table is that of its record, within its budget."""

import json
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from typing import Any

import numpy as np

from docs.pages import ROOT
from stepwell.simulation import sweep


def _benchmark(name: str) -> Any:
    """A script of the folder of benchmarks, which is no package."""
    spec = spec_from_file_location(name, ROOT / "benchmarks" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


learner = _benchmark("learner")

RECORD = json.loads(learner.FILE.read_text("utf-8"))


def test_the_table_of_the_page_is_that_of_the_record():
    assert learner.page(RECORD) == learner.PAGE.read_text("utf-8"), "run it with --page"
    assert [row["name"] for row in RECORD["rows"]] == [*learner.contenders()]


def test_numbers_and_episodes_are_those_of_the_budget():
    budget = RECORD["generations"], RECORD["pairs"]
    for row, (_, learns) in zip(RECORD["rows"], learner.contenders().values(), strict=True):
        assert row["numbers"] == learns * learner.plain().size
        assert row["episodes"] == learns * learner.episodes(*budget)
        assert row["off_runs"] == 8 and len(row["checks"]) == learns * (budget[0] + 1)


def test_the_strategy_climbs_a_plain_hill_and_returns_its_highest_place():
    # Where the score is the distance from a point, the mean comes nearer.
    goal = learner.plain() + 0.5

    def height(one: Any) -> float:
        return -float(np.sum((one - goal) ** 2))

    found, checks = learner.evolved(lambda one, _: height(one), height, (6, 4))
    assert height(found) > 0.7 * height(learner.plain()) and len(checks) == 7
    # A cliff behind the first policy: no later one is returned.
    first, _ = learner.evolved(
        lambda one, _: height(one), lambda one: -abs(height(one) - height(learner.plain())), (2, 2)
    )
    assert np.array_equal(first, learner.plain())


def test_unequal_legs_turn_to_either_side_by_their_strokes_alone():
    legs, _ = learner.contenders()["unequal legs, learned strokes"]
    assert not any(one.connected for one in legs.antennas)
    shorter = replace(legs, drive=replace(legs.drive, amplitude=0.9 * legs.drive.amplitude))
    full, short = sweep([legs, shorter], cycles=3).trials
    assert full.turn > 0.03 > -0.03 > short.turn
