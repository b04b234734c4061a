// Proposer. A candidate passes the tests in order of their cost; the first refusal is its verdict:
//   CheckShape     lengths, normals, side of the base
//   CheckSectors   the new sides leave each corner into its open side
//   EdgeExists     no edge and no face twice
//   CheckFences    crossings both ways, front vertices inside or too near
//   StandsForSurface
// Rejected: taking the nearest legal vertex, as the prototype does; the smallest angle *including the corners left behind*
// decides instead, because a corner of 10° left behind is the next sliver.
#include "core/front/proposer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/front/tolerances.h"
#include "core/geometry/segment.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

using namespace front_tolerances;

constexpr double kFreeMinNormalCosine = 0.5;
constexpr double kMinRadiusPerBase = 0.7,
                 kMaxRadiusPerBase = 1.6;  // free sides against a base that is too long or too short
constexpr double kFarTooClose = 0.85;      // of the clearance: what curvature may add to a distance in the plane
constexpr double kApexMayMove =
    0.2;  // in steps, from the plane of its edge to the surface, before its surroundings are others
constexpr double kSixtyDegrees = 0.6339745962155614;  // ClockwiseTurn of 60°
// Turn below which a corner is none (0.006°): what it leaves behind could only be filled by a triangle without area.
constexpr double kLeastCorner = 1e-4;
constexpr double kSignTells =
    1e-6;  // a cosine that is required and above this is not met by what is not positive, rounded or not
constexpr double kBallSlack = 1 + 1e-6;  // for rounding, and for the normals of needles
// Cosine between the normals of an ear and of the surface at its corners, from which on it stands for the surface: where that is a
// thin part's other side, or a lumen, they disagree.
constexpr double kSmoothEar = 0.9;
constexpr double kSameSheetResidual = 1e-3;  // in parts of the side: a descent that arrives is exact

// Strictly inside the triangle when seen along its normal `m` (any length).
bool ProjectsInside(const Vec3& p, const Vec3& m, const Vec3& a, const Vec3& b, const Vec3& c) {
  return Dot(m, Cross(b - a, p - a)) > 0 && Dot(m, Cross(c - b, p - b)) > 0 && Dot(m, Cross(a - c, p - c)) > 0;
}

}  // namespace

std::string_view VerdictName(Verdict verdict) {
  static constexpr std::array<std::string_view, kVerdicts> kNames = {
      "accepted",  "no_apex",       "outside_sector",  "edge_exists", "normals_disagree",
      "too_close", "crosses_fence", "contains_vertex", "too_long",    "off_sheet"};
  return kNames[static_cast<int>(verdict)];
}

Verdict Proposer::Judge(Verdict verdict) {
  ++counts_[static_cast<int>(verdict)];
  return verdict;
}

// With its height.
FenceIndex::Ball Proposer::BallAround(const NewEdge& edge) {
  return {0.5 * (edge.start + edge.end), kBallSlack * (0.5 * Distance(edge.start, edge.end) + edge.half_height)};
}

bool Proposer::MayCross(const FenceIndex::Ball& ball, const Near& fence) {
  const double apart = ball.radius + fence.reach;
  return SquaredDistance(ball.center, fence.middle) <= apart * apart;
}

// The front edges around a place, on the edge's sheet.
void Proposer::Gather(FrontEdgeId of, const Vec3& center, double radius) {
  found_.clear();
  fences_.Query(center, radius, found_);
  near_.clear();
  const uint32_t sheet = fences_.at(of).sheet;
  for (const FrontEdgeId edge : found_) {
    if (fences_.at(edge).sheet != sheet) continue;
    const FenceIndex::Ball& ball = fences_.BallOf(edge);
    near_.push_back({edge, ball.center, ball.radius + fences_.at(edge).half_height});
  }
}

double Proposer::FreeRatio(FrontEdgeId edge) const {
  const WindowVertex &a = fronts_.at(fronts_.From(edge)), &b = fronts_.at(fronts_.To(edge));
  return RadiusRatioOfSides(Distance(a.position, b.position), a.length, b.length);
}

