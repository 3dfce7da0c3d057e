# SPDX-License-Identifier: BSD-3-Clause
"""Runs `stratus` and checks its output. A script that imports this is called with PATH-OF-STRATUS FOLDER, works in FOLDER, and ends by done(),
with status 1 if anything did not hold."""
import os
import re
import subprocess
import sys

STRATUS = os.path.realpath(sys.argv[1])
failures = 0
os.makedirs(sys.argv[2], exist_ok=True)
os.chdir(sys.argv[2])


def fail(text):
    global failures
    failures += 1
    print("FAILED:", text)


def expect(status, pattern, *words):
    """Runs the command, and returns its output."""
    done = subprocess.run([STRATUS, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
    if done.returncode != status or not re.search(pattern, done.stdout, re.MULTILINE):
        fail(f"'{' '.join(words)}' ended with {done.returncode} and said:\n{done.stdout}instead of {status} and '{pattern}'")
    return done.stdout


def done():
    sys.exit(1 if failures else 0)
