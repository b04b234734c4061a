// STL, ascii and binary, welded.
#pragma once

#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {

// Whether the size fits a binary file's count, or the text begins with "solid" and goes on like an ascii file.
bool IsStl(const Source& source);
// The size decides whether a file is binary, not the word "solid". A binary file may hold more triangles than its header
// says (warning), never fewer. Normals and colours in the attribute bytes are not read.
absl::StatusOr<ReadResult> ReadStl(const Source& source);
// Binary, 32-bit floats, normals from the triangles. InvalidArgument for a point set and for coordinates beyond a float.
absl::Status WriteStl(const TriangleMesh& mesh, Output& output);

}  // namespace meshfront
