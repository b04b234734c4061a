// The advancing front. Beside Figure 4 and section 3 of the paper:
//
//   until the agenda is empty
//     edge      ← the agenda's best edge in the working area          (Agenda)
//     triangle  ← what would this edge make?                          (Proposer: free by two spheres, else a connection)
//     refuse it unless it passes every test                           (Proposer and FenceIndex)
//     emit it, and let the fronts grow, close, split or merge         (FrontSet)
//   between areas: what lies well behind the fronts is improved, audited and sent       (SettlingWindow)
//
// "Every free triangle before any connection" holds inside a working area, a ball of ten edge lengths. Areas sweep over the surface
// along its longest axis, and open at the finest edges in reach: the fronts are then about as long as a section through the surface,
// and fine regions are closed before a front has to wind around them (front edges at most, igea at rho 0.05, when the three were
// compared: 5985; by the sweep alone 10464; by the finest octave of the whole surface, then by birth, 11355;
// 8485 today). Taken literally over the whole surface the rule would keep every vertex on a front until half of the
// triangles exist, and nothing could settle (rejected).
//
// Edges without an acceptable triangle wait until everything else is done, then the ladder, at one place after the other: the tests
// relaxed in named stages, the loop closed by a minimum-weight triangulation, the place taken back and advanced again at finer steps,
// then connections and closures that hardly look at normals, and at last the place reported.
#include "core/front/advancing_front.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>
#include <queue>

#include "absl/functional/function_ref.h"
#include "core/base/status_macros.h"
#include "core/front/agenda.h"
#include "core/front/fence_index.h"
#include "core/front/front_set.h"
#include "core/front/local_field.h"
#include "core/front/loop_closing.h"
#include "core/front/open_boundary.h"
#include "core/front/proposer.h"
#include "core/front/settling_window.h"
#include "core/front/tolerances.h"
#include "core/geometry/loop_triangulation.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

using namespace front_tolerances;

constexpr double kCoarsestPerFinest =
    0.5;  // an area opens at an edge that no edge in its reach is shorter than by this factor
constexpr double kFocusPerArea = 1.4;  // what the edges of an area look at reaches so far, in radii of the area
constexpr size_t kWorthAFocus = 6;     // edges to search a connection for
// Scores, which are pseudo-angles (ClockwiseTurn), of an ear that stands for its edge until its turn comes (18°), and that is made without
// looking for something better then (39°). Most edges are taken by a neighbour's connection before, and most good ears are the best.
constexpr double kSomeEar = 0.2;
constexpr double kGoodEar = 0.45;
[[maybe_unused]] constexpr size_t kSlotsPerCheckedStep = 64;  // of the front set, in builds with assertions
constexpr int kStepsBetweenChecks = 64;   // of the stop flag and the clock: well under a millisecond
constexpr size_t kMinSettleBatch = 3000;  // triangles, before the window is worth a sweep
// Stage of kStrictness that hardly looks at normals and may fold the mesh: taken only where closing and rolling back have failed.
constexpr size_t kMayFold = 3;
constexpr double kRollBackLength = 0.7;  // of g, where the front has to advance again
constexpr size_t kMaxRollBacksAtAPlace = 5;
constexpr size_t kMaxRollBacksForShape = 3;  // the same for slivers
constexpr size_t kMaxRollBacksForBound = 2;  // … and for what refinement can't bring within max_error
constexpr size_t kMaxRollBacks = 500;
constexpr int kRollBackRings = 2;
constexpr double kRollBackReach = 4.0;         // edge lengths around a place that count as the same place
constexpr double kOwnIntersectionReach = 1.5;  // edge lengths around a fault in which the surface may meet itself

struct EdgeRef {
  FrontEdgeId edge;
  uint32_t generation;
};

// An edge outside the working area: the one that lies lowest along the sweep comes next, the elder of equals.
struct WaitingEdge {
  double height;
  uint32_t order;
  EdgeRef ref;
  bool operator<(const WaitingEdge& other) const {
    return height != other.height ? height > other.height : order > other.order;
  }
};

class AdvancingFront {
 public:
  AdvancingFront(const Surface& surface, const GuidanceField& field, const FrontOptions& options, MeshSink& sink,
                 const Context& context)
      : surface_(surface),
        field_(field),
        options_(options),
        context_(context),
        fences_(fronts_),
        proposer_(surface, fronts_, fences_),
        window_(surface, fronts_,
                {options.flips, options.smooth, options.fit, options.error_per_length, options.max_error,
                 field.options().min_length, options.max_insertions, static_cast<double>(options.predicted_triangles),
                 options.wedges},
                sink) {}

  absl::StatusOr<FrontReport> Run(const std::vector<OrientedLoop>& loops, const std::vector<SourcePoint>& seeds);

 private:
  // What the agenda needs to know of a live front edge.
  struct EdgeState {
    AgendaStage stage = AgendaStage::kFree;
    bool in_area = false;
    bool stuck = false;      // no acceptable triangle at the present strictness
    bool abandoned = false;  // reported as an open place
    bool outdated = false;   // the corner was found before a neighbour changed, or by its ears alone
    FrontEdgeId corner;      // the connection found
    uint32_t corner_generation = 0;
    float score = -1;  // of that connection
  };

