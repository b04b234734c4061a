// 1. which nodes have a fixed one to lean on, by a search from these    2. one row for each of them that is not fixed: symmetric,
// positive definite, what is fixed goes to the right-hand side    3. L D Lᵀ, sparse; one solution for each of the two values
#define EIGEN_MPL2_ONLY
#include "core/guidance/blend.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>

#include "core/base/status_macros.h"

namespace meshfront {
namespace {

constexpr uint32_t kNone = 0xffffffffu;

class System {
 public:
  System(uint32_t count, absl::Span<const WeightedEdge> edges) : edges_(edges), values_(count), rows_(count, kNone) {}

  absl::StatusOr<std::vector<BlendValues>> Solve(absl::Span<const std::pair<uint32_t, BlendValues>> fixed,
                                                 const Context& context) {
    NumberRows(fixed);
    if (row_count_ == 0) return std::move(values_);
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    Assemble();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix_);
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    if (factors.info() != Eigen::Success) return absl::InternalError("the blend of edge lengths has no solution");
    const Eigen::MatrixXd solution = factors.solve(right_);
    for (uint32_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i] == kNone) continue;
      for (int k = 0; k < 2; ++k) values_[i][k] = std::clamp(solution(rows_[i], k), least_[k], most_[k]);
    }
    return std::move(values_);
  }

 private:
  void NumberRows(absl::Span<const std::pair<uint32_t, BlendValues>> fixed);
  void Assemble();

  absl::Span<const WeightedEdge> edges_;
  std::vector<BlendValues> values_;
  std::vector<uint32_t> rows_;  // of the nodes that are not fixed, and joined to one that is
  uint32_t row_count_ = 0;
  BlendValues least_{}, most_{};  // of the fixed ones
  Eigen::SparseMatrix<double> matrix_;
  Eigen::MatrixXd right_;
};

void System::NumberRows(absl::Span<const std::pair<uint32_t, BlendValues>> fixed) {
  std::vector<std::vector<uint32_t>> neighbours(values_.size());
  for (const WeightedEdge& e : edges_) neighbours[e.a].push_back(e.b), neighbours[e.b].push_back(e.a);
  std::vector<bool> reached(values_.size(), false), is_fixed(values_.size(), false);
  std::vector<uint32_t> queue;
  for (const auto& [node, value] : fixed) {
    for (int k = 0; k < 2; ++k) {
      least_[k] = queue.empty() ? value[k] : std::min(least_[k], value[k]);
      most_[k] = queue.empty() ? value[k] : std::max(most_[k], value[k]);
    }
    values_[node] = value;
    reached[node] = is_fixed[node] = true;
    queue.push_back(node);
  }
  for (size_t i = 0; i < queue.size(); ++i) {
    for (const uint32_t n : neighbours[queue[i]]) {
      if (!reached[n]) reached[n] = true, queue.push_back(n);
    }
  }
  for (uint32_t i = 0; i < rows_.size(); ++i) {
    if (reached[i] && !is_fixed[i]) rows_[i] = row_count_++;
  }
}

void System::Assemble() {
  std::vector<Eigen::Triplet<double>> entries;
  right_ = Eigen::MatrixXd::Zero(row_count_, 2);
  const auto add = [&](uint32_t row, uint32_t other, double weight) {
    if (rows_[row] == kNone) return;
    entries.emplace_back(rows_[row], rows_[row], weight);
    if (rows_[other] != kNone)
      entries.emplace_back(rows_[row], rows_[other], -weight);
    else
      for (int k = 0; k < 2; ++k) right_(rows_[row], k) += weight * values_[other][k];
  };
  for (const WeightedEdge& e : edges_) {
    add(e.a, e.b, e.weight);
    add(e.b, e.a, e.weight);
  }
  matrix_.resize(row_count_, row_count_);
  matrix_.setFromTriplets(entries.begin(), entries.end());
}

}  // namespace

absl::StatusOr<std::vector<BlendValues>> SolveBlend(uint32_t count, absl::Span<const WeightedEdge> edges,
                                                    absl::Span<const std::pair<uint32_t, BlendValues>> fixed,
                                                    const Context& context) {
  return System(count, edges).Solve(fixed, context);
}

}  // namespace meshfront
