"""Lazy imports: names of a package on first use, and the optional extras."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from types import MappingProxyType
from typing import Any, NamedTuple

from stepwell.base.errors import ExtraError

# What pip installs. No index has Stepwell yet, so it is the folder of a clone. A release on an
# index changes this line to "stepwell"; a test lists the pages that have to follow.
SOURCE: str = "."
# The place for an installation command, for the end of a message.
IN_CLONE = " (in a clone of Stepwell)" if SOURCE == "." else ""


def install(*extras: str) -> str:
    """The command that installs Stepwell with these extras."""
    return f"pip install '{SOURCE}[{','.join(extras)}]'"


class Extra(NamedTuple):
    """Content of an extra: packages, each with its module, and texts.

    `needs` is a sentence on which feature needs which package, `note` a remark on the installation.
    """

    packages: dict[str, str]
    used_for: str
    needs: str
    note: str = ""


# As in pyproject.toml; a test compares both.
EXTRAS: MappingProxyType[str, Extra] = MappingProxyType(
    {
        "figures": Extra(
            {"matplotlib": "matplotlib", "pillow": "PIL"},
            "figures, GIFs, folders of --out",
            "Figures and GIFs need Matplotlib and Pillow",
        ),
        "tables": Extra(
            {"python-calamine": "python_calamine", "xarray": "xarray"},
            "maps, NetCDF, to_xarray, recordings in workbooks",
            "Maps and labelled tables need xarray, and workbooks need python-calamine",
        ),
        "proof": Extra(
            {"python-flint": "flint"},
            "Path.prove, Margin.prove, `stepwell run --prove`",
            "Proofs need ball arithmetic: python-flint",
        ),
        "robot": Extra(
            {"mujoco": "mujoco"}, "walk, maze, view, export", "The robot's simulation needs MuJoCo"
        ),
        "env": Extra(
            {"gymnasium": "gymnasium"},
            "stepwell.make_env",
            "Environments for reinforcement learning need Gymnasium",
        ),
        "gpu": Extra(
            {"mujoco-warp": "mujoco_warp"},
            "`stepwell sweep walk --engine warp`",
            "Robots by the thousand on a GPU need MuJoCo Warp",
        ),
        "video": Extra(
            {"av": "av"},
            "videos as MP4",
            "MP4 files need PyAV",
            "Its wheel bundles the encoder that writes them, libx264, which is under the GPL; GIF "
            "files need neither.",
        ),
        "studies": Extra(
            {"google-crc32c": "google_crc32c", "zarr": "zarr"},
            "stores of `stepwell sweep`",
            "Sweeps need Zarr",
        ),
        "parquet": Extra(
            {"pyarrow": "pyarrow"},
            "`stepwell sweep export` as Parquet",
            "Parquet files need PyArrow",
        ),
        "cluster": Extra(
            {"distributed": "distributed"},
            "`stepwell sweep --scheduler`",
            "Work on a Dask cluster needs Dask's distributed",
        ),
        "studio": Extra(
            {"starlette": "starlette", "uvicorn": "uvicorn", "websockets": "websockets"},
            "the page of `stepwell studio`",
            "The studio needs Starlette, uvicorn and websockets",
        ),
        "build": Extra(
            {
                "ezdxf": "ezdxf",
                "manifold3d": "manifold3d",
                "reportlab": "reportlab",
                "shapely": "shapely",
                "spyrrow": "spyrrow",
            },
            "parts, drawings, sheets and guide of `stepwell build`",
            "Parts and their files need ezdxf, manifold3d, ReportLab, shapely and spyrrow",
        ),
        "step": Extra(
            {"build123d": "build123d"},
            "parts as STEP files, `stepwell build --step`",
            "STEP files need build123d",
        ),
    }
)


def late(
    room: str, files: Mapping[str, Sequence[str]], names: Iterable[str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """The functions `__getattr__` and `__dir__` of a package that imports modules on first use.

    `files` maps each module of the package to its lazy names; `names` are the public ones.
    """
    homes = {name: file for file, its_names in files.items() for name in its_names}

    def attribute(name: str) -> Any:
        if name in homes:
            return getattr(import_module(f"{room}.{homes[name]}"), name)
        raise AttributeError(f"module {room!r} has no attribute {name!r}")

    return attribute, lambda: sorted(names)


def have(*names: str) -> bool:
    """Whether all packages of these extras are installed, checked without importing them."""
    return not _lacking(names)


def missing(*names: str, note: str = "") -> ExtraError:
    """The error for missing extras: which are missing, the command to install them, and a note."""
    lacking = _lacking(names)
    extras = [EXTRAS[name] for name in lacking]
    first, *more = (one.needs for one in extras)
    sentences = ", and ".join([first, *(text[0].lower() + text[1:] for text in more)])
    one_package = sum(len(one.packages) for one in extras) == 1
    are, them = ("is not", "it") if one_package else ("are not all", "them")
    advice = (
        f"{sentences}, which {are} installed here. "
        f"Install {them} with: {install(*lacking)}{IN_CLONE}"
    )
    notes = " ".join(filter(None, [*(one.note for one in extras), note]))
    return ExtraError(f"{advice}. {notes}" if notes else advice, name=next(iter(lacking.values())))


def need(*names: str, note: str = "") -> None:
    """Raise ExtraError, with the command to run, if an extra is missing.

    The note is a sentence on what is possible without the extra.
    """
    if not have(*names):
        raise missing(*names, note=note)


def _lacking(names: tuple[str, ...]) -> dict[str, str]:
    """The extras with missing packages, each with its first missing module."""
    absent = {
        name: [module for module in EXTRAS[name].packages.values() if find_spec(module) is None]
        for name in names
    }
    return {name: modules[0] for name, modules in absent.items() if modules}
