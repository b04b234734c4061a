#include "core/front/advancing_front.h"

#include <atomic>
#include <map>
#include <numbers>
#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/front/fake_surfaces.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using meshfront::testing::CheckingSink;
using meshfront::testing::DistanceSurface;
using meshfront::testing::HasBoundaryLoops;
using meshfront::testing::HasComponents;
using meshfront::testing::HasGenus;
using meshfront::testing::HasNoSelfIntersection;
using meshfront::testing::IsClosedManifold;
using meshfront::testing::IsManifold;
using meshfront::testing::IsOk;
using meshfront::testing::PlaneSurface;
using meshfront::testing::SphereSurface;
using meshfront::testing::StatusIs;
using meshfront::testing::TorusSurface;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr FrontOptions kPlain{.flips = false, .smooth = false, .fit = false};

GuidanceField Uniform(double length, double eta = 1.2) { return *GuidanceField::Create({}, {eta, 0, length}, {}); }

// From `fine` at one place to five times as much far away, as fast as eta allows.
GuidanceField Graded(double fine, const Vec3& place, double eta) {
  return *GuidanceField::Create({{place, fine * eta}}, {eta, 0, 5 * fine}, {});
}

// Along a circle in the plane z = 0; the open side lies outside when it runs counter-clockwise.
OrientedLoop Circle(const Vec3& center, double radius, int n, bool counter_clockwise) {
  OrientedLoop loop;
  for (int i = 0; i < n; ++i) {
    const double angle = (counter_clockwise ? 2 : -2) * std::numbers::pi * i / n;
    loop.points.push_back({center + radius * Vec3{std::cos(angle), std::sin(angle), 0}, {0, 0, 1}, 0});
  }
  return loop;
}

struct Outcome {
  CheckingSink sink;
  absl::StatusOr<FrontReport> report = absl::UnknownError("not run");
};

void ExpectKeepsItsPromises(Outcome& run) {
  ASSERT_THAT(run.report, IsOk());
  run.sink.CheckEnd();
  EXPECT_THAT(run.sink.complaints(), IsEmpty());
  EXPECT_THAT(run.report->open_places, IsEmpty());
  EXPECT_EQ(run.report->triangles, run.sink.mesh().triangles.size());
  EXPECT_EQ(run.report->vertices, run.sink.mesh().positions.size());
  EXPECT_EQ(run.report->free_triangles + run.report->connection_triangles + run.report->closing_triangles,
            run.report->triangles);
  EXPECT_EQ(run.report->components, MeasureTopology(run.sink.mesh()).components);
  EXPECT_EQ(run.report->boundary_edges, MeasureTopology(run.sink.mesh()).boundary_edges);
  EXPECT_EQ(run.report->boundary_loops, MeasureTopology(run.sink.mesh()).boundary_loops);
}

struct Setting {
  FrontOptions options;
  double length;
};

std::ostream& operator<<(std::ostream& out, const Setting& s) { return out << "length " << s.length; }

class AdvanceFrontShapes : public ::testing::TestWithParam<Setting> {
 protected:
  Outcome Run(const Surface& surface, const std::vector<OrientedLoop>& loops, const std::vector<SourcePoint>& seeds) {
    Outcome run;
    run.report = AdvanceFront(surface, Uniform(GetParam().length), loops, seeds, GetParam().options, run.sink, {});
    return run;
  }
};

TEST_P(AdvanceFrontShapes, ClosesASphere) {
  const SphereSurface sphere;
  Outcome run = Run(sphere, {}, {sphere.Project({1, 0, 0}, 0)});
  ExpectKeepsItsPromises(run);
  EXPECT_THAT(run.sink.mesh(), IsClosedManifold());
  EXPECT_THAT(run.sink.mesh(), HasGenus(0));
  EXPECT_THAT(run.sink.mesh(), HasNoSelfIntersection());
}

TEST_P(AdvanceFrontShapes, ClosesATorus) {
  const TorusSurface torus(2, 0.7);
  Outcome run = Run(torus, {}, {torus.Project({2.7, 0, 0}, 0)});
  ExpectKeepsItsPromises(run);
  EXPECT_THAT(run.sink.mesh(), IsClosedManifold());
  EXPECT_THAT(run.sink.mesh(), HasGenus(1));
  EXPECT_THAT(run.sink.mesh(), HasNoSelfIntersection());
}

