"""The comparison with a learned policy: its table is that of its record, within its budget."""

import json
from importlib.util import module_from_spec, spec_from_file_location
from typing import Any

import numpy as np

from docs.pages import ROOT


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
    for row, (_, learns) in zip(RECORD["rows"], learner.contenders().values(), strict=True):
        assert row["numbers"] == learns * learner.plain().size
        assert row["episodes"] == learns * 2 * learner.PAIRS * learner.GENERATIONS
        assert row["off_runs"] == 8 and len(row["best"]) == learns * learner.GENERATIONS


def test_the_strategy_climbs_a_plain_hill():
    # Where the score is the distance from a point, the mean comes nearer.
    goal = learner.plain() + 0.5
    found, scores = learner.evolved(lambda one, _: -float(np.sum((one - goal) ** 2)))
    before = np.sum((learner.plain() - goal) ** 2)
    assert np.sum((found - goal) ** 2) < 0.7 * before and len(scores) == learner.GENERATIONS
