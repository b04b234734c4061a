// What is mended beside creases, of flat meshes whose creases are lines.
#include "core/crease_relaxation.h"

#include <algorithm>
#include <map>

#include "core/geometry/triangle.h"
#include "core/mesh/topology.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

constexpr int kSquares = 10;

// A sheet with a crease along x = 0 from rim to rim, its vertices the last ones.
CreasedMesh CreasedSheet() {
  CreasedMesh creased;
  const TriangleMesh sheet = Sheet(kSquares);
  std::vector<uint32_t> order;
  for (const bool on_crease : {false, true}) {
    if (on_crease) creased.first_on_crease = static_cast<uint32_t>(order.size());
    for (uint32_t v = 0; v < sheet.positions.size(); ++v) {
      if ((std::abs(sheet.positions[v].x) < 1e-9) == on_crease) order.push_back(v);
    }
  }
  std::vector<uint32_t> names(order.size());
  for (uint32_t i = 0; i < order.size(); ++i) {
    names[order[i]] = i;
    creased.mesh.positions.push_back(sheet.positions[order[i]]);
  }
  for (const Triangle& t : sheet.triangles) {
    std::array<uint32_t, 3> at;
    for (int i = 0; i < 3; ++i) at[i] = names[t[i].index()];
    creased.mesh.triangles.push_back({VertexId(at[0]), VertexId(at[1]), VertexId(at[2])});
    for (int i = 0; i < 3; ++i) {
      const uint32_t a = at[i], b = at[(i + 1) % 3];
      if (a < b && a >= creased.first_on_crease) creased.creases.push_back({a, b});
    }
  }
  return creased;
}

// The vertex of the crease at (0, y).
Vec3& OnCrease(CreasedMesh& creased, double y) {
  const auto first = creased.mesh.positions.begin() + creased.first_on_crease;
  return *std::min_element(first, creased.mesh.positions.end(),
                           [&](const Vec3& a, const Vec3& b) { return std::abs(a.y - y) < std::abs(b.y - y); });
}

absl::Status Relax(CreasedMesh& creased) {
  SideFit plane;
  plane.u = {1, 0, 0}, plane.v = {0, 1, 0}, plane.normal = {0, 0, 1};
  const uint32_t first = creased.first_on_crease;
  return RelaxCreases(creased,
                      {[&](uint32_t v) { return v < first ? &plane : nullptr; },
                       [&](uint32_t v, const Vec3& x) -> std::optional<Vec3> {
                         return v < first ? Vec3{x.x, x.y, 0} : Vec3{0, x.y, 0};
                       },
                       [](uint32_t) { return false; }},
                      Context{});
}

void ExpectMended(const CreasedMesh& creased) {
  const TriangleMesh& mesh = creased.mesh;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    EXPECT_GT(AreaVector(a, b, c).z, 0);
    EXPECT_GT(RadiusRatio(a, b, c), 0.1);
    EXPECT_TRUE(std::max({a.x, b.x, c.x}) <= 1e-12 || std::min({a.x, b.x, c.x}) >= -1e-12);
  }
  const TopologyReport topology = MeasureTopology(mesh);
  EXPECT_TRUE(topology.manifold && topology.oriented);
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_EQ(topology.euler_characteristic, 1);
}

TEST(CreaseRelaxation, PutsCreaseVerticesBackInOrder) {
  CreasedMesh creased = CreasedSheet();
  OnCrease(creased, 0.2).y = 0.47;
  ASSERT_THAT(Relax(creased), IsOk());
  ExpectMended(creased);
}

TEST(CreaseRelaxation, TakesVerticesBackThatPassedTheCrease) {
  CreasedMesh creased = CreasedSheet();
  for (Vec3& x : creased.mesh.positions) {
    if (Distance(x, {0.2, 0.4, 0}) < 1e-9) x.x = -0.1;
    if (Distance(x, {-0.2, -0.4, 0}) < 1e-9) x.x = -0.001;
  }
  ASSERT_THAT(Relax(creased), IsOk());
  ExpectMended(creased);
}

TEST(CreaseRelaxation, LeavesGoodFacesAlone) {
  CreasedMesh creased = CreasedSheet();
  const CreasedMesh before = creased;
  ASSERT_THAT(Relax(creased), IsOk());
  EXPECT_EQ(creased.mesh.positions, before.mesh.positions);
  EXPECT_EQ(creased.mesh.triangles, before.mesh.triangles);
}

}  // namespace
}  // namespace meshfront::testing
