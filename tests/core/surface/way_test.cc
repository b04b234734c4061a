#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "core/surface/mesh_surface.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/surface/surfaces.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using meshfront::testing::HeightField;
using meshfront::testing::Icosphere;
using meshfront::testing::Sheet;
using meshfront::testing::SurfaceOf;
using meshfront::testing::Torus;
using meshfront::testing::WithNoise;
using ::testing::IsEmpty;

// From one end to the other without a gap, each piece in its face, each face next to the last. Empty: it is.
std::string FaultOf(const MeshSurface& surface, const SourcePoint& a, const SourcePoint& b,
                    const std::vector<WayPiece>& way) {
  if (way.empty()) return "empty";
  if (way.front().from != a.position || way.back().to != b.position) return "does not lead from end to end";
  for (size_t i = 0; i < way.size(); ++i) {
    if (i > 0 && way[i].from != way[i - 1].to) return "has a gap";
    for (const Vec3& p : {way[i].from, way[i].to}) {
      const TriangleMesh& mesh = surface.mesh();
      const SourcePoint at = surface.Snap(surface.AtFace(FaceId(way[i].patch), 0.3, 0.3), p);
      if (Distance(at.position, p) > 1e-9 * BoundingBox(mesh).Diagonal()) return "leaves the surface";
    }
  }
  return "";
}

double LengthOf(const std::vector<WayPiece>& way) {
  double length = 0;
  for (const WayPiece& piece : way) length += Distance(piece.from, piece.to);
  return length;
}

// The point of a height field at a place of its map.
SourcePoint UnderPlace(const MeshSurface& surface, double x, double y) {
  for (uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    const Triangle& t = surface.mesh().triangles[f];
    const Vec3 &a = surface.mesh().PositionAt(t[0]), e = surface.mesh().PositionAt(t[1]) - a,
               g = surface.mesh().PositionAt(t[2]) - a;
    const double det = e.x * g.y - e.y * g.x;
    const double u = ((x - a.x) * g.y - (y - a.y) * g.x) / det, v = (e.x * (y - a.y) - e.y * (x - a.x)) / det;
    if (u >= 0 && v >= 0 && u + v <= 1) return surface.AtFace(FaceId(f), u, v);
  }
  ADD_FAILURE() << x << ", " << y << " is not on the map";
  return {};
}

TEST(TraceWay, IsStraightOnAPlane) {
  const auto surface = SurfaceOf(Sheet(10));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 0.5);
  std::vector<WayPiece> way;
  for (int i = 0; i < 300; ++i) {
    const auto place = [&] {
      return surface->AtFace(FaceId(static_cast<uint32_t>(random() % surface->mesh().triangles.size())), unit(random),
                             unit(random));
    };
    const SourcePoint a = place(), b = place();
    ASSERT_TRUE(surface->TraceWay(a, b, way)) << i;
    ASSERT_EQ(FaultOf(*surface, a, b, way), "") << i;
    EXPECT_NEAR(LengthOf(way), Distance(a.position, b.position), 1e-12);
  }
}

TEST(TraceWay, LeadsFromVertexToVertex) {
  const auto surface = SurfaceOf(Sheet(6));
  std::vector<WayPiece> way;
  for (uint32_t i = 0; i < surface->mesh().positions.size(); ++i) {
    for (uint32_t j = 0; j < i; ++j) {
      const SourcePoint a = surface->AtVertex(VertexId(i)), b = surface->AtVertex(VertexId(j));
      if (surface->IsOnBoundary(a) && surface->IsOnBoundary(b)) continue;  // may run along the rim
      ASSERT_TRUE(surface->TraceWay(a, b, way)) << i << " to " << j;
      ASSERT_EQ(FaultOf(*surface, a, b, way), "") << i << " to " << j;
    }
  }
}

TEST(TraceWay, IsAnArcOnASphere) {
  const auto surface = SurfaceOf(Icosphere(4));
  std::vector<WayPiece> way;
  const SourcePoint a = surface->AtFace(FaceId(100), 0.2, 0.3);
  int traced = 0;
  for (uint32_t f = 0; f < surface->mesh().triangles.size(); f += 7) {
    const SourcePoint b = surface->AtFace(FaceId(f), 0.5, 0.1);
    const double cosine = Dot(Normalized(a.position), Normalized(b.position));
    if (cosine < 0.2) continue;
    ASSERT_TRUE(surface->TraceWay(a, b, way)) << f;
    ASSERT_EQ(FaultOf(*surface, a, b, way), "") << f;
    EXPECT_NEAR(LengthOf(way), std::acos(std::min(cosine, 1.0)), 0.01) << f;
    ++traced;
  }
  EXPECT_GT(traced, 200);
}

