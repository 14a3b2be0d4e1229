# SPDX-License-Identifier: Apache-2.0
"""Images as NumPy files, read without NumPy and without our C++ code."""

import ast


def read_npy(path):
    """(rows, columns, bytes) of a file of format 1.0, 8 bits."""
    with open(path, "rb") as file:
        raw = file.read()
    assert raw[:8] == b"\x93NUMPY\x01\x00", path
    size = int.from_bytes(raw[8:10], "little")
    header = ast.literal_eval(raw[10:10 + size].decode("latin1"))
    assert header["descr"] == "|u1" and header["fortran_order"] is False, header
    rows, columns = header["shape"]
    assert len(raw) == 10 + size + rows * columns, path
    return rows, columns, raw[10 + size:]
