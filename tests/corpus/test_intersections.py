#!/usr/bin/env python3
"""Pairs of faces whose meeting is known."""
import math
import pathlib
import struct
import tempfile
import unittest
from unittest import mock

import intersections as at

FLOOR = [(0, 0, 0), (4, 0, 0), (0, 4, 0)]


def mesh(*triangles):
    points = [p for t in triangles for p in t]
    return at.welded(points, [(k, k + 1, k + 2) for k in range(0, len(points), 3)])


class Intersections(unittest.TestCase):
    def test_a_blade_through_the_floor_meets_it_in_a_segment(self):
        pairs = at.pairs_of(mesh(FLOOR, [(1, 1, -1), (1, 1, 1), (1, -3, 1)]))
        self.assertEqual([(i, j) for i, j, _ in pairs], [(0, 1)])
        self.assertLessEqual({(1.0, 1.0, 0.0), (1.0, 0.0, 0.0)}, set(pairs[0][2]))

    def test_a_corner_on_the_floor_counts(self):
        self.assertEqual(1, len(at.pairs_of(mesh(FLOOR, [(1, 1, 0), (1, 1, 1), (1, 2, 1)]))))

    def test_a_corner_just_above_the_floor_does_not(self):
        self.assertEqual([], at.pairs_of(mesh(FLOOR, [(1, 1, 1e-300), (1, 1, 1), (1, 2, 1)])))

    def test_neighbours_over_an_edge_do_not_meet(self):
        self.assertEqual([], at.pairs_of(mesh(FLOOR, [(4, 0, 0), (0, 0, 0), (0, -4, 0)])))

    def test_a_fold_flat_onto_its_neighbour_does(self):
        self.assertEqual(1, len(at.pairs_of(mesh(FLOOR, [(4, 0, 0), (0, 0, 0), (1, 1, 0)]))))

    def test_a_neighbour_at_one_vertex_that_cuts_through_does(self):
        pairs = at.pairs_of(mesh(FLOOR, [(0, 0, 0), (2, 1, 1), (1, 2, -1)]))
        self.assertEqual(1, len(pairs))
        self.assertIn((1.5, 1.5, 0.0), pairs[0][2])

    def test_overlap_in_a_plane_counts_and_faces_without_area_do_not(self):
        line = [(0, 0, 0), (1, 0, 0), (2, 0, 0)]
        self.assertEqual([(0, 1)], [(i, j) for i, j, _ in at.pairs_of(mesh(FLOOR, [(1, 1, 0), (9, 1, 0), (9, 2, 0)], line))])

    def test_the_next_meeting_is_as_far_as_it_is(self):
        near = at.NearestMeeting(mesh(FLOOR, [(1, 1, -1), (1, 1, 1), (1, -3, 1)]), reach=2.0)
        self.assertAlmostEqual(1.0, near.distance((1, 0.5, 1)))
        self.assertEqual(float("inf"), near.distance((4, 0, 0)))

    def test_neighbours_at_one_vertex_meet_from_there_on(self):
        blade = [FLOOR[0], (3, 1, 1), (3, 1, -1)]  # through the floor from its corner at the origin
        near = at.NearestMeeting(mesh(FLOOR, blade), reach=2.0)
        for x in (0.0, 1.0, 2.0):
            self.assertAlmostEqual(0.5, near.distance((x, x / 3, 0.5)))

    def test_faces_in_one_plane_meet_in_all_that_they_share(self):
        near = at.NearestMeeting(mesh(FLOOR, [(-1, -1, 0), (8, -1, 0), (-1, 8, 0)]), reach=2.0)
        for x, y in ((0.5, 0.5), (1.3, 1.2), (3, 0.5), (0, 0)):
            self.assertAlmostEqual(0.25, near.distance((x, y, 0.25)))
        self.assertAlmostEqual(1.0, near.distance((1, -1, 0)))

    def test_of_a_row_of_meetings_only_the_near_ones_are_looked_at(self):
        far_apart = [[(x, 1, -1), (x, 1, 1), (x, 2, 1)] for x in range(0, 200, 2)]
        near = at.NearestMeeting(mesh([(-9, 0, 0), (300, 0, 0), (0, 99, 0)], *far_apart), reach=150.0)
        self.assertAlmostEqual(0.25, near.distance((100, 1, 0.25)))
        self.assertLessEqual(len(near.parts), 3)
        self.assertAlmostEqual(50.0, near.distance((99, 1, -math.sqrt(50 ** 2 - 1))))

    def test_faces_beside_the_plane_of_another_are_not_looked_at_edge_by_edge(self):
        hill = [[(0, 0, 1), (math.cos(k), math.sin(k), 0), (math.cos(k + 1), math.sin(k + 1), 0)] for k in range(6)]
        with mock.patch.object(at, "segment_meets") as looked:
            self.assertEqual([], at.pairs_of(mesh(*hill)))
        looked.assert_not_called()

    def test_whole_numbers_decide_where_floating_point_does_not(self):
        a, b, c = (0.1, 0.2, 0.3), (0.3, 0.1, 0.7), (0.2, 0.9, 0.4)
        self.assertEqual(0, at.side(a, b, c, b))
        tiny = 5e-324
        self.assertEqual(-at.side((0, 0, 0), (1, 0, 0), (0, 1, 0), (0.3, 0.3, tiny)),
                         at.side((0, 0, 0), (1, 0, 0), (0, 1, 0), (0.3, 0.3, -tiny)))
        self.assertNotEqual(0, at.side((0, 0, 0), (1, 0, 0), (0, 1, 0), (0.3, 0.3, tiny)))
        points = at.whole((0.5, 0.25, 3.0), (1.0, 0.0, -0.125))
        self.assertEqual([(4, 2, 24), (8, 0, -1)], points)

    def test_a_written_mesh_is_read_and_its_equal_positions_are_one(self):
        header = ("ply\nformat binary_little_endian 1.0\ncomment Meshfront\nelement vertex 4\nproperty double x\nproperty double y\n"
                  "property double z\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n")
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "m.ply"
            corners = struct.pack("<12d", *(x for p in (*FLOOR, FLOOR[0]) for x in p))
            file.write_bytes(header.encode() + corners + struct.pack("<B3I", 3, 3, 1, 2))
            self.assertEqual([(0, 1, 2)], at.read_ply(file).faces)


if __name__ == "__main__":
    unittest.main()
