// The smooth pieces of a point set around a place: which samples lie on which side of a sharp edge (sec. 3.3).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/point_tree.h"
#include "core/mesh/side_fit.h"

namespace meshfront {

// Samples near a place that hang together without a sharp turn, and their fit there.
struct PointSide {
  std::vector<uint32_t> members;  // ascending
  SideFit fit;
  double distance = 0;  // of the place from the fit, and from its samples where it lies beyond them
};

// Immutable; safe to read from many threads; deterministic. Samples are linked to their nearest neighbours whose normals turn by less
// than the angle; a side is what hangs together inside of a ball. So a crease may end inside a smooth piece: around its end both
// sides are one. An *edge sample* has two sides around it whose fits turn by more than the angle and explain the samples much better
// than one fit of both: noise does not.
class PointPieces {
 public:
  // As many unit normals as positions, which outlive the pieces as the normals do; `angle` in radians. With `are_estimated` normals are
  // those of planes through neighbours, which are blurred at edges: there each is replaced by that of the flattest of the planes around
  // that explain the sample. 5 µs a point, 20 where normals are estimated.
  static absl::StatusOr<std::unique_ptr<PointPieces>> Create(absl::Span<const Vec3> positions,
                                                             absl::Span<const Vec3> normals, double angle,
                                                             bool are_estimated, const Context& context);

  bool HasEdges() const { return has_edges_; }
  // The distance between samples near x, and whether an edge sample lies so near that it matters.
  double SpacingAt(const Vec3& x) const;
  double median_spacing() const { return median_spacing_; }
  double mean_area() const { return mean_area_; }
  bool IsNearEdge(const Vec3& x) const;
  // In the order of their first members; none of fewer than 6 samples.
  std::vector<PointSide> SidesAt(const Vec3& x) const;
  // Whether the fits turn by more than the angle at x.
  bool TurnAt(const Vec3& x, const SideFit& a, const SideFit& b) const;
  const Vec3& position(uint32_t sample) const { return positions_[sample]; }

 private:
  PointPieces(absl::Span<const Vec3> positions, absl::Span<const Vec3> normals, double angle);
  absl::Status LinkNeighbours(const Context& context);
  absl::Status SharpenNormals(const Context& context);
  absl::Status FindEdgeSamples(const Context& context);
  void MeasureNoise();
  void DropShortEdges();
  void RefitWithoutOutliers(const Vec3& x, PointSide& side) const;
  double EdgeClarity(uint32_t sample) const;
  bool HasSharpLink(uint32_t sample) const;
  bool IsSmoothLink(uint32_t a, uint32_t b) const;

  absl::Span<const Vec3> positions_;
  std::vector<Vec3> normals_;
  double cosine_ = 0, median_spacing_ = 0, mean_area_ = 0, noise_ = 0;
  PointTree tree_;
  std::vector<uint32_t> neighbours_;
  size_t each_ = 0;
  std::vector<double> spacing_;
  std::vector<double> clarity_;  // of edge samples, before the short edges go; else 0
  std::vector<uint8_t> is_edge_;
  bool has_edges_ = false, are_estimated_ = false;
};

}  // namespace meshfront
