#include "client/cli/text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace meshfront {

std::string WithThousands(uint64_t n) {
  const std::string digits = absl::StrCat(n);
  std::string grouped;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) grouped += ',';
    grouped += digits[i];
  }
  return grouped;
}

std::string WithByteUnit(uint64_t bytes) {
  if (bytes < 1000) return absl::StrCat(bytes, " B");
  if (bytes < 1000000) return absl::StrFormat("%.1f KB", bytes / 1e3);
  return bytes < 1000000000 ? absl::StrFormat("%.1f MB", bytes / 1e6) : absl::StrFormat("%.2f GB", bytes / 1e9);
}

std::string PlaceText(const Vec3& p) { return absl::StrFormat("(%g, %g, %g)", p.x, p.y, p.z); }

}  // namespace meshfront
