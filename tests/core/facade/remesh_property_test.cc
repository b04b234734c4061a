// What must hold for every shape, rho and eta.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "core/geometry/bvh.h"
#include "core/guidance/sizing.h"
#include "core/remesh.h"
#include "tests/core/facade/grid_names.h"
#include "tests/core/facade/zoo.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

using ::testing::AllOf;
using ::testing::Combine;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Values;
using ::testing::ValuesIn;

struct Outcome {
  TriangleMesh mesh;
  Report report;
};

Outcome RemeshOrFail(const TriangleMesh& input, const RemeshOptions& options) {
  CheckingSink sink;
  absl::StatusOr<Report> report = Remesh({input, options}, sink, {});
  EXPECT_THAT(report, IsOk());
  if (!report.ok()) return {};
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  return {sink.mesh(), *std::move(report)};
}

RemeshOptions WithRhoEta(double rho, double eta) {
  RemeshOptions options;
  options.rho = rho;
  options.eta = eta;
  return options;
}

double LongestEdge(const TriangleMesh& mesh, const Triangle& t) {
  double longest = 0;
  for (int i = 0; i < 3; ++i)
    longest = std::max(longest, Distance(mesh.PositionAt(t[i]), mesh.PositionAt(t[(i + 1) % 3])));
  return longest;
}

// The largest distance from a triangle to the surface, over a lattice of 45 points of it.
double ForwardDistance(const TriangleMesh& mesh, const Triangle& t, const TriangleBvh& surface) {
  constexpr int kSteps = 8;
  double worst = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const double u = double(i) / kSteps, v = double(j) / kSteps;
      const Vec3 p = (1 - u - v) * mesh.PositionAt(t[0]) + u * mesh.PositionAt(t[1]) + v * mesh.PositionAt(t[2]);
      worst = std::max(worst, surface.FindClosestPoint(p)->squared_distance);
    }
  }
  return std::sqrt(worst);
}

// The report says of the output what can be counted in it.
void ExpectReportMatches(const Outcome& out) {
  const TopologyReport measured = MeasureTopology(out.mesh);
  EXPECT_EQ(out.report.output.triangles, measured.triangles);
  EXPECT_EQ(out.report.output.vertices, measured.vertices);
  EXPECT_EQ(out.report.output.components, measured.components);
  EXPECT_EQ(out.report.output.boundary_loops, measured.boundary_loops);
  EXPECT_EQ(out.report.output.genus, measured.genus);
  EXPECT_EQ(out.report.output.closed, measured.closed);
  const auto& kinds = out.report.triangles_by_kind;
  EXPECT_EQ(kinds.free + kinds.connection + kinds.closing, measured.triangles);
  EXPECT_TRUE(out.report.open_places.empty());
}

class EveryShape : public ::testing::TestWithParam<std::tuple<ZooShape, double, double>> {
 protected:
  const ZooShape& shape() const { return std::get<0>(GetParam()); }
  RemeshOptions options() const { return WithRhoEta(std::get<1>(GetParam()), std::get<2>(GetParam())); }
};

TEST_P(EveryShape, KeepsItsTopologyDoesNotIntersectItselfAndIsReportedAsItIs) {
  const TriangleMesh input = shape().make();
  const TopologyReport before = MeasureTopology(input);
  const Outcome out = RemeshOrFail(input, options());
  EXPECT_TRUE(out.report.complete);
  EXPECT_THAT(out.mesh, AllOf(IsManifold(), HasComponents(before.components), HasGenus(*before.genus),
                              HasBoundaryLoops(before.boundary_loops)));
  EXPECT_THAT(out.mesh, HasNoSelfIntersection());
  ExpectReportMatches(out);
}

// Triangles of a smooth surface are no farther from it than eq. 7 says for their own longest edge. What the input's facets are
// off the smooth surface comes on top, once for the vertices that lie on the facets and once for the distance measured to them.
class EverySmoothShape : public EveryShape {};
TEST_P(EverySmoothShape, StaysWithinTheErrorBoundOfEachTriangle) {
  const TriangleMesh input = shape().make();
  const TriangleBvh surface(input.positions, input.triangles);
  const double faceting = FacetingError(input, shape().max_curvature);
  const Outcome out = RemeshOrFail(input, options());
  int beyond = 0;
  double worst_share = 0;
  for (const Triangle& t : out.mesh.triangles) {
    const double bound = LongestEdge(out.mesh, t) * ErrorPerLength(options().rho) + 2 * faceting;
    const double share = ForwardDistance(out.mesh, t, surface) / bound;
    worst_share = std::max(worst_share, share);
    beyond += share > 1;
  }
  EXPECT_EQ(beyond, 0) << "of " << out.mesh.triangles.size() << " triangles; the worst is at " << worst_share
                       << " of its bound";
}

