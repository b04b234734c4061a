// What must hold of attributes: each corner of the output has the values of the input there, on its side of every seam.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/prepared_input.h"
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

Outcome RemeshOrFail(const TriangleMesh& input, const RemeshOptions& options,
                     const std::optional<Region>& region = std::nullopt) {
  CheckingSink sink;
  absl::StatusOr<Report> report = Remesh({input, options, region}, sink, Context());
  EXPECT_THAT(report, IsOk());
  if (!report.ok()) return {};
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  Outcome outcome{sink.mesh(), *std::move(report)};
  if (options.attributes) outcome.mesh.attributes.channels = input.attributes.channels;
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
  EXPECT_LT(largest, 0.025) << where.x << " " << where.y << " " << where.z;
}

// A face with what its corners carry, wherever its corners begin.
using FaceBits = std::vector<std::vector<double>>;
FaceBits BitsOf(const TriangleMesh& mesh, size_t face) {
  FaceBits bits;
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = mesh.PositionAt(mesh.triangles[face][i]);
    std::vector<double>& corner = bits.emplace_back(std::vector<double>{p.x, p.y, p.z});
    if (mesh.attributes.channels.empty()) continue;
    for (const float value : mesh.attributes.WedgeAt(mesh.attributes.corners[face][i])) corner.push_back(value);
  }
  std::rotate(bits.begin(), std::min_element(bits.begin(), bits.end()), bits.end());
  bits.push_back({static_cast<double>(mesh.attributes.GroupOf(face))});
  return bits;
}

bool IsInside(const RegionSphere& sphere, const TriangleMesh& mesh, const Triangle& t) {
  return std::all_of(t.begin(), t.end(),
                     [&](VertexId v) { return Distance(mesh.PositionAt(v), sphere.center) <= sphere.radius; });
}

// Faces outside of the region that are not in the result with all their bits.
size_t CountMissing(const TriangleMesh& input, const RegionSphere& sphere, const TriangleMesh& result) {
  std::multiset<FaceBits> left;
  for (size_t f = 0; f < result.triangles.size(); ++f) left.insert(BitsOf(result, f));
  size_t missing = 0;
  for (size_t f = 0; f < input.triangles.size(); ++f) {
    if (IsInside(sphere, input, input.triangles[f])) continue;
    const auto found = left.find(BitsOf(input, f));
    if (found == left.end())
      ++missing;
    else
      left.erase(found);
  }
  return missing;
}

// Regions on seams, beside them and on both sides of a corner: their border crosses seams, or runs along them.
TEST_P(TexturedShapes, KeepTheRestOfARegionWithItsBitsAndInterpolateInside) {
  const TriangleMesh input = Textured(GetParam().make(), GetParam().map);
  for (const Vec3& toward : {Vec3{-1, 0.05, 0.1}, Vec3{1, 0.3, 0.2}, Vec3{0.5, 0.6, 0.9}}) {
    const auto farthest =
        std::max_element(input.positions.begin(), input.positions.end(),
                         [&](const Vec3& a, const Vec3& b) { return Dot(a, toward) < Dot(b, toward); });
    const RegionSphere sphere{*farthest, 0.5};
    const auto [mesh, report] = RemeshOrFail(input, {.rho = 0.3}, Region{sphere});
    SCOPED_TRACE(std::to_string(toward.x));
    EXPECT_EQ(CountMissing(input, sphere, mesh), 0u);
    EXPECT_TRUE(report.complete);
    EXPECT_TRUE(report.output.manifold);
    double largest = 0;
    for (size_t f = report.region->kept_triangles; f < mesh.triangles.size(); ++f) {
      const Vec3 centroid = CentroidOf(mesh, mesh.triangles[f]);
      if (std::hypot(centroid.x, centroid.y) < 0.3 && GetParam().map == AroundZ) continue;
      for (int i = 0; i < 3; ++i) {
        const auto [u, v] = GetParam().map(mesh.PositionAt(mesh.triangles[f][i]), centroid);
        const absl::Span<const float> values = mesh.attributes.WedgeAt(mesh.attributes.corners[f][i]);
        largest = std::max({largest, std::abs(values[0] - u), std::abs(values[1] - v)});
      }
    }
    EXPECT_LT(largest, 0.02);
  }
}

