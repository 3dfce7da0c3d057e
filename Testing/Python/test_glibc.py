# SPDX-License-Identifier: BSD-3-Clause
"""The versions of the C library's functions that wheels need (Python/glibc_2_28.h) give the bits of today's, and none that the core calls
is left out. The same library is made with the header and without, and called with the same numbers."""
import ctypes
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile

from checking import check, done

import numpy

import stratus_volume

if platform.machine() != "x86_64" or platform.libc_ver()[0] != "glibc" or not shutil.which("objdump"):
    print("SKIPPED: the header is for glibc on x86-64, and objdump reads what it did")
    sys.exit(77)

SOURCE = """
#include <math.h>
#include <stddef.h>
void each(int function, const double* x, const double* y, double* result, size_t n)
{
  for (size_t i = 0; i < n; ++i) {
    double a = x[i], b = y[i];
    result[i] = function == 0 ? exp(a) : function == 1 ? exp2(a) : function == 2 ? log(a) : function == 3 ? log2(a) : function == 4 ? pow(a, b)
                                                                                                                                    : fmod(a, b);
  }
}
"""
NAMES = ["exp", "exp2", "log", "log2", "pow", "fmod"]
HEADER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Python", "glibc_2_28.h")


def versions(library):
    """The version of glibc that each function of the C library is taken from."""
    symbols = subprocess.run(["objdump", "-T", library], check=True, capture_output=True, text=True).stdout
    return {name: tuple(map(int, version.split("."))) for version, name in re.findall(r"\*UND\*\s.*\(GLIBC_([0-9.]+)\)\s+(\w+)", symbols)}


def numbers(n):
    """Returns arguments of all magnitudes, and as functions, cameras and optical depths have them; zeros, infinities, NaN, and arguments whose
    results overflow or vanish."""
    random = numpy.random.default_rng(28)
    ends = [0.0, -0.0, 1.0, -1.0, numpy.inf, -numpy.inf, numpy.nan, 5e-324, 2.2250738585072014e-308, 1.7976931348623157e308,
            709.782712893384, 709.7827128933841, -745.1332191019411, -745.1332191019412, 1024.0, -1075.0, 0.5, 2.0]
    any_bits = random.integers(0, 2**64, n, dtype=numpy.uint64).view(numpy.float64)
    return numpy.concatenate([ends, any_bits, random.random(n), random.normal(0, 30, n)])


with tempfile.TemporaryDirectory() as folder:
    source, calls = os.path.join(folder, "each.c"), []
    with open(source, "w", encoding="ascii") as file:
        file.write(SOURCE)
    for name, options in ("today", []), ("wheel", ["-include", HEADER]):
        library = os.path.join(folder, name + ".so")
        subprocess.run([os.environ.get("CC", "cc"), "-O2", "-fPIC", "-shared", *options, source, "-o", library, "-lm"], check=True)
        needed = versions(library)
        check(set(NAMES) <= set(needed), f"{name} calls them all: {needed}")
        if options:
            check(max(needed[one] for one in NAMES) <= (2, 28), f"glibc 2.28 has the functions that {name} needs: {needed}")
        calls.append(ctypes.CDLL(library).each)
    x = numbers(400000)
    y = numpy.random.default_rng(29).permutation(x)
    for number, name in enumerate(NAMES):
        results = []
        for call in calls:
            results.append(numpy.empty_like(x))
            call(number, *(ctypes.c_void_p(array.ctypes.data) for array in (x, y, results[-1])), ctypes.c_size_t(x.size))
        same = results[0].view(numpy.uint64) == results[1].view(numpy.uint64)
        same |= numpy.isnan(results[0]) & numpy.isnan(results[1])  # log of negative numbers is a NaN of either sign
        check(same.all(), f"{name} of {x[~same][:3]} {y[~same][:3]}")

# A new call of a function that is younger than glibc 2.28 goes into the header, or is left out. These functions have other names in Debian
# 11, which makes the wheel.
MOVED = {"pthread_create", "pthread_join", "pthread_sigmask"}  # the header has their older versions
RENAMED = {"stat", "lstat", "fstat", "fstatat", "pthread_once"}
core = versions(os.path.join(os.path.dirname(stratus_volume.__file__), "libstratus-core.so"))
check(len(core) > 50, f"of the core, {len(core)} functions are seen")
newer = {name for name, version in core.items() if version > (2, 28)}
check(newer <= set(NAMES) | RENAMED | MOVED, f"newer than glibc 2.28: {newer - set(NAMES) - RENAMED - MOVED}")
with open(HEADER, encoding="ascii") as file:
    header = file.read()
for name in MOVED:
    check(f".symver {name}, {name}@GLIBC_2.2.5" in header, f"the header has an older version of {name}")
done()
