// Refine: each triangle that is beyond the bound, the worst first, unless a neighbour's turn has changed it already.
//   kSides       its longest side is halved, or all of them where one would not do. Smoothing and flips round the halves off.
//   kWorstPlace  the side next to the worst place, or the triangle, is split right there
//   kAnyShape    the same for what no round triangle can mend: at rims and creases whose edges are given
// Rejected: taking the place back and advancing again with shorter edges. The field's slope carries these four edges far, so that one
// bad triangle costs dozens.
#include "core/front/refinement.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

// How far the surface's corners may be from the output, in parts of the bound: where that is certain it is one of the other way.
constexpr double kDetailPerBound = 1.0, kDetailPerCertainBound = 1.25;
constexpr double kMaxDetail = 1.0;  // of the triangle's longest side
constexpr int kMostTries = 6;       // to come nearer to one place: what is as far after that lies over other triangles
constexpr int kMostSeenFartherOn = 64;  // corners, in search of the triangles that a place belongs to
constexpr double kFarBeyond = 1.5;      // of the bound: one halved side would not do
constexpr double kShortestPerGuidance =
    0.0625;  // no shorter edges than this part of what the field asks for: bounds a place
constexpr double kMinAgreement =
    0.3;  // cosine between the normals of new triangles and of the surface at their corners
constexpr double kLeewayFarBeyond =
    0.2;  // … so much less for a count, where places are far beyond: on crests as thin as the edges are long
constexpr double kLeastAgreement = 0;  // … where those that they replace have less than that
constexpr double kMinRadiusRatio = 0.2,
                 kMinRatioForCount = 0.35;  // of new triangles; where a count is wanted and the place is not far beyond
constexpr double kMinRimRatio = 0.4;        // … of those on a rim, which nothing turns away from it
constexpr double kMinAnyRatio = 0.1;        // … where any shape will do
constexpr double kMinLastRatio = 0.03;      // … beside what has settled, so that it can't be taken back
constexpr double kLiftedTo = 0.97;          // of the bound: where a worst place is moved
constexpr double kLeastLifted = 0.9, kMostLifted = 1.4;  // … from where
constexpr int kLiftSteps = 5;                            // there may be several such places
constexpr double kLeastLever = 0.2;      // sum of the squared weights of what may move: it would move too far
constexpr double kMinLiftedRatio = 0.3;  // radius ratio of the triangles around
constexpr double kMinTurnedRatio = 0.8;
constexpr double kEnclosingStep = 1.05;
constexpr int kEnclosingSteps = 100;
constexpr double kMinEqualizedRatio = 0.4;
constexpr double kRound =
    0.9;  // radius ratio of the worst triangle around a vertex, from which on it is left where it is
constexpr double kPoor = 0.7;  // radius ratio of a triangle below which its sides are tried the other way
constexpr int kRoundingSweeps = 4;
constexpr double kRoundingSteps[] = {0.2, 0.1, 0.05};  // in parts of the mean spoke
constexpr double kNearSide = 0.25;  // weight of the opposite corner below which a place lies next to a side
constexpr double kNoFloor = -2;     // no worst is lower
constexpr double kAtCorner = 0.9;   // weight of a corner above which no vertex fits between it and the place

// The weights of a place in a triangle; negative beside it, all 0 where the triangle has no area.
std::array<double, 3> WeightsAt(const std::array<Vec3, 3>& p, const Vec3& place) {
  const Vec3 area = AreaVector(p[0], p[1], p[2]);
  const double area2 = SquaredNorm(area);
  std::array<double, 3> weight = {0, 0, 0};
  for (int i = 0; i < 3 && area2 > 0; ++i)
    weight[i] = Dot(AreaVector(place, p[(i + 1) % 3], p[(i + 2) % 3]), area) / area2;
  return weight;
}

}  // namespace

Deviation Refinement::Measure(WindowTriangleId id) {
  const Deviation deviation = MeasureCorners(fronts_.at(id).corners);
  fronts_.at(id).deviation = deviation.largest;
  return deviation;
}

void Refinement::Enclose(WindowTriangleId id, double known) {
  WindowTriangle& t = fronts_.at(id);
  const std::array<PlaceAndFoot, 3> places = PlacesOf(t.corners);
  double within = std::max(t.deviation, max_error_);
  for (int step = 0; step < kEnclosingSteps; ++step, within *= kEnclosingStep) {
    if (within * kEnclosingStep <= known) continue;
    if (DeviationMeter(surface_, within).Measure(places).is_kept) break;
  }
  t.deviation = within;
}

