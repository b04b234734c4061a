"""The quality of every triangle, 2r/R, of a PLY that meshfront wrote; and the box of its vertices."""
import collections
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "corpus"))
import intersections

BINS = 200
# worst, half_percentile, median: as in the paper's Table 1. share: of the triangles in each of BINS equal steps of 2r/R. box: two corners.
Quality = collections.namedtuple("Quality", "triangles worst half_percentile median bins box")


def radius_ratio(p, q, r):
    """2r/R: 1 of an equilateral triangle, 0 of one without area."""
    a, b, c = math.dist(q, r), math.dist(r, p), math.dist(p, q)
    product = a * b * c
    return max(0.0, (b + c - a) * (c + a - b) * (a + b - c) / product) if product else 0.0


def percentile(ordered, share):
    """Between the two nearest ranks, in proportion."""
    rank = share * (len(ordered) - 1)
    low = math.floor(rank)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (rank - low) * (ordered[high] - ordered[low])


def quality_of(path):
    points, triangles = intersections.read_parts(path)
    ordered = sorted(radius_ratio(points[a], points[b], points[c]) for a, b, c in triangles)
    if not ordered:
        raise ValueError(f"{path.name} has no triangles")
    bins = collections.Counter(min(BINS - 1, int(BINS * q)) for q in ordered)
    box = [[extreme(axis) for axis in zip(*points)] for extreme in (min, max)]
    return Quality(len(ordered), ordered[0], percentile(ordered, 0.005), percentile(ordered, 0.5), [bins[i] for i in range(BINS)], box)
