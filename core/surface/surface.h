// What the advancing front knows of the thing it meshes (sec. 3.2, 3.4): anything that can place a point on itself and tell a
// normal and a maximum curvature there.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// A place on a surface: position, unit normal, and what the surface needs to walk on from there (a mesh: the face and the
// barycentric weights of its second and third corner). The last three are the surface's own; nobody else interprets them.
struct SourcePoint {
  Vec3 position;
  Vec3 normal;
  uint32_t patch = 0xffffffffu;
  double u = 0, v = 0;
};

// A place of a triangle and the surface's over it, seen along the triangle's normal. `is_detail`: the surface has a corner there that
// places next to it don't tell of.
struct FarPlace {
  Vec3 below;
  SourcePoint above;
  bool is_detail = false;
  bool is_beside = false;  // the place below lies in the triangle's plane, but outside it
};

// A part of a triangle that may be farther from the surface than the rest, and where over it to begin.
struct DoubtfulPart {
  std::array<Vec3, 3> corners;
  SourcePoint start;
};

// A stretch of a way over a surface inside one of its patches, straight there.
struct WayPiece {
  uint32_t patch;
  Vec3 from, to;
};
// Whether two ways cross inside a patch that both pass. Ways that only touch, or run along each other, don't.
bool WaysCross(absl::Span<const WayPiece> way, absl::Span<const WayPiece> other);

// Implemented by: MeshSurface, ImplicitMlsSurface, MlsSurface. Called by: the front, its closure and its settling window.
// Immutable after construction, safe to read from many threads, deterministic. No call leaves the connected sheet that its
// starting points lie on: the other side of a thin plate is never reached.
class Surface {
 public:
  virtual ~Surface() = default;

  // The point x on the surface with |x − a| = radius_a and |x − b| = radius_b (within 1e-9 of them, relative), on the open
  // (right-hand) side of the directed edge a → b, that is towards (b − a) × normal; among several, the one whose triangle
  // (b, a, x) has its normal closest to those at a and b (sec. 3.2). Nothing when the spheres do not meet each other, or meet
  // the surface only beyond its rim or on another sheet.
  virtual std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                              double radius_b) const = 0;

  // The locally closest point of the surface to `target`, reached from `start` by descending the distance along the connected
  // sheet. Always succeeds; the result may be far from `target` when the sheet does not come near it.
  virtual SourcePoint Snap(const SourcePoint& start, const Vec3& target) const = 0;
  // The same place without its normal, which is left zero where that saves time.
  virtual SourcePoint Foot(const SourcePoint& start, const Vec3& target) const { return Snap(start, target); }
  // Whether Snap from `start` comes within `tolerance` of a place of the surface. `tolerance`: more than rounding.
  virtual bool Reaches(const SourcePoint& start, const SourcePoint& place, double tolerance) const {
    return Distance(Foot(start, place.position).position, place.position) <= tolerance;
  }

  // Maximum absolute principal curvature at p, 1/length, ≥ 0.
  virtual double MaxCurvatureAt(const SourcePoint& p) const = 0;

  // True when p lies on the rim of an open surface (within rounding).
  virtual bool IsOnBoundary(const SourcePoint& p) const = 0;

  // The way from a to b over the surface that lies in one plane with the mean of their normals, piece by piece. False, and no way,
  // when that section does not lead from a to b. Surfaces without patches have none, and say so.
  virtual bool HasWays() const { return false; }
  virtual bool TraceWay(const SourcePoint& a, const SourcePoint& b, std::vector<WayPiece>& way) const {
    static_cast<void>(a), static_cast<void>(b);
    way.clear();
    return false;
  }

  // Which of the surface's sheets p lies on: patches between creases are sheets of their own, whose meshes meet in the creases
  // only and need not be kept apart elsewhere.
  virtual uint32_t SheetOf(const SourcePoint& p) const {
    static_cast<void>(p);
    return 0;
  }

  // Collects places where a triangle and the surface over it, around `start`, may be farther apart than `bound`. True: the triangle is
  // nowhere farther from the surface but in the doubtful parts, which are not told where `doubtful` is null. False: it can't tell of all
  // of the triangle. Details beside the triangle belong to it by up to `beside` of its size. Surfaces that have no faces never can.
  virtual bool FindFarPlaces(const SourcePoint& start, const std::array<Vec3, 3>& triangle, double bound, double beside,
                             std::vector<FarPlace>& far, std::vector<DoubtfulPart>* doubtful) const {
    static_cast<void>(start), static_cast<void>(triangle), static_cast<void>(bound), static_cast<void>(beside);
    far.clear();
    if (doubtful) doubtful->clear();
    return false;
  }

  // How far a place is from the flat piece of the surface that p lies on: no less than from the surface, and convex, so that over a
  // triangle it is largest at a corner. Infinite where the surface has no such pieces.
  virtual double DistanceToPieceOf(const SourcePoint& p, const Vec3& place) const {
    static_cast<void>(p), static_cast<void>(place);
    return std::numeric_limits<double>::infinity();
  }

  // Whether the surface itself passes through or touches itself within `radius` of a place: there a mesh of it may do the same.
  // Asked rarely; the context may stop what the first answer needs, which then is yes. Surfaces that can't tell say no.
  virtual bool MeetsItselfNear(const Vec3& place, double radius, const Context& context) const {
    static_cast<void>(place), static_cast<void>(radius), static_cast<void>(context);
    return false;
  }
};

}  // namespace meshfront
