// Fronts on both sides of a crease: two patches of a surface whose loops share vertices of the output.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "core/front/advancing_front.h"
#include "core/front/front_set.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/front/fake_surfaces.h"
#include "tests/core/front/front_checks.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using testing::CheckingSink;
using testing::DistanceSurface;
using testing::FaultOf;
using testing::HasGenus;
using testing::HasNoSelfIntersection;
using testing::IsClosedManifold;
using ::testing::IsEmpty;
using testing::IsManifold;
using testing::IsOk;
using testing::LiveTriangles;
using ::testing::SizeIs;

// A square cushion: its upper side's loop runs through the joints 0 1 2 3, its lower side's the other way.
//
//      3 --- 2
//      |     |
//      0 --- 1
struct Cushion {
  Cushion() : upper(Loop({0, 1, 2, 3})), lower(Loop({0, 3, 2, 1})) {}

  std::vector<WindowVertexId> Loop(const std::vector<uint32_t>& joints) {
    std::vector<WindowVertexId> at_joint(4), order;
    for (const uint32_t joint : joints) {
      order.push_back(fronts.AddVertex({{1.0 * joint, 0, 0}, {0, 0, 1}}, 1, 0));
      fronts.AttachJoint(order.back(), joint);
      at_joint[joint] = order.back();
    }
    for (size_t i = 0; i < 4; ++i) fronts.MarkCrease(order[i], order[(i + 1) % 4]);
    fronts.AddLoop(order);
    return at_joint;
  }
  FrontEdgeId EdgeFrom(WindowVertexId v) const { return fronts.at(v).first_corner; }
  // Fills a side with two triangles, whose common edge runs from the start of `edge` to the corner across.
  void Fill(FrontEdgeId edge) {
    const FrontEdgeId corner = fronts.at(fronts.at(edge).next).next;
    const FrontEdgeId diagonal = fronts.Connect(edge, corner, TriangleKind::kConnection).made[0];
    fronts.Connect(diagonal, fronts.at(diagonal).prev, TriangleKind::kClosing);
  }

  FrontSet fronts;
  std::vector<WindowVertexId> upper, lower;  // by their joints
};

TEST(FrontSetJoints, AreOneVertexOfTheOutput) {
  Cushion c;
  std::set<uint32_t> identities;
  for (int joint = 0; joint < 4; ++joint) {
    EXPECT_NE(c.upper[joint], c.lower[joint]);
    EXPECT_EQ(c.fronts.IdentityOf(c.upper[joint]), c.fronts.IdentityOf(c.lower[joint]));
    identities.insert(c.fronts.IdentityOf(c.upper[joint]));
    EXPECT_EQ(c.fronts.joint(joint).vertices, 2u);
  }
  const WindowVertexId other = c.fronts.AddVertex({{9, 9, 9}, {0, 0, 1}}, 1, 0);
  identities.insert(c.fronts.IdentityOf(other));
  EXPECT_THAT(identities, SizeIs(5));
}

TEST(FrontSetJoints, HaveTheEdgesOfTheirCreasesFromTheStart) {
  Cushion c;
  for (int joint = 0; joint < 4; ++joint) {
    const int next = (joint + 1) % 4;
    EXPECT_TRUE(c.fronts.EdgeExists(c.upper[joint], c.upper[next]));
    EXPECT_TRUE(c.fronts.EdgeExists(c.lower[next], c.lower[joint]));
    EXPECT_TRUE(c.fronts.IsOnCrease(c.EdgeFrom(c.upper[joint])));
    EXPECT_EQ(c.fronts.SidesOnCrease(c.EdgeFrom(c.upper[joint])), 0);
  }
  EXPECT_FALSE(c.fronts.EdgeExists(c.upper[0], c.upper[2]));
  EXPECT_FALSE(c.fronts.EdgeExists(c.lower[0], c.lower[2]));
  EXPECT_TRUE(c.fronts.EdgeExists(c.upper[0], c.lower[0])) << "one vertex has no edge to itself";
  EXPECT_THAT(c.fronts.BareCreases(), IsEmpty());
}