std::array<PlaceAndFoot, 3> Refinement::PlacesOf(const Corners& corners) const {
  std::array<PlaceAndFoot, 3> places;
  for (int i = 0; i < 3; ++i) places[i] = {fronts_.at(corners[i]).position, fronts_.at(corners[i]).source};
  return places;
}

bool Refinement::NeedNotBeMeasured(WindowTriangleId id, const Vec3& centroid_foot) {
  WindowTriangle& t = fronts_.at(id);
  if (certain_ || !meter_.SeemsNear(PlacesOf(t.corners), &centroid_foot)) return false;
  t.deviation = 0;
  return true;
}

Refinement::Measurement& Refinement::PlaceToRemember(const Corners& c) {
  remembered_.resize(kRemembered);
  return remembered_[(c[0].index() * 0x9e3779b1u + c[1].index() * 0x85ebca6bu + c[2].index()) % kRemembered];
}

Deviation Refinement::MeasureCorners(const Corners& corners) {
  const std::array<PlaceAndFoot, 3> places = PlacesOf(corners);
  Measurement& last = PlaceToRemember(corners);
  if (last.bound != max_error_ || last.places != places) {
    if (!certain_ && meter_.SeemsNear(places, nullptr)) return {};
    last.deviation = meter_.Measure(places);
    last.far_details = meter_.far_details();
    last.places = places, last.bound = max_error_;
  }
  Deviation deviation = last.deviation;
  MeasureDetails(corners, last.far_details, deviation);
  return deviation;
}

// The other way: the surface's corners that lie over the triangle, from the triangles around there.
void Refinement::MeasureDetails(const Corners& corners, const std::vector<FarPlace>& details, Deviation& deviation) {
  if (details.empty()) return;
  const Vec3 normal = Normalized(
      AreaVector(fronts_.at(corners[0]).position, fronts_.at(corners[1]).position, fronts_.at(corners[2]).position));
  const double detail_bound = (certain_ ? kDetailPerCertainBound : kDetailPerBound) * max_error_;
  double longest = 0;
  for (int i = 0; i < 3; ++i)
    longest = std::max(longest, Distance(fronts_.at(corners[i]).position, fronts_.at(corners[(i + 1) % 3]).position));
  for (const FarPlace& far : details) {
    if (Dot(far.above.normal, normal) < kMinAgreement) continue;  // of another side, reached around an edge
    const double enough = std::max(detail_bound, deviation.largest);
    double distance = DistanceAround(far.above.position, corners, enough);
    // Beyond the triangle's own size it belongs to another part of the output, which is not looked at here.
    if (distance <= enough || distance > kMaxDetail * longest) continue;
    distance = DistanceFartherOn(far.above.position, corners, enough, distance);
    if (distance <= enough || TriesAt(far.above.position) >= kMostTries) continue;
    deviation.largest = distance;
    deviation.worst = {far.below, far.above};
    deviation.is_kept = false, deviation.is_of_detail = true;
  }
}

int Refinement::TriesAt(const Vec3& p) const {
  const auto tried = tries_.find({p.x, p.y, p.z});
  return tried == tries_.end() ? 0 : tried->second;
}

// To the triangle and those that share a corner with it, once each; of distances up to `enough` any, the first that is found.
double Refinement::DistanceAround(const Vec3& place, const Corners& corners, double enough) const {
  double least = INFINITY;
  const auto look_at = [&](const Corners& c) { least = std::min(least, DistanceTo(c, place)); };
  look_at(corners);
  for (int i = 0; i < 3; ++i) {
    fronts_.VisitFan(corners[i], [&](WindowTriangleId t, int corner) {
      if (least <= enough) return;
      const Corners& c = fronts_.at(t).corners;
      const WindowVertexId next = c[corner == 2 ? 0 : corner + 1], last = c[corner == 0 ? 2 : corner - 1];
      bool is_known = next == corners[(i + 1) % 3] && last == corners[(i + 2) % 3];
      for (int k = 0; k < i; ++k) is_known |= (next == corners[k]) | (last == corners[k]);
      if (!is_known) look_at(c);
    });
  }
  return least;
}

double Refinement::DistanceTo(const Corners& c, const Vec3& place) const {
  const TrianglePoint at =
      ClosestPointOnTriangle(place, fronts_.at(c[0]).position, fronts_.at(c[1]).position, fronts_.at(c[2]).position);
  return Distance(place, at.position);
}

