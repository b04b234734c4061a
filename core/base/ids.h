// Typed indices that never decay to an integer.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace meshfront {

// An index into one kind of array. `Tag` keeps vertices and faces apart; the default value is invalid. 32 bits, trivially
// copyable: an array of them is an array of uint32_t in memory.
template <class Tag>
class Id {
 public:
  static constexpr uint32_t kInvalid = 0xffffffffu;

  constexpr Id() = default;
  constexpr explicit Id(uint32_t index) : index_(index) {}
  constexpr explicit Id(size_t index) : index_(static_cast<uint32_t>(index)) {}
  constexpr explicit Id(int index) : index_(static_cast<uint32_t>(index)) {}

  constexpr uint32_t index() const { return index_; }
  constexpr bool valid() const { return index_ != kInvalid; }

  friend constexpr bool operator==(Id, Id) = default;
  friend constexpr auto operator<=>(Id, Id) = default;
  template <class H>
  friend H AbslHashValue(H state, Id id) {
    return H::combine(std::move(state), id.index_);
  }

 private:
  uint32_t index_ = kInvalid;
};

using VertexId = Id<struct VertexTag>;  // a vertex of a mesh (input or output)
using FaceId = Id<struct FaceTag>;      // a triangle of a mesh

}  // namespace meshfront
