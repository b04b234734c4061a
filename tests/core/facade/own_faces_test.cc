// Components of which no mesh came out right, and the input's faces in their place.
#include "core/own_faces.h"

#include <memory>
#include <utility>
#include <vector>

#include "core/preparation.h"
#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kFlatRatio = 1e-12;

std::unique_ptr<MeshSurface> SurfaceOf(const TriangleMesh& mesh) {
  absl::StatusOr<std::unique_ptr<MeshSurface>> surface = MeshSurface::Create(mesh, Context{});
  return surface.ok() ? *std::move(surface) : nullptr;
}

// The output of components that share no vertex, each made as it is given.
std::vector<HeldPiece> PiecesOf(const std::vector<TriangleMesh>& components) {
  std::vector<OutputVertex> vertices;
  std::vector<Triangle> triangles;
  for (uint32_t c = 0; c < components.size(); ++c) {
    const auto first = static_cast<uint32_t>(vertices.size());
    for (const Vec3& p : components[c].positions) vertices.push_back({.position = p, .normal = {0, 0, 1}, .sheet = c});
    for (const Triangle& t : components[c].triangles)
      triangles.push_back(
          {VertexId(first + t[0].index()), VertexId(first + t[1].index()), VertexId(first + t[2].index())});
  }
  const std::vector<TriangleKind> kinds(triangles.size(), TriangleKind::kFree);
  return {HeldPiece(MeshPiece{vertices, triangles, {}, 0, kinds})};
}

TriangleMesh MeshOf(const PartlyOwn& mixed) {
  CollectingSink sink;
  for (const HeldPiece& piece : mixed.pieces) EXPECT_THAT(sink.Append(piece.View()), IsOk());
  return sink.mesh;
}

// Two spheres, and what came of them.
class TwoComponents : public ::testing::Test {
 protected:
  PartlyOwn Mix(const TriangleMesh& first, const TriangleMesh& second) {
    const auto surface = SurfaceOf(Joined(near_, far_));
    absl::StatusOr<PartlyOwn> mixed =
        PutOwnFacesIn(PiecesOf({first, second}), *surface, {{}, 0.01, kFlatRatio}, Context{});
    EXPECT_THAT(mixed, IsOk());
    return *std::move(mixed);
  }

  const TriangleMesh near_ = Icosphere(2), far_ = Moved(Icosphere(2), {3, 0, 0});
  const TriangleMesh made_near_ = Icosphere(3), made_far_ = Moved(Icosphere(3), {3, 0, 0});
};

TEST_F(TwoComponents, StayWhereTheyAreRight) {
  const PartlyOwn mixed = Mix(made_near_, made_far_);
  EXPECT_EQ(mixed.components, 0u);
  EXPECT_EQ(mixed.faces, 0u);
  EXPECT_EQ(MeshOf(mixed).triangles.size(), 2 * made_near_.triangles.size());
}

TEST_F(TwoComponents, AreTheInputsWhereOpen) {
  TriangleMesh open = made_far_;
  open.triangles.pop_back();
  const PartlyOwn mixed = Mix(made_near_, open);
  EXPECT_EQ(mixed.components, 1u);
  EXPECT_EQ(mixed.faces, far_.triangles.size());
  EXPECT_EQ(mixed.by_kind[0], made_near_.triangles.size());
  EXPECT_EQ(mixed.by_kind[2], far_.triangles.size());
  EXPECT_EQ(mixed.topology.components, 2u);
  const TriangleMesh mesh = MeshOf(mixed);
  EXPECT_THAT(mesh, IsClosedManifold());
  EXPECT_EQ(mesh.triangles.size(), made_near_.triangles.size() + far_.triangles.size());
  EXPECT_EQ(mesh.positions.size(), made_near_.positions.size() + far_.positions.size()) << "none is left of the other";
}

