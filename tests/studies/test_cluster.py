"""A Dask cluster fills a study as this machine does, whoever of it is killed."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import stepwell as sw
from facts import refuses
from sizes import examples

pytest.importorskip("distributed", reason="clusters are not tested: distributed is not installed")
pytest.importorskip("zarr", reason="clusters are not tested: zarr is not installed")

from stepwell.studies import Axis, Space, SweepError, opened, resumed, status, sweep
from studies_bytes import bytes_of

LEG = sw.preset("paper-forward")
GRID = Space((Axis("outer.q.x", 0.0, 0.020, 9), Axis("outer.q.y", -0.015, 0.015, 7)))
KILLS = examples(1, 40)


class Cluster:
    """A scheduler and two workers, as somebody would start them by hand on three machines."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.file = folder / "scheduler.json"
        options = "--host 127.0.0.1 --port 0 --no-dashboard --scheduler-file"
        self.scheduler = self._started("scheduler", *options.split(), str(self.file))
        while not self.file.exists():
            assert self.scheduler.poll() is None
            time.sleep(0.05)
        self.address = json.loads(self.file.read_text())["address"]
        self.workers = [self.worker() for _ in range(2)]

    def worker(self) -> "subprocess.Popen[bytes]":
        options = ["--nthreads", "1", "--no-dashboard", "--no-nanny", "--local-directory"]
        return self._started("worker", self.address, *options, str(self.folder))

    def _started(self, what: str, *options: str) -> "subprocess.Popen[bytes]":
        silent = subprocess.DEVNULL
        command = [sys.executable, "-m", "distributed.cli.dask_" + what, *options]
        return subprocess.Popen(command, stdout=silent, stderr=silent)

    def end(self) -> None:
        for one in (*self.workers, self.scheduler):
            one.kill()
            one.wait()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory) -> Iterator[Cluster]:
    """One for both tests: the last of them kills it."""
    running = Cluster(tmp_path_factory.mktemp("cluster"))
    yield running
    running.end()


@pytest.mark.slow
def test_a_cluster_whose_workers_are_killed_writes_what_this_machine_writes(tmp_path, cluster):
    here, there = tmp_path / "here.zarr", tmp_path / "there.zarr"
    sweep(LEG, "cycle", GRID, here, chunk=4, workers=0)
    luck, killed = random.Random(4), []

    def kill(done: int, _all: int) -> None:
        if done % 3 == 1 and len(killed) < KILLS:
            number = luck.randrange(2)
            os.kill(cluster.workers[number].pid, signal.SIGKILL)
            killed.append(number)
            cluster.workers[number].wait()
            cluster.workers[number] = cluster.worker()

    result = sweep(LEG, "cycle", GRID, there, chunk=4, scheduler=cluster.address, progress=kill)
    assert result.finished and killed
    assert bytes_of(there) == bytes_of(here)


@pytest.mark.slow
def test_a_scheduler_that_is_killed_is_reported_and_another_one_goes_on(tmp_path, cluster):
    folder = tmp_path / "s.zarr"

    def kill(done: int, _all: int) -> None:
        if done == 2:
            cluster.scheduler.kill()

    with refuses(SweepError, "16 chunks", "scheduler", "resume"):
        sweep(LEG, "cycle", GRID, folder, chunk=4, scheduler=cluster.address, progress=kill)
    assert 2 <= status(folder).done < 16
    with refuses(SweepError, "chunks", cluster.address, "no Dask scheduler"):
        resumed(opened(folder), scheduler=cluster.address)
    assert resumed(opened(folder), 0).finished
