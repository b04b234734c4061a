// Settling. In the window, a few rings behind every front, in this order (engine sec. 11 measured each):
//   FlipSweep    edges that raise the smaller of the two smallest angles
//   SmoothSweep  each vertex to the average of its triangles' centroids weighted by area / (opposite edge)², in the tangent
//                plane, back on the surface, kept only if the worst angle around it does not fall
//   RemovalSweep vertices of slivers, where the ring without them can be filled with rounder triangles
//   SearchSweep  pattern search on the worst radius ratio around a vertex, where it is poor
//   FitSweep     each vertex along its normal, by least squares of the signed deviations around it
//   Audit        pairs of triangles that intersect are sent back to the front
// Each vertex has its turn when it has come to lie far enough behind the fronts, together with the ring around it.
// Rejected: improving the whole mesh after the last triangle, which would hold the output and stream nothing; the window shows
// the same gain, because every operation reaches one ring only.
#include "core/front/settling_window.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/geometry/intersection.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr uint32_t kFar = 0xffffu;
constexpr double kMinFlipNormalCosine = 0.5;  // new triangles against the surface normals at their corners
constexpr double kMinFlipGain = 1.02 * 1.02;  // the smaller sine's square must grow by this factor: no ping-pong
constexpr double kRoundSineSquared = 0.45;    // of 42°: nothing that turns between such triangles is worth it
constexpr double kNeedleSineSquared = 1e-5;   // below it a ratio is left to RadiusRatio, which knows needles
constexpr double kNoFloor = -std::numeric_limits<double>::infinity();
constexpr double kMinMoveNormalCosine = 0.3;
constexpr double kLeastSmoothing = 0.02;             // in parts of an edge around: less is not worth a look
constexpr double kSearchBelow = 0.875;               // radius ratio under which a vertex is worth a search
constexpr double kSearchSteps[] = {0.2, 0.1, 0.05};  // in parts of the mean spoke
constexpr int kImproveSweeps = 2, kSearchSweeps = 4, kFitSweeps = 2;
constexpr double kMaxFitPerLength = 0.15;  // the fit moves a vertex by at most this part of its mean spoke
constexpr double kFitPerErrorBound = 0.9;  // … and at most this part of the error bound of the triangles around it
constexpr double kFitMayLoseQuality = 0.97;
constexpr double kSlightFit = 0.02;  // of the mean spoke: so short a move along the normal loses less than that
constexpr int kMovedRounds = 8, kPlainRounds = 4,
              kLastRounds = 4;  // of the refinement; each reaches every triangle once
// Of max_error, where only what is far beyond it is refined. At 1 the maximum is the same and triangles are less round, since a few
// places make it; at 1.9 it is larger.
constexpr double kFarBeyondMaxError = 1.45;
constexpr double kSlackStep = 1.05;
// What a triangle may deviate at most, in parts of the largest place that was measured before it was given up.
constexpr double kMostPerMeasured = 1.5;
constexpr int kRefinementRings = 2;  // around new vertices, that move with them
constexpr size_t kMaxRing = 24;      // vertices around one that is removed
constexpr double kSliver = 0.25;     // radius ratio below which a triangle is worth another try of the front
constexpr double kSineSquaredOf22Degrees = 0.1403301;

// Each once, in order. `slots`: ids are below.
template <class Id>
std::vector<Id> MadeUnique(const std::vector<Id>& ids, size_t slots) {
  std::vector<uint8_t> is_among(slots, 0);
  for (const Id id : ids) is_among[id.index()] = 1;
  std::vector<Id> unique;
  for (uint32_t i = 0; i < slots; ++i) {
    if (is_among[i]) unique.push_back(Id(i));
  }
  return unique;
}

// Squared sine of the smallest angle: twice the area over the product of the two longest sides, squared. From the squares of
// the sides and of twice the area.
inline double SquaredSineOfSquares(double ab, double bc, double ca, double area) {
  const double product = std::max(ab, bc) * std::max(std::min(ab, bc), ca);
  return product > 0 ? area / product : 0;
}
inline double MinSquaredSine(const Vec3& a, const Vec3& b, const Vec3& c) {
  return SquaredSineOfSquares(SquaredDistance(a, b), SquaredDistance(b, c), SquaredDistance(c, a),
                              SquaredNorm(AreaVector(a, b, c)));
}

// Of two angles of 22° and one of 136° the ratio is the least that goes with that smallest angle, 0.27.
bool IsSliver(const Vec3& a, const Vec3& b, const Vec3& c) {
  return MinSquaredSine(a, b, c) < kSineSquaredOf22Degrees && RadiusRatio(a, b, c) < kSliver;
}

double NormalAgreement(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& na, const Vec3& nb, const Vec3& nc) {
  const Vec3 n = Normalized(AreaVector(a, b, c));
  return std::min({Dot(n, na), Dot(n, nb), Dot(n, nc)});
}

// A side of a triangle, from the place that WorstAround is asked for.
struct Side {
  explicit Side(const Vec3& along) : vector(along), squared(SquaredNorm(along)), length(std::sqrt(squared)) {}
  Vec3 vector;
  double squared, length;
};

