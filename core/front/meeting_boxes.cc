// 1. Boxes in floats, rounded outwards, in a frame where all lie in [-1, 1]³ (BoxesInFrame).
// 2. The triangles in Morton order of their boxes' middles (OrderByPlace).
// 3. A tree whose nodes are four neighbours each, side by side, up to a single root (BoxTree).
// 4. The tree against itself: each child of a node against the four of another at once; at the triangles, those that share a corner
//    which keeps them apart are struck out four at a time as well (Join).
//
// Rejected: TriangleBvh::VisitOverlappingPairs. It is right, but nearly all pairs that it comes by are neighbours around a vertex, and
// telling that of one pair after the other took three times as long.
#include "core/front/meeting_boxes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/geometry/box.h"
#include "core/geometry/lanes.h"

namespace meshfront {
namespace {

constexpr uint32_t kLanes = 4;
constexpr int kDigits = 3, kBitsPerDigit = 10;  // of a place's code, one bit of each axis after the other
constexpr uint32_t kNoCorner = 0xffffffffu, kNoTriangle = 0xfffffffeu;

// Four boxes side by side. Those that are not used meet nothing.
struct Boxes {
  FourFloats min[3], max[3];
  Boxes() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = FourFloats{} + kInfinity;
      max[axis] = FourFloats{} - kInfinity;
    }
  }
  FourFlags Meet(const Boxes& other, uint32_t lane) const {
    FourFlags meet = (min[0] <= other.max[0][lane]) & (max[0] >= other.min[0][lane]);
    for (int axis = 1; axis < 3; ++axis)
      meet &= (min[axis] <= other.max[axis][lane]) & (max[axis] >= other.min[axis][lane]);
    return meet;
  }
};

// The corners of four triangles.
struct Corners {
  FourFlags name[3];
  uint32_t keeping_apart[3][kLanes];  // kNoCorner in place of the others
  Corners() {
    for (int i = 0; i < 3; ++i) {
      name[i] = FourFlags{} + static_cast<int32_t>(kNoTriangle);
      std::fill_n(keeping_apart[i], kLanes, kNoCorner);
    }
  }
  FourFlags Share(const Corners& other, uint32_t lane) const {
    FourFlags share{};
    for (int i = 0; i < 3; ++i) {
      const FourFlags corner = FourFlags{} + static_cast<int32_t>(other.keeping_apart[i][lane]);
      share |= (name[0] == corner) | (name[1] == corner) | (name[2] == corner);
    }
    return share;
  }
};

struct FloatBox {
  float min[3], max[3];
};

// One or two floats farther out than x.
float RoundedDown(double x) {
  const float nearest = static_cast<float>(x);
  return nearest - std::numeric_limits<float>::epsilon() * std::abs(nearest) - std::numeric_limits<float>::min();
}
float RoundedUp(double x) { return -RoundedDown(-x); }

std::vector<FloatBox> BoxesInFrame(absl::Span<const Vec3> positions, absl::Span<const Triangle> triangles) {
  Box3 all;
  for (const Triangle& t : triangles) {
    for (const VertexId v : t) all.Extend(positions[v.index()]);
  }
  const Vec3 center = 0.5 * all.min + 0.5 * all.max, half = 0.5 * all.max - 0.5 * all.min;
  const double largest = std::max({half.x, half.y, half.z});
  const double scale = largest > 1e-290 ? 1 / largest : 1;
  std::vector<FloatBox> corners(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = scale * (positions[i] - center);
    for (int axis = 0; axis < 3; ++axis)
      corners[i].min[axis] = RoundedDown(p[axis]), corners[i].max[axis] = RoundedUp(p[axis]);
  }
  std::vector<FloatBox> boxes(triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i) {
    const FloatBox &a = corners[triangles[i][0].index()], &b = corners[triangles[i][1].index()],
                   &c = corners[triangles[i][2].index()];
    for (int axis = 0; axis < 3; ++axis) {
      boxes[i].min[axis] = std::min(std::min(a.min[axis], b.min[axis]), c.min[axis]);
      boxes[i].max[axis] = std::max(std::max(a.max[axis], b.max[axis]), c.max[axis]);
    }
  }
  return boxes;
}

