// A region is remeshed, the rest comes back bit for bit, and both are one manifold mesh.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/quality.h"
#include "core/mesh/self_intersection.h"
#include "core/prepared_input.h"
#include "core/remesh.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

using Bits = std::array<uint64_t, 3>;

Bits BitsOf(const Vec3& p) {
  Bits bits;
  std::memcpy(bits.data(), &p, sizeof(p));
  return bits;
}

// A face as what it is wherever its vertices' numbers begin: positions, from the smallest on.
using FaceBits = std::array<Bits, 3>;
FaceBits FaceOf(const TriangleMesh& mesh, const Triangle& t) {
  FaceBits face{BitsOf(mesh.PositionAt(t[0])), BitsOf(mesh.PositionAt(t[1])), BitsOf(mesh.PositionAt(t[2]))};
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  return face;
}

bool IsInside(const RegionSphere& sphere, const TriangleMesh& mesh, const Triangle& t) {
  return std::all_of(t.begin(), t.end(),
                     [&](VertexId v) { return Distance(mesh.PositionAt(v), sphere.center) <= sphere.radius; });
}

struct Result {
  TriangleMesh mesh;
  Report report;
};

Result RemeshRegion(TriangleMesh mesh, Region region, RemeshOptions options = {}) {
  CollectingSink sink;
  auto report = Remesh({std::move(mesh), options, std::move(region)}, sink, {});
  EXPECT_THAT(report, IsOk());
  return {std::move(sink.mesh), report.ok() ? *std::move(report) : Report{}};
}

// What holds for every region: see engine.md section 8.
void ExpectGraft(const TriangleMesh& input, const RegionSphere& sphere, const Result& result) {
  std::multiset<FaceBits> kept;
  for (const Triangle& t : input.triangles) {
    if (!IsInside(sphere, input, t)) kept.insert(FaceOf(input, t));
  }
  ASSERT_TRUE(result.report.region.has_value());
  EXPECT_EQ(result.report.region->kept_triangles, kept.size());
  EXPECT_EQ(result.report.region->replaced_triangles, input.triangles.size() - kept.size());
  EXPECT_EQ(result.report.region->new_triangles, result.mesh.triangles.size() - kept.size());
  for (const Triangle& t : result.mesh.triangles) {
    const auto found = kept.find(FaceOf(result.mesh, t));
    if (found != kept.end()) kept.erase(found);
  }
  EXPECT_TRUE(kept.empty()) << kept.size() << " faces outside are not what they were";
  EXPECT_TRUE(result.report.complete);
  const TopologyReport before = MeasureTopology(input), after = MeasureTopology(result.mesh);
  EXPECT_THAT(result.mesh, testing::IsManifold());
  EXPECT_EQ(after.closed, before.closed);
  EXPECT_EQ(after.components, before.components);
  EXPECT_EQ(after.boundary_loops, before.boundary_loops);
  EXPECT_EQ(after.genus, before.genus);
  EXPECT_EQ(result.report.output.genus, after.genus);
  EXPECT_EQ(result.report.output.boundary_edges, after.boundary_edges);
  // Their search has no scale of its own.
  const double scale = std::ldexp(1.0, -std::ilogb(BoundingBox(input).Diagonal()));
  const auto meetings = FindSelfIntersections(testing::Scaled(result.mesh, scale), 1, {});
  ASSERT_THAT(meetings, IsOk());
  EXPECT_EQ(meetings->pairs, 0u);
}

double DiagonalOf(const TriangleMesh& mesh) { return BoundingBox(mesh).Diagonal(); }

// The vertex that a hash of the round picks, and a radius of 4 to 20 % of the diagonal.
RegionSphere RandomSphere(const TriangleMesh& mesh, uint64_t round) {
  uint64_t x = 0x9e3779b97f4a7c15u * (round + 1);
  x ^= x >> 31, x *= 0xbf58476d1ce4e5b9u, x ^= x >> 29;
  const auto share = static_cast<double>(x >> 40) / (1 << 24);
  return {mesh.positions[x % mesh.positions.size()], (0.04 + 0.16 * share) * DiagonalOf(mesh)};
}

bool HoldsAFace(const RegionSphere& sphere, const TriangleMesh& mesh) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(),
                     [&](const Triangle& t) { return IsInside(sphere, mesh, t); });
}