Verdict Proposer::ProposeFree(FrontEdgeId edge, FreeProposal& proposal) {
  const WindowVertex &a = fronts_.at(fronts_.From(edge)), &b = fronts_.at(fronts_.To(edge));
  const double base = Distance(a.position, b.position);
  const double radius_a = std::clamp(a.length, kMinRadiusPerBase * base, kMaxRadiusPerBase * base);
  const double radius_b = std::clamp(b.length, kMinRadiusPerBase * base, kMaxRadiusPerBase * base);
  const double step = 0.5 * (radius_a + radius_b), reach = 1.05 * std::max(radius_a, radius_b);
  const std::optional<FlatApex> flat = FindFlatApex(a, b, radius_a, radius_b);
  if (flat) {
    if (const Verdict v = CheckNeighbours(edge, *flat, step); v != Verdict::kAccepted) return Judge(v);
    Gather(edge, flat->position, reach + kApexMayMove * step);
    if (IsFarTooClose(edge, *flat, step)) return Judge(Verdict::kTooClose);
  }
  const std::optional<SourcePoint> apex = surface_.FindApex(a.source, b.source, radius_a, radius_b);
  if (!apex) return Judge(Verdict::kNoApex);
  if (!flat || SquaredDistance(apex->position, flat->position) > kApexMayMove * kApexMayMove * step * step)
    Gather(edge, apex->position, reach);
  proposal.apex = *apex;
  proposal.at_guidance = radius_a == a.length && radius_b == b.length;
  return Judge(CheckFree(edge, *apex, step));
}

// The apex in the plane of the edge and its normal; nothing when the sides do not meet.
std::optional<Proposer::FlatApex> Proposer::FindFlatApex(const WindowVertex& a, const WindowVertex& b, double radius_a,
                                                         double radius_b) {
  const Vec3 along = b.position - a.position;
  const double base2 = SquaredNorm(along);
  const double x = (radius_a * radius_a - radius_b * radius_b + base2) / (2 * base2);
  const double y2 = radius_a * radius_a / base2 - x * x;
  if (!(y2 > 0)) return std::nullopt;
  const Vec3 normal = Normalized(a.source.normal + b.source.normal);
  return FlatApex{a.position + x * along + std::sqrt(y2) * Cross(along, normal), normal};
}

// Refuses what the fences before and after the edge would refuse by far, which spares most of the vain placements.
//
//        P        the apex of e stands within the clearance of P–a, or behind it, when the corner at a is
//         \\       below 90° or so
//      x   a --e--> b
Verdict Proposer::CheckNeighbours(FrontEdgeId edge, const FlatApex& apex, double step) const {
  const double clearance = kFarTooClose * kFreeClearance * step;
  for (const FrontEdgeId neighbour : {fronts_.at(edge).prev, fronts_.at(edge).next}) {
    const Fence& f = fences_.at(neighbour);
    if (!(DistanceToFence(apex.position, apex.normal, f) < clearance)) continue;
    return Dot(apex.normal, Cross(f.end - f.start, apex.position - f.start)) > 0 ? Verdict::kOutsideSector
                                                                                 : Verdict::kTooClose;
  }
  return Verdict::kAccepted;
}

// The same for all the fences around.
bool Proposer::IsFarTooClose(FrontEdgeId edge, const FlatApex& apex, double step) const {
  const double clearance = kFarTooClose * kFreeClearance * step;
  return std::any_of(near_.begin(), near_.end(), [&](const Near& near) {
    const double apart = clearance + near.reach;
    return near.edge != edge && SquaredDistance(near.middle, apex.position) <= apart * apart &&
           DistanceToFence(apex.position, apex.normal, fences_.at(near.edge)) < clearance;
  });
}

// Whether the new side number `side`, from one source point to another, crosses a front edge. Where the fences leave it unclear, the
// ways over the surface decide: the fronts then stay simple loops on the surface, however rough that is. A side without a way is taken
// to cross what does not face the other way.
bool Proposer::Crosses(const NewEdge& edge, const SourcePoint& from, const SourcePoint& to, int side,
                       FrontEdgeId fence) {
  const Crossing crossing = CrossFence(edge, fences_.at(fence));
  if (crossing != Crossing::kUnclear || !surface_.HasWays()) return crossing == Crossing::kCrosses;
  NewWay& way = new_ways_[side];
  if (!way.is_known) way.is_known = true, surface_.TraceWay(from, to, way.pieces);
  if (way.pieces.empty()) return Dot(edge.normal, fences_.at(fence).normal) >= kOtherSheetCosine;
  if (fence_ways_.size() <= fence.index()) fence_ways_.resize(2 * fence.index() + 16);
  FenceWay& along = fence_ways_[fence.index()];
  if (along.birth != fronts_.at(fence).birth) {
    along.birth = fronts_.at(fence).birth;
    surface_.TraceWay(fronts_.at(fronts_.From(fence)).source, fronts_.at(fronts_.To(fence)).source, along.pieces);
  }
  return WaysCross(way.pieces, along.pieces);
}

