"""The Python client against the real server, over a real socket.

    python_client_test.py MESHFRONTD MESHFRONT [unittest's arguments]     with client/python and the stubs on PYTHONPATH
"""
import array
import math
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

import grpc

import meshfront_client
from meshfront_client import RemeshClient, RemeshError

MESHFRONTD, MESHFRONT = sys.argv[1:3]


def torus(around, along):
    """A torus of radii 1 and 0.4: positions, triangles."""
    positions, triangles = array.array("d"), array.array("I")
    for i in range(around):
        for j in range(along):
            u, v = 2 * math.pi * i / around, 2 * math.pi * j / along
            radius = 1 + 0.4 * math.cos(v)
            positions.extend((radius * math.cos(u), radius * math.sin(u), 0.4 * math.sin(v)))
            a, b = i * along + j, (i + 1) % around * along + j
            c, d = (i + 1) % around * along + (j + 1) % along, i * along + (j + 1) % along
            triangles.extend((a, b, c, a, c, d))
    return positions, triangles


def is_closed(triangles):
    """Whether every edge is run through once in each direction."""
    edges = set()
    for i in range(0, len(triangles), 3):
        t = triangles[i:i + 3]
        for k in range(3):
            edge = (t[k], t[(k + 1) % 3])
            if edge in edges:
                return False
            edges.add(edge)
    return all((b, a) in edges for a, b in edges)