struct Shape {
  std::string name;
  TriangleMesh mesh;
};

std::vector<Shape> Shapes() {
  return {{"ball", testing::Icosphere(4)},
          {"noisy ball", testing::WithNoise(testing::Icosphere(4), 0.01, 7)},
          {"torus", testing::Torus(1, 0.4, 96, 40)},
          {"cube", testing::Cube(12)},
          {"sheet", testing::Sheet(24)},
          {"terrain", testing::WavyTerrain(40)},
          {"disk with holes", testing::DiskWithHoles(40)},
          {"slab", testing::ThinSlab(30)},
          {"plate with hole", testing::PlateWithRoundHole(16)},
          {"iso-surface", testing::GenusThree(40)},
          {"cylinder", testing::CappedCylinder(0.5, 2, 40, 16)},
          {"tubes", testing::ParallelTubes(0.02, 3, 16, 5)}};
}

TEST(RemeshRegion, KeepsTheRestBitForBitAndJoinsItWhereverTheRegionIs) {
  for (const Shape& shape : Shapes()) {
    for (uint64_t round = 0; round < 8; ++round) {
      const RegionSphere sphere = RandomSphere(shape.mesh, 100 * round + shape.name.size());
      if (!HoldsAFace(sphere, shape.mesh)) continue;
      SCOPED_TRACE(shape.name + ", round " + std::to_string(round));
      RemeshOptions options;
      options.rho = round % 2 == 0 ? 0.8 : 0.4;
      ExpectGraft(shape.mesh, sphere, RemeshRegion(shape.mesh, {sphere}, options));
    }
  }
}

TEST(RemeshRegion, RefusesARegionThatHoldsNoFace) {
  CollectingSink sink;
  const auto report = Remesh({testing::Icosphere(2), {}, Region{RegionSphere{{5, 0, 0}, 1}}}, sink, {});
  EXPECT_THAT(report, StatusIs(absl::StatusCode::kInvalidArgument, "options.region is empty"));
  EXPECT_THAT(report, StatusIs(absl::StatusCode::kInvalidArgument, "the mesh lies between"));
  EXPECT_TRUE(sink.mesh.triangles.empty());
}

TEST(RemeshRegion, RefusesAFaceThatTheInputDoesNotHave) {
  CollectingSink sink;
  EXPECT_THAT(Remesh({testing::Icosphere(1), {}, Region{RegionFaces{3, 80}}}, sink, {}),
              StatusIs(absl::StatusCode::kInvalidArgument, "options.region.faces names face 80 (entry 1)"));
}

TEST(RemeshRegion, OfEverythingIsTheSameAsNone) {
  const TriangleMesh mesh = testing::Icosphere(3);
  const Result whole = RemeshRegion(mesh, {RegionSphere{{0, 0, 0}, 2}});
  CollectingSink sink;
  ASSERT_THAT(Remesh({mesh, {}, {}}, sink, {}), IsOk());
  EXPECT_EQ(whole.mesh.triangles, sink.mesh.triangles);
  EXPECT_EQ(whole.mesh.positions, sink.mesh.positions);
  EXPECT_EQ(whole.report.region->kept_triangles, 0u);
  EXPECT_EQ(whole.report.region->replaced_triangles, mesh.triangles.size());
}

// Two squares of a sheet that touch in a corner.
TEST(RemeshRegion, JoinsPartsThatTouchInAVertex) {
  const TriangleMesh mesh = testing::Sheet(8);
  RegionFaces faces;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    Vec3 middle;
    for (const VertexId v : mesh.triangles[f]) middle += mesh.PositionAt(v) / 3.0;
    const bool first = middle.x > -0.5 && middle.x < 0 && middle.y > -0.5 && middle.y < 0;
    const bool second = middle.x > 0 && middle.x < 0.5 && middle.y > 0 && middle.y < 0.5;
    if (first || second) faces.push_back(f);
  }
  ASSERT_EQ(faces.size(), 16u);
  RemeshOptions options;
  options.max_edge = Length{0.1, false};
  const Result result = RemeshRegion(mesh, {faces}, options);
  EXPECT_THAT(result.mesh, testing::IsManifold());
  EXPECT_EQ(result.report.region->replaced_triangles, 16u);
  EXPECT_EQ(MeasureTopology(result.mesh).boundary_loops, 1u);
}

