# SPDX-License-Identifier: BSD-3-Clause
"""One call for one picture of whatever it is."""
import inspect

from ._annotation import flag
from ._core import Progress, whole
from ._globe import OnGlobe
from ._mesh_layers import PlaneLayers, check_variable, is_on_mesh, on_globe
from ._picture import Film, paint
from ._tetrahedra import Tetrahedra
from ._values import background_color, meant, number, positive
from ._volume import Volume


_OF_DATA = ("spacing", "origin", "axes", "scalars", "component", "device", "threads", "matrix", "exaggerate", "globe", "memory")


def drawn_of(data, spacing=None, origin=None, axes=None, scalars=None, component=None, device=None, threads=None, matrix=None, exaggerate=None,
             globe=False, memory=None):
    """What draws the data: a Volume or Tetrahedra."""
    is_dataset = hasattr(data, "data_vars")
    if is_dataset:
        check_variable(data, scalars)
    if flag(globe, "globe"):
        chosen = None if is_dataset else scalars
        for name, value in dict(spacing=spacing, origin=origin, axes=axes, scalars=chosen, component=component, matrix=matrix).items():
            if value is not None:
                raise ValueError(f"{name} is {value!r}, but on a globe places are those of longitudes, latitudes and heights: leave it out")
        if memory is not None:
            raise ValueError(f"memory is {memory!r}, but on a globe all values are read at once: leave it out")
        return on_globe(data, scalars, exaggerate, device, threads)
    if is_dataset and is_on_mesh(data, scalars):
        for name, value in dict(spacing=spacing, origin=origin, axes=axes, component=component, memory=memory).items():
            if value is not None:
                raise ValueError(f"{name} is {value!r}, but a mesh of a Dataset has its own places and values: leave it out")
        return PlaneLayers(data, scalars, exaggerate, device, threads, matrix)
    if is_dataset:
        data, scalars = data[scalars], None
    if isinstance(data, (Volume, Tetrahedra)):
        given = dict(spacing=spacing, origin=origin, axes=axes, scalars=scalars, component=component, device=device, threads=threads, matrix=matrix,
                     exaggerate=exaggerate, memory=memory)
        for name, value in given.items():
            if value is not None:
                raise ValueError(f"{name} is {value!r}, but a {type(data).__name__} has its own")
        return data
    if hasattr(data, "IsA") and (data.IsA("vtkUnstructuredGrid") or data.IsA("vtkStructuredGrid")):
        for name, value in dict(spacing=spacing, origin=origin, axes=axes, exaggerate=exaggerate, memory=memory).items():
            if value is not None:
                raise ValueError(f"{name} is {value!r}, but a {data.GetClassName()} has none")
        return Tetrahedra(data, scalars=scalars, device=device, threads=threads, matrix=matrix, component=component)
    return Volume(data, spacing, origin, axes, scalars, component, device, threads, matrix, exaggerate, memory)


def _render(function, drawn, *arguments, **options):
    """Draws by the method `render`. An argument that it does not have is an error of the function that was called."""
    known = inspect.signature(drawn.render).parameters
    for name in options:
        if name not in known:
            of = f" for a {type(drawn).__name__}" if name in inspect.signature(Volume.render).parameters else ""
            raise TypeError(f"{function.__name__}() has no argument {name!r}{of or meant(name, [*known, *inspect.signature(function).parameters, *_OF_DATA])}")
    return drawn.render(*arguments, **options)


