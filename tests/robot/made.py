"""Parts of a robot as boxes, for tests: every body a box of its own size and mass."""

import numpy as np

from stepwell.robot import BodyMass, PartRole, Robot, RobotParts, Shape, body_names

# Half the edges of a box, in signs, and its faces, outward.
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)
# Mass [kg] and edges [m] by the end of a body's name.
BOXES = {
    "body": (0.160, (0.150, 0.120, 0.003)),
    "carriage": (0.0195, (0.020, 0.110, 0.006)),
    "inner.block": (0.010, (0.090, 0.012, 0.003)),
    "outer.block": (0.0058, (0.032, 0.020, 0.003)),
    "lever 1": (0.001, (0.028, 0.008, 0.003)),
    "lever 2": (0.001, (0.028, 0.008, 0.003)),
    "slider": (0.011, (0.020, 0.012, 0.006)),
    "link front": (0.001, (0.008, 0.003, 0.035)),
    "link rear": (0.001, (0.008, 0.003, 0.035)),
    "foot": (0.0035, (0.012, 0.012, 0.012)),
    "antenna": (0.003, (0.130, 0.003, 0.003)),
    "crank": (0.001, (0.014, 0.005, 0.003)),
}
ROLES = {
    "inner.block": PartRole.MIDDLE_BLOCK,
    "outer.block": PartRole.OUTER_BLOCK,
    "lever 1": PartRole.LEVER,
    "lever 2": PartRole.LEVER,
    "slider": PartRole.MIDDLE_BLOCK,
    "link front": PartRole.LINK,
    "link rear": PartRole.LINK,
}


def parts(robot: Robot, heavier: float = 1.0) -> RobotParts:
    """One box for each body, at about its place in the robot; masses times `heavier`."""
    shapes, masses, hinges = [], [], {}
    for name in body_names(robot):
        end = next(end for end in BOXES if name.endswith(end))
        mass, size = BOXES[end]
        mass, centre = mass * heavier, np.array(place(robot, name))
        corners = centre + CORNERS * np.array(size) / 2
        role = PartRole(ROLES.get(end, end))
        shapes.append(Shape(name, f"{name} plate", corners, FACES, role))
        if end in ("body", "inner.block", "outer.block", "carriage", "slider"):
            shapes.append(Shape(name, f"{name} outline", corners, FACES, role, collides=True))
        x, y, z = np.array(size) ** 2
        inertia = np.diag([y + z, x + z, x + y]) * mass / 12
        masses.append(BodyMass(name, mass, centre, inertia))
        if "lever" in end:
            hinges[name] = tuple(centre - lever(robot, name) / 2)
        if end == "crank":
            hinges[name] = tuple(centre + np.array([-0.005, 0.003, 0.0]))
    return RobotParts(shapes, masses, "acrylic-3mm", hinges)


def lever(robot: Robot, name: str) -> np.ndarray:
    """(3,) from the joint of a lever on the inner block to that on the outer one [m].

    Levers of inner cells point away from the midline, those of outer cells back to it.
    """
    leg = next(leg for leg in robot.legs if name.startswith(f"{leg.name}."))
    cell = leg.chain.levers[outer := "outer" in name]
    along, across = np.sin(cell.limit), leg.side * np.cos(cell.limit) * (-1 if outer else 1)
    return cell.lever * np.array([along, across, 0.0])


def place(robot: Robot, name: str) -> tuple[float, float, float]:
    """About where a body is with every cell at 0 [m]."""
    half = robot.foot.span / 2
    for leg in robot.legs:
        x, y = leg.at
        if name.startswith(f"{leg.name}."):
            rest = name.removeprefix(f"{leg.name}.")
            return (
                {
                    "inner.block": (x + half, y + 0.01 * leg.side, 0.019),
                    "outer.block": (x - half, y, 0.019),
                    "slider": (x + half, y, 0.006),
                    "inner.lever 1": (x + half + 0.02, y + 0.005 * leg.side, 0.016),
                    "inner.lever 2": (x + half + 0.04, y + 0.005 * leg.side, 0.016),
                    "outer.lever 1": (x - half, y + 0.005 * leg.side, 0.016),
                    "outer.lever 2": (x - half + 0.02, y + 0.005 * leg.side, 0.016),
                    "link front": (x + half / 2, y, -0.014),
                    "link rear": (x - half / 2, y, -0.014),
                    "foot": (x, y, -0.028),
                }[rest]
                if rest not in ("antenna", "crank")
                else antenna_place(robot, name)
            )
    if name == "carriage":
        return (robot.legs[0].at[0] - half - 0.01, 0.0, 0.012)
    return (0.024, 0.0, 0.008) if name == "body" else antenna_place(robot, name)


def antenna_place(robot: Robot, name: str) -> tuple[float, float, float]:
    """About where an antenna or its crank is at rest [m]."""
    antenna = next(one for one in robot.antennas if name.startswith(f"{one.name}."))
    x, y = antenna.pivot
    if name.endswith("crank"):
        return (0.055, robot.leg(antenna.leg).at[1], 0.024)
    reach = antenna.length / 2
    return (x + reach * np.cos(antenna.angle), y + reach * np.sin(antenna.angle), 0.003)