// The faces are numbered before repair: here each vertex comes several times, and a face without area is dropped in front of them.
TEST(RemeshRegion, NumbersFacesAsTheyWereBeforeRepair) {
  const TriangleMesh ball = testing::Icosphere(3);
  TriangleMesh mesh = testing::Soup(ball);
  mesh.triangles.insert(mesh.triangles.begin(), {VertexId(0), VertexId(0), VertexId(1)});
  RegionFaces faces;
  std::set<FaceBits> chosen;
  for (uint32_t f = 1; f < mesh.triangles.size(); ++f) {
    if (!IsInside({{0, 0, 1}, 0.5}, mesh, mesh.triangles[f])) continue;
    faces.push_back(f);
    chosen.insert(FaceOf(mesh, mesh.triangles[f]));
  }
  RemeshOptions options;
  options.rho = 0.2;
  Region region{faces};
  region.patch_only = true;
  const Result patch = RemeshRegion(mesh, region, options);
  EXPECT_EQ(patch.report.region->replaced_triangles, faces.size());
  faces.insert(faces.begin(), 0);  // the one that repair dropped is gone, too
  EXPECT_EQ(patch.report.region->removed_faces, faces);
  EXPECT_THAT(patch.report.warnings, Contains(HasSubstr("dropped 1 anywhere")));
  const Result whole = RemeshRegion(mesh, {RegionFaces(faces.begin() + 1, faces.end())}, options);
  EXPECT_TRUE(MeasureTopology(whole.mesh).closed);
  EXPECT_THAT(whole.mesh, testing::IsManifold());
}

TEST(RemeshRegion, HandsOnThePatchAlone) {
  const TriangleMesh mesh = testing::Icosphere(4);
  const RegionSphere sphere{{0, 0, 1}, 0.6};
  Region region{sphere};
  const Result whole = RemeshRegion(mesh, region);
  region.patch_only = true;
  const Result patch = RemeshRegion(mesh, region);
  EXPECT_EQ(patch.mesh.triangles.size(), whole.report.region->new_triangles);
  EXPECT_EQ(patch.report.region->removed_faces.size(), whole.report.region->replaced_triangles);
  EXPECT_EQ(patch.report.output.boundary_loops, 1u);
  for (const uint32_t f : patch.report.region->removed_faces) EXPECT_TRUE(IsInside(sphere, mesh, mesh.triangles[f]));
}

// Also of a mesh with attributes, and of one whose faces repair moves, drops and turns.
TEST(RemeshRegion, HandsTheWholeToWhoGoesOnWithItBesideThePatch) {
  TriangleMesh dirty = testing::Icosphere(4);
  dirty.triangles.insert(dirty.triangles.begin() + 7, {VertexId(0), VertexId(0), VertexId(1)});
  std::swap(dirty.triangles[50][1], dirty.triangles[50][2]);
  TriangleMesh grouped = testing::Icosphere(4);
  grouped.attributes.groups.assign(grouped.triangles.size(), 0);
  for (size_t f = 0; f < grouped.triangles.size(); f += 2) grouped.attributes.groups[f] = 1;
  for (const TriangleMesh& mesh : {testing::Icosphere(4), dirty, grouped}) {
    Region region{RegionSphere{{0, 0, 1}, 0.6}};
    const Result without = RemeshRegion(mesh, region);
    region.patch_only = true;
    CollectingSink patch, whole;
    const auto report = Remesh({mesh, {}, region, nullptr, {}, &whole}, patch, {});
    ASSERT_THAT(report, IsOk());
    EXPECT_EQ(whole.mesh.positions, without.mesh.positions);
    EXPECT_EQ(whole.mesh.triangles, without.mesh.triangles);
    EXPECT_EQ(whole.mesh.attributes.groups, without.mesh.attributes.groups);
    EXPECT_EQ(report->region->new_triangles, without.report.region->new_triangles);
    // What a client has that takes the removed faces out of its list and appends those of the patch.
    std::vector<FaceBits> list, faces;
    std::vector<bool> is_removed(mesh.triangles.size());
    for (const uint32_t f : report->region->removed_faces) is_removed[f] = true;
    for (size_t f = 0; f < mesh.triangles.size(); ++f) {
      Triangle t = mesh.triangles[f];
      if (f == 50 && mesh.triangles.size() == dirty.triangles.size()) std::swap(t[1], t[2]);  // as repaired
      if (!is_removed[f]) list.push_back(FaceOf(mesh, t));
    }
    for (const Triangle& t : patch.mesh.triangles) list.push_back(FaceOf(patch.mesh, t));
    for (const Triangle& t : whole.mesh.triangles) faces.push_back(FaceOf(whole.mesh, t));
    EXPECT_EQ(list, faces);
  }
}

