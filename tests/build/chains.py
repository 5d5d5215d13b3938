"""Chains for tests of builds."""

import math

import stepwell as sw

mm = 1e-3


def band(p, q, **more):
    """A band with anchors in mm."""
    return sw.Band(p=(mm * p[0], mm * p[1]), q=(mm * q[0], mm * q[1]), **more)


def cell(p, q, lever=14.142135623730951, limit=45.0):
    """A cell with one band, lengths in mm and degrees."""
    return sw.Cell(band(p, q), lever=mm * lever, limit=math.radians(limit))


def pair():
    """The paper's forward pair."""
    return sw.load("preset:paper-forward")


def mixed():
    """Three cells with other levers and limits each, stopped by faces."""
    return sw.Chain(
        [
            cell((-10, 0), (10, 0), 20.0, 40.0),
            cell((-10, 0), (20, 0), 14.1, 50.0),
            cell((-10, 0), (5, 10), 30.0, 36.0),
        ]
    )


def slotted():
    """Two cells that arc slots stop."""
    return sw.Chain([cell((-10, 0), (10, 0), 30.0, 25.0), cell((-10, 0), (20, 0), 20.0, 62.0)])


def crossed():
    """Four bands in a cell that cross each other, and two bands on the same hooks."""
    inner = [
        band((-10, 0), (10, 0)),
        band((-10, 5), (10, -15), rest_length=0.012),
        band((-10, -5), (20, 15), rest_length=0.012),
        band((-5, 0), (0, 0)),
    ]
    return sw.Chain([sw.Cell(inner), sw.Cell([band((-10, 0), (20, 0))] * 2)])


def steep():
    """A limit at which the two levers of the cell meet."""
    return sw.Chain([cell((-10, 0), (10, 0), 30.0, 70.0)])


def eight():
    """Eight cells."""
    return sw.Chain([cell((-10, 0), (2.5 * i, 0)) for i in range(1, 9)])
