// A mesh as the messages of a request: header, blocks, end.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/mesh/polylines.h"
#include "core/mesh/triangle_mesh.h"
#include "meshfront/v1/mesh.pb.h"

namespace meshfront {

// What announces the mesh, or the point set, in float64.
v1::Header HeaderFor(const TriangleMesh& mesh);

// Where the blocks go; false when the stream is broken, which ends the upload.
using BlockWriter = std::function<bool(const v1::DataBlock&)>;
// Every announced array in order, in blocks of at most 1 MiB with their checksums. Returns the end of input with the digest of all
// bytes sent, or nothing when a write failed.
// `region_faces`: ARRAY_REGION_FACES; empty: it was not announced; likewise `features`.
bool UploadArrays(const TriangleMesh& mesh, const std::vector<uint32_t>& region_faces, const Polylines& features,
                  const BlockWriter& write, v1::EndOfInput* end);

}  // namespace meshfront