TEST(RemeshRegion, HandsTheWholeOnWithoutARegionToo) {
  const TriangleMesh mesh = testing::Icosphere(3);
  for (const bool with_region : {false, true}) {  // the second one is all of the mesh
    CollectingSink sink, whole;
    Problem problem{mesh, {}, std::nullopt, nullptr, {}, &whole};
    if (with_region) problem.region = Region{RegionSphere{{0, 0, 0}, 2}, true};
    ASSERT_THAT(Remesh(std::move(problem), sink, {}), IsOk());
    EXPECT_EQ(whole.mesh.triangles, sink.mesh.triangles);
    EXPECT_GT(whole.mesh.triangles.size(), 50u);
  }
}

// The mean of the edges at the vertices that lie `from` to `to` away from the border, inwards.
double MeanEdge(const TriangleMesh& mesh, const Vec3& center, double from, double to) {
  double sum = 0;
  int count = 0;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const Vec3 &a = mesh.PositionAt(t[i]), &b = mesh.PositionAt(t[(i + 1) % 3]);
      const double distance = Distance(0.5 * (a + b), center);
      if (distance >= from && distance < to) sum += Distance(a, b), ++count;
    }
  }
  return sum / count;
}

// A sheet of edges of 0.05, remeshed to 0.15 within a circle of 0.9: at the border edges are as the border's, far inside as asked for.
TEST(RemeshRegion, BlendsFromTheBordersEdgesToThoseWanted) {
  RemeshOptions options;
  options.sizing = Sizing::kUniform;
  options.edge_length = Length{0.15, false};
  options.blend = 6;
  const Region region{RegionSphere{{0, 0, 0}, 0.9}, true};
  const Result coarse = RemeshRegion(testing::Sheet(40), region, options);
  const double border = MeanEdge(coarse.mesh, {}, 0.84, 0.9);
  EXPECT_NEAR(border, 0.057, 0.012);
  EXPECT_NEAR(MeanEdge(coarse.mesh, {}, 0, 0.3), 0.15, 0.02);
  EXPECT_GT(MeanEdge(coarse.mesh, {}, 0.65, 0.75), 1.2 * border);
  options.edge_length = Length{0.02, false};
  const Result fine = RemeshRegion(testing::Sheet(40), region, options);
  EXPECT_NEAR(MeanEdge(fine.mesh, {}, 0, 0.4), 0.02, 0.003);
  EXPECT_GT(MeanEdge(fine.mesh, {}, 0.8, 0.9), 0.035);
}

TEST(RemeshRegion, CountsTheNewTrianglesWhereANumberIsWanted) {
  RemeshOptions options;
  options.target_triangles = 1500;
  const Result result = RemeshRegion(testing::Icosphere(5), {RegionSphere{{0, 0, 1}, 0.8}}, options);
  EXPECT_NEAR(static_cast<double>(result.report.region->new_triangles), 1500, 0.03 * 1500);
}

TEST(RemeshRegion, KeepsTheDirectionOfWhatFacesInwards) {
  const TriangleMesh mesh = testing::Reversed(testing::Icosphere(3));
  const RegionSphere sphere{{0, 0, 1}, 0.7};
  ExpectGraft(mesh, sphere, RemeshRegion(mesh, {sphere}));
}

TEST(RemeshRegion, KeepsCoordinatesThatSquaresCannotHold) {
  const TriangleMesh mesh = testing::Scaled(testing::Icosphere(3), 1e140);
  const RegionSphere sphere{{0, 0, 1e140}, 0.7e140};
  ExpectGraft(mesh, sphere, RemeshRegion(mesh, {sphere}));
}

TEST(RemeshRegion, GivesTheSameBitsAtAnyThreadCount) {
  const TriangleMesh mesh = testing::GenusThree(40);
  const Region region{RegionSphere{mesh.positions[100], 0.5}};
  CollectingSink one, four;
  Context context;
  ASSERT_THAT(Remesh({mesh, {}, region}, one, context), IsOk());
  context.threads = 4;
  ASSERT_THAT(Remesh({mesh, {}, region}, four, context), IsOk());
  EXPECT_EQ(one.mesh.positions, four.mesh.positions);
  EXPECT_EQ(one.mesh.triangles, four.mesh.triangles);
}

