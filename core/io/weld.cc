#include "core/io/weld.h"

#include <array>
#include <bit>

#include "absl/hash/hash.h"

namespace meshfront {
namespace {

std::array<uint64_t, 3> BitsOf(const Vec3& p) {
  // Adding zero turns -0 into 0 and leaves everything else.
  return {std::bit_cast<uint64_t>(p.x + 0.0), std::bit_cast<uint64_t>(p.y + 0.0), std::bit_cast<uint64_t>(p.z + 0.0)};
}

size_t HashOf(const Vec3& p) { return absl::Hash<std::array<uint64_t, 3>>()(BitsOf(p)); }

}  // namespace

VertexId Welder::Add(const Vec3& point) {
  if (3 * (positions_.size() + 1) > 2 * slots_.size()) Grow();
  const size_t mask = slots_.size() - 1;
  size_t slot = HashOf(point) & mask;
  while (slots_[slot] != VertexId::kInvalid) {
    if (BitsOf(positions_[slots_[slot]]) == BitsOf(point)) return VertexId(slots_[slot]);
    slot = (slot + 1) & mask;
  }
  slots_[slot] = static_cast<uint32_t>(positions_.size());
  positions_.push_back(point);
  return VertexId(slots_[slot]);
}

void Welder::Grow() {
  const size_t size = slots_.empty() ? 64 : 2 * slots_.size();
  slots_ = {};
  slots_.assign(size, VertexId::kInvalid);
  for (size_t i = 0; i < positions_.size(); ++i) {
    size_t slot = HashOf(positions_[i]) & (size - 1);
    while (slots_[slot] != VertexId::kInvalid) slot = (slot + 1) & (size - 1);
    slots_[slot] = static_cast<uint32_t>(i);
  }
}

}  // namespace meshfront
