#include "core/surface/normal_grid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/mesh/adjacency.h"
#include "core/surface/tolerances.h"
#include "core/surface/vertex_normals.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using surface_tolerances::kOpposed;

// A mesh with what a grid reads of it.
struct Scene {
  explicit Scene(TriangleMesh m)
      : mesh(std::move(m)),
        adjacency(CreateAdjacency(mesh)),
        normals(ComputeVertexNormals(mesh)),
        bvh(mesh.positions, mesh.triangles) {}

  NormalGrid Grid(double cell_size) const {
    const FaceView view{mesh.positions.data(), mesh.triangles.data(), adjacency.opposite.data()->data(),
                        static_cast<uint32_t>(mesh.triangles.size())};
    return NormalGrid(view, mesh.positions.size(), BoundingBox(mesh), cell_size);
  }
  bool IsOpposed(FaceId face, const Vec3& normal) const {
    const Triangle& t = mesh.triangles[face.index()];
    const Vec3 area = AreaVector(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
    return Dot(area, normal) < kOpposed * Norm(area);
  }
  // The first opposed face on the way from vertex v along sign times its normal.
  std::optional<SegmentHit> OpposedHit(uint32_t v, double sign, double length) const {
    return bvh.FindFirstHit(mesh.positions[v], sign * normals[v], 0, length,
                            [&](FaceId face) { return IsOpposed(face, normals[v]); });
  }

  TriangleMesh mesh;
  FaceAdjacency adjacency;
  std::vector<Vec3> normals;
  TriangleBvh bvh;
};

TEST(NormalGrid, NeverRulesOutARayThatMeetsAnOpposedFace) {
  for (const TriangleMesh& mesh : {testing::ThinSlab(20, 0.04), testing::ConcentricShells(3, 0.9), testing::Cube(1),
                                   testing::ParallelTubes(0.01), testing::GenusThree(32)}) {
    const Scene scene(mesh);
    for (const double cell_size : {0.0, 0.01, 0.07, 0.5}) {
      NormalGrid grid = scene.Grid(cell_size);
      std::vector<uint32_t> hits;
      for (uint32_t v = 0; v < scene.mesh.positions.size(); ++v) {
        for (const double sign : {-1.0, 1.0}) {
          const auto hit = scene.OpposedHit(v, sign, 0.3);
          if (!hit) continue;
          const Vec3 &from = scene.mesh.positions[v], &normal = scene.normals[v];
          ASSERT_TRUE(grid.MayMeetOpposed(from, from + sign * 0.3 * normal, normal)) << v << " " << cell_size;
          grid.MarkOpposed(from, from + sign * 0.3 * normal, normal);
          hits.push_back(static_cast<uint32_t>(hit->face.index()));
        }
      }
      const std::vector<uint32_t> marked = grid.FacesInMarked();
      for (const uint32_t f : hits) EXPECT_TRUE(std::binary_search(marked.begin(), marked.end(), f)) << f;
    }
  }
}

TEST(NormalGrid, RulesOutShortRaysOfASphere) {
  const Scene scene(testing::Icosphere(4));
  const NormalGrid grid = scene.Grid(0.1);
  for (uint32_t v = 0; v < scene.mesh.positions.size(); ++v) {
    const Vec3 &from = scene.mesh.positions[v], &normal = scene.normals[v];
    EXPECT_FALSE(grid.MayMeetOpposed(from, from - 0.2 * normal, normal)) << v;
    EXPECT_FALSE(grid.MayMeetOpposed(from, from + 0.2 * normal, normal)) << v;
  }
}

}  // namespace
}  // namespace meshfront
