// The table of formats: what each is called, how it is recognised, who reads and who writes it. A new format is one pair of
// files and one row here.
#pragma once

#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/io/mesh_io.h"
#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {

struct FormatRow {
  Format format;
  std::string_view name;
  std::vector<std::string_view> endings;  // lower case, without the dot
  // Whether the content can be nothing else (a magic word); null where text has no mark.
  bool (*is_surely)(const Source& source);
  absl::StatusOr<ReadResult> (*read)(const Source& source);
  absl::Status (*write)(const TriangleMesh& mesh, Output& output);
};

// In the order in which contents are recognised.
const std::vector<FormatRow>& FormatTable();
// Null for kUnknown.
const FormatRow* FindFormat(Format format);

}  // namespace meshfront
