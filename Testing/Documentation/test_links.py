#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Each relative link in a page of the repository leads to a file, and each anchor to a heading: test_links.py ROOT"""
import os
import re
import subprocess
import sys

root = os.path.abspath(sys.argv[1])
pages = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"], cwd=root, capture_output=True, text=True).stdout.split()
if not pages:
    print("SKIPPED: no list of pages from git")
    sys.exit(77)


def anchors(path):
    """Those that GitHub makes of headings."""
    text = re.sub(r"^```.*?^```$", "", open(path).read(), flags=re.M | re.S)
    titles = re.findall(r"^#+ +(.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


failures, links = 0, 0
for page in pages:
    path = os.path.join(root, page)
    text = re.sub(r"^```.*?^```$|`[^`]*`", "", open(path).read(), flags=re.M | re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        links += 1
        file, _, anchor = target.partition("#")
        to = os.path.normpath(os.path.join(os.path.dirname(path), file)) if file else path
        good = os.path.exists(to) and (not anchor or not to.endswith(".md") or anchor in anchors(to))
        if not good:
            failures += 1
            print(f"{page}: {target} leads nowhere")
print(f"{links} links in {len(pages)} pages")
sys.exit(1 if failures or links < 100 else 0)