TEST_P(AdvanceFrontShapes, FillsADiskFromItsRim) {
  const PlaneSurface plane(2);
  const int n = static_cast<int>(4 * std::numbers::pi / GetParam().length);
  Outcome run = Run(plane, {Circle({}, 2, n, false)}, {});
  ExpectKeepsItsPromises(run);
  EXPECT_THAT(run.sink.mesh(), IsManifold());
  EXPECT_THAT(run.sink.mesh(), HasGenus(0));
  EXPECT_EQ(MeasureTopology(run.sink.mesh()).boundary_edges, static_cast<uint64_t>(n));
  EXPECT_THAT(run.sink.mesh(), HasNoSelfIntersection());
}

TEST_P(AdvanceFrontShapes, KeepsAHoleAsALoopOfItsOwn) {
  const Vec3 hole{0.5, 0.2, 0};
  const PlaneSurface plane(2, 0.5, hole);
  const double length = GetParam().length;
  const std::vector<OrientedLoop> loops = {Circle({}, 2, static_cast<int>(4 * std::numbers::pi / length), false),
                                           Circle(hole, 0.5, static_cast<int>(std::numbers::pi / length), true)};
  Outcome run = Run(plane, loops, {});
  ExpectKeepsItsPromises(run);
  EXPECT_THAT(run.sink.mesh(), IsManifold());
  EXPECT_THAT(run.sink.mesh(), HasBoundaryLoops(2));
  EXPECT_THAT(run.sink.mesh(), HasGenus(0));
  EXPECT_THAT(run.sink.mesh(), HasNoSelfIntersection());
  for (const Triangle& t : run.sink.mesh().triangles) {
    for (const VertexId v : t)
      EXPECT_GE(Distance(run.sink.mesh().PositionAt(v), hole), 0.5 - 1e-9) << "a vertex in the hole";
  }
}

TEST_P(AdvanceFrontShapes, KeepsTheRimsVerticesWhereTheyAre) {
  const PlaneSurface plane(2);
  const OrientedLoop rim = Circle({}, 2, static_cast<int>(4 * std::numbers::pi / GetParam().length), false);
  Outcome run = Run(plane, {rim}, {});
  ASSERT_THAT(run.report, IsOk());
  const auto& positions = run.sink.mesh().positions;
  for (const SourcePoint& p : rim.points) EXPECT_EQ(std::count(positions.begin(), positions.end(), p.position), 1);
}

TEST_P(AdvanceFrontShapes, ClosesTwoComponentsFromTwoSeeds) {
  const SphereSurface spheres;
  Outcome run = Run(spheres, {}, {spheres.Project({1, 0, 0}, 0), spheres.Project({5, 0, 0}, 1)});
  ExpectKeepsItsPromises(run);
  EXPECT_THAT(run.sink.mesh(), IsClosedManifold());
  EXPECT_THAT(run.sink.mesh(), HasComponents(2));
  EXPECT_THAT(run.sink.mesh(), HasGenus(0));
}

TEST_P(AdvanceFrontShapes, JoinsTwoFrontsOfOneComponent) {
  const SphereSurface sphere;
  Outcome run = Run(sphere, {}, {sphere.Project({1, 0, 0}, 0), sphere.Project({-1, 0, 0}, 0)});
  ExpectKeepsItsPromises(run);
  EXPECT_THAT(run.sink.mesh(), IsClosedManifold());
  EXPECT_THAT(run.sink.mesh(), HasComponents(1));
}

INSTANTIATE_TEST_SUITE_P(All, AdvanceFrontShapes,
                         ::testing::Values(Setting{{}, 0.2}, Setting{{}, 0.07}, Setting{kPlain, 0.2},
                                           Setting{kPlain, 0.07}, Setting{{.flips = false}, 0.1},
                                           Setting{{.smooth = false}, 0.1}, Setting{{.fit = false}, 0.1}),
                         [](const auto& info) {
                           const FrontOptions& o = info.param.options;
                           return std::string(o.flips ? "Flips" : "") + (o.smooth ? "Smooth" : "") +
                                  (o.fit ? "Fit" : "") + "At" +
                                  std::to_string(static_cast<int>(std::lround(1000 * info.param.length)));
                         });