  WindowVertexId NewVertex(const SourcePoint& source, uint32_t origin);
  void AddLoop(const OrientedLoop& loop);
  void AttachJoints(const OrientedLoop& loop, const std::vector<WindowVertexId>& vertices, uint32_t origin);
  void AddSeed(const SourcePoint& seed);
  bool TrySeed(const SourcePoint& seed, double length, const Vec3& direction);

  void Welcome(FrontEdgeId edge);  // a new front edge: into the index and onto the agenda or the waiting list
  void Wait(const EdgeRef& ref);
  void Schedule(FrontEdgeId edge, AgendaStage stage, double ratio);
  void Farewell(FrontEdgeId edge);  // before it is consumed
  void Revive(FrontEdgeId edge, Proposer::Neighbour changed);
  FrontEdgeId FinestAround(FrontEdgeId edge);
  bool OpenArea();
  bool InArea(FrontEdgeId edge) const;
  absl::Status AdvanceArea();
  void Step(const Agenda::Entry& entry);
  bool TryFree(FrontEdgeId edge);
  void SearchConnection(FrontEdgeId edge);
  void MakeConnection(FrontEdgeId edge);
  void PlanConnection(FrontEdgeId edge, const ConnectionProposal& proposal, bool outdated);
  void Strand(FrontEdgeId edge);
  void Connect(FrontEdgeId edge, FrontEdgeId corner, TriangleKind kind);
  void AfterStep(const FrontSet::Step& step);

  absl::Status Settle(bool everything);
  bool RescueStuck();  // the next rung of the ladder; false when nothing is left to do
  bool FindRescuePlace();
  bool InRescuePlace(FrontEdgeId edge) const;
  void RescueLoops(const std::vector<EdgeRef>& stuck, absl::FunctionRef<bool(const std::vector<FrontEdgeId>&)> rescue);
  bool CloseLoop(const std::vector<FrontEdgeId>& loop, const Strictness& strictness);
  bool RollBackLoop(const std::vector<FrontEdgeId>& loop);
  bool TakeBack(WindowTriangleId t, size_t limit);
  bool Answer(const Fault& fault);
  bool RollBack(std::vector<WindowVertexId> around, int rings);
  void SeedAgain(const SourcePoint& seed, uint32_t label);
  void Abandon(const std::vector<FrontEdgeId>& loop);
  uint64_t CandidateCount() const;
  bool HasRunAway() const;
  void AbandonAll();
  void ReportProgress();
  void ReportOpenPlaces(FrontReport& report) const;
  FrontReport Summarise() const;

  double ErrorBound(double length) const {
    return std::isfinite(options_.max_error) ? options_.max_error : options_.bound_per_length * length;
  }
  uint32_t NewOrigin() { return labels_.emplace_back(static_cast<uint32_t>(labels_.size())); }
  // Halves the path to it, which is as long as there are patches otherwise.
  uint32_t RootOf(uint32_t label) {
    while (labels_[label] != label) label = labels_[label] = labels_[labels_[label]];
    return label;
  }
  EdgeState& StateOf(FrontEdgeId edge) {
    if (states_.size() <= edge.index()) states_.resize(2 * edge.index() + 16);
    return states_[edge.index()];
  }

  const Surface& surface_;
  LocalField field_;
  const FrontOptions options_;
  const Context& context_;
  FrontSet fronts_;
  FenceIndex fences_;
  Proposer proposer_;
  SettlingWindow window_;
  Agenda agenda_;
  std::vector<EdgeState> states_;
  std::priority_queue<WaitingEdge> waiting_;
  uint32_t waits_ = 0;
  std::vector<EdgeRef> stuck_;
  std::vector<FrontEdgeId> scratch_;
  Vec3 area_center_;
  double area_radius_ = 0;
  size_t strictness_ = 0;
  size_t rung_ = 0;  // of the ladder, at the place where it stands
  Vec3 rescue_center_;
  double rescue_radius_ = 0;
  uint64_t steps_ = 0, steps_at_last_rescue_ = 0;
  size_t window_after_settling_ = 0;
  uint64_t peak_front_edges_ = 0, roll_backs_ = 0;
  bool ran_away_ = false;
  std::vector<RimEdge> rim_edges_;  // of the surface, creases left out
  std::vector<uint32_t> labels_;    // union-find over the origins of the fronts: counts the components
  size_t lost_components_ = 0;
  std::vector<Vec3> spread_intersections_;
  std::optional<Vec3> own_intersection_;
  std::vector<Vec3> open_places_;  // seeds without a triangle; the loops that stay open are found at the end
};

WindowVertexId AdvancingFront::NewVertex(const SourcePoint& source, uint32_t origin) {
  const LocalField::Value g = field_.ValueAt(source.position);
  const WindowVertexId v = fronts_.AddVertex(source, g.length, surface_.MaxCurvatureAt(source));
  fronts_.at(v).origin = origin;
  fronts_.at(v).sheet = surface_.SheetOf(source);
  fronts_.at(v).refined = g.is_refined;
  return v;
}

