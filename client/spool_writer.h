// From a spooled result to a file of any output format, with bounded memory.
#pragma once

#include "absl/status/status.h"
#include "client/chunk_spool.h"
#include "client/output_file.h"
#include "core/io/mesh_io.h"

namespace meshfront {

// Whether files of the format carry a normal for each vertex, so that the server is asked for them.
bool HoldsNormals(Format format);

// OK for the formats that can be written, else InvalidArgument.
absl::Status CheckWritable(Format format);

// Appends the mesh to `file`; the same bytes for the same mesh, whatever the chunks were. OFF, OBJ, PLY (binary little-endian,
// double), STL (binary), GLB and glTF (one primitive, float32 positions and normals, relative to a node at the
// centre of the mesh when that lies far from the origin). Internal when the disk is full or the mesh
// is beyond what the format can hold (GLB: 4 GiB). Memory: under 4 MB.
absl::Status WriteSpool(const ChunkSpool& spool, Format format, ByteSink& file);

}  // namespace meshfront
