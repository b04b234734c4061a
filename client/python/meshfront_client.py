#!/usr/bin/env python3
"""Remeshes over gRPC from Python: to use, or to see what a client in any language has to do.

    client/python/generate_stubs
    client/python/meshfront_client.py HOST:PORT in.ply out.off --rho 0.5

or, in a program:

    client = meshfront_client.RemeshClient("127.0.0.1:50051")
    result = client.remesh_mesh(positions, triangles, options={"rho": 0.5})
    result.positions, result.triangles, result.summary.quality.radius_ratio_median

Arrays go in as buffers of float64 and uint32 (array.array, numpy, bytes), and come back as array.array. Debian's packages: python3-grpcio,
python3-protobuf, python3-crcmod.
"""
import argparse
import array
import dataclasses
import errno
import hashlib
import os
import pathlib
import sys

import crcmod.predefined
import grpc

sys.path.append(os.environ.get("MESHFRONT_STUBS", str(pathlib.Path(__file__).resolve().parent / "generated")))
from meshfront.v1 import events_pb2, mesh_pb2, options_pb2, remesh_service_pb2, remesh_service_pb2_grpc  # noqa: E402

BLOCK_BYTES = 1 << 18
# Chunks of up to 1 MiB and what is around them.
MESSAGE_BYTES = 4 << 20

crc32c = crcmod.predefined.mkCrcFun("crc-32c")


class RemeshError(Exception):
    """The server refused, or the call failed. `code`: a grpc.StatusCode.

    `reason`: why, for programs, in UPPER_SNAKE (SESSION_CHANGED, OUT_OF_MEMORY, …), and `metadata`: a dict that says where; both empty where
    no server of ours says so, as where there is none.
    """

    def __init__(self, error):
        super().__init__(f"{error.code().name}: {error.details()}")
        self.code, self.message = error.code(), error.details()
        self.reason, self.metadata = _reason_of(dict(error.trailing_metadata() or ()).get("grpc-status-details-bin", b""))


class DamagedError(Exception):
    """What came back is not what was sent: a checksum, a number or a count is wrong."""


@dataclasses.dataclass
class Result:
    """A mesh, and the report on it."""
    positions: array.array      # float64, three a vertex
    triangles: array.array      # uint32, three a triangle, counter-clockwise seen from outside
    summary: events_pb2.Summary
    warnings: list              # sentences
    # uint32: faces of the input that a patch (region.patch_only) takes the place of
    removed: array.array = dataclasses.field(default_factory=lambda: array.array("I"))

    @property
    def complete(self):
        """Whether it is whole; else summary.open_places says where it is not."""
        return self.summary.complete