void AdvancingFront::AddLoop(const OrientedLoop& loop) {
  std::vector<WindowVertexId> vertices;
  const uint32_t origin = NewOrigin();
  for (const SourcePoint& p : loop.points) vertices.push_back(NewVertex(p, origin));
  AttachJoints(loop, vertices, origin);
  FrontEdgeId e = fronts_.AddLoop(vertices);
  for (size_t i = 0; i < vertices.size(); ++i, e = fronts_.at(e).next) Welcome(e);
  for (size_t i = 0; i < vertices.size(); ++i) {
    if (!loop.creases.empty() && loop.creases[i]) continue;
    rim_edges_.push_back({fronts_.IdentityOf(vertices[i]), fronts_.IdentityOf(vertices[(i + 1) % vertices.size()])});
  }
}

// A loop along creases belongs to the component of the loops on their other sides.
void AdvancingFront::AttachJoints(const OrientedLoop& loop, const std::vector<WindowVertexId>& vertices,
                                  uint32_t origin) {
  for (size_t i = 0; i < loop.joints.size(); ++i) {
    if (loop.joints[i] == kNoJoint) continue;
    fronts_.AttachJoint(vertices[i], loop.joints[i]);
    Joint& joint = fronts_.joint(loop.joints[i]);
    if (joint.vertices == 1) joint.label = origin;
    labels_[RootOf(joint.label)] = RootOf(origin);
  }
  for (size_t i = 0; i < loop.creases.size(); ++i) {
    if (loop.creases[i]) fronts_.MarkCrease(vertices[i], vertices[(i + 1) % vertices.size()]);
  }
  for (const auto& [u, v] : loop.taken) fronts_.MarkTaken(u, v);
}