// Coarse fronts on a small sphere: a handful of triangles, down to a tetrahedron.
TEST(AdvanceFront, ClosesASphereOfAHandfulOfTriangles) {
  const SphereSurface sphere;
  for (double length = 0.5; length < 1.7; length += 0.05) {
    Outcome run;
    run.report = AdvanceFront(sphere, Uniform(length), {}, {sphere.Project({0, 0, 1}, 0)}, {}, run.sink, {});
    SCOPED_TRACE(length);
    ASSERT_THAT(run.report, IsOk());
    EXPECT_THAT(run.sink.complaints(), IsEmpty());
    EXPECT_EQ(MeasureTopology(run.sink.mesh()).closed, run.report->open_places.empty());
    EXPECT_TRUE(run.report->open_places.empty() || length > 1.2);
  }
}

// --- The ratio of incident edges -------------------------------------------------------------------------------------------

class KeepsKinds : public CheckingSink {
 public:
  absl::Status Append(const MeshPiece& piece) override {
    EXPECT_EQ(piece.kinds.size(), piece.triangles.size());
    kinds.insert(kinds.end(), piece.kinds.begin(), piece.kinds.end());
    return CheckingSink::Append(piece);
  }
  std::vector<TriangleKind> kinds;
};

using Edge = std::pair<VertexId, VertexId>;
Edge Undirected(VertexId a, VertexId b) { return std::minmax(a, b); }

// Of the free triangles whose base is a free edge: how many, and the greatest ratio of their sides.
std::pair<int, double> WorstRatio(const TriangleMesh& mesh, const std::vector<TriangleKind>& kinds) {
  std::set<Edge> free_edges;
  for (size_t i = 0; i < kinds.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (kinds[i] == TriangleKind::kFree) free_edges.insert({Undirected(t[0], t[2]), Undirected(t[1], t[2])});
  }
  std::pair<int, double> worst = {0, 1};
  for (size_t i = 0; i < kinds.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (kinds[i] != TriangleKind::kFree || free_edges.count(Undirected(t[0], t[1])) == 0) continue;
    const auto [least, greatest] = std::minmax({Distance(mesh.PositionAt(t[0]), mesh.PositionAt(t[1])),
                                                Distance(mesh.PositionAt(t[1]), mesh.PositionAt(t[2])),
                                                Distance(mesh.PositionAt(t[2]), mesh.PositionAt(t[0]))});
    ++worst.first;
    worst.second = std::max(worst.second, greatest / least);
  }
  return worst;
}

TEST(AdvanceFront, KeepsTheRatioEtaInFreeTrianglesOnFreeEdges) {
  for (const double eta : {1.1, 1.2, 1.5, 1.9}) {
    SCOPED_TRACE(eta);
    const SphereSurface sphere;
    const TorusSurface torus(2, 0.7);
    KeepsKinds on_sphere, on_torus;
    const auto first =
        AdvanceFront(sphere, Graded(0.03, {0, 0, 1}, eta), {}, {sphere.Project({1, 0, 0}, 0)}, kPlain, on_sphere, {});
    const auto second =
        AdvanceFront(torus, Graded(0.05, {0, 1.3, 0}, eta), {}, {torus.Project({2.7, 0, 0}, 0)}, kPlain, on_torus, {});
    ASSERT_THAT(first, IsOk());
    ASSERT_THAT(second, IsOk());
    EXPECT_THAT(on_sphere.mesh(), IsClosedManifold());
    EXPECT_THAT(on_torus.mesh(), IsClosedManifold());
    for (const KeepsKinds* sink : {&on_sphere, &on_torus}) {
      const auto [count, ratio] = WorstRatio(sink->mesh(), sink->kinds);
      EXPECT_GT(count, 200);
      EXPECT_GT(ratio, 1.02) << "the field was not graded";
      EXPECT_LE(ratio, eta * (1 + 1e-8));
    }
  }
}

// --- Stopping ------------------------------------------------------------------------------------------------------------

class FailsAfter : public MeshSink {
 public:
  explicit FailsAfter(int pieces) : pieces_(pieces) {}
  absl::Status Append(const MeshPiece&) override {
    ++calls;
    return --pieces_ < 0 ? absl::DataLossError("the reader has left") : absl::OkStatus();
  }
  int calls = 0;

 private:
  int pieces_;
};

