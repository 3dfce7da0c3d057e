#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the site and looks through its pages: test_site.py ROOT BUILD

- Each link within the site leads to a file, and each anchor to a place on its page.
- The references have every option of the command line, every public name of the Python package and every public header.
- The home page leads to four ways in and four tutorials, shows a picture, and has the version; the search index knows the references."""
import ast
import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit

root, build = map(os.path.abspath, sys.argv[1:3])
site = os.path.join(build, "site")
errors = []


class Page(HTMLParser):
    """The links and anchors of a page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.anchors, self.images = set(), set(), 0
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.feed(self.text)

    def handle_starttag(self, tag, attributes):
        known = dict(attributes)
        self.anchors |= {known.get("id"), known.get("name")}
        self.images += tag == "img"
        for key in ("href", "src"):
            if known.get(key):
                self.links.add(known[key])


def hold(condition, sentence):
    if not condition:
        errors.append(sentence)


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


def check_links(pages):
    links = 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or link.startswith("data:"):
                continue
            links += 1
            to = os.path.normpath(os.path.join(os.path.dirname(path), unquote(parts.path))) if parts.path else path
            name = os.path.relpath(path, site)
            if not os.path.isfile(to):
                hold(False, f"{name}: {link} leads nowhere")
            elif parts.fragment and to in pages:
                hold(unquote(parts.fragment) in pages[to].anchors, f"{name}: {link} has no such place")
    hold(links > 2000, f"only {links} links")
    return links


def main():
    done = subprocess.run([os.path.join(root, "docs", "site", "build"), build])
    if done.returncode:
        return done.returncode
    pages = {}
    for folder, _, names in os.walk(site):
        if os.path.relpath(folder, site).split(os.sep)[0] != "api":  # Doxygen's own, which it checks
            pages.update({os.path.join(folder, name): None for name in names if name.endswith(".html")})
    for path in pages:
        pages[path] = Page(path)
    links = check_links(pages)

    of = {name: pages[os.path.join(site, "docs", "site", name + ".html")] for name in ("index", "command-line", "python", "c")}
    options = set(re.findall(r"^  (--[\w-]+)", read(root, "Applications", "stratus", "options.cxx"), re.M))
    hold(len(options) > 50, f"only {len(options)} options in options.cxx")
    for option in sorted(options):
        hold(f"cmdoption{option[1:]}" in of["command-line"].anchors, f"the reference of the command line lacks {option}")
    module = ast.parse(read(root, "Python", "stratus_volume", "__init__.py"))
    names = [node.value for node in module.body if isinstance(node, ast.Assign) and node.targets[0].id == "__all__"][0]
    for name in ast.literal_eval(names):
        hold(f"stratus_volume.{name}" in of["python"].anchors, f"the reference of Python lacks {name}")
    headers = os.listdir(os.path.join(root, "Core", "stratus"))
    for header in headers:
        hold(os.path.isfile(os.path.join(site, "api", "html", header[:-2].replace("_", "__") + "_8h.html")), f"the reference of C lacks {header}")

    version = ".".join(re.findall(r"#define STRATUS_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", read(root, "Core", "stratus", "version.h")))
    hold(f"Stratus {version}" in of["index"].text, f"the home page lacks the version {version}")
    hold(of["index"].images >= 5, f"the home page has {of['index'].images} pictures")
    for page in ("../command-line", "../python", "../../ParaView/README", "../install", "../tutorials/meteorologist", "../tutorials/oceanographer",
                 "../tutorials/image", "../tutorials/c", "command-line", "python", "c"):
        hold(page + ".html" in of["index"].links, f"the home page does not lead to {page}")
    search = read(site, "searchindex.js")
    for page in ("docs/site/command-line", "docs/site/python", "docs/tutorials/oceanographer"):
        hold(f'"{page}"' in search, f"the search does not know {page}")
    print("\n".join(errors[:60] + [f"{len(pages)} pages, {links} links, {len(options)} options, {len(errors)} errors"]))
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