// A sphere with bumps of several sizes, in triangles about as large as those wanted: what no curvature at its vertices tells of.
TriangleMesh BumpySphere(int subdivisions) {
  return Mapped(Icosphere(subdivisions), [](const Vec3& p) {
    const double bumps =
        std::sin(7 * p.x) * std::sin(5 * p.y + 1) * std::sin(6 * p.z) + 0.3 * std::sin(19 * p.x - 17 * p.y);
    return (1 + 0.06 * bumps) * p;
  });
}

// Every triangle is as close to the surface as was asked for, and that costs neither topology nor shape.
TEST(MaxError, IsKeptByEveryTriangle) {
  for (const TriangleMesh& input :
       {BumpySphere(4), WithNoise(Icosphere(4), 0.01, 3), WavyTerrain(40), DiskWithHoles(40)}) {
    const TriangleBvh surface(input.positions, input.triangles);
    for (const double error : {0.006, 0.012}) {
      RemeshOptions options;
      options.sizing = Sizing::kError;
      options.max_error = Length{error, false};
      const Outcome out = RemeshOrFail(input, options);
      EXPECT_TRUE(out.report.complete);
      EXPECT_THAT(out.report.warnings, IsEmpty());
      EXPECT_EQ(out.report.error_bound, error);
      ExpectReportMatches(out);
      EXPECT_THAT(out.mesh, AllOf(IsManifold(), HasNoSelfIntersection(),
                                  HasBoundaryLoops(MeasureTopology(input).boundary_loops)));
      double worst = 0;
      for (const Triangle& t : out.mesh.triangles) worst = std::max(worst, ForwardDistance(out.mesh, t, surface));
      EXPECT_LE(worst, error) << "of " << out.mesh.triangles.size() << " triangles";
      EXPECT_GT(out.report.quality.radius_ratio_min, 0.2);
    }
  }
}

// Also where edges are given beforehand, and where the fit is in the way of no other part but the input itself.
TEST(MaxError, IsKeptAtBentCreasesAndWhereTheInputMeetsItself) {
  const TriangleMesh crown = Mapped(CappedCylinder(1, 1, 32, 8), [](const Vec3& p) {
    return Vec3{p.x, p.y, p.z * (1 + 0.3 * std::sin(5 * std::atan2(p.y, p.x)))};
  });
  const TriangleMesh shapes[] = {crown, Joined(Icosphere(4), Moved(Icosphere(4), {0.9, 0.1, 0}))};
  for (const TriangleMesh& input : shapes) {
    const TriangleBvh surface(input.positions, input.triangles);
    for (const double error : {0.003, 0.008}) {
      RemeshOptions options;
      options.sizing = Sizing::kError;
      options.max_error = Length{error, false};
      const Outcome out = RemeshOrFail(input, options);
      if (&input == &shapes[0])
        EXPECT_THAT(out.report.warnings, IsEmpty());
      else
        EXPECT_THAT(out.report.warnings, ElementsAre(HasSubstr("the input meets itself")));
      double worst = 0;
      for (const Triangle& t : out.mesh.triangles) worst = std::max(worst, ForwardDistance(out.mesh, t, surface));
      EXPECT_LE(worst, 0.98 * error) << "of " << out.mesh.triangles.size() << " triangles";
    }
  }
}

// A number of triangles leaves room for the worst places only, and says how far off the others are.
TEST(MaxError, IsWhatTheReportBoundsWhereACountIsWanted) {
  const TriangleMesh input = BumpySphere(5);
  RemeshOptions options;
  options.sizing = Sizing::kError;
  options.target_triangles = 4000;
  const Outcome out = RemeshOrFail(input, options);
  EXPECT_THAT(out.report.warnings, IsEmpty());
  const TriangleBvh surface(input.positions, input.triangles);
  double worst = 0;
  for (const Triangle& t : out.mesh.triangles) worst = std::max(worst, ForwardDistance(out.mesh, t, surface));
  EXPECT_LE(worst, 1.05 * out.report.error_bound) << "as measured, where it is not certified";
  EXPECT_LE(out.report.error_bound, 3 * out.report.parameters.options.max_error->value);
  EXPECT_NEAR(static_cast<double>(out.mesh.triangles.size()) / 4000, 1, 0.05);
  // Where nothing is far beyond it, what is a little is not told apart.
  const Report smooth = RemeshOrFail(Icosphere(5), options).report;
  EXPECT_GT(smooth.error_bound, 1.25 * smooth.parameters.options.max_error->value);
  EXPECT_THAT(smooth.warnings, IsEmpty());
}