Verdict Proposer::CheckFree(FrontEdgeId edge, const SourcePoint& apex, double step) {
  const WindowVertexId ia = fronts_.From(edge), ib = fronts_.To(edge);
  const WindowVertex &a = fronts_.at(ia), &b = fronts_.at(ib);
  const Vec3 normal = Normalized(AreaVector(b.position, a.position, apex.position));
  if (std::min({Dot(normal, a.source.normal), Dot(normal, b.source.normal), Dot(normal, apex.normal)}) <
      kFreeMinNormalCosine) {
    return Verdict::kNormalsDisagree;
  }
  const Vec3 base = b.position - a.position;
  const Vec3 before = fronts_.at(fronts_.From(fronts_.at(edge).prev)).position - a.position;
  const Vec3 after = fronts_.at(fronts_.To(fronts_.at(edge).next)).position - b.position;
  const double open_a = ClockwiseTurn(a.source.normal, base, before),
               open_b = ClockwiseTurn(b.source.normal, after, -base);
  if (open_a > 0 && ClockwiseTurn(a.source.normal, base, apex.position - a.position) >= open_a)
    return Verdict::kOutsideSector;
  if (open_b > 0 && ClockwiseTurn(b.source.normal, after, apex.position - b.position) >= open_b)
    return Verdict::kOutsideSector;
  for (NewWay& way : new_ways_) way.is_known = false;
  const double clearance = kFreeClearance * step;
  const double height_a = FenceHalfHeight(Distance(a.position, apex.position), a.max_curvature);
  const double height_b = FenceHalfHeight(Distance(b.position, apex.position), b.max_curvature);
  const NewEdge side_a{a.position, apex.position, Normalized(a.source.normal + apex.normal), height_a};
  const NewEdge side_b{b.position, apex.position, Normalized(b.source.normal + apex.normal), height_b};
  const uint32_t at_a = fronts_.IdentityOf(ia), at_b = fronts_.IdentityOf(ib);
  const FenceIndex::Ball ball_a = BallAround(side_a), ball_b = BallAround(side_b);
  for (const Near& near : near_) {
    if (near.edge == edge) continue;
    const Fence& fence = fences_.at(near.edge);
    if (DistanceToFence(apex.position, apex.normal, fence) < clearance) return Verdict::kTooClose;
    if (fence.from != at_a && fence.to != at_a && MayCross(ball_a, near) &&
        Crosses(side_a, a.source, apex, 0, near.edge))
      return Verdict::kCrossesFence;
    if (fence.from != at_b && fence.to != at_b && MayCross(ball_b, near) &&
        Crosses(side_b, b.source, apex, 1, near.edge))
      return Verdict::kCrossesFence;
    if (fence.from == at_a || fence.from == at_b || Dot(fence.normal, normal) < kOtherSheetCosine) continue;
    if (DistanceToSegment(fence.start, a.position, apex.position) < clearance ||
        DistanceToSegment(fence.start, b.position, apex.position) < clearance) {
      return Verdict::kTooClose;
    }
  }
  return Verdict::kAccepted;
}

// A connection candidate with everything its tests need.
struct Proposer::Candidate {
  // Of the edge alone.
  FrontEdgeId edge, before, after;  // `after`: the edge at whose start the one after the base ends
  WindowVertexId ia, ib;
  const WindowVertex *a, *b;
  Vec3 ab;
  double side_ab;
  double open_a, open_b;  // the turns of the open sides at its ends
  // Of the corner too.
  FrontEdgeId corner;
  WindowVertexId ic;
  const WindowVertex* c;
  bool zip_before, zip_after;  // the side a–c or c–b is a front edge already
  // From CheckShape and CheckSectors.
  double side_ac, side_cb;
  Vec3 normal;            // of the triangle (b, a, c), unit length
  double optimistic = 0;  // smallest angle of the triangle alone
  double score = 0;       // and of the corners left behind
};

Proposer::Proposer(const Surface& surface, const FrontSet& fronts, const FenceIndex& fences)
    : surface_(surface), fronts_(fronts), fences_(fences) {}