class PythonClient(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = subprocess.Popen([MESHFRONTD, "--listen", "127.0.0.1:0"], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        ready = cls.server.stderr.readline()
        assert "listening on" in ready, ready
        cls.address = ready.split()[-1]
        cls.client = RemeshClient(cls.address)

    @classmethod
    def tearDownClass(cls):
        cls.server.send_signal(signal.SIGTERM)
        cls.server.communicate(timeout=30)

    def test_gives_the_mesh_that_the_program_gives(self):
        positions, triangles = torus(48, 24)
        seen = []
        result = self.client.remesh_mesh(positions, triangles, options={"rho": 0.6}, on_progress=lambda *at: seen.append(at))
        self.assertTrue(result.complete)
        self.assertTrue(is_closed(result.triangles))
        self.assertEqual(len(result.positions) // 3 - len(result.triangles) // 6, 0, "V - F/2 of a torus")
        self.assertEqual(seen[-1][0], len(result.triangles) // 3)
        self.assertGreater(seen[-1][1], 0)
        with tempfile.TemporaryDirectory() as folder:
            source, out = pathlib.Path(folder, "in.off"), pathlib.Path(folder, "out.off")
            meshfront_client.write_off(source, meshfront_client.Result(positions, triangles, None, []))
            subprocess.run([MESHFRONT, "remesh", source, out, "--rho", "0.6", "--quiet"], check=True)
            by_program = out.read_text().split()
            by_file = self.client.remesh_file("in.off", source.read_bytes(), options={"rho": 0.6})
        counts = [int(n) for n in by_program[1:4]]
        self.assertEqual(counts[:2], [len(result.positions) // 3, len(result.triangles) // 3])
        self.assertEqual([float(x) for x in by_program[4:4 + len(result.positions)]], list(result.positions))
        self.assertEqual((by_file.positions, by_file.triangles), (result.positions, result.triangles))

    def test_meshes_points(self):
        positions, _ = torus(90, 60)
        normals = array.array("d")
        for i in range(0, len(positions), 3):
            x, y, z = positions[i:i + 3]
            ring = math.hypot(x, y)
            normals.extend((x - x / ring, y - y / ring, z))
        result = self.client.remesh_points(positions, normals)
        self.assertTrue(result.complete)
        self.assertTrue(is_closed(result.triangles))
        with self.assertRaises(ValueError):
            self.client.remesh_points(positions, normals[3:])

    def test_patches_accumulate_in_a_session(self):
        positions, triangles = torus(96, 48)
        region = {"sphere": {"center": {"x": 1.4}, "radius": 0.3}}
        whole = self.client.remesh_mesh(positions, triangles, options={"rho": 0.5, "region": region})
        kept = len(whole.triangles) // 3 - whole.summary.region.new_triangles
        faces = array.array("I", range(kept, len(whole.triangles) // 3))  # what is new
        options = {"rho": 0.2, "region": {"patch_only": True}}
        twice = self.client.remesh_mesh(whole.positions, whole.triangles, options=options, region_faces=faces)
        first = self.client.remesh_mesh(positions, triangles, options={"rho": 0.5, "region": {**region, "patch_only": True}},
                                        keep_session=True, update_session=True)
        self.assertEqual(len(first.removed), len(triangles) // 3 - kept)
        session = first.summary.session
        second = self.client.remesh_session(session.id, session.revision, options=options, region_faces=faces, update_session=True)
        self.assertEqual((second.positions, second.triangles, second.removed), (twice.positions, twice.triangles, twice.removed))
        self.assertEqual(second.removed, faces)
        # Sent again, as if the answer had been lost: it is told apart from what may be tried again, and not made twice.
        with self.assertRaises(RemeshError) as late:
            self.client.remesh_session(session.id, session.revision, options=options, region_faces=faces, update_session=True)
        self.assertEqual((late.exception.code, late.exception.reason), (grpc.StatusCode.ABORTED, "SESSION_CHANGED"))
        self.assertEqual(late.exception.metadata, {"revision": str(session.revision + 1)})
        after = self.client.remesh_session(session.id, session.revision + 1, options=options, region_faces=faces)
        self.assertEqual(after.summary.session.revision, session.revision + 1)
        with self.assertRaises(RemeshError) as unknown:
            self.client.remesh_session("0123")
        self.assertEqual((unknown.exception.code, unknown.exception.reason), (grpc.StatusCode.NOT_FOUND, "SESSION_UNKNOWN"))

    def test_says_what_the_server_refuses(self):
        positions, triangles = torus(8, 6)
        with self.assertRaises(RemeshError) as refused:
            self.client.remesh_mesh(positions, triangles, options={"rho": 9.0})
        self.assertEqual(refused.exception.code, grpc.StatusCode.INVALID_ARGUMENT)
        self.assertIn("rho", refused.exception.message)
        triangles[0] = 1000
        with self.assertRaises(RemeshError) as refused:
            self.client.remesh_mesh(positions, triangles)
        self.assertEqual(refused.exception.code, grpc.StatusCode.INVALID_ARGUMENT)
        with self.assertRaises(ValueError):
            self.client.remesh_mesh(positions[1:], triangles)
        with self.assertRaises(ValueError):
            self.client.remesh_mesh(positions, triangles, options={"roh": 0.5})
        # Items of another kind are not read as what they are not: numpy's integers have 8 bytes.
        for wrong in (array.array("q", triangles), array.array("H", triangles), array.array("f", positions)):
            with self.assertRaises(TypeError, msg=wrong.typecode):
                self.client.remesh_mesh(positions, wrong)
        with self.assertRaises(TypeError):
            self.client.remesh_mesh(array.array("f", positions), triangles)

    def test_ends_at_its_deadline(self):
        positions, triangles = torus(48, 24)
        with self.assertRaises(RemeshError) as late:
            self.client.remesh_mesh(positions, triangles, options={"rho": 0.01}, timeout=0.5)
        self.assertEqual(late.exception.code, grpc.StatusCode.DEADLINE_EXCEEDED)

    def test_an_exception_of_the_caller_ends_the_job(self):
        positions, triangles = torus(48, 24)

        def stop(*_):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            self.client.remesh_mesh(positions, triangles, options={"rho": 0.05}, on_progress=stop)
        self.assertTrue(self.client.remesh_mesh(positions, triangles).complete, "the server goes on")

    def test_says_that_there_is_no_server(self):
        with self.assertRaises(RemeshError) as gone:
            RemeshClient("127.0.0.1:1").capabilities(timeout=5)
        self.assertEqual((gone.exception.code, gone.exception.reason, gone.exception.metadata), (grpc.StatusCode.UNAVAILABLE, "", {}))
        self.assertIn("rho", " ".join(self.client.capabilities(timeout=30).supported_options))

    def test_sees_reasons_in_what_may_be_damaged(self):
        info = b"\x0a\x03WHY\x1a\x06\x0a\x01k\x12\x01v"
        url = b"type.googleapis.com/google.rpc.ErrorInfo"
        any_detail = b"\x0a" + bytes([len(url)]) + url + b"\x12" + bytes([len(info)]) + info
        details = b"\x08\x0a\x1a" + bytes([len(any_detail)]) + any_detail
        self.assertEqual(meshfront_client._reason_of(details), ("WHY", {"k": "v"}))
        self.assertEqual(meshfront_client._reason_of(b""), ("", {}))
        for size in range(1, len(details)):
            meshfront_client._reason_of(details[:size])
        for byte in range(len(details)):
            meshfront_client._reason_of(details[:byte] + bytes([details[byte] ^ 0xff]) + details[byte + 1:])

    def test_is_a_program_too(self):
        program = meshfront_client.__file__
        with tempfile.TemporaryDirectory() as folder:
            source, out = pathlib.Path(folder, "in.off"), pathlib.Path(folder, "out.off")
            meshfront_client.write_off(source, meshfront_client.Result(*torus(24, 12), None, []))
            done = subprocess.run([sys.executable, program, self.address, source, out, "--target-triangles", "2000"],
                                  capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertAlmostEqual(int(done.stdout.split()[0]) / 2000, 1, delta=0.05)
            before = out.read_bytes()
            refused = subprocess.run([sys.executable, program, self.address, source, out, "--rho", "9"], capture_output=True, text=True,
                                     check=False)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("rho", refused.stderr)
            self.assertEqual(out.read_bytes(), before, "what was there stays")
            for wrong, code in (([source, folder], 7), ([source, pathlib.Path(folder, "none", "out.off")], 7), ([folder, out], 3),
                                ([source, out, "--target-triangles", "-5"], 2), ([source, out, "--timeout", "0"], 6)):
                refused = subprocess.run([sys.executable, program, self.address, *wrong], capture_output=True, text=True, check=False)
                self.assertEqual(refused.returncode, code, wrong)
                self.assertNotIn("Traceback", refused.stderr)
            self.assertFalse(pathlib.Path(f"{folder}.part").exists())


class Damage(unittest.TestCase):
    def test_is_seen(self):
        chunk = meshfront_client.mesh_pb2.Chunk(vertex_count=1, positions=bytes(24))
        chunk.crc32c = meshfront_client.crc32c(chunk.positions)
        meshfront_client._check(chunk, 0, 0)
        for field, value in (("crc32c", 1), ("sequence", 1), ("first_vertex", 1), ("vertex_count", 2), ("indices", bytes(12))):
            damaged = meshfront_client.mesh_pb2.Chunk()
            damaged.CopyFrom(chunk)
            setattr(damaged, field, value)
            with self.assertRaises(meshfront_client.DamagedError, msg=field):
                meshfront_client._check(damaged, 0, 0)
        with self.assertRaises(meshfront_client.DamagedError):
            meshfront_client._collect([], None)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
