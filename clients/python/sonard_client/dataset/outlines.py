# SPDX-License-Identifier: Apache-2.0
"""Outlines of masks along the edges of pixels: pixel (x, y) is the square from (x, y) to (x + 1, y + 1)."""

from __future__ import annotations

from typing import Any

import numpy as np

Loop = Any  # corners, (n, 2) of x and y, closed: the last corner is joined to the first


def outlines(mask: Any) -> tuple[list[Loop], list[Loop]]:
    """(outer loops, holes) of a table of booleans. Together they cover its pixels exactly, by the even-odd rule. Pixels that
    share only a corner are separate parts; gaps that share only a corner are one hole."""
    padded = np.pad(np.asarray(mask, bool), 1)
    nw, ne, sw, se = padded[:-1, :-1], padded[:-1, 1:], padded[1:, :-1], padded[1:, 1:]
    is_saddle = (nw == se) & (ne == sw) & (nw != ne)
    ys, xs = np.nonzero((nw ^ ne ^ sw ^ se) | is_saddle)
    # At a saddle two corners meet: one joins the lines to north and west (pixels nw and se set), or north and east.
    twice = is_saddle[ys, xs]
    joins_north_and_west = nw[ys, xs]
    first = np.where(joins_north_and_west, 0, 1)
    xs, ys = np.concatenate([xs, xs[twice]]), np.concatenate([ys, ys[twice]])
    in_row = np.concatenate([np.where(twice, first, 0), 1 - first[twice]])  # the corner with the line to the west comes first
    in_column = np.concatenate([np.zeros_like(first), np.ones_like(first[twice])])  # the corner with the line to the north
    across, down = _pairs(np.lexsort((in_row, xs, ys))), _pairs(np.lexsort((in_column, ys, xs)))

    outer: list[Loop] = []
    holes: list[Loop] = []
    seen = bytearray(len(xs))
    for start in np.lexsort((1 - in_column, xs, ys)).tolist():  # of two at one place, the one with the line to the south
        corners, at = [], start
        while not seen[at]:
            ahead = across[at]
            seen[at] = seen[ahead] = 1
            corners += [at, ahead]
            at = down[ahead]
        if corners:  # begins at its upper left corner
            (outer if se[ys[start], xs[start]] else holes).append(np.stack([xs[corners], ys[corners]], axis=1))
    return outer, holes


def _pairs(order: Any) -> list[int]:
    """For each corner, the one that the line leads to: in this order, each line joins two neighbours."""
    partner = np.empty(len(order), np.intp)
    partner[order[0::2]], partner[order[1::2]] = order[1::2], order[0::2]
    return list(partner.tolist())


def one_polygon(loops: list[Loop]) -> Loop:
    """All loops as one polygon, joined by lines that lead there and back and hold no area: each from the first corner of a
    loop to the nearest corner before."""
    polygon = loops[0]
    for loop in loops[1:]:
        here = int(((polygon - loop[0]) ** 2).sum(axis=1).argmin())
        polygon = np.concatenate([polygon[: here + 1], loop, loop[:1], polygon[here:]])
    return polygon


def run_lengths(mask: Any) -> list[int]:
    """COCO's uncompressed counts: lengths of runs of 0, 1, 0, ... down the columns, from left to right."""
    flat = np.asarray(mask, bool).ravel(order="F")
    changes = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    counts = np.diff(np.concatenate([[0], changes, [flat.size]])).tolist()
    return [0, *counts] if flat[0] else counts


def box(mask: Any) -> tuple[int, int, int, int]:
    """x, y, width, height in pixels of a mask that is not empty."""
    ys, xs = np.flatnonzero(np.any(mask, axis=1)), np.flatnonzero(np.any(mask, axis=0))
    return int(xs[0]), int(ys[0]), int(xs[-1] - xs[0] + 1), int(ys[-1] - ys[0] + 1)