// What a target adds is torn apart at −x, where the texture has its seam: each side keeps its own, inside of the region and outside.
TEST(Region, InterpolatesMorphTargetsOnBothSidesOfATear) {
  const auto moved = [](const Vec3& p, const Vec3& c) {
    return std::vector<float>{static_cast<float>(p.z), static_cast<float>(2 * AroundZ(p, c)[0]), 0};
  };
  const TriangleMesh input = WithChannel(Torus(1, 0.4, 64, 32), "MORPH_0_POSITION", 3, moved);
  const RegionSphere sphere{{-1.4, 0.05, 0.1}, 0.5};
  for (const bool whole : {true, false}) {
    const auto [mesh, report] = RemeshOrFail(input, {.rho = 0.3}, whole ? std::nullopt : std::optional(Region{sphere}));
    if (!whole) {
      EXPECT_EQ(CountMissing(input, sphere, mesh), 0u);
    }
    EXPECT_TRUE(report.output.closed);
    double largest = 0;
    for (size_t f = 0; f < mesh.triangles.size(); ++f) {
      for (int i = 0; i < 3; ++i) {
        const std::vector<float> wanted =
            moved(mesh.PositionAt(mesh.triangles[f][i]), CentroidOf(mesh, mesh.triangles[f]));
        const absl::Span<const float> values = mesh.attributes.WedgeAt(mesh.attributes.corners[f][i]);
        for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(double{values[axis]} - wanted[axis]));
      }
    }
    EXPECT_LT(largest, 0.02) << whole;
  }
}

// Where no seam is, the border's vertices have one wedge on both sides of it.
TEST(Region, SharesTheWedgesOfItsBorder) {
  const TriangleMesh input = Textured(Icosphere(4), [](const Vec3& p, const Vec3&) { return std::array{p.x, p.y}; });
  const auto [mesh, report] = RemeshOrFail(input, {.rho = 0.3}, Region{RegionSphere{{0, 0, 1}, 0.6}});
  EXPECT_EQ(mesh.attributes.wedge_count(), mesh.positions.size());
  EXPECT_GT(report.region->new_triangles, 100u);
}

// Two materials that meet inside of the region: no new triangle lies on both sides.
TEST(Region, KeepsTheBorderOfMaterials) {
  TriangleMesh input = Cube(16);
  for (const Triangle& t : input.triangles) input.attributes.groups.push_back(CentroidOf(input, t).x > 0 ? 7 : 2);
  const RegionSphere sphere{{0, 0, 1}, 0.7};
  const auto [mesh, report] = RemeshOrFail(input, {.rho = 0.3}, Region{sphere});
  EXPECT_EQ(CountMissing(input, sphere, mesh), 0u);
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const VertexId v : mesh.triangles[f])
      EXPECT_TRUE(mesh.attributes.GroupOf(f) == 7 ? mesh.PositionAt(v).x > -1e-9 : mesh.PositionAt(v).x < 1e-9) << f;
  }
}

// Also where the mesh was prepared before, and whether attributes are wanted or not.
TEST(Region, KeepsTheAttributesOfAPreparedInput) {
  const TriangleMesh input = Textured(Torus(1, 0.4, 64, 32), AroundZ);
  const auto prepared = PreparedInput::Create(input, true, Context());
  ASSERT_THAT(prepared, IsOk());
  for (const bool attributes : {true, false}) {
    const RemeshOptions options{.rho = 0.3, .attributes = attributes};
    const Region region{RegionSphere{{-1.4, 0, 0}, 0.5}};
    const Outcome alone = RemeshOrFail(input, options, region);
    CollectingSink again;
    ASSERT_THAT(Remesh({{}, options, region, *prepared}, again, Context()), IsOk());
    EXPECT_EQ(again.mesh.positions, alone.mesh.positions);
    EXPECT_EQ(again.mesh.attributes.values, alone.mesh.attributes.values);
    EXPECT_EQ(again.mesh.attributes.corners, alone.mesh.attributes.corners);
    EXPECT_EQ(again.mesh.attributes.corners.empty(), !attributes);
  }
}

TEST(Region, HandsOnAPatchWithItsAttributesOrWithout) {
  const TriangleMesh input = Textured(Torus(1, 0.4, 64, 32), AroundZ);
  Region region{RegionSphere{{1.4, 0, 0}, 0.5}, true};
  const auto [patch, report] = RemeshOrFail(input, {.rho = 0.3}, region);
  EXPECT_EQ(patch.attributes.corners.size(), patch.triangles.size());
  const auto [bare, bare_report] = RemeshOrFail(input, {.rho = 0.3, .attributes = false}, region);
  EXPECT_TRUE(bare.attributes.empty());
  EXPECT_THAT(report.warnings, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(All, TexturedShapes, ValuesIn(Shapes()), [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace meshfront::testing
