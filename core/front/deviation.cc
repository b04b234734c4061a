// Measure asks the surface for far places. Where parts are doubtful, or the surface can't tell: SettleParts, if it has pieces. The distance
// to a piece is convex, so that over a part it is largest at a corner: a part keeps the bound if its corners do with the piece next to
// one of them, or if one has so much left that the way to the others can't use it up. Other parts are halved across their longest side,
// in the order in which they came, up to kMaxParts; where anything is left then, the bound is not kept. Where it need not be certain they
// are few, and what is left is let go.
//
// Surfaces without pieces: by a recursion over parts of the triangle (Halve).
//
//        2            1. the feet of the middles 3, 4, 5: one walk each
//       / \           2. bend: how far each foot is from the middle of the feet at the ends of its side
//      5---4          3. a part is within the bound if its corners are, even with kBendPerHalving of the bend on top
//     / \ / \         4. a part with a corner beyond the bound is beyond it; the others are halved
//    0---3---1      5. what is not settled after kMaxHalvings is let go: it lies within the bound at places closer than 1/128 of a side
//
// The distance to what lies between three feet is convex, hence largest at a part's corners; what the surface itself is off that is
// its bend. That is exact enough for smooth surfaces only: a mesh with edges as long as the triangle's has ridges that no middle
// tells of. Rejected: the Lipschitz bound alone (distance at a place and the way to it), which takes parts as small as what is
// left to the bound, thousands of them where a triangle comes close to it.
#include "core/front/deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr size_t kMaxParts = 2000, kMaxPartsOfUncertain = 40;
// What seems near: seven places up to this part of the bound, or four up to the next one where the surface bends less over the sides
// than the third; and the normal agrees so well with the surface's at its corners.
constexpr double kSeemsNear = 0.55, kSeemsNearAtFour = 0.4, kSeemsStraight = 0.35, kSeemsToAgree = 0.6;
constexpr int kMinHalvings = 3, kMaxHalvings = 7;
// How much more than at its corners the distance may be inside a part, in bends over its parent's sides. A smooth surface bends over
// half a side by a quarter of what it bends over the whole, a ridge by half at most.
constexpr double kBendPerHalving = 0.5;
// … nor is any place of a part farther from all of its corners than this part of its longest side.
constexpr double kReachPerSide = 0.578;
// The distance's slope at the corners of a part tells of that inside up to this factor, and where the foot is not too near.
constexpr double kSlopeMargin = 1.5, kLeastGapForSlope = 0.1;
// Weights by which the surface's details may lie beside the triangle, by how well its normal agrees with the surface's at its corners.
constexpr double kBesideSmooth = 0.1, kBesideSharp = 0.4, kSharpAgreement = 0.9;

// From the middle of the feet at the ends of a side to the foot of its middle.
double BendOver(const PlaceAndFoot& from, const PlaceAndFoot& to, const PlaceAndFoot& middle) {
  return Distance(0.5 * (from.foot.position + to.foot.position), middle.foot.position);
}

// How far the middle of a side would be from a surface that bends evenly between the normals at its ends.
double SagittaOver(const PlaceAndFoot& from, const PlaceAndFoot& to) {
  return std::abs(Dot(to.foot.normal - from.foot.normal, to.place - from.place)) / 8;
}

}  // namespace

void DeviationMeter::Note(const PlaceAndFoot& at) {
  const double gap = at.Gap();
  if (gap > found_.largest) found_.largest = gap, found_.worst = at;
  if (gap > bound_) found_.is_kept = false;
}

bool DeviationMeter::SeemsNear(const std::array<PlaceAndFoot, 3>& c, const Vec3* centroid_foot) const {
  const double near2 = kSeemsNear * kSeemsNear * bound_ * bound_;
  const Vec3 area = AreaVector(c[0].place, c[1].place, c[2].place);
  const double least = kSeemsToAgree * Norm(area);
  double farthest2 = 0, bend = -1;
  int bent = 0;  // the side over which it bends most
  for (int i = 0; i < 3; ++i) {
    const PlaceAndFoot &at = c[i], &next = c[i == 2 ? 0 : i + 1];
    farthest2 = std::max(farthest2, SquaredDistance(at.place, at.foot.position));
    const double sagitta = SagittaOver(at, next);
    if (sagitta > bend) bend = sagitta, bent = i;
    if (!(farthest2 <= near2 && Dot(at.foot.normal, area) >= least)) return false;
  }
  const Vec3 centroid = (c[0].place + c[1].place + c[2].place) / 3.0;
  const Vec3 foot = centroid_foot ? *centroid_foot : surface_.Foot(c[0].foot, centroid).position;
  farthest2 = std::max(farthest2, SquaredDistance(centroid, foot));
  if (!(farthest2 <= near2)) return false;
  if (farthest2 <= kSeemsNearAtFour * kSeemsNearAtFour * bound_ * bound_ && bend <= kSeemsStraight * bound_)
    return true;
  const Vec3 middle = 0.5 * (c[bent].place + c[(bent + 1) % 3].place);
  return SquaredDistance(middle, surface_.Foot(c[bent].foot, middle).position) <= near2;
}