class CancelsAfter : public MeshSink {
 public:
  explicit CancelsAfter(int pieces) : pieces_(pieces) {}
  absl::Status Append(const MeshPiece&) override {
    ++calls;
    if (--pieces_ == 0) stop = true;
    return absl::OkStatus();
  }
  std::atomic<bool> stop = false;
  int calls = 0;

 private:
  int pieces_;
};

TEST(AdvanceFront, PassesTheSinksStatusOn) {
  const SphereSurface sphere;
  for (const int pieces : {0, 1, 3}) {
    FailsAfter sink(pieces);
    const auto report = AdvanceFront(sphere, Uniform(0.04), {}, {sphere.Project({1, 0, 0}, 0)}, kPlain, sink, {});
    EXPECT_THAT(report, StatusIs(absl::StatusCode::kDataLoss, "the reader has left"));
    EXPECT_EQ(sink.calls, pieces + 1) << "nothing is sent after a failure";
  }
}

TEST(AdvanceFront, LeavesWhenItIsCancelledBeforeItStarts) {
  const SphereSurface sphere;
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  CheckingSink sink;
  EXPECT_THAT(AdvanceFront(sphere, Uniform(0.1), {}, {sphere.Project({1, 0, 0}, 0)}, {}, sink, context),
              StatusIs(absl::StatusCode::kCancelled, ""));
  EXPECT_EQ(sink.pieces, 0);
}

TEST(AdvanceFront, LeavesWhenItIsCancelledInTheMiddle) {
  const SphereSurface sphere;
  for (const FrontOptions& options : {FrontOptions{}, kPlain}) {
    CancelsAfter sink(2);
    Context context;
    context.stop = &sink.stop;
    EXPECT_THAT(AdvanceFront(sphere, Uniform(0.03), {}, {sphere.Project({1, 0, 0}, 0)}, options, sink, context),
                StatusIs(absl::StatusCode::kCancelled, ""));
    EXPECT_EQ(sink.calls, 2);
  }
}

TEST(AdvanceFront, LeavesAtItsDeadline) {
  const SphereSurface sphere;
  Context context;
  context.deadline = absl::InfinitePast();
  CheckingSink sink;
  EXPECT_THAT(AdvanceFront(sphere, Uniform(0.1), {}, {sphere.Project({1, 0, 0}, 0)}, {}, sink, context),
              StatusIs(absl::StatusCode::kDeadlineExceeded, ""));
}

// --- Streaming -----------------------------------------------------------------------------------------------------------

TEST(AdvanceFront, SendsPiecesWhileItAdvances) {
  const TorusSurface torus(2, 0.7);
  Outcome run;
  std::vector<Progress> progress;
  Context context;
  context.progress = [&](const Progress& p) { progress.push_back(p); };
  run.report = AdvanceFront(torus, Uniform(0.05), {}, {torus.Project({2.7, 0, 0}, 0)}, {.predicted_triangles = 17},
                            run.sink, context);
  ExpectKeepsItsPromises(run);
  EXPECT_GE(run.sink.pieces, 5);
  ASSERT_GE(progress.size(), 5u);
  for (size_t i = 0; i < progress.size(); ++i) {
    EXPECT_EQ(progress[i].predicted_triangles, 17u);
    EXPECT_EQ(progress[i].stage, Stage::kMesh);
    EXPECT_GE(progress[i].triangles, progress[i > 0 ? i - 1 : 0].triangles);
  }
  EXPECT_EQ(progress.back().triangles, run.report->triangles);
  EXPECT_EQ(progress.back().open_front_edges, 0u);
}

TEST(AdvanceFront, FinalisesEveryVertexExactlyOnce) {
  class Counts : public MeshSink {
   public:
    absl::Status Append(const MeshPiece& piece) override {
      for (const VertexId v : piece.finalised) ++times[v];
      vertices += piece.vertices.size();
      return absl::OkStatus();
    }
    std::map<VertexId, int> times;
    size_t vertices = 0;
  };
  const TorusSurface torus(2, 0.7);
  for (const FrontOptions& options : {FrontOptions{}, kPlain}) {
    Counts sink;
    ASSERT_THAT(AdvanceFront(torus, Uniform(0.09), {}, {torus.Project({2.7, 0, 0}, 0)}, options, sink, {}), IsOk());
    EXPECT_EQ(sink.times.size(), sink.vertices);
    for (const auto& [v, times] : sink.times) EXPECT_EQ(times, 1) << v.index();
  }
}

