// The polylines of --features.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/mesh/polylines.h"

namespace meshfront {

struct FeatureLines {
  Polylines lines;
  std::vector<uint64_t> numbers;  // of each segment, the line of the file that it is from
};

// Points (`v`) and lines (`l`, as "1 2 3" or "1/1 2/2") of an OBJ; what else it holds is not looked at. Empty without a path.
// InvalidArgument with the file and the line: it can't be read, a number is none, a point is not there; or there is no line.
absl::StatusOr<FeatureLines> ReadFeatureLines(const std::optional<std::string>& path);

// An error about a segment that was sent, with the line of the file that it is from.
absl::Status WithFeatureLine(const absl::Status& status, const std::string& path, const FeatureLines& features);

}  // namespace meshfront