#ifdef MESHFRONT_COARSE_ZOO
const std::vector<double> kRhos{0.8}, kEtas{1.2};
#else
const std::vector<double> kRhos{0.4, 0.8, 1.4}, kEtas{1.2, 1.5};
#endif
INSTANTIATE_TEST_SUITE_P(Zoo, EveryShape, Combine(ValuesIn(Zoo()), ValuesIn(kRhos), ValuesIn(kEtas)),
                         NameOfGridCase<ZooShape>);
INSTANTIATE_TEST_SUITE_P(Zoo, EverySmoothShape, Combine(ValuesIn(SmoothZoo()), ValuesIn(kRhos), Values(1.2)),
                         NameOfGridCase<ZooShape>);

// A smooth shape at the default options gives triangles as good as the table asks of real models.
TEST(RemeshQuality, IsThatOfTheTableOnSmoothShapes) {
  for (const ZooShape& shape : SmoothZoo()) {
    SCOPED_TRACE(shape.name);
    const Outcome out = RemeshOrFail(shape.make(), WithRhoEta(0.5, 1.2));
    EXPECT_GE(out.report.quality.radius_ratio_median, 0.97);
    EXPECT_GE(out.report.quality.radius_ratio_p0_5, 0.70);
    EXPECT_GE(out.report.quality.radius_ratio_min, 0.20);
  }
}

TEST(RemeshSizing, GivesASphereTrianglesOfTheIdealLength) {
  // A unit sphere: l = 2 sin(rho / 2) everywhere. At a sample g is l/η, one edge away it is l (eq. 2 and 5), so that edges
  // lie between the two.
  const double rho = 0.3;
  const Outcome out = RemeshOrFail(Icosphere(5), WithRhoEta(rho, 1.2));
  std::vector<double> lengths;
  for (const Triangle& t : out.mesh.triangles) {
    for (int i = 0; i < 3; ++i)
      lengths.push_back(Distance(out.mesh.PositionAt(t[i]), out.mesh.PositionAt(t[(i + 1) % 3])));
  }
  std::nth_element(lengths.begin(), lengths.begin() + lengths.size() / 2, lengths.end());
  EXPECT_GE(lengths[lengths.size() / 2], 0.98 * IdealLength(rho, 1) / 1.2);
  EXPECT_LE(lengths[lengths.size() / 2], IdealLength(rho, 1));
}

TEST(RemeshSizing, MakesAllEdgesAlikeWhenUniform) {
  RemeshOptions options;
  options.sizing = Sizing::kUniform;
  options.edge_length = Length{0.08, false};
  const Outcome out = RemeshOrFail(Torus(1, 0.4, 120, 48), options);
  double sum = 0;
  for (const Triangle& t : out.mesh.triangles) sum += Distance(out.mesh.PositionAt(t[0]), out.mesh.PositionAt(t[1]));
  EXPECT_NEAR(sum / out.mesh.triangles.size(), 0.08, 0.004);
}

TEST(RemeshSizing, NeverExceedsTheLongestEdgeAsked) {
  RemeshOptions options;
  options.max_edge = Length{0.1, false};
  const Outcome out = RemeshOrFail(Sheet(20), options);
  double longest = 0;
  for (const Triangle& t : out.mesh.triangles) longest = std::max(longest, LongestEdge(out.mesh, t));
  EXPECT_LE(longest, 0.1 * 1.5);
  EXPECT_GT(out.mesh.triangles.size(), 700u);  // 4 / (√3/4 · 0.1²) is 924
}

// Ends of the edges with one triangle.
std::vector<std::pair<Vec3, Vec3>> RimEdges(const TriangleMesh& mesh) {
  std::map<std::pair<VertexId, VertexId>, int> uses;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++uses[std::minmax(t[i], t[(i + 1) % 3])];
  }
  std::vector<std::pair<Vec3, Vec3>> rim;
  for (const auto& [edge, count] : uses) {
    if (count == 1) rim.push_back({mesh.PositionAt(edge.first), mesh.PositionAt(edge.second)});
  }
  return rim;
}