TEST(AdvanceFront, GivesTheSameBitsTwice) {
  const TorusSurface torus(2, 0.7);
  CheckingSink first, second;
  for (CheckingSink* sink : {&first, &second}) {
    ASSERT_THAT(AdvanceFront(torus, Graded(0.04, {0, 1.3, 0}, 1.2), {}, {torus.Project({2.7, 0, 0}, 0)}, {}, *sink, {}),
                IsOk());
  }
  EXPECT_EQ(first.pieces, second.pieces);
  EXPECT_TRUE(first.mesh().positions == second.mesh().positions);
  EXPECT_TRUE(first.mesh().normals == second.mesh().normals);
  EXPECT_TRUE(first.mesh().triangles == second.mesh().triangles);
}

TEST(AdvanceFront, DoesNothingWithoutLoopsAndSeeds) {
  Outcome run;
  run.report = AdvanceFront(SphereSurface(), Uniform(0.1), {}, {}, {}, run.sink, {});
  ASSERT_THAT(run.report, IsOk());
  EXPECT_EQ(run.report->triangles, 0u);
  EXPECT_EQ(run.report->components, 0u);
}

TEST(AdvanceFront, MakesOneTriangleOfARimOfThree) {
  Outcome run;
  run.report = AdvanceFront(PlaneSurface(1), Uniform(2), {Circle({}, 1, 3, false)}, {}, {}, run.sink, {});
  ExpectKeepsItsPromises(run);
  EXPECT_EQ(run.report->triangles, 1u);
  EXPECT_EQ(run.report->closing_triangles, 1u);
}

// --- The ladder ----------------------------------------------------------------------------------------------------------

// A sphere on which no apex is found, and no triangle stands for it whose sides are longer than `finest`, around a place.
class RoughSphere : public SphereSurface {
 public:
  RoughSphere(const Vec3& place, double radius, double finest) : place_(place), radius_(radius), finest_(finest) {}
  std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double ra, double rb) const override {
    if (Distance(a.position, place_) < radius_ && std::max(ra, rb) > finest_) return std::nullopt;
    return SphereSurface::FindApex(a, b, ra, rb);
  }
  bool Covers(const Vec3& x) const { return Distance(x, place_) < radius_; }
  bool LeansAt(const Vec3& x) const { return Distance(x, place_) < 1.5 * radius_; }
  // Its normals lean there and next to it: an ear that they agree with would stand for it unasked.
  SourcePoint Project(const Vec3& x, uint32_t patch) const override {
    SourcePoint p = SphereSurface::Project(x, patch);
    if (LeansAt(p.position)) p.normal = Normalized(p.normal + 0.6 * Normalized(Cross(p.normal, Vec3{1, 0, 0})));
    return p;
  }
  SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override {
    SourcePoint x = SphereSurface::Snap(start, target);
    // What lies between the corners of a long triangle finds its way to the surface lost, to its other side.
    if (Distance(x.position, place_) < radius_ && Distance(start.position, target) > 0.5 * finest_)
      return SphereSurface::Snap(start, -1.0 * target);
    return x;
  }

 private:
  Vec3 place_;
  double radius_, finest_;
};

TEST(AdvanceFront, TakesAPlaceBackAndAdvancesAtFinerSteps) {
  const RoughSphere sphere({0, 0, -1}, 0.5, 0.17);
  Outcome run;
  run.report = AdvanceFront(sphere, Uniform(0.2), {}, {sphere.Project({0, 0, 1}, 0)}, {}, run.sink, {});
  ExpectKeepsItsPromises(run);
  EXPECT_GT(run.report->roll_backs, 0u);
  EXPECT_THAT(run.sink.mesh(), IsClosedManifold());
  EXPECT_THAT(run.sink.mesh(), HasGenus(0));
}

