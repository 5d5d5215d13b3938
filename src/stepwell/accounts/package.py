"""The package itself: its installation, its designs, its claims, its folders."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from stepwell import base
from stepwell.accounts.head import About, Row, keys, recorded
from stepwell.accounts.parts import CARD, Account, Fact, RecordTable, Verbatim
from stepwell.base import Quantity, Schema

if TYPE_CHECKING:
    from stepwell.files import Presets
    from stepwell.paper import Verdicts


_PACKAGE: Schema = (
    Quantity("name", head="package"),
    Quantity("version", head="version", none="missing", missing=True),
)
_NAME, _USED_FOR = Quantity("name", head="extra"), Quantity("used_for", head="used for")
_EXTRA: Schema = (_NAME, _USED_FOR, *keys(present=bool, versions={str: str}, install=str))
_KERNELS = keys(
    folder=(str, lambda kept: str(kept.folder)),
    writable=bool,
    compiled=int,
    size_MB=(float, lambda kept: kept.size / 1e6),
)
_TOOL: Schema = (
    Quantity("name", head="tool"),
    _USED_FOR,
    Quantity("found", head="found", none="no", missing=True),
)
_BROKEN: Schema = (Quantity("part", head="part"), Quantity("reason", head="reason"))
# What is reported of an installation.
DOCTOR: Schema = (
    *keys(ok=bool, python=str, system=str, cores=int | None, packages=[_PACKAGE], extras=[_EXTRA]),
    Quantity("kernels", holds=_KERNELS, missing=True),
    *keys(tools=[_TOOL], broken=[_BROKEN]),
)
_PRESET: Schema = (
    Quantity("name", head="name", read=itemgetter(0)),
    Quantity("title", head="title", read=itemgetter(1)),
)
# What is reported of the designs that come with Stepwell.
PRESETS: Schema = keys(presets=([_PRESET], lambda presets: presets.items()))
_ID, _REASON = Quantity("id", head="claim", read="claim.id"), Quantity("reason", head="reason")
_STATEMENT = Quantity("claim", head="statement", read="claim.claim")
_WITHIN = Quantity("tolerance", head="within", read="claim.tolerance")
_COMPARED: Schema = (
    Quantity("where", head="where", read="claim.where"),
    Quantity("paper", head="published", read="claim.paper_value"),
    Quantity("ours", head="Stepwell"),
    Quantity("verdict", head="verdict", read=lambda one: str(one.verdict)),
)
_CLAIM: Schema = (_ID, _STATEMENT, *_COMPARED[:2], _WITHIN, *_COMPARED[2:], _REASON)
# What is reported of verdicts.
PAPER = keys(claims=([_CLAIM], lambda verdicts: verdicts))
# What is reported of a folder; `files.staged_folder` writes it.
FOLDER: Schema = (
    Quantity("command"),
    Quantity("files", holds={str: str}, doc="the SHA-256 of each file by its name"),
)


def installation_account(setup: base.Installation, about: About) -> Account:
    """What is reported of an installation."""
    missing, kernels = setup.missing, setup.kernels
    lacking = [one.install for one in setup.extras if not one.present]
    facts = [
        Fact("Missing", ", ".join(missing)),
        Fact("Repair", "" if setup.ok else "pip install --upgrade --force-reinstall stepwell"),
        Fact("Stepwell", f"{base.__version__}, Python {setup.python}, {setup.system}"),
        Fact("Cores", str(setup.cores or "")),
    ]
    if kernels:
        fix = "no: set a writable folder with NUMBA_CACHE_DIR"
        facts += [
            Fact("Kernels", f"{kernels.compiled} compiled, {kernels.size / 1e6:.0f} MB"),
            Fact("Kept in", str(kernels.folder)),
            Fact("Writable", "yes" if kernels.writable else fix),
        ]
    extras = (_NAME, _USED_FOR, base.Column("installed", _versions))
    sections = {
        "Broken": _table(_BROKEN, setup.broken),
        "Packages": _table(_PACKAGE, setup.packages),
        "Extras": replace(_table(_EXTRA, setup.extras), columns=extras),
        "Extras to install": Verbatim("\n".join(lacking), "commands"),
        "Tools": _table(_TOOL, setup.tools),
    }
    title, hint = "Installation", "No other part is examined before the packages are installed."
    answer, hints = "All packages that Stepwell needs are installed", [hint] if missing else ()
    if not setup.ok:
        answer = "Packages are missing" if missing else "Packages are broken"
    return Account(setup, title, "doctor/1", answer, facts, sections, hints=hints, computed=False)


def _table(of: Schema, rows: Iterable[Any]) -> RecordTable:
    return RecordTable(of, recorded(of, rows), most=None)


def _versions(row: Row) -> str:
    versions = (f"{name} {version}" for name, version in row["versions"].items())
    return ", ".join(versions) if row["present"] else "no"


def presets_account(presets: Presets, about: About) -> Account:
    """What is reported of the designs that come with Stepwell."""
    table = replace(_table(_PRESET, presets.items()), more="designs", level=CARD)
    title, answer = "Designs that come with Stepwell", base.counted(len(presets), "design")
    sections = {"Names and titles": table}
    return Account(presets, title, "presets/1", answer, sections=sections, computed=False)


def verdicts_account(verdicts: Verdicts, about: About) -> Account:
    """What is reported of verdicts."""
    claims, reasons = recorded(_CLAIM, verdicts), [one for one in verdicts if one.reason]
    compared, wide = (_ID, *_COMPARED), (_WITHIN, _STATEMENT)
    given = replace(_table((_ID, _REASON), reasons), more="reasons")
    title = "Validation against published claims"
    answer = f"{verdicts.agreed} of {len(verdicts)} claims agree"
    sections = {
        "Claims": RecordTable(compared, claims, "", wide, None, "claims"),
        "Reasons and limits": given,
    }
    return Account(verdicts, title, "paper/1", answer, sections=sections)
