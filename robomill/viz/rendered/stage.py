"""The pieces of a rendered picture: the block as sheet and skirt, the ideal's outline and ghost, tool, words."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.units import format_significant
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.theme import palette

METAL = {False: "#C4CCD2", True: "#66747E"}
FACE = {False: "#E7D9B8", True: "#8A7A52"}
ROLES = {
    "cutter": ("#B8892B", "#D9AA4C"),
    "shank": ("#9AA5AD", "#A9B5BD"),
    "spindle": ("#56656F", "#8795A0"),
    "link": ("#C9D2D8", "#6C7B86"),
    "joint": ("#3D4E5A", "#C9D4DB"),
}
FACE_SAMPLES = 1201
STEEP = 2.0  # of a cell: a face between points that differ by more in height is a wall


def lights(plotter: Any) -> None:
    """A key light from the front left and two soft ones that go with the camera."""
    import pyvista as pv

    for position, intensity in (((-0.5, -0.8, 1.4), 0.72), ((1.0, 0.2, 0.8), 0.30), ((0.0, 1.0, 0.35), 0.22)):
        light = pv.Light(position=position, focal_point=(0, 0, 0), intensity=intensity, light_type="camera light")
        if intensity > 0.5:
            light = pv.Light(position=position, focal_point=(0, 0, 0), intensity=intensity)
        plotter.add_light(light, only_active=True)


def block(plotter: Any, picture: SurfacePicture, z: FloatArray, error: FloatArray | None, colours: Any) -> None:
    """The part with heights ``z`` (nx, ny), coloured by ``error`` where known; cut open if the picture says so."""
    metal = METAL[picture.dark]
    top, sides = sheet(picture, z, error), skirt(picture, z)
    top, walls = _parted(picture, top, z) if error is not None else (top, top.extract_cells([]))
    if picture.cutaway and picture.station is not None:
        along = (*picture.direction, 0.0)
        top, walls, sides = (mesh.clip(along, origin=picture.station, invert=False) for mesh in (top, walls, sides))
        _face(plotter, picture, z)
    lit = {"ambient": 0.32, "diffuse": 0.72, "specular": 0.12, "specular_power": 20}
    upright = {**lit, "ambient": 0.72, "diffuse": 0.32}  # a wall turned from the light keeps a colour that can be read
    for mesh, scalars, shine in ((top, "error", lit), (walls, "wall", upright)):
        if mesh.n_points and error is not None:
            plotter.add_mesh(
                mesh,
                scalars=scalars,
                cmap=colours,
                clim=(-picture.limit, picture.limit),
                nan_color=metal,
                show_scalar_bar=False,
                interpolate_before_map=True,
                **shine,
            )
    if top.n_points and error is None:
        plotter.add_mesh(top, color=metal, **lit)
    if sides.n_points:
        plotter.add_mesh(sides, color=metal, ambient=0.3, diffuse=0.7)


def sheet(picture: SurfacePicture, z: FloatArray, error: FloatArray | None) -> Any:
    """The surface seen from above."""
    import pyvista as pv

    x, y = np.meshgrid(picture.x, picture.y, indexing="ij")
    made = pv.StructuredGrid(x, y, np.where(np.isfinite(z), z, picture.bottom))
    if error is not None:
        made["error"] = np.asarray(error, dtype=np.float32).ravel(order="F")
    return made


def _parted(picture: SurfacePicture, top: Any, z: FloatArray) -> tuple[Any, Any]:
    """The sheet without its steep faces beside walls, and these: a wall has one colour from its foot to its top, its
    own, not what lies between those of the floor and the rim."""
    if picture.wall is None:
        return top, top.extract_cells([])
    corners = [np.s_[:-1, :-1], np.s_[1:, :-1], np.s_[1:, 1:], np.s_[:-1, 1:]]
    heights, told = (np.stack([field[at] for at in corners]) for field in (z, picture.wall))
    size = max(float(np.diff(picture.x[:2])[0]), float(np.diff(picture.y[:2])[0]))
    steep = (np.isfinite(told).all(axis=0) & (np.ptp(heights, axis=0) > STEEP * size)).ravel(order="F")
    top.cell_data["wall"] = np.where(steep, told.mean(axis=0).ravel(order="F"), np.nan).astype(np.float32)
    return top.extract_cells(np.flatnonzero(~steep)), top.extract_cells(np.flatnonzero(steep))


def skirt(picture: SurfacePicture, z: FloatArray) -> Any:
    """The four sides of the block, from the surface's edge down to the bottom."""
    import pyvista as pv

    z = np.where(np.isfinite(z), z, picture.bottom)
    x, y = np.meshgrid(picture.x, picture.y, indexing="ij")
    sides = []
    for edge in (np.s_[:, 0], np.s_[-1, :], np.s_[::-1, -1], np.s_[0, ::-1]):
        top = np.stack([x[edge], y[edge], z[edge]], axis=-1)
        low = top.copy()
        low[:, 2] = picture.bottom
        points = np.stack([top, low])
        sides.append(pv.StructuredGrid(points[..., 0:1], points[..., 1:2], points[..., 2:3]))
    return pv.merge([side.extract_surface() for side in sides], merge_points=False)


