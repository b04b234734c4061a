// Which front edges are near, and may a new edge stand among them? Fences of sec. 3.4 and Figure 4: every front edge extruded
// by ±h along the surface normal.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/front/front_set.h"

namespace meshfront {

// A front edge as the tests see it.
struct Fence {
  FrontEdgeId edge;
  uint32_t from, to;  // which vertices of the output its ends are: FrontSet::IdentityOf
  uint32_t sheet;     // Surface::SheetOf
  Vec3 start, end;
  Vec3 normal;         // mean of the surface normals at the ends, unit length
  double half_height;  // h

  double Length() const { return Distance(start, end); }
};

// A segment that is about to become an edge.
struct NewEdge {
  Vec3 start, end;
  Vec3 normal;
  double half_height;
};

// h of an edge: kFenceHeightPerError · ε(length, curvature), at least kMinFenceHeightPerLength · length.
double FenceHalfHeight(double length, double max_curvature);

// Whether the new edge passes through the fence or the front edge through the new edge's own fence: seen along the mean of
// their normals the two cross, and where they do their heights differ by at most the greater h. Symmetric, so one test serves
// both ways. Unclear: they cross farther apart, or their normals differ by more than 45°, so that what is seen depends on where one
// stands: another sheet, or rough ground. Only the surface can tell (Surface::TraceWay).
enum class Crossing : uint8_t { kNone, kUnclear, kCrosses };
Crossing CrossFence(const NewEdge& edge, const Fence& fence);
// Distance from p, whose normal is `normal`, to the fence; infinite when it stands on another sheet.
double DistanceToFence(const Vec3& p, const Vec3& normal, const Fence& fence);

// Angle turned clockwise about `normal` from one direction to another, as a monotone stand-in in [0, 4): 1 for 90°, exact at
// multiples of 45°. No library transcendental, so that it is the same in every bit everywhere.
double ClockwiseTurn(const Vec3& normal, const Vec3& from, const Vec3& to);
// The same from what stands for its cosine and its sine.
inline double TurnOf(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (sum == 0) return 0;
  if (y >= 0) return x >= 0 ? y / sum : 1 - x / sum;
  const double turn = x < 0 ? 2 - y / sum : 3 + x / sum;
  return turn < 4 ? turn : 0;
}
inline double ClockwiseTurn(const Vec3& normal, const Vec3& from, const Vec3& to) {
  return TurnOf(Dot(from, to) - Dot(from, normal) * Dot(to, normal), Dot(normal, Cross(to, from)));
}

// A multi-level hash grid of the live front edges: level = ⌊log2 length⌋, cells of 8 such lengths, an edge in the cell of its
// middle. Insert, erase and query cost O(1) however strongly the fronts are graded.
class FenceIndex {
 public:
  explicit FenceIndex(const FrontSet& fronts);

  void Insert(FrontEdgeId edge);  // reads its geometry: vertices on a front do not move
  void Erase(FrontEdgeId edge);
  const Fence& at(FrontEdgeId edge) const { return fences_[edge.index()]; }
  // The least ball around a front edge, without its height.
  struct Ball {
    Vec3 center;
    double radius = 0;
  };
  const Ball& BallOf(FrontEdgeId edge) const { return slots_[edge.index()].ball; }
  // From now on, until the next call, queries inside this ball are cheaper: its edges are kept apart, without hashing or levels, in
  // strips across the axis farthest from `normal`.
  void Focus(const Vec3& center, double radius, const Vec3& normal);
  void EndFocus() { focus_.radius = 0; }
  // Appends the edges that may come within `radius` of `center` (all that do, and some that do not), in an order that depends on
  // the history of inserts, erasures and the focus only.
  void Query(const Vec3& center, double radius, std::vector<FrontEdgeId>& found) const;

 private:
  // What a query reads of an edge, apart from its fence: one cache line.
  struct Slot {
    Ball ball;
    uint64_t cell = 0;
    uint32_t next = kNone, prev = kNone;
    uint32_t place = 0;        // among the members of its level
    uint32_t focus_place = 0;  // in its strip of the focus
    int16_t level = -1;        // −1: not in the index
    uint16_t focus_strip = kNotInFocus;
  };
  // Balls of edges in the focus, in parts of its own, four side by side. Places that are not used are out of reach.
  static constexpr uint32_t kLanes = 4;
  struct Block {
    float x[kLanes], y[kLanes], z[kLanes], radius[kLanes];
    uint32_t slot[kLanes];
  };
  struct Strip {
    std::vector<Block> blocks;
    uint32_t count = 0;  // of edges
  };
  static constexpr uint32_t kNone = 0xffffffffu;
  static constexpr uint16_t kNotInFocus = 0xffffu;
  static constexpr int kStrips = 16;
  static constexpr int kLevels = 2100;  // every exponent a double has

  uint64_t CellOf(int level, int64_t x, int64_t y, int64_t z) const;
  uint32_t& Bucket(uint64_t cell) { return buckets_[cell & (buckets_.size() - 1)]; }
  void LinkSlot(uint32_t slot);
  void Rehash();
  void AddToFocus(uint32_t slot);
  void DropFromFocus(uint32_t slot);
  int StripAt(double x) const;
  void QueryFocus(const Vec3& center, double radius, std::vector<FrontEdgeId>& found) const;

  const FrontSet* fronts_;
  std::vector<Slot> slots_;
  std::vector<Fence> fences_;
  std::vector<uint32_t> buckets_;
  std::vector<std::vector<uint32_t>> members_;  // by level: short lists are looked through instead of cells
  std::vector<int> levels_in_use_;
  size_t count_ = 0;
  Ball focus_;  // radius 0: none
  int focus_axis_ = 0;
  double largest_in_focus_ = 0;  // of the balls' radii
  std::array<Strip, kStrips> strips_;
};

}  // namespace meshfront