class RemeshClient:
    """Calls one server. Safe to share among threads."""

    def __init__(self, target, credentials=None):
        """`target`: HOST:PORT. `credentials`: grpc.ssl_channel_credentials(…) for a server with TLS."""
        limits = [("grpc.max_receive_message_length", MESSAGE_BYTES)]
        channel = grpc.secure_channel(target, credentials, limits) if credentials else grpc.insecure_channel(target, limits)
        self._stub = remesh_service_pb2_grpc.MeshfrontServiceStub(channel)

    def capabilities(self, timeout=None):
        """What the server can do and allows: remesh_service_pb2.GetCapabilitiesResponse."""
        try:
            return self._stub.GetCapabilities(remesh_service_pb2.GetCapabilitiesRequest(), timeout=timeout)
        except grpc.RpcError as error:
            raise RemeshError(error) from None

    def remesh_mesh(self, positions, triangles, **keywords):
        """Remeshes an indexed mesh. Keywords: see _call."""
        positions, triangles = _as_bytes(positions, 24, "positions"), _as_bytes(triangles, 12, "triangles")
        header = mesh_pb2.Header(mesh=mesh_pb2.MeshArrays(vertex_count=len(positions) // 24, triangle_count=len(triangles) // 12,
                                                          scalar_type=mesh_pb2.SCALAR_TYPE_FLOAT64))
        return self._call(header, {mesh_pb2.ARRAY_POSITIONS: positions, mesh_pb2.ARRAY_TRIANGLES: triangles}, **keywords)

    def remesh_points(self, positions, normals=None, **keywords):
        """Meshes a point set, with outward normals or without. Keywords: see _call."""
        arrays = {mesh_pb2.ARRAY_POSITIONS: _as_bytes(positions, 24, "positions")}
        count = len(arrays[mesh_pb2.ARRAY_POSITIONS]) // 24
        if normals is not None:
            arrays[mesh_pb2.ARRAY_NORMALS] = _as_bytes(normals, 24, "normals")
            if len(arrays[mesh_pb2.ARRAY_NORMALS]) != 24 * count:
                raise ValueError(f"there are {len(arrays[mesh_pb2.ARRAY_NORMALS]) // 24} normals for {count} points")
        header = mesh_pb2.Header(points=mesh_pb2.PointSet(point_count=count, scalar_type=mesh_pb2.SCALAR_TYPE_FLOAT64,
                                                          has_normals=normals is not None))
        return self._call(header, arrays, **keywords)

    def remesh_file(self, name, data, **keywords):
        """Remeshes what is in a file (OFF, OBJ, PLY, STL, GLB, glTF, XYZ), which the server reads. Keywords: see _call."""
        header = mesh_pb2.Header(file=mesh_pb2.WholeFile(name=pathlib.PurePath(name).name, size_bytes=len(data)))
        return self._call(header, {mesh_pb2.ARRAY_FILE: memoryview(data)}, **keywords)

    def remesh_session(self, session_id, session_revision=None, **keywords):
        """Remeshes the mesh that the server keeps as summary.session.id; RemeshError (reason SESSION_CHANGED) where it has another revision
        than this. With its revision an update may be sent again whose answer was lost: it is not made twice.

        Keywords: see _call.
        """
        return self._call(mesh_pb2.Header(session_id=session_id, session_revision=session_revision), {}, **keywords)

    def _call(self, header, arrays, options=None, timeout=None, on_progress=None, region_faces=None, keep_session=False,
              update_session=False):
        """`options`: a dict or an options_pb2.RemeshOptions; `timeout`: seconds; `on_progress(triangles, predicted_triangles)`.

        `region_faces`: a buffer of uint32, faces to remesh. `keep_session`: the server keeps the mesh for remesh_session.
        `update_session`: with that or of a session, the result takes the place of the mesh that is kept. Its faces are the input's but for
        the removed ones, then the new ones.

        Raises RemeshError, DamagedError. A call that is broken off (an exception in on_progress, Ctrl-C) is cancelled on the server too.
        """
        if options is not None:
            header.options.CopyFrom(options_pb2.RemeshOptions(**options) if isinstance(options, dict) else options)
        header.output.scalar_type = mesh_pb2.SCALAR_TYPE_FLOAT64
        header.keep_session, header.update_session = keep_session, update_session
        if region_faces is not None:
            arrays = {**arrays, mesh_pb2.ARRAY_REGION_FACES: _as_bytes(region_faces, 4, "region_faces")}
            header.options.region.face_count = len(arrays[mesh_pb2.ARRAY_REGION_FACES]) // 4
        call = self._stub.Remesh(_requests(header, arrays), timeout=timeout)
        try:
            return _collect(call, on_progress)
        except grpc.RpcError as error:
            raise RemeshError(error) from None
        finally:
            call.cancel()  # does nothing to a call that has ended


