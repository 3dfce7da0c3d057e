#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the tutorials as a reader would type them: test_tutorials.py BUILD FOLDER [PAGE...]. The blocks of a page run in their order, in a folder
of the page's own: sh by bash, with the build's programs on the path, python in one process a page, with the build's packages, and c is
kept under the name in its first line. A page fails with its first block that fails, or that draws an image of nothing. Blocks of ParaView
run by pvbatch, where STRATUS_PVBATCH names it; STRATUS_PLUGIN names the plugin."""
import os
import re
import shutil
import subprocess
import sys

build, folder = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
pvbatch = os.environ.get("STRATUS_PVBATCH")
pages = sys.argv[3:] or ["meteorologist", "oceanographer", "image", "numpy", "tetrahedra", "c"]
environment = dict(os.environ, PATH=os.path.join(build, "bin") + os.pathsep + os.environ["PATH"],
                   PYTHONPATH=os.path.join(build, "lib", "python3", "dist-packages"), OMP_WAIT_POLICY="passive")


def installed_core():
    """The core as pkg-config finds it: of this build, installed into the folder."""
    prefix = os.path.join(folder, "prefix")
    for part in "core", "core_development":
        subprocess.run(["cmake", "--install", build, "--prefix", prefix, "--component", part], check=True, stdout=subprocess.DEVNULL)
    found = [path for path, _, files in os.walk(prefix) if "stratus-core.pc" in files]
    libraries = [path for path, _, files in os.walk(prefix) if "libstratus-core.so" in files]
    return {"PKG_CONFIG_PATH": found[0], "LD_LIBRARY_PATH": libraries[0]}


def blocks(text):
    return re.findall(r"^```(\w+)\n(.*?)^```$", text, re.M | re.S)


def run(page):
    place = os.path.join(folder, page)
    shutil.rmtree(place, ignore_errors=True)
    os.makedirs(place)
    own = dict(environment, **(installed_core() if page == "c" else {}))
    todo = blocks(open(f"docs/tutorials/{page}.md").read())
    assert todo, f"{page} has no block to run"
    python = None  # one process a page: blocks share what they define
    if page == "paraview":
        whole = "from paraview import simple\nsimple.LoadPlugin(%r, ns=globals())\n" % os.environ["STRATUS_PLUGIN"]
        whole += "".join(code for kind, code in todo if kind == "python") + "print('to the end')\n"
        open(os.path.join(place, "page.py"), "w").write(whole)
        done = subprocess.run([pvbatch, "page.py"], cwd=place, env=dict(own, PYTHONPATH=""), capture_output=True, text=True)
        return [] if "to the end" in done.stdout else [done.stdout + done.stderr]
    for kind, code in todo:
        if kind == "python":
            if python is None:
                runner = "import sys\nnames = {}\n" \
                    "for block in iter(lambda: sys.stdin.read(int(sys.stdin.readline() or 0)), ''):\n" \
                    "    exec(compile(block, 'block', 'exec'), names)\n    print('block done', flush=True)\n"
                python = subprocess.Popen(["/usr/bin/python3", "-c", runner], cwd=place, env=own, text=True,
                                          stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            python.stdin.write(f"{len(code)}\n{code}")
            python.stdin.flush()
            output = ""
            for line in python.stdout:
                if line == "block done\n":
                    break
                output += line
            else:
                return [f"{code}\n{output}"]
        elif kind == "sh":
            done = subprocess.run(["bash", "-e", "-o", "pipefail", "-c", code], cwd=place, env=own, capture_output=True, text=True)
            if re.search(r"^  samples +0 taken", done.stdout, re.M):
                return [f"{code}\n{done.stdout}an image shows nothing"]
            if done.returncode:
                return [f"{code}\n{done.stdout}{done.stderr}"]
        elif kind == "c":
            open(os.path.join(place, re.match(r"/\* (\S+):", code)[1]), "w").write(code)
    if python:
        python.stdin.close()
        python.stdout.close()
        python.wait()
    return []


failures = 0
for page in pages:
    if page == "c" and not shutil.which("pkg-config"):
        print("SKIPPED: no pkg-config; the page c did not run")
        continue
    trouble = run(page)
    failures += len(trouble)
    print(f"{page}: {'fails:' if trouble else 'runs'}", *trouble)
sys.exit(1 if failures else 0)
