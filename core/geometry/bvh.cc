// Building the hierarchy:
//
// 1. Morton codes, 16 bits an axis, of the triangles' box centres in a cube around all (MortonCodes).
// 2. The faces in the order of their codes, by four counting passes (SortByCode).
// 3. Top down, each range is cut where the highest bit that differs changes, which is a plane of the cube's grid; equal
//    codes are halved. Boxes are joined on the way up (Build).
// Rejected: binned surface-area splits; queries gain 10 to 20 %, and building takes three times as long.
#include "core/geometry/bvh.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace meshfront {
namespace {

constexpr int kBitsPerAxis = 16;
constexpr int kDigitBits = 12;

// abcd -> a00b00c00d.
uint64_t SpreadBits(uint64_t x) {
  x = (x | x << 32) & 0x00ff00000000ffffull;
  x = (x | x << 16) & 0x00ff0000ff0000ffull;
  x = (x | x << 8) & 0xf00f00f00f00f00full;
  x = (x | x << 4) & 0x30c30c30c30c30c3ull;
  return (x | x << 2) & 0x9249249249249249ull;
}

struct CodedFace {
  uint64_t code;
  uint32_t face;
};

void SortByCode(std::vector<CodedFace>& faces) {
  if (faces.size() < (1u << kDigitBits)) {  // the tables below would cost more
    std::sort(faces.begin(), faces.end(), [](const CodedFace& a, const CodedFace& b) {
      return a.code != b.code ? a.code < b.code : a.face < b.face;
    });
    return;
  }
  std::vector<CodedFace> sorted(faces.size());
  for (int shift = 0; shift < 3 * kBitsPerAxis; shift += kDigitBits) {
    const auto digit = [&](const CodedFace& f) { return (f.code >> shift) & ((1u << kDigitBits) - 1); };
    std::vector<uint32_t> start((1u << kDigitBits) + 1, 0);
    for (const CodedFace& f : faces) ++start[digit(f) + 1];
    for (size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    for (const CodedFace& f : faces) sorted[start[digit(f)]++] = f;
    faces.swap(sorted);
  }
}

// Where the highest differing bit of a sorted range turns to 1; the middle when all are equal.
uint32_t SplitOf(absl::Span<const uint64_t> codes, uint32_t begin, uint32_t end) {
  const uint64_t difference = codes[begin] ^ codes[end - 1];
  if (difference == 0) return begin + (end - begin) / 2;
  const uint64_t bit = std::bit_floor(difference);
  uint32_t low = begin, high = end - 1;  // codes[low] has 0 there, codes[high] has 1
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (codes[middle] & bit ? high : low) = middle;
  }
  return high;
}

// One or two floats farther out than x.
float RoundedDown(double x) {
  const float nearest = static_cast<float>(x);
  return nearest - std::numeric_limits<float>::epsilon() * std::abs(nearest) - std::numeric_limits<float>::min();
}
float RoundedUp(double x) { return -RoundedDown(-x); }

}  // namespace

TriangleBvh::TriangleBvh(absl::Span<const Vec3> positions, absl::Span<const Corners> triangles)
    : positions_(positions), triangles_(triangles) {
  if (triangles.empty()) return;
  const uint32_t count = static_cast<uint32_t>(triangles.size());
  for (uint32_t f = 0; f < count; ++f) bounds_.Extend(BoxOf(FaceId(f)));
  center_ = 0.5 * bounds_.min + 0.5 * bounds_.max;
  const Vec3 half = 0.5 * bounds_.max - 0.5 * bounds_.min;
  const double largest = std::max({half.x, half.y, half.z});
  scale_ = largest > 1e-290 ? 1 / largest : 1;

  std::vector<CodedFace> coded(count);
  const double cells = (1 << kBitsPerAxis) - 1;
  for (uint32_t f = 0; f < count; ++f) {
    const Box3 box = BoxOf(FaceId(f));
    const Vec3 q = ToFrame(0.5 * box.min + 0.5 * box.max);
    uint64_t code = 0;
    for (int i = 0; i < 3; ++i) {
      const double cell = std::clamp((0.5 + 0.5 * q[i]) * cells, 0.0, cells);
      code |= SpreadBits(static_cast<uint64_t>(cell)) << i;
    }
    coded[f] = {code, f};
  }
  SortByCode(coded);
  order_.resize(count);
  std::vector<uint64_t> codes(count);
  for (uint32_t i = 0; i < count; ++i) order_[i] = coded[i].face, codes[i] = coded[i].code;
  coded = {};
  nodes_.reserve(count / 2 + 2 * kLeafSize);
  nodes_.resize(2);  // the root, and a pad that keeps siblings on even places
  Build(0, 0, count, codes);
}