def _as_bytes(buffer, element, name):
    """The bytes of three float64 (24), three uint32 (12) or one (4) each; bytes themselves are taken as they are."""
    view = memoryview(buffer)
    if not view.c_contiguous:
        raise ValueError(f"{name} must be contiguous")
    wanted, size = {24: (("d",), 8), 12: (("I", "L", "i"), 4), 4: (("I", "L", "i"), 4)}[element]
    if view.format not in ("B", "b", "c") and (view.format.lstrip("@=<") not in wanted or view.itemsize != size):
        raise TypeError(f"{name} has items of format {view.format!r}; it takes {'float64' if element == 24 else 'uint32'}")
    view = view.cast("B")
    if len(view) == 0 or len(view) % element:
        raise ValueError(f"{name} has {len(view)} bytes; it takes {element} each")
    return view


def _fields(message):
    """(number, bytes) of each field of a Protobuf message that has a length; the others are passed over."""
    at = 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = message[at]
            at, value, shift = at + 1, value | (byte & 127) << shift, shift + 7
            if byte < 128:
                return value

    while at < len(message):
        key = varint()
        if key & 7 == 0:
            varint()
            continue
        size = {1: 8, 5: 4}.get(key & 7) or varint()
        if key & 7 == 2:
            yield key >> 3, message[at:at + size]
        at += size


def _reason_of(details):
    """(reason, metadata) of the google.rpc.ErrorInfo in a google.rpc.Status; ("", {}) where there is none, or the bytes are damaged."""
    try:
        for any_detail in (dict(_fields(value)) for number, value in _fields(details) if number == 3):
            if not any_detail.get(1, b"").endswith(b"/google.rpc.ErrorInfo"):
                continue
            info = list(_fields(any_detail.get(2, b"")))
            entries = [dict(_fields(value)) for number, value in info if number == 3]
            metadata = {entry.get(1, b"").decode(): entry.get(2, b"").decode() for entry in entries}
            return dict(info).get(1, b"").decode(), metadata
    except (IndexError, UnicodeDecodeError):
        pass
    return "", {}


def _requests(header, arrays):
    """Header, blocks, end: what the server wants, in the order that it wants it."""
    yield remesh_service_pb2.RemeshRequest(header=header)
    digest = hashlib.sha256()
    for name, data in arrays.items():
        for offset in range(0, len(data), BLOCK_BYTES):
            block = bytes(data[offset:offset + BLOCK_BYTES])
            digest.update(block)
            yield remesh_service_pb2.RemeshRequest(
                block=mesh_pb2.DataBlock(array=name, offset=offset, data=block, crc32c=crc32c(block)))
    yield remesh_service_pb2.RemeshRequest(end=mesh_pb2.EndOfInput(sha256=digest.digest()))