def _face(plotter: Any, picture: SurfacePicture, z: FloatArray) -> None:
    """The cut face at the station: filled up to the machined surface, the ideal profile as a line over it."""
    import pyvista as pv

    points, inside = _across(picture)
    if inside.sum() < 2:
        return
    points = points[inside]
    i = np.clip(np.searchsorted(picture.x, points[:, 0]), 0, len(picture.x) - 1)
    j = np.clip(np.searchsorted(picture.y, points[:, 1]), 0, len(picture.y) - 1)
    edges = []
    for heights in (z, picture.ideal):
        height = np.where(np.isfinite(heights[i, j]), heights[i, j], picture.bottom)
        edges.append(np.column_stack([points, height]))
    low = np.column_stack([points, np.full(len(points), picture.bottom)])
    both = np.stack([edges[0], low])
    face = pv.StructuredGrid(both[..., 0:1], both[..., 1:2], both[..., 2:3])
    plotter.add_mesh(face, color=FACE[picture.dark], lighting=False)
    p = palette(picture.dark)
    toward = -0.02 * np.array([*picture.direction, 0.0])
    for edge, colour, width in ((edges[1], p.accent, 2.5), (edges[0], p.text, 3.2)):
        plotter.add_mesh(pv.lines_from_points(edge + toward), color=colour, line_width=width, lighting=False)


def _across(picture: SurfacePicture) -> tuple[FloatArray, FloatArray]:
    """Points (q, 2) mm on the line across the cut through the station, and whether they lie on the block."""
    assert picture.station is not None
    reach = float(np.hypot(np.ptp(picture.x), np.ptp(picture.y)))
    w = np.linspace(-reach, reach, FACE_SAMPLES)
    points = np.array(picture.station[:2]) + w[:, None] * np.array([-picture.direction[1], picture.direction[0]])
    inside = (points[:, 0] >= picture.x[0]) & (points[:, 0] <= picture.x[-1])
    return points, inside & (points[:, 1] >= picture.y[0]) & (points[:, 1] <= picture.y[-1])


def ideal_lines(plotter: Any, picture: SurfacePicture) -> None:
    """Outlines of the ideal cut: where it leaves the stock's top, where its floor begins."""
    ideal = np.where(np.isfinite(picture.ideal), picture.ideal, picture.bottom)
    top, low = float(ideal.max()), float(ideal.min())
    if top - low < 1e-6:
        return
    made = sheet(picture, ideal, None)
    made["height"] = made.points[:, 2]
    for level, lift in ((top - 0.02 * (top - low), 0.02), (low + 0.02 * (top - low), 0.02)):
        outline = made.contour([level], scalars="height")
        if picture.cutaway and picture.station is not None and outline.n_points:
            outline = outline.clip((*picture.direction, 0.0), origin=picture.station, invert=False)
        if outline.n_points:
            outline.points[:, 2] += lift * (top - low)
            plotter.add_mesh(outline, color=palette(picture.dark).text, line_width=2.2, lighting=False)


def ghost(plotter: Any, picture: SurfacePicture) -> None:
    """The ideal cut as a clear shell: floor and walls where something was to be cut."""
    ideal = np.where(np.isfinite(picture.ideal), picture.ideal, picture.bottom)
    top = float(ideal.max())
    shell = sheet(picture, ideal + 0.01 * (top - float(ideal.min())), None)
    shell["cut"] = (ideal < top - 1e-6).ravel(order="F").astype(np.float32)
    shell = shell.threshold(0.5, scalars="cut", all_scalars=False)
    if shell.n_points and picture.cutaway and picture.station is not None:
        shell = shell.clip((*picture.direction, 0.0), origin=picture.station, invert=False)
    if shell.n_points:
        plotter.add_mesh(shell, color=palette(picture.dark).accent, opacity=0.38, lighting=False)


