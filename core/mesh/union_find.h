// Disjoint sets over 0 … n − 1, with and without a parity between members.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace meshfront {

// The representative of a set is its smallest member. Almost O(1) a call.
class UnionFind {
 public:
  explicit UnionFind(size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }

  uint32_t Find(uint32_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  // False when both were in one set already.
  bool Unite(uint32_t a, uint32_t b) {
    a = Find(a), b = Find(b);
    if (a == b) return false;
    parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  std::vector<uint32_t> parent_;
};

// Every member is either like or unlike its set's representative: faces that are to be flipped, or not, to agree.
class ParityUnionFind {
 public:
  explicit ParityUnionFind(size_t size) : parent_(size), unlike_parent_(size, false) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  // Representative, and whether x is unlike it.
  std::pair<uint32_t, bool> Find(uint32_t x) {
    while (parent_[x] != x && parent_[parent_[x]] != parent_[x]) {
      unlike_parent_[x] = unlike_parent_[x] != unlike_parent_[parent_[x]];
      parent_[x] = parent_[parent_[x]];
    }
    bool unlike = false;
    for (; parent_[x] != x; x = parent_[x]) unlike = unlike != unlike_parent_[x];
    return {x, unlike};
  }
  // States that a and b are unlike each other, or like. False when that contradicts what was stated before.
  bool Unite(uint32_t a, uint32_t b, bool unlike) {
    const auto [root_a, a_unlike] = Find(a);
    const auto [root_b, b_unlike] = Find(b);
    if (root_a == root_b) return (a_unlike != b_unlike) == unlike;
    const uint32_t top = std::min(root_a, root_b), below = std::max(root_a, root_b);
    parent_[below] = top;
    unlike_parent_[below] = (a_unlike != b_unlike) != unlike;
    return true;
  }

 private:
  std::vector<uint32_t> parent_;
  std::vector<bool> unlike_parent_;
};

}  // namespace meshfront