TEST(FrontSetJoints, KnowAnEdgeOfAnotherPatch) {
  Cushion c;
  c.Fill(c.EdgeFrom(c.upper[0]));  // with the edge 0–2
  EXPECT_EQ(FaultOf(c.fronts), "");
  EXPECT_TRUE(c.fronts.EdgeExists(c.lower[0], c.lower[2]));
  EXPECT_TRUE(c.fronts.EdgeExists(c.lower[2], c.lower[0]));
  EXPECT_FALSE(c.fronts.EdgeExists(c.lower[1], c.lower[3])) << "the diagonal that is left for this side";
}

TEST(FrontSetJoints, CountTheTrianglesOnBothSidesOfACrease) {
  Cushion c;
  const FrontEdgeId below = c.EdgeFrom(c.lower[1]);  // 1 → 0
  EXPECT_EQ(c.fronts.SidesOnCrease(below), 0);
  c.Fill(c.EdgeFrom(c.upper[0]));
  EXPECT_EQ(c.fronts.SidesOnCrease(below), 1);
  EXPECT_THAT(c.fronts.BareCreases(), SizeIs(4));
  c.Fill(c.EdgeFrom(c.lower[1]));
  EXPECT_EQ(FaultOf(c.fronts), "");
  EXPECT_THAT(c.fronts.BareCreases(), IsEmpty());
  EXPECT_EQ(c.fronts.front_edge_count(), 0u);
}

TEST(FrontSetJoints, FollowAFlip) {
  Cushion c;
  c.Fill(c.EdgeFrom(c.upper[0]));
  const auto filled = LiveTriangles(c.fronts);
  ASSERT_THAT(filled, SizeIs(2));
  for (int side = 0; side < 3; ++side) {
    if (!c.fronts.at(filled[0]).across[side].is_half_edge()) continue;
    c.fronts.Flip(Link::HalfEdge(filled[0], side));
    break;
  }
  EXPECT_EQ(FaultOf(c.fronts), "");
  EXPECT_FALSE(c.fronts.EdgeExists(c.lower[0], c.lower[2]));
  EXPECT_TRUE(c.fronts.EdgeExists(c.lower[1], c.lower[3]));
  EXPECT_THAT(c.fronts.BareCreases(), SizeIs(4)) << "the sides on the creases are the same";
}

TEST(FrontSetJoints, ForgetWhatIsTakenBack) {
  Cushion c;
  c.Fill(c.EdgeFrom(c.upper[0]));
  c.fronts.Remove(LiveTriangles(c.fronts));
  EXPECT_EQ(FaultOf(c.fronts), "");
  EXPECT_FALSE(c.fronts.EdgeExists(c.lower[0], c.lower[2]));
  EXPECT_TRUE(c.fronts.EdgeExists(c.lower[0], c.lower[1])) << "the crease stays one";
  EXPECT_THAT(c.fronts.BareCreases(), IsEmpty());
  EXPECT_EQ(c.fronts.SidesOnCrease(c.EdgeFrom(c.lower[1])), 0);
  EXPECT_TRUE(c.fronts.IsOnCrease(c.EdgeFrom(c.upper[0])));
  EXPECT_EQ(c.fronts.joint(0).vertices, 2u);
}

TEST(FrontSetJoints, RememberWhatIsSettledAndGone) {
  Cushion c;
  c.Fill(c.EdgeFrom(c.upper[0]));
  for (uint32_t joint = 0; joint < 4; ++joint) c.fronts.at(c.upper[joint]).emitted = VertexId(joint);
  c.fronts.Settle(LiveTriangles(c.fronts));
  EXPECT_TRUE(c.fronts.EdgeExists(c.lower[0], c.lower[2]));
  EXPECT_FALSE(c.fronts.EdgeExists(c.lower[1], c.lower[3]));
  EXPECT_EQ(c.fronts.SidesOnCrease(c.EdgeFrom(c.lower[1])), 1);
  EXPECT_THAT(c.fronts.BareCreases(), SizeIs(4));
}