def render(data, opacity=None, color=None, size=(640, 480), camera=None, spacing=None, origin=None, axes=None, scalars=None, component=None,
           device=None, threads=None, matrix=None, exaggerate=None, globe=False, memory=None, **options):
    """Draws a volume and returns a Rendering: rgba, depth, counters.

    data           a NumPy array, an xarray.DataArray, an xarray.Dataset, whose variable `scalars` names, with a mesh of UGRID, FVCOM, MPAS or ICON
                   in layers or without, a lazy array such as zarr's, a
                   vtkImageData or vtkRectilinearGrid, a vtkUnstructuredGrid or vtkStructuredGrid, pyvista's too; or a Volume or Tetrahedra, which
                   are drawn again without building anew. See `Volume` and `Tetrahedra` for the accepted data, and for spacing, origin, axes,
                   scalars, component, device, threads, matrix, exaggerate and memory
    globe          True: on a sphere of 6371 km, which hides what is behind it: an xarray.DataArray with longitudes and latitudes, of one or two
                   dimensions, or a variable of an xarray.Dataset with a mesh in layers, of UGRID, MPAS or ICON. Heights are times `exaggerate`,
                   by default as much as makes them reach over a tenth of the radius. Lattices that go all the way round are closed, at poles and at
                   the seam between two poles, too. Cells are drawn, as of structured grids
    opacity        pairs of a value and its opacity in 0..1 per unit_distance. Two pairs at one value are a step. A number is the top of a
                   ramp away from the most frequent value, or the opacity of the whole volume if all values are equal; default 0.3, in mode
                   slice and of one isosurface 1 for all values, of several isosurfaces 0.5. For several components one of these for all, or a list with one for each
    color          (r, g, b) in 0..1 for all values, or several (value, r, g, b), two at one value being a step; or a colour map over the range of
                   the values: a function of 0..1, or the name of one of `color_maps()`, or of a map or colour of matplotlib's, if that is
                   installed. For several components one of these for all, or a list with one for each
    size           width and height in pixels, 1..16384
    camera         dict of azimuth, elevation (degrees) and zoom; or dict of position, focal_point, view_up (x, y, z), view_angle (degrees) and,
                   for parallel rays, parallel_scale (half the window's height); or (position, focal point, view up); or a vtkCamera
    unit_distance  world length to which opacities refer; default: a fiftieth of the volume's diagonal
    extinction     factor of all optical depths, above 0 (default 1): 2 doubles them, whatever defines the opacities. It has no effect in
                   modes other than composite and additive
    mode           composite, first-hit, maximum, minimum, average, additive, isosurface or slice
    interpolation  linear or nearest
    structure      the structure by which rays skip empty space: auto, none, block, distance, octant or hybrid
    sampling       auto, midpoint, preintegrated or cells
    sample_distance  world length; default 0: as the tolerance needs
    tolerance      root mean square error of RGBA in 0..1 over the lit pixels that automatic settings may cause; default 0.001, 0: the finest
    shade          False, True, or a dict of ambient, diffuse, specular, specular_power: light from the eye. The dict may also have suns (a
                   direction to each, x, y, z, or with red, green and blue), shadows (True: matter absorbs light on its way), scattering (the
                   share of light, 0..1, that matter scatters, the rest is reflected), anisotropy (-.99...99; clouds have .85), multiple
                   (True: matter scatters light any number of times) and, with it, sky (red, green and blue of the zenith, or followed by
                   those of the horizon; z is up). Or a list with one dict of the first four for each component
    gradient_opacity  pairs of the gradient's magnitude, in values per mean spacing, and a factor in 0..1 of the optical depth; or a list with
                   one of these for each component
    contours       for mode isosurface: 1 to 16 values
    surface        for mode slice, which shows the values on it: dict of center and normal (a plane), center and radius (a sphere), center, axis
                   and radius (a cylinder), center, axis and angle (a cone, half its angle in degrees), or center, square, linear and constant
                   (with d = x - center: square[0] dx dx + [1] dy dy + [2] dz dz + [3] dx dy + [4] dy dz + [5] dx dz + linear . d + constant = 0).
                   `slab` makes thick slices, in any mode
    dependent      for 2 or 4 components; False: each is a separate medium, and their optical depths and light add up. True: all are one medium. Of 2
                   the first has the colour and the second the opacity; 4 are red, green and blue in 0..255 and the opacity, of up to 16 bits or floats
    weights        for independent components: a factor in 0..1 of the optical depth of each; default 1
    mean_components  for independent components: whether each counts by its share of the optical depth, as VTK's mappers mix them
    labels, looks  whole numbers in 0..255 in the values' shape, and a dict of labels, 1..255, and dicts of opacity, color and gradient_opacity:
                   values nearest to a label of looks are drawn by its functions. The picture's functions draw all other values, and replace
                   functions that a look lacks
    function_2d    dict of rgba, numbers in 0..1 (rows, columns, 4), not premultiplied, value_range and second_range: colour and opacity as a
                   function of the value, along the columns, and of the gradient's magnitude or, of 2 components, of the second, along the rows.
                   The ranges reach from the first entry's outer edge to the last entry's. It replaces opacity and color
    crop           xmin, xmax, ymin, ymax, zmin, zmax in the world, before matrix: values outside do not show
    clip_planes    up to 6 of a, b, c, d: points with a x + b y + c z + d >= 0 show
    average_range  for mode average: the values that count, ends included
    jitter         whether samples move along their rays by a noise
    audit          whether counters["differing_pixels"] counts the pixels that skipping changed
    opaque_depth   array (height, width) of OpenGL depths in 0..1 at which rays end, the top row first
    quantities     names of numbers of each pixel's ray, which are then arrays in the Rendering's quantities (xarray's for an xarray.DataArray):
                   integral of the values over the ray's length, length on which it meets values, mean, maximum, maximum_depth, cells that it
                   passes, transmittance, transmittance_depth, where that falls to threshold. Lengths and depths before matrix, in metres if units of
                   all three coordinates of an xarray.DataArray are lengths, or VTK's field data have MetresPerUnit, otherwise in world units;
                   NaN where a ray has no such number. Of the values of the first component, whatever the mode and the functions. Rays are
                   those of the picture: of heights that are exaggerated, exaggerate=1 has true directions
    threshold      of the transmittance, above 0 and below 1; default 0.5
    show_axes      True: a box around the data, with the numbers of an xarray.DataArray's coordinates (degrees, depths, pressures at their levels),
                   or of the world if there are none or a matrix turns them. Cameras of azimuth, elevation and zoom leave room for text
    color_bar      True: the colours of the values of the first component, with their name and unit
    caption        a text at the top, whose lines break to fit
    coast          True: coastlines of 1:110 million, at the bottom of data with longitudes and latitudes, of depths at the top, or on the globe
    ink            grey of lines and text, 0..1; default 0.9
    progress       function of a stage's name and a fraction in 0..1; a true result, an exception, or Ctrl+C ends the call.
                   Or a bar of tqdm's protocol

    Cells of unstructured and structured grids, and of meshes, have no interpolation, structure, sampling, sample_distance, jitter, audit, labels, looks,
    and function_2d, but a method: auto, march or project. A picture that shows nothing gives one warning, NothingShown, that names the reason.
    """
    drawn = drawn_of(data, spacing, origin, axes, scalars, component, device, threads, matrix, exaggerate, globe, memory)
    return _render(render, drawn, opacity, color, size, camera, **options)