// Whether a triangle turns against a normal. `area2`: the square of its area vector.
inline bool FacesAgainst(const Vec3& area, double area2, const Vec3& normal) {
  const double facing = Dot(area, normal);
  return facing < 0 || facing * facing < kMinMoveNormalCosine * kMinMoveNormalCosine * area2;
}

// What WorstAround takes the least of. `area2`: the square of twice the area.
constexpr auto kMinSine = [](const Vec3&, const auto& spoke, const Side& from, const Side& to, double area2) {
  return SquaredSineOfSquares(from.squared, spoke.opposite2, to.squared, area2);
};
constexpr auto kRadiusRatio = [](const Vec3& place, const auto& spoke, const Side& from, const Side& to, double area2) {
  if (area2 < kNeedleSineSquared * from.squared * to.squared) return RadiusRatio(place, spoke.from, spoke.to);
  return RadiusRatioOfLengths(from.length, spoke.opposite, to.length, area2);
};

}  // namespace

// Rings to the nearest front vertex, up to kEmitDepth; kFar beyond.
void SettlingWindow::MeasureDepth() {
  for (uint32_t i = 0; i < fronts_.vertex_slots(); ++i) {
    WindowVertex& v = fronts_.at(WindowVertexId(i));
    v.depth = v.on_front() ? 0 : kFar;
  }
  for (uint32_t depth = 1; depth < kEmitDepth; ++depth) {
    for (uint32_t i = 0; i < fronts_.triangle_slots(); ++i) {
      const WindowTriangle& t = fronts_.at(WindowTriangleId(i));
      if (!t.alive) continue;
      uint32_t least = kFar;
      for (const WindowVertexId v : t.corners) least = std::min(least, fronts_.at(v).depth);
      if (least + 1 != depth) continue;
      for (const WindowVertexId v : t.corners) fronts_.at(v).depth = std::min(fronts_.at(v).depth, depth);
    }
  }
}

// Far enough behind the fronts to be improved.
bool SettlingWindow::IsReached(const WindowVertex& v) const { return v.alive && !v.frozen() && v.depth >= kMoveDepth; }

// The vertices that have been reached since the last time, and those next to them; what lies on a rim keeps its place.
void SettlingWindow::ChooseVertices() {
  std::vector<uint8_t> wanted(fronts_.vertex_slots(), 0);
  for (uint32_t i = 0; i < fronts_.triangle_slots(); ++i) {
    const WindowTriangle& t = fronts_.at(WindowTriangleId(i));
    if (!t.alive) continue;
    const auto is_new = [&](WindowVertexId v) { return IsReached(fronts_.at(v)) && !fronts_.at(v).improved; };
    if (std::none_of(t.corners.begin(), t.corners.end(), is_new)) continue;
    for (const WindowVertexId v : t.corners) wanted[v.index()] = IsReached(fronts_.at(v));
  }
  chosen_.clear();
  for (uint32_t i = 0; i < wanted.size(); ++i) {
    WindowVertex& v = fronts_.at(WindowVertexId(i));
    v.improved = v.improved || wanted[i];
    if (wanted[i] && !v.on_rim) chosen_.push_back(WindowVertexId(i));
  }
  GatherAround(wanted);
}

// The triangles that have a wanted corner.
void SettlingWindow::GatherAround(const std::vector<uint8_t>& wanted) {
  around_.clear();
  feet_.clear();
  place_in_around_.assign(fronts_.triangle_slots(), kNotAround);
  for (uint32_t i = 0; i < fronts_.triangle_slots(); ++i) {
    const WindowTriangle& t = fronts_.at(WindowTriangleId(i));
    const auto is_wanted = [&](WindowVertexId v) { return wanted[v.index()] != 0; };
    if (!t.alive || std::none_of(t.corners.begin(), t.corners.end(), is_wanted)) continue;
    place_in_around_[i] = static_cast<uint32_t>(around_.size());
    around_.push_back(WindowTriangleId(i));
  }
}

bool SettlingWindow::TryFlip(Link h) {
  const WindowTriangle& s = fronts_.at(h.triangle());
  const Link g = s.across[h.side()];
  const WindowTriangle& t = fronts_.at(g.triangle());
  const WindowVertexId ia = s.corners[h.side()], ib = s.corners[(h.side() + 1) % 3];
  const WindowVertexId ic = s.corners[(h.side() + 2) % 3], id = t.corners[(g.side() + 2) % 3];
  const WindowVertex &a = fronts_.at(ia), &b = fronts_.at(ib), &c = fronts_.at(ic), &d = fronts_.at(id);
  if (std::min({a.depth, b.depth, c.depth, d.depth}) + 1 < kMoveDepth) return false;
  const double one_after = MinSquaredSine(c.position, d.position, b.position);
  if (one_after < std::min(sines_[h.triangle().index()], sines_[g.triangle().index()])) return false;
  const double before =
      std::min(MinSquaredSine(a.position, b.position, c.position), MinSquaredSine(b.position, a.position, d.position));
  const double after = std::min(one_after, MinSquaredSine(d.position, c.position, a.position));
  if (after <= kMinFlipGain * before) return false;
  const auto agreement = [](const WindowVertex& p, const WindowVertex& q, const WindowVertex& r) {
    return NormalAgreement(p.position, q.position, r.position, p.source.normal, q.source.normal, r.source.normal);
  };
  const double old_agreement = std::min(agreement(a, b, c), agreement(b, a, d));
  const double new_agreement = std::min(agreement(c, d, b), agreement(d, c, a));
  if (new_agreement < std::min(kMinFlipNormalCosine, old_agreement)) return false;
  NoteChange(h.triangle());
  NoteChange(g.triangle());
  if (fronts_.EdgeExists(ic, id)) return false;  // perhaps not for long: the note has it looked at again
  fronts_.Flip(h);
  sines_[h.triangle().index()] = SquaredSineOf(h.triangle());
  sines_[g.triangle().index()] = SquaredSineOf(g.triangle());
  return true;
}

