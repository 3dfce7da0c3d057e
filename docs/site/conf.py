# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings: the site is the repository's own pages, linked as they are, and Doxygen's pages of the public headers under api/."""
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
_root = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
with open(os.path.join(_root, "Core", "stratus", "version.h")) as _header:
    release = ".".join(re.findall(r"#define STRATUS_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", _header.read()))
version = release.rpartition(".")[0]
project = "Stratus"
copyright = "Stratus contributors, BSD-3-Clause"
extensions = ["myst_parser", "sphinx_design", "sphinx_copybutton", "reference"]
root_doc = "docs/site/index"
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "docs/*.md", "docs/*/*.md", "*/README.md", "*/*/README.md"]
exclude_patterns = ["build*", "**/node_modules"]
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence", "deflist"]
smartquotes = False # options begin with two hyphens
html_theme = "furo"
html_title = f"Stratus {release}"
html_copy_source = False
html_static_path = ["static"]
html_css_files = ["stratus.css"]
html_theme_options = {"navigation_with_keys": True}
add_module_names = False
toc_object_entries = True
toc_object_entries_show_parents = "hide"
html_extra_path = [path for path in [os.environ.get("STRATUS_DOXYGEN", "")] if path]
# Pages link to sources and pictures, which are files of the repository and no pages of the site.
suppress_warnings = ["myst.xref_missing", "myst.header", "toc.not_included", "misc.highlighting_failure"]

_address = os.path.join(_root, "cmake", "packaging", "address")  # where the project is published, if it is


def _link_folders(app, docname, source):
    """Links to folders of the repository lead to its page, or are only text, because the site has no such pages."""
    here = os.path.dirname(os.path.join(_root, docname))

    def link(found):
        folder = os.path.normpath(os.path.join(here, found[2]))
        if not os.path.isdir(folder):
            return found[0]
        if not os.path.isfile(_address):
            return found[1]
        with open(_address) as file:
            return f"[{found[1]}]({file.read().strip()}/tree/main/{os.path.relpath(folder, _root)})"

    source[0] = re.sub(r"\[([^\]\n]+)\]\(([\w./-]+)\)", link, source[0])


def setup(app):
    app.connect("source-read", _link_folders)
