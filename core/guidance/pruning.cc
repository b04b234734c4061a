//   1. SweepInOrder drops what one of the last few survivors dominates, in the order given: meshes list neighbours near each
//      other, so most samples go here at the cost of a few distances. It asks for a margin, so that dominance is certain in
//      exact arithmetic; being transitive, it leads in the end to a sample that is kept, and nothing is lost.
//   2. SortByLength.
//   3. KeepUndominated visits the rest by increasing length and keeps a sample when the field of those kept does not lie below
//      it. All survivors are in one static tree in which only the kept ones have a height.
// Rejected: a scan of the kept ones per sample (grows with the kept count), and a tree of all samples that are marked from
// each kept one (visits every dominated sample once per sample that dominates it).
#include "core/guidance/pruning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/status_macros.h"
#include "core/guidance/cone_tree.h"
#include "core/guidance/tolerances.h"

namespace meshfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr size_t kStopInterval = 4096;  // samples between two looks at the context: below a millisecond
constexpr size_t kRecent = 4;           // survivors that the sweep compares with
constexpr int kLeafSize = 8;

class Pruner {
 public:
  Pruner(std::vector<SizingSample>& samples, double eta, double max_length)
      : samples_(samples), eta_(eta), slope_(1 - 1 / eta), max_length_(max_length) {}

  void DropAboveClamp() {
    std::erase_if(samples_, [&](const SizingSample& s) { return !(s.ideal_length / eta_ < max_length_); });
  }

  void SweepInOrder() {
    size_t kept = 0;
    for (size_t i = 0; i < samples_.size(); ++i) {
      const SizingSample sample = samples_[i];
      const size_t window = std::min(kept, kRecent);
      const double apex = sample.ideal_length / eta_ * kPruneShrink;
      bool dominated = false;
      for (size_t k = kept - window; k < kept && !dominated; ++k) {
        dominated =
            GradedLength(Distance(sample.position, samples_[k].position), samples_[k].ideal_length, eta_) < apex;
      }
      if (!dominated) samples_[kept++] = sample;
    }
    samples_.resize(kept);
  }

  void SortByLength() {
    std::stable_sort(samples_.begin(), samples_.end(),
                     [](const SizingSample& a, const SizingSample& b) { return a.ideal_length < b.ideal_length; });
  }

  absl::Status KeepUndominated(const Context& context) {
    std::vector<Cone> cones(samples_.size());
    for (size_t i = 0; i < samples_.size(); ++i) cones[i] = {samples_[i].position, kInfinity};
    ConeTree tree(std::move(cones), slope_, kLeafSize);
    size_t kept = 0;
    for (uint32_t i = 0; i < samples_.size(); ++i) {
      if (i % kStopInterval == 0) MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
      const double apex = samples_[i].ideal_length / eta_;
      if (tree.AnyAtMost(i, apex)) continue;
      tree.Activate(i, apex);
      samples_[kept++] = samples_[i];
    }
    samples_.resize(kept);
    return absl::OkStatus();
  }

 private:
  std::vector<SizingSample>& samples_;
  double eta_, slope_, max_length_;
};

}  // namespace

absl::StatusOr<std::vector<SizingSample>> PruneDominated(std::vector<SizingSample> samples, double eta,
                                                         double max_length, const Context& context) {
  Pruner pruner(samples, eta, max_length);
  pruner.DropAboveClamp();
  pruner.SweepInOrder();
  std::reverse(samples.begin(), samples.end());
  pruner.SweepInOrder();
  std::reverse(samples.begin(), samples.end());
  MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
  pruner.SortByLength();
  MESHFRONT_RETURN_IF_ERROR(pruner.KeepUndominated(context));
  samples.shrink_to_fit();
  return samples;
}

}  // namespace meshfront