double SettlingWindow::SquaredSineOf(WindowTriangleId id) const {
  const WindowTriangle& t = fronts_.at(id);
  return MinSquaredSine(fronts_.at(t.corners[0]).position, fronts_.at(t.corners[1]).position,
                        fronts_.at(t.corners[2]).position);
}

// The triangle changed, and with it what can be had from its sides and corners: the next sweeps look at them again.
void SettlingWindow::NoteChange(WindowTriangleId id) {
  if (changed_.size() <= id.index()) changed_.resize(id.index() + 1), sines_.resize(id.index() + 1);
  changed_[id.index()] = clock_;
  for (const WindowVertexId v : fronts_.at(id).corners) is_search_due_[v.index()] = true;
}

void SettlingWindow::FlipSweep() {
  const uint32_t since = last_flips_;
  last_flips_ = ++clock_;
  for (const WindowTriangleId t : around_) {
    if (fronts_.at(t).alive && changed_[t.index()] >= since) sines_[t.index()] = SquaredSineOf(t);
  }
  for (const WindowTriangleId t : around_) {
    for (int side = 0; side < 3 && fronts_.at(t).alive; ++side) {
      const Link across = fronts_.at(t).across[side];
      if (!across.is_half_edge() || across.triangle() < t || !IsAround(across.triangle())) continue;
      if (changed_[t.index()] < since && changed_[across.triangle().index()] < since) continue;
      if (std::min(sines_[t.index()], sines_[across.triangle().index()]) >= kRoundSineSquared) continue;
      if (TryFlip(Link::HalfEdge(t, side))) ++counts_.flips;
    }
  }
}

bool SettlingWindow::GatherRing(WindowVertexId v) {
  ring_.clear();
  return fronts_.VisitFan(v, [&](WindowTriangleId t, int corner) {
    const WindowTriangle& triangle = fronts_.at(t);
    const Vec3& from =
        ring_.empty() ? fronts_.at(triangle.corners[corner == 2 ? 0 : corner + 1]).position : ring_.back().to;
    const Vec3& to = fronts_.at(triangle.corners[corner == 0 ? 2 : corner - 1]).position;
    const double opposite2 = SquaredDistance(from, to);
    ring_.push_back({from, to, opposite2, std::sqrt(opposite2), t, corner});
  });
}

// The least `measure` of the triangles around a vertex at `place`, or −1 when one of them turns against the normal; any value
// below `floor` where the least is below it.
template <class Measure>
double SettlingWindow::WorstAround(const Vec3& place, const Vec3& normal, Measure measure, double floor) const {
  double worst = std::numeric_limits<double>::infinity();
  Side from(ring_.front().from - place);  // each spoke begins where the last one ended
  for (const Spoke& s : ring_) {
    const Side to(s.to - place);
    const Vec3 area = Cross(from.vector, to.vector);
    const double area2 = SquaredNorm(area);
    if (FacesAgainst(area, area2, normal)) return -1;
    worst = std::min(worst, measure(place, s, from, to, area2));
    if (worst < floor) break;
    from = to;
  }
  return worst;
}

// Moves the vertex to the surface next to `target` if the worst measure around it does not fall below `worst` (updated).
template <class Measure>
bool SettlingWindow::TryMove(WindowVertexId id, const Vec3& target, Measure measure, double& worst) {
  WindowVertex& v = fronts_.at(id);
  const SourcePoint moved = surface_.Snap(v.source, target);
  const double after = WorstAround(moved.position, moved.normal, measure, worst);
  if (after < worst || after < 0) return false;
  worst = after;
  v.source = moved;
  v.position = moved.position;
  for (const Spoke& s : ring_) NoteChange(s.triangle);
  return true;
}

