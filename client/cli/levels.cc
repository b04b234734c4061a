#include "client/cli/levels.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace meshfront {

std::string LevelPath(const std::string& out, size_t level) {
  const size_t slash = out.rfind('/'), begin = slash == std::string::npos ? 0 : slash + 1;
  const size_t end = absl::EndsWithIgnoreCase(out, ".gz") ? out.size() - 3 : out.size();
  size_t dot = end > begin ? out.rfind('.', end - 1) : std::string::npos;
  if (dot == std::string::npos || dot <= begin) dot = end;
  return absl::StrCat(out.substr(0, dot), ".lod", level, out.substr(dot));
}

std::vector<double> ScreenCoverages(const std::vector<v1::Summary>& levels) {
  constexpr double pixel = 1e-3, most = 0.5, step = 0.5;
  std::vector<double> coverages;
  double last = most / step;
  for (size_t level = 0; level + 1 < levels.size(); ++level) {
    const double bound = levels[level + 1].error_bound();
    last = std::min(step * last, bound > 0 ? pixel * levels[level].input().diagonal() / bound : most);
    coverages.push_back(last);
  }
  coverages.push_back(0);
  return coverages;
}

}  // namespace meshfront
