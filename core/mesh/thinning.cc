// 1. a quadric for each vertex: the planes of its triangles, and planes upright on its feature edges     (AddQuadrics)
// 2. a queue of ways from a vertex to a neighbour, the cheapest first                                   (Push)
// 3. the next way, if what it makes is allowed (IsAllowed): topology, then shape, then what lies near    (Collapse)
// 4. where the queue is empty too early, again with less asked of shapes, and then with more that a way may cost
// Vertices stay where they are, unlike in Garland and Heckbert's method: they lie on the surface, and a place of least error does not.
// Rejected: a coarser field. Where it asks for edges longer than the surface allows to walk over, fronts are taken back again and again,
// and make the more triangles the fewer are wanted.
#include "core/mesh/thinning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/geometry/bvh.h"
#include "core/geometry/intersection.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

// What is asked of triangles that are made, unless it was worse before; less where the queue ends too early.
struct Shape {
  double least_ratio;  // radius ratio
  double least_fold;   // cosine between the normals of neighbours
};
constexpr Shape kShapes[] = {{0.4, -0.5}, {0.2, -0.5}, {0.05, -0.9}, {0.005, -0.99}};
// How much a way may cost, in parts of the mean squared edge: less is asked of shapes before more is lost of the surface.
constexpr double kCostLimits[] = {1e-3, 1e-2, 0.1, 1, 10, std::numeric_limits<double>::infinity()};
// A new triangle's normal against that of the one in whose place it is.
constexpr double kMinNormalCosine = 0.0;
// What a way costs for its length alone, in parts of its square; and what a bad shape multiplies that by at most.
constexpr double kCostPerLength = 2e-3;
constexpr double kLeastRatioInCost = 0.02;
// The weight of planes upright on feature edges against those of the triangles there.
constexpr double kFeatureWeight = 4;
// Triangles that changed since the tree was built are looked at one by one; beyond so many, and a part of all, it is built again.
constexpr size_t kMostChanged = 256, kTriangleSharesChanged = 64;
constexpr uint32_t kUnnamed = 0xffffffffu;
constexpr size_t kStopInterval = 64;  // collapses between two looks at the context

// Sums of squared distances to planes, each times a weight.
struct Quadric {
  double a[10] = {};
  void Add(const Vec3& n, double d, double weight) {
    const double p[4] = {n.x, n.y, n.z, d};
    for (int i = 0, k = 0; i < 4; ++i) {
      for (int j = i; j < 4; ++j) a[k++] += weight * p[i] * p[j];
    }
  }
  void Add(const Quadric& other) {
    for (int k = 0; k < 10; ++k) a[k] += other.a[k];
  }
  double At(const Vec3& x) const {
    const double p[4] = {x.x, x.y, x.z, 1};
    double sum = 0;
    for (int i = 0, k = 0; i < 4; ++i) {
      for (int j = i; j < 4; ++j) sum += (i == j ? 1 : 2) * a[k++] * p[i] * p[j];
    }
    return std::max(sum, 0.0);
  }
};

struct Way {
  double cost;
  uint32_t from, to;
  uint64_t stamp;                           // of `from`, when it was found
  bool operator<(const Way& other) const {  // the queue's top is the greatest
    return std::tie(other.cost, other.from, other.to) < std::tie(cost, from, to);
  }
};