Deviation DeviationMeter::Measure(const std::array<PlaceAndFoot, 3>& corners) {
  corners_ = corners;
  found_ = {};
  normal_ = Normalized(AreaVector(corners[0].place, corners[1].place, corners[2].place));
  far_details_.clear();
  // Over a convex edge there are places that are over none of its two triangles, the sharper it is the farther beside them; and
  // beyond a rim that cuts off a corner.
  double agreement = 1;
  int on_rim = 0;
  for (const PlaceAndFoot& c : corners) {
    agreement = std::min(agreement, Dot(c.foot.normal, normal_));
    on_rim += surface_.IsOnBoundary(c.foot);
  }
  const double beside = agreement < kSharpAgreement || on_rim > 1 ? kBesideSharp : kBesideSmooth;
  const bool all = surface_.FindFarPlaces(corners[0].foot, {corners[0].place, corners[1].place, corners[2].place},
                                          bound_, beside, far_, certain_ ? &doubtful_ : nullptr);
  for (const PlaceAndFoot& c : corners) Note(c);
  NoteFar();
  if (found_.is_kept && !(all && doubtful_.empty())) Examine(all);
  return found_;
}

// The farthest along the normal first: others that are less far than what was found, seen so, need no walk.
void DeviationMeter::NoteFar() {
  const auto height2 = [](const FarPlace& p) { return SquaredDistance(p.below, p.above.position); };
  const FarPlace* farthest = nullptr;
  for (const FarPlace& p : far_) {
    if (p.is_detail || !certain_) far_details_.push_back(p);
    if (!p.is_beside && (!farthest || height2(p) > height2(*farthest))) farthest = &p;
  }
  if (!farthest) return;
  Note(Closest(farthest->above, farthest->below));
  for (const FarPlace& p : far_) {
    if (!p.is_beside && &p != farthest && height2(p) > found_.largest * found_.largest) Note(Closest(p.above, p.below));
  }
}

// Looks closer at what the surface could not tell of: the doubtful parts, or everything.
void DeviationMeter::Examine(bool all) {
  if (!std::isfinite(surface_.DistanceToPieceOf(corners_[0].foot, corners_[0].place))) return Halve(corners_, 0);
  parts_.clear();
  if (!all) parts_.push_back(corners_);
  for (size_t i = 0; all && i < doubtful_.size() && (certain_ || found_.is_kept); ++i) {
    const DoubtfulPart& part = doubtful_[i];
    const std::array<PlaceAndFoot, 3>* before =
        i > 0 && part.start.patch == doubtful_[i - 1].start.patch ? &parts_.back() : nullptr;
    std::array<PlaceAndFoot, 3> places;
    for (int corner = 0; corner < 3; ++corner) {
      const PlaceAndFoot* known = nullptr;  // parts of one face share places
      for (int k = 0; before && k < 3; ++k) {
        if ((*before)[k].place == part.corners[corner]) known = &(*before)[k];
      }
      if (known)
        places[corner] = *known;
      else
        Note(places[corner] = Closest(part.start, part.corners[corner]));
    }
    parts_.push_back(places);
  }
  SettleParts();
}

// No less than the distance anywhere in a part.
double DeviationMeter::MostOver(const std::array<PlaceAndFoot, 3>& c) const {
  double most = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const PlaceAndFoot &a = c[i], &b = c[(i + 1) % 3], &d = c[(i + 2) % 3];
    most = std::min(most, a.Gap() + std::max(Distance(a.place, b.place), Distance(a.place, d.place)));
    if (most <= bound_) return most;
    most = std::min(most, std::max({a.Gap(), surface_.DistanceToPieceOf(a.foot, b.place),
                                    surface_.DistanceToPieceOf(a.foot, d.place)}));
    if (most <= bound_) return most;
  }
  return most;
}