// Over the triangles, from corner to corner, the nearest to the place first: where the surface has folds, what lies over a triangle
// belongs to others some rings away. Where what has gone to the sink comes nearer than `least`, which is what is known, the
// place was seen to when that was here.
double Refinement::DistanceFartherOn(const Vec3& place, const Corners& corners, double enough, double least) {
  seen_.resize(fronts_.vertex_slots(), 0);
  if (++seen_now_ == 0) std::fill(seen_.begin(), seen_.end(), 0), seen_now_ = 1;
  queue_.clear();
  const auto see = [&](WindowVertexId v) {
    if (std::exchange(seen_[v.index()], seen_now_) == seen_now_) return;
    queue_.push_back({SquaredDistance(fronts_.at(v).position, place), v});
    std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
  };
  for (const WindowVertexId v : corners) see(v);
  for (int visited = 0; visited < kMostSeenFartherOn && !queue_.empty() && least > enough; ++visited) {
    const auto [distance2, v] = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    queue_.pop_back();
    if (fronts_.at(v).frozen() && 2 * distance2 < least * least) return enough;
    fronts_.VisitFan(v, [&](WindowTriangleId t, int) {
      const Corners& c = fronts_.at(t).corners;
      if (least > enough) least = std::min(least, DistanceTo(c, place));
      for (const WindowVertexId corner : c) see(corner);
    });
  }
  return least;
}

std::vector<WindowVertexId> Refinement::Refine(const std::vector<WindowTriangleId>& triangles, Manner manner,
                                               absl::FunctionRef<size_t(double excess)> limit) {
  made_.clear();
  touched_.assign(fronts_.triangle_slots(), 0);
  std::vector<WindowTriangleId> beyond;
  for (const WindowTriangleId t : triangles) {
    if (fronts_.at(t).alive && !Measure(t).is_kept) beyond.push_back(t);
  }
  std::stable_sort(beyond.begin(), beyond.end(), [&](WindowTriangleId s, WindowTriangleId t) {
    return fronts_.at(s).deviation > fronts_.at(t).deviation;
  });
  for (const WindowTriangleId t : beyond) {
    if (IsTouched(t)) continue;
    const Deviation deviation = Measure(t);  // a neighbour's turn may have mended it
    least_ratio_ = kMinRadiusRatio;
    if (deviation.is_kept || TryLift(t, deviation) || TryTurn(t)) continue;
    const double excess = deviation.largest / max_error_;
    least_ratio_ = LeastRatioFor(t, manner, excess);
    is_far_beyond_ = !certain_ && excess > kFarBeyond;
    if (made_.size() >= limit(excess)) continue;
    const size_t before = made_.size();
    RefineAt(t, deviation, manner);
    const Vec3& worst = deviation.worst.foot.position;
    if (deviation.is_of_detail && made_.size() > before) ++tries_[{worst.x, worst.y, worst.z}];
  }
  return made_;
}

double Refinement::RatioOf(const Corners& c) const {
  return RadiusRatio(fronts_.at(c[0]).position, fronts_.at(c[1]).position, fronts_.at(c[2]).position);
}

bool Refinement::MayMove(WindowVertexId id) const {
  const WindowVertex& v = fronts_.at(id);
  return !v.frozen() && !v.on_rim && v.depth >= depth_;
}

// Moves the corners just so far that the worst place comes within the bound: by its weights there, which is the shortest way. Kept
// where no triangle around is beyond the bound then that was not before.
bool Refinement::TryLift(WindowTriangleId id, Deviation deviation) {
  const Corners corners = fronts_.at(id).corners;
  std::array<Vec3, 3> before;
  for (int i = 0; i < 3; ++i) before[i] = fronts_.at(corners[i]).position;
  for (int step = 0; step < kLiftSteps && !deviation.is_kept; ++step) {
    if (!LiftOnce(corners, deviation.worst)) break;
    deviation = MeasureCorners(corners);
  }
  if (deviation.is_kept && KeepsAround(corners, kMinLiftedRatio)) return true;
  for (int i = 0; i < 3; ++i) fronts_.at(corners[i]).position = before[i];
  return false;
}

bool Refinement::LiftOnce(const Corners& corners, const PlaceAndFoot& worst) {
  const Vec3 way = worst.foot.position - worst.place;
  const double gap = Norm(way);
  if (!(gap > kLeastLifted * max_error_) || gap > kMostLifted * max_error_) return false;
  std::array<Vec3, 3> places;
  for (int i = 0; i < 3; ++i) places[i] = fronts_.at(corners[i]).position;
  std::array<double, 3> weight = WeightsAt(places, worst.place);
  double squares = 0;
  for (int i = 0; i < 3; ++i) {
    weight[i] = MayMove(corners[i]) ? std::max(weight[i], 0.0) : 0;
    squares += weight[i] * weight[i];
  }
  if (!(squares > kLeastLever)) return false;
  const Vec3 shift = (1 - kLiftedTo * std::min(1.0, max_error_ / gap)) / squares * way;
  for (int i = 0; i < 3; ++i) fronts_.at(corners[i]).position += weight[i] * shift;
  return true;
}

