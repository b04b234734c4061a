// The guidance field g (sec. 3.1): position -> edge length, Lipschitz with constant 1 − 1/η by construction.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/guidance/cone_tree.h"
#include "core/guidance/sizing.h"

namespace meshfront {

struct GuidanceOptions {
  double eta = 1.2;       // bound on the ratio of incident edges, in (1, 2)
  double min_length = 0;  // clamp of g from below, ≥ 0
  double max_length = 0;  // clamp of g from above, > 0, ≥ min_length, finite
};

// g(x) = clamp(min over the samples of ĝ(|x − s|)). Immutable; thread-safe. Exact: equal to the brute-force minimum over the
// kept samples in every bit, and within 4 ulp of the one over all samples.
class GuidanceField {
 public:
  // Prunes dominated samples (a sample whose cone lies above another's everywhere) and indexes the rest. InvalidArgument when
  // there is no clamp (max_length not finite), eta is out of range, or a sample has a length that is not positive or a place
  // that is not finite. No samples: g ≡ max_length. O(n log n); stops when the context says so.
  static absl::StatusOr<GuidanceField> Create(std::vector<SizingSample> samples, const GuidanceOptions& options,
                                              const Context& context);
  GuidanceField(GuidanceField&&);
  GuidanceField& operator=(GuidanceField&&);
  ~GuidanceField();

  double At(const Vec3& x) const;  // 0.1–0.4 µs, no allocation
  // The same value, sooner: `upper_bound` must be at least g(x) but for rounding, such as g(y) + (1 − 1/η) |x − y|. It only
  // prunes and is never returned.
  double At(const Vec3& x, double upper_bound) const;
  // The field of the kept samples with other ideal lengths, > 0, one for each in their order, and another clamp from above, > 0. They
  // are not pruned again, which changes no value by more than 4 ulp. O(kept samples).
  GuidanceField WithLengths(absl::Span<const double> ideal_lengths, double max_length) const;
  double eta() const;
  const GuidanceOptions& options() const;
  absl::Span<const SizingSample> kept_samples() const;  // by increasing ideal length

 private:
  friend class FieldPatch;
  struct Index;
  explicit GuidanceField(std::unique_ptr<Index> index);
  std::unique_ptr<Index> index_;
};

// Asks a field at many places close to each other: what may decide inside a ball is looked up once.
//   FieldPatch patch(field);
//   patch.Cover(center, radius, bound);
//   for (const Vec3& x : places) g = patch.At(x);
// Not thread-safe; about 1 kB, without allocation. The field outlives it.
class FieldPatch {
 public:
  explicit FieldPatch(const GuidanceField& field) : field_(field) {}
  // From now on places are in this ball, up to rounding. Worth it from three places on, and where the radius is about g or less.
  // `upper_bound`: as in GuidanceField::At, of the centre. About two evaluations of g.
  void Cover(const Vec3& center, double radius, double upper_bound);
  // g(x), in every bit that of the field.
  double At(const Vec3& x) const;

 private:
  const GuidanceField& field_;
  ConePatch patch_;
  bool is_whole_ = false;
};

}  // namespace meshfront
