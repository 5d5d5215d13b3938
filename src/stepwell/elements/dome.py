"""A rubber dome as it was measured: pressed, it collapses, and then it lands on its base."""

from stepwell.base import check
from stepwell.elements.kept import kept
from stepwell.mechanism import Element

# Displacement [mm] and force [gf] while pressed, read off the raw recording at the steps where the
# curve bends; ThereminGoat, force-curves, "AEBoards Raed HE White (60g Dome) 1", 2025-09-20. Its
# author asks for being named and no more. The recording goes on in steps of 0.005 mm and 0.1 gf.
_PRESSED = (
    (0.185, 0.0),
    (0.250, 4.7),
    (0.300, 9.6),
    (0.350, 15.0),
    (0.400, 21.1),
    (0.450, 26.8),
    (0.500, 31.4),
    (0.600, 38.4),
    (0.700, 44.2),
    (0.800, 47.5),
    (0.900, 50.3),
    (1.000, 52.5),
    (1.100, 54.3),
    (1.205, 55.8),
    (1.300, 56.6),
    (1.425, 57.0),
    (1.600, 56.5),
    (1.800, 55.4),
    (2.015, 53.8),
    (2.200, 52.5),
    (2.400, 50.8),
    (2.605, 49.3),
    (2.800, 48.3),
    (3.000, 47.6),
    (3.200, 47.3),
    (3.400, 47.7),
    (3.600, 47.9),
    (3.800, 48.6),
    (3.870, 49.3),
    (3.900, 52.2),
    (3.945, 58.6),
    (4.005, 69.9),
    (4.045, 89.2),
    (4.085, 110.2),
    (4.120, 131.3),
    (4.150, 148.2),
    (4.185, 167.9),
    (4.215, 183.7),
    (4.235, 195.8),
)
_GRAM_FORCE = 9.80665e-3


@kept
def dome(count: int = 1, name: str = "rubber dome") -> Element:
    """A rubber dome of a keyboard switch, from a table of measured numbers.

    It has one place of rest, at travel 0, and is not bistable, but snaps under a force: the force
    rises to 0.559 N at 1.2 mm, falls to 0.464 N at 3.0 mm, and rises steeply from 3.7 mm on, where
    the dome lies on its base. Only the half while pressed is here, of one specimen in its switch,
    whose stem rubs; on the way back the recorded force is smaller. A table of your own is made an
    element by `Element.from_table`.

    Args:
        count: domes side by side, >= 1; their forces add up.
        name: what messages and figures call the element.

    Raises:
        ValueError: a count that is not a whole number, 1 or more.

    Source: ThereminGoat 2025, force-curves, recording "AEBoards Raed HE White (60g Dome) 1".
    """
    count = check.whole("count", count, 1)
    start = _PRESSED[0][0]
    return Element.from_table(
        [(mm - start) * 1e-3 for mm, _ in _PRESSED],
        [count * gf * _GRAM_FORCE for _, gf in _PRESSED],
        name,
        stops=(True, False),
    )