Proposer::~Proposer() = default;

void Proposer::DescribeBase(FrontEdgeId edge, Candidate& c) const {
  const auto whole = [](double turn) { return turn > 0 ? turn : 4.0; };
  const FrontEdgeId next = fronts_.at(edge).next;
  c.edge = edge, c.before = fronts_.at(edge).prev, c.after = fronts_.at(next).next;
  c.ia = fronts_.From(edge), c.ib = fronts_.From(next);
  c.a = &fronts_.at(c.ia), c.b = &fronts_.at(c.ib);
  c.ab = c.b->position - c.a->position;
  c.side_ab = Norm(c.ab);
  const Vec3 before = fronts_.at(fronts_.From(c.before)).position - c.a->position;
  const Vec3 after = fronts_.at(fronts_.From(c.after)).position - c.b->position;
  c.open_a = whole(ClockwiseTurn(c.a->source.normal, c.ab, before));
  c.open_b = whole(ClockwiseTurn(c.b->source.normal, after, -c.ab));
}

void Proposer::DescribeCorner(FrontEdgeId corner, Candidate& c) const {
  c.corner = corner;
  c.ic = fronts_.From(corner);
  c.c = &fronts_.at(c.ic);
  c.zip_before = corner == c.before;
  c.zip_after = corner == c.after;
}

// Also computes the sides, the normal and the optimistic score.
Verdict Proposer::CheckShape(Candidate& c, const Strictness& s) const {
  const Vec3 ac = c.c->position - c.a->position, cb = c.b->position - c.c->position;
  const Vec3 area = Cross(ac, c.ab);
  // Most candidates lie behind the edge: their signs tell.
  if (s.min_normal_cosine > kSignTells && (Dot(area, c.a->source.normal) <= 0 || Dot(area, c.b->source.normal) <= 0 ||
                                           Dot(area, c.c->source.normal) <= 0)) {
    return Verdict::kNormalsDisagree;
  }
  c.normal = Normalized(area);
  if (c.normal == Vec3{}) return Verdict::kNormalsDisagree;
  if (std::min({Dot(c.normal, c.a->source.normal), Dot(c.normal, c.b->source.normal),
                Dot(c.normal, c.c->source.normal)}) < s.min_normal_cosine) {
    return Verdict::kNormalsDisagree;
  }
  c.side_ac = Norm(ac), c.side_cb = Norm(cb);
  const double limit = s.max_side * kMaxSidePerGuidance;
  if (!c.zip_before && c.side_ac > limit * std::max({c.a->length, c.c->length, 0.5 * c.side_ab}))
    return Verdict::kTooLong;
  if (!c.zip_after && c.side_cb > limit * std::max({c.b->length, c.c->length, 0.5 * c.side_ab}))
    return Verdict::kTooLong;
  const double up_ab = Dot(c.ab, c.normal), up_ac = Dot(ac, c.normal), up_cb = Dot(cb, c.normal);
  c.optimistic = std::min({TurnOf(Dot(c.ab, ac) - up_ab * up_ac, Dot(c.normal, area)),
                           TurnOf(Dot(cb, c.ab) - up_cb * up_ab, Dot(c.normal, Cross(c.ab, cb))),
                           TurnOf(up_ac * up_cb - Dot(ac, cb), -Dot(c.normal, Cross(cb, ac)))});
  return Verdict::kAccepted;
}