// Where each corner was made on the surface is told of both kinds.
TEST_F(TwoComponents, KeepTheWedgesOfTheirCorners) {
  const auto surface = SurfaceOf(Joined(near_, far_));
  TriangleMesh open = far_;
  open.triangles.pop_back();
  std::vector<HeldPiece> pieces = PiecesOf({near_, open});  // of the surface's own faces, so that places are known
  for (uint32_t f = 0; f < pieces[0].triangles.size(); ++f) {
    pieces[0].faces.push_back(f);
    pieces[0].corners.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    for (const auto& [u, v] : {std::pair(0.0, 0.0), std::pair(1.0, 0.0), std::pair(0.0, 1.0)})
      pieces[0].wedges.push_back({f, u, v, {0, 0, 1}});
  }
  const absl::StatusOr<PartlyOwn> mixed = PutOwnFacesIn(pieces, *surface, {{}, 0.01, kFlatRatio}, Context{});
  ASSERT_THAT(mixed, IsOk());
  ASSERT_EQ(mixed->components, 1u);
  size_t corners = 0;
  std::vector<OutputVertex> vertices;
  std::vector<OutputWedge> wedges;
  for (const HeldPiece& piece : mixed->pieces) {
    vertices.insert(vertices.end(), piece.vertices.begin(), piece.vertices.end());
    wedges.insert(wedges.end(), piece.wedges.begin(), piece.wedges.end());
    ASSERT_EQ(piece.corners.size(), piece.triangles.size());
    ASSERT_EQ(piece.faces.size(), piece.triangles.size());
    for (size_t t = 0; t < piece.triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        const OutputWedge& w = wedges[piece.corners[t][i]];
        EXPECT_EQ(w.face, piece.faces[t]);
        EXPECT_LT(Distance(surface->AtFace(FaceId(w.face), w.u, w.v).position,
                           vertices[piece.triangles[t][i].index()].position),
                  1e-12);
        ++corners;
      }
    }
  }
  EXPECT_EQ(corners, 3 * (near_.triangles.size() + far_.triangles.size()));
}

TEST_F(TwoComponents, AreTheInputsWhereATriangleHasNoArea) {
  TriangleMesh flat = made_near_;
  const Triangle t = flat.triangles[0];
  flat.positions[t[2].index()] = 0.5 * (flat.PositionAt(t[0]) + flat.PositionAt(t[1]));
  const PartlyOwn mixed = Mix(flat, made_far_);
  EXPECT_EQ(mixed.components, 1u);
  EXPECT_EQ(mixed.faces, near_.triangles.size());
}

TEST_F(TwoComponents, AreTheInputsWhereTheyMeetEachOther) {
  const PartlyOwn mixed = Mix(made_near_, Moved(Icosphere(3), {1.5, 0, 0}));
  EXPECT_EQ(mixed.components, 2u) << "neither is known to be the one that is wrong";
  EXPECT_THAT(MeshOf(mixed), HasNoSelfIntersection());
}

TEST_F(TwoComponents, AreTheInputsWhereTheyMeetThemselves) {
  const PartlyOwn mixed = Mix(made_near_, Mapped(made_far_, [](const Vec3& p) {
                                return Vec3{p.x, p.y, p.x > 3.9 ? -3 * p.z : p.z};  // a cap turned inside out
                              }));
  EXPECT_EQ(mixed.components, 1u);
  EXPECT_EQ(mixed.faces, far_.triangles.size());
  EXPECT_THAT(MeshOf(mixed), HasNoSelfIntersection());
}

// Where the surface meets itself its mesh may as well.
TEST(OwnFaces, AreNotNeededWhereTheSurfaceMeetsItself) {
  const TriangleMesh first = Icosphere(2), second = Moved(Icosphere(2), {1.5, 0, 0});
  const auto surface = SurfaceOf(Joined(first, second));
  const absl::StatusOr<PartlyOwn> mixed = PutOwnFacesIn(PiecesOf({Icosphere(3), Moved(Icosphere(3), {1.5, 0, 0})}),
                                                        *surface, {{}, 0.1, kFlatRatio}, Context{});
  ASSERT_THAT(mixed, IsOk());
  EXPECT_EQ(mixed->components, 0u);
}

TriangleMesh Square(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return {{a, b, c, d}, {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(0), VertexId(2), VertexId(3)}}};
}

