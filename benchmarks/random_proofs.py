"""Proofs tried against random chains of all kinds, and against wrong answers; a run that resumes.

`python benchmarks/random_proofs.py 1100 --seed 41 --record FILE` proves the cycles of 1100 random
chains of two to six cells, a third each of concave cells, of any cells without friction, and of any
cells. The record has a line a chain; a run that is started again leaves out the chains of the
record. `python tests/docs/proofs.py random` writes the table of the page from it.
"""

import argparse
import json
import re
import signal
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import chains  # pyright: ignore[reportMissingImports]  the one of the tests
import stepwell as sw
from stepwell.proof import prove

RECORD = Path(__file__).resolve().parents[1] / "docs" / "random-proofs.jsonl"
KINDS = "concave", "without friction", "any"
# Longest proof of a chain, in seconds of the processor.
LONGEST = 30
# Of cells whose forces are equal, or constant, the model picks none; forces closer than 1e-9 of the
# largest one count as equal.
_TIES = re.compile("the order of cells|constant force")


class TooLongError(Exception):
    """A proof that took longer than a limit."""


def random_chain(seed: int, k: int) -> tuple[str, sw.Chain, np.random.Generator]:
    """Chain k of a seed: its kind, the chain, and the generator behind it."""
    rng, kind = np.random.default_rng([seed, k]), KINDS[k % len(KINDS)]
    cells = int(rng.integers(2, 7))
    if kind == "concave":
        return kind, chains.concave_chain(rng, cells), rng
    return kind, chains.any_chain(rng, cells, friction=kind == "any"), rng


def row(seed: int, k: int) -> dict[str, Any]:
    """What is proved of a chain: a line of the record.

    `outcome` is proved, tie, not proved, contradicted or no answer; `cause` is that of the first
    gap, since the proof begins again at the engine's answer behind it; `caught` is whether a wrong
    answer was.
    """
    kind, chain, rng = random_chain(seed, k)
    out: dict[str, Any] = {"chain": k, "kind": kind, "cells": len(chain)}
    begin = time.perf_counter()
    try:
        path = chain.cycle().path
    except sw.StepwellError as why:
        return {**out, "outcome": "no answer", "cause": type(why).__name__}
    out["engine_s"] = round(time.perf_counter() - begin, 4)
    begin = time.perf_counter()
    proof = path.prove()
    out |= {"events": len(path.events), "proof_s": round(time.perf_counter() - begin, 3)}
    if proof.proved:
        out["outcome"] = "proved"
        if path.events:
            wrong = chains.corrupted(rng, list(path.events))
            out["caught"] = not prove(path, claims=wrong).proved
        return out
    cause = re.sub(r"\d+", "…", proof.gaps[0].cause)
    tie = _TIES.search(cause)
    out["outcome"] = "tie" if tie else "not proved"
    if any(gap.contradicted for gap in proof.gaps):
        out["outcome"] = "contradicted"
    return {**out, "cause": cause, "gaps": len(proof.gaps)}


def timed_row(seed: int, k: int) -> dict[str, Any]:
    """`row`, or what is known of a chain whose proof takes too long."""

    def stop(*_: Any) -> None:
        raise TooLongError

    signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        return row(seed, k)
    except TooLongError:
        kind, chain, _ = random_chain(seed, k)
        cause = f"a proof of more than {LONGEST} s"
        own = {"chain": k, "kind": kind, "cells": len(chain)}
        return {**own, "outcome": "not proved", "cause": cause}
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def rows_of(record: Path) -> list[dict[str, Any]]:
    """The lines of a record in order of the chains, the last one of each."""
    if not record.exists():
        return []
    lines = [json.loads(line) for line in record.read_text("utf-8").splitlines()]
    return sorted({one["chain"]: one for one in lines}.values(), key=lambda one: one["chain"])


def main() -> None:
    """Add the missing chains to a record."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=41)
    parser.add_argument("--record", type=Path, default=RECORD)
    parser.add_argument("--again", action="store_true", help="try those that are not proved again")
    given = parser.parse_args()
    known = {one["chain"]: one["outcome"] for one in rows_of(given.record)}
    for k in range(given.count):
        if k in known and not (given.again and known[k] in ("not proved", "contradicted")):
            continue
        line = json.dumps(timed_row(given.seed, k), ensure_ascii=False)
        with given.record.open("a", encoding="utf-8") as file:
            file.write(line + "\n")
    for kind in KINDS:
        own = [one["outcome"] for one in rows_of(given.record) if one["kind"] == kind]
        print(kind, {name: own.count(name) for name in dict.fromkeys(own)})


if __name__ == "__main__":
    main()