// What is kept of an input (PreparedInput) must change nothing but the time.
void ExpectSameAsAlone(const std::shared_ptr<const PreparedInput>& prepared, const TriangleMesh& mesh,
                       const std::optional<Region>& region, const RemeshOptions& options = {}) {
  CollectingSink alone, again;
  const auto expected = Remesh({mesh, options, region}, alone, {});
  const auto report = Remesh({{}, options, region, prepared}, again, {});
  ASSERT_EQ(report.status(), expected.status());
  EXPECT_EQ(again.mesh.positions, alone.mesh.positions);
  EXPECT_EQ(again.mesh.triangles, alone.mesh.triangles);
  if (!report.ok()) return;
  EXPECT_EQ(report->warnings, expected->warnings);
  ASSERT_EQ(report->region.has_value(), region.has_value());
  if (region) {
    EXPECT_EQ(report->region->removed_faces, expected->region->removed_faces);
  }
}

std::shared_ptr<const PreparedInput> Prepared(const TriangleMesh& mesh, bool repair = true) {
  auto prepared = PreparedInput::Create(mesh, repair, {});
  EXPECT_THAT(prepared, IsOk());
  return prepared.ok() ? *prepared : nullptr;
}

TEST(RemeshRegion, GivesTheSameBytesOfAPreparedInput) {
  for (const TriangleMesh& mesh : {testing::Icosphere(4), testing::Soup(testing::Cube(8)),
                                   testing::Scaled(testing::Icosphere(3), 1e140), testing::ThinSlab(30)}) {
    const auto prepared = Prepared(mesh);
    for (const uint64_t round : {1, 2, 3}) {
      Region region{RandomSphere(mesh, round)};
      region.patch_only = round == 2;
      ExpectSameAsAlone(prepared, mesh, region);
    }
    ExpectSameAsAlone(prepared, mesh, Region{RegionFaces{0, 5, 7}, true});
    ExpectSameAsAlone(prepared, mesh, std::nullopt);
  }
}

// A mesh that needs repair, prepared with it and without.
TEST(RemeshRegion, AsksAPreparedInputForRepairAsTheOptionsDo) {
  const TriangleMesh soup = testing::Soup(testing::Icosphere(3)), whole = testing::Icosphere(3);
  const Region region{RegionSphere{{0, 0, 1}, 0.6}};
  RemeshOptions options;
  options.repair = false;
  ExpectSameAsAlone(Prepared(soup), soup, region, options);
  ExpectSameAsAlone(Prepared(whole, false), whole, region);
  ExpectSameAsAlone(Prepared(whole), whole, region, options);
}

// Two balls, one in the other, that almost touch at +x, where edges that may not be shorter pass through both. Around there the faces stay.
TEST(Region, LeavesFacesAsTheyAreWhereNoMeshComesOutRight) {
  const TriangleMesh outer = testing::UvSphere(32, 16);
  const Vec3 touch = *std::max_element(outer.positions.begin(), outer.positions.end(),
                                       [](const Vec3& a, const Vec3& b) { return a.x < b.x; });
  TriangleMesh inner = testing::Moved(testing::Scaled(outer, 0.8), 0.1995 * touch);
  for (Triangle& t : inner.triangles) std::swap(t[1], t[2]);
  const TriangleMesh mesh = testing::Joined(outer, inner);
  RegionFaces faces;
  for (uint32_t f = 0; f < outer.triangles.size(); ++f) {
    const Triangle& t = outer.triangles[f];
    if (std::min({outer.PositionAt(t[0]).x, outer.PositionAt(t[1]).x, outer.PositionAt(t[2]).x}) > 0.2)
      faces.push_back(f);
  }
  RemeshOptions options;
  options.min_edge = Length{0.05, false};
  for (const bool patch_only : {false, true}) {
    const auto [result, report] = RemeshRegion(mesh, Region{faces, patch_only}, options);
    EXPECT_TRUE(report.complete);
    EXPECT_THAT(report.warnings,
                ElementsAre(HasSubstr(absl::StrCat(" of ", faces.size(), " faces of options.region stay"))));
    EXPECT_GT(report.region->replaced_triangles, faces.size() / 3);
    EXPECT_LT(report.region->replaced_triangles, faces.size());
    EXPECT_EQ(report.region->kept_triangles + report.region->replaced_triangles, mesh.triangles.size());
    if (patch_only) {
      EXPECT_EQ(report.region->removed_faces.size(), report.region->replaced_triangles);
      continue;
    }
    EXPECT_THAT(result, testing::IsClosedManifold());
    const auto meetings = FindSelfIntersections(result, 1, {});
    ASSERT_THAT(meetings, IsOk());
    EXPECT_EQ(meetings->pairs, 0u);
    std::set<FaceBits> left;
    for (const Triangle& t : result.triangles) left.insert(FaceOf(result, t));
    size_t same = 0;
    for (const Triangle& t : mesh.triangles) same += left.contains(FaceOf(mesh, t));
    EXPECT_GE(same, report.region->kept_triangles);
  }
}

