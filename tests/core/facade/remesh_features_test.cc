// Lines that a caller wants: the output has them as edges, from end to end.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/geometry/segment.h"
#include "core/mesh/adjacency.h"
#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/polylines.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

struct Result {
  TriangleMesh mesh;
  absl::StatusOr<Report> report;
};

Result RemeshWith(const TriangleMesh& mesh, const Polylines& lines, double rho,
                  const std::optional<Region>& region = std::nullopt) {
  CheckingSink sink;
  Problem problem{mesh, {}, region, nullptr, lines};
  problem.options.rho = rho;
  absl::StatusOr<Report> report = Remesh(std::move(problem), sink, {});
  sink.CheckEnd();
  EXPECT_TRUE(sink.complaints().empty()) << sink.complaints().front();
  return {sink.mesh(), std::move(report)};
}

double NearestVertex(const TriangleMesh& mesh, const Vec3& p) {
  double least = 1e9;
  for (const Vec3& q : mesh.positions) least = std::min(least, Distance(p, q));
  return least;
}

// How far the nearest edge of the mesh passes by the place, for edges that run along `direction` within 20 degrees.
double NearestEdgeAlong(const TriangleMesh& mesh, const Vec3& p, const Vec3& direction) {
  double least = 1e9;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const Vec3 &a = mesh.PositionAt(t[i]), &b = mesh.PositionAt(t[(i + 1) % 3]);
      if (std::abs(Dot(Normalized(b - a), direction)) > 0.94) least = std::min(least, DistanceToSegment(p, a, b));
    }
  }
  return least;
}

// A slit in each of two faces of a cube that are flat, one with a bend; both ends lie inside a face.
TEST(RemeshFeatures, KeepLinesThatEndInAFlatFace) {
  const Vec3 a{-0.61, -0.43, 1}, b{0.13, 0.37, 1}, c{0.52, -0.31, 1};
  const auto [mesh, report] = RemeshWith(Cube(3), Line({a, b, c}), 0.8);
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(report->complete);
  EXPECT_THAT(mesh, IsClosedManifold());
  EXPECT_THAT(mesh, HasGenus(0));
  const double close = 1e-6 * report->input.diagonal;
  for (const Vec3& p : {a, b, c}) EXPECT_LE(NearestVertex(mesh, p), close);
  for (int i = 1; i < 40; ++i) {
    const double t = i / 40.0;
    EXPECT_LE(NearestEdgeAlong(mesh, (1 - t) * a + t * b, Normalized(b - a)), 1e-3);
    EXPECT_LE(NearestEdgeAlong(mesh, (1 - t) * b + t * c, Normalized(c - b)), 1e-3);
  }
  EXPECT_EQ(report->parameters.feature_segments, 2u);
  ASSERT_FALSE(report->input.repairs.empty());
  EXPECT_EQ(report->input.repairs.back().what, "split_faces_along_features");
}

// A closed line and an arc on a ball: within the error bound.
TEST(RemeshFeatures, FollowCurvesOnARoundSurface) {
  Polylines lines;
  const int n = 40;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    lines.points.push_back({0.8 * std::cos(angle), 0.8 * std::sin(angle), 0.6});
    lines.segments.push_back({static_cast<uint32_t>(i), static_cast<uint32_t>((i + 1) % n)});
  }
  for (int i = 0; i <= 10; ++i) {
    lines.points.push_back({std::cos(0.1 * i), std::sin(0.1 * i), 0});
    if (i > 0) lines.segments.push_back({static_cast<uint32_t>(n + i - 1), static_cast<uint32_t>(n + i)});
  }
  const auto [mesh, report] = RemeshWith(Icosphere(4), lines, 0.7);
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(report->complete);
  EXPECT_THAT(mesh, IsClosedManifold());
  for (int i = 0; i < 200; ++i) {
    const double angle = 2 * std::numbers::pi * i / 200;
    const Vec3 p{0.8 * std::cos(angle), 0.8 * std::sin(angle), 0.6}, along{-std::sin(angle), std::cos(angle), 0};
    EXPECT_LE(NearestEdgeAlong(mesh, p, along), report->error_bound) << i;
  }
  EXPECT_LE(NearestVertex(mesh, {1, 0, 0}), 1e-6 * report->input.diagonal);
}

TEST(RemeshFeatures, ArePartOfTheSurfaceAtAnyScale) {
  const Polylines lines = Line({{-0.6, -0.4, 1}, {0.5, 0.3, 1}});
  Polylines large = lines;
  for (Vec3& p : large.points) p = std::ldexp(1.0, 200) * p;
  const auto [mesh, report] = RemeshWith(Cube(3), lines, 1);
  const auto [other, of_large] = RemeshWith(Scaled(Cube(3), std::ldexp(1.0, 200)), large, 1);
  ASSERT_THAT(of_large, IsOk());
  EXPECT_TRUE(mesh.triangles == other.triangles);
}

