# SPDX-License-Identifier: BSD-3-Clause
"""declare.py's declarations of the public headers agree with a C compiler: sizes, offsets, enums, macros, and the library's functions."""
import ast
import ctypes
import glob
import inspect
import os
import shutil
import subprocess
import sys
import tempfile

from checking import check, done

import stratus_volume
from stratus_volume import _declarations as c

root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
compiler = os.environ.get("CC") or shutil.which("cc")
if not compiler:
    print("SKIPPED: no C compiler")
    sys.exit(77)

wanted, lines = [], []
for name, struct in c.STRUCTS.items():
    wanted.append((f"sizeof {name}", ctypes.sizeof(struct)))
    lines.append(f'printf("%zu\\n", sizeof({name}));')
    for field, *_ in struct._fields_:
        own = getattr(struct, field)
        wanted += [(f"offset of {name}.{field}", own.offset), (f"size of {name}.{field}", own.size)]
        lines += [f'printf("%zu\\n", offsetof({name}, {field}));', f'printf("%zu\\n", sizeof((({name}*)0)->{field}));']
for entries in c.ENUMS.values():
    for name, value in entries.items():
        wanted.append((name, value))
        lines.append(f'printf("%lld\\n", (long long){name});')
for name, value in c.CONSTANTS.items():
    wanted.append((name, value))
    lines.append(f'printf("%.17g\\n", (double){name});')
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "layout.c")
    with open(path, "w", encoding="utf-8") as file:
        file.write("#include <stddef.h>\n#include <stdio.h>\n#include <stratus.h>\nint main(void)\n{\n" + "\n".join(lines) + "\nreturn 0;\n}\n")
    program = os.path.join(folder, "layout")
    subprocess.run([compiler, "-std=c11", "-I" + os.path.join(root, "Core"), "-o", program, path], check=True)
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout.split()
check(len(printed) == len(wanted) > 600, f"{len(printed)} numbers for {len(wanted)}")
for (name, value), line in zip(wanted, printed):
    check(float(line) == value, f"{name} is {value}, the compiler says {line}")

# Every function that the headers mark, by another way of looking at them, and every one of the library.
marked = set()
for path in glob.glob(os.path.join(root, "Core", "stratus", "*.h")):
    if os.path.basename(path) != "scenes.h":
        with open(path, encoding="utf-8") as file:
            for part in file.read().replace("STRATUS_EXPERIMENTAL", "STRATUS_API").split("STRATUS_API ")[1:]:
                before = part.split("(")[0].split()
                if before and before[-1].lstrip("*").startswith("stratus_"):
                    marked.add(before[-1].lstrip("*"))
check(marked == set(c.FUNCTIONS), f"functions: {sorted(marked ^ set(c.FUNCTIONS))}")
nm = shutil.which("nm")
if nm:
    library = stratus_volume._core.library._name
    exported = {line.split()[-1] for line in subprocess.run([nm, "-D", "--defined-only", library], check=True, capture_output=True,
                                                            text=True).stdout.splitlines()}
    exported = {name for name in exported if name.startswith("stratus_")}
    check(exported == set(c.FUNCTIONS), f"of the library: {sorted(exported ^ set(c.FUNCTIONS))}")

# Results by value, which a wrong layout would shift.
options = stratus_volume._core.library.stratus_ray_cast_options_default()
check(options.sampling.tolerance == 0.001 and options.clipping.crop_regions == 0x2000 and options.light.shading.diffuse == 0.9
      and options.light.shading.light_count == -1,
      "defaults of rays")
check(list(stratus_volume._core.library.stratus_volume_default().matrix) == [float(n % 5 == 0) for n in range(16)], "the identity")

# The type stubs name what the package has, parameter by parameter.
with open(os.path.join(os.path.dirname(stratus_volume.__file__), "__init__.pyi"), encoding="utf-8") as file:
    stubs = {node.name: node for node in ast.parse(file.read()).body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
check(sorted(stubs) == sorted(stratus_volume.__all__), f"stubs: {sorted(set(stubs) ^ set(stratus_volume.__all__))}")


def compare(stub, own, name):
    parameters = inspect.signature(own).parameters
    names = [each.arg for each in stub.args.args] + ([stub.args.kwarg.arg] if stub.args.kwarg else [])
    check(names == list(parameters), f"stub of {name}: {names} and {list(parameters)}")
    defaults = sum(each.default is not inspect.Parameter.empty for each in parameters.values())
    check(len(stub.args.defaults) == defaults, f"stub of {name}: {len(stub.args.defaults)} defaults, not {defaults}")


for name, stub in stubs.items():
    own = getattr(stratus_volume, name)
    check(len(own.__doc__ or "") > 20, f"{name} is described")
    for method in [stub] if isinstance(stub, ast.FunctionDef) else [node for node in stub.body if isinstance(node, ast.FunctionDef)]:
        one = own if method is stub else inspect.getattr_static(own, method.name)
        one = one.fget if isinstance(one, property) else one.__func__ if isinstance(one, classmethod) else one
        compare(method, one, f"{name}.{method.name}")

# A statement that declare.py does not know is an error, not a gap.
with tempfile.TemporaryDirectory() as folder:
    header = os.path.join(folder, "odd.h")
    for text, of_it in ("typedef struct odd { int bits : 3; } odd;", "bits"), ("STRATUS_API void odd(unknown_type* x);", "unknown_type"), \
            ("union odd { int x; };", "union"):
        with open(header, "w", encoding="utf-8") as file:
            file.write(text + "\n")
        ended = subprocess.run([sys.executable, os.path.join(root, "Python", "declare.py"), os.path.join(folder, "out.py"), header],
                               capture_output=True, text=True)
        check(ended.returncode != 0 and "declare.py does not" in ended.stderr and of_it in ended.stderr, f"{text}: {ended.stderr}")
done()
