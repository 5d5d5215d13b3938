"""Recordings of unit cells tell what their rubber is like, and predict a cell never tested."""

import tempfile
from pathlib import Path

import numpy as np

import stepwell as sw
from stepwell import lab

# A test machine of our own: rubber of 24 N/m that gives back a fifth less, 50 mN of friction.
STIFFNESS, REST_LENGTH = 24.0, 0.008
ANCHORS = {"MB": (0, 0), "MM": (10, 0), "MT": (20, 0), "MRB": (0, -15), "ML": (10, 15)}
rng = np.random.default_rng(8)


def record(file: Path, cell: sw.Cell | None) -> None:
    """Drive a cell from state 0 to 1 and write what the machine writes."""
    travel = np.linspace(0.0, 0.020, 1500)
    force = np.full(1500, 0.050)
    if cell is not None:
        theta = cell.angle(travel)
        length = cell.bands[0].length(theta, cell.lever)
        shorter = np.maximum.accumulate(length) - length
        force += cell.force(theta) * (1 - 0.2 * (1 - np.exp(-shorter / 0.003)))
    force += rng.normal(0.0, 0.005, 1500)
    rows = zip(np.arange(1500) / 25, travel * 1e3, force, strict=True)
    body = "".join(f"{t:.3f},{u:.4f},{f:.4f}\n" for t, u, f in rows)
    file.write_text("Time (s),Displacement (mm),Force (N)\n" + body, "utf-8")


with tempfile.TemporaryDirectory() as folder:
    for code, (x, y) in ANCHORS.items():
        band = sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3), STIFFNESS, REST_LENGTH)
        for run in (1, 2):
            record(Path(folder) / f"1unit_{code}_{run}.csv", sw.Cell(band))
    record(Path(folder) / "friction_1.csv", None)
    recordings = lab.read_all([folder]).recordings

# Against the paper's rubber they differ; calibrated, each is predicted from the others.
for test in lab.compare(recordings).cells:
    print(f"{test.series.name}: {test.rmse:.3f} k r from the paper's rubber")
fitted = lab.calibrate(lab.prepare(lab.sort_series(recordings).series), "linear")
print(f"left out and predicted: {fitted.mean_error(1):.4f} k r")
for parameter in fitted.parameters:
    print(parameter)

stiffness = fitted["stiffness_1"].value
