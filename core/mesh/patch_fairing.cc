// The bend at a vertex is Σ (x_j − x) / length over its neighbours, by the lengths that are wanted. Rejected: by those that edges have; short
// ones pull, and become shorter. At the rim the surface behind is one more neighbour, with a weight that balances those in the patch, so
// that a flat surface has no bend there; it depends on directions alone, which the step before tells. Of bends at the rim what is
// along it stays what it was: at a notch neighbours lie to one side, and would be pulled into it.
#define EIGEN_MPL2_ONLY
#include "core/mesh/patch_fairing.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <vector>

namespace meshfront {
namespace {

constexpr int kSteps = 3;
// The weight of the surface behind the rim is at least this part of one neighbour's.
constexpr double kLeastBehind = 0.2;

class Fairing {
 public:
  Fairing(absl::Span<const HoleRimVertex> rim, absl::Span<const double> lengths, PatchShape shape, TriangleMesh& patch)
      : rim_(rim), lengths_(lengths), patch_(patch), first_row_(shape == PatchShape::kFair ? 0 : rim.size()) {
    std::vector<std::array<uint32_t, 2>> edges;
    for (const Triangle& t : patch.triangles) {
      for (int i = 0; i < 3; ++i) {
        edges.push_back({t[i].index(), t[(i + 1) % 3].index()});
        edges.push_back({t[(i + 1) % 3].index(), t[i].index()});
      }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    edges_ = std::move(edges);
  }

  bool Run() {
    const std::vector<Vec3> before = patch_.positions;
    for (int step = 0; step < kSteps; ++step) {
      if (Step()) continue;
      patch_.positions = before;
      return false;
    }
    return true;
  }

 private:
  using Matrix = Eigen::SparseMatrix<double>;

  bool Step();
  // Adds `weight` times a place to a row: to the matrix where the vertex may move, else to the right side.
  void Add(size_t row, size_t vertex, double weight) {
    if (vertex < rim_.size())
      AddFixed(row, patch_.positions[vertex], weight);
    else
      terms_.emplace_back(static_cast<int>(row - first_row_), static_cast<int>(vertex - rim_.size()), weight);
  }
  void AddFixed(size_t row, const Vec3& place, double weight) {
    for (int k = 0; k < 3; ++k) right_(static_cast<int>(row - first_row_), k) -= weight * place[k];
  }
  void AddRow(size_t vertex, size_t begin, size_t end);

  const absl::Span<const HoleRimVertex> rim_;
  const absl::Span<const double> lengths_;
  TriangleMesh& patch_;
  const size_t first_row_;
  std::vector<std::array<uint32_t, 2>> edges_;  // in both directions, ordered
  std::vector<Eigen::Triplet<double>> terms_;
  Eigen::MatrixXd right_;
};

// Edges [begin, end) are those of the vertex. What bends along the rim is no bend of the patch.
void Fairing::AddRow(size_t vertex, size_t begin, size_t end) {
  const Vec3& x = patch_.positions[vertex];
  std::vector<uint32_t> others;
  for (size_t e = begin; e < end; ++e) {
    const size_t other = edges_[e][1], n = rim_.size();
    const bool is_along = vertex < n && other < n && ((vertex + 1) % n == other || (other + 1) % n == vertex);
    if (!is_along) others.push_back(edges_[e][1]);
  }
  double sum = 0;
  Vec3 bend;
  const double scale = 2.0 / static_cast<double>(end - begin);
  if (vertex < rim_.size()) {
    const Vec3& behind = rim_[vertex].behind;
    const Vec3 back = Normalized(behind - x);
    double pull = 0;
    for (const uint32_t other : others) pull -= Dot(Normalized(patch_.positions[other] - x), back);
    sum = scale * std::max(pull, kLeastBehind) / std::max(Distance(behind, x), kLeastBehind * lengths_[vertex]);
    AddFixed(vertex, behind, sum);
    bend = sum * (behind - x);
  }
  for (const uint32_t other : others) {
    const double own = scale * 2 / (lengths_[vertex] + lengths_[other]);
    Add(vertex, other, own);
    sum += own;
    bend += own * (patch_.positions[other] - x);
  }
  Add(vertex, vertex, -sum);
  if (vertex >= rim_.size()) return;
  const Vec3 along = Normalized(Cross(rim_[vertex].behind - x, rim_[vertex].normal));
  AddFixed(vertex, Dot(bend, along) * along, -1);
}

bool Fairing::Step() {
  const size_t count = patch_.positions.size();
  terms_.clear();
  right_ = Eigen::MatrixXd::Zero(static_cast<int>(count - first_row_), 3);
  for (size_t begin = 0, end; begin < edges_.size(); begin = end) {
    const uint32_t vertex = edges_[begin][0];
    for (end = begin + 1; end < edges_.size() && edges_[end][0] == vertex;) ++end;
    if (vertex >= first_row_) AddRow(vertex, begin, end);
  }
  Matrix bends(static_cast<int>(count - first_row_), static_cast<int>(count - rim_.size()));
  bends.setFromTriplets(terms_.begin(), terms_.end());
  const Matrix normal = Matrix(bends.transpose()) * bends;
  const Eigen::SimplicialLDLT<Matrix> factors(normal);
  if (factors.info() != Eigen::Success) return false;
  const Eigen::MatrixXd places = factors.solve(bends.transpose() * right_);
  if (!places.allFinite()) return false;
  for (size_t v = rim_.size(); v < count; ++v) {
    const auto row = static_cast<int>(v - rim_.size());
    patch_.positions[v] = {places(row, 0), places(row, 1), places(row, 2)};
  }
  return true;
}

}  // namespace

bool FairPatch(absl::Span<const HoleRimVertex> rim, absl::Span<const double> lengths, PatchShape shape,
               TriangleMesh& patch) {
  if (patch.positions.size() == rim.size()) return true;
  return Fairing(rim, lengths, shape, patch).Run();
}

}  // namespace meshfront
