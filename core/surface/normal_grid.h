// Which way the faces near a place look, coarsely: rules out most searches for another sheet.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "core/surface/mesh_walk.h"

namespace meshfront {

// A grid of cells, each with a box around the unit normals of the faces whose own boxes meet it. At most twice as many cells as
// faces, 9 bytes each, and 16 bytes a vertex; built in O(faces), 0.05 µs a face. Const calls are safe from many threads.
class NormalGrid {
 public:
  // `cell_size` is what is wished for; cells are larger where that would make too many, or faces too large against them. The mesh
  // must outlive the grid.
  NormalGrid(const FaceView& mesh, size_t vertex_count, const Box3& bounds, double cell_size);

  // Whether the segment may meet a face whose normal makes a cosine below kOpposed with the unit vector `normal`; never false
  // where it does.
  bool MayMeetOpposed(const Vec3& from, const Vec3& to, const Vec3& normal) const;

  // Marks the cells that made MayMeetOpposed say so.
  void MarkOpposed(const Vec3& from, const Vec3& to, const Vec3& normal);
  // The faces that may meet a marked cell, in their order.
  std::vector<uint32_t> FacesInMarked() const;

 private:
  // The least of each component, then the least of each component's negative, in 127ths.
  typedef int8_t Normals __attribute__((vector_size(8)));
  class Opposition;
  struct Range {
    std::array<int, 3> first, last;  // cells along each axis, both included
  };

  // A cell along each axis, then the negatives of these, so that the least of several has the range's first and last.
  typedef int16_t Corner __attribute__((vector_size(16)));

  Range RangeOf(const Vec3& min, const Vec3& max) const;
  Range RangeOfFace(uint32_t f) const;
  void PlaceCorners();
  Normals NormalsOf(uint32_t f) const;
  void Resize(double cell_size);
  bool Fill(uint64_t most_refs);
  // Calls visit(cell index) until it returns true; whether it did.
  template <class Visit>
  static bool VisitCells(const Range& range, const std::array<uint32_t, 3>& counts, Visit&& visit);
  template <class Visit>
  bool VisitSegment(const Vec3& from, const Vec3& to, Visit&& visit) const;

  FaceView mesh_;
  size_t vertex_count_;
  Box3 bounds_;
  double cell_size_ = 0, per_length_ = 0;
  std::array<uint32_t, 3> counts_{};
  std::vector<Corner> corners_;  // of the vertices
  std::vector<Normals> cells_;
  std::vector<uint8_t> marked_;
};

}  // namespace meshfront
