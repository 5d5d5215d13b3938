"""Solids of parts: watertight meshes as STL and 3MF, exact solids as STEP."""

import io
import math
import tempfile
import zipfile
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple
from xml.sax.saxutils import quoteattr

import numpy as np

from stepwell.base import Floats, InputError, Ints, need
from stepwell.build.contour import MM, Contour, arc
from stepwell.build.part import Part

# Largest distance of a mesh from an arc [m], far below what printers resolve.
SAGITTA = 2e-6


class Mesh(NamedTuple):
    """A closed mesh: (n, 3) corners [m] and (m, 3) triangles, counter-clockwise from outside."""

    corners: Floats
    triangles: Ints


@lru_cache(maxsize=256)
def mesh_of(part: Part, sagitta: float = SAGITTA) -> Mesh:
    """The part as a closed mesh, its lower face at z = 0; arcs are at most `sagitta` [m] off.

    Raises:
        ValueError: contours of the part cross each other.
    """
    need("build")
    from manifold3d import CrossSection, Error

    rings = [part.outline.ring(sagitta), *(one.ring(sagitta)[::-1] for one in part.openings)]
    solid = CrossSection([MM * ring for ring in rings]).extrude(MM * part.thickness)
    mesh = solid.to_mesh64()
    genus = solid.genus()
    if solid.status() != Error.NoError or genus != len(part.openings):
        raise InputError(
            f"part {part.name}: {len(part.openings)} openings are drawn, the solid has {genus}: "
            f"contours cross each other. Move the openings apart."
        )
    return Mesh(1e-3 * np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, np.int64))


def stl_bytes(mesh: Mesh, name: str) -> bytes:
    """A binary STL file in millimetres."""
    facets = MM * mesh.corners[mesh.triangles]
    normals = np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.zeros(
        len(facets), np.dtype([("normal", "<3f4"), ("corners", "<9f4"), ("unused", "<u2")])
    )
    rows["normal"] = normals / np.where(lengths > 0.0, lengths, 1.0)
    rows["corners"] = facets.reshape(-1, 9)
    # A head that begins with "solid" would be taken for a text file.
    head = f"stepwell {name}, millimetres".encode("ascii", "replace")[:80].ljust(80)
    return head + np.uint32(len(facets)).tobytes() + rows.tobytes()


_CONTENT_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" '
    'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" '
    'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
)


def threemf_bytes(
    parts: Sequence[Part], places: Sequence[tuple[float, float, float]], title: str
) -> bytes:
    """A 3MF file with parts as objects of their names, flat on z = 0.

    Args:
        parts: to be printed.
        places: of each part: x, y [m], and the angle [rad] by which it is turned before.
        title: of the model.
    """
    objects, items = [], []
    for number, (part, place) in enumerate(zip(parts, places, strict=True), 1):
        mesh = mesh_of(part)
        rows = (MM * mesh.corners).tolist(), mesh.triangles.tolist()
        corners = "".join(f'<vertex x="{a:.6f}" y="{b:.6f}" z="{c:.6f}"/>' for a, b, c in rows[0])
        triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in rows[1])
        objects.append(
            f'<object id="{number}" type="model" name={quoteattr(part.name)}><mesh>'
            f"<vertices>{corners}</vertices><triangles>{triangles}</triangles></mesh></object>"
        )
        x, y, angle = place
        # Rows of the matrix are the images of x, y and z.
        c, s = math.cos(angle), math.sin(angle)
        numbers = (c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0, MM * x, MM * y, 0.0)
        matrix = " ".join(f"{one:.7g}" for one in numbers)
        items.append(f'<item objectid="{number}" transform="{matrix}"/>')
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<model unit="millimeter" xml:lang="en-US" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f'<metadata name="Title">{quoteattr(title)[1:-1]}</metadata>'
        f"<resources>{''.join(objects)}</resources><build>{''.join(items)}</build></model>\n"
    )
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as file:
        for name, text in (
            ("[Content_Types].xml", _CONTENT_TYPES),
            ("_rels/.rels", _RELATIONS),
            ("3D/3dmodel.model", model),
        ):
            # A date would make the files of equal parts differ.
            info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            file.writestr(info, text)
    return content.getvalue()


def step_bytes(part: Part, title: str = "") -> bytes:
    """The part as an exact solid in a STEP file: arcs are arcs, its lower face at z = 0.

    The name of the solid is `title`, by default that of the part.

    Raises:
        ModuleNotFoundError: the extra `step` is not installed; the text has the command for it.
    """
    need("step", note="STL, 3MF and DXF files need no build123d.")
    import build123d  # pyright: ignore[reportMissingImports]

    def face(contour: Contour) -> Any:
        return build123d.Face(build123d.Wire([_curve(build123d, *one) for one in contour.edges()]))

    plate = face(part.outline)
    for opening in part.openings:
        plate = plate - face(opening)
    solid = build123d.extrude(plate, MM * part.thickness, dir=(0, 0, 1))
    solid.label = title or part.name
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "part.step"
        build123d.export_step(solid, str(file))
        return file.read_bytes()


def _curve(
    build123d: Any, start: tuple[float, float], end: tuple[float, float], bulge: float
) -> Any:
    """An edge in millimetres as a curve of build123d."""
    ends = [(MM * x, MM * y, 0.0) for x, y in (start, end)]
    if bulge == 0.0:
        return build123d.Edge.make_line(*ends)
    (x, y), radius, first, span = arc(start, end, bulge)
    half = first + span / 2.0
    middle = (MM * (x + radius * math.cos(half)), MM * (y + radius * math.sin(half)), 0.0)
    return build123d.Edge.make_three_point_arc(ends[0], middle, ends[1])