def show(data, opacity=None, color=None, size=(640, 480), camera=None, background=(0.08, 0.1, 0.14), **options):
    """Draws a volume and returns a Picture, an array (height, width, 4) of bytes that notebooks show.

    background     (r, g, b) in 0..1, or None for transparent
    caption        as in `render`; the factor of heights that are exaggerated follows it. "": no text at all
    ink            default: by the background
    Everything else is as in `render`. The picture's `caption` names the factor of heights that are exaggerated.
    """
    background = background_color(background)
    drawn = drawn_of(data, **{name: options.pop(name) for name in _OF_DATA if name in options})
    factor = getattr(drawn, "exaggeration", 1.0)
    heights = "" if factor == 1 else f"heights x {factor:.4g}" if isinstance(drawn, OnGlobe) else f"heights x {factor:.15g}"
    if options.get("caption") is None and heights:
        options["caption"] = heights
    elif options.get("caption") and heights:
        options["caption"] += ", " + heights
    options.setdefault("ink", 0.5 if background is None else 0.1 if sum(background) > 1.2 else 0.9)
    picture = paint(_render(show, drawn, opacity, color, size, camera, **options).rgba, background)
    picture.caption = heights
    return picture


def render_tetrahedra(points, tetrahedra, values, opacity=None, color=None, size=(640, 480), camera=None, device=None, threads=None, **options):
    """Draws a mesh of tetrahedra, or for tetrahedra=None a curvilinear grid, and returns a Rendering: rgba, depth, counters.

    points, tetrahedra, values  see Tetrahedra
    Everything else is as in `render`.
    """
    drawn = Tetrahedra(points, tetrahedra, values, device=device, threads=threads)
    return _render(render_tetrahedra, drawn, opacity, color, size, camera, **options)


def turn(data, frames=36, opacity=None, color=None, size=(320, 240), elevation=25.0, zoom=1.15, background=(0.08, 0.1, 0.14), seconds=4.0,
         progress=None, spacing=None, origin=None, axes=None, scalars=None, component=None, device=None, threads=None, matrix=None,
         exaggerate=None, globe=False, memory=None, **options):
    """Returns a Film of the data as it turns once about the z axis: a list of Pictures, which notebooks show as a film.

    frames     number of pictures, 1..1000
    elevation  of the camera, degrees
    seconds    the time of one turn
    progress   as in `render`, for the whole film
    Everything else is as in `render` and `show`. Structures are built once.
    """
    whole(frames, "frames", 1, 1000)
    background, seconds = background_color(background), positive(seconds, "seconds")
    view = dict(elevation=number(elevation, "elevation"), zoom=number(zoom, "zoom"))
    drawn = drawn_of(data, spacing, origin, axes, scalars, component, device, threads, matrix, exaggerate, globe, memory)
    film, report = Film(seconds=seconds), Progress.of(progress)
    for n in range(frames):
        part = None if report is None else lambda stage, fraction, n=n: report(stage, (n + fraction) / frames)
        camera = dict(azimuth=30 + 360 * n / frames, **view)
        film.append(paint(_render(turn, drawn, opacity, color, size, camera, progress=part, **options).rgba, background))
    if report is not None:
        report("done", 1.0)
    return film
