#!/usr/bin/env python3
"""check.py FILE COMPILER [FLAG...]: FILE must fail to compile, for the reason it names."""

import os
import re
import subprocess
import sys


def compile_(command):
    environment = dict(os.environ, LC_ALL="C")  # messages in English
    return subprocess.run(command, env=environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          universal_newlines=True)


def main():
    file, command = sys.argv[1], sys.argv[2:] + ["-fsyntax-only", sys.argv[1]]
    with open(file) as source:
        match = re.match(r"// expect-error: (.+)", source.readline())
    if not match:
        return file + ": the first line must be '// expect-error: REGEX'"
    expected = match.group(1).strip()

    control = compile_(command + ["-DSLAMGC_POSITIVE_CONTROL"])
    if control.returncode != 0:
        return control.stderr + "the positive control does not compile"

    failure = compile_(command)
    if failure.returncode == 0:
        return "it compiles, but should not"
    # Only what is said about errors counts: notes quote source lines, the expected text included.
    errors = [line for line in failure.stderr.splitlines() if "error:" in line]
    if not any(re.search(expected, line) for line in errors):
        return failure.stderr + "no error matches '" + expected + "'"
    return 0


sys.exit(main())
