// 1. The rims as loops of half-edges with their arcs (RimMap). 2. From places on each half-edge a straight line across the patch,
// perpendicular to it, over the faces laid flat one after the other (WalkAcross), until a rim. 3. Unless the way there along the rim
// is short, or as long as that to the tip of a wedge and back (IsBend). 4. Half-edges that are long against the width are halved and
// looked at again (MeasureAlong).
//
//        rim  ────────┬──────────      A line from the middle of a rim's edge, and from more of its places where the
//                     │ width          patch is narrow against the edge.
//        rim  ───•────┴────•─────
//
// Rejected: the closest point of another rim. In a wedge it is the corner's tip, and each detail of a rim is near itself.
#include "core/features/patch_width.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/features/tolerances.h"

namespace meshfront {
namespace {

constexpr size_t kGrain = 16;

struct RimPlace {
  uint32_t half_edge = 0;
  uint32_t loop = 0;
  double arc = 0;  // along the loop, at the half-edge's origin
};

// The rims' half-edges in increasing order, and where on their loops they lie.
class RimMap {
 public:
  explicit RimMap(const MeshSurface& surface) {
    for (const std::vector<uint32_t>& loop : FindBoundaryLoops(surface.adjacency())) {
      double arc = 0;
      for (const uint32_t h : loop) {
        places_.push_back({h, static_cast<uint32_t>(lengths_.size()), arc});
        arc += Distance(surface.mesh().PositionAt(OriginOf(surface.mesh(), h)),
                        surface.mesh().PositionAt(TargetOf(surface.mesh(), h)));
      }
      lengths_.push_back(arc);
    }
    std::sort(places_.begin(), places_.end(),
              [](const RimPlace& a, const RimPlace& b) { return a.half_edge < b.half_edge; });
  }

  const std::vector<RimPlace>& places() const { return places_; }
  const RimPlace& PlaceOf(uint32_t half_edge) const {
    return *std::lower_bound(places_.begin(), places_.end(), half_edge,
                             [](const RimPlace& p, uint32_t h) { return p.half_edge < h; });
  }
  // The shorter of the two ways along a rim; +infinity between two of them.
  double WayBetween(const RimPlace& a, double beyond_a, const RimPlace& b, double beyond_b) const {
    if (a.loop != b.loop) return INFINITY;
    const double way = std::abs(a.arc + beyond_a - b.arc - beyond_b);
    return std::min(way, lengths_[a.loop] - way);
  }

 private:
  std::vector<RimPlace> places_;
  std::vector<double> lengths_;  // of each loop
};

// Where a line meets a rim.
struct Crossing {
  uint32_t half_edge = 0;
  double along = 0;  // length from the half-edge's origin
  double width = 0;
  double slope = 0;  // sine of the angle between the rims, ≥ 0
};

// A line on its way into a face: through the half-edge h at `along` from its origin. In the plane of the face with h as the x
// axis and the face above it, its direction is (x, y), y ≥ 0.
struct Line {
  uint32_t h = 0;
  double along = 0;
  double x = 0, y = 1;
};

// To the side of the face through which the line leaves: it turns to the frame of that side, seen from the face beyond. Returns
// the length inside the face; nothing in a face without area.
std::optional<double> CrossFace(const TriangleMesh& mesh, Line& line) {
  const uint32_t next = NextHalfEdge(line.h);
  const Vec3& a = mesh.PositionAt(OriginOf(mesh, line.h));
  const Vec3& b = mesh.PositionAt(OriginOf(mesh, next));
  const Vec3& c = mesh.PositionAt(TargetOf(mesh, next));
  const double base = Distance(a, b);
  if (!(base > 0)) return std::nullopt;
  const double apex_x = Dot(c - a, b - a) / base;
  const double apex_y = std::sqrt(std::max(SquaredDistance(a, c) - apex_x * apex_x, 0.0));
  // To the right of the apex the line leaves through b c, to its left through c a.
  const bool right = line.x * apex_y - line.y * (apex_x - line.along) > 0;
  const double from_x = right ? base : apex_x, from_y = right ? 0 : apex_y;
  const double side_x = (right ? apex_x : 0) - from_x, side_y = (right ? apex_y : 0) - from_y;
  const double side = std::hypot(side_x, side_y), across = line.x * side_y - line.y * side_x;
  if (!(side > 0) || !(across > 0)) return std::nullopt;
  // along + t (x, y) = from + s (side_x, side_y)
  const double gap_x = from_x - line.along;
  const double t = std::max((gap_x * side_y - from_y * side_x) / across, 0.0);
  const double s = std::clamp((gap_x * line.y - from_y * line.x) / across, 0.0, 1.0);
  line.h = right ? next : PreviousHalfEdge(line.h);
  line.along = s * side;
  const double forward = (line.x * side_x + line.y * side_y) / side;
  line.y = across / side;
  line.x = forward;
  return t;
}

std::optional<Crossing> WalkAcross(const MeshSurface& surface, uint32_t h, double along, double limit) {
  Line line{h, along, 0, 1};
  double width = 0;
  for (int faces = 0; faces < kMaxWidthFaces; ++faces) {
    const std::optional<double> length = CrossFace(surface.mesh(), line);
    if (!length) return std::nullopt;
    width += *length;
    if (width > limit) return std::nullopt;
    const uint32_t beyond = surface.adjacency().OppositeOf(line.h);
    if (beyond == kNoHalfEdge) return Crossing{line.h, line.along, width, std::abs(line.x)};
    const TriangleMesh& mesh = surface.mesh();
    // The half-edge beyond runs the other way, and the face beyond lies above it.
    line.along =
        Distance(mesh.PositionAt(OriginOf(mesh, beyond)), mesh.PositionAt(TargetOf(mesh, beyond))) - line.along;
    line.x = -line.x;
    line.h = beyond;
  }
  return std::nullopt;
}

class WidthMeter {
 public:
  WidthMeter(const MeshSurface& surface, const RimMap& rims) : surface_(surface), rims_(rims) {}

