#include "core/mesh/polylines.h"

#include "absl/strings/str_cat.h"

namespace meshfront {

absl::Status ValidatePolylines(const Polylines& lines) {
  for (size_t i = 0; i < lines.points.size(); ++i) {
    if (!IsFinite(lines.points[i]))
      return absl::InvalidArgumentError(absl::StrCat("options.features.points[", i, "] is not finite"));
  }
  for (size_t i = 0; i < lines.segments.size(); ++i) {
    for (const uint32_t point : lines.segments[i]) {
      if (point < lines.points.size()) continue;
      return absl::InvalidArgumentError(
          absl::StrCat("options.features.segments[", i, "] names point ", point, "; there are ", lines.points.size()));
    }
  }
  return absl::OkStatus();
}

}  // namespace meshfront