def _collect(call, on_progress):
    positions, triangles, removed, warnings = array.array("d"), array.array("I"), array.array("I"), []
    chunks, predicted, summary = 0, 0, None
    for response in call:
        kind = response.event.WhichOneof("event")
        if kind == "chunk":
            chunk = response.event.chunk
            _check(chunk, chunks, len(positions) // 3)
            positions.frombytes(chunk.positions)
            triangles.frombytes(chunk.indices)
            chunks += 1
        elif kind == "removed":
            if crc32c(response.event.removed.faces) != response.event.removed.crc32c:
                raise DamagedError("a list of removed faces is not what was sent")
            removed.frombytes(response.event.removed.faces)
        elif kind == "progress":
            predicted = response.event.progress.predicted_triangles
        elif kind == "defect":
            warnings.append(response.event.defect.message)
        elif kind == "summary":
            summary = response.event.summary
            warnings.extend(summary.warnings)
        if on_progress and kind in ("chunk", "progress"):
            on_progress(len(triangles) // 3, predicted)
    if summary is None or summary.chunks != chunks:
        raise DamagedError("the stream ended without its summary, or chunks are missing: the mesh is not whole")
    if summary.region.removed_faces != len(removed):
        raise DamagedError(f"{len(removed)} removed faces came; there are {summary.region.removed_faces}")
    if sys.byteorder == "big":
        positions.byteswap(), triangles.byteswap(), removed.byteswap()
    return Result(positions, triangles, summary, warnings, removed)


def _check(chunk, sequence, first_vertex):
    # All bytes fields, in the order of their numbers.
    crc = 0
    for data in (chunk.positions, chunk.normals, chunk.indices, chunk.finalised, chunk.wedge_values, chunk.corner_wedges, chunk.groups):
        crc = crc32c(data, crc)
    if (chunk.crc32c, chunk.sequence, chunk.first_vertex) != (crc, sequence, first_vertex):
        raise DamagedError(f"chunk {sequence} is not what was sent")
    if len(chunk.positions) != 24 * chunk.vertex_count or len(chunk.indices) != 12 * chunk.triangle_count:
        raise DamagedError(f"chunk {sequence} has other arrays than it says")


EXIT_CODES = {
    grpc.StatusCode.INVALID_ARGUMENT: 2, grpc.StatusCode.FAILED_PRECONDITION: 3, grpc.StatusCode.UNAVAILABLE: 5,
    grpc.StatusCode.RESOURCE_EXHAUSTED: 5, grpc.StatusCode.CANCELLED: 6, grpc.StatusCode.DEADLINE_EXCEEDED: 6,
}


def write_off(path, result):
    """Writes the mesh aside and renames it, so that a file that was there is whole at any time. OSError where it can't."""
    p, t = result.positions, result.triangles
    if pathlib.Path(path).exists() and not pathlib.Path(path).is_file():
        raise OSError(errno.EINVAL, "is no regular file", str(path))
    aside = pathlib.Path(f"{path}.part")
    with aside.open("w", encoding="ascii") as out:
        out.write(f"OFF\n{len(p) // 3} {len(t) // 3} 0\n")
        out.writelines(f"{p[i]!r} {p[i + 1]!r} {p[i + 2]!r}\n" for i in range(0, len(p), 3))
        out.writelines(f"3 {t[i]} {t[i + 1]} {t[i + 2]}\n" for i in range(0, len(t), 3))
    aside.replace(path)


def main():
    parser = argparse.ArgumentParser(description="Remeshes a file on a server.")
    parser.add_argument("server", metavar="HOST:PORT")
    parser.add_argument("input", metavar="IN", help="OFF, OBJ, PLY, STL, GLB, glTF or XYZ")
    parser.add_argument("output", metavar="OUT.off")
    parser.add_argument("--rho", type=float, help="angle that an edge subtends on the osculating circle, default 0.8")
    parser.add_argument("--target-triangles", type=int)
    parser.add_argument("--timeout", type=float, help="seconds")
    arguments = parser.parse_args()
    options = {name: value for name in ("rho", "target_triangles") if (value := getattr(arguments, name)) is not None}

    def show(triangles, predicted):
        if sys.stderr.isatty():
            print(f"\r{triangles} of about {predicted} triangles", end="", file=sys.stderr, flush=True)

    def give_up(code, error):
        said = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else error
        print(f"meshfront_client: {said}", file=sys.stderr)
        return code

    # The program's exit codes.
    try:
        data = pathlib.Path(arguments.input).read_bytes()
    except OSError as error:
        return give_up(3, error)
    try:
        result = RemeshClient(arguments.server).remesh_file(arguments.input, data, options=options, timeout=arguments.timeout,
                                                            on_progress=show)
    except ValueError as error:  # an option that its field can't hold
        return give_up(2, error)
    except RemeshError as error:
        return give_up(EXIT_CODES.get(error.code, 70), error)
    except DamagedError as error:
        return give_up(5, error)
    for warning in result.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    try:
        write_off(arguments.output, result)
    except OSError as error:
        return give_up(7, error)
    quality = result.summary.quality
    print(f"{len(result.triangles) // 3} triangles, 2r/R {quality.radius_ratio_min:.3f} at least, {quality.radius_ratio_median:.3f} in the middle")
    return 0 if result.complete else 4


if __name__ == "__main__":
    sys.exit(main())