void AdvancingFront::AddSeed(const SourcePoint& seed) {
  const Vec3 axis = std::abs(seed.normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = Normalized(Cross(seed.normal, axis)), v = Cross(seed.normal, u);
  const double g = field_.At(seed.position);
  for (double length = g; length > g / 100; length *= 0.7) {
    for (const Vec3& direction : {u, v, -u, -v, Normalized(u + v), Normalized(u - v)}) {
      if (TrySeed(seed, length, direction)) return;
    }
  }
  open_places_.push_back(seed.position);
}

bool AdvancingFront::TrySeed(const SourcePoint& seed, double length, const Vec3& direction) {
  SourcePoint second = surface_.Snap(seed, seed.position + length * direction);
  for (int i = 0; i < 3; ++i) {  // to the wanted distance, over a curved surface
    const Vec3 chord = second.position - seed.position;
    second = surface_.Snap(second, seed.position + length * Normalized(chord));
  }
  const double base = Distance(seed.position, second.position);
  if (base < 0.6 * length || base > 1.4 * length || Dot(seed.normal, second.normal) < 0.3) return false;
  const std::optional<SourcePoint> apex = surface_.FindApex(seed, second, length, length);
  if (!apex || Dot(apex->normal, seed.normal) < 0.3 || Dot(apex->normal, second.normal) < 0.3) return false;
  const uint32_t origin = NewOrigin();
  const WindowVertexId a = NewVertex(seed, origin), b = NewVertex(second, origin), c = NewVertex(*apex, origin);
  FrontEdgeId e = fronts_.AddSeed(b, a, c);
  ++steps_;
  for (int i = 0; i < 3; ++i, e = fronts_.at(e).next) Welcome(e);
  return true;
}

bool AdvancingFront::InArea(FrontEdgeId edge) const {
  const Fence& f = fences_.at(edge);
  return SquaredDistance(0.5 * (f.start + f.end), area_center_) <= area_radius_ * area_radius_;
}

void AdvancingFront::Schedule(FrontEdgeId edge, AgendaStage stage, double ratio) {
  StateOf(edge).stage = stage;
  agenda_.Push(stage, ratio, fronts_.at(edge).birth, edge);
}

void AdvancingFront::Wait(const EdgeRef& ref) {
  const Vec3 both = fronts_.at(fronts_.From(ref.edge)).position + fronts_.at(fronts_.To(ref.edge)).position;
  waiting_.push({Dot(both, options_.sweep), waits_++, ref});
}

void AdvancingFront::Welcome(FrontEdgeId edge) {
  fences_.Insert(edge);
  EdgeState& state = StateOf(edge);
  state = {};
  state.in_area = InArea(edge);
  if (state.in_area)
    Schedule(edge, AgendaStage::kFree, proposer_.FreeRatio(edge));
  else
    Wait({edge, fronts_.at(edge).generation});
}

void AdvancingFront::Farewell(FrontEdgeId edge) {
  fences_.Erase(edge);
  agenda_.Cancel(edge);
}

// A neighbour changed. What the edge had planned is looked at again when its turn comes; only the ear with the new neighbour can
// bring that turn forward.
void AdvancingFront::Revive(FrontEdgeId edge, Proposer::Neighbour changed) {
  EdgeState& state = StateOf(edge);
  if (!state.in_area || state.stage == AgendaStage::kFree) return;
  if (state.stuck) {
    state.stuck = false;
    Schedule(edge, AgendaStage::kSearch, 0);
  } else if (state.stage == AgendaStage::kConnect) {
    state.outdated = true;
    const ConnectionProposal ear = proposer_.ProposeEar(edge, kStrictness[strictness_], changed, state.score);
    if (ear.corner.valid()) PlanConnection(edge, ear, true);
  }
}

// The edge around which the working area opens: `edge`, or where its area would hold much finer ones, the finest of those. A ball
// of ten coarse edges that held a fine region would bring all of it onto the fronts at once.
FrontEdgeId AdvancingFront::FinestAround(FrontEdgeId edge) {
  for (double length = fences_.at(edge).Length();;) {
    const Fence& f = fences_.at(edge);
    const Vec3 middle = 0.5 * (f.start + f.end);
    const double reach = kAreaRadius * length;
    scratch_.clear();
    fences_.Query(middle, reach, scratch_);
    double finest = kCoarsestPerFinest * length;
    for (const FrontEdgeId e : scratch_) {
      const Fence& g = fences_.at(e);
      const EdgeState& state = StateOf(e);
      if (state.abandoned || state.stuck || !(g.Length() < finest)) continue;
      if (SquaredDistance(0.5 * (g.start + g.end), middle) <= reach * reach) finest = g.Length(), edge = e;
    }
    if (!(finest < kCoarsestPerFinest * length)) return edge;
    length = finest;
  }
}

// The working area moves to the first of the waiting edges, and takes in every edge around it.
bool AdvancingFront::OpenArea() {
  fences_.EndFocus();
  while (!waiting_.empty()) {
    const EdgeRef ref = waiting_.top().ref;
    waiting_.pop();
    if (!fronts_.IsAlive(ref.edge, ref.generation) || StateOf(ref.edge).abandoned || StateOf(ref.edge).stuck) continue;
    const FrontEdgeId finest = FinestAround(ref.edge);
    const Fence& f = fences_.at(finest);
    area_center_ = 0.5 * (f.start + f.end);
    area_radius_ = kAreaRadius * f.Length();
    if (finest != ref.edge && !InArea(ref.edge)) Wait(ref);
    scratch_.clear();
    fences_.Query(area_center_, area_radius_, scratch_);
    size_t to_do = 0;
    for (const FrontEdgeId e : scratch_) {
      EdgeState& state = StateOf(e);
      if (!InArea(e) || state.abandoned || state.stuck) continue;
      state.in_area = true;
      to_do += state.stage == AgendaStage::kFree ? kWorthAFocus : 1;
      if (state.stage == AgendaStage::kFree)
        Schedule(e, AgendaStage::kFree, proposer_.FreeRatio(e));
      else
        Schedule(e, AgendaStage::kSearch, 0);
    }
    if (to_do >= kWorthAFocus) fences_.Focus(area_center_, kFocusPerArea * area_radius_, f.normal);
    return true;
  }
  return false;
}

absl::Status AdvancingFront::AdvanceArea() {
  Agenda::Entry entry;
  int until_check = 1;
#ifndef NDEBUG
  size_t until_violation = 1;  // of steps: a check costs what they cost, however large the window
#endif
  while (agenda_.Pop(entry)) {
    if (--until_check == 0) {
      MESHFRONT_RETURN_IF_ERROR(context_.CheckStop());
      until_check = kStepsBetweenChecks;
    }
    Step(entry);
#ifndef NDEBUG
    if (--until_violation > 0) continue;
    if (const char* violation = fronts_.FindViolation())
      std::fprintf(stderr, "front set: %s\n", violation), std::abort();
    until_violation = 1 + (fronts_.edge_slots() + fronts_.triangle_slots()) / kSlotsPerCheckedStep;
#endif
  }
  return absl::OkStatus();
}

void AdvancingFront::Step(const Agenda::Entry& entry) {
  switch (entry.stage()) {
    case AgendaStage::kFree:
      if (!TryFree(entry.edge)) Schedule(entry.edge, AgendaStage::kSearch, 0);
      break;
    case AgendaStage::kSearch:
      SearchConnection(entry.edge);
      break;
    case AgendaStage::kConnect:
      MakeConnection(entry.edge);
      break;
  }
}

bool AdvancingFront::TryFree(FrontEdgeId edge) {
  FreeProposal proposal;
  if (proposer_.ProposeFree(edge, proposal) != Verdict::kAccepted) return false;
  const WindowVertexId apex = NewVertex(proposal.apex, fronts_.at(fronts_.From(edge)).origin);
  Farewell(edge);
  // Where lengths from before and after a refinement meet, or the base limits the sides, eta is not promised.
  const bool refined =
      fronts_.at(fronts_.From(edge)).refined || fronts_.at(fronts_.To(edge)).refined || fronts_.at(apex).refined;
  const FrontSet::Step step = fronts_.Grow(edge, apex);
  if (refined || !proposal.at_guidance) fronts_.at(step.triangle).kind = TriangleKind::kClosing;
  AfterStep(step);
  return true;
}

void AdvancingFront::PlanConnection(FrontEdgeId edge, const ConnectionProposal& proposal, bool outdated) {
  EdgeState& state = StateOf(edge);
  state.corner = proposal.corner;
  state.corner_generation = fronts_.at(proposal.corner).generation;
  state.score = static_cast<float>(proposal.score);
  state.outdated = outdated;
  Schedule(edge, AgendaStage::kConnect, proposal.score);
}

void AdvancingFront::Strand(FrontEdgeId edge) {
  StateOf(edge).stuck = true;
  stuck_.push_back({edge, fronts_.at(edge).generation});
}

// What is found is a plan only, looked at again when its turn comes: fences and surface are asked then.
void AdvancingFront::SearchConnection(FrontEdgeId edge) {
  if (strictness_ == 0) {
    const ConnectionProposal ear = proposer_.ProposeEar(edge, kStrictness[0], Proposer::Neighbour::kEither, kSomeEar);
    if (ear.corner.valid()) return PlanConnection(edge, ear, true);
  }
  ConnectionProposal proposal;
  if (proposer_.ProposeConnection(edge, kStrictness[strictness_], Proposer::Scrutiny::kShape, proposal) ==
      Verdict::kAccepted)
    PlanConnection(edge, proposal, false);
  else
    Strand(edge);
}

void AdvancingFront::MakeConnection(FrontEdgeId edge) {
  const EdgeState state = StateOf(edge);
  const Strictness& strictness = kStrictness[strictness_];
  const auto is_ear = [&] {  // with a neighbour as it is now
    return state.corner == fronts_.at(edge).prev || state.corner == fronts_.at(fronts_.at(edge).next).next;
  };
  if (fronts_.IsAlive(state.corner, state.corner_generation) &&
      (!state.outdated || (state.score >= kGoodEar && is_ear()))) {
    ConnectionProposal planned{state.corner, state.score};
    if (proposer_.CheckConnection(edge, strictness, planned) == Verdict::kAccepted &&
        static_cast<float>(planned.score) >= state.score) {
      return Connect(edge, state.corner, TriangleKind::kConnection);
    }
  }
  ConnectionProposal proposal;
  if (proposer_.ProposeConnection(edge, strictness, Proposer::Scrutiny::kWhole, proposal) != Verdict::kAccepted)
    return Strand(edge);
  if (static_cast<float>(proposal.score) >= state.score)
    Connect(edge, proposal.corner, TriangleKind::kConnection);
  else
    PlanConnection(edge, proposal, false);
}

void AdvancingFront::Connect(FrontEdgeId edge, FrontEdgeId corner, TriangleKind kind) {
  const FrontEdgeId before = fronts_.at(edge).prev, after = fronts_.at(edge).next;
  const bool zip_before = corner == before, zip_after = corner == fronts_.at(after).next;
  labels_[RootOf(fronts_.at(fronts_.From(edge)).origin)] = RootOf(fronts_.at(fronts_.From(corner)).origin);
  Farewell(edge);
  if (zip_before) Farewell(before);
  if (zip_after) Farewell(after);
  if (zip_before && zip_after) kind = TriangleKind::kClosing;
  AfterStep(fronts_.Connect(edge, corner, kind));
}

void AdvancingFront::AfterStep(const FrontSet::Step& step) {
  ++steps_;
  strictness_ = 0;
  for (int i = 0; i < step.made_count; ++i) Welcome(step.made[i]);
  for (int i = 0; i < step.made_count; ++i) {
    Revive(fronts_.at(step.made[i]).prev, Proposer::Neighbour::kAfter);
    Revive(fronts_.at(step.made[i]).next, Proposer::Neighbour::kBefore);
  }
  peak_front_edges_ = std::max<uint64_t>(peak_front_edges_, fronts_.front_edge_count());
}

// The ladder climbs at one place at a time, a ball as large as a working area: what happens there changes nothing elsewhere, and a
// step at one of many places would otherwise send all of them down to its foot.
bool AdvancingFront::RescueStuck() {
  std::erase_if(stuck_, [this](const EdgeRef& r) {
    if (!fronts_.IsAlive(r.edge, r.generation) || StateOf(r.edge).abandoned) return true;
    if (StateOf(r.edge).stuck) return false;
    Wait(r);  // what was taken back next to it lets it advance
    return true;
  });
  strictness_ = 0;
  if (!waiting_.empty()) return true;
  if (stuck_.empty()) return false;
  const bool is_new = FindRescuePlace();
  rung_ = is_new || steps_ != steps_at_last_rescue_ ? 0 : rung_ + 1;
  steps_at_last_rescue_ = steps_;
  std::vector<EdgeRef> here;
  std::erase_if(stuck_, [&](const EdgeRef& r) {
    if (!InRescuePlace(r.edge)) return false;
    here.push_back(r);
    return true;
  });
  if (rung_ == kMayFold) {
    RescueLoops(here, [this](const std::vector<FrontEdgeId>& loop) {
      return CloseLoop(loop, kStrictness[kMayFold - 1]) || RollBackLoop(loop);
    });
    if (steps_ != steps_at_last_rescue_) rung_ = 0;
  } else if (rung_ >= kStrictness.size()) {
    rung_ = 0;
    RescueLoops(here, [this](const std::vector<FrontEdgeId>& loop) {
      if (CloseLoop(loop, kStrictness[kMayFold]) || CloseLoop(loop, kRegardlessOfNormals)) return true;
      Abandon(loop);
      return false;
    });
  }
  strictness_ = rung_;
  for (const EdgeRef& r : here) {
    if (!fronts_.IsAlive(r.edge, r.generation) || StateOf(r.edge).abandoned) continue;
    StateOf(r.edge).stuck = false;
    Wait(r);
  }
  return true;
}

bool AdvancingFront::InRescuePlace(FrontEdgeId edge) const {
  return SquaredDistance(fences_.BallOf(edge).center, rescue_center_) <= rescue_radius_ * rescue_radius_;
}

// Stays where the ladder is while an edge is stuck there. True: moved to that of the edge that has waited longest.
bool AdvancingFront::FindRescuePlace() {
  if (std::any_of(stuck_.begin(), stuck_.end(), [this](const EdgeRef& r) { return InRescuePlace(r.edge); }))
    return false;
  rescue_center_ = fences_.BallOf(stuck_.front().edge).center;
  rescue_radius_ = kAreaRadius * fences_.at(stuck_.front().edge).Length();
  return true;
}

// Loop by loop. `rescue` tells whether it took a step.
void AdvancingFront::RescueLoops(const std::vector<EdgeRef>& stuck,
                                 absl::FunctionRef<bool(const std::vector<FrontEdgeId>&)> rescue) {
  for (const EdgeRef& r : stuck) {
    if (!fronts_.IsAlive(r.edge, r.generation) || StateOf(r.edge).abandoned || !StateOf(r.edge).stuck) continue;
    const std::vector<FrontEdgeId> loop = fronts_.LoopOf(r.edge);
    // Taken back since by another loop's rescue: it can advance again.
    if (!std::all_of(loop.begin(), loop.end(), [&](FrontEdgeId e) { return StateOf(e).stuck; })) continue;
    steps_ += rescue(loop);
  }
}

bool AdvancingFront::CloseLoop(const std::vector<FrontEdgeId>& loop, const Strictness& strictness) {
  const auto steps = ProposeClosure(fronts_, proposer_, loop, strictness);
  if (!steps) return false;
  std::vector<WindowVertexId> v;
  for (const FrontEdgeId e : loop) v.push_back(fronts_.From(e));
  for (const ClosureStep& s : *steps) {
    const FrontEdgeId base = fronts_.FindEdge(v[s.last], v[s.first]);
    if (!base.valid()) return true;  // cannot be: the steps come in order
    Connect(base, fronts_.CornerOnLoop(base, v[s.apex]), TriangleKind::kClosing);
  }
  return true;
}

bool AdvancingFront::RollBackLoop(const std::vector<FrontEdgeId>& loop) {
  std::vector<WindowVertexId> around;
  Vec3 middle;
  double length = 0;
  for (const FrontEdgeId e : loop) {
    if (InRescuePlace(e)) around.push_back(fronts_.From(e));
  }
  for (const WindowVertexId v : around) {
    middle += fronts_.at(v).position / static_cast<double>(around.size());
    length += fronts_.at(v).length / static_cast<double>(around.size());
  }
  if (roll_backs_ >= kMaxRollBacks) return false;
  const size_t before = field_.RefinementsNear(middle);
  if (before >= kMaxRollBacksAtAPlace) return false;
  field_.Refine(middle, kRollBackLength * field_.At(middle), kRollBackReach * length);
  return RollBack(std::move(around), kRollBackRings + static_cast<int>(before));
}

// Removes the triangles within `rings` rings of the vertices, as far as they may be touched, and lets the front advance again.
bool AdvancingFront::RollBack(std::vector<WindowVertexId> around, int rings) {
  std::vector<bool> reached(fronts_.vertex_slots(), false), doomed(fronts_.triangle_slots(), false);
  for (const WindowVertexId v : around) reached[v.index()] = true;
  std::vector<WindowTriangleId> removed;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<WindowVertexId> next;
    for (uint32_t i = 0; i < fronts_.triangle_slots(); ++i) {
      const WindowTriangle& t = fronts_.at(WindowTriangleId(i));
      if (!t.alive || doomed[i]) continue;
      const auto is_reached = [&](WindowVertexId v) { return reached[v.index()]; };
      const auto is_frozen = [&](WindowVertexId v) { return fronts_.at(v).frozen(); };
      if (std::none_of(t.corners.begin(), t.corners.end(), is_reached)) continue;
      if (std::any_of(t.corners.begin(), t.corners.end(), is_frozen)) continue;
      doomed[i] = true;
      removed.push_back(WindowTriangleId(i));
      next.insert(next.end(), t.corners.begin(), t.corners.end());
    }
    for (const WindowVertexId v : next) reached[v.index()] = true;
  }
  if (removed.empty()) return false;
  const bool whole = std::none_of(removed.begin(), removed.end(), [&](WindowTriangleId t) {
    const auto& across = fronts_.at(t).across;
    return std::any_of(across.begin(), across.end(),
                       [&](Link l) { return !l.is_front() && !(l.is_half_edge() && doomed[l.triangle().index()]); });
  });
  const SourcePoint place = fronts_.at(around[0]).source;
  const uint32_t label = RootOf(fronts_.at(around[0]).origin);
  for (const WindowTriangleId t : removed) {
    for (const Link across : fronts_.at(t).across) {
      if (across.is_front()) Farewell(across.front());
    }
  }
  const std::vector<FrontEdgeId> made = fronts_.Remove(removed);
  if (whole) SeedAgain(place, label);  // nothing is left of the component
  for (const FrontEdgeId e : made) {
    WindowVertex& from = fronts_.at(fronts_.From(e));
    from.position = from.source.position;  // fronts stand on the surface
    from.improved = false;
    const LocalField::Value g = field_.ValueAt(from.position);
    from.length = g.length;
    from.refined = g.is_refined;
  }
  for (const FrontEdgeId e : made) {
    StateOf(e) = {};
    Welcome(e);
  }
  for (const WindowVertexId v : around) {  // edges that stayed, next to the place
    if (!fronts_.at(v).alive) continue;
    for (FrontEdgeId c = fronts_.at(v).first_corner; c.valid(); c = fronts_.at(c).next_at_vertex) {
      if (!StateOf(c).abandoned) StateOf(c).stuck = false, StateOf(c).stage = AgendaStage::kFree;
    }
  }
  ++roll_backs_;
  ++steps_;
  return true;
}