// Each corner's open side runs clockwise from the edge that leaves it to the one that comes in. Also computes the score.
Verdict Proposer::CheckSectors(Candidate& c) const {
  const auto place = [this](WindowVertexId v) { return fronts_.at(v).position; };
  const Vec3 ac = c.c->position - c.a->position, cb = c.b->position - c.c->position;
  c.score = std::min(kSixtyDegrees, c.optimistic);
  if (c.zip_before && c.zip_after) return SurroundsOpenSide(c.edge) ? Verdict::kAccepted : Verdict::kOutsideSector;
  const auto whole = [](double turn) { return turn > 0 ? turn : 4.0; };
  if (!c.zip_before) {
    const double turn = ClockwiseTurn(c.a->source.normal, c.ab, ac);
    if (turn <= 0 || turn >= c.open_a) return Verdict::kOutsideSector;
    c.score = std::min(c.score, c.open_a - turn);
  }
  if (!c.zip_after) {
    const Vec3 after = place(fronts_.From(c.after)) - c.b->position;
    const double turn = ClockwiseTurn(c.b->source.normal, after, -cb);
    if (turn <= 0 || turn >= c.open_b) return Verdict::kOutsideSector;
    c.score = std::min(c.score, turn);
  }
  const Vec3 leave = place(fronts_.To(c.corner)) - c.c->position;
  const Vec3 come = place(fronts_.From(fronts_.at(c.corner).prev)) - c.c->position;
  const double open = whole(ClockwiseTurn(c.c->source.normal, leave, come));
  const double turn_a = c.zip_before ? 0 : ClockwiseTurn(c.c->source.normal, leave, -ac);
  const double turn_b = c.zip_after ? open : ClockwiseTurn(c.c->source.normal, leave, cb);
  if (turn_a >= turn_b || turn_b > open) return Verdict::kOutsideSector;
  if (!c.zip_before && turn_a <= 0) return Verdict::kOutsideSector;
  if (!c.zip_after && turn_b >= open) return Verdict::kOutsideSector;
  if (!c.zip_before) c.score = std::min(c.score, turn_a);
  if (!c.zip_after) c.score = std::min(c.score, open - turn_b);
  return c.score < kLeastCorner ? Verdict::kOutsideSector : Verdict::kAccepted;
}

// Whether the loop goes around its open side rather than the other way: the corners of a polygon of n sides sum up to n − 2 straight
// angles, of the hole in a sheet to n + 2.
bool Proposer::SurroundsOpenSide(FrontEdgeId edge) const {
  const auto place = [this](FrontEdgeId e) { return fronts_.at(fronts_.From(e)).position; };
  double turns = 0;
  int corners = 0;
  FrontEdgeId e = edge;
  do {
    const FrontEdgeId next = fronts_.at(e).next, before = fronts_.at(e).prev;
    const double turn =
        ClockwiseTurn(fronts_.at(fronts_.From(e)).source.normal, place(next) - place(e), place(before) - place(e));
    turns += turn > 0 ? turn : 4.0;
    ++corners;
    e = next;
  } while (e != edge);
  return turns < 2.0 * corners;
}

// The new sides of a candidate as fences, the room that it wants around it, and a ball around all of that.
struct Proposer::NewFences {
  NewEdge side_a, side_b;  // a–c and b–c
  double height, clearance_a, clearance_b;
  Vec3 center;
  double reach;
};

Proposer::NewFences Proposer::FencesOf(const Candidate& c, const Strictness& s) {
  const double height_a = FenceHalfHeight(c.side_ac, std::max(c.a->max_curvature, c.c->max_curvature));
  const double height_b = FenceHalfHeight(c.side_cb, std::max(c.b->max_curvature, c.c->max_curvature));
  const double height = std::max({height_a, height_b, kMinFenceHeightPerLength * c.side_ab});
  const double clearance_a = s.clearance * std::min(c.side_ac, std::max(c.a->length, c.c->length));
  const double clearance_b = s.clearance * std::min(c.side_cb, std::max(c.b->length, c.c->length));
  const Vec3 center = (c.a->position + c.b->position + c.c->position) / 3.0;
  const double radius =
      std::sqrt(std::max({SquaredDistance(center, c.a->position), SquaredDistance(center, c.b->position),
                          SquaredDistance(center, c.c->position)}));
  return {{c.a->position, c.c->position, Normalized(c.a->source.normal + c.c->source.normal), height_a},
          {c.b->position, c.c->position, Normalized(c.b->source.normal + c.c->source.normal), height_b},
          height,
          clearance_a,
          clearance_b,
          center,
          kBallSlack * (radius + std::max({height, clearance_a, clearance_b}))};
}

