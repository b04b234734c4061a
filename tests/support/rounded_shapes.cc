#include "tests/support/rounded_shapes.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "tests/support/shapes.h"

namespace meshfront::testing {

TriangleMesh AsWritten(TriangleMesh mesh, const char* format) {
  const auto written = [&](double x) {
    char text[64];
    std::snprintf(text, sizeof(text), format, x);
    return std::strtod(text, nullptr);
  };
  return Mapped(std::move(mesh), [&](const Vec3& p) { return Vec3{written(p.x), written(p.y), written(p.z)}; });
}

TriangleMesh AsFloats(TriangleMesh mesh) {
  const auto rounded = [](double x) {
    const volatile float nearest = static_cast<float>(x);  // g++ 12 takes the way there and back for nothing else
    return static_cast<double>(nearest);
  };
  return Mapped(std::move(mesh), [&](const Vec3& p) { return Vec3{rounded(p.x), rounded(p.y), rounded(p.z)}; });
}

}  // namespace meshfront::testing