  void Measure(const RimPlace& rim, const WidthRange& range, std::vector<WidthSample>& samples) const {
    const TriangleMesh& mesh = surface_.mesh();
    const double length =
        Distance(mesh.PositionAt(OriginOf(mesh, rim.half_edge)), mesh.PositionAt(TargetOf(mesh, rim.half_edge)));
    if (!(length > 0 && range.least <= range.most)) return;
    const double pieces = std::clamp(std::ceil(length / (kWidthSpacing * range.most)), 1.0, double{kMaxWidthPieces});
    for (double i = 0; i < pieces; ++i)
      MeasureAlong(rim, i / pieces * length, (i + 1) / pieces * length, range, 0, samples);
  }

 private:
  void MeasureAlong(const RimPlace& rim, double begin, double end, const WidthRange& range, int halvings,
                    std::vector<WidthSample>& samples) const {
    const double middle = 0.5 * (begin + end);
    const std::optional<Crossing> crossing = WalkAcross(surface_, rim.half_edge, middle, range.most);
    if (!crossing) return;
    const double width = crossing->width;
    const bool is_piece = end - begin <= kWidthSpacing * std::max(width, range.least) || halvings == kMaxWidthHalvings;
    if (width >= range.least && !IsBend(rim, middle, *crossing))
      samples.push_back({PlaceAt(rim, middle), width, rim.half_edge, is_piece ? end - begin : 0});
    if (is_piece) return;
    MeasureAlong(rim, begin, middle, range, halvings + 1, samples);
    MeasureAlong(rim, middle, end, range, halvings + 1, samples);
  }
  // At a corner, or in a wedge: both are as narrow as their angle makes them, down to nothing.
  bool IsBend(const RimPlace& rim, double along, const Crossing& crossing) const {
    const double way = rims_.WayBetween(rim, along, rims_.PlaceOf(crossing.half_edge), crossing.along);
    if (way <= kStripDetour * crossing.width) return true;
    if (crossing.slope < kMinWedgeSine) return false;
    const double cosine = std::sqrt(std::max(1 - crossing.slope * crossing.slope, 0.0));
    const double to_tip_and_back = crossing.width * (1 + cosine) / crossing.slope;
    return way >= kMinWedgeWay * to_tip_and_back && way <= kMaxWedgeWay * to_tip_and_back;
  }
  Vec3 PlaceAt(const RimPlace& rim, double along) const {
    const TriangleMesh& mesh = surface_.mesh();
    const Vec3 &a = mesh.PositionAt(OriginOf(mesh, rim.half_edge)), &b = mesh.PositionAt(TargetOf(mesh, rim.half_edge));
    return Lerp(a, b, along / Distance(a, b));
  }

  const MeshSurface& surface_;
  const RimMap& rims_;
};

}  // namespace

absl::StatusOr<std::vector<WidthSample>> MeasurePatchWidths(const MeshSurface& surface,
                                                            const std::vector<WidthRange>& ranges,
                                                            const Context& context) {
  const RimMap rims(surface);
  const WidthMeter meter(surface, rims);
  const size_t count = rims.places().size();
  std::vector<std::vector<WidthSample>> blocks((count + kGrain - 1) / kGrain);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(count, kGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const RimPlace& rim = rims.places()[i];
      const uint32_t component = surface.ComponentOf(FaceId(FaceOfHalfEdge(rim.half_edge)));
      meter.Measure(rim, ranges[component], blocks[begin / kGrain]);
    }
  }));
  std::vector<WidthSample> samples;
  for (const std::vector<WidthSample>& block : blocks) samples.insert(samples.end(), block.begin(), block.end());
  return samples;
}

}  // namespace meshfront