void AdvancingFront::SeedAgain(const SourcePoint& seed, uint32_t label) {
  const size_t labels = labels_.size();
  AddSeed(seed);
  if (labels_.size() > labels)
    labels_[label] = static_cast<uint32_t>(labels);
  else
    ++lost_components_;
}

uint64_t AdvancingFront::CandidateCount() const {
  return std::accumulate(proposer_.counts().begin(), proposer_.counts().end(), uint64_t{0});
}

bool AdvancingFront::HasRunAway() const {
  if (roll_backs_ > options_.max_roll_backs || CandidateCount() > options_.max_candidates) return true;
  const SettledCounts& counts = window_.counts();
  return options_.max_triangles > 0 &&
         counts.triangles + fronts_.triangle_count() > options_.max_triangles + 2 * counts.insertions;
}

void AdvancingFront::AbandonAll() {
  for (uint32_t i = 0; i < fronts_.edge_slots(); ++i) {
    if (fronts_.at(FrontEdgeId(i)).alive) StateOf(FrontEdgeId(i)).abandoned = true;
  }
  waiting_ = {};
  stuck_.clear();
  roll_backs_ = std::max<uint64_t>(roll_backs_, kMaxRollBacks);
  ran_away_ = true;
}

void AdvancingFront::Abandon(const std::vector<FrontEdgeId>& loop) {
  for (const FrontEdgeId e : loop) {
    if (InRescuePlace(e)) StateOf(e).abandoned = true;
  }
}

