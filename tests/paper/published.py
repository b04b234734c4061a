"""What the paper prints about itself: Table 1, and the sentences that say what its figures show.

*Direct (Re)Meshing for Efficient Surface Processing*. Counts in thousands of triangles, errors as Hausdorff distance in percent of the
bounding box's diagonal, seconds on a 3.0 GHz Pentium D. The quality column of its table is a picture and has no numbers; section 5
says them in words.
"""
import collections

Row = collections.namedtuple("Row", "rho seconds error out")

INPUT = {"bunny": 69.4, "max": 200.0, "dragon": 100.0, "feline": 151.0, "pelvis": 529.8, "david": 1300.8, "pensatore": 1995.7,
         "buddha": 1087.7}

TABLE_1 = {
    "bunny": [Row(0.5, 28.1, 0.24, 34.2), Row(1.0, 18.2, 0.47, 14.0), Row(1.5, 15.2, 0.57, 8.3)],
    "max": [Row(0.5, 50.6, 0.12, 45.0), Row(1.0, 36.5, 0.33, 18.7), Row(1.5, 33.0, 0.44, 11.4)],
    "dragon": [Row(0.5, 92.6, 0.23, 120.7), Row(1.0, 49.4, 0.34, 51.3), Row(1.5, 38.8, 0.43, 31.2)],
    "feline": [Row(0.5, 80.6, 0.10, 130.7), Row(1.0, 45.0, 0.26, 57.5), Row(1.5, 34.7, 0.28, 37.7)],
    "pelvis": [Row(0.5, 182.0, 0.08, 68.5), Row(1.0, 97.2, 0.14, 26.6), Row(1.5, 93.0, 0.27, 16.2)],
    "david": [Row(1.5, 286.0, 0.59, 133.6)],
    "pensatore": [Row(1.5, 371.0, 0.19, 92.9)],
    "buddha": [Row(0.8, 228.0, 0.90, 182.9)],
}
ETA = 1.2

# Figure 10: of every remesh, the first half percentile is at least this, the median within 3 % of 1; of 30 million triangles, after
# edge flips, the worst is above 1/8.
HALF_PERCENTILE, MEDIAN, WORST = 0.5, 0.97, 0.125
# Figure 11: where there are fewer triangles than in the input, the measured error is about this share of the predicted one.
MEASURED_BY_PREDICTED = 0.5
# Memory, in megabytes.
MEMORY = {"bunny": 17, "pensatore": 470}