// One line crosses the region and goes on on both sides, one lies in it, one does not: what lies in it is kept, up to a face from the
// border, the rest of the mesh has its bits, and the others are named.
TEST(RemeshFeatures, AreInForceInsideOfARegion) {
  const TriangleMesh ball = Icosphere(5);
  const auto arc = [](double height, double from, double to) {
    std::vector<Vec3> points;
    const double radius = std::sqrt(1 - height * height);
    for (int i = 0; i <= 20; ++i) {
      const double angle = from + (to - from) * i / 20;
      points.push_back({radius * std::cos(angle), radius * std::sin(angle), height});
    }
    return Line(points);
  };
  Polylines lines = arc(0.03, -1.3, 1.3);
  for (const Polylines& more : {arc(0.23, -0.2, 0.2), arc(0.1, 2, 2.5)}) {
    const auto first = static_cast<uint32_t>(lines.points.size());
    lines.points.insert(lines.points.end(), more.points.begin(), more.points.end());
    for (const auto& [a, b] : more.segments) lines.segments.push_back({a + first, b + first});
  }
  const auto [mesh, report] = RemeshWith(ball, lines, 0.3, Region{RegionSphere{{1, 0, 0}, 0.8}});
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(report->complete);
  EXPECT_THAT(mesh, IsClosedManifold());
  EXPECT_EQ(report->region->kept_triangles + report->region->replaced_triangles, ball.triangles.size());
  const auto worst = [&mesh = mesh](double height, double reach) {
    double most = 0;
    for (int i = -100; i <= 100; ++i) {
      const double angle = reach * i / 100, radius = std::sqrt(1 - height * height);
      const Vec3 p{radius * std::cos(angle), radius * std::sin(angle), height};
      most = std::max(most, NearestEdgeAlong(mesh, p, {-std::sin(angle), std::cos(angle), 0}));
    }
    return most;
  };
  EXPECT_LE(worst(0.03, 0.65), report->error_bound);
  EXPECT_LE(worst(0.23, 0.2), report->error_bound);
  EXPECT_GT(worst(0.03, 1.1), 4 * report->error_bound) << "not in force outside";
  ASSERT_EQ(report->warnings.size(), 1u);
  EXPECT_THAT(report->warnings.front(),
              ::testing::HasSubstr("segments of options.features lie, wholly or in part, outside"));
  EXPECT_LT(report->parameters.feature_segments, 40u);
  EXPECT_GT(report->parameters.feature_segments, 25u);
}

TEST(RemeshFeatures, AreRefusedWhereThereIsNoPlaceForThem) {
  const Polylines off = Line({{-0.6, -0.4, 1}, {0.5, 0.3, 1.2}});
  CollectingSink sink;
  EXPECT_THAT(Remesh({Cube(3), {}, std::nullopt, nullptr, off}, sink, {}),
              StatusIs(absl::StatusCode::kInvalidArgument, "options.features.segments[0] lies at 0.5, 0.3, 1.2"));
  Problem sampled{Cube(3), {}, std::nullopt, nullptr, off};
  sampled.options.surface = SurfaceKind::kImls;
  EXPECT_THAT(Remesh(std::move(sampled), sink, {}),
              StatusIs(absl::StatusCode::kInvalidArgument, "leave options.surface out to keep lines"));
  Problem apart{Sampled(Icosphere(3), 6), {}, std::nullopt, nullptr, off};  // no surface
  EXPECT_FALSE(Remesh(std::move(apart), sink, {}).ok());
}

