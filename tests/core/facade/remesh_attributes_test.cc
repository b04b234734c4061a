// What must hold of attributes: each corner of the output has the values of the input there, on its side of every seam.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/textured.h"

namespace meshfront::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::ValuesIn;

using Map = std::array<double, 2> (*)(const Vec3& place, const Vec3& centroid);

struct TexturedShape {
  std::string name;
  TriangleMesh (*make)();
  Map map;
};
void PrintTo(const TexturedShape& shape, std::ostream* out) { *out << shape.name; }

std::array<double, 2> CapsApart(const Vec3& p, const Vec3& c) {
  if (std::abs(c.z) > 0.999) return {p.x + 3, p.y};
  return AroundZ(p, c);
}

// A chart for each side of the cube around the place.
std::array<double, 2> SixSides(const Vec3& p, const Vec3& c) {
  const Vec3 size{std::abs(c.x), std::abs(c.y), std::abs(c.z)};
  const int axis = size.x > std::max(size.y, size.z) ? 0 : size.y > size.z ? 1 : 2;
  return {p[(axis + 1) % 3] + 3 * (2 * axis + (c[axis] > 0)), p[(axis + 2) % 3]};
}

// Both halves have the same texture, which is the same on their border.
std::array<double, 2> Mirrored(const Vec3& p, const Vec3&) { return {std::abs(p.x), p.z}; }

std::vector<TexturedShape> Shapes() {
  return {
      {"OpenCylinder", [] { return OpenCylinder(1, 3, 64, 24); }, AroundZ},
      {"CappedCylinder", [] { return CappedCylinder(1, 2, 64, 16); }, CapsApart},
      {"Sphere", [] { return UvSphere(64, 32); }, AroundZ},
      {"Torus", [] { return Torus(1, 0.4, 64, 32); }, AroundZ},
      {"SixSides", [] { return Mapped(Cube(16), [](const Vec3& p) { return Normalized(p); }); }, SixSides},
      {"Mirrored", [] { return Icosphere(4); }, Mirrored},
  };
}

struct Outcome {
  TriangleMesh mesh;
  Report report;
};

Outcome RemeshOrFail(const TriangleMesh& input, const RemeshOptions& options) {
  CheckingSink sink;
  absl::StatusOr<Report> report = Remesh({input, options}, sink, Context());
  EXPECT_THAT(report, IsOk());
  if (!report.ok()) return {};
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  Outcome outcome{sink.mesh(), *std::move(report)};
  outcome.mesh.attributes.channels = input.attributes.channels;
  EXPECT_THAT(ValidateAttributes(outcome.mesh.attributes, outcome.mesh.triangles.size()), IsOk());
  return outcome;
}

class TexturedShapes : public ::testing::TestWithParam<TexturedShape> {};

Vec3 CentroidOf(const TriangleMesh& mesh, const Triangle& t) {
  return (mesh.PositionAt(t[0]) + mesh.PositionAt(t[1]) + mesh.PositionAt(t[2])) / 3.0;
}

TEST_P(TexturedShapes, AreMeshedAsWithoutTheirSeams) {
  const TriangleMesh bare = GetParam().make();
  const auto [mesh, report] = RemeshOrFail(Textured(bare, GetParam().map), {.rho = 0.5});
  const auto [plain, plain_report] = RemeshOrFail(bare, {.rho = 0.5});
  EXPECT_TRUE(report.complete);
  EXPECT_TRUE(report.output.manifold);
  EXPECT_EQ(report.output.closed, plain_report.output.closed);
  EXPECT_EQ(report.output.genus, plain_report.output.genus);
  EXPECT_EQ(report.output.boundary_loops, plain_report.output.boundary_loops);
  EXPECT_GT(report.quality.radius_ratio_min, 0.2);
  EXPECT_LT(report.output.triangles, 2 * plain_report.output.triangles);
}

// Of the poles of a globe nothing is asked: all of its meridians meet there.
TEST_P(TexturedShapes, HaveTheTextureOfTheInputOnTheirSideOfEverySeam) {
  const auto [mesh, report] = RemeshOrFail(Textured(GetParam().make(), GetParam().map), {.rho = 0.4});
  double largest = 0;
  Vec3 where;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Vec3 centroid = CentroidOf(mesh, mesh.triangles[f]);
    if (std::hypot(centroid.x, centroid.y) < 0.3 && GetParam().map == AroundZ) continue;
    for (int i = 0; i < 3; ++i) {
      const Vec3& place = mesh.PositionAt(mesh.triangles[f][i]);
      const auto [u, v] = GetParam().map(place, centroid);
      const absl::Span<const float> values = mesh.attributes.WedgeAt(mesh.attributes.corners[f][i]);
      const double off = std::max(std::abs(values[0] - u), std::abs(values[1] - v));
      if (off > largest) largest = off, where = place;
    }
  }
  EXPECT_LT(largest, 0.02) << where.x << " " << where.y << " " << where.z;
}

INSTANTIATE_TEST_SUITE_P(All, TexturedShapes, ValuesIn(Shapes()), [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace meshfront::testing