void TriangleBvh::Build(uint32_t node, uint32_t begin, uint32_t end, absl::Span<const uint64_t> codes) {
  Box3 box;
  if (end - begin <= kLeafSize) {
    for (uint32_t i = begin; i < end; ++i) box.Extend(BoxOf(FaceId(order_[i])));
    nodes_[node].first = begin;
    nodes_[node].count = end - begin;
    SetBox(node, box);
    return;
  }
  const uint32_t children = static_cast<uint32_t>(nodes_.size());
  nodes_.resize(children + 2);
  const uint32_t split = SplitOf(codes, begin, end);
  Build(children, begin, split, codes);
  Build(children + 1, split, end, codes);
  Node& self = nodes_[node];
  const Node &left = nodes_[children], &right = nodes_[children + 1];
  self.first = children;
  self.count = 0;
  for (int i = 0; i < 3; ++i) {
    self.min[i] = std::min(left.min[i], right.min[i]);
    self.max[i] = std::max(left.max[i], right.max[i]);
  }
}

void TriangleBvh::SetBox(uint32_t node, const Box3& box) {
  const Vec3 low = ToFrame(box.min), high = ToFrame(box.max);
  for (int i = 0; i < 3; ++i) nodes_[node].min[i] = RoundedDown(low[i]), nodes_[node].max[i] = RoundedUp(high[i]);
}

Box3 TriangleBvh::BoxOf(FaceId f) const {
  const Vec3 &a = Corner(f, 0), &b = Corner(f, 1), &c = Corner(f, 2);
  Box3 box;
  box.min = Min(Min(a, b), c);
  box.max = Max(Max(a, b), c);
  return box;
}

TriangleBvh::Ray TriangleBvh::RayInFrame(const Vec3& origin, const Vec3& direction, double t0, double t1) const {
  // A component of 0 becomes one so small that the slab's ends are reached at enormous t only; never 0 · ∞.
  constexpr double kHuge = 1e200;
  Ray ray{ToFrame(origin), {}, t0, t1};
  for (int i = 0; i < 3; ++i) {
    const double d = scale_ * direction[i];
    ray.inverse[i] = std::abs(d) > 1 / kHuge ? 1 / d : std::copysign(kHuge, d);
  }
  return ray;
}

// The signs of the three volumes that the ray spans with the sides tell where it passes; both triangles at a side
// compute the same number there with opposite signs, so that no ray passes between them.
std::optional<SegmentHit> TriangleBvh::HitFace(FaceId f, const Vec3& origin, const Vec3& direction) const {
  const Vec3 a = Corner(f, 0) - origin, b = Corner(f, 1) - origin, c = Corner(f, 2) - origin;
  const double u = Dot(direction, Cross(b, c)), v = Dot(direction, Cross(c, a)), w = Dot(direction, Cross(a, b));
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
  const double sum = u + v + w;
  if (sum == 0) return std::nullopt;
  SegmentHit hit{f, 0, {u / sum, v / sum, w / sum}};
  hit.t =
      (hit.weights[0] * Dot(a, direction) + hit.weights[1] * Dot(b, direction) + hit.weights[2] * Dot(c, direction)) /
      SquaredNorm(direction);
  return hit;
}

}  // namespace meshfront
