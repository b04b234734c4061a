#include "core/front/loop_closing.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr int kMaxLoopToTriangulate = 64;  // edges; the triangulation is cubic
constexpr double kDihedralPenalty = 4.0;   // weight of a fold, against one mean squared edge
// A triangle with corners on one line weighs nothing by its area, and is none: heavier than all folds where there is another closure.
constexpr double kFlatPenalty = 1000.0, kFlatRatio = 1e-4;

class LoopCloser {
 public:
  LoopCloser(const FrontSet& fronts, const Proposer& proposer, const std::vector<FrontEdgeId>& loop,
             const Strictness& strictness)
      : fronts_(fronts), proposer_(proposer), loop_(loop), strictness_(strictness) {
    for (const FrontEdgeId e : loop) {
      vertices_.push_back(fronts.From(e));
      const Vec3 &from = fronts.at(vertices_.back()).position, &to = fronts.at(fronts.To(e)).position;
      mean_square_ += SquaredDistance(from, to) / static_cast<double>(loop.size());
    }
  }

  std::optional<std::vector<ClosureStep>> Run() const {
    if (size() > kMaxLoopToTriangulate || IsPinched() || !proposer_.SurroundsOpenSide(loop_[0])) return std::nullopt;
    auto steps = TriangulateLoop(size(), [this](int first, int apex, int last) { return WeightOf(first, apex, last); });
    if (steps && LiesBackToBack()) return std::nullopt;
    return steps;
  }

 private:
  int size() const { return static_cast<int>(loop_.size()); }
  bool IsPinched() const {
    std::vector<WindowVertexId> sorted = vertices_;
    std::sort(sorted.begin(), sorted.end());
    return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
  }
  // Whether the one triangle of a loop of three has the same corners as one behind it.
  bool LiesBackToBack() const {
    return size() == 3 && std::any_of(loop_.begin(), loop_.end(), [this](FrontEdgeId e) {
             const Link owner = fronts_.at(e).owner;
             if (!owner.is_half_edge()) return false;
             const WindowVertexId opposite = fronts_.at(owner.triangle()).corners[(owner.side() + 2) % 3];
             return std::find(vertices_.begin(), vertices_.end(), opposite) != vertices_.end();
           });
  }
  bool MakesNoEdgeTwice(int first, int apex, int last) const;
  double WeightOf(int first, int apex, int last) const;

  const FrontSet& fronts_;
  const Proposer& proposer_;
  const std::vector<FrontEdgeId>& loop_;
  const Strictness& strictness_;
  std::vector<WindowVertexId> vertices_;
  double mean_square_ = 0;
};

bool LoopCloser::MakesNoEdgeTwice(int first, int apex, int last) const {
  for (const auto& [i, j] : {std::pair{first, apex}, std::pair{apex, last}, std::pair{first, last}}) {
    const bool on_loop = j == i + 1 || (i == 0 && j == size() - 1);
    if (!on_loop && fronts_.EdgeExists(vertices_[i], vertices_[j])) return false;
  }
  return true;
}

double LoopCloser::WeightOf(int first, int apex, int last) const {
  if (!MakesNoEdgeTwice(first, apex, last)) return -1;
  // Loop edges run from position i to i + 1 with the open side on the right: the triangle is (last, apex, first) reversed.
  const WindowVertex &p = fronts_.at(vertices_[first]), &q = fronts_.at(vertices_[apex]),
                     &r = fronts_.at(vertices_[last]);
  const Vec3 area = AreaVector(r.position, q.position, p.position);
  const Vec3 normal = Normalized(area);
  const double agreement =
      std::min({Dot(normal, p.source.normal), Dot(normal, q.source.normal), Dot(normal, r.source.normal)});
  if (agreement < strictness_.min_normal_cosine) return -1;
  const double longest =
      std::sqrt(std::max({SquaredDistance(p.position, q.position), SquaredDistance(q.position, r.position),
                          SquaredDistance(r.position, p.position)}));
  const double tolerance = strictness_.sheet_tolerance;
  if (tolerance < 1 && !proposer_.StandsForSurface(r.source, p.source, q.source, false, false, tolerance * longest)) {
    return -1;
  }
  const bool is_flat = RadiusRatio(p.position, q.position, r.position) < kFlatRatio;
  return Norm(area) + mean_square_ * (kDihedralPenalty * (1 - agreement) + (is_flat ? kFlatPenalty : 0));
}

}  // namespace

std::optional<std::vector<ClosureStep>> ProposeClosure(const FrontSet& fronts, const Proposer& proposer,
                                                       const std::vector<FrontEdgeId>& loop,
                                                       const Strictness& strictness) {
  return LoopCloser(fronts, proposer, loop, strictness).Run();
}

}  // namespace meshfront
