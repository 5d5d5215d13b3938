"""The package itself: its installation, its designs, its claims, its folders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from stepwell import base
from stepwell.accounts.head import About
from stepwell.accounts.parts import Account, Fact, Level, RecordTable, Section, Verbatim
from stepwell.base import Quantity, Schema

if TYPE_CHECKING:
    from stepwell.files import Presets
    from stepwell.paper import Verdicts


_PACKAGE: Schema = (
    Quantity("name", head="package"),
    Quantity("version", head="version", none="missing", missing=True),
)
_NAME, _USED_FOR = Quantity("name", head="extra"), Quantity("used_for", head="used for")
_EXTRA: Schema = (
    _NAME,
    _USED_FOR,
    *base.quantities(present=bool, versions={str: str}, install=str),
)
_HERE = base.Column("installed", lambda row: _versions(row))
_KERNELS: Schema = (
    Quantity("folder", read=lambda kept: str(kept.folder)),
    *base.quantities(writable=bool, compiled=int),
    Quantity("size_MB", read=lambda kept: kept.size / 1e6, holds=float),
)
_TOOL: Schema = (
    Quantity("name", head="tool"),
    _USED_FOR,
    Quantity("found", head="found", none="no", missing=True),
)
_BROKEN: Schema = (Quantity("part", head="part"), Quantity("reason", head="reason"))


# What is reported of an installation.
DOCTOR: Schema = (
    *base.quantities(
        ok=bool, python=str, system=str, cores=int | None, packages=[_PACKAGE], extras=[_EXTRA]
    ),
    Quantity("kernels", holds=_KERNELS, missing=True),
    *base.quantities(tools=[_TOOL], broken=[_BROKEN]),
)


def installation_account(found: base.Installation, about: About) -> Account:
    """What is reported of an installation."""
    missing, kernels = found.missing, found.kernels
    lacking = [one.install for one in found.extras if not one.present]
    return Account(
        found,
        "Installation",
        "doctor/1",
        DOCTOR,
        answer=_answer(found),
        computed=False,
        facts=(
            Fact("Missing", ", ".join(missing)),
            Fact("Repair", "" if found.ok else "pip install --upgrade --force-reinstall stepwell"),
            Fact("Stepwell", f"{base.__version__}, Python {found.python}, {found.system}"),
            Fact("Cores", str(found.cores or "")),
            Fact("Kernels", _kernel_words(kernels) if kernels else ""),
            Fact("Kept in", str(kernels.folder) if kernels else ""),
            Fact("Writable", _writable(kernels.writable) if kernels else ""),
        ),
        sections=(
            Section("Broken", _table(_BROKEN, found.broken)),
            Section("Packages", _table(_PACKAGE, found.packages)),
            Section("Extras", _table(_EXTRA, found.extras, (_NAME, _USED_FOR, _HERE))),
            Section("Extras to install", Verbatim("\n".join(lacking), "commands")),
            Section("Tools", _table(_TOOL, found.tools)),
        ),
        hints=["No other part is examined before the packages are installed."] if missing else (),
    )


def _table(of: Schema, rows: Sequence[Any], columns: base.Columns = ()) -> RecordTable:
    found = [base.record(of, one) for one in rows]
    return RecordTable(columns or of, lambda: found, most=None)


def _answer(found: base.Installation) -> str:
    if found.ok:
        return "All packages that Stepwell needs are installed"
    return "Packages are missing" if found.missing else "Packages are broken"


def _kernel_words(kept: Any) -> str:
    return f"{kept.compiled} compiled, {kept.size / 1e6:.0f} MB"


def _writable(writable: bool) -> str:
    return "yes" if writable else "no: set a writable folder with NUMBA_CACHE_DIR"


def _versions(row: Mapping[str, Any]) -> str:
    versions = (f"{name} {version}" for name, version in row["versions"].items())
    return ", ".join(versions) if row["present"] else "no"


_PRESET: Schema = (
    Quantity("name", head="name", read=lambda one: one[0]),
    Quantity("title", head="title", read=lambda one: one[1]),
)


# What is reported of the designs that come with Stepwell.
PRESETS: Schema = (Quantity("presets", read=lambda found: found.items(), holds=[_PRESET]),)


def presets_account(found: Presets, about: About) -> Account:
    """What is reported of the designs that come with Stepwell."""
    rows = [base.record(_PRESET, one) for one in found.items()]
    table = RecordTable(_PRESET, lambda: rows, most=None, more="designs", level=Level.CARD)
    return Account(
        found,
        "Designs that come with Stepwell",
        "presets/1",
        PRESETS,
        answer=base.counted(len(found), "design"),
        computed=False,
        sections=(Section("Names and titles", table),),
    )


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
PAPER: Schema = (Quantity("claims", read=lambda found: found, holds=[_CLAIM]),)


def verdicts_account(found: Verdicts, about: About) -> Account:
    """What is reported of verdicts."""
    rows = [base.record(_CLAIM, one) for one in found]
    reasons = [row for row in rows if row["reason"]]
    compared, wide = (_ID, *_COMPARED), (_WITHIN, _STATEMENT)
    return Account(
        found,
        "Validation against published claims",
        "paper/1",
        PAPER,
        answer=f"{found.agreed} of {len(found)} claims agree",
        sections=(
            Section("Claims", RecordTable(compared, lambda: rows, "", wide, None, "claims")),
            Section(
                "Reasons and limits",
                RecordTable((_ID, _REASON), lambda: reasons, most=None, more="reasons"),
            ),
        ),
    )


# What is reported of a folder; `files.staged_folder` writes it.
FOLDER: Schema = (
    Quantity("command"),
    Quantity("files", holds={str: str}, doc="the SHA-256 of each file by its name"),
)
