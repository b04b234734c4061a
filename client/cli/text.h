// Numbers as people read them.
#pragma once

#include <cstdint>
#include <string>

#include "core/geometry/vec3.h"

namespace meshfront {

// 1234567 -> "1,234,567".
std::string WithThousands(uint64_t n);
// "1.5 KB", "23.4 MB": decimal units.
std::string WithByteUnit(uint64_t bytes);
// "(0.125, -3, 1e+30)", six digits.
std::string PlaceText(const Vec3& p);

}  // namespace meshfront