// Narrow columns among wide ones, cut across: edges of 0.1 and 0.004 meet on the border.
TEST(Region, WarnsWhereEdgesOfTheBorderDiffer) {
  const auto warnings_of = [](const TriangleMesh& mesh) {
    return RemeshRegion(mesh, {Box3{{-9, -0.5, -1}, {9, 0.5, 1}}}).report.warnings;
  };
  EXPECT_THAT(warnings_of(testing::Sheet(32)), ::testing::Not(Contains(HasSubstr("differ"))));
  const TriangleMesh strips = testing::Mapped(testing::Sheet(32), [](const Vec3& p) {
    const double column = std::round((p.x + 1) * 16), pair = std::floor(column / 2);
    return Vec3{pair * 0.104 + (column > 2 * pair ? 0.004 : 0.0), p.y, p.z};
  });
  EXPECT_THAT(warnings_of(strips), Contains(HasSubstr("differ 25 times in length")));
}

// With attributes and without; where a mesh had to be mended the one that came is there as well.
TEST(PreparedInput, TakesTheMemoryThatWasForeseen) {
  TriangleMesh ball = testing::Icosphere(2);
  EXPECT_EQ(Prepared(ball)->bytes(), PreparedInput::LeastBytes(PreparedInput::SizeOf(ball)));
  ball.attributes.channels = {{"TEXCOORD_0", 2}};
  for (const Triangle& t : ball.triangles)
    ball.attributes.corners.push_back({t[0].index(), t[1].index(), t[2].index()});
  ball.attributes.values.resize(2 * ball.positions.size());
  EXPECT_EQ(Prepared(ball)->bytes(), PreparedInput::LeastBytes(PreparedInput::SizeOf(ball)));
  const TriangleMesh soup = testing::Soup(testing::Icosphere(2));
  EXPECT_GT(Prepared(soup)->bytes(), PreparedInput::LeastBytes(PreparedInput::SizeOf(soup)));
}

TEST(Remesh, AsksBeforeTheFirstTriangleWhetherItMayMakeSoMany) {
  for (const bool is_region : {false, true}) {
    uint64_t heard = 0;
    absl::Status answer;
    const auto remesh = [&](CollectingSink& sink) {
      Problem problem{testing::Icosphere(3)};
      if (is_region) problem.region = Region{RegionSphere{{0, 0, 1}, 0.6}};
      problem.admit = [&](uint64_t triangles) {
        EXPECT_TRUE(sink.mesh.triangles.empty());
        heard = triangles;
        return answer;
      };
      return Remesh(std::move(problem), sink, {});
    };
    CollectingSink sink, refused;
    const absl::StatusOr<Report> report = remesh(sink);
    ASSERT_THAT(report, IsOk());
    EXPECT_EQ(heard, report->predicted_triangles);
    answer = absl::ResourceExhaustedError("too many");
    EXPECT_THAT(remesh(refused), StatusIs(absl::StatusCode::kResourceExhausted, "too many"));
    EXPECT_TRUE(refused.mesh.triangles.empty());
  }
}

TEST(PreparedInput, RefusesAPointSet) {
  TriangleMesh points = testing::Icosphere(2);
  points.triangles.clear();
  EXPECT_THAT(PreparedInput::Create(points, true, {}), StatusIs(absl::StatusCode::kInvalidArgument, "point set"));
}

}  // namespace
}  // namespace meshfront
