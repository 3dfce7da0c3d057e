#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The recipes in cmake/packaging agree with the project: test_recipes.py ROOT. Needs no network.

- Every recipe has the version of Core/stratus/version.h, and the change log has a heading for it.
- cmake/packaging/needs.toml lists the libraries that CMake's files look for, and each recipe has the packages of this list.
- Files, options of CMake and components of the installation that recipes name exist.
- YAML, JSON, TOML and Debian's control files parse; issue forms have what GitHub needs.
- set-address writes one address into every recipe, and replaces it."""
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import tomllib
    import yaml
except ImportError as error:
    print(f"SKIPPED: {error} (Debian 12: python3-yaml)")
    sys.exit(77)

RECIPES = "cmake/packaging/"
errors, checks = [], 0


def hold(condition, sentence):
    """Count a check, and keep the sentence that says what does not hold."""
    global checks
    checks += 1
    if not condition:
        errors.append(sentence)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def paragraphs(text):
    """Return the paragraphs of a Debian control file as dictionaries."""
    found = []
    for paragraph in re.split(r"\n\s*\n", re.sub(r"^#.*\n", "", text, flags=re.M).strip()):
        fields = re.findall(r"^([A-Za-z-]+):(.*(?:\n[ \t].*)*)", paragraph, re.M)
        hold(sum(len(name) + 1 + len(value) + 1 for name, value in fields) == len(paragraph) + 1, f"debian/control: a line is no field in\n{paragraph}")
        found.append({name: value.strip() for name, value in fields})
    return found


def packages(field):
    """Return the names in a list of Debian packages."""
    return [re.match(r"[^\s(\[<]+", entry.strip())[0] for entry in field.split(",") if entry.strip()]


def check_versions(recipe):
    header = dict(re.findall(r"^#define STRATUS_VERSION_(\w+) (\d+)$", read("Core/stratus/version.h"), re.M))
    version = ".".join(header[part] for part in ("MAJOR", "MINOR", "PATCH"))
    abi = f"{header['MAJOR']}.{header['MINOR']}"
    places = {
        "CITATION.cff": str(recipe["citation"]["version"]),
        RECIPES + "conda/recipe.yaml": recipe["conda"]["context"]["version"],
        RECIPES + "vcpkg/vcpkg.json": recipe["vcpkg"]["version-semver"],
        RECIPES + "spack/package.py": (re.findall(r'^    version\("([^"]+)"', recipe["spack"], re.M) or ["none"])[0],
        RECIPES + "debian/changelog": (re.findall(r"^stratus \(([^-)]+)-", read(RECIPES + "debian/changelog")) or ["none"])[0],
        RECIPES + "docker/Dockerfile": (re.findall(r'image\.version="([^"]+)"', recipe["docker"]) or ["none"])[0],
        RECIPES + "apptainer/stratus.def": (re.findall(r"^    Version (\S+)$", recipe["apptainer"], re.M) or ["none"])[0],
    }
    for path, found in places.items():
        hold(found == version, f"{path}: version {found} instead of {version}")
    hold(recipe["pyproject"]["tool"]["scikit-build"]["metadata"]["version"]["input"] == "Core/stratus/version.h",
         "pyproject.toml: the version comes from another file")
    hold(f"stratus@{version}" in recipe["spack"], f"spack/package.py: the comment names another version than {version}")
    names = [paragraph["Package"] for paragraph in recipe["debian"][1:]]
    hold(f"libstratus{abi}" in names and f"libstratus-vtk{abi}" in names, f"debian/control: no libraries of {abi} among {names}")
    # A release has a heading "[X.Y.Z] - YYYY-MM-DD"; the version that is being made is "[Unreleased]: X.Y.Z".
    headings = re.findall(r"^## (.*)$", read("CHANGELOG.md"), re.M)
    good = [re.fullmatch(r"\[Unreleased\]: (\d+\.\d+\.\d+)|\[(\d+\.\d+\.\d+)\] - \d{4}-\d\d-\d\d", heading) for heading in headings]
    hold(headings and all(good), f"CHANGELOG.md: headings {headings}")
    listed = [found[1] or found[2] for found in good if found]
    hold(version in listed[:1], f"CHANGELOG.md: the first heading is of {listed[:1]} instead of {version}")
    order = [tuple(map(int, number.split("."))) for number in listed]
    hold(order == sorted(order, reverse=True), f"CHANGELOG.md: the versions {listed} are not in order")
    tags = subprocess.run(["git", "tag", "--list"], capture_output=True, text=True).stdout.split()
    for tag in tags:
        hold(re.fullmatch(r"v\d+\.\d+\.\d+", tag) and tag[1:] in listed, f"the tag {tag} is no version of CHANGELOG.md")


def check_needs(recipe):
    needs = tomllib.loads(read(RECIPES + "needs.toml"))
    listed = {name for need in needs.values() for name in need["cmake"]}
    sought = set()
    own = {"Stratus", "ParaView"}
    files = ["CMakeLists.txt", "module.cmake", "Core/CMakeLists.txt", "Python/CMakeLists.txt", "Applications/stratus/CMakeLists.txt"]
    files += [file for pattern in ("cmake/*.cmake", "Filters/*/CMakeLists.txt", "Rendering/*/CMakeLists.txt") for file in glob.glob(pattern)]
    for file in files:
        text = re.sub(r"#.*", "", read(file))
        sought |= set(re.findall(r"find_package\s*\(\s*(\w+)", text))
        for words in re.findall(r"find_(?:path|library)\s*\(\s*\w+\s+([^)]*)", text):
            names = re.split(r"\s(?:PATH_SUFFIXES|HINTS|PATHS|REQUIRED)\b", words)[0].split()
            sought.add(([name for name in names if name != "NAMES"] + [""])[0])
    sought -= own
    hold(len(sought) > 15, f"only {sought} found in CMake's files")
    for name in sorted(sought - listed):
        hold(False, f"needs.toml lacks {name}, which CMake looks for")
    for name in sorted(listed - sought):
        hold(False, f"needs.toml has {name}, which CMake does not look for")

    def column(system, part=None):
        return {package for need in needs.values() for package in need.get(system, []) if part in (None, need["for"])}

    def compare(path, system, found, others, part=None):
        """others: what the recipe needs besides the libraries."""
        wanted = column(system, part)
        hold(wanted <= found, f"{path} lacks {sorted(wanted - found)} of needs.toml")
        hold(found - wanted <= others, f"{path} has {sorted(found - wanted - others)}, which needs.toml lacks")

    tools = {"debhelper-compat", "dh-python", "python3:any", "cmake", "ninja-build", "pkg-config"}
    compare("debian/control", "debian", set(packages(recipe["debian"][0]["Build-Depends"])), tools)
    made = re.search(r"^packages=\((.*?)\)", read("cmake/make-packages"), re.M | re.S)[1].split()
    compare("cmake/make-packages", "debian", set(made), {"build-essential", "cmake", "ninja-build", "dpkg-dev", "file", "zstd"})
    host = {entry.split()[0] for entry in recipe["conda"]["requirements"]["host"]}
    compare("conda/recipe.yaml", "conda", host, {"pip", "scikit-build-core"})
    used = re.findall(r'^    depends_on\("([\w-]+)[^"]*"(.*)\)$', recipe["spack"], re.M)
    compare("spack/package.py", "spack", {name for name, _ in used}, {"c", "cxx", "cmake", "ninja"})
    core = {name for name, options in used if "when" not in options}
    hold(column("spack", "core") <= core, f"spack/package.py: {sorted(column('spack', 'core') - core)} must not depend on a variant")
    hold(not column("spack", "vtk") & core, f"spack/package.py: {sorted(column('spack', 'vtk') & core)} must depend on a variant")

    def ports(entries):
        return {entry if isinstance(entry, str) else entry["name"] for entry in entries}

    compare("vcpkg.json", "vcpkg", ports(recipe["vcpkg"]["dependencies"]), {"vcpkg-cmake", "vcpkg-cmake-config"}, "core")
    compare("vcpkg.json, feature vtk", "vcpkg", ports(recipe["vcpkg"]["features"]["vtk"]["dependencies"]), set(), "vtk")


def check_names(recipe):
    cmake = "".join(read(file) for file in ["CMakeLists.txt", "module.cmake", "Python/CMakeLists.txt", "Testing/CMakeLists.txt"] + glob.glob("cmake/*.cmake"))
    options = set(re.findall(r"^\s*(?:option|set)\s*\((STRATUS_\w+) ", cmake, re.M))
    texts = {RECIPES + name: read(RECIPES + name) for name in ("conda/build.sh", "debian/rules", "vcpkg/portfile.cmake", "spack/package.py")}
    for path, text in texts.items():
        for option in set(re.findall(r"STRATUS_[A-Z0-9_]+", text)):
            hold(option in options, f"{path}: CMake has no option {option}")
        if path.endswith("portfile.cmake") or path.endswith("package.py"):
            left = {option for option in options if re.fullmatch(r"STRATUS_BUILD_(?!BENCHMARKS).*", option)} - set(re.findall(r"STRATUS_\w+", text))
            allowed = {"STRATUS_BUILD_" + name for name in ("EXR", "NETCDF", "HDF5", "PROJ", "CODECS")} if "vcpkg" in path else set()
            hold(left <= allowed, f"{path} leaves {sorted(left - allowed)} to what CMake finds on the machine")
    components = set(re.findall(r"stratus_package\((\w+) ", read("cmake/packages.cmake")))
    parts = dict(part.split("=") for part in re.search(r"^parts = ((?:.*\\\n)*.*)$", texts[RECIPES + "debian/rules"], re.M)[1].replace("\\\n", " ").split())
    hold(set(parts.values()) == components, f"debian/rules has the components {sorted(parts.values())}, cmake/packages.cmake {sorted(components)}")
    names = {paragraph["Package"] for paragraph in recipe["debian"][1:]}
    hold(set(parts) == names, f"debian/rules has the packages {sorted(parts)}, debian/control {sorted(names)}")
    hold(os.path.normpath(os.path.join(RECIPES, "conda", recipe["conda"]["source"]["path"])) == ".", "conda/recipe.yaml: source is not this checkout")
    for path in (RECIPES + "conda/" + recipe["conda"]["build"]["script"], recipe["conda"]["about"]["license_file"], "cmake/make-packages"):
        hold(os.path.isfile(path), f"there is no {path}")
    for text in (recipe["docker"], recipe["apptainer"]):
        hold("/stratus/cmake/make-packages --no-paraview /packages" in text, "a container is not made by cmake/make-packages")
        hold("pocl-opencl-icd xvfb xauth" in text, "a container lacks PoCL or an X server")
    port = re.search(r"CMAKE_CURRENT_LIST_DIR}(/[./]+)\"", texts[RECIPES + "vcpkg/portfile.cmake"])[1]
    hold(os.path.normpath(RECIPES + "vcpkg" + port) == ".", "vcpkg/portfile.cmake: source is not this checkout")
    tests = paragraphs(read(RECIPES + "debian/tests/control"))
    for name in [test["Tests"] for test in tests]:
        hold(os.access(RECIPES + "debian/tests/" + name, os.X_OK), f"debian/tests/{name} is no program")
    hold(os.access(RECIPES + "debian/rules", os.X_OK), "debian/rules is no program")
    for path in re.findall(r"Files: (?!\*)(\S+)", read(RECIPES + "debian/copyright")):
        hold(os.path.isfile(path), f"debian/copyright: there is no {path}")
    for hook in recipe["hooks"]["repos"][0]["hooks"]:
        for path in re.findall(r"Testing/[\w./]+", hook["entry"]):
            hold(os.path.isfile(path), f".pre-commit-config.yaml: there is no {path}")
    project = recipe["pyproject"]["project"]
    for path in (project["readme"], project["license"]["file"]):
        hold(os.path.isfile(path), f"pyproject.toml: there is no {path}")
    for key in ("authors", "keywords", "classifiers", "description"):
        hold(project.get(key), f"pyproject.toml has no {key}")
    readme = read(RECIPES + "README.md")
    for folder in sorted(entry for entry in os.listdir(RECIPES) if os.path.isdir(RECIPES + entry)):
        hold(f"`{folder}/" in readme, f"cmake/packaging/README.md does not describe {folder}/")


def check_forms():
    forms = sorted(glob.glob(".github/ISSUE_TEMPLATE/*.yml"))
    hold(len(forms) >= 3, f"only the issue forms {forms}")
    for path in forms:
        form = yaml.safe_load(read(path))
        if path.endswith("config.yml"):
            continue
        hold({"name", "description", "body"} <= set(form), f"{path} has only {sorted(form)}")
        ids = [part.get("id") for part in form["body"] if part["type"] != "markdown"]
        hold(None not in ids and len(ids) == len(set(ids)), f"{path}: ids {ids}")
        for part in form["body"]:
            hold(part["type"] in ("markdown", "textarea", "input", "dropdown", "checkboxes"), f"{path}: type {part['type']}")
            hold(part["attributes"].get("value" if part["type"] == "markdown" else "label"), f"{path}: a part has no text")
    for path in glob.glob(".github/workflows/*.yml"):
        workflow = yaml.safe_load(read(path))
        hold(workflow.get("jobs"), f"{path} has no jobs")
        for job in workflow["jobs"].values():
            for step in job["steps"]:
                for script in re.findall(r"(?:docs|Testing|cmake|Python)/[\w/.-]+", step.get("run", "")):
                    hold(os.path.exists(script), f"{path}: there is no {script}")


def check_address():
    """Set an address twice in a copy."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(RECIPES, os.path.join(folder, RECIPES))
        for path in ("pyproject.toml", "CITATION.cff"):
            shutil.copy(path, folder)
        script = os.path.join(folder, RECIPES, "set-address")
        state = {}
        for address in ("https://one.example/a/stratus", "https://two.example/b/stratus", "https://one.example/a/stratus"):
            done = subprocess.run([sys.executable, script, address], capture_output=True, text=True)
            hold(done.returncode == 0, f"set-address {address}: {done.stderr}")
            for place, _, names in os.walk(folder):
                for name in names:
                    path = os.path.join(place, name)
                    text = read(path)
                    if name != "set-address" and ".example/" in text:
                        state[os.path.relpath(path, folder)] = text
            other = "two.example" if "one" in address else "one.example"
            for path, text in state.items():
                hold(address in text and other not in text, f"set-address {address} left {other} in {path}")
        hold(len(state) == 9, f"set-address wrote {sorted(state)}")
        if len(state) == 9:
            hold(tomllib.loads(state["pyproject.toml"])["project"]["urls"]["Homepage"] == address, "pyproject.toml: no address")
            hold(yaml.safe_load(state["CITATION.cff"])["repository-code"] == address, "CITATION.cff: no address")
            hold(yaml.safe_load(state[RECIPES + "conda/recipe.yaml"])["about"]["homepage"] == address, "conda/recipe.yaml: no address")
            hold(json.loads(state[RECIPES + "vcpkg/vcpkg.json"])["homepage"] == address, "vcpkg.json: no address")
            hold(paragraphs(state[RECIPES + "debian/control"])[0]["Homepage"] == address, "debian/control: no address")
            compile(state[RECIPES + "spack/package.py"], "package.py", "exec")
        for wrong in ("http://one.example/a", "https://one.example", "https://one.example/a.git", "one"):
            hold(subprocess.run([sys.executable, script, wrong], capture_output=True).returncode == 2, f"set-address accepts {wrong}")


def main():
    os.chdir(sys.argv[1])
    recipe = {
        "citation": yaml.safe_load(read("CITATION.cff")),
        "conda": yaml.safe_load(read(RECIPES + "conda/recipe.yaml")),
        "vcpkg": json.loads(read(RECIPES + "vcpkg/vcpkg.json")),
        "spack": read(RECIPES + "spack/package.py"),
        "debian": paragraphs(read(RECIPES + "debian/control")),
        "docker": read(RECIPES + "docker/Dockerfile"),
        "apptainer": read(RECIPES + "apptainer/stratus.def"),
        "pyproject": tomllib.loads(read("pyproject.toml")),
        "hooks": yaml.safe_load(read(".pre-commit-config.yaml")),
    }
    compile(recipe["spack"], "package.py", "exec")
    check_versions(recipe)
    check_needs(recipe)
    check_names(recipe)
    check_forms()
    check_address()
    print("\n".join(errors + [f"{checks} checks, {len(errors)} do not hold"]))
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