// The first triangles of a component are all that there is within the rings that are taken back.
TEST(AdvanceFront, DoesNotLoseAComponentThatIsTakenBackWhole) {
  const RoughSphere rough({4, 0, 1}, 3, 0.3);  // the second sphere is rough everywhere
  class SeedsOnly : public RoughSphere {
   public:
    using RoughSphere::RoughSphere;
    std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double ra,
                                        double rb) const override {
      if (calls_-- > 0) return SphereSurface::FindApex(a, b, ra, rb);
      return RoughSphere::FindApex(a, b, ra, rb);
    }
    mutable int calls_ = 1;
  };
  for (const bool alone : {true, false}) {
    const SeedsOnly surface({4, 0, 1}, 3, 0.3);
    std::vector<SourcePoint> seeds = {surface.Project({4, 0, 1}, 1)};
    if (!alone) seeds.push_back(surface.Project({0, 0, 1}, 0));
    Outcome run;
    run.report = AdvanceFront(surface, Uniform(0.5), {}, seeds, {}, run.sink, {});
    ASSERT_THAT(run.report, IsOk());
    EXPECT_THAT(run.sink.complaints(), IsEmpty());
    EXPECT_GT(run.report->roll_backs, 0u);
    EXPECT_EQ(MeasureTopology(run.sink.mesh()).components, seeds.size());
    EXPECT_EQ(MeasureTopology(run.sink.mesh()).closed, run.report->open_places.empty());
  }
}

// A sphere with a place where nothing can be placed and nothing stands for the surface, too wide for a closure.
TEST(AdvanceFront, ReportsAPlaceThatItCouldNotClose) {
  const RoughSphere sphere({0, 0, -1}, 0.6, 1e-6);
  CheckingSink sink;
  const auto report = AdvanceFront(sphere, Uniform(0.04), {}, {sphere.Project({0, 0, 1}, 0)}, kPlain, sink, {});
  ASSERT_THAT(report, IsOk());
  EXPECT_THAT(sink.complaints(), IsEmpty());
  const TopologyReport topology = MeasureTopology(sink.mesh());
  ASSERT_THAT(report->open_places, Not(IsEmpty()));
  for (const Vec3& place : report->open_places) EXPECT_LT(Distance(place, {0, 0, -1}), 0.8);
  EXPECT_THAT(sink.mesh(), IsManifold());
  EXPECT_EQ(report->boundary_edges, topology.boundary_edges);
  EXPECT_EQ(report->boundary_loops, topology.boundary_loops);
  EXPECT_EQ(report->pinched_vertices, 0u);
}

// The same with a second place beside it, where shorter edges help: one loop runs around both. The ladder has to climb there as well,
// wherever it has come to its end first.
TEST(AdvanceFront, ClosesWhatItCanOfALoopThatItCannotCloseElsewhere) {
  constexpr double kLength = 0.06;
  class TwoPlaces : public SphereSurface {
   public:
    explicit TwoPlaces(const Vec3& mendable)
        : hopeless_({0, 0, -1}, 0.7, 1e-6), mendable_(mendable, 0.25, 0.85 * kLength) {}
    std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double ra,
                                        double rb) const override {
      const RoughSphere& here = hopeless_.Covers(a.position) ? hopeless_ : mendable_;
      const std::optional<SourcePoint> apex = here.FindApex(a, b, ra, rb);
      return apex ? std::optional(Project(apex->position, apex->patch)) : std::nullopt;
    }
    SourcePoint Project(const Vec3& x, uint32_t patch) const override {
      return (hopeless_.LeansAt(x) ? hopeless_ : mendable_).Project(x, patch);
    }
    SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override {
      const SourcePoint x = hopeless_.Snap(start, target);
      if (Dot(x.normal, start.normal) < 0) return x;
      const SourcePoint y = mendable_.Snap(start, target);
      return Dot(y.normal, start.normal) < 0 ? y : Project(y.position, y.patch);
    }

   private:
    RoughSphere hopeless_, mendable_;
  };
  for (const double angle : {0.0, 3.0}) {
    const Vec3 mendable = Normalized(Vec3{0.8 * std::cos(angle), 0.8 * std::sin(angle), -0.6});
    CheckingSink sink;
    const auto report = AdvanceFront(TwoPlaces(mendable), Uniform(kLength), {}, {SphereSurface().Project({0, 0, 1}, 0)},
                                     kPlain, sink, {});
    ASSERT_THAT(report, IsOk());
    EXPECT_THAT(sink.complaints(), IsEmpty());
    EXPECT_THAT(report->open_places, Not(IsEmpty()));
    double nearest = 9;
    for (const Vec3& p : sink.mesh().positions) nearest = std::min(nearest, Distance(p, mendable));
    EXPECT_LT(nearest, 2 * kLength) << angle;
  }
}

