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

// Answers queries over the lower envelope of cones of one slope. Exact: every answer is the one a scan over all cones with
// slope · |x − position| + apex would give, in every bit. Queries are const, allocate nothing and may run on many threads;
// Activate must not run beside them.
class ConeTree {
 public:
  // `leaf_size` in [4, 256]. O(n log n).
  ConeTree(absl::Span<const Cone> cones, double slope, int leaf_size);

  // The minimum of the cones at x if that is below `limit`, else any value ≥ limit (+infinity mostly).
  double MinAt(const Vec3& x, double limit) const;

  // True when a cone other than `except` (an index into the cones given; its own apex must be +infinity still) is at most
  // `height` at its position. Searches outward from where that cone is stored.
  bool AnyAtMost(uint32_t except, double height) const;
  // Gives the cone with this index its height. It must be +infinity so far.
  void Activate(uint32_t cone, double apex);

 private:
  // Four cones side by side, so that a leaf is scanned without gathers. Unused places hold apex +infinity.
  struct Block {
    double x[4] = {}, y[4] = {}, z[4] = {}, apex[4];
  };
  // One cache line. Children lie side by side; a leaf has none and `block_count` > 0.
  struct alignas(64) Node {
    Box3 box;
    double min_apex;
    uint32_t first = 0;  // left child, or first block
    uint32_t block_count = 0;
  };
  struct Item {
    Vec3 position;
    double apex;
    uint32_t cone;
  };
  struct Visit {
    double bound;
    uint32_t node;
  };

  void Build(uint32_t node, absl::Span<Item> items);
  void MakeLeaf(uint32_t node, absl::Span<const Item> items);
  double BoundOf(const Node& node, const Vec3& x) const;
  double MinOfLeaf(const Node& leaf, const Vec3& x) const;
  double SearchBelow(uint32_t root, const Vec3& x, double limit, bool first_hit) const;

  double slope_;
  int leaf_size_;
  std::vector<Node> nodes_;
  std::vector<Block> blocks_;
  std::vector<uint32_t> parents_;  // of nodes
  std::vector<uint32_t> slots_;    // of cones: 4 · block + lane
  std::vector<uint32_t> leaves_;   // of blocks: their node
};

}  // namespace meshfront
