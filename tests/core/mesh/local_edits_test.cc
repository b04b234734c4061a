#include "core/mesh/local_edits.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/triangle.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

constexpr TriangleShape kAnyShape = {0, -1};

HeldPiece PieceOf(const std::vector<Vec3>& places, const std::vector<std::array<uint32_t, 3>>& triangles) {
  HeldPiece piece(MeshPiece{});
  for (const Vec3& p : places) piece.vertices.push_back({p, {}});
  for (const auto& t : triangles) piece.triangles.push_back({VertexId(t[0]), VertexId(t[1]), VertexId(t[2])});
  piece.kinds.assign(triangles.size(), TriangleKind::kFree);
  return piece;
}

// For each vertex a wedge on each side of a seam; `is_right` of each triangle.
void AddSides(const std::vector<bool>& is_right, HeldPiece& piece) {
  const auto vertices = static_cast<uint32_t>(piece.vertices.size());
  for (uint32_t w = 0; w < 2 * vertices; ++w)
    piece.wedges.push_back({w / vertices, static_cast<double>(w % vertices), 0, {}});
  for (size_t t = 0; t < piece.triangles.size(); ++t) {
    CornerWedges corners;
    for (int i = 0; i < 3; ++i) corners[i] = piece.triangles[t][i].index() + (is_right[t] ? vertices : 0);
    piece.corners.push_back(corners);
    piece.faces.push_back(static_cast<uint32_t>(t));
  }
}

HeldPiece Square() { return PieceOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}); }

TEST(LocalEdits, TurnAnEdgeBetweenTwoTriangles) {
  HeldPiece piece = Square();
  AddSides({false, false}, piece);
  LocalEdits edits(piece);
  EXPECT_FALSE(edits.ProposeFlip(0, 1, kAnyShape)) << "a rim";
  ASSERT_TRUE(edits.ProposeFlip(0, 2, kAnyShape));
  edits.Apply();
  EXPECT_EQ(edits.TrianglesBetween(0, 2).count, 0);
  EXPECT_EQ(edits.TrianglesBetween(1, 3).count, 2);
  edits.Compact();
  ASSERT_EQ(piece.triangles.size(), 2u);
  for (size_t t = 0; t < 2; ++t) {
    std::array<Vec3, 3> corners;
    for (int i = 0; i < 3; ++i) {
      corners[i] = piece.vertices[piece.triangles[t][i].index()].position;
      const Vec3 of_wedge = Square().vertices[static_cast<size_t>(piece.wedges[piece.corners[t][i]].u)].position;
      EXPECT_EQ(corners[i].x, of_wedge.x);
      EXPECT_EQ(corners[i].y, of_wedge.y);
    }
    EXPECT_GT(AreaVector(corners[0], corners[1], corners[2]).z, 0);
  }
}

TEST(LocalEdits, TurnNoEdgeOfASeam) {
  HeldPiece piece = Square();
  AddSides({false, true}, piece);
  EXPECT_FALSE(LocalEdits(piece).ProposeFlip(0, 2, kAnyShape));
}

// A roof whose eaves' ends A and B are joined by an edge of its keel already; nothing would lie in one place twice.
TEST(LocalEdits, TurnNoEdgeWhereThereIsOneAlready) {
  enum : uint32_t { U, V, A, B, M, N };
  const std::vector<Vec3> places = {{-1, 0, 1}, {1, 0, 1}, {0, -1, 0}, {0, 1, 0}, {-0.5, 0, -1}, {0.5, 0, -1}};
  HeldPiece piece =
      PieceOf(places, {{U, V, B}, {V, U, A}, {U, M, A}, {U, B, M}, {V, A, N}, {V, N, B}, {M, B, A}, {N, A, B}});
  TriangleMesh mesh;
  for (const Vec3& p : places) mesh.positions.push_back(p);
  mesh.triangles = piece.triangles;
  ASSERT_THAT(mesh, IsClosedManifold());
  EXPECT_FALSE(LocalEdits(piece).ProposeFlip(U, V, kAnyShape));
  HeldPiece roof = PieceOf(places, {{U, V, B}, {V, U, A}});
  EXPECT_TRUE(LocalEdits(roof).ProposeFlip(U, V, kAnyShape));
}