// Whether the triangles around the corners are not farther beyond the bound than they were. Writes
// their deviations down if so.
bool Refinement::KeepsAround(const Corners& corners, double least_ratio) {
  std::vector<std::pair<WindowTriangleId, double>> now;
  bool keeps = true;
  for (const WindowVertexId v : corners) {
    fronts_.VisitFan(v, [&](WindowTriangleId t, int) {
      const auto is_known = [&](const auto& known) { return known.first == t; };
      if (!keeps || std::any_of(now.begin(), now.end(), is_known)) return;
      const auto& c = fronts_.at(t).corners;
      keeps = RatioOf(c) >= least_ratio;
      if (!keeps) return;
      const Deviation deviation = MeasureCorners(c);
      keeps = deviation.is_kept || deviation.largest <= fronts_.at(t).deviation;
      now.push_back({t, deviation.largest});
    });
  }
  if (!keeps) return false;
  for (const auto& [t, deviation] : now) fronts_.at(t).deviation = deviation;
  return true;
}

bool Refinement::TryMove(WindowVertexId id, const Vec3& place) {
  const Vec3 before = fronts_.at(id).position;
  fronts_.at(id).position = place;
  if (KeepsAround({id, id, id}, 0)) return true;
  fronts_.at(id).position = before;
  return false;
}

bool Refinement::TryTurn(WindowTriangleId t) {
  for (int side = 0; side < 3; ++side) {
    if (TryTurnSide(Link::HalfEdge(t, side))) return true;
  }
  return false;
}

// Turns a side where that leaves two good triangles within the bound.
bool Refinement::TryTurnSide(Link h) {
  const Quad q = QuadAround(h);
  if (!q.is_free) return false;
  const WindowTriangleId s = h.triangle(), t = fronts_.at(s).across[h.side()].triangle();
  if (IsTouched(t)) return false;
  const Corners first = {q.c, q.d, q.b}, second = {q.d, q.c, q.a};
  const double before = std::min(RatioOf(fronts_.at(s).corners), RatioOf(fronts_.at(t).corners));
  if (std::min(RatioOf(first), RatioOf(second)) < std::min(kMinTurnedRatio, before) || !MayTurn(q)) return false;
  if (!MeasureCorners(first).is_kept || !MeasureCorners(second).is_kept) return false;
  Touch(s), Touch(t);
  fronts_.Flip(h);
  Measure(s), Measure(t);
  return true;
}

// Moves vertices to where the worst triangle around them is rounder, as long as none leaves the bound: what was inserted last, and
// what was moved to keep the bound, is not round.
void Refinement::RoundOff(const std::vector<WindowVertexId>& vertices) {
  for (const WindowVertexId v : vertices) {
    if (fronts_.at(v).alive && ValenceOf(v) == 4) TurnTowards(v);
  }
  for (int sweep = 0; sweep < kRoundingSweeps; ++sweep) {
    for (const WindowVertexId v : vertices) {
      if (fronts_.at(v).alive && MayMove(v)) RoundOff(v);
    }
  }
}

// Four triangles around a vertex can't be round. Turns the sides across from it towards it, one of them for good: that with which the
// worst triangle around, once all has moved, is rounder than before.
void Refinement::TurnTowards(WindowVertexId v) {
  std::vector<WindowTriangleId> fan;
  fronts_.VisitFan(v, [&](WindowTriangleId t, int) { fan.push_back(t); });
  for (const WindowTriangleId t : fan) {
    const auto& corners = fronts_.at(t).corners;
    const auto corner = static_cast<int>(std::find(corners.begin(), corners.end(), v) - corners.begin());
    const Link side = Link::HalfEdge(t, (corner + 1) % 3);
    const Quad q = QuadAround(side);
    if (q.is_free && HasBetterValences(q) && TryTurnAndRound(side)) return;
  }
}

// The least ratio of the triangles at a side's four corners.
double Refinement::WorstAround(const Quad& q) const {
  double least = 1;
  for (const WindowVertexId v : {q.a, q.b, q.c, q.d})
    fronts_.VisitFan(v, [&](WindowTriangleId t, int) { least = std::min(least, RatioOf(fronts_.at(t).corners)); });
  return least;
}