TEST(FrontSetJoints, AreFinalisedWithTheLastPatchAroundThem) {
  Cushion c;
  c.Fill(c.EdgeFrom(c.upper[0]));
  for (uint32_t joint = 0; joint < 4; ++joint) {
    for (const WindowVertexId v : {c.upper[joint], c.lower[joint]}) c.fronts.at(v).emitted = VertexId(10 + joint);
  }
  EXPECT_THAT(c.fronts.Settle(LiveTriangles(c.fronts)), IsEmpty()) << "the lower side still needs all of them";
  c.Fill(c.EdgeFrom(c.lower[1]));
  const auto lower = LiveTriangles(c.fronts);
  EXPECT_THAT(c.fronts.Settle(std::vector{lower[0]}), SizeIs(1));
  EXPECT_THAT(c.fronts.Settle(std::vector{lower[1]}), SizeIs(3));
}

// --- Advanced --------------------------------------------------------------------------------------------------------------

// A unit sphere in two patches: 0 above the equator, 1 below; no walk leaves its half.
class SphereHalves : public DistanceSurface {
 public:
  SourcePoint Project(const Vec3& x, uint32_t patch) const override {
    Vec3 p = x;
    if (patch == 0 ? p.z < 0 : p.z > 0) p.z = 0;
    const Vec3 n = p == Vec3{} ? Vec3{1, 0, 0} : Normalized(p);
    return {n, n, patch};
  }
  double SignedDistance(const Vec3& x, uint32_t) const override { return Norm(x) - 1; }
  double MaxCurvatureAt(const SourcePoint&) const override { return 1; }
  uint32_t SheetOf(const SourcePoint& p) const override { return p.patch; }

  // Two loops of n edges along the equator.
  static std::vector<OrientedLoop> Loops(int n) {
    std::vector<OrientedLoop> loops(2);
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      const Vec3 p{std::cos(angle), std::sin(angle), 0};
      for (uint32_t patch = 0; patch < 2; ++patch) {
        loops[patch].points.push_back({p, p, patch});
        loops[patch].joints.push_back(static_cast<uint32_t>(i));
        loops[patch].creases.push_back(true);
      }
    }
    // Above, the open side is on the right of a clockwise loop.
    std::reverse(loops[0].points.begin(), loops[0].points.end());
    std::reverse(loops[0].joints.begin(), loops[0].joints.end());
    return loops;
  }
};

// The square [-2, 2]² in two patches: 0 where y > 0, 1 where y < 0.
class SquareHalves : public DistanceSurface {
 public:
  SourcePoint Project(const Vec3& x, uint32_t patch) const override {
    const auto into = [](double t, double low, double high) { return std::clamp(t, low, high); };
    return {{into(x.x, -2, 2), patch == 0 ? into(x.y, 0, 2) : into(x.y, -2, 0), 0}, {0, 0, 1}, patch};
  }
  double SignedDistance(const Vec3& x, uint32_t) const override { return x.z; }
  uint32_t SheetOf(const SourcePoint& p) const override { return p.patch; }

  // n edges on a side of 4; the crease runs along y = 0, from rim to rim.
  static std::vector<OrientedLoop> Loops(int n) {
    std::vector<OrientedLoop> loops;
    for (uint32_t patch = 0; patch < 2; ++patch) {
      const double up = patch == 0 ? 1 : -1;
      std::vector<Vec3> corners{{-2, 0, 0}, {-2, 2 * up, 0}, {2, 2 * up, 0}, {2, 0, 0}};
      if (patch == 1) std::reverse(corners.begin(), corners.end());
      OrientedLoop loop;
      for (int side = 0; side < 4; ++side) {
        const Vec3 &from = corners[side], &to = corners[(side + 1) % 4];
        const int steps = from.x == to.x ? n / 2 : n;
        for (int i = 0; i < steps; ++i) {
          const Vec3 p = Lerp(from, to, static_cast<double>(i) / steps);
          const bool on_crease = p.y == 0;
          loop.points.push_back({p, {0, 0, 1}, patch});
          loop.joints.push_back(on_crease ? static_cast<uint32_t>(std::lround((p.x + 2) * n / 4)) : kNoJoint);
          loop.creases.push_back(from.y == 0 && to.y == 0);
        }
      }
      loops.push_back(loop);
    }
    return loops;
  }
};

GuidanceField Uniform(double length) { return *GuidanceField::Create({}, {1.2, 0, length}, {}); }

