"""Atlas from its store: transition graphs with their memory and yields, and proofs."""

import json
from collections import Counter
from collections.abc import Iterable, Sequence as Sized
from dataclasses import replace
from itertools import islice, zip_longest
from typing import Any

import numpy as np

from stepwell.base import InputError, Progress, StepwellError, tracked
from stepwell.concave import (
    DECIDED,
    classed,
    closed_graph,
    motion_orders,
    proved_ends,
    sampled_cells,
)
from stepwell.design import DEFAULT_TOLERANCES, Draws, Fraction, Tolerances, fraction_of
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, TransitionGraph
from stepwell.studies import graph_classes as classes
from stepwell.studies.blocks import CLOSED_FORM, COUNTS, DRIVES, Packed, packed
from stepwell.studies.designs import IndependentBlocks, changed
from stepwell.studies.graph_classes import Atlas, GraphClass, possible, proved_space
from stepwell.studies.store import Study

# Candidate designs of a graph whose yields are compared: those with the largest gaps.
_CANDIDATES = 8
# Samples of each candidate, until one of them is selected.
_FEW = 100

_Best = list[tuple[float, int]]


def charted(
    study: Study,
    *,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    samples: int = 1000,
    checks: int = 100,
    progress: Progress = None,
) -> Atlas:
    """The atlas of all finished blocks of a store that `atlas` has begun.

    Args:
        tolerances: tolerances of anchors, stiffness and rest length.
        samples: number of samples of each design.
        checks: largest number of designs with, and of designs without, a closed form that the
            engine simulates.
        progress: called with (done, total) graphs.

    Raises:
        ValueError: another study, no finished block, or tolerances of other parameters.
    """
    designs, done = _require_blocks(study, tolerances), study.done_chunks()
    chain = study.subject
    assert isinstance(chain, Chain)
    drive = str(study.given.get("drive", "stroke"))
    space = _Space(study, packed(chain, [axis.name for axis in designs.axes]), DRIVES[drive])
    sums = {name: int(np.sum(study.values(name, done))) for name in COUNTS}
    graphs, cycles = (_merged(study.values(name, done)) for name in ("graphs", "cycles"))
    total = designs.size * sum(len(study.rows(chunk)) for chunk in done)
    closed_form = sums.pop(CLOSED_FORM)
    graph_classes = [
        space.graph_class(key, fraction_of(count, closed_form), best, tolerances, samples)
        for key, (count, best) in tracked(graphs.items(), progress)
    ]
    known = closed_form + sums["wakes"]
    agreed, checked = space.agreement(checks)
    allowed = possible(len(chain), space.drive)
    return Atlas(
        chain,
        tuple(designs.axes),
        drive,
        designs.seed,
        total,
        closed_form,
        **sums,
        tolerances=tolerances,
        graph_classes=tuple(graph_classes),
        cycles=tuple(
            space.full_cycle(code, fraction_of(n, known), b) for code, (n, b) in cycles.items()
        ),
        unseen=_unseen(study, done),
        sampled=space.sampled(_asked(study, done, checks)),
        checked=checked,
        agreed=agreed,
        possible=None if allowed is None else len(allowed),
        space_proved=proved_space(chain, tuple(designs.axes)),
    )


def _require_blocks(study: Study, tolerances: Tolerances) -> IndependentBlocks:
    if not isinstance(study.designs, IndependentBlocks) or study.what != "atlas":
        raise InputError(f"{study.folder}: must contain an atlas, but contains {study!r}.")
    if not study.done_chunks():
        raise InputError(f"{study.folder}: no block is finished yet: run the same command again.")
    if tolerances.cells:
        raise InputError(
            "tolerances by cell: must be one for all cells, because the cells of an atlas are any "
            "of its designs."
        )
    if tolerances.friction or tolerances.travel or tolerances.lever:
        raise InputError(
            "tolerances: lever, friction and travel must be 0, because cells of an atlas have one "
            "travel."
        )
    return study.designs


def _merged(blocks: Iterable[str]) -> dict[int, tuple[int, _Best]]:
    """Count and best designs (by falling gap) of every key, the most frequent first."""
    counts, best = Counter[int](), dict[int, _Best]()
    for text in blocks:
        for key, count, gap, design in json.loads(str(text)):
            counts[key] += count
            best.setdefault(key, []).append((-gap, design))
    return {
        key: (count, [(-gap, design) for gap, design in sorted(best[key])[:_CANDIDATES]])
        for key, count in sorted(counts.items(), key=lambda one: (-one[1], one[0]))
    }


def _unseen(study: Study, done: Sized[int]) -> Fraction | None:
    """Fraction of designs of the second half with a graph that does not occur in the first half. It
    bounds the fraction of designs with a graph that occurs in neither half.
    """
    half = len(done) // 2
    if not half:
        return None
    known = _merged(study.values("graphs", done[:half])).keys()
    later = {key: count for key, (count, _) in _merged(study.values("graphs", done[half:])).items()}
    return fraction_of(sum(later[key] for key in later.keys() - known), sum(later.values()))


def _asked(study: Study, done: Sized[int], most: int) -> list[int]:
    """Designs without a closed form: the first of every block, then the second."""
    designs = [json.loads(str(text)) for text in study.values("asked", done)]
    turns = (design for turn in zip_longest(*designs) for design in turn if design is not None)
    return list(islice(turns, most))