// Turns a side and moves the four corners to where that is rounder; takes it back if the worst triangle around is not rounder then.
bool Refinement::TryTurnAndRound(Link h) {
  const Quad q = QuadAround(h);
  if (!q.is_free || !MayTurn(q)) return false;
  if (!MeasureCorners({q.c, q.d, q.b}).is_kept || !MeasureCorners({q.d, q.c, q.a}).is_kept) return false;
  const std::array<WindowVertexId, 4> moved = {q.a, q.b, q.c, q.d};
  std::array<std::pair<SourcePoint, Vec3>, 4> places;
  for (int i = 0; i < 4; ++i) places[i] = {fronts_.at(moved[i]).source, fronts_.at(moved[i]).position};
  const double before = WorstAround(q);
  const WindowTriangleId s = h.triangle(), t = fronts_.at(s).across[h.side()].triangle();
  fronts_.Flip(h);
  Measure(s), Measure(t);
  for (int sweep = 0; sweep < kRoundingSweeps; ++sweep) {
    for (const WindowVertexId v : moved) {
      if (MayMove(v)) RoundOff(v);
    }
  }
  if (WorstAround(q) > before) return true;
  for (int i = 0; i < 4; ++i)
    fronts_.at(moved[i]).source = places[i].first, fronts_.at(moved[i]).position = places[i].second;
  fronts_.Flip(Link::HalfEdge(s, 0));
  for (const WindowVertexId v : moved) fronts_.VisitFan(v, [&](WindowTriangleId around, int) { Measure(around); });
  return false;
}

void Refinement::TurnAway(const std::vector<WindowTriangleId>& triangles) {
  for (const WindowTriangleId t : triangles) {
    for (int side = 0; side < 3 && fronts_.at(t).alive && RatioOf(fronts_.at(t).corners) < kPoor; ++side) {
      if (TryTurnAndRound(Link::HalfEdge(t, side))) break;
    }
  }
}

// The least radius ratio around a vertex at a place, −1 where a triangle turns against the normal; anything below or at `floor` where
// it is.
double Refinement::WorstAround(WindowVertexId id, const Vec3& place, double floor) const {
  double worst = 1;
  const Vec3& normal = fronts_.at(id).source.normal;
  const bool closed = fronts_.VisitFan(id, [&](WindowTriangleId t, int corner) {
    if (worst <= floor) return;
    const auto& c = fronts_.at(t).corners;
    const Vec3 &from = fronts_.at(c[corner == 2 ? 0 : corner + 1]).position,
               &to = fronts_.at(c[corner == 0 ? 2 : corner - 1]).position;
    const Vec3 area = AreaVector(place, from, to);
    worst = std::min(worst, Dot(area, normal) < kMinAgreement * Norm(area) ? -1 : RadiusRatio(place, from, to));
  });
  return closed ? worst : 2;
}