// abcd -> a00b00c00d, of ten bits.
uint32_t SpreadBits(uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

std::vector<uint32_t> OrderByPlace(const std::vector<FloatBox>& boxes) {
  struct Coded {
    uint32_t code, triangle;
  };
  constexpr float kCells = (1 << kBitsPerDigit) - 1;
  std::vector<Coded> coded(boxes.size()), sorted(boxes.size());
  for (uint32_t i = 0; i < boxes.size(); ++i) {
    uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float cell = (0.5f + 0.25f * (boxes[i].min[axis] + boxes[i].max[axis])) * kCells;
      code |= SpreadBits(static_cast<uint32_t>(std::clamp(cell, 0.0f, kCells))) << axis;
    }
    coded[i] = {code, i};
  }
  for (int digit = 0; digit < kDigits; ++digit) {
    const auto digit_of = [&](const Coded& c) {
      return c.code >> (digit * kBitsPerDigit) & ((1u << kBitsPerDigit) - 1);
    };
    std::vector<uint32_t> start((1u << kBitsPerDigit) + 1, 0);
    for (const Coded& c : coded) ++start[digit_of(c) + 1];
    for (size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    for (const Coded& c : coded) sorted[start[digit_of(c)]++] = c;
    coded.swap(sorted);
  }
  std::vector<uint32_t> order;
  order.reserve(boxes.size());
  for (const Coded& c : coded) order.push_back(c.triangle);
  return order;
}

class BoxTree {
 public:
  // `order` is kept.
  BoxTree(const std::vector<FloatBox>& boxes, const std::vector<uint32_t>& order, absl::Span<const uint8_t> is_wanted)
      : order_(order), levels_(1) {
    Level& triangles = levels_.front();
    triangles.boxes.resize((order.size() + kLanes - 1) / kLanes);
    triangles.is_wanted.resize(kLanes * triangles.boxes.size());
    for (uint32_t place = 0; place < order.size(); ++place) {
      Boxes& four = triangles.boxes[place / kLanes];
      const FloatBox& box = boxes[order[place]];
      for (int axis = 0; axis < 3; ++axis)
        four.min[axis][place % kLanes] = box.min[axis], four.max[axis][place % kLanes] = box.max[axis];
      triangles.is_wanted[place] = is_wanted[order[place]];
    }
    while (levels_.back().boxes.size() > 1) levels_.push_back(Above(levels_.back()));
  }
  void SetCorners(absl::Span<const Triangle> triangles, absl::Span<const uint8_t> keeps_apart) {
    corners_.resize(levels_.front().boxes.size());
    for (uint32_t place = 0; place < order_.size(); ++place) {
      Corners& four = corners_[place / kLanes];
      const uint32_t lane = place % kLanes;
      for (int i = 0; i < 3; ++i) {
        const uint32_t corner = triangles[order_[place]][i].index();
        four.name[i][lane] = static_cast<int32_t>(corner);
        if (keeps_apart[corner]) four.keeping_apart[i][lane] = corner;
      }
    }
  }
  void JoinWithItself(std::vector<std::pair<uint32_t, uint32_t>>& pairs) const {
    Join(static_cast<int>(levels_.size()) - 1, 0, 0, pairs);
  }

 private:
  // Nodes, four by four; the lowest are the triangles.
  struct Level {
    std::vector<Boxes> boxes;
    std::vector<uint8_t> is_wanted;  // or something below it is
  };

  static Level Above(const Level& below) {
    Level level;
    level.boxes.resize((below.boxes.size() + kLanes - 1) / kLanes);
    level.is_wanted.resize(kLanes * level.boxes.size());
    for (uint32_t node = 0; node < below.boxes.size(); ++node) {
      Boxes& four = level.boxes[node / kLanes];
      const Boxes& inside = below.boxes[node];
      for (uint32_t lane = 0; lane < kLanes; ++lane) {
        for (int axis = 0; axis < 3; ++axis) {
          float &low = four.min[axis][node % kLanes], &high = four.max[axis][node % kLanes];
          low = std::min(low, inside.min[axis][lane]), high = std::max(high, inside.max[axis][lane]);
        }
        level.is_wanted[node] |= below.is_wanted[kLanes * node + lane];
      }
    }
    return level;
  }
  // The four nodes or triangles of block `a` against those of block `b`, a ≤ b.
  void Join(int at, uint32_t a, uint32_t b, std::vector<std::pair<uint32_t, uint32_t>>& pairs) const {
    const Level& level = levels_[at];
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      const uint32_t node = kLanes * a + lane;
      FourFlags meet = level.boxes[b].Meet(level.boxes[a], lane);
      uint32_t others = LanesOf(meet);
      if (a == b) others &= ~0u << (at == 0 ? lane + 1 : lane);
      if (others == 0) continue;
      if (at == 0) others &= ~LanesOf(corners_[b].Share(corners_[a], lane));
      for (; others != 0; others &= others - 1) {
        const uint32_t other = kLanes * b + static_cast<uint32_t>(std::countr_zero(others));
        if (!(level.is_wanted[node] | level.is_wanted[other])) continue;
        if (at == 0)
          pairs.push_back({order_[node], order_[other]});
        else
          Join(at - 1, node, other, pairs);
      }
    }
  }

  const std::vector<uint32_t>& order_;
  std::vector<Level> levels_;
  std::vector<Corners> corners_;  // of the triangles, four by four
};

}  // namespace

MeetingBoxes FindMeetingBoxes(absl::Span<const Vec3> positions, absl::Span<const Triangle> triangles,
                              absl::Span<const uint8_t> is_wanted, absl::Span<const uint8_t> keeps_apart) {
  MeetingBoxes found;
  if (triangles.empty()) return found;
  const std::vector<FloatBox> boxes = BoxesInFrame(positions, triangles);
  found.order = OrderByPlace(boxes);
  BoxTree tree(boxes, found.order, is_wanted);
  tree.SetCorners(triangles, keeps_apart);
  tree.JoinWithItself(found.pairs);
  return found;
}

}  // namespace meshfront
