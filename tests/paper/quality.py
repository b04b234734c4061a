"""The quality of every triangle, 2r/R, of a PLY that meshfront wrote; and the box of its vertices."""
import array
import collections
import math
import struct

BINS = 200
# worst, half_percentile, median: as in the paper's Table 1. share: of the triangles in each of BINS equal steps of 2r/R. box: two corners.
Quality = collections.namedtuple("Quality", "triangles worst half_percentile median bins box")


def read_ply(path):
    """(points, iterator of triangles)"""
    data = path.read_bytes()
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:begin].decode("ascii").splitlines()
    sizes = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element ")}
    properties = [line.split()[1:] for line in header if line.startswith("property ")]
    if properties[:3] != [["double", axis] for axis in "xyz"] or properties[3][0] != "list" or len(properties) != 4:
        raise ValueError(f"{path.name} has more than coordinates of double precision and triangles")
    middle = begin + 24 * sizes["vertex"]
    numbers = array.array("d", data[begin:middle])
    points = list(zip(numbers[0::3], numbers[1::3], numbers[2::3]))
    return points, struct.iter_unpack("<xiii", data[middle:middle + 13 * sizes["face"]])


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
    points, triangles = read_ply(path)
    ordered = sorted(radius_ratio(points[a], points[b], points[c]) for a, b, c in triangles)
    if not ordered:
        raise ValueError(f"{path.name} has no triangles")
    bins = collections.Counter(min(BINS - 1, int(BINS * q)) for q in ordered)
    box = [[extreme(axis) for axis in zip(*points)] for extreme in (min, max)]
    return Quality(len(ordered), ordered[0], percentile(ordered, 0.005), percentile(ordered, 0.5), [bins[i] for i in range(BINS)], box)