// Up one side of a steep roof and down the other.
TEST(TraceWay, ClimbsOverARoof) {
  const auto surface = SurfaceOf(HeightField(20, [](double x, double) { return 3 - 3 * std::abs(x); }));
  const auto at = [&](double x, double y) { return UnderPlace(*surface, x, y); };
  const SourcePoint left = at(-0.33, 0.1), right = at(0.37, 0.13);
  std::vector<WayPiece> way, across, beside;
  ASSERT_TRUE(surface->TraceWay(left, right, way));
  EXPECT_EQ(FaultOf(*surface, left, right, way), "");
  EXPECT_NEAR(LengthOf(way), 0.7 * std::sqrt(10), 0.02);
  ASSERT_TRUE(surface->TraceWay(at(0.16, -0.4), at(0.17, 0.6), across));
  EXPECT_TRUE(WaysCross(way, across)) << "on the far side, far from the chord";
  EXPECT_TRUE(WaysCross(across, way));
  ASSERT_TRUE(surface->TraceWay(at(0.16, 0.2), at(0.17, 0.6), beside));
  EXPECT_FALSE(WaysCross(way, beside));
}

TEST(TraceWay, StopsAtTheRim) {
  const auto surface = SurfaceOf(meshfront::testing::DiskWithHoles(40));
  std::vector<WayPiece> way = {{1, {}, {}}};
  size_t traced = 0, stopped = 0;
  for (uint32_t f = 0; f < surface->mesh().triangles.size(); f += 11) {
    const SourcePoint a = surface->AtFace(FaceId(0), 0.3, 0.3), b = surface->AtFace(FaceId(f), 0.3, 0.3);
    if (surface->TraceWay(a, b, way)) {
      ++traced;
      EXPECT_EQ(FaultOf(*surface, a, b, way), "");
    } else {
      ++stopped;
      EXPECT_THAT(way, IsEmpty());
    }
  }
  EXPECT_GT(traced, 10u);
  EXPECT_GT(stopped, 10u);
}

TEST(TraceWay, StaysOnItsSideOfAThinTube) {
  const auto surface = SurfaceOf(Torus(1, 0.02, 200, 12));
  std::vector<WayPiece> way, other;
  const auto at = [&](double angle, double height) {
    SourcePoint p = surface->AtVertex(VertexId(0));
    for (int i = 0; i <= 60; ++i) p = surface->Snap(p, {std::cos(angle * i / 60), std::sin(angle * i / 60), height});
    return p;
  };
  ASSERT_TRUE(surface->TraceWay(at(0.1, 0.03), at(0.4, 0.03), way));
  ASSERT_TRUE(surface->TraceWay(at(0.2, -0.03), at(0.3, -0.03), other));
  EXPECT_FALSE(WaysCross(way, other));
}

// Where it leads somewhere it leads there from both ends, over the same faces.
TEST(TraceWay, IsTheSameFromBothEndsOnRoughGround) {
  const auto surface = SurfaceOf(WithNoise(Icosphere(4), 0.03, 5));
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0.05, 0.45);
  std::vector<WayPiece> way, back;
  int traced = 0;
  for (uint32_t i = 0; i < 500; ++i) {
    const SourcePoint a = surface->AtFace(FaceId(7 * i % 5120), unit(random), unit(random));
    const Vec3 aside{unit(random) - 0.25, unit(random) - 0.25, unit(random) - 0.25};
    const SourcePoint b = surface->Snap(a, a.position + aside);
    if (!surface->TraceWay(a, b, way) || !surface->TraceWay(b, a, back)) continue;
    ++traced;
    EXPECT_EQ(FaultOf(*surface, a, b, way), "");
    ASSERT_EQ(way.size(), back.size());
    for (size_t k = 0; k < way.size(); ++k) EXPECT_EQ(way[k].patch, back[back.size() - 1 - k].patch);
  }
  EXPECT_GT(traced, 250);
}

TEST(WaysCross, OnlyInsideAPatchThatBothPass) {
  const std::vector<WayPiece> way = {{3, {-1, 0, 0}, {1, 0, 0}}};
  const auto crosses = [&](const WayPiece& other) { return WaysCross(way, {{other}}); };
  EXPECT_TRUE(crosses({3, {0.2, -1, 0}, {-0.3, 1, 0}}));
  EXPECT_FALSE(crosses({4, {0.2, -1, 0}, {-0.3, 1, 0}})) << "another patch";
  EXPECT_FALSE(crosses({3, {1.2, -1, 0}, {1.3, 1, 0}})) << "beside it";
  EXPECT_FALSE(crosses({3, {0.2, 0.1, 0}, {-0.3, 1, 0}})) << "ends before it";
  EXPECT_FALSE(crosses({3, {0.2, 0, 0}, {-0.3, 1, 0}})) << "only touches it";
  EXPECT_FALSE(crosses({3, {-0.5, 0, 0}, {0.5, 0, 0}})) << "runs along it";
  EXPECT_FALSE(WaysCross(way, {}));
  EXPECT_FALSE(WaysCross({}, way));
}

}  // namespace
}  // namespace meshfront
