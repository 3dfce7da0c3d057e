# SPDX-License-Identifier: BSD-3-Clause
# A package for Spack. With this folder as packages/stratus of a repository of yours, and from a checkout of Stratus:
#   spack develop --path CHECKOUT stratus@0.1.0 && spack install stratus

from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Stratus(CMakePackage):
    """Draws uneven volumes and tetrahedra: VTK modules over a C11 core with
    OpenCL kernels, a command line and Python packages."""

    license("BSD-3-Clause")

    version("0.1.0", tag="v0.1.0")

    variant("shared", default=True, description="Build shared libraries")
    variant("vtk", default=True, description="Build the VTK modules and the command line")
    variant("exr", default=True, when="+vtk", description="Read and write OpenEXR images")
    variant(
        "netcdf",
        default=True,
        when="+vtk",
        description="Read netCDF files, with units and map projections",
    )
    variant(
        "hdf5",
        default=True,
        when="+vtk",
        description="Read HDF5 files, and netCDF-4 in several threads",
    )
    variant(
        "codecs", default=True, when="+vtk", description="Read chunks of Zarr by zstd and Blosc"
    )

    depends_on("c", type="build")
    depends_on("cxx", type="build", when="+vtk")
    depends_on("cmake@3.20:", type="build")
    depends_on("ninja", type="build")

    depends_on("opencl@1.2:")
    depends_on("zlib-api")
    depends_on("vtk@9.1:", when="+vtk")
    depends_on("openexr@3.1:", when="+exr")
    depends_on("netcdf-c", when="+netcdf")
    depends_on("udunits", when="+netcdf")
    depends_on("proj@6.2:", when="+netcdf")
    depends_on("hdf5@1.10.3:~mpi", when="+hdf5")
    depends_on("zstd", when="+codecs")
    depends_on("c-blosc", when="+codecs")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define_from_variant("STRATUS_BUILD_VTK", "vtk"),
            self.define_from_variant("STRATUS_BUILD_APPLICATIONS", "vtk"),
            self.define_from_variant("STRATUS_BUILD_EXR", "exr"),
            self.define_from_variant("STRATUS_BUILD_NETCDF", "netcdf"),
            self.define_from_variant("STRATUS_BUILD_UDUNITS", "netcdf"),
            self.define_from_variant("STRATUS_BUILD_PROJ", "netcdf"),
            self.define_from_variant("STRATUS_BUILD_HDF5", "hdf5"),
            self.define_from_variant("STRATUS_BUILD_CODECS", "codecs"),
            self.define("STRATUS_BUILD_VDB", False),
            self.define("STRATUS_BUILD_TETGEN", False),
            self.define("STRATUS_BUILD_TESTING", False),
            self.define("STRATUS_BUILD_EXAMPLES", False),
        ]