void Refinement::RoundOff(WindowVertexId id) {
  WindowVertex& v = fronts_.at(id);
  double worst = WorstAround(id, v.position, kNoFloor);
  if (worst >= kRound) return;
  double spoke = 0, count = 0;
  fronts_.VisitFan(id, [&](WindowTriangleId t, int corner) {
    spoke += Distance(v.position, fronts_.at(fronts_.at(t).corners[(corner + 1) % 3]).position), ++count;
  });
  for (const double step : kRoundingSteps) {
    const Vec3 n = v.source.normal;
    const Vec3 u = Normalized(Cross(n, std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), w = Cross(n, u);
    Vec3 best;
    double best_worst = worst;
    for (const auto& [x, y] :
         {std::pair{1.0, 0.0}, {0.5, 0.866}, {-0.5, 0.866}, {-1.0, 0.0}, {-0.5, -0.866}, {0.5, -0.866}}) {
      const Vec3 offset = step * spoke / count * (x * u + y * w);
      const double trial = WorstAround(id, v.position + offset, best_worst);
      if (trial > best_worst) best = offset, best_worst = trial;
    }
    if (best_worst <= worst) continue;
    const SourcePoint source = v.source;
    const Vec3 position = v.position;
    const double height = Dot(position - source.position, n);  // as the fit or a lift left it
    v.source = surface_.Snap(source, source.position + best);
    v.position = v.source.position + height * v.source.normal;
    const double after = WorstAround(id, v.position, worst);
    if (after > worst && KeepsAround({id, id, id}, kMinLiftedRatio)) {
      worst = after;
    } else {
      v.source = source, v.position = position;
    }
  }
}

double Refinement::LeastRatioFor(WindowTriangleId id, Manner manner, double excess) const {
  if (manner != Manner::kAnyShape) return certain_ || excess > kFarBeyond ? kMinRadiusRatio : kMinRatioForCount;
  const Corners& corners = fronts_.at(id).corners;
  const auto is_frozen = [&](WindowVertexId v) { return fronts_.at(v).frozen(); };
  return std::any_of(corners.begin(), corners.end(), is_frozen) ? kMinLastRatio : kMinAnyRatio;
}

void Refinement::RefineAt(WindowTriangleId t, const Deviation& deviation, Manner manner) {
  if (TrySplitRim(t, deviation.worst.foot)) return;
  const bool begins_with_sides = manner == Manner::kSides;
  if (begins_with_sides ? HalveSides(t, deviation) : SplitAtWorst(t, deviation)) return;
  begins_with_sides ? SplitAtWorst(t, deviation) : HalveSides(t, deviation);
}

void Refinement::Touch(WindowTriangleId t) {
  if (touched_.size() <= t.index()) touched_.resize(fronts_.triangle_slots(), 0);
  touched_[t.index()] = 1;
  fronts_.at(t).deviation = -1;
}

// Neither side of it is settled, on a front or next to one, and its halves are not too short.
bool Refinement::MaySplit(Link h) const {
  if (!h.is_half_edge()) return false;
  const WindowTriangle& s = fronts_.at(h.triangle());
  const Link g = s.across[h.side()];
  if (!g.is_half_edge()) return false;
  const WindowVertex &a = fronts_.at(s.corners[h.side()]), &b = fronts_.at(s.corners[(h.side() + 1) % 3]);
  const WindowVertexId ic = s.corners[(h.side() + 2) % 3];
  const WindowVertexId id = fronts_.at(g.triangle()).corners[(g.side() + 2) % 3];
  const uint32_t depth = std::min({a.depth, b.depth, fronts_.at(ic).depth, fronts_.at(id).depth});
  const double shortest = std::max(min_edge_, kShortestPerGuidance * std::min(a.length, b.length));
  return ic != id && depth + 1 >= depth_ && Distance(a.position, b.position) >= 2 * shortest;
}

Link Refinement::SideBetween(WindowVertexId from, WindowVertexId to) const {
  Link side = Link::Rim();
  fronts_.VisitFan(from, [&](WindowTriangleId t, int corner) {
    if (fronts_.at(t).corners[(corner + 1) % 3] == to) side = Link::HalfEdge(t, corner);
  });
  return side;
}

// The least cosine between a triangle's normal and the surface's at its corners, or kMinAgreement: what may come instead of it.
double Refinement::LeastAgreement(const Corners& c) const {
  if (least_ratio_ < kMinRadiusRatio) return kMinAgreement;
  const WindowVertex *p = &fronts_.at(c[0]), *q = &fronts_.at(c[1]), *r = &fronts_.at(c[2]);
  const Vec3 normal = Normalized(AreaVector(p->position, q->position, r->position));
  const double agreement = std::min(
      {kMinAgreement, Dot(normal, p->source.normal), Dot(normal, q->source.normal), Dot(normal, r->source.normal)});
  return std::max(agreement, kLeastAgreement) - (is_far_beyond_ ? kLeewayFarBeyond : 0);
}

// Whether the triangles of a new vertex and these sides face the surface's way and are no slivers.
bool Refinement::FitsBetween(const Vec3& place, const Vec3& place_normal, double least_agreement,
                             absl::Span<const std::array<WindowVertexId, 2>> opposite) const {
  return std::all_of(opposite.begin(), opposite.end(), [&](const std::array<WindowVertexId, 2>& side) {
    const WindowVertex &from = fronts_.at(side[0]), &to = fronts_.at(side[1]);
    const Vec3 normal = Normalized(AreaVector(place, from.position, to.position));
    const double agreement =
        std::min({Dot(normal, place_normal), Dot(normal, from.source.normal), Dot(normal, to.source.normal)});
    return agreement >= least_agreement && RadiusRatio(place, from.position, to.position) >= least_ratio_;
  });
}

// Whether a new vertex there lies so close to one of these sides that is a rim that the triangle between stays flat. Not where the bound
// is to be kept: what is refused here comes as any shape then.
bool Refinement::CrowdsRim(const Vec3& place, absl::Span<const std::array<WindowVertexId, 2>> opposite) const {
  if (certain_ || least_ratio_ < kMinRadiusRatio) return false;
  return std::any_of(opposite.begin(), opposite.end(), [&](const std::array<WindowVertexId, 2>& side) {
    if (RadiusRatio(place, fronts_.at(side[0]).position, fronts_.at(side[1]).position) >= kMinRimRatio) return false;
    const Link link = SideBetween(side[0], side[1]);
    return link.is_half_edge() && fronts_.at(link.triangle()).across[link.side()].is_rim();
  });
}

WindowVertexId Refinement::NewVertex(const SourcePoint& source, WindowVertexId a, WindowVertexId b) {
  const WindowVertexId v =
      fronts_.AddVertex(source, 0.5 * (fronts_.at(a).length + fronts_.at(b).length), surface_.MaxCurvatureAt(source));
  WindowVertex& made = fronts_.at(v);
  made.origin = fronts_.at(a).origin;
  made.sheet = fronts_.at(a).sheet;
  made.depth = std::min(fronts_.at(a).depth, fronts_.at(b).depth);
  made.improved = true;
  made_.push_back(v);
  return v;
}

bool Refinement::TrySplitSide(Link h, const Vec3& target) {
  if (!MaySplit(h)) return false;
  const WindowTriangle& s = fronts_.at(h.triangle());
  const WindowVertexId a = s.corners[h.side()], b = s.corners[(h.side() + 1) % 3];
  const Link g = s.across[h.side()];
  const WindowVertexId c = s.corners[(h.side() + 2) % 3], d = fronts_.at(g.triangle()).corners[(g.side() + 2) % 3];
  const SourcePoint source = surface_.Snap(fronts_.at(a).source, target);
  const double least_agreement = std::min(LeastAgreement({a, b, c}), LeastAgreement({b, a, d}));
  const std::array<std::array<WindowVertexId, 2>, 4> around = {{{b, c}, {c, a}, {a, d}, {d, b}}};
  if (!FitsBetween(source.position, source.normal, least_agreement, around) || CrowdsRim(source.position, around))
    return false;
  Touch(h.triangle()), Touch(g.triangle());
  fronts_.SplitSide(h, NewVertex(source, a, b));
  return true;
}

size_t Refinement::ValenceOf(WindowVertexId v) const {
  size_t count = 0;
  return fronts_.VisitFan(v, [&](WindowTriangleId, int) { ++count; }) ? count : 0;
}

// A vertex on a side has four triangles, which no smoothing makes round. Turns the sides around it where that brings the
// valences nearer to six.
void Refinement::EqualizeAround(WindowVertexId v) {
  std::vector<WindowTriangleId> fan;
  fronts_.VisitFan(v, [&](WindowTriangleId t, int) { fan.push_back(t); });
  for (const WindowTriangleId t : fan) {
    const auto& corners = fronts_.at(t).corners;
    const auto corner = static_cast<int>(std::find(corners.begin(), corners.end(), v) - corners.begin());
    if (corner < 3 && ValenceOf(v) < 6) TryEqualize(Link::HalfEdge(t, (corner + 1) % 3));
  }
}

// On the other diagonal than today.
bool Refinement::HasBetterValences(const Quad& q) const {
  int before = 0, after = 0;
  for (const auto& [vertex, change] : {std::pair{q.a, -1}, {q.b, -1}, {q.c, 1}, {q.d, 1}}) {
    const size_t valence = ValenceOf(vertex);
    if (valence == 0) return false;  // at a rim or where triangles have settled
    const int excess = static_cast<int>(valence) - 6;
    before += excess * excess, after += (excess + change) * (excess + change);
  }
  return after < before;
}

bool Refinement::TryEqualize(Link h) {
  const Quad q = QuadAround(h);
  if (!q.is_free || !HasBetterValences(q) || !MayTurn(q)) return false;
  if (std::min(RatioOf({q.c, q.d, q.b}), RatioOf({q.d, q.c, q.a})) < kMinEqualizedRatio) return false;
  Touch(h.triangle()), Touch(fronts_.at(h.triangle()).across[h.side()].triangle());
  fronts_.Flip(h);
  return true;
}

// The corners of the two triangles at a side: a and b its ends, c and d across.
Refinement::Quad Refinement::QuadAround(Link h) const {
  const WindowTriangle& s = fronts_.at(h.triangle());
  const Link g = s.across[h.side()];
  if (!g.is_half_edge()) return {};
  const WindowTriangle& t = fronts_.at(g.triangle());
  Quad q{true, s.corners[h.side()], s.corners[(h.side() + 1) % 3], s.corners[(h.side() + 2) % 3],
         t.corners[(g.side() + 2) % 3]};
  for (const WindowVertexId v : {q.a, q.b, q.c, q.d}) q.is_free = q.is_free && fronts_.at(v).depth + 1 >= depth_;
  return q;
}

// Whether the triangles on the other diagonal face the surface's way and it is not an edge already.
bool Refinement::MayTurn(const Quad& q) const {
  const WindowVertex &c = fronts_.at(q.c), &d = fronts_.at(q.d);
  return FitsBetween(c.position, c.source.normal, kMinAgreement, {{q.d, q.b}}) &&
         FitsBetween(d.position, d.source.normal, kMinAgreement, {{q.c, q.a}}) && !fronts_.EdgeExists(q.c, q.d);
}

bool Refinement::HalveSides(WindowTriangleId t, const Deviation& deviation) {
  const std::array<WindowVertexId, 3> corners = fronts_.at(t).corners;
  std::array<int, 3> order = {0, 1, 2};
  std::array<double, 3> length;
  for (int i = 0; i < 3; ++i)
    length[i] = Distance(fronts_.at(corners[i]).position, fronts_.at(corners[(i + 1) % 3]).position);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return length[i] > length[j]; });
  const size_t wanted = deviation.largest > kFarBeyond * max_error_ ? 3 : 1;
  const size_t first_made = made_.size();
  size_t halved = 0;
  for (const int i : order) {
    const WindowVertexId from = corners[i], to = corners[(i + 1) % 3];
    if (halved == wanted) break;
    halved += TrySplitSide(SideBetween(from, to), 0.5 * (fronts_.at(from).position + fronts_.at(to).position));
  }
  for (size_t i = first_made; i < made_.size(); ++i) EqualizeAround(made_[i]);
  return halved > 0;
}