TEST(RemeshBoundary, KeepsTheVerticesOfARimOnTheRim) {
  // A dome with holes: each rim vertex of the output lies on a rim edge of the input.
  const TriangleMesh input = DiskWithHoles();
  const Outcome out = RemeshOrFail(input, WithRhoEta(0.4, 1.2));
  const auto before = RimEdges(input), after = RimEdges(out.mesh);
  ASSERT_GT(after.size(), 20u);
  for (const auto& [p, unused] : after) {
    double nearest = 1;
    for (const auto& [a, b] : before) {
      const double t = std::clamp(Dot(p - a, b - a) / SquaredDistance(a, b), 0.0, 1.0);
      nearest = std::min(nearest, Distance(p, Lerp(a, b, t)));
    }
    EXPECT_LT(nearest, 1e-12);
  }
}

TEST(RemeshRepair, ClosesASoupOfTrianglesFirst) {
  const Outcome out = RemeshOrFail(Soup(Icosphere(4)), WithRhoEta(0.4, 1.2));
  EXPECT_THAT(out.mesh, AllOf(IsClosedManifold(), HasGenus(0), HasComponents(1)));
  EXPECT_FALSE(out.report.input.repairs.empty());
}

// As grown: the kind of every triangle, and its corners as (base end, base start, apex).
class KindSink : public CollectingSink {
 public:
  absl::Status Append(const MeshPiece& piece) override {
    kinds.insert(kinds.end(), piece.kinds.begin(), piece.kinds.end());
    return CollectingSink::Append(piece);
  }
  std::vector<TriangleKind> kinds;
};

// Sec. 3: two edges of a free triangle that grew from a free edge differ by a factor of eta at most.
void ExpectRatioOfFreeTriangles(const TriangleMesh& mesh, const std::vector<TriangleKind>& kinds, double eta) {
  ASSERT_EQ(kinds.size(), mesh.triangles.size());
  std::set<std::pair<VertexId, VertexId>> free_edges;
  for (size_t f = 0; f < kinds.size(); ++f) {
    const auto& [end, start, apex] = mesh.triangles[f];
    if (kinds[f] == TriangleKind::kFree) free_edges.insert({std::minmax(end, apex), std::minmax(start, apex)});
  }
  size_t checked = 0;
  for (size_t f = 0; f < kinds.size(); ++f) {
    const auto& [end, start, apex] = mesh.triangles[f];
    if (kinds[f] != TriangleKind::kFree || !free_edges.contains(std::minmax(end, start))) continue;
    const auto [shortest, longest] = std::minmax({Distance(mesh.PositionAt(end), mesh.PositionAt(start)),
                                                  Distance(mesh.PositionAt(start), mesh.PositionAt(apex)),
                                                  Distance(mesh.PositionAt(apex), mesh.PositionAt(end))});
    EXPECT_LE(longest, eta * shortest * (1 + 1e-6)) << "triangle " << f;
    ++checked;
  }
  EXPECT_GT(checked, kinds.size() / 20);
}

TEST(RemeshGrading, KeepsTheRatioEtaInEveryFreeTriangleOnAFreeEdge) {
  for (const double eta : {1.2, 1.5}) {
    RemeshOptions options = WithRhoEta(0.25, eta);
    options.flips = options.smooth = options.fit = false;
    for (const TriangleMesh& input : {Torus(1, 0.4, 120, 48), Ellipsoid(5, {2, 1, 0.5}), GenusThree(64)}) {
      KindSink sink;
      ASSERT_THAT(Remesh({input, options}, sink, {}), IsOk());
      ExpectRatioOfFreeTriangles(sink.mesh, sink.kinds, eta);
    }
  }
}

TEST(RemeshUnits, ScalesExactlyWithTheInput) {
  // A power of two scales every number without rounding, so nothing may change but the exponent.
  const TriangleMesh input = Torus(1, 0.4, 80, 32);
  const Outcome one = RemeshOrFail(input, WithRhoEta(0.6, 1.2));
  for (const double factor : {0x1p-20, 0x1p12}) {
    const Outcome scaled = RemeshOrFail(Scaled(input, factor), WithRhoEta(0.6, 1.2));
    EXPECT_EQ(scaled.mesh.triangles, one.mesh.triangles) << "factor " << factor;
    EXPECT_EQ(scaled.mesh.positions, Scaled(one.mesh, factor).positions) << "factor " << factor;
  }
}

}  // namespace
}  // namespace meshfront::testing
