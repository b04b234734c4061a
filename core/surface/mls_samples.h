// The samples of a point set as a moving-least-squares surface needs them: with normals, supports from the local
// spacing, and lists of those that have a say at a place.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/box.h"
#include "core/geometry/point_tree.h"
#include "core/geometry/vec3.h"
#include "core/mesh/union_find.h"
#include "core/surface/tolerances.h"

namespace meshfront {

struct MlsSample {
  Vec3 position, normal;  // unit length
  double support = 0;     // so far it matters, and the radius of its weight where the surface is flat; 0: it has none
  // 1 / square of the radius of its weight, which is less than the support where the surface bends sharply between samples.
  double inverse_squared_radius = 0;

  // 0 where its weight is as wide as its support, 1 where it is as narrow as any.
  double Sharpness() const;
};
static_assert(sizeof(MlsSample) == 64);  // one cache line

// How wide the weights are: as the supports everywhere, or narrower where the surface bends sharply between samples, which rounds it less.
inline double MlsSample::Sharpness() const {
  constexpr double kNarrowest = 1 / (surface_tolerances::kNarrowestRadius * surface_tolerances::kNarrowestRadius);
  const double sharpness = (support * support * inverse_squared_radius - 1) / (kNarrowest - 1);
  return sharpness > surface_tolerances::kLeastSharpness ? sharpness : 0;
}

enum class MlsWeights { kWide, kNarrowAtEdges };

// Immutable; safe to read from many threads; deterministic at any thread count. Samples are in an order of their own,
// near ones next to each other. They form *patches* of up to 8 near ones whose normals agree, each with the list of
// samples whose supports reach its box or what lies within a margin around it, but for the other side of a thin sheet:
// those whose normals point the other way and that no short way around an edge leads to. So no search is needed as long
// as a place stays within the margin. About 200 bytes a point.
class MlsSamples {
 public:
  // As many positions as normals of unit length, no two positions the same; `radius` in local spacings, > 0, which are
  // measured among so many neighbours: more than 12 where the points lie in a cloud around the surface.
  // InvalidArgument: fewer than 4 points, a place or normal that is not finite. 2 µs a point and core.
  static absl::StatusOr<std::unique_ptr<MlsSamples>> Create(absl::Span<const Vec3> positions,
                                                            absl::Span<const Vec3> normals, double radius,
                                                            const Context& context, size_t neighbours = 12,
                                                            MlsWeights weights = MlsWeights::kWide);
  // The same samples with supports that are wider: by `factor` at the places and less within some supports of them, or
  // everywhere where there are no places; but never wider than `most` spacings.
  absl::StatusOr<std::unique_ptr<MlsSamples>> Widened(absl::Span<const Vec3> places, double factor, double most,
                                                      const Context& context) const;

  // The same samples with weights as wide as the supports around the places, within as far as Widened, or everywhere where there are
  // no places: the surface rounds sharp edges there as weights kWide do. Null where no weight is narrower.
  absl::StatusOr<std::unique_ptr<MlsSamples>> Rounded(absl::Span<const Vec3> places, const Context& context) const;

  // The same samples and more of them, whose supports are as wide as those of the nearest one.
  absl::StatusOr<std::unique_ptr<MlsSamples>> With(absl::Span<const Vec3> positions, absl::Span<const Vec3> normals,
                                                   const Context& context) const;

  absl::Span<const MlsSample> samples() const { return samples_; }
  // The part of the surface's area that each stands for, and the distance between samples where they are as dense as
  // there.
  absl::Span<const double> areas() const { return areas_; }
  double SpacingAt(uint32_t sample) const {
    return samples_[sample].support / (measures_.radius * widths_.supports[sample]);
  }
  double radius() const { return measures_.radius; }
  const Box3& box() const { return tree_->nodes()[0].box; }
  const PointTree& tree() const { return *tree_; }

  uint32_t patch_count() const { return static_cast<uint32_t>(patches_.size()); }
  uint32_t PatchOf(uint32_t sample) const { return patch_of_[sample]; }
  absl::Span<const uint32_t> MembersOf(
      uint32_t patch) const;  // the first is the one whose normal the others agree with
  absl::Span<const uint32_t> ListOf(uint32_t patch) const;
  // Samples that have a say at a place, on average.
  double MeanListLength() const { return static_cast<double>(lists_.size()) / static_cast<double>(patches_.size()); }
  // The patch to ask at x: `patch` where x is within its margin, else that of the nearest sample whose normal agrees
  // with `normal`, or `patch` again where that is much farther away.
  uint32_t PatchNear(const Vec3& x, const Vec3& normal, uint32_t patch) const;
  // The nearest sample closer than `limit` whose normal agrees with `normal`; PointTree::kNone when none does.
  uint32_t NearestLike(const Vec3& x, const Vec3& normal, double limit = std::numeric_limits<double>::infinity()) const;

  // Connected parts: samples are joined to their neighbours within their supports whose normals do not point the other
  // way. Numbered by their first samples. Samples of parts too small for a surface are strays: their support is 0,
  // their component kStray, and nobody's list has them.
  static constexpr uint32_t kStray = 0xffffffffu;
  uint32_t stray_count() const { return stray_count_; }
  uint32_t component_count() const { return component_count_; }
  uint32_t ComponentOf(uint32_t sample) const { return components_[sample]; }

 private:
  struct Patch {
    Box3 box;
    Vec3 normal;
    double margin = 0;
    uint32_t first_member = 0, member_count = 0;
    uint64_t first_listed = 0;
    uint32_t listed_count = 0;
  };
  // Of each sample: the width of its support in parts of the radius, 1 where nothing was widened, and how far its weight may not be
  // narrower, 0 to 1.
  struct Widths {
    std::vector<double> supports, roundness;
  };
  struct Measures {
    double radius = 0;
    size_t neighbours = 0;
    MlsWeights weights = MlsWeights::kWide;
  };
  MlsSamples() = default;
  static absl::StatusOr<std::unique_ptr<MlsSamples>> Make(absl::Span<const Vec3> positions,
                                                          absl::Span<const Vec3> normals, const Widths& widths,
                                                          const Measures& measures, const Context& context);
  std::vector<Vec3> Normals() const;
  std::vector<double> SharesAround(absl::Span<const Vec3> places) const;
  absl::Status MeasureSpacing(const Context& context);
  void SetRadii();
  void NumberComponents(UnionFind& sets);
  void MakePatches();
  void FindNear(const Patch& patch, const std::vector<double>& reach, std::vector<uint32_t>& near) const;
  void KeepOwnSide(const Patch& patch, const std::vector<uint32_t>& near, std::vector<uint32_t>& list) const;
  absl::Status ListPatches(const Context& context);

  Measures measures_;
  std::vector<MlsSample> samples_;
  Widths widths_;
  std::vector<Vec3> positions_;  // the same, as the tree wants them
  std::vector<double> areas_;
  std::unique_ptr<PointTree> tree_;
  std::vector<Patch> patches_;
  std::vector<uint32_t> patch_of_, members_, lists_, components_;
  std::vector<uint32_t> neighbours_;  // of each sample, while it is made
  size_t neighbours_each_ = 0;
  uint32_t component_count_ = 0, stray_count_ = 0;
};

}  // namespace meshfront
