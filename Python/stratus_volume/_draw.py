# SPDX-License-Identifier: BSD-3-Clause
"""One call for one picture of whatever it is."""
from ._picture import paint
from ._tetrahedra import Tetrahedra
from ._values import background_color
from ._volume import Volume


def render(data, opacity=None, color=None, size=(640, 480), camera=None, spacing=None, origin=None, axes=None, scalars=None, component=None,
           device=None, threads=None, **options):
    """Draws a volume and returns a Rendering: rgba, depth, counters.

    data           a NumPy array, an xarray.DataArray, a vtkImageData or vtkRectilinearGrid, a vtkUnstructuredGrid or vtkStructuredGrid,
                   pyvista's too; or a Volume or Tetrahedra, which are drawn again without building anew. `Volume` and `Tetrahedra` tell
                   what is taken, also for spacing, origin, axes, scalars, component, device and threads
    opacity        pairs of a value and its opacity in 0..1 per unit_distance. Two pairs at one value are a step. A number is the top of a
                   ramp away from the most frequent value, or the opacity of the whole volume where all values are equal; default 0.3
    color          (r, g, b) in 0..1 for all values, or several (value, r, g, b). Two at one value are a step
    size           width and height in pixels, 1..16384
    camera         dict of azimuth, elevation (degrees) and zoom; or dict of position, focal_point, view_up (x, y, z), view_angle (degrees) and,
                   for parallel rays, parallel_scale (half the window's height); or (position, focal point, view up); or a vtkCamera
    unit_distance  world length to which opacities refer; default: a fiftieth of the volume's diagonal
    mode           composite, first-hit, maximum, minimum, average, additive or isosurface
    interpolation  linear or nearest
    structure      by which rays skip empty space: auto, none, block, distance, octant or hybrid
    sampling       auto, midpoint, preintegrated or cells
    sample_distance  world length; 0: by the tolerance
    tolerance      root mean square error of RGBA in 0..1 over the lit pixels that automatic settings may cause; default 0.001, 0: the finest
    shade          False, True, or a dict of ambient, diffuse, specular, specular_power: light from the eye
    gradient_opacity  pairs of the gradient's magnitude, in values per mean spacing, and a factor in 0..1 of the optical depth
    contours       1 to 16 values, of mode isosurface
    crop           xmin, xmax, ymin, ymax, zmin, zmax in the world: what is outside does not show
    clip_planes    up to 6 of a, b, c, d: points with a x + b y + c z + d >= 0 show
    average_range  the values that count in mode average, ends included
    jitter         whether samples move along their rays by a noise
    audit          whether counters["differing_pixels"] counts the pixels that skipping changed
    opaque_depth   array (height, width) of OpenGL depths in 0..1 at which rays end, the top row first
    progress       function of a stage's name and a fraction in 0..1; a true result, an exception, or Ctrl+C ends the call

    Cells of unstructured and structured grids have no interpolation, structure, sampling, sample_distance, jitter and audit, and no mode
    first-hit, but a method: auto, march or project. A picture that shows nothing gives one warning, NothingShown, that names the reason.
    """
    if isinstance(data, (Volume, Tetrahedra)):
        given = dict(spacing=spacing, origin=origin, axes=axes, scalars=scalars, component=component, device=device, threads=threads)
        for name, value in given.items():
            if value is not None:
                raise ValueError(f"{name} is {value!r}, but a {type(data).__name__} has its own")
        drawn = data
    elif hasattr(data, "IsA") and (data.IsA("vtkUnstructuredGrid") or data.IsA("vtkStructuredGrid")):
        for name, value in dict(spacing=spacing, origin=origin, axes=axes, component=component).items():
            if value is not None:
                raise ValueError(f"{name} is {value!r}, but a {data.GetClassName()} has none")
        drawn = Tetrahedra(data, scalars=scalars, device=device, threads=threads)
    else:
        drawn = Volume(data, spacing, origin, axes, scalars, component, device, threads)
    return drawn.render(opacity, color, size, camera, **options)


def show(data, opacity=None, color=None, size=(640, 480), camera=None, background=(0.08, 0.1, 0.14), **options):
    """Draws a volume and returns a Picture, an array (height, width, 4) of bytes that notebooks show.

    background     (r, g, b) in 0..1, or None for transparent
    Everything else is as in `render`.
    """
    background = background_color(background)
    return paint(render(data, opacity, color, size, camera, **options).rgba, background)


def render_tetrahedra(points, tetrahedra, values, opacity=None, color=None, size=(640, 480), camera=None, device=None, threads=None, **options):
    """Draws a mesh of tetrahedra, or for tetrahedra=None a curvilinear grid, and returns a Rendering: rgba, depth, counters.

    points, tetrahedra, values  see Tetrahedra
    Everything else is as in `render`.
    """
    return Tetrahedra(points, tetrahedra, values, device=device, threads=threads).render(opacity, color, size, camera, **options)
