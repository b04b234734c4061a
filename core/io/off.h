// OFF as Geomview and its heirs write it.
#pragma once

#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {

// Whether the first word is OFF, perhaps with prefixes (ST, C, N, 4, n).
bool IsOff(const Source& source);
// [ST][C][N]OFF, text. Counts may stand on the first line and the number of edges may be missing; the word OFF too. Comments,
// colours of faces and vertices, faces of any number of corners (fewer than three: skipped with a warning). Refused: nOFF, 4OFF,
// OFF BINARY.
absl::StatusOr<ReadResult> ReadOff(const Source& source);
absl::Status WriteOff(const TriangleMesh& mesh, Output& output);

}  // namespace meshfront
