"""Peer of the curve and the vector sum: the IFS tree of 000 §3.3 in numpy.

Prints one JSON line: seconds (the best of several rounds) to iterate a cubic Bézier curve to 2^n segments and to
project it, and to sum two such curves of m points each into m * m vertices.

    python3 ifs_tree.py SEGMENT_ITERATIONS SUM_POINTS
"""

import json
import sys
import time

import numpy as np


def bezier_maps(m):
    """The two transformations of a Bézier curve with m control points (de Casteljau at 1/2), m x m columns."""
    left = np.zeros((m, m))
    for j in range(m):
        column = np.zeros(m)
        column[0] = 1.0
        for _ in range(j):
            column = (column + np.roll(column, 1)) / 2
        left[:, j] = column
    return left, left[::-1, ::-1].copy()


def curve(control, iterations):
    """Homogeneous points P K_n, n-fold tree K_{n+1} = T_1 K_n u T_2 K_n, projected to space; one row per point."""
    m = control.shape[1]
    germ = np.zeros((m, 2))
    germ[0, 0] = germ[m - 1, 1] = 1.0
    maps = bezier_maps(m)
    for _ in range(iterations):
        germ = np.concatenate([t @ germ for t in maps], axis=1)
    figure = control @ germ
    return (figure[:3] / figure[3]).T


def vector_sum(a, b, centre):
    """Vertices A_i + B_j - c in homogeneous coordinates, projected; (rows of b) x (rows of a) x 3."""
    figure = a[None, :, :] + b[:, None, :] - centre
    return figure[..., :3] / figure[..., 3:]


def best(run, rounds=5):
    """Seconds of the fastest of some rounds."""
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def main():
    iterations, points = int(sys.argv[1]), int(sys.argv[2])
    control = np.array([[0.0, 300, 700, 1000], [0, 500, 500, 0], [0, 0, 100, 0], [1, 1, 1, 1]])
    ends = np.linspace(0.0, 1000.0, points)
    a = np.stack([ends, np.sin(ends / 200), 0 * ends, 1 + 0 * ends], axis=1)
    b = np.stack([0 * ends, ends, np.cos(ends / 300), 1 + 0 * ends], axis=1)
    print(json.dumps({
        "curve_s": best(lambda: curve(control, iterations)),
        "vector_sum_s": best(lambda: vector_sum(a, b, np.array([0.0, 0, 0, 1]))),
    }))


main()