// A rim that leaves the surface, or cuts off a part of it, gets a vertex there.
bool Refinement::TrySplitRim(WindowTriangleId id, const SourcePoint& place) {
  if (!surface_.IsOnBoundary(place)) return false;
  for (int side = 0; side < 3; ++side) {
    const WindowTriangle& t = fronts_.at(id);
    const WindowVertexId a = t.corners[side], b = t.corners[(side + 1) % 3], c = t.corners[(side + 2) % 3];
    if (!t.across[side].is_rim() || !surface_.IsOnBoundary(fronts_.at(a).source)) continue;
    if (fronts_.IsOnCrease(a, b)) continue;  // the patch on the other side has it too
    const Vec3 &from = fronts_.at(a).position, &to = fronts_.at(b).position;
    const double shortest = std::max(min_edge_, kShortestPerGuidance * fronts_.at(a).length);
    if (Distance(from, place.position) < shortest || Distance(to, place.position) < shortest) continue;
    if (!FitsBetween(place.position, place.normal, kMinAgreement, {{b, c}, {c, a}})) continue;
    Touch(id);
    fronts_.SplitSide(Link::HalfEdge(id, side), NewVertex(place, a, b));
    ++rim_insertions_;
    return true;
  }
  return false;
}

bool Refinement::SplitAtWorst(WindowTriangleId id, const Deviation& deviation) {
  const std::array<WindowVertexId, 3> corners = fronts_.at(id).corners;
  std::array<Vec3, 3> p;
  for (int i = 0; i < 3; ++i) p[i] = fronts_.at(corners[i]).position;
  const std::array<double, 3> weight = WeightsAt(p, deviation.worst.place);
  const auto least = static_cast<int>(std::min_element(weight.begin(), weight.end()) - weight.begin());
  if (weight == std::array<double, 3>{} || *std::max_element(weight.begin(), weight.end()) > kAtCorner) return false;
  const int side = (least + 1) % 3;  // the one that faces the corner of the least weight
  if (weight[least] < kNearSide && TrySplitSide(Link::HalfEdge(id, side), deviation.worst.place)) return true;
  const double longest = std::max({Distance(p[0], p[1]), Distance(p[1], p[2]), Distance(p[2], p[0])});
  if (longest < 2 * std::max(min_edge_, kShortestPerGuidance * fronts_.at(corners[0]).length)) return false;
  if (weight[least] < kNearSide / 2) return false;  // on a side that can't be split
  const std::array<std::array<WindowVertexId, 2>, 3> around = {
      {{corners[0], corners[1]}, {corners[1], corners[2]}, {corners[2], corners[0]}}};
  const SourcePoint& foot = deviation.worst.foot;
  if (!FitsBetween(foot.position, foot.normal, LeastAgreement(corners), around) || CrowdsRim(foot.position, around))
    return false;
  Touch(id);
  const WindowVertexId v = NewVertex(deviation.worst.foot, corners[0], corners[1]);
  fronts_.at(v).depth = std::min(fronts_.at(v).depth, fronts_.at(corners[2]).depth);
  fronts_.SplitTriangle(id, v);
  return true;
}

}  // namespace meshfront
