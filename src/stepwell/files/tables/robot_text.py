"""A robot as the text of a design file."""

from __future__ import annotations

from stepwell.files.schema import robot as schema, table_lines
from stepwell.files.tables.chain_text import NOTHING, Shared, cell_lines, shared_by
from stepwell.files.text import array, quoted
from stepwell.mechanism import Chain
from stepwell.robot import Robot
from stepwell.robot.parts import of_robot


def robot_text(robot: Robot) -> str:
    """The file as a person would write it: what legs and cells share stands once."""
    chains = [leg.chain for leg in robot.legs]
    shared = shared_by([cell for chain in chains for cell in chain.cells])
    alike = all(chain == chains[0] for chain in chains)
    text = ["[chain]", *(_title(chains[0].title) if alike else []), *shared.lines(), ""]
    if alike:
        text += _cells("chain.cell", chains[0], shared)
    return _text(robot, text, shared, own_chains=not alike)


def whole_text(robot: Robot) -> str:
    """The file in which every leg and every cell has all its keys to itself."""
    return _text(robot, [], NOTHING, own_chains=True)


def _text(robot: Robot, chain: list[str], shared: Shared, *, own_chains: bool) -> str:
    odd = robot.unusual or any(of_robot(robot))
    head = _title(robot.title) + (["unusual = true"] if odd else [])
    text = [*head, *([""] if head else []), *chain]
    for name, (table, _) in schema.PARTS.items():
        text += [f"[{name}]", *table_lines(table, getattr(robot, name)), ""]
    for leg in robot.legs:
        text += ["[[leg]]", *table_lines(schema.LegKeys, leg, left_out=["chain"]), ""]
        if own_chains:
            text += ["[leg.chain]", *_title(leg.chain.title), ""] if leg.chain.title else []
            text += _cells("leg.chain.cell", leg.chain, shared)
    for antenna in robot.antennas:
        text += ["[[antenna]]", *table_lines(schema.AntennaKeys, antenna), ""]
    return "\n".join([*text, *_source(robot)]).rstrip("\n") + "\n"


def _cells(table: str, chain: Chain, shared: Shared) -> list[str]:
    return [
        line for cell in chain.cells for line in (f"[[{table}]]", *cell_lines(cell, shared), "")
    ]


def _title(title: str) -> list[str]:
    return [f"title = {quoted(title)}"] if title else []


def _source(robot: Robot) -> list[str]:
    labels = [*schema.SOURCES, *sorted(set(robot.sources.values()) - set(schema.SOURCES))]
    lists = {
        label: [path for path, said in robot.sources.items() if said == label] for label in labels
    }
    lines = [
        f"{label if label.isalpha() else quoted(label)} = {array(map(quoted, paths))}"
        for label, paths in lists.items()
        if paths
    ]
    return ["[source]", *lines] if lines else []