TEST(LocalEdits, AskForAGain) {
  HeldPiece square = Square();
  EXPECT_FALSE(LocalEdits(square).ProposeFlip(0, 2, {0, -1, 1.02})) << "as round before as after";
  HeldPiece kite = PieceOf({{-2, 0, 0}, {0, -1, 0}, {2, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  EXPECT_TRUE(LocalEdits(kite).ProposeFlip(0, 2, {0, -1, 1.02}));
}

// A seam S that bends to the right around the vertex L on its left: once L is gone and the seam straight, L's place is on the right.
TEST(LocalEdits, MoveNoVertexToAPlaceOfTheOtherSide) {
  enum : uint32_t { A, B, S1, S2, S3, C, D, L, R };
  const std::vector<Vec3> places = {{-1, -1, 0},  {-1, 1, 0},  {0, -1, 0},  {0.4, 0, 0}, {0, 1, 0},
                                    {1.5, -1, 0}, {1.5, 1, 0}, {0.2, 0, 0}, {0.7, 0, 0}};
  const std::vector<std::array<uint32_t, 3>> triangles = {{L, A, S1},  {L, S1, S2}, {L, S2, S3}, {L, S3, B},
                                                          {L, B, A},   {R, S1, C},  {R, C, D},   {R, D, S3},
                                                          {R, S3, S2}, {R, S2, S1}};
  for (const bool has_sides : {false, true}) {
    HeldPiece piece = PieceOf(places, triangles);
    if (has_sides) AddSides({false, false, false, false, false, true, true, true, true, true}, piece);
    LocalEdits edits(piece);
    for (const auto& [from, to] : {std::pair(L, A), std::pair(S2, S1)}) {
      ASSERT_TRUE(edits.ProposeMove(from, to, kAnyShape));
      edits.Apply();
    }
    EXPECT_EQ(edits.triangles(), 6u);
    EXPECT_EQ(edits.ProposeMove(R, S2, kAnyShape), !has_sides) << "it was on the seam";
    ASSERT_EQ(edits.ProposeMove(R, L, kAnyShape), !has_sides);
    if (has_sides) continue;
    edits.Apply();
    EXPECT_EQ(edits.around(L).size(), 4u);
    EXPECT_TRUE(edits.around(R).empty());
    ASSERT_TRUE(edits.ProposeMove(L, R, kAnyShape)) << "and back";
  }
}

// Two spheres: what the outer one may become alone would cut into the inner one.
TEST(LocalEdits, MakeNothingThatMeetsSomethingElse) {
  const TriangleMesh sphere = Icosphere(1), inner = Scaled(sphere, 0.95);
  const TriangleMesh both = Joined(sphere, inner);
  HeldPiece piece(MeshPiece{});
  for (const Vec3& p : both.positions) piece.vertices.push_back({p, {}});
  piece.triangles = both.triangles;
  piece.kinds.assign(both.triangles.size(), TriangleKind::kFree);
  LocalEdits edits(piece);
  HeldPiece alone(MeshPiece{});
  for (const Vec3& p : sphere.positions) alone.vertices.push_back({p, {}});
  alone.triangles = sphere.triangles;
  alone.kinds.assign(sphere.triangles.size(), TriangleKind::kFree);
  LocalEdits without(alone);
  int refused = 0;
  for (uint32_t v = 0; v < sphere.positions.size(); ++v) {
    for (const uint32_t w : without.NeighboursOf(v))
      refused += without.ProposeMove(v, w, kAnyShape) && !edits.ProposeMove(v, w, kAnyShape);
  }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace meshfront::testing
