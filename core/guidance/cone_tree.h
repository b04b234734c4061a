// A kd-tree over the cones ĝ_i of the guidance field, bounded by place and by height: what pruning and evaluation share.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/types/span.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// A cone: height `apex` (= l/η) at `position`, rising with the tree's slope (1 − 1/η).
struct Cone {
  Vec3 position;
  double apex = 0;  // > 0; +infinity: not there (yet)
};

// Four cones side by side, so that they are looked at without gathers. Unused places hold apex +infinity.
struct ConeBlock {
  static constexpr int kLanes = 4;  // two SSE2 registers of doubles each
  double x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {}, apex[kLanes];
};

// The blocks of a tree that hold the cones of the lower envelope inside some ball.
struct ConePatch {
  static constexpr int kCapacity = 128;
  int blocks = 0;
  const ConeBlock* block[kCapacity];
};

// Answers queries over the lower envelope of cones of one slope. Exact: every answer is the one a scan over all cones with
// slope · |x − position| + apex would give, in every bit. Queries are const, allocate nothing and may run on many threads;
// Activate must not run beside them.
class ConeTree {
 public:
  // `leaf_size` in [4, 256]. O(n log n). The cones are taken over, so that they are gone before the tree stands.
  ConeTree(std::vector<Cone> cones, double slope, int leaf_size);

  // The minimum of the cones at x if that is below `limit`, else any value ≥ limit (+infinity mostly).
  double MinAt(const Vec3& x, double limit) const;

  // Makes a patch of the cones that are, somewhere in a ball, the lowest of those below `limit` at its centre: those that lie less than
  // 2 · slope · radius above the minimum there. False, and no patch, where their blocks are more than its capacity. The tree outlives it.
  bool Gather(const Vec3& center, double radius, double limit, ConePatch& patch) const;
  // The minimum of a patch's cones at x, +infinity where it has none: in every bit what MinAt finds in the ball, where that is below the
  // patch's limit less slope · radius.
  double MinOf(const ConePatch& patch, const Vec3& x) const;
  // The same cones with other heights, one for each in the order in which they were given. O(n).
  ConeTree WithApexes(absl::Span<const double> apexes) const;

  // True when a cone other than `except` (an index into the cones given; its own apex must be +infinity still) is at most
  // `height` at its position. Searches outward from where that cone is stored.
  bool AnyAtMost(uint32_t except, double height) const;
  // Gives the cone with this index its height. It must be +infinity so far.
  void Activate(uint32_t cone, double apex);

 private:
  static constexpr int kLanes = ConeBlock::kLanes;  // cones of a block, children of a node
  using Block = ConeBlock;
  // Up to four children, bounded side by side. Unused ones, and those without an active cone, hold apex +infinity.
  struct alignas(64) Node {
    double min_x[kLanes] = {}, min_y[kLanes] = {}, min_z[kLanes] = {};
    double max_x[kLanes] = {}, max_y[kLanes] = {}, max_z[kLanes] = {};
    double min_apex[kLanes];
    uint32_t child[kLanes] = {};  // an inner node, or kLeafBit | leaf
  };
  // Where a node or leaf hangs: `lane` of `node`.
  struct Place {
    uint32_t node = 0, lane = 0;
  };
  struct Leaf {
    uint32_t first_block = 0, block_count = 0;
    Place place;
  };
  struct Item {
    Vec3 position;
    double apex;
    uint32_t cone;
  };

  void CountFor(size_t items, size_t& nodes, size_t& blocks) const;
  uint32_t Build(absl::Span<Item> items, const Place& place);
  void Attach(const Place& place, absl::Span<Item> items);
  uint32_t MakeLeaf(absl::Span<const Item> items, const Place& place);
  void BoundChildren(const Node& node, const Vec3& x, double bounds[kLanes]) const;
  double MinOfLeaf(const Leaf& leaf, const Vec3& x) const;
  void FindMinApexes();
  double SearchBelow(uint32_t root, uint32_t skipped_lane, const Vec3& x, double limit, bool first_hit) const;

  double slope_;
  size_t leaf_size_;
  std::vector<Node> nodes_;     // the root first
  std::vector<Place> parents_;  // of nodes
  std::vector<Leaf> leaves_;
  std::vector<Block> blocks_;
  std::vector<uint32_t> slots_;    // of cones: 4 · block + lane
  std::vector<uint32_t> leaf_of_;  // of blocks
};

}  // namespace meshfront
