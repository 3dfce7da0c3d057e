# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings: the site is the repository's own pages, linked as they are, and Doxygen's pages of the public headers under api/."""
import os
import re

_root = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
with open(os.path.join(_root, "Core", "stratus", "version.h")) as _header:
    release = ".".join(re.findall(r"#define STRATUS_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", _header.read()))
version = release.rpartition(".")[0]
project = "Stratus"
copyright = "Stratus contributors, BSD-3-Clause"
extensions = ["myst_parser"]
root_doc = "docs/site/index"
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "docs/*.md", "docs/*/*.md", "*/README.md", "*/*/README.md"]
exclude_patterns = ["build*", "**/node_modules"]
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence"]
html_theme = "furo"
html_title = f"Stratus {release}"
html_extra_path = [path for path in [os.environ.get("STRATUS_DOXYGEN", "")] if path]
# Pages link to sources and pictures, which are files of the repository and no pages of the site.
suppress_warnings = ["myst.xref_missing", "myst.header", "toc.not_included", "misc.highlighting_failure"]
