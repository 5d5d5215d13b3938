"""`stepwell program`: what the actuator has to do to bring a chain to a state."""

from functools import partial

from stepwell.cli.options import (
    Design,
    Force,
    From,
    Json,
    Out,
    To,
    free,
    own,
    planned,
    read_chain,
)
from stepwell.cli.screen import answered, finish


def program(
    design: Design,
    start: From = None,
    to: To = None,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find the fewest turning points of the actuator from one state to another.

    Each comes with the window in which turning does the same; or you get the proof that no
    program does it. Without --to, the program in the design file is played, and you are told
    whether it ends as it should. With --out, a figure, the turning points as CSV, the result
    as JSON and the design with the program in it are written into a folder.
    """
    from stepwell import reports, results
    from stepwell.cli.text import chains as texts
    from stepwell.sequences import Unreachable

    text, chain = read_chain(design)
    free(out, "program", force)
    try:
        found = planned(chain, start, to) if start or to else own(text, design)
    except Unreachable as why:
        record, write = results.unreachable_record(chain, start, to, why, design=text), None
    else:
        record = results.program_record(found, design=text)
        write = partial(reports.write_program, found, design=text)
    finish(record, texts.program, as_json, out, force, write)
    answered(record["does_it"])