// Fronts that are stopped in the middle: where two of their edges meet in a vertex, the triangles there are not one fan.
TEST(AdvanceFront, CountsTheVerticesWhereOpenPlacesTouch) {
  const TorusSurface torus(2, 0.7);
  int pinched = 0;
  for (uint64_t limit = 500; limit < 6000; limit += 250) {
    Outcome run;
    FrontOptions options = kPlain;
    options.max_triangles = limit;
    run.report = AdvanceFront(torus, Uniform(0.15), {}, {torus.Project({2.7, 0, 0}, 0)}, options, run.sink, {});
    ASSERT_THAT(run.report, IsOk());
    EXPECT_EQ(run.report->pinched_vertices == 0, MeasureTopology(run.sink.mesh()).manifold) << limit;
    pinched += run.report->pinched_vertices > 0;
  }
  EXPECT_GT(pinched, 0) << "no open places touch: choose other limits";
}

TEST(AdvanceFront, StopsAndSaysWhereItIsOpenBeyondTheLimits) {
  const TorusSurface torus(2, 0.7);
  for (const FrontOptions& options : {FrontOptions{.max_triangles = 1000}, FrontOptions{.max_candidates = 1000}}) {
    Outcome run;
    run.report = AdvanceFront(torus, Uniform(0.1), {}, {torus.Project({2.7, 0, 0}, 0)}, options, run.sink, {});
    ASSERT_THAT(run.report, IsOk());
    EXPECT_TRUE(run.report->ran_away);
    EXPECT_THAT(run.report->open_places, Not(IsEmpty()));
    EXPECT_LT(run.report->triangles, 3000u) << "at most a working area more";
    EXPECT_EQ(run.sink.mesh().triangles.size(), run.report->triangles);
  }
}

FrontReport AdvanceWithInsertions(double length, double max_error, double most) {
  const SphereSurface sphere;
  const FrontOptions options{.predicted_triangles = 3000, .max_error = max_error, .max_insertions = most};
  Outcome run;
  run.report = AdvanceFront(sphere, Uniform(length), {}, {sphere.Project({0, 0, 1}, 0)}, options, run.sink, {});
  EXPECT_THAT(run.report, IsOk());
  return run.report.ok() ? *run.report : FrontReport();
}

// Every triangle is off by several times what is asked for.
TEST(AdvanceFront, InsertsNoMoreVerticesThanItMay) {
  const auto none = static_cast<double>(AdvanceWithInsertions(0.1, 3e-4, 0).triangles);
  const auto some = static_cast<double>(AdvanceWithInsertions(0.1, 3e-4, 60).triangles);
  EXPECT_GT(some, none + 60);
  EXPECT_LE(some, none + 180) << "two triangles a vertex, and half as many again where they are off by far";
}

// How far it goes with that is what it tells of triangles that it does not tell apart.
TEST(AdvanceFront, LooksOnlyAtWhatIsFartherOffWhereItMayInsertNoMore) {
  constexpr double kMaxError = 1.5e-3;
  EXPECT_LT(AdvanceWithInsertions(0.06, kMaxError, 1000).largest_deviation, 1.5 * kMaxError);
  EXPECT_GT(AdvanceWithInsertions(0.06, kMaxError, 0).largest_deviation, 1.6 * kMaxError);
}

TEST(AdvanceFront, ReportsASeedThatFindsNoTriangle) {
  class Bare : public SphereSurface {
    std::optional<SourcePoint> FindApex(const SourcePoint&, const SourcePoint&, double, double) const override {
      return std::nullopt;
    }
  };
  Outcome run;
  run.report = AdvanceFront(Bare(), Uniform(0.1), {}, {Bare().Project({0, 0, 1}, 0)}, {}, run.sink, {});
  ASSERT_THAT(run.report, IsOk());
  EXPECT_THAT(run.report->open_places, SizeIs(1));
  EXPECT_EQ(run.report->triangles, 0u);
  EXPECT_EQ(run.report->boundary_loops, 0u) << "there is no mesh, so it has no boundary";
}

}  // namespace
}  // namespace meshfront