// What is open at the end, rather than what was abandoned: another front may have reached an abandoned loop since.
void AdvancingFront::ReportOpenPlaces(FrontReport& report) const {
  for (const std::vector<FrontEdgeId>& loop : OpenLoops(fronts_)) {
    Vec3 middle;
    for (const FrontEdgeId e : loop) middle += fronts_.at(fronts_.From(e)).position / static_cast<double>(loop.size());
    report.open_places.push_back(middle);
  }
}

void AdvancingFront::ReportProgress() {
  context_.Report({Stage::kMesh, options_.predicted_triangles, window_.counts().triangles, fronts_.front_edge_count()});
}

// Takes back a triangle and what is around it, to advance there again with shorter edges; at most so often at a place.
bool AdvancingFront::TakeBack(WindowTriangleId t, size_t limit) {
  const auto& corners = fronts_.at(t).corners;
  const WindowVertex& v = fronts_.at(corners[0]);
  const size_t before = field_.RefinementsNear(v.position);
  if (before >= limit || roll_backs_ >= kMaxRollBacks) return false;
  field_.Refine(v.position, kRollBackLength * field_.At(v.position), kRollBackReach * v.length);
  return RollBack({corners.begin(), corners.end()}, 1 + static_cast<int>(before));
}

// Where the surface meets itself within the error bound, the mesh may as well; what does so not much farther away is noted. Elsewhere
// the edges are too long for what lies close by. True: taken back.
bool AdvancingFront::Answer(const Fault& fault) {
  const double length = fronts_.at(fronts_.at(fault.triangle).corners[0]).length;
  const double bound = ErrorBound(std::max(length, window_.counts().longest_edge));
  if (surface_.MeetsItselfNear(fault.place, bound, context_)) {
    window_.Excuse(fault.triangle);
    if (!own_intersection_) own_intersection_ = fault.place;
    return false;
  }
  if (surface_.MeetsItselfNear(fault.place, std::max(bound, kOwnIntersectionReach * length), context_)) {
    window_.Excuse(fault.triangle);
    const bool is_known =
        !spread_intersections_.empty() && spread_intersections_.back() == fault.place;  // of its partner
    if (!is_known) spread_intersections_.push_back(fault.place);
    return false;
  }
  if (TakeBack(fault.triangle, kMaxRollBacksAtAPlace)) return true;
  window_.GiveUp(fault.triangle);
  return false;
}

