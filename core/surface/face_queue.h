// Breadth-first search over connected faces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/surface/mesh_walk.h"

namespace meshfront {

// A set of faces. Scratch like FaceQueue.
class FaceMarks {
 public:
  void Clear() {
    count_ = 0;
    if (slots_.empty()) slots_.resize(256);
    if (++generation_ == 0) {  // after 2^32 searches
      std::fill(slots_.begin(), slots_.end(), 0);
      generation_ = 1;
    }
  }
  // False where it is marked already.
  bool Mark(uint32_t face) {
    const uint64_t key = KeyOf(face);
    const size_t mask = slots_.size() - 1;
    for (size_t i = PlaceOf(face) & mask;; i = (i + 1) & mask) {
      if (slots_[i] == key) return false;
      if (slots_[i] >> 32 == generation_) continue;  // another face's
      slots_[i] = key;
      if (2 * ++count_ > slots_.size()) Grow();
      return true;
    }
  }
  bool IsMarked(uint32_t face) const {
    const uint64_t key = KeyOf(face);
    const size_t mask = slots_.size() - 1;
    for (size_t i = PlaceOf(face) & mask; slots_[i] >> 32 == generation_; i = (i + 1) & mask) {
      if (slots_[i] == key) return true;
    }
    return false;
  }

 private:
  static uint32_t PlaceOf(uint32_t face) { return face * 0x9e3779b1u; }
  uint64_t KeyOf(uint32_t face) const { return uint64_t{generation_} << 32 | face; }
  void Grow() {
    const std::vector<uint64_t> before = std::exchange(slots_, std::vector<uint64_t>(2 * slots_.size()));
    count_ = 0;
    for (const uint64_t slot : before) {
      if (slot >> 32 == generation_) Mark(static_cast<uint32_t>(slot));
    }
  }

  std::vector<uint64_t> slots_;  // generation, face
  size_t count_ = 0;
  uint32_t generation_ = 0;
};

// Faces in the order they were reached, each once, with the way to them: from side to side, each time to the closest point of
// the next. Scratch to be kept for each thread and emptied by Clear; memory stays at the largest search.
class FaceQueue {
 public:
  struct Entry {
    uint32_t face;
    double way;    // length of the way here
    Vec3 entered;  // where it came in
  };

  void Clear() {
    entries_.clear();
    marks_.Clear();
  }
  void Add(const Entry& entry) {
    if (marks_.Mark(entry.face)) entries_.push_back(entry);
  }
  // Adds the faces across the sides of `at` that `accept` admits and that are not farther than `longest_way`.
  template <class Accept>
  void AddAcross(const FaceView& mesh, const Entry& at, double longest_way, Accept&& accept) {
    for (int side = 0; side < 3; ++side) {
      const uint32_t across = mesh.opposite[3 * at.face + side];
      if (across == kNoHalfEdge || marks_.IsMarked(across / 3)) continue;
      const Vec3 passed = ClosestOnSide(mesh, at.face, side, at.entered);
      const double way = at.way + Distance(at.entered, passed);
      if (way <= longest_way && accept(across / 3)) Add({across / 3, way, passed});
    }
  }
  size_t size() const { return entries_.size(); }
  Entry operator[](size_t i) const { return entries_[i]; }

 private:
  static Vec3 ClosestOnSide(const FaceView& mesh, uint32_t face, int side, const Vec3& p) {
    const Vec3 &a = mesh.Corner(face, side), &b = mesh.Corner(face, side == 2 ? 0 : side + 1);
    const double length2 = SquaredDistance(a, b);
    return length2 > 0 ? Lerp(a, b, std::clamp(Dot(p - a, b - a) / length2, 0.0, 1.0)) : a;
  }

  FaceMarks marks_;
  std::vector<Entry> entries_;
};

}  // namespace meshfront
