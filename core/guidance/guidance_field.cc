// Create: 1. CheckOptions and CheckSamples; 2. PruneDominated (core/guidance/pruning.h); 3. a ConeTree over what is kept.
// At: the tree's minimum below the clamp.
#include "core/guidance/guidance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/guidance/cone_tree.h"
#include "core/guidance/pruning.h"
#include "core/guidance/tolerances.h"

namespace meshfront {
namespace {

constexpr int kLeafSize = 16;  // 8 is 30 % slower, 32 equal on a scanned model's field

absl::Status CheckOptions(const GuidanceOptions& options) {
  if (!(options.eta > 1 && options.eta < 2)) {
    return absl::InvalidArgumentError(absl::StrCat("guidance.eta is ", options.eta, "; it must be in (1, 2)"));
  }
  if (!(options.min_length >= 0 && std::isfinite(options.min_length))) {
    return absl::InvalidArgumentError(
        absl::StrCat("guidance.min_length is ", options.min_length, "; it must be finite and not negative"));
  }
  if (!(options.max_length > 0 && options.max_length >= options.min_length && std::isfinite(options.max_length))) {
    return absl::InvalidArgumentError(absl::StrCat("guidance.max_length is ", options.max_length,
                                                   "; it must be positive, finite and at least min_length (",
                                                   options.min_length, ")"));
  }
  return absl::OkStatus();
}

absl::Status CheckSamples(absl::Span<const SizingSample> samples) {
  for (size_t i = 0; i < samples.size(); ++i) {
    if (!(samples[i].ideal_length > 0)) {
      return absl::InvalidArgumentError(
          absl::StrCat("sizing sample ", i, " has ideal length ", samples[i].ideal_length, "; it must be positive"));
    }
    if (!IsFinite(samples[i].position)) {
      return absl::InvalidArgumentError(absl::StrCat("sizing sample ", i, " has a position that is not finite"));
    }
  }
  return absl::OkStatus();
}

constexpr double kRadiusSlack = 1 + 1e-9;  // of a patch: for rounding in the places

std::vector<Cone> ConesOf(absl::Span<const SizingSample> samples, double eta) {
  std::vector<Cone> cones(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) cones[i] = {samples[i].position, samples[i].ideal_length / eta};
  return cones;
}

}  // namespace

struct GuidanceField::Index {
  Index(std::vector<SizingSample> kept, const GuidanceOptions& guidance_options)
      : options(guidance_options),
        samples(std::move(kept)),
        tree(ConesOf(samples, options.eta), 1 - 1 / options.eta, kLeafSize) {}

  Index(const GuidanceOptions& guidance_options, std::vector<SizingSample> changed, ConeTree changed_tree)
      : options(guidance_options), samples(std::move(changed)), tree(std::move(changed_tree)) {}

  GuidanceOptions options;
  std::vector<SizingSample> samples;
  ConeTree tree;
};

absl::StatusOr<GuidanceField> GuidanceField::Create(std::vector<SizingSample> samples, const GuidanceOptions& options,
                                                    const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(CheckOptions(options));
  MESHFRONT_RETURN_IF_ERROR(CheckSamples(samples));
  MESHFRONT_ASSIGN_OR_RETURN(std::vector<SizingSample> kept,
                             PruneDominated(std::move(samples), options.eta, options.max_length, context));
  return GuidanceField(std::make_unique<Index>(std::move(kept), options));
}

GuidanceField::GuidanceField(std::unique_ptr<Index> index) : index_(std::move(index)) {}
GuidanceField::GuidanceField(GuidanceField&&) = default;
GuidanceField& GuidanceField::operator=(GuidanceField&&) = default;
GuidanceField::~GuidanceField() = default;

double GuidanceField::At(const Vec3& x) const { return At(x, index_->options.max_length); }

double GuidanceField::At(const Vec3& x, double upper_bound) const {
  const GuidanceOptions& options = index_->options;
  const double lowest = index_->tree.MinAt(x, std::min(options.max_length, upper_bound) * kPruneGrow);
  return std::max(options.min_length, std::min(options.max_length, lowest));
}

GuidanceField GuidanceField::WithLengths(absl::Span<const double> ideal_lengths, double max_length) const {
  GuidanceOptions options = index_->options;
  options.max_length = max_length;
  std::vector<SizingSample> samples = index_->samples;
  std::vector<double> apexes(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) {
    samples[i].ideal_length = ideal_lengths[i];
    apexes[i] = ideal_lengths[i] / options.eta;
  }
  return GuidanceField(std::make_unique<Index>(options, std::move(samples), index_->tree.WithApexes(apexes)));
}

void FieldPatch::Cover(const Vec3& center, double radius, double upper_bound) {
  const GuidanceOptions& options = field_.options();
  // A place of the ball has at most that much more than the centre.
  const double reach = kRadiusSlack * radius, slope = 1 - 1 / options.eta;
  const double limit = std::min(options.max_length + slope * reach, upper_bound + 2 * slope * reach) * kPruneGrow;
  is_whole_ = field_.index_->tree.Gather(center, reach, limit, patch_);
}

double FieldPatch::At(const Vec3& x) const {
  if (!is_whole_) return field_.At(x);
  const GuidanceOptions& options = field_.options();
  return std::max(options.min_length, std::min(options.max_length, field_.index_->tree.MinOf(patch_, x)));
}

double GuidanceField::eta() const { return index_->options.eta; }
const GuidanceOptions& GuidanceField::options() const { return index_->options; }
absl::Span<const SizingSample> GuidanceField::kept_samples() const { return index_->samples; }

}  // namespace meshfront