absl::Status AdvancingFront::Settle(bool everything) {
  bool taken_back = false;
  for (const Fault& fault : window_.Improve(context_)) {
    if (fronts_.at(fault.triangle).alive) taken_back |= Answer(fault);
  }
  for (const WindowTriangleId t : window_.slivers()) {
    if (!fronts_.at(t).alive) continue;
    if (TakeBack(t, kMaxRollBacksForShape))
      taken_back = true;
    else
      window_.Excuse(t);
  }
  for (const WindowTriangleId t : window_.beyond()) {
    if (fronts_.at(t).alive) taken_back |= TakeBack(t, kMaxRollBacksForBound);
  }
  if (taken_back && everything) return absl::OkStatus();  // the caller advances and settles again
  if (taken_back) window_.MeasureDepth();                 // fronts are back where none was
  MESHFRONT_RETURN_IF_ERROR(context_.CheckStop());
  MESHFRONT_RETURN_IF_ERROR(window_.Emit(everything));
  window_after_settling_ = fronts_.triangle_count();
  ReportProgress();
  return absl::OkStatus();
}

FrontReport AdvancingFront::Summarise() const {
  const SettledCounts& counts = window_.counts();
  FrontReport report;
  report.vertices = counts.vertices;
  report.triangles = counts.triangles;
  report.free_triangles = counts.by_kind[0];
  report.connection_triangles = counts.by_kind[1];
  report.closing_triangles = counts.by_kind[2];
  report.flips = counts.flips;
  report.peak_front_edges = peak_front_edges_;
  report.roll_backs = roll_backs_;
  report.ran_away = ran_away_;
  const double bound = ErrorBound(counts.longest_edge);  // the longest is known by now
  for (const Vec3& place : spread_intersections_) {
    if (!surface_.MeetsItselfNear(place, bound, context_)) report.spread_intersections.push_back(place);
  }
  report.own_intersection = own_intersection_;
  report.longest_edge = counts.longest_edge;
  report.largest_deviation = counts.largest_deviation;
  report.beyond_max_error = counts.beyond_max_error;
  report.farthest_place = counts.farthest_place;
  report.quality = counts.quality.Report();
  const OpenBoundary boundary = MeasureBoundary(fronts_, rim_edges_);
  report.boundary_edges = boundary.edges + window_.rim_insertions();
  report.boundary_loops = boundary.loops;
  report.pinched_vertices = boundary.pinched_vertices;
  report.open_places = open_places_;
  ReportOpenPlaces(report);
  report.open_places.insert(report.open_places.end(), window_.faults().begin(), window_.faults().end());
  for (uint32_t i = 0; i < labels_.size(); ++i) report.components += labels_[i] == i;
  report.components -= lost_components_;
  for (int i = 0; i < kVerdicts; ++i) {
    report.refusals.push_back({std::string(VerdictName(static_cast<Verdict>(i))), proposer_.counts()[i]});
  }
  return report;
}