struct Outcome {
  CheckingSink sink;
  absl::StatusOr<FrontReport> report = absl::UnknownError("not run");
};

Outcome Advance(const Surface& surface, const std::vector<OrientedLoop>& loops, double length,
                uint64_t max_triangles = 0) {
  Outcome run;
  FrontOptions options;
  options.max_triangles = max_triangles;
  run.report = AdvanceFront(surface, Uniform(length), loops, {}, options, run.sink, {});
  EXPECT_THAT(run.report, IsOk());
  EXPECT_THAT(run.sink.complaints(), IsEmpty());
  return run;
}

void ExpectReportMatches(const Outcome& run) {
  const TopologyReport measured = MeasureTopology(run.sink.mesh());
  EXPECT_EQ(run.report->vertices, measured.vertices);
  EXPECT_EQ(run.report->triangles, measured.triangles);
  EXPECT_EQ(run.report->components, measured.components);
  EXPECT_EQ(run.report->boundary_edges, measured.boundary_edges);
  EXPECT_EQ(run.report->boundary_loops, measured.boundary_loops);
  EXPECT_EQ(run.report->pinched_vertices == 0, measured.manifold);
}

bool HasDistinctPlaces(const TriangleMesh& mesh) {
  std::set<std::tuple<double, double, double>> places;
  for (const Vec3& p : mesh.positions) places.insert({p.x, p.y, p.z});
  return places.size() == mesh.positions.size();
}

TEST(AdvanceFrontJoints, CloseASphereOfTwoHalves) {
  for (const double length : {0.9, 0.4, 0.15}) {
    const int n = std::max(4, static_cast<int>(2 * std::numbers::pi / length));
    Outcome run = Advance(SphereHalves(), SphereHalves::Loops(n), length);
    run.sink.CheckEnd();
    EXPECT_THAT(run.sink.complaints(), IsEmpty()) << "no vertex is used after it was finalised, each is at last";
    ExpectReportMatches(run);
    EXPECT_THAT(run.report->open_places, IsEmpty());
    EXPECT_THAT(run.sink.mesh(), IsClosedManifold());
    EXPECT_THAT(run.sink.mesh(), HasGenus(0));
    EXPECT_THAT(run.sink.mesh(), HasNoSelfIntersection());
    EXPECT_TRUE(HasDistinctPlaces(run.sink.mesh())) << "a joint is one vertex, whichever side came first";
    const auto on_equator = [](const Vec3& p) { return p.z == 0; };
    EXPECT_EQ(std::count_if(run.sink.mesh().positions.begin(), run.sink.mesh().positions.end(), on_equator), n);
  }
}

TEST(AdvanceFrontJoints, ShareARimThatTheCreaseEndsOn) {
  for (const int n : {4, 12, 40}) {
    Outcome run = Advance(SquareHalves(), SquareHalves::Loops(n), 4.0 / n);
    run.sink.CheckEnd();
    EXPECT_THAT(run.sink.complaints(), IsEmpty());
    ExpectReportMatches(run);
    EXPECT_EQ(run.report->components, 1u);
    EXPECT_EQ(run.report->boundary_loops, 1u);
    EXPECT_EQ(run.report->boundary_edges, static_cast<uint64_t>(4 * n));
    EXPECT_THAT(run.sink.mesh(), IsManifold());
    EXPECT_TRUE(HasDistinctPlaces(run.sink.mesh()));
  }
}

// Stopped in the middle, with open places on either side of the crease or on both.
TEST(AdvanceFrontJoints, AreReportedAsTheyAreWhenTheFrontsAreStopped) {
  int open = 0;
  for (uint64_t limit = 1; limit < 1600; limit += 40) {
    SCOPED_TRACE("at most " + std::to_string(limit) + " triangles");
    Outcome sphere = Advance(SphereHalves(), SphereHalves::Loops(40), 0.15, limit);
    ExpectReportMatches(sphere);
    Outcome square = Advance(SquareHalves(), SquareHalves::Loops(40), 0.1, limit);
    ExpectReportMatches(square);
    open += !sphere.report->open_places.empty() + !square.report->open_places.empty();
  }
  EXPECT_GT(open, 20);
}

}  // namespace
}  // namespace meshfront