void DeviationMeter::SettleParts() {
  for (size_t i = 0; i < parts_.size() && found_.is_kept; ++i) {
    const std::array<PlaceAndFoot, 3> c = parts_[i];
    const double most = MostOver(c);
    if (most <= bound_) continue;
    if (parts_.size() >= (certain_ ? kMaxParts : kMaxPartsOfUncertain)) {
      if (!certain_) return;
      found_.is_kept = false;
      if (most > found_.largest) found_.largest = most;
      return;
    }
    int longest = 0;
    double length2[3];
    for (int k = 0; k < 3; ++k) {
      length2[k] = SquaredDistance(c[k].place, c[(k + 1) % 3].place);
      if (length2[k] > length2[longest]) longest = k;
    }
    const PlaceAndFoot &a = c[longest], &b = c[(longest + 1) % 3], &d = c[(longest + 2) % 3];
    const PlaceAndFoot middle = Middle(a, b);
    parts_.push_back({a, middle, d});
    parts_.push_back({middle, b, d});
  }
}

// The surface's place next to a place: from the triangle's nearest corner, which is the shortest way, and where that ends beyond the bound,
// as in a hollow beside the closest place, from `start` and from the other corners as well.
PlaceAndFoot DeviationMeter::Closest(const SourcePoint& start, const Vec3& place) const {
  const auto distance2 = [&](int i) { return SquaredDistance(corners_[i].place, place); };
  int nearest = distance2(1) < distance2(0) ? 1 : 0;
  if (distance2(2) < distance2(nearest)) nearest = 2;
  const std::array<const SourcePoint*, 4> starts = {&corners_[nearest].foot, &start, &corners_[(nearest + 1) % 3].foot,
                                                    &corners_[(nearest + 2) % 3].foot};
  PlaceAndFoot closest{place, surface_.Snap(*starts[0], place)};
  for (int i = 1; i < 4 && closest.Gap() > bound_; ++i) {
    const PlaceAndFoot other{place, surface_.Snap(*starts[i], place)};
    if (other.Gap() < closest.Gap()) closest = other;
  }
  return closest;
}

PlaceAndFoot DeviationMeter::Middle(const PlaceAndFoot& a, const PlaceAndFoot& b) {
  const PlaceAndFoot middle = Closest(a.foot, 0.5 * (a.place + b.place));
  Note(middle);
  return middle;
}

// How much the distance grows at most along the triangle, for each unit of the way: the sine between its normal and the way to the foot.
double DeviationMeter::SlopeAt(const PlaceAndFoot& at) const {
  const double gap = at.Gap();
  if (gap < kLeastGapForSlope * bound_) return 1;
  const double along = Dot(at.foot.position - at.place, normal_) / gap;
  return std::sqrt(std::max(0.0, 1 - along * along));
}

void DeviationMeter::Halve(const std::array<PlaceAndFoot, 3>& c, int halvings) {
  const std::array<PlaceAndFoot, 3> m = {Middle(c[0], c[1]), Middle(c[1], c[2]), Middle(c[2], c[0])};
  const double bend = std::max({BendOver(c[0], c[1], m[0]), BendOver(c[1], c[2], m[1]), BendOver(c[2], c[0], m[2])});
  const std::array<std::array<PlaceAndFoot, 3>, 4> parts = {
      {{m[0], m[1], m[2]}, {c[0], m[0], m[2]}, {m[0], c[1], m[1]}, {m[2], m[1], c[2]}}};
  for (const auto& part : parts) {
    const double gap = std::max({part[0].Gap(), part[1].Gap(), part[2].Gap()});
    const double side = std::max({Distance(part[0].place, part[1].place), Distance(part[1].place, part[2].place),
                                  Distance(part[2].place, part[0].place)});
    const double slope = std::min(1.0, kSlopeMargin * std::max({SlopeAt(part[0]), SlopeAt(part[1]), SlopeAt(part[2])}));
    const double more = std::min(kBendPerHalving * bend, kReachPerSide * slope * side);
    if (gap > bound_ || (halvings + 1 >= kMinHalvings && gap + more <= bound_)) continue;
    if (halvings + 1 < kMaxHalvings) Halve(part, halvings + 1);
  }
}

}  // namespace meshfront
