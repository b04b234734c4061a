#include "client/cli/feature_lines.h"

#include <cmath>
#include <fstream>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/status_macros.h"

namespace meshfront {
namespace {

using Words = std::vector<absl::string_view>;

// Coordinates; what follows them, as a weight, says nothing of the place.
bool AppendPoint(const Words& words, Polylines& lines) {
  double xyz[3];
  if (words.size() < 4) return false;
  for (int i = 0; i < 3; ++i) {
    if (!absl::SimpleAtod(words[i + 1], &xyz[i]) || !std::isfinite(xyz[i])) return false;
  }
  lines.points.push_back({xyz[0], xyz[1], xyz[2]});
  return true;
}

// Points are counted from 1, or from the last one backwards.
bool AppendLine(const Words& words, uint64_t number, FeatureLines& features) {
  std::vector<uint32_t> points;
  const auto count = static_cast<int64_t>(features.lines.points.size());
  for (size_t i = 1; i < words.size(); ++i) {
    int64_t point;
    const absl::string_view digits = words[i].substr(0, words[i].find('/'));
    if (!absl::SimpleAtoi(digits, &point)) return false;
    if (point < 0) point += count + 1;
    if (point < 1 || point > count) return false;
    points.push_back(static_cast<uint32_t>(point - 1));
  }
  for (size_t i = 1; i < points.size(); ++i) {
    features.lines.segments.push_back({points[i - 1], points[i]});
    features.numbers.push_back(number);
  }
  return points.size() > 1;
}

}  // namespace

absl::StatusOr<FeatureLines> ReadFeatureLines(const std::optional<std::string>& path) {
  FeatureLines features;
  if (!path) return features;
  std::ifstream file(*path);
  if (!file)
    return absl::InvalidArgumentError(absl::StrCat("--features names the file ", *path, ", which can't be read"));
  std::string line;
  for (uint64_t number = 1; std::getline(file, line); ++number) {
    const Words words = absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty() || (words[0] != "v" && words[0] != "l")) continue;
    if (words[0] == "v" ? AppendPoint(words, features.lines) : AppendLine(words, number, features)) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(*path, " has \"", line.substr(0, 40), "\" in line ", number, "; it must be ",
                     words[0] == "v" ? "three finite coordinates" : "two or more numbers of points before it"));
  }
  if (!features.lines.segments.empty()) return features;
  return absl::InvalidArgumentError(absl::StrCat(*path, " has no line (l); --features needs at least one"));
}

absl::Status WithFeatureLine(const absl::Status& status, const std::string& path, const FeatureLines& features) {
  absl::string_view text = status.message();
  uint64_t segment;
  if (!absl::ConsumePrefix(&text, "options.features.segments[") ||
      !absl::SimpleAtoi(text.substr(0, text.find(']')), &segment) || segment >= features.numbers.size())
    return status;
  absl::Status told(status.code(),  // which begins with the path of the field
                    absl::StrCat(status.message(), " (line ", features.numbers[segment], " of ", path, ")"));
  status.ForEachPayload([&](absl::string_view url, const absl::Cord& payload) { told.SetPayload(url, payload); });
  return told;
}

}  // namespace meshfront