// A closed line around a ball and one that ends inside of its face, both a little off the points.
TEST(RemeshFeatures, AreKeptOnPoints) {
  const int n = 60;
  Polylines lines;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    lines.points.push_back({0.802 * std::cos(angle), 0.802 * std::sin(angle), 0.6});
    lines.segments.push_back({static_cast<uint32_t>(i), static_cast<uint32_t>((i + 1) % n)});
  }
  for (int i = 0; i <= 10; ++i) {
    lines.points.push_back({std::cos(0.1 * i), std::sin(0.1 * i), 0});
    if (i > 0) lines.segments.push_back({static_cast<uint32_t>(n + i - 1), static_cast<uint32_t>(n + i)});
  }
  for (const bool with_creases : {true, false}) {
    CheckingSink sink;
    Problem problem{Sampled(Icosphere(5), 8000), {}, std::nullopt, nullptr, lines};
    if (!with_creases) problem.options.crease_angle = std::nullopt;
    const absl::StatusOr<Report> report = Remesh(std::move(problem), sink, {});
    ASSERT_THAT(report, IsOk());
    EXPECT_TRUE(report->complete && report->input.is_point_set);
    EXPECT_EQ(report->parameters.feature_segments, lines.segments.size());
    EXPECT_THAT(report->warnings, ::testing::Contains(::testing::HasSubstr("lines are to be kept on the point set")));
    EXPECT_THAT(sink.mesh(), IsClosedManifold());
    EXPECT_THAT(sink.mesh(), HasGenus(0));
    const double close = report->error_bound + 0.005;  // how far the lines are off
    for (int i = 0; i < 100; ++i) {
      const double around = 2 * std::numbers::pi * i / 100, along = 0.01 * i;
      EXPECT_LE(NearestEdgeAlong(sink.mesh(), {0.8 * std::cos(around), 0.8 * std::sin(around), 0.6},
                                 {-std::sin(around), std::cos(around), 0}),
                close);
      EXPECT_LE(
          NearestEdgeAlong(sink.mesh(), {std::cos(along), std::sin(along), 0}, {-std::sin(along), std::cos(along), 0}),
          close);
    }
  }
}

// A cube has its edges as well.
TEST(RemeshFeatures, AreKeptBesideTheEdgesOfPoints) {
  const Vec3 a{-0.5, -0.4, 1}, b{0.6, 0.3, 1};
  CheckingSink sink;
  const absl::StatusOr<Report> report =
      Remesh({Sampled(Cube(3), 12000), {}, std::nullopt, nullptr, Line({a, b})}, sink, {});
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(report->complete);
  EXPECT_THAT(report->warnings, ::testing::Contains(::testing::HasSubstr("creases were found on the point set")));
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  for (const Vec3& p : {a, b}) EXPECT_LE(NearestVertex(sink.mesh(), p), 0.01);
  for (int i = 1; i < 40; ++i)
    EXPECT_LE(NearestEdgeAlong(sink.mesh(), a + i / 40.0 * (b - a), Normalized(b - a)), 0.01);
  EXPECT_LE(NearestVertex(sink.mesh(), {1, 1, 1}), 0.03);
}

// Sides that have one face.
std::vector<std::array<Vec3, 2>> RimOf(const TriangleMesh& mesh) {
  const FaceAdjacency adjacency = CreateAdjacency(mesh);
  std::vector<std::array<Vec3, 2>> rim;
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    if (adjacency.OppositeOf(h) == kNoHalfEdge)
      rim.push_back({mesh.PositionAt(OriginOf(mesh, h)), mesh.PositionAt(TargetOf(mesh, h))});
  }
  return rim;
}

double FarthestEnd(const std::vector<std::array<Vec3, 2>>& from, const std::vector<std::array<Vec3, 2>>& to) {
  double farthest = 0;
  for (const auto& side : from) {
    double nearest = 1e9;
    for (const auto& other : to) nearest = std::min(nearest, DistanceToSegment(side[0], other[0], other[1]));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

// The ends of a narrow ribbon were pointed: its corners lie closer together than an edge is long.
TEST(RemeshRims, KeepTheCornersOfARibbon) {
  const TriangleMesh ribbon = Mapped(Sheet(8), [](const Vec3& p) { return Vec3{p.x, 0.04 * p.y, 0}; });
  const auto [result, report] = RemeshWith(ribbon, {}, 0.5);
  ASSERT_THAT(report, IsOk());
  for (const double x : {-1, 1}) {
    for (const double y : {-0.04, 0.04}) EXPECT_LE(NearestVertex(result, {x, y, 0}), 1e-9) << x << " " << y;
  }
}

// Holes of six faces each, which a triangle of the edges that are wanted would fit, are farther from that than surfaces may be.
TEST(RemeshRims, KeepTheErrorBoundBothWays) {
  TriangleMesh mesh = Icosphere(4);
  std::erase_if(mesh.triangles, [](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), [](VertexId v) { return v.index() % 43 == 7; });
  });
  for (const double rho : {0.3, 0.5}) {
    const auto [result, report] = RemeshWith(mesh, {}, rho);
    ASSERT_THAT(report, IsOk());
    EXPECT_EQ(report->output.boundary_loops, report->input.topology.boundary_loops);
    EXPECT_GT(report->output.boundary_loops, 20u);
    EXPECT_LE(FarthestEnd(RimOf(mesh), RimOf(result)), report->error_bound);
    EXPECT_LE(FarthestEnd(RimOf(result), RimOf(mesh)), report->error_bound);
  }
}

}  // namespace
}  // namespace meshfront::testing
