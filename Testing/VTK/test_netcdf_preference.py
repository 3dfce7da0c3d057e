# SPDX-License-Identifier: BSD-3-Clause
"""Which variable the netCDF readers read by default: a field of the cells before staggered ones, flags, and ingredients of coordinates. The
order of each file is written down here by hand; in the file it is reversed."""
import os
import sys

import netCDF4
import numpy

import stratus

failures = 0
folder = sys.argv[1] if len(sys.argv) > 1 else "."
sizes = {"Time": 1, "bottom_top": 3, "bottom_top_stag": 4, "south_north": 4, "west_east": 5, "lev": 3, "lat": 4, "lon": 5, "s_rho": 3, "s_w": 4,
         "eta_rho": 4, "xi_rho": 5, "xi_u": 4, "node": 4, "face": 1, "corner": 4, "layer": 2, "border": 3, "level": 3, "row": 4, "column": 5}


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def order(name, variables, cls="vtkStratusCFReader", **fixed):
    """Writes the variables in reverse. Returns the reader's list."""
    path = os.path.join(folder, "preference %s.nc" % name)
    with netCDF4.Dataset(path, "w") as file:
        for variable, (dimensions, attributes) in [*fixed.items(), *reversed(variables.items())]:
            for dimension in dimensions.split():
                if dimension not in file.dimensions:
                    file.createDimension(dimension, sizes[dimension])
            made = file.createVariable(variable, "f8", dimensions.split())
            made.setncatts({key: value for key, value in attributes.items() if key != "values"})
            made[:] = attributes.get("values", numpy.arange(numpy.prod([sizes[one] for one in dimensions.split()])).reshape(made.shape))
    errors = []
    reader = getattr(stratus, cls)()
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    reader.SetFileName(path)
    reader.Update()
    found = [reader.GetNameOfVariable(i) for i in range(reader.GetNumberOfVariables())]
    data = reader.GetOutput()
    array = data and (data.GetPointData().GetScalars() or data.GetCellData().GetScalars())
    check(not errors and array and array.GetName() == found[0], name + ": the first variable is read")
    return found


def cells(**attributes):
    return "Time bottom_top south_north west_east", attributes


def staggered(**attributes):
    return "Time bottom_top_stag south_north west_east", attributes


wrf = {
    "QCLOUD": cells(description="Cloud water mixing ratio", units="kg kg-1"),
    "W": staggered(description="z-wind component", units="m s-1"),
    "P": cells(description="perturbation pressure", units="Pa"),
    "PB": cells(description="BASE STATE PRESSURE", units="Pa"),
    "PHB": staggered(description="base-state geopotential", units="m2 s-2"),
    "PH": staggered(description="perturbation geopotential", units="m2 s-2"),
}
found = order("wrf", wrf)
check(found[:2] == ["QCLOUD", "W"] and set(found[2:]) == {"P", "PB", "PHB", "PH"}, "WRF: %r" % found)

grid = "lev lat lon"
climate = {
    "cli": (grid, {"standard_name": "mass_fraction_of_cloud_ice_in_air", "cell_measures": "volume: boxes", "ancillary_variables": "quality"}),
    "quality": (grid, {}), "kinds": (grid, {"flag_values": numpy.array([0., 1.]), "flag_meanings": "a b"}), "land_mask": (grid, {}),
    "boxes": (grid, {"units": "m3"}), "air": (grid, {"standard_name": "air_pressure"}), "high": (grid, {"standard_name": "altitude"}),
    "thick": (grid, {"standard_name": "cell_thickness"}), "zg": (grid, {"standard_name": "geopotential_height"}), "lower": (grid, {"positive": "up"}),
}
found = order("climate", climate)
check(found[0] == "cli" and set(found[1:4]) == {"quality", "kinds", "land_mask"}, "climate: %r" % found)
check(sorted(found) == sorted(climate), "nothing is left out: %r" % found)

roms = {"dye_01": ("s_rho eta_rho xi_rho", {}), "u": ("s_rho eta_rho xi_u", {}), "AKt": ("s_w eta_rho xi_rho", {})}
found = order("roms", roms)
check(found == ["dye_01", "AKt", "u"], "ROMS: %r" % found)

# at the same rank the file's order counts; an optical depth and a level of noise are fields
found = order("fields", {"optical_depth": ("level row column", {}), "b": ("level row column", {"long_name": "level of noise"}), "a": ("level row column", {})})
check(found == ["a", "b", "optical_depth"], "equals: %r" % found)
found = order("only", {"pressure": ("level row column", {"standard_name": "air_pressure"})})
check(found == ["pressure"], "a single ingredient is drawn")

mesh = {"dye": ("layer face", {}), "pres": ("layer face", {"long_name": "pressure"}), "flat": ("face", {}), "area": ("face", {"long_name": "cell area"})}
found = order("mesh", mesh, "vtkStratusUgridReader",
              mesh=("", {"cf_role": "mesh_topology", "topology_dimension": 2, "node_coordinates": "x y", "face_node_connectivity": "corners", "values": 0}),
              x=("node", {"values": [0, 1, 1, 0]}), y=("node", {"values": [0, 0, 1, 1]}), corners=("face corner", {"values": [[0, 1, 2, 3]]}),
              sigma=("layer", {"values": [-.75, -.25], "standard_name": "ocean_sigma_coordinate", "formula_terms": "sigma: sigma eta: eta depth: bed"}),
              eta=("node", {"values": 0}), bed=("node", {"values": 10}))
check([one for one in found if one in mesh] == ["dye", "pres", "flat", "area"], "a mesh: %r" % found)

sys.exit(1 if failures else 0)
