# SPDX-License-Identifier: Apache-2.0
"""Reads with readelf which protections of docs/security.md ("Builds") a program lacks."""

import platform
import re
import subprocess


def readelf(*arguments):
    return subprocess.run(["readelf", "--wide", *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout


def missing_protections(program):
    """Names of the missing protections; empty if the program has all."""
    header, dynamic = readelf("--file-header", program), readelf("--dynamic", program)
    segments, symbols = readelf("--program-headers", program), readelf("--dyn-syms", program)
    stack = re.search(r"^\s*GNU_STACK\s.*?\s([RWE]{1,3})\s", segments, re.MULTILINE)
    found = {
        "position-independent": re.search(r"Type:\s+DYN", header) is not None,
        "read-only relocations": "GNU_RELRO" in segments,
        "immediate binding": re.search(r"\(FLAGS(_1)?\).*\bNOW\b|BIND_NOW", dynamic) is not None,
        "stack that is not executable": stack is not None and "E" not in stack.group(1),
        "stack protector": "__stack_chk_fail" in symbols,
        "fortified functions": re.search(r"\b__\w+_chk@", symbols.replace("__stack_chk_fail", "")) is not None,
    }
    if platform.machine() == "x86_64":
        found["landing pads of indirect branches"] = has_landing_pads(program)
    return [name for name, there in found.items() if not there]


def has_landing_pads(program):
    """Whether functions begin with ENDBR64 (-fcf-protection). The ELF note for this is no use, because it also requires
    start files of the distribution with this option. These files have fewer than ten ENDBR64."""
    offset, size = re.search(r"\s\.text\s+PROGBITS\s+[0-9a-f]+\s+([0-9a-f]+)\s+([0-9a-f]+)", readelf("--section-headers", program)).groups()
    with open(program, "rb") as file:
        file.seek(int(offset, 16))
        return file.read(int(size, 16)).count(b"\xf3\x0f\x1e\xfa") >= 100
