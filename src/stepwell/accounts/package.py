"""The package itself: its installation, its designs, its claims, its folders."""

from __future__ import annotations

from collections.abc import Iterable
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from stepwell import base
from stepwell.accounts.head import About, Row, keys, recorded
from stepwell.accounts.parts import CARD, TERMINAL, Account, Fact, RecordTable, Verbatim
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
_KERNELS: Schema = (
    *keys(folder=(str, lambda kernels: str(kernels.folder)), writable=bool, compiled=int),
    *keys(size_MB=(float, lambda kernels: kernels.size / 1e6)),
)
_FOUND = Quantity("found", head="found", none="no", missing=True)
_TOOL: Schema = (Quantity("name", head="tool"), _USED_FOR, _FOUND)
_BROKEN: Schema = (Quantity("part", head="part"), Quantity("reason", head="reason"))
DOCTOR: Schema = (
    *keys(ok=bool, python=str, system=str, cores=int | None, packages=[_PACKAGE], extras=[_EXTRA]),
    Quantity("kernels", holds=_KERNELS, missing=True),
    *keys(tools=[_TOOL], broken=[_BROKEN]),
)
_PRESET: Schema = (
    Quantity("name", head="name", read=itemgetter(0)),
    Quantity("title", head="title", read=itemgetter(1)),
)
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
PAPER = keys(claims=([_CLAIM], lambda verdicts: verdicts))
# What is reported of a folder; `files.staged_folder` writes it.
_HASHES = Quantity("files", holds={str: str}, doc="the SHA-256 of each file by its name")
FOLDER: Schema = (Quantity("command"), _HASHES)


def installation_account(setup: base.Installation, about: About) -> Account:
    """Packages, tools and machine code of an installation."""
    missing, kernels = setup.missing, setup.kernels
    again = f"pip install --upgrade --force-reinstall {base.SOURCE}{base.IN_CLONE}"
    facts = [
        Fact("Missing", ", ".join(missing)),
        Fact("Repair", "" if setup.ok else again),
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
    lacking = [one.install for one in setup.extras if not one.present]
    extras = (_NAME, _USED_FOR, base.Column("installed", _versions))
    sections = {
        "Broken": _table(_BROKEN, setup.broken),
        "Extras": RecordTable(extras, recorded(_EXTRA, setup.extras)),
        f"Extras to install{base.IN_CLONE}": Verbatim("\n".join(lacking), "commands"),
        "Tools": _table(_TOOL, setup.tools),
        "Packages": _table(_PACKAGE, setup.packages),
    }
    title, hint = "Installation", "No other part is examined before the packages are installed."
    answer, hints = "All packages that Stepwell needs are installed", [hint] if missing else ()
    if not setup.ok:
        answer = "Packages are missing" if missing else "Packages are broken"
    return Account(setup, title, "doctor/1", answer, facts, sections, hints=hints, computed=False)


def _table(columns: Schema, rows: Iterable[Any], **shown: Any) -> RecordTable:
    return RecordTable(columns, recorded(columns, rows), **shown)


def _versions(row: Row) -> str:
    versions = (f"{name} {version}" for name, version in row["versions"].items())
    return ", ".join(versions) if row["present"] else "no"


def presets_account(presets: Presets, about: About) -> Account:
    """Names and titles of the designs that come with Stepwell."""
    title, answer = "Designs that come with Stepwell", base.counted(len(presets), "design")
    sections = {"Names and titles": _table(_PRESET, presets.items(), more="designs", level=CARD)}
    hints = ["`stepwell run preset:NAME` computes a chain, `stepwell walk NAME` simulates a robot."]
    hints += ["`stepwell new my.toml --preset NAME` writes a copy to edit."]
    return Account(
        presets, title, "presets/1", answer, sections=sections, hints=hints, computed=False
    )


def verdicts_account(verdicts: Verdicts, about: About) -> Account:
    """Published claims compared with results of Stepwell."""
    claims, reasons = recorded(_CLAIM, verdicts), [one for one in verdicts if one.reason]
    compared, wide = (_ID, *_COMPARED), (_WITHIN, _STATEMENT)
    sections = {
        "Claims": RecordTable(compared, claims, "", wide, "claims"),
        "Reasons and limits": _table((_ID, _REASON), reasons, more="reasons"),
    }
    answer = f"{verdicts.agreed} of {len(verdicts)} claims agree"
    others = base.grouped((str(one.verdict), one.claim.id) for one in verdicts)
    others.pop("agrees", None)
    facts = [Fact(base.headed(kind), ", ".join(ids), TERMINAL) for kind, ids in others.items()]
    title = "Validation against published claims"
    return Account(verdicts, title, "paper/1", answer, facts, sections)