class _Space:
    """Designs of a study by number, and their graphs and yields."""

    def __init__(self, study: Study, numbers: Packed, drive: int):
        assert isinstance(study.designs, IndependentBlocks)
        self.study, self.numbers, self.drive = study, numbers, drive
        self.space = study.designs.space
        self.names = [axis.name for axis in study.designs.axes]

    def chain(self, design: int) -> Chain:
        """A design as a chain."""
        return self.made(self.space.points(design, design + 1)[0].tolist())

    def made(self, point: Sized[float]) -> Chain:
        made = changed(self.study.subject, self.names, point)
        assert isinstance(made, Chain)
        return made

    def graph(self, chain: Chain) -> TransitionGraph:
        return chain.graph("force" if self.drive else None)

    def cells(self, design: int) -> Any:
        """(N, 6) parameters of the cells of a design."""
        return self.numbers.at(self.space.points(design, design + 1))[0]

    def name(self, chain: Chain) -> str:
        """Name of a chain's graph, computed by the general engine."""
        return classes.name_of(classes.canonical(classes.ways_of(self.graph(chain)), len(chain)))

    def graph_class(
        self, key: int, fraction: Fraction, best: _Best, tolerances: Tolerances, samples: int
    ) -> GraphClass:
        """A graph with its most robust design: the candidate with the highest yield."""
        # The selection uses its own samples, so that it does not bias the yield.
        other, few = self.space.seed + 1, min(samples, _FEW)
        kept = [
            self._kept(key, Draws(self.chain(design), tolerances, other), design, few)[0]
            for _, design in best
        ]
        gap, design = best[int(np.argmax(kept))]
        chain, cells = self.chain(design), self.cells(design)
        ways = closed_graph(cells, self.drive)
        name = classes.name_of(classes.canonical(ways, len(chain)))
        draws = Draws(chain, tolerances, self.space.seed)
        times, others = self._kept(key, draws, design, samples)
        times += sum(self._followed(draws, number) == name for number in others)
        graph = self.graph(chain)
        agrees = sorted(classes.ways_of(graph)) == sorted(ways)
        reading, vertices, reached = graph.reading, graph.vertices, graph.reachable()
        counts, by_hand = (
            max(
                (one.transient for one in reading.counting.accumulators if one.by_hand == hand),
                default=0,
            )
            for hand in (False, True)
        )
        loading, unloading = (order.tolist() for order in motion_orders(proved_ends(cells)[0]))
        # Cells are numbered in loading order.
        again = [loading.index(cell) for cell in unloading]
        cycle = Sequence.full_cycle(range(len(loading)), again)
        return GraphClass(
            name,
            fraction,
            design,
            chain,
            gap,
            fraction_of(times, samples),
            agrees,
            str(cycle),
            len(vertices),
            sum(vertex in reached for vertex in vertices),
            sum(snaps for *_, snaps in ways),
            reading.sub_loop_count,
            reading.return_point_memory.holds,
            len(reading.scrambling),
            counts,
            by_hand,
            len(reading.garden_of_eden or ()),
            len(reading.latches),
            ways,
        )

    def _kept(self, key: int, draws: Draws, design: int, samples: int) -> tuple[int, list[int]]:
        """Number of samples of a design with this graph, and the samples without a closed form."""
        cells, times, first, others = self.cells(design), 0, 0, list[int]()
        for piece in draws.chunks(samples):
            keys, _, _, verdict = classed(sampled_cells(piece, cells, draws.spread), self.drive)
            times += int(np.sum(keys == key))
            others += (first + np.flatnonzero(verdict != DECIDED)).tolist()
            first += len(piece)
        return times, others

    def _followed(self, draws: Draws, number: int) -> str:
        """Name of a sample's graph, computed by the general engine; "" if that fails."""
        try:
            return self.name(draws.sample(number))
        except StepwellError:
            return ""

    def full_cycle(self, code: int, fraction: Fraction, best: _Best) -> classes.FullCycle:
        """A cycle with its most robust design."""
        gap, design = best[0]
        n = len(self.numbers.base)
        digits = [code // n**k % n for k in reversed(range(2 * n))]
        cycle = str(Sequence.full_cycle(digits[:n], digits[n:]))
        return classes.FullCycle(cycle, fraction, design, self.chain(design), gap)

    def agreement(self, most: int) -> tuple[int, int]:
        """Number of new designs for which engine and closed form agree, and number of designs."""
        seed = self.space.seed + 1
        points = replace(self.space, seed=seed, count=max(self.space.count, most)).points(0, most)
        _, _, _, verdict = classed(self.numbers.at(points), self.drive)
        checked, agreed = points[verdict == DECIDED], 0
        for point in checked:
            ways = classes.ways_of(self.graph(self.made(point.tolist())))
            agreed += sorted(ways) == sorted(
                closed_graph(self.numbers.at(point[None])[0], self.drive)
            )
        return agreed, len(checked)

    def sampled(self, designs: Sized[int]) -> classes.SampledGraphs:
        """Result of the engine for these designs."""
        counts, failed = Counter[str](), 0
        for design in designs:
            try:
                counts[self.name(self.chain(design))] += 1
            except StepwellError:
                failed += 1
        return classes.SampledGraphs(len(designs), failed, dict(counts.most_common()))