// A floor and a wall that were parted along an edge. A triangle of the floor is turned over; the wall has a vertex in the middle of that edge.
TEST(OwnFaces, TakeWhatSharesASeamWithThemAlong) {
  const TriangleMesh floor = Square({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  const TriangleMesh wall = Square({0, 0, 0}, {0, 0, -1}, {1, 0, -1}, {1, 0, 0});
  const auto surface = SurfaceOf(Joined(floor, wall));
  TriangleMesh turned = floor;
  turned.triangles[1] = {VertexId(0), VertexId(3), VertexId(2)};
  TriangleMesh finer = wall;
  finer.positions.push_back({0.5, 0, 0});
  finer.triangles = {{VertexId(0), VertexId(1), VertexId(4)},
                     {VertexId(1), VertexId(2), VertexId(4)},
                     {VertexId(2), VertexId(3), VertexId(4)}};
  const absl::StatusOr<PartlyOwn> mixed =
      PutOwnFacesIn(PiecesOf({turned, finer}), *surface, {{}, 1, kFlatRatio}, Context{});
  ASSERT_THAT(mixed, IsOk());
  EXPECT_EQ(mixed->components, 2u);
  EXPECT_THAT(MeshOf(*mixed), HasNoSelfIntersection());
}

// A blade through a floor: the stretch that the input's have in common is a fifth as long as that of what was made of them.
TEST(OwnFaces, AreNeededWhereAMeetingGoesOnBeyondTheBound) {
  const auto blade = [](double width) {
    return TriangleMesh{{{-width, 0, -1}, {width, 0, -1}, {0, 0, 1}}, {{VertexId(0), VertexId(1), VertexId(2)}}};
  };
  const TriangleMesh floor = Square({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0});
  const auto surface = SurfaceOf(Joined(floor, blade(0.2)));
  const auto count_own = [&](double bound) {
    const absl::StatusOr<PartlyOwn> mixed =
        PutOwnFacesIn(PiecesOf({floor, blade(1)}), *surface, {{}, bound, kFlatRatio}, Context{});
    EXPECT_THAT(mixed, IsOk());
    return mixed.ok() ? mixed->components : 0;
  };
  EXPECT_EQ(count_own(0.2), 2u) << "the middle of each half is 0.15 from the input's, its end 0.4";
  EXPECT_EQ(count_own(0.5), 0u);
}

// However it was cut, components have the numbers that they had.
TEST(OwnFaces, ComeFromTheSurfaceAsItWasBeforeTheCut) {
  const TriangleMesh cubes = Joined(Moved(Cube(2), {5, 0, 0}), Cube(2));
  const absl::StatusOr<Preparation> prepared = Prepare(Problem{cubes, {}}, Context{});
  ASSERT_THAT(prepared, IsOk());
  const MeshSurface& surface = *prepared->surface;
  ASSERT_EQ(surface.component_count(), 12u) << "the sides of both";
  const TriangleMesh before = surface.MeshBeforeCut();
  EXPECT_EQ(before.positions, cubes.positions);
  EXPECT_EQ(before.triangles, cubes.triangles);
  for (uint32_t f = 0; f < cubes.triangles.size(); ++f)
    EXPECT_EQ(surface.WholeComponentOf(surface.ComponentOf(FaceId(f))), f < cubes.triangles.size() / 2 ? 0u : 1u);
}

// More faults than are mended one by one: rods in tubes, so close to them that edges as long as asked for pass through both.
TEST(OwnFaces, AreTheResultWhereNothingElseComesOutWhole) {
  constexpr int kPairs = 15;
  TriangleMesh mesh = Icosphere(3);
  for (int i = 0; i < kPairs; ++i) {
    const TriangleMesh pair = Joined(OpenCylinder(1, 2, 96, 24), CappedCylinder(0.99, 3, 96, 32));
    mesh = Joined(std::move(mesh), Moved(pair, {4.0 * (i + 1), 0, 0}));
  }
  Problem problem{std::move(mesh), {}};
  problem.options.rho = 1.5;
  CheckingSink sink;
  const absl::StatusOr<Report> report = Remesh(std::move(problem), sink, Context{});
  ASSERT_THAT(report, IsOk());
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  EXPECT_TRUE(report->complete);
  EXPECT_THAT(report->open_places, IsEmpty());
  EXPECT_THAT(sink.mesh(), IsManifold());
  EXPECT_THAT(sink.mesh(), HasComponents(1u + 2 * kPairs));
  EXPECT_THAT(sink.mesh(), HasBoundaryLoops(2u * kPairs));
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  EXPECT_EQ(report->output.triangles, sink.mesh().triangles.size());
  ASSERT_EQ(report->warnings.size(), 1u);
  EXPECT_THAT(report->warnings[0], HasSubstr("components are the input's own faces"));
}

}  // namespace
}  // namespace meshfront::testing