absl::StatusOr<FrontReport> AdvancingFront::Run(const std::vector<OrientedLoop>& loops,
                                                const std::vector<SourcePoint>& seeds) {
  for (const OrientedLoop& loop : loops) AddLoop(loop);
  for (const SourcePoint& seed : seeds) AddSeed(seed);
  ReportProgress();
  do {
    // What was taken back within the last area is on the agenda already.
    while (OpenArea() || !agenda_.empty() || RescueStuck()) {
      MESHFRONT_RETURN_IF_ERROR(context_.CheckStop());
      MESHFRONT_RETURN_IF_ERROR(AdvanceArea());
      if (HasRunAway()) AbandonAll();
      if (fronts_.triangle_count() >= 3 * window_after_settling_ / 2 + kMinSettleBatch)
        MESHFRONT_RETURN_IF_ERROR(Settle(false));
    }
    MESHFRONT_RETURN_IF_ERROR(Settle(true));
    // The last look may have taken everything back to the rims.
  } while (fronts_.triangle_count() > 0 || !waiting_.empty() || !agenda_.empty());
  return Summarise();
}

}  // namespace

absl::StatusOr<FrontReport> AdvanceFront(const Surface& surface, const GuidanceField& field,
                                         const std::vector<OrientedLoop>& loops, const std::vector<SourcePoint>& seeds,
                                         const FrontOptions& options, MeshSink& sink, const Context& context) {
  AdvancingFront front(surface, field, options, sink, context);
  return front.Run(loops, seeds);
}

}  // namespace meshfront