class Thinning {
 public:
  explicit Thinning(HeldPiece& mesh) : mesh_(mesh), alive_(mesh.triangles.size()) {
    const size_t vertices = mesh.vertices.size();
    around_.resize(vertices), quadrics_.resize(vertices), stamps_.resize(vertices);
    for (const OutputVertex& v : mesh.vertices) positions_.push_back(v.position);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      for (const VertexId v : mesh.triangles[t]) around_[v.index()].push_back(t);
    }
    is_alive_.assign(alive_, true);
    AddQuadrics();
    BuildTree();
  }

  absl::StatusOr<uint64_t> Run(uint64_t most_triangles, const Context& context) {
    const double unit = MeanSquaredEdge();
    for (const double limit : kCostLimits) {
      for (const Shape& shape : kShapes) {
        if (alive_ > most_triangles) MESHFRONT_RETURN_IF_ERROR(TakeOut(most_triangles, limit * unit, shape, context));
      }
    }
    Compact();
    return alive_;
  }

 private:
  using Corners = std::array<VertexId, 3>;
  struct Between {
    uint32_t triangles[2];
    int count = 0;
  };

  double MeanSquaredEdge() const {
    double sum = 0;
    for (const Corners& c : mesh_.triangles) {
      for (int i = 0; i < 3; ++i) sum += SquaredDistance(positions_[c[i].index()], positions_[c[(i + 1) % 3].index()]);
    }
    return sum / (3 * static_cast<double>(std::max<size_t>(mesh_.triangles.size(), 1)));
  }

  // Ways up to a cost, whose triangles have a shape.
  absl::Status TakeOut(uint64_t most_triangles, double most_cost, const Shape& shape, const Context& context) {
    shape_ = shape;
    queue_ = {};
    for (uint32_t v = 0; v < around_.size(); ++v) PushFrom(v);
    while (alive_ > most_triangles && !queue_.empty() && queue_.top().cost <= most_cost) {
      const Way way = queue_.top();
      queue_.pop();
      if (way.stamp != stamps_[way.from] || !IsAllowed(way.from, way.to)) continue;
      Collapse(way.from, way.to);
      if (++collapses_ % kStopInterval == 0) MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    }
    return absl::OkStatus();
  }

  Corners& CornersOf(uint32_t t) { return mesh_.triangles[t]; }
  Vec3 AreaOf(const Corners& c) const {
    return AreaVector(positions_[c[0].index()], positions_[c[1].index()], positions_[c[2].index()]);
  }
  static int CornerOf(const Corners& c, uint32_t v) {
    for (int i = 0; i < 3; ++i) {
      if (c[i].index() == v) return i;
    }
    return -1;
  }
  Between TrianglesBetween(uint32_t u, uint32_t v) const {
    Between between;
    for (const uint32_t t : around_[u]) {
      if (CornerOf(mesh_.triangles[t], v) >= 0 && between.count < 2) between.triangles[between.count++] = t;
    }
    return between;
  }

  // A rim, or an edge on whose sides a wedge differs.
  bool IsFeature(uint32_t u, uint32_t v) const {
    const Between between = TrianglesBetween(u, v);
    if (between.count < 2) return true;
    if (mesh_.corners.empty()) return false;
    const uint32_t s = between.triangles[0], t = between.triangles[1];
    for (const uint32_t end : {u, v}) {
      if (mesh_.corners[s][CornerOf(mesh_.triangles[s], end)] != mesh_.corners[t][CornerOf(mesh_.triangles[t], end)])
        return true;
    }
    return false;
  }

  std::vector<uint32_t> NeighboursOf(uint32_t v) const {
    std::vector<uint32_t> found;
    for (const uint32_t t : around_[v]) {
      for (const VertexId w : mesh_.triangles[t]) {
        if (w.index() != v) found.push_back(w.index());
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  bool IsRim(uint32_t v) const {
    for (const uint32_t w : NeighboursOf(v)) {
      if (TrianglesBetween(v, w).count < 2) return true;
    }
    return false;
  }

  void AddQuadrics() {
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Corners& c = mesh_.triangles[t];
      const Vec3 area = AreaOf(c), n = Normalized(area);
      const double weight = 0.5 * Norm(area);
      for (const VertexId v : c) quadrics_[v.index()].Add(n, -Dot(n, positions_[c[0].index()]), weight);
      for (int i = 0; i < 3; ++i) AddFeature(c[i].index(), c[(i + 1) % 3].index(), n);
    }
  }

  // Upright on the triangle, through its side.
  void AddFeature(uint32_t u, uint32_t v, const Vec3& normal) {
    if (!IsFeature(u, v)) return;
    const Vec3 along = positions_[v] - positions_[u], n = Normalized(Cross(along, normal));
    for (const uint32_t end : {u, v})
      quadrics_[end].Add(n, -Dot(n, positions_[u]), kFeatureWeight * SquaredNorm(along));
  }

  void PushFrom(uint32_t u) {
    if (around_[u].empty()) return;
    const std::vector<uint32_t> neighbours = NeighboursOf(u);
    std::vector<uint32_t> along;
    for (const uint32_t v : neighbours) {
      if (IsFeature(u, v)) along.push_back(v);
    }
    if (!along.empty() && along.size() != 2) return;
    for (const uint32_t v : along.empty() ? neighbours : along) Push(u, v);
  }

  void Push(uint32_t u, uint32_t v) {
    double area = 0, ratio = 1;
    for (const uint32_t t : around_[u]) {
      area += 0.5 * Norm(AreaOf(mesh_.triangles[t]));
      if (CornerOf(mesh_.triangles[t], v) < 0) ratio = std::min(ratio, RatioOf(Moved(t, u, v)));
    }
    if (!(area > 0)) return;
    Quadric both = quadrics_[u];
    both.Add(quadrics_[v]);
    const double way = SquaredDistance(positions_[u], positions_[v]);
    const double cost = (both.At(positions_[v]) / area + kCostPerLength * way) / std::max(ratio, kLeastRatioInCost);
    queue_.push({cost, u, v, stamps_[u]});
  }

  Corners Moved(uint32_t t, uint32_t u, uint32_t v) const {
    Corners c = mesh_.triangles[t];
    c[CornerOf(c, u)] = VertexId(v);
    return c;
  }
  double RatioOf(const Corners& c) const {
    return RadiusRatio(positions_[c[0].index()], positions_[c[1].index()], positions_[c[2].index()]);
  }

  bool IsAllowed(uint32_t u, uint32_t v) {
    made_.clear();
    going_ = u;
    for (const uint32_t t : around_[u]) {
      if (CornerOf(mesh_.triangles[t], v) < 0) made_.push_back({t, Moved(t, u, v)});
    }
    return KeepsTopology(u, v) && KeepsWedges(u, v) && KeepsShape(u) && KeepsFolds(u) && MeetsNothing();
  }

  // The link condition; and nothing is left with two triangles back to back, or without any.
  bool KeepsTopology(uint32_t u, uint32_t v) const {
    const Between between = TrianglesBetween(u, v);
    const std::vector<uint32_t> of_u = NeighboursOf(u), of_v = NeighboursOf(v);
    std::vector<uint32_t> common;
    std::set_intersection(of_u.begin(), of_u.end(), of_v.begin(), of_v.end(), std::back_inserter(common));
    if (made_.empty() || common.size() != static_cast<size_t>(between.count)) return false;
    for (const uint32_t apex : common) {
      if (around_[apex].size() < (IsRim(apex) ? 2 : 4)) return false;
    }
    return true;
  }

  bool KeepsShape(uint32_t u) const {
    double before = 1, after = 1;
    for (const uint32_t t : around_[u]) before = std::min(before, RatioOf(mesh_.triangles[t]));
    for (const auto& [t, c] : made_) {
      after = std::min(after, RatioOf(c));
      const Vec3 was = AreaOf(mesh_.triangles[t]), is = AreaOf(c);
      if (Dot(was, is) <= kMinNormalCosine * Norm(was) * Norm(is)) return false;
    }
    return after >= std::min(shape_.least_ratio, before) && after > 0;
  }

  // Over the sides of the triangles that are made, and of those that were there.
  bool KeepsFolds(uint32_t u) const {
    double before = 1, after = 1;
    for (const uint32_t t : around_[u]) before = std::min(before, LeastFold(t, mesh_.triangles[t], false));
    for (const auto& [t, c] : made_) after = std::min(after, LeastFold(t, c, true));
    return after >= std::min(before, shape_.least_fold);
  }

  // The least cosine between the normals of a triangle and of those across its sides.
  double LeastFold(uint32_t t, const Corners& c, bool is_made) const {
    const Vec3 n = Normalized(AreaOf(c));
    double least = 1;
    const auto look = [&](const Corners& other) {
      int shared = 0;
      for (const VertexId v : other) shared += CornerOf(c, v.index()) >= 0;
      if (shared == 2) least = std::min(least, Dot(n, Normalized(AreaOf(other))));
    };
    for (const VertexId v : c) {
      for (const uint32_t s : around_[v.index()]) {
        if (s != t && !(is_made && IsReplaced(s))) look(mesh_.triangles[s]);
      }
    }
    if (!is_made) return least;
    for (const auto& [s, other] : made_) {
      if (s != t) look(other);
    }
    return least;
  }

  // One of those around the vertex that goes, while a way is looked at.
  bool IsReplaced(uint32_t t) const { return CornerOf(mesh_.triangles[t], going_) >= 0; }

  bool Meet(const Corners& a, const Corners& b) const {
    const Vec3 p[3] = {positions_[a[0].index()], positions_[a[1].index()], positions_[a[2].index()]};
    const Vec3 q[3] = {positions_[b[0].index()], positions_[b[1].index()], positions_[b[2].index()]};
    return TrianglesIntersect(p, q, SharedCornersOf(a, b));
  }

  bool MeetsNothing() const {
    for (size_t i = 0; i < made_.size(); ++i) {
      for (size_t k = 0; k < i; ++k) {
        if (Meet(made_[i].second, made_[k].second)) return false;
      }
    }
    return std::none_of(made_.begin(), made_.end(), [&](const auto& made) { return MeetsAny(made.second); });
  }

  bool IsNear(const Corners& c, const Box3& box) const {
    const Vec3 &p = positions_[c[0].index()], &q = positions_[c[1].index()], &r = positions_[c[2].index()];
    const auto is_apart = [&](double Vec3::*axis) {
      return std::min({p.*axis, q.*axis, r.*axis}) > box.max.*axis ||
             std::max({p.*axis, q.*axis, r.*axis}) < box.min.*axis;
    };
    return !is_apart(&Vec3::x) && !is_apart(&Vec3::y) && !is_apart(&Vec3::z);
  }

  bool MeetsAny(const Corners& c) const {
    Box3 box;
    for (const VertexId v : c) box.Extend(positions_[v.index()]);
    bool found = false;
    const auto look = [&](uint32_t t) {
      found = found || (is_alive_[t] && !IsReplaced(t) && Meet(c, mesh_.triangles[t]));
    };
    tree_->VisitOverlaps(box, [&](FaceId f) {
      if (!is_changed_[f.index()]) look(f.index());
      return !found;
    });
    for (const uint32_t t : changed_) {
      if (IsNear(mesh_.triangles[t], box)) look(t);
    }
    return found;
  }

  void Collapse(uint32_t u, uint32_t v) {
    const Between between = TrianglesBetween(u, v);
    GiveWedges(u, v);
    for (int i = 0; i < between.count; ++i) {
      const uint32_t gone = between.triangles[i];
      for (const VertexId w : mesh_.triangles[gone]) std::erase(around_[w.index()], gone);
      is_alive_[gone] = false;
      --alive_;
    }
    for (const auto& [t, c] : made_) {
      mesh_.triangles[t] = c;
      around_[v].push_back(t);
      if (!std::exchange(is_changed_[t], uint8_t{1})) changed_.push_back(t);
    }
    around_[u].clear();
    quadrics_[v].Add(quadrics_[u]);
    if (changed_.size() > kMostChanged + alive_ / kTriangleSharesChanged) BuildTree();
    std::vector<uint32_t> near = NeighboursOf(v);
    near.push_back(v);
    for (const uint32_t w : near) ++stamps_[w];
    ++stamps_[u];
    for (const uint32_t w : near) PushFrom(w);
  }

  // On each side of the way, the wedge of u and that of v: what is drawn onto v gets the latter for the former.
  std::array<std::pair<uint32_t, uint32_t>, 2> WedgesBeside(uint32_t u, uint32_t v) const {
    const Between between = TrianglesBetween(u, v);
    std::array<std::pair<uint32_t, uint32_t>, 2> beside;
    for (int i = 0; i < 2; ++i) {
      const uint32_t t = between.triangles[std::min(i, between.count - 1)];
      const Corners& c = mesh_.triangles[t];
      beside[i] = {mesh_.corners[t][CornerOf(c, u)], mesh_.corners[t][CornerOf(c, v)]};
    }
    return beside;
  }

  // Each wedge around u has one at v to become.
  bool KeepsWedges(uint32_t u, uint32_t v) const {
    if (mesh_.corners.empty()) return true;
    const auto [left, right] = WedgesBeside(u, v);
    if (left.first == right.first && left.second != right.second) return false;
    return std::all_of(around_[u].begin(), around_[u].end(), [&, a = left.first, b = right.first](uint32_t t) {
      const uint32_t wedge = mesh_.corners[t][CornerOf(mesh_.triangles[t], u)];
      return wedge == a || wedge == b;
    });
  }

  void GiveWedges(uint32_t u, uint32_t v) {
    if (mesh_.corners.empty()) return;
    const auto [left, right] = WedgesBeside(u, v);
    for (const auto& made : made_) {
      uint32_t& wedge = mesh_.corners[made.first][CornerOf(mesh_.triangles[made.first], u)];
      wedge = wedge == left.first ? left.second : right.second;
    }
  }

  void BuildTree() {
    was_ = mesh_.triangles;
    for (uint32_t t = 0; t < was_.size(); ++t) {
      if (!is_alive_[t]) was_[t] = {was_[t][0], was_[t][0], was_[t][0]};  // found, and passed over
    }
    tree_ = std::make_unique<TriangleBvh>(positions_, was_);
    is_changed_.assign(was_.size(), 0);
    changed_.clear();
  }

  void Compact();

  HeldPiece& mesh_;
  uint64_t alive_;
  std::vector<bool> is_alive_;
  std::vector<Vec3> positions_;
  std::vector<std::vector<uint32_t>> around_;  // triangles of each vertex
  std::vector<Quadric> quadrics_;
  std::vector<uint64_t> stamps_;
  std::priority_queue<Way> queue_;
  Shape shape_ = kShapes[0];  // asked for at present
  uint64_t collapses_ = 0;
  uint32_t going_ = 0;
  std::vector<std::pair<uint32_t, Corners>> made_;  // by the way that is looked at: the triangle, and what it becomes
  std::vector<Corners> was_;                        // the tree's
  std::unique_ptr<TriangleBvh> tree_;
  std::vector<uint8_t> is_changed_;
  std::vector<uint32_t> changed_;
};

// What is left, numbered in the order that it had.
void Thinning::Compact() {
  HeldPiece left(MeshPiece{});
  left.open_front_edges = mesh_.open_front_edges;
  std::vector<uint32_t> vertex(mesh_.vertices.size(), kUnnamed), wedge(mesh_.wedges.size(), kUnnamed);
  const auto name = [](std::vector<uint32_t>& names, uint32_t i, const auto& from, auto& to) {
    if (names[i] == kUnnamed) {
      names[i] = static_cast<uint32_t>(to.size());
      to.push_back(from[i]);
    }
    return names[i];
  };
  for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (!is_alive_[t]) continue;
    Corners c = mesh_.triangles[t];
    for (VertexId& v : c) v = VertexId(name(vertex, v.index(), mesh_.vertices, left.vertices));
    left.triangles.push_back(c);
    left.kinds.push_back(mesh_.kinds[t]);
    if (!mesh_.faces.empty()) left.faces.push_back(mesh_.faces[t]);
    if (mesh_.corners.empty()) continue;
    CornerWedges wedges = mesh_.corners[t];
    for (uint32_t& w : wedges) w = name(wedge, w, mesh_.wedges, left.wedges);
    left.corners.push_back(wedges);
  }
  for (uint32_t v = 0; v < left.vertices.size(); ++v) left.finalised.push_back(VertexId(v));
  mesh_ = std::move(left);
}

}  // namespace

absl::StatusOr<uint64_t> ThinOut(uint64_t most_triangles, HeldPiece& mesh, const Context& context) {
  return Thinning(mesh).Run(most_triangles, context);
}

}  // namespace meshfront
