#!/usr/bin/env python3
"""Pairs of faces whose meeting is known."""
import pathlib
import struct
import tempfile
import unittest

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
