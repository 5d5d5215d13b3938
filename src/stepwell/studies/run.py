"""Run a study: what is missing in its store, on all cores of this machine."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from stepwell.base import ByValue, StepwellError
from stepwell.kernels import cores
from stepwell.mechanism import Chain
from stepwell.studies.fill import fill
from stepwell.studies.mapper import mapped
from stepwell.studies.space import Space
from stepwell.studies.store import PROBLEM, Study, begun, opened

# Of a chunk that nobody has given the size of: some seconds, and files that are not too many.
_CHUNK, _MOST_CHUNKS = 64, 10_000


class SweepError(StepwellError, RuntimeError):
    """A study that could not be finished; what is done stays."""


@dataclass(frozen=True, eq=False)
class Status(ByValue):
    """How far a study is.

    Attributes:
        study: which.
        done: chunks that are there and hold.
        problems: how many designs could not be computed, by the kind of their problem.
    """

    study: Study
    done: int
    problems: dict[str, int]

    @property
    def finished(self) -> bool:
        """Whether nothing is missing."""
        return self.done == self.study.chunks

    def __repr__(self):
        failed = sum(self.problems.values())
        return (
            f"Status({self.done} of {self.study.chunks} chunks done, "
            f"{failed} of {self.study.count} designs with a problem)"
        )


def sweep(
    chain: Chain,
    what: str,
    space: Space,
    folder: str | os.PathLike[str],
    *,
    chunk: int | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Status:
    """Compute something of many designs, into a store that loses nothing.

    A call with the same arguments goes on with what is missing; whatever was killed in between, the
    finished store has the same bytes.

    Args:
        chain: the design that is varied.
        what: is computed: "cycle", "margin", "yield" or "graph".
        space: of its parameters.
        folder: of the store, which xarray opens as Zarr.
        chunk: designs that are computed and written together; by default 64, or more where the
            study has more than 640,000.
        workers: processes at once; one for every core by default.
        progress: called with (done, all) chunks.

    Returns:
        How far it is: finished.

    Raises:
        ValueError: a parameter that the chain does not have, or nothing of that name to compute.
        StudyError: the folder holds another study, or one that another version has begun.
        SweepError: chunks could not be computed or written; the text says why.
        ExtraError: the extra studies is not installed.
    """
    from stepwell.files import dumps

    size = chunk or max(_CHUNK, -(-space.count // _MOST_CHUNKS))
    return resumed(begun(Study(Path(folder), what, dumps(chain), space, size)), workers, progress)


def resumed(
    study: Study,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Status:
    """Compute what is missing of a study; arguments and errors as for `sweep`."""
    missing = study.missing()
    done = study.chunks - len(missing)
    told = str(study.folder), study.identity, study.version
    tasks = ((*told, number) for number in missing)
    failed: list[str] = []
    for task, raised in mapped(fill, tasks, min(workers or cores(), max(len(missing), 1))):
        if raised is not None:
            failed.append(f"chunk {task[-1]}: {raised}")
            if isinstance(
                raised, OSError
            ):  # the disk is full, or gone: no other chunk can do better
                break
            continue
        done += 1
        if progress is not None:
            progress(done, study.chunks)
    if failed:
        more = f"; and {len(failed) - 1} more" if len(failed) > 1 else ""
        raise SweepError(
            f"{study.folder}: {done} of {study.chunks} chunks are done. {failed[0]}{more}. The "
            f"same command goes on with the others."
        )
    return status(study)


def status(study: Study | str | os.PathLike[str]) -> Status:
    """How far a study is, by what its store holds.

    Raises:
        StudyError: the folder holds no study.
    """
    study = study if isinstance(study, Study) else opened(study)
    missing = set(study.missing())
    problems: Counter[str] = Counter()
    for chunk in range(study.chunks):
        if chunk not in missing:
            problems.update(_kinds(study, chunk))
    return Status(study, study.chunks - len(missing), dict(problems.most_common()))


def _kinds(study: Study, chunk: int) -> list[str]:
    rows = study.rows(chunk)
    found = study.column(PROBLEM)[rows.start : rows.stop]
    return [str(one).partition(":")[0] for one in found if one]