def section_plane(plotter: Any, picture: SurfacePicture) -> None:
    """A clear plane across the cut at the station."""
    import pyvista as pv

    assert picture.station is not None
    top = float(np.nanmax(picture.z))
    height = 1.5 * (top - picture.bottom)
    centre = np.array([picture.station[0], picture.station[1], picture.bottom + 0.6 * height])
    width = 0.55 * min(float(np.ptp(picture.x)), float(np.ptp(picture.y))) + 4.0
    across = np.array([-picture.direction[1], picture.direction[0], 0.0])
    up = np.array([0.0, 0.0, 0.5 * height])
    corners = [centre + a * width * across + b * up for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    plane = pv.PolyData(np.array(corners), faces=[4, 0, 1, 2, 3])
    plotter.add_mesh(plane, color=palette(picture.dark).accent, opacity=0.22, lighting=False)


def solids(plotter: Any, picture: SurfacePicture) -> None:
    """Tool, spindle and arm."""
    import pyvista as pv

    for solid in picture.solids:
        faces = np.column_stack([np.full(len(solid.faces), 3), solid.faces]).astype(np.int64).ravel()
        mesh = pv.PolyData(np.asarray(solid.points, dtype=float), faces)
        plotter.add_mesh(
            mesh,
            color=ROLES[solid.role][int(picture.dark)],
            opacity=solid.opacity,
            smooth_shading=True,
            split_sharp_edges=True,
            ambient=0.3,
            diffuse=0.7,
            specular=0.25,
            specular_power=25,
        )


def colour_bar(plotter: Any, picture: SurfacePicture, colours: Any, left: float = 0.835) -> None:
    """The scale of the error, tied to the tolerance, with its words; ``left`` is where it begins (0..1)."""
    import pyvista as pv

    p = palette(picture.dark)
    limits = (-picture.limit, picture.limit)
    carrier = pv.PolyData(np.full((2, 3), [picture.x[0], picture.y[0], picture.bottom]))
    carrier["signed"] = np.array(limits)
    actor = plotter.add_mesh(
        carrier, scalars="signed", cmap=colours, clim=limits, opacity=0.0, show_scalar_bar=False, point_size=1
    )
    spare = 1.0 - left
    plotter.add_scalar_bar(
        title="",
        mapper=actor.mapper,
        vertical=True,
        n_labels=0,
        color=p.text,
        position_x=left + 0.39 * spare,
        position_y=0.22,
        width=0.21 * spare,
        height=0.56,
    )
    size = font(picture, 11)
    for words, y, colour, less in (
        (f"Error, {picture.unit}", 0.885, p.text, 0),
        ("+ material left", 0.815, p.muted, 2),
        ("\u2212 cut too deep", 0.145, p.muted, 2),
        *((f"{format_significant(k * picture.limit, 3, sign=True)}", 0.485 + 0.27 * k, p.text, 2) for k in (-1, 0, 1)),
    ):
        beside = left + (0.65 * spare if words[-1].isdigit() else 0.0)
        plotter.add_text(words, position=(beside, y), viewport=True, font_size=size - less, color=colour)


def words(plotter: Any, picture: SurfacePicture, title: str = "") -> None:
    """Captions at the bottom, a title on top and, where there is a scale, the axes of {W}."""
    p = palette(picture.dark)
    size = font(picture, 11)
    for i, caption in enumerate(picture.captions):
        plotter.add_text(
            caption,
            position=(0.02, 0.03 + 0.05 * (len(picture.captions) - 1 - i)),
            viewport=True,
            font_size=size,
            color=p.text if i == 0 else p.muted,
        )
    if title:
        plotter.add_text(title, position=(0.16, 0.885), viewport=True, font_size=size + 2, color=p.text)
    if not picture.scale:  # a picture that only shows what comes out
        return
    plotter.add_axes(
        line_width=3,
        labels_off=False,
        color=p.text,
        viewport=(0.0, 0.78, 0.13, 1.0),
        x_color="#D55E00",
        y_color="#009E73",
        z_color="#0072B2",
    )


def font(picture: SurfacePicture, size: int) -> int:
    """A font size that goes with the size of the picture."""
    return max(9, round(size * picture.size[0] / 1150))
