"""A verdict on a design as people read it: on one screen, the answer first."""

from typing import Any

from stepwell.base import percent
from stepwell.cli.screen import show_facts, show_text
from stepwell.cli.text.chains import calibrated
from stepwell.mechanism import Chain
from stepwell.results import (
    killer_words,
    measure_words,
    pull_words,
    tolerance_words,
    verdict_words,
)


def check(record: dict[str, Any], chain: Chain) -> None:
    """Print what `results.check_record` returns of a chain."""
    low, high = percent(record["share_low"]), percent(record["share_high"])
    tolerances = tolerance_words(record["tolerances"], chain)
    found = {
        "Verdict": verdict_words(record),
        "Wanted": record["wanted"],
        "Does": "" if record["does_it"] else record["does"],
        "Yield": f"{percent(record['share'])}, with 95 % confidence {low} to {high}",
        "Made": f"{record['samples']} mechanisms with {tolerances}",
        "Killer": killer_words(record, chain),
        "Pull": pull_words(record, chain),
        "Measure": measure_words(record, chain),
    }
    show_facts(record, found, 9)
    for head, lines in (
        ("Out of the ordinary", record["oddities"]),
        ("Too close to call", record["ties"]),
    ):
        if lines:
            show_text(f"{head}: {lines[0]}", *lines[1:])
    calibrated(record)
    show_text(record["assumptions"])