// A fence whose ball stays clear of the triangle's, with the heights and clearances added, can fail no test.
Verdict Proposer::CheckFences(const Candidate& c, const NewFences& fences) {
  const uint32_t at_a = fronts_.IdentityOf(c.ia), at_b = fronts_.IdentityOf(c.ib), at_c = fronts_.IdentityOf(c.ic);
  const auto touches = [](const Fence& f, uint32_t u, uint32_t v) {
    return f.from == u || f.to == u || f.from == v || f.to == v;
  };
  const Vec3& center = fences.center;
  const double reach = fences.reach;
  for (NewWay& way : new_ways_) way.is_known = false;
  for (const Near& near : near_) {
    const double apart = reach + near.reach;
    if (SquaredDistance(near.middle, center) > apart * apart || near.edge == c.edge) continue;
    const Fence& f = fences_.at(near.edge);
    if (!c.zip_before && !touches(f, at_a, at_c) && Crosses(fences.side_a, c.a->source, c.c->source, 0, near.edge))
      return Verdict::kCrossesFence;
    if (!c.zip_after && !touches(f, at_b, at_c) && Crosses(fences.side_b, c.b->source, c.c->source, 1, near.edge))
      return Verdict::kCrossesFence;
    if (f.from == at_a || f.from == at_b || f.from == at_c) continue;
    if (SquaredDistance(f.start, center) > reach * reach || Dot(f.normal, c.normal) < kOtherSheetCosine) continue;
    const double off = std::abs(Dot(c.normal, f.start - c.a->position));
    if (off <= fences.height && ProjectsInside(f.start, c.normal, c.b->position, c.a->position, c.c->position)) {
      return Verdict::kContainsVertex;
    }
    if (!c.zip_before && DistanceToSegment(f.start, c.a->position, c.c->position) < fences.clearance_a)
      return Verdict::kTooClose;
    if (!c.zip_after && DistanceToSegment(f.start, c.b->position, c.c->position) < fences.clearance_b)
      return Verdict::kTooClose;
  }
  return Verdict::kAccepted;
}

bool Proposer::StandsForSurface(const SourcePoint& a, const SourcePoint& b, const SourcePoint& apex, bool new_side_a,
                                bool new_side_b, double tolerance) const {
  const auto side = [&](const SourcePoint& from, const SourcePoint& to) {
    const Vec3 middle = 0.5 * (from.position + to.position);
    const SourcePoint x = surface_.Foot(from, middle);
    if (Distance(x.position, middle) > tolerance) return false;
    return surface_.Reaches(x, to, kSameSheetResidual * Distance(from.position, to.position));
  };
  if (new_side_a && !side(a, apex)) return false;
  if (new_side_b && !side(b, apex)) return false;
  const Vec3 centroid = (a.position + b.position + apex.position) / 3.0;
  const SourcePoint x = surface_.Snap(a, centroid);
  if (Distance(x.position, centroid) > tolerance) return false;
  return Dot(x.normal, AreaVector(b.position, a.position, apex.position)) > 0;
}

// What comes after CheckShape and CheckSectors.
Verdict Proposer::CheckSurroundings(const Candidate& c, const NewFences& fences, const Strictness& s) {
  const Link owner = fronts_.at(c.edge).owner;
  if (owner.is_half_edge() && fronts_.at(owner.triangle()).corners[(owner.side() + 2) % 3] == c.ic)
    return Verdict::kEdgeExists;
  if (!c.zip_before && fronts_.EdgeExists(c.ia, c.ic)) return Verdict::kEdgeExists;
  if (!c.zip_after && fronts_.EdgeExists(c.ib, c.ic)) return Verdict::kEdgeExists;
  if (const Verdict v = CheckFences(c, fences); v != Verdict::kAccepted) return v;
  if (c.zip_before || c.zip_after) {
    // The front leads from corner to corner, and the surface faces where the triangle does.
    const double agreement = std::min(
        {Dot(c.normal, c.a->source.normal), Dot(c.normal, c.b->source.normal), Dot(c.normal, c.c->source.normal)});
    if (agreement >= kSmoothEar) return Verdict::kAccepted;
  }
  return StandsForSurface(c, s.sheet_tolerance) ? Verdict::kAccepted : Verdict::kOffSheet;
}

// Connections are asked for again when they are made, and while their edges are stuck. The answer stays, since vertices on
// fronts do not move.
bool Proposer::StandsForSurface(const Candidate& c, double tolerance) {
  const uint32_t edge = fronts_.at(c.edge).birth, corner = fronts_.at(c.corner).birth;
  SheetAnswer& answer = sheet_answers_[(edge * 0x9e3779b1u + corner) % kSheetAnswers];
  if (answer.edge != edge || answer.corner != corner || answer.tolerance != tolerance ||
      answer.zip_before != c.zip_before || answer.zip_after != c.zip_after) {
    const double longest = std::max({c.side_ab, c.side_ac, c.side_cb});
    const bool stands =
        StandsForSurface(c.a->source, c.b->source, c.c->source, !c.zip_before, !c.zip_after, tolerance * longest);
    answer = {edge, corner, tolerance, c.zip_before, c.zip_after, stands};
  }
  return answer.stands;
}