void SettlingWindow::SmoothSweep() {
  for (const WindowVertexId id : chosen_) {
    WindowVertex& v = fronts_.at(id);
    if (!v.alive || !GatherRing(id)) continue;
    Vec3 sum;
    double weights = 0, worst = std::numeric_limits<double>::infinity();
    Side from(ring_.front().from - v.position);
    for (const Spoke& s : ring_) {
      const Side to(s.to - v.position);
      const Vec3 area = Cross(from.vector, to.vector);
      const double area2 = SquaredNorm(area);
      worst =
          FacesAgainst(area, area2, v.source.normal) ? -1 : std::min(worst, kMinSine(v.position, s, from, to, area2));
      if (s.opposite2 > 0) {
        const double w = std::sqrt(area2) / s.opposite2;
        sum += w / 3 * (from.vector + to.vector);
        weights += w;
      }
      from = to;
    }
    if (weights <= 0) continue;
    Vec3 offset = sum / weights;
    offset = offset - Dot(offset, v.source.normal) * v.source.normal;
    if (SquaredNorm(offset) < kLeastSmoothing * kLeastSmoothing * ring_.front().opposite2) continue;
    TryMove(id, v.position + offset, kMinSine, worst);
  }
}

void SettlingWindow::SearchSweep() {
  for (const WindowVertexId id : chosen_) {
    WindowVertex& v = fronts_.at(id);
    if (!is_search_due_[id.index()] || !v.alive || !GatherRing(id)) continue;
    is_search_due_[id.index()] = false;
    double worst = WorstAround(v.position, v.source.normal, kRadiusRatio, kNoFloor);
    if (worst >= kSearchBelow) continue;
    double spoke = 0;
    for (const Spoke& s : ring_) spoke += Distance(v.position, s.from) / static_cast<double>(ring_.size());
    for (const double step : kSearchSteps) {
      const Vec3 n = v.source.normal;
      const Vec3 u = Normalized(Cross(n, std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), w = Cross(n, u);
      const Vec3 start = v.position;
      Vec3 best = start;
      double best_worst = worst;
      for (const auto& [x, y] :
           {std::pair{1.0, 0.0}, {0.5, 0.866}, {-0.5, 0.866}, {-1.0, 0.0}, {-0.5, -0.866}, {0.5, -0.866}}) {
        const Vec3 target = start + step * spoke * (x * u + y * w);
        const double trial = WorstAround(target, n, kRadiusRatio, best_worst);
        if (trial > best_worst) best = target, best_worst = trial;
      }
      if (best_worst > worst) TryMove(id, best, kRadiusRatio, worst);
    }
  }
}

// Loops along which every triangulation is bad leave slivers around vertices that flips and moves can't save: a corner of one goes.
void SettlingWindow::RemovalSweep() {
  const uint32_t since = last_removals_;
  last_removals_ = ++clock_;
  for (const WindowTriangleId id : around_) {
    if (changed_[id.index()] < since) continue;
    for (int i = 0; i < 3; ++i) {
      const WindowTriangle& t = fronts_.at(id);
      if (!t.alive) break;
      if (!IsSliver(fronts_.at(t.corners[0]).position, fronts_.at(t.corners[1]).position,
                    fronts_.at(t.corners[2]).position)) {
        break;
      }
      NoteChange(id);  // what is around it may change: the next sweep looks again
      if (TryRemoval(t.corners[i])) break;
    }
  }
}

// Replaces the triangles around a vertex by the roundest filling of its ring, if that is rounder than they are.
bool SettlingWindow::TryRemoval(WindowVertexId id) {
  const WindowVertex& v = fronts_.at(id);
  if (!IsReached(v) || v.on_rim) return false;
  std::vector<WindowVertexId> ring;  // clockwise, as the front will run
  std::vector<WindowTriangleId> star;
  bool free = fronts_.VisitFan(id, [&](WindowTriangleId t, int corner) {
    ring.push_back(fronts_.at(t).corners[(corner + 1) % 3]);
    star.push_back(t);
  });
  std::reverse(ring.begin(), ring.end());
  // What fills the ring takes the places of the star, and the sweeps after this one go by them.
  free = free && std::all_of(star.begin(), star.end(), [&](WindowTriangleId t) { return IsAround(t); });
  free = free && ring.size() <= kMaxRing &&
         std::none_of(ring.begin(), ring.end(), [&](WindowVertexId r) { return fronts_.at(r).frozen(); });
  std::vector<WindowVertexId> sorted = ring;
  std::sort(sorted.begin(), sorted.end());
  if (!free || ring.size() < 4 || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return false;
  double before = std::numeric_limits<double>::infinity(), agreement = 1;
  for (const WindowTriangleId t : star) {
    const WindowVertex* c[3];
    for (int i = 0; i < 3; ++i) c[i] = &fronts_.at(fronts_.at(t).corners[i]);
    before = std::min(before, RadiusRatio(c[0]->position, c[1]->position, c[2]->position));
    agreement = std::min(agreement, NormalAgreement(c[0]->position, c[1]->position, c[2]->position, c[0]->source.normal,
                                                    c[1]->source.normal, c[2]->source.normal));
  }
  double after = 0;
  std::vector<ClosureStep> steps;
  if (!FillRing(ring, std::min(agreement, kMinMoveNormalCosine), after, steps) || after <= before) return false;
  fronts_.Remove(star);
  for (const ClosureStep& s : steps) {
    const FrontEdgeId base = fronts_.FindEdge(ring[s.last], ring[s.first]);
    NoteChange(fronts_.Connect(base, fronts_.CornerOnLoop(base, ring[s.apex]), TriangleKind::kClosing).triangle);
  }
  return true;
}

// The filling with the least sum of 1 / ratio², and its least ratio. `least_agreement`: of its normals with those at the corners.
bool SettlingWindow::FillRing(const std::vector<WindowVertexId>& ring, double least_agreement, double& worst,
                              std::vector<ClosureStep>& steps) const {
  const int n = static_cast<int>(ring.size());
  const auto ratio = [&](int first, int apex, int last) {
    return RadiusRatio(fronts_.at(ring[last]).position, fronts_.at(ring[apex]).position,
                       fronts_.at(ring[first]).position);
  };
  const auto weight = [&](int first, int apex, int last) -> double {
    for (const auto& [i, j] : {std::pair{first, apex}, {apex, last}, {first, last}}) {
      const bool on_ring = j == i + 1 || (i == 0 && j == n - 1);
      if (!on_ring && fronts_.EdgeExists(ring[i], ring[j])) return -1;
    }
    const WindowVertex &p = fronts_.at(ring[last]), &q = fronts_.at(ring[apex]), &r = fronts_.at(ring[first]);
    if (NormalAgreement(p.position, q.position, r.position, p.source.normal, q.source.normal, r.source.normal) <
        least_agreement) {
      return -1;
    }
    const double quality = ratio(first, apex, last);
    return quality > 0 ? 1 / (quality * quality) : -1;
  };
  std::optional<std::vector<ClosureStep>> found = TriangulateLoop(n, weight);
  if (!found) return false;
  steps = *std::move(found);
  worst = std::numeric_limits<double>::infinity();
  for (const ClosureStep& s : steps) worst = std::min(worst, ratio(s.first, s.apex, s.last));
  return true;
}

// Of the centroids, before the first sweep of the fit: it moves places along the normal by a fraction of an edge, which hardly moves
// their feet.
void SettlingWindow::FindFeet() {
  feet_.resize(around_.size());
  for (uint32_t i = 0; i < around_.size(); ++i) {
    const WindowTriangle& t = fronts_.at(around_[i]);
    if (!t.alive) continue;
    const WindowVertex* v[3] = {&fronts_.at(t.corners[0]), &fronts_.at(t.corners[1]), &fronts_.at(t.corners[2])};
    const Vec3 centroid = (v[0]->position + v[1]->position + v[2]->position) / 3.0;
    feet_[i] = surface_.Foot(v[0]->source, centroid).position;
  }
}

// The shift along the normal that makes the surface's signed deviations from the triangles around least in the mean square, by the
// rule for squares that takes the corners (1/12 of each triangle's area) and the centroid (3/4). The middles of the sides tell hardly
// more, and cost three times the walks.
void SettlingWindow::FitVertex(WindowVertexId id) {
  WindowVertex& v = fronts_.at(id);
  const Vec3 n = v.source.normal;
  double numerator = 0, denominator = 0, spoke = 0, total_area = 0;
  double least_edge2 = std::numeric_limits<double>::infinity();  // of the triangles' longest edges
  const auto sample = [&](const Vec3& place, const Vec3& foot, double weight, double share) {
    numerator += weight * share * Dot(foot - place, n);
    denominator += weight * share * share;
  };
  Side from(ring_.front().from - v.position);
  for (const Spoke& s : ring_) {
    const Side to(s.to - v.position);
    const double area = 0.5 * Norm(Cross(from.vector, to.vector));
    total_area += area;
    least_edge2 = std::min(least_edge2, std::max({s.opposite2, from.squared, to.squared}));
    spoke += from.length / static_cast<double>(ring_.size());
    sample((v.position + s.from + s.to) / 3.0, feet_[place_in_around_[s.triangle.index()]], 0.75 * area, 1.0 / 3);
    from = to;
  }
  sample(v.position, v.source.position, total_area / 12, 1);
  if (!(denominator > 0)) return;
  const double offset = Dot(v.position - v.source.position, n) + numerator / denominator;
  const double bound = std::min(options_.max_error, options_.error_per_length * std::sqrt(least_edge2));
  const double limit = std::min(kMaxFitPerLength * spoke, kFitPerErrorBound * bound);
  const Vec3 target = v.source.position + std::clamp(offset, -limit, limit) * n;
  if (SquaredDistance(target, v.position) <= kSlightFit * kSlightFit * spoke * spoke) {
    v.position = target;
    return;
  }
  const double floor = kFitMayLoseQuality * WorstAround(v.position, n, kRadiusRatio, kNoFloor);
  const double after = WorstAround(target, n, kRadiusRatio, floor);
  if (after >= floor && after >= 0) v.position = target;
}

void SettlingWindow::FitSweep() {
  for (const WindowVertexId id : chosen_) {
    if (!fronts_.at(id).alive || !GatherRing(id)) continue;
    // A filling beside what was chosen has no feet.
    if (std::all_of(ring_.begin(), ring_.end(), [&](const Spoke& s) { return IsAround(s.triangle); })) FitVertex(id);
  }
}

// The sweeps, over what is chosen.
void SettlingWindow::Polish(const Context& context, bool begins_with_flips) {
  clock_ = 1, last_flips_ = last_removals_ = 0;
  changed_.assign(fronts_.triangle_slots(), clock_);
  sines_.resize(fronts_.triangle_slots());
  is_search_due_.assign(fronts_.vertex_slots(), true);
  const auto stopped = [&] { return !context.CheckStop().ok(); };
  for (int sweep = 0; sweep < kImproveSweeps && !stopped(); ++sweep) {
    if (options_.flips && (sweep > 0 || begins_with_flips)) FlipSweep();
    if (options_.smooth) SmoothSweep();
  }
  for (int sweep = 0; sweep < kSearchSweeps && options_.smooth && !stopped(); ++sweep) {
    RemovalSweep();
    if (options_.flips) FlipSweep();
    SearchSweep();
  }
  if (options_.fit && !stopped()) FindFeet();
  for (int sweep = 0; sweep < kFitSweeps && options_.fit && !stopped(); ++sweep) FitSweep();
}

std::vector<Fault> SettlingWindow::Improve(const Context& context) {
  MeasureDepth();
  ChooseVertices();
  Polish(context, true);
  if (std::isfinite(options_.max_error)) KeepMaxError(context);
  if (!context.CheckStop().ok()) return {};
  if (options_.smooth) FindSlivers();
  if (std::isfinite(options_.max_error) && IsBeyondMended()) FindBeyond();
  return Audit();
}

// Deep enough to go to the sink.
bool SettlingWindow::Leaves(WindowTriangleId id) const {
  const WindowTriangle& t = fronts_.at(id);
  return t.alive && std::all_of(t.corners.begin(), t.corners.end(),
                                [&](WindowVertexId v) { return fronts_.at(v).depth >= kEmitDepth; });
}

bool SettlingWindow::IsReached(WindowTriangleId id) const {
  const WindowTriangle& t = fronts_.at(id);
  const auto is_reached = [&](WindowVertexId v) { return fronts_.at(v).depth >= kMoveDepth; };
  return t.alive && std::all_of(t.corners.begin(), t.corners.end(), is_reached);
}

// The triangles around that may be refined, without those that what the fit has seen of them tells to need it least.
std::vector<WindowTriangleId> SettlingWindow::DoubtfulTriangles() {
  std::vector<WindowTriangleId> doubtful;
  for (size_t i = 0; i < around_.size(); ++i) {
    const WindowTriangleId t = around_[i];
    if (IsReached(t) && !(i < feet_.size() && refinement_.NeedNotBeMeasured(t, feet_[i]))) doubtful.push_back(t);
  }
  return doubtful;
}

// What is to be moved around new vertices: they and what lies within two rings.
void SettlingWindow::ChooseNear(const std::vector<WindowVertexId>& made) {
  std::vector<uint8_t> wanted(fronts_.vertex_slots(), 0);
  std::vector<WindowVertexId> near = made;
  for (int ring = 0; ring < kRefinementRings; ++ring) {
    for (size_t i = 0, count = near.size(); i < count; ++i) {
      fronts_.VisitFan(near[i], [&](WindowTriangleId t, int) {
        for (const WindowVertexId v : fronts_.at(t).corners) {
          if (!wanted[v.index()]) wanted[v.index()] = 1, near.push_back(v);
        }
      });
    }
  }
  near = MadeUnique(near, fronts_.vertex_slots());
  chosen_.clear();
  for (const WindowVertexId v : near) {
    wanted[v.index()] = IsReached(fronts_.at(v));
    if (wanted[v.index()] && !fronts_.at(v).on_rim) chosen_.push_back(v);
  }
  GatherAround(wanted);
}

// The corners of poor triangles among those given.
void SettlingWindow::RoundOff(const std::vector<WindowTriangleId>& triangles) {
  std::vector<WindowVertexId> corners;
  for (const WindowTriangleId id : triangles) {
    const WindowTriangle& t = fronts_.at(id);
    if (!t.alive) continue;
    const auto place = [&](int i) { return fronts_.at(t.corners[i]).position; };
    if (RadiusRatio(place(0), place(1), place(2)) < kSearchBelow)
      corners.insert(corners.end(), t.corners.begin(), t.corners.end());
  }
  refinement_.RoundOff(MadeUnique(corners, fronts_.vertex_slots()));
  refinement_.TurnAway(triangles);
}

double SettlingWindow::RefinedBeyond(const SettlingOptions& options) {
  return std::isfinite(options.max_insertions) ? kFarBeyondMaxError * options.max_error : options.max_error;
}

size_t SettlingWindow::InsertionsLeft(double excess) const {
  return insertion_budget_.Left(counts_.insertions, counts_.triangles + fronts_.triangle_count(), excess);
}

// Where the insertions are spent only what is farther off is refined, until they are level with the triangles again: as where
// the output is finer than the input's edges, whose turns no finer triangle makes smaller.
void SettlingWindow::PaceInsertions() {
  if (IsBeyondMended()) return;
  slack_ = InsertionsLeft(1) == 0 ? slack_ * kSlackStep : std::max(1.0, slack_ / kSlackStep);
  refinement_.SetSlack(slack_);
  counts_.largest_deviation =
      std::max(counts_.largest_deviation, refinement_.bound());  // what is within is not told apart
}

// Refines until every triangle keeps the bound: first by halved sides, each time moved to good places; what these moves can't keep
// within the bound by plain insertions; and what no good triangle can, by any.
void SettlingWindow::KeepMaxError(const Context& context) {
  PaceInsertions();
  std::vector<WindowTriangleId> all = around_;
  const auto refine = [&](Refinement::Manner manner) {
    const std::vector<WindowVertexId> made =
        refinement_.Refine(DoubtfulTriangles(), manner, [this](double excess) { return InsertionsLeft(excess); });
    counts_.insertions += made.size();
    if (made.empty() || !context.CheckStop().ok()) return false;
    ChooseNear(made);
    if (manner == Refinement::Manner::kSides)
      Polish(context, false);  // the new valences are worth something only when all has moved
    all.insert(all.end(), around_.begin(), around_.end());
    return true;
  };
  int round = 0;
  while (round < kMovedRounds && refine(Refinement::Manner::kSides)) ++round;
  while (round < kMovedRounds + kPlainRounds && refine(Refinement::Manner::kWorstPlace)) ++round;
  around_ = MadeUnique(all, fronts_.triangle_slots());
  feet_.clear();
  if (IsBeyondMended()) {
    const auto is_within = [&](WindowTriangleId t) { return !IsBeyond(t); };
    around_.erase(std::remove_if(around_.begin(), around_.end(), is_within), around_.end());
    for (round = 0; round < kLastRounds && refine(Refinement::Manner::kAnyShape); ++round) continue;
  }
  if (options_.smooth) RoundOff(all);
  around_ = MadeUnique(all, fronts_.triangle_slots());  // for those who look for what has changed
}

// Where a count is wanted the bound is what comes of it.
bool SettlingWindow::IsBeyondMended() const { return !insertion_budget_.IsLimited(); }

// Whether to look closer at what a triangle was measured to deviate. Where a count is wanted only the largest is told of.
bool SettlingWindow::MayBeLargest(double deviation) const {
  return IsBeyondMended() || kMostPerMeasured * deviation > counts_.largest_deviation;
}

bool SettlingWindow::IsBeyond(WindowTriangleId id) {
  if (fronts_.at(id).alive && fronts_.at(id).deviation < 0) refinement_.Measure(id);
  return fronts_.at(id).alive && fronts_.at(id).deviation > refinement_.bound();
}

void SettlingWindow::FindSlivers() {
  slivers_.clear();
  for (const WindowTriangleId id : around_) {
    const WindowTriangle& t = fronts_.at(id);
    if (!t.alive || t.audit != AuditMark::kNone || !Leaves(id)) continue;
    if (IsSliver(fronts_.at(t.corners[0]).position, fronts_.at(t.corners[1]).position,
                 fronts_.at(t.corners[2]).position)) {
      slivers_.push_back(id);
    }
  }
}

void SettlingWindow::FindBeyond() {
  beyond_.clear();
  for (uint32_t i = 0; i < fronts_.triangle_slots(); ++i) {
    const WindowTriangleId id(i);
    if (Leaves(id) && IsBeyond(id)) beyond_.push_back(id);
  }
}

Vec3 SettlingWindow::WhereTheyMeet(WindowTriangleId s, WindowTriangleId t) const {
  const auto place = [&](WindowTriangleId id, int corner) {
    return fronts_.at(fronts_.at(id).corners[corner]).position;
  };
  return PlaceOfMeeting({place(s, 0), place(s, 1), place(s, 2)}, {place(t, 0), place(t, 1), place(t, 2)});
}

// The corners of pairs that intersect go back to where they were before the fit; `gently`: where the bound is kept without it.
void SettlingWindow::Unfit(const WindowTrianglePairs& pairs, bool gently, MovedVertices& moved) {
  for (const auto& [s, t] : pairs) {
    for (const WindowTriangleId id : {s, t}) {
      for (const WindowVertexId corner : fronts_.at(id).corners) {
        WindowVertex& v = fronts_.at(corner);
        if (v.frozen() || v.position == v.source.position) continue;
        if (gently) {
          refinement_.TryMove(corner, v.source.position);
        } else {
          moved.push_back({corner, v.position});
          Place(corner, v.source.position);
        }
      }
    }
  }
}

void SettlingWindow::Place(WindowVertexId v, const Vec3& place) {
  fronts_.at(v).position = place;
  fronts_.VisitFan(v, [&](WindowTriangleId around, int) { fronts_.at(around).deviation = -1; });
}

// What intersects still, without the fit.
WindowTrianglePairs SettlingWindow::AuditUnfitted(WindowTrianglePairs pairs) {
  const auto leaves = [this](WindowTriangleId t) { return Leaves(t); };
  const bool keeps_bound = std::isfinite(options_.max_error) && IsBeyondMended();
  MovedVertices moved;
  for (int attempt = 0; attempt < 2 && !pairs.empty(); ++attempt) {
    Unfit(pairs, keeps_bound && attempt == 0, moved);
    pairs = FindIntersections(fronts_, leaves);
  }
  if (!keeps_bound || pairs.empty() || moved.empty()) return pairs;
  std::vector<WindowVertexId> helpless;  // where it was no use, the bound is kept at least
  for (const auto& [s, t] : pairs) {
    for (const WindowTriangleId id : {s, t})
      helpless.insert(helpless.end(), fronts_.at(id).corners.begin(), fronts_.at(id).corners.end());
  }
  helpless = MadeUnique(helpless, fronts_.vertex_slots());
  for (const auto& [v, before] : moved) {
    if (std::binary_search(helpless.begin(), helpless.end(), v)) Place(v, before);
  }
  return FindIntersections(fronts_, leaves);
}

std::vector<Fault> SettlingWindow::Audit() {
  std::vector<Fault> faults;
  auto pairs = FindIntersections(fronts_, [this](WindowTriangleId t) { return Leaves(t); });
  if (options_.fit && !pairs.empty()) pairs = AuditUnfitted(std::move(pairs));
  for (const auto& [s, t] : pairs) {
    if (fronts_.at(s).audit != AuditMark::kNone || fronts_.at(t).audit != AuditMark::kNone) continue;
    const Vec3 place = WhereTheyMeet(s, t);
    faults.push_back({s, place});
    faults.push_back({t, place});
  }
  return faults;
}

// The vertex's id in the output; a new one, and the vertex to `vertices`, unless it is a joint that was sent from another patch.
VertexId SettlingWindow::NameOf(const WindowVertex& v, std::vector<OutputVertex>& vertices) {
  Joint* const joint = v.joint == kNoJoint ? nullptr : &fronts_.joint(v.joint);
  if (joint != nullptr && joint->emitted.valid()) return joint->emitted;
  const VertexId name(next_output_++);
  // Where patches turn their backs on each other their normals cancel out: either is as good.
  const Vec3 mean = joint == nullptr ? Vec3{} : Normalized(joint->normal);
  vertices.push_back({v.position, mean == Vec3{} ? v.source.normal : mean, v.joint, v.sheet});
  if (joint != nullptr) joint->emitted = name;
  return name;
}

CornerWedges SettlingWindow::WedgesOf(const WindowTriangle& t, std::vector<OutputWedge>& wedges) {
  CornerWedges out;
  for (int i = 0; i < 3; ++i) {
    WindowVertex& v = fronts_.at(t.corners[i]);
    if (v.wedge == kNoWedge) {
      v.wedge = next_wedge_++;
      wedges.push_back({v.source.patch, v.source.u, v.source.v, v.source.normal});
    }
    out[i] = v.wedge;
  }
  return out;
}

absl::Status SettlingWindow::Emit(bool everything) {
  std::vector<WindowTriangleId> leaving;
  for (uint32_t i = 0; i < fronts_.triangle_slots(); ++i) {
    const WindowTriangle& t = fronts_.at(WindowTriangleId(i));
    if (t.alive && (everything || Leaves(WindowTriangleId(i)))) leaving.push_back(WindowTriangleId(i));
  }
  if (leaving.empty()) return absl::OkStatus();
  std::vector<OutputVertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<TriangleKind> kinds;
  std::vector<OutputWedge> wedges;
  std::vector<CornerWedges> corners;
  std::vector<uint32_t> faces;
  for (const WindowTriangleId id : leaving) {
    const WindowTriangle& t = fronts_.at(id);
    Triangle out;
    Vec3 place[3];
    for (int i = 0; i < 3; ++i) {
      WindowVertex& v = fronts_.at(t.corners[i]);
      if (!v.emitted.valid()) v.emitted = NameOf(v, vertices);
      out[i] = v.emitted;
      place[i] = v.position;
    }
    triangles.push_back(out);
    kinds.push_back(t.kind);
    if (options_.wedges) {
      corners.push_back(WedgesOf(t, wedges));
      faces.push_back(fronts_.at(t.corners[0]).source.patch);
    }
    if (std::isfinite(options_.max_error)) {
      if (t.deviation < 0) refinement_.Measure(id);
      if (t.deviation > options_.max_error && MayBeLargest(t.deviation))
        refinement_.Enclose(id, IsBeyondMended() ? 0 : counts_.largest_deviation);
      if (t.deviation > counts_.largest_deviation)
        counts_.largest_deviation = t.deviation, counts_.farthest_place = (place[0] + place[1] + place[2]) / 3.0;
      counts_.beyond_max_error += t.deviation > options_.max_error;
    }
    counts_.quality.Add(place[0], place[1], place[2]);
    for (int i = 0; i < 3; ++i)
      counts_.longest_edge = std::max(counts_.longest_edge, Distance(place[i], place[(i + 1) % 3]));
    ++counts_.by_kind[static_cast<int>(t.kind)];
    if (t.audit == AuditMark::kFault) faults_.push_back((place[0] + place[1] + place[2]) / 3.0);
  }
  counts_.vertices += vertices.size();
  counts_.triangles += triangles.size();
  const std::vector<VertexId> finalised = fronts_.Settle(leaving);
  return sink_.Append(
      {vertices, triangles, finalised, fronts_.front_edge_count(), kinds, wedges, corners, faces, {}, {}});
}

}  // namespace meshfront