double Proposer::SearchRadius(FrontEdgeId edge, const Strictness& s) const {
  const WindowVertex &a = fronts_.at(fronts_.From(edge)), &b = fronts_.at(fronts_.To(edge));
  const double length = std::max({Distance(a.position, b.position), a.length, b.length});
  return s.range * kSearchRange * length;
}

ConnectionProposal Proposer::ProposeEar(FrontEdgeId edge, const Strictness& strictness, Neighbour with,
                                        double least_score) const {
  ConnectionProposal proposal{{}, least_score};
  Candidate c;
  DescribeBase(edge, c);
  for (const Neighbour side : {Neighbour::kBefore, Neighbour::kAfter}) {
    if (with != Neighbour::kEither && with != side) continue;
    const FrontEdgeId corner = side == Neighbour::kBefore ? c.before : c.after;
    DescribeCorner(corner, c);
    if (c.ic == c.ia || c.ic == c.ib || CheckShape(c, strictness) != Verdict::kAccepted) continue;
    if (c.optimistic <= proposal.score || CheckSectors(c) != Verdict::kAccepted) continue;
    if (c.score > proposal.score) proposal = {corner, c.score};
  }
  return proposal;
}

Verdict Proposer::CheckConnection(FrontEdgeId edge, const Strictness& strictness, ConnectionProposal& proposal) {
  Candidate c;
  DescribeBase(edge, c);
  DescribeCorner(proposal.corner, c);
  if (c.ic == c.ia || c.ic == c.ib) return Verdict::kEdgeExists;
  if (const Verdict v = CheckShape(c, strictness); v != Verdict::kAccepted) return v;
  if (const Verdict v = CheckSectors(c); v != Verdict::kAccepted) return v;
  proposal.score = c.score;
  const NewFences fences = FencesOf(c, strictness);
  Gather(edge, fences.center, fences.reach + fences.height);
  return CheckSurroundings(c, fences, strictness);
}

Verdict Proposer::ProposeConnection(FrontEdgeId edge, const Strictness& strictness, Scrutiny scrutiny,
                                    ConnectionProposal& proposal) {
  Candidate c;
  DescribeBase(edge, c);
  const Vec3 middle = 0.5 * (c.a->position + c.b->position);
  const double radius = SearchRadius(edge, strictness);
  Gather(edge, middle, radius);
  candidates_.clear();
  const Vec3 open_side_a = Cross(c.ab, c.a->source.normal), open_side_b = Cross(c.ab, c.b->source.normal);
  const bool signs_tell = strictness.min_normal_cosine > kSignTells;
  Verdict last = Verdict::kTooLong;
  for (const Near& near : near_) {
    const Fence& fence = fences_.at(near.edge);
    if (fence.from == fronts_.IdentityOf(c.ia) || fence.from == fronts_.IdentityOf(c.ib)) continue;
    if (SquaredDistance(fence.start, middle) > radius * radius) continue;
    const Vec3 ac = fence.start - c.a->position;
    if (signs_tell && (Dot(ac, open_side_a) <= 0 || Dot(ac, open_side_b) <= 0)) {
      last = Judge(Verdict::kNormalsDisagree);
      continue;
    }
    DescribeCorner(near.edge, c);
    last = CheckShape(c, strictness);
    if (last != Verdict::kAccepted)
      ++counts_[static_cast<int>(last)];
    else
      candidates_.push_back(c);
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& x, const Candidate& y) {
    return x.optimistic != y.optimistic ? x.optimistic > y.optimistic : x.corner < y.corner;
  });
  proposal = {};
  for (Candidate& candidate : candidates_) {
    if (std::min(candidate.optimistic, kSixtyDegrees) <= proposal.score) break;
    last = CheckSectors(candidate);
    if (last == Verdict::kAccepted) {
      if (candidate.score <= proposal.score) continue;  // would change nothing
      if (scrutiny == Scrutiny::kWhole)
        last = CheckSurroundings(candidate, FencesOf(candidate, strictness), strictness);
    }
    if (Judge(last) == Verdict::kAccepted) proposal = {candidate.corner, candidate.score};
  }
  return proposal.corner.valid() ? Verdict::kAccepted : last;
}

}  // namespace meshfront
