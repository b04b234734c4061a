// 1. a quadric for each vertex: the planes of its triangles, and planes upright on its feature edges     (AddQuadrics)
// 2. a queue of ways from a vertex to a neighbour, the cheapest first                                   (Push)
// 3. the next way, if what it makes is allowed (LocalEdits)                                             (TakeOut)
// 4. where the queue is empty too early, again with less asked of shapes, and then with more that a way may cost
// 5. edges are turned and vertices moved to places where others went, where that is rounder             (RoundOff)
// Vertices have places of the mesh, unlike in Garland and Heckbert's method: they lie on the surface, and a place of least error does
// not.
// Rejected: a coarser field. Where it asks for edges longer than the surface allows to walk over, fronts are taken back again and again,
// and make the more triangles the fewer are wanted.
#include "core/mesh/thinning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/mesh/local_edits.h"

namespace meshfront {
namespace {

constexpr TriangleShape kShapes[] = {{0.4, -0.5}, {0.2, -0.5}, {0.05, -0.9}, {0.005, -0.99}};
// How much a way may cost, in parts of the mean squared edge: less is asked of shapes before more is lost of the surface.
constexpr double kCostLimits[] = {1e-3, 1e-2, 0.1, 1, 10, std::numeric_limits<double>::infinity()};
// What a way costs for its length alone, in parts of its square; and what a bad shape multiplies that by at most.
constexpr double kCostPerLength = 2e-3;
constexpr double kLeastRatioInCost = 0.02;
// The weight of planes upright on feature edges against those of the triangles there.
constexpr double kFeatureWeight = 4;
constexpr size_t kStopInterval = 64;  // edits between two looks at the context
// Of edits that make nothing but rounder triangles; how many places are tried for a vertex, and how often all is looked through.
constexpr TriangleShape kRounder = {0.4, -0.5, 1.02};
// What they may cost, in parts of the mean squared edge of what is left: three times as much makes p0.5 of four of six models 0.01 to 0.1
// better still, and the mean error of four 3 to 9 % larger.
constexpr double kCostOfRounding = 0.01;
constexpr size_t kMostPlaces = 6;
constexpr int kSweeps = 8;

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
  explicit Thinning(HeldPiece& mesh) : edits_(mesh) {
    quadrics_.resize(edits_.vertices()), stamps_.resize(edits_.vertices()), gone_.resize(edits_.vertices());
    AddQuadrics();
  }

  absl::StatusOr<uint64_t> Run(uint64_t most_triangles, const Context& context) {
    const double unit = MeanSquaredEdge();
    for (const double parts : kCostLimits) {
      for (const TriangleShape& shape : kShapes) {
        if (edits_.triangles() <= most_triangles) break;
        MESHFRONT_RETURN_IF_ERROR(TakeOut(most_triangles, parts * unit, shape, context));
      }
    }
    MESHFRONT_RETURN_IF_ERROR(RoundOff(kCostOfRounding * MeanSquaredEdge(), context));
    edits_.Compact();
    return edits_.triangles();
  }

 private:
  double MeanSquaredEdge() const {
    double sum = 0;
    for (uint32_t t = 0; t < edits_.triangle_slots(); ++t) {
      const LocalEdits::Corners& c = edits_.corners(t);
      for (int i = 0; i < 3 && edits_.is_alive(t); ++i)
        sum += SquaredDistance(edits_.position(c[i].index()), edits_.position(c[(i + 1) % 3].index()));
    }
    return sum / (3 * static_cast<double>(std::max<uint64_t>(edits_.triangles(), 1)));
  }

  absl::Status CheckStop(const Context& context) {
    return ++looks_ % kStopInterval == 0 ? context.CheckStop() : absl::OkStatus();
  }

  // ---- fewer ----

  // Ways up to a cost, whose triangles have a shape.
  absl::Status TakeOut(uint64_t most_triangles, double most_cost, const TriangleShape& shape, const Context& context) {
    queue_ = {};
    for (uint32_t v = 0; v < edits_.vertices(); ++v) PushFrom(v);
    while (edits_.triangles() > most_triangles && !queue_.empty() && queue_.top().cost <= most_cost) {
      const Way way = queue_.top();
      queue_.pop();
      if (way.stamp != stamps_[way.from] || !edits_.ProposeMove(way.from, way.to, shape)) continue;
      edits_.Apply();
      DrawOnto(way.from, way.to);
      MESHFRONT_RETURN_IF_ERROR(CheckStop(context));
    }
    return absl::OkStatus();
  }

  void AddQuadrics() {
    for (uint32_t t = 0; t < edits_.triangle_slots(); ++t) {
      const LocalEdits::Corners& c = edits_.corners(t);
      const Vec3 area = edits_.AreaOf(c), n = Normalized(area);
      const double weight = 0.5 * Norm(area);
      for (const VertexId v : c) quadrics_[v.index()].Add(n, -Dot(n, edits_.position(c[0].index())), weight);
      for (int i = 0; i < 3; ++i) AddFeature(c[i].index(), c[(i + 1) % 3].index(), n);
    }
  }

  // Upright on the triangle, through its side.
  void AddFeature(uint32_t u, uint32_t v, const Vec3& normal) {
    if (!edits_.IsFeature(u, v)) return;
    const Vec3 along = edits_.position(v) - edits_.position(u), n = Normalized(Cross(along, normal));
    for (const uint32_t end : {u, v})
      quadrics_[end].Add(n, -Dot(n, edits_.position(u)), kFeatureWeight * SquaredNorm(along));
  }

  void PushFrom(uint32_t u) {
    if (edits_.around(u).empty()) return;
    const std::vector<uint32_t> neighbours = edits_.NeighboursOf(u), along = AlongFeatures(u, neighbours);
    if (!along.empty() && along.size() != 2) return;
    for (const uint32_t v : along.empty() ? neighbours : along) Push(u, v);
  }

  std::vector<uint32_t> AlongFeatures(uint32_t u, const std::vector<uint32_t>& neighbours) const {
    std::vector<uint32_t> along;
    for (const uint32_t v : neighbours) {
      if (edits_.IsFeature(u, v)) along.push_back(v);
    }
    return along;
  }

  double AreaAround(uint32_t u) const {
    double area = 0;
    for (const uint32_t t : edits_.around(u)) area += 0.5 * Norm(edits_.AreaOf(edits_.corners(t)));
    return area;
  }

  void Push(uint32_t u, uint32_t v) {
    double ratio = 1;
    for (const uint32_t t : edits_.around(u)) {
      if (LocalEdits::CornerOf(edits_.corners(t), v) < 0)
        ratio = std::min(ratio, edits_.RatioOf(edits_.Moved(t, u, v)));
    }
    const double area = AreaAround(u);
    if (!(area > 0)) return;
    Quadric both = quadrics_[u];
    both.Add(quadrics_[v]);
    const double way = SquaredDistance(edits_.position(u), edits_.position(v));
    const double cost =
        (both.At(edits_.position(v)) / area + kCostPerLength * way) / std::max(ratio, kLeastRatioInCost);
    queue_.push({cost, u, v, stamps_[u]});
  }

  void DrawOnto(uint32_t u, uint32_t v) {
    quadrics_[v].Add(quadrics_[u]);
    gone_[v].push_back(u);
    gone_[v].insert(gone_[v].end(), gone_[u].begin(), gone_[u].end());
    gone_[u].clear();
    std::vector<uint32_t> near = edits_.NeighboursOf(v);
    near.push_back(v);
    for (const uint32_t w : near) ++stamps_[w];
    ++stamps_[u];
    for (const uint32_t w : near) PushFrom(w);
  }

  // ---- rounder ----

  // Edits that cost no more than `most_cost`, or than what is there.
  absl::Status RoundOff(double most_cost, const Context& context) {
    bool is_changed = true;
    for (int sweep = 0; sweep < kSweeps && is_changed; ++sweep) {
      is_changed = false;
      for (uint32_t t = 0; t < edits_.triangle_slots(); ++t) {
        MESHFRONT_RETURN_IF_ERROR(CheckStop(context));
        for (int i = 0; i < 3 && edits_.is_alive(t); ++i) {
          const uint32_t u = edits_.corners(t)[i].index(), v = edits_.corners(t)[(i + 1) % 3].index();
          if (u < v && TurnEdge(u, v, most_cost)) is_changed = true;
        }
      }
      for (uint32_t v = 0; v < edits_.vertices(); ++v) {
        MESHFRONT_RETURN_IF_ERROR(CheckStop(context));
        if (MoveVertex(v, most_cost)) is_changed = true;
      }
    }
    return absl::OkStatus();
  }

  bool TurnEdge(uint32_t u, uint32_t v, double most_cost) {
    if (!edits_.ProposeFlip(u, v, kRounder)) return false;
    const LocalEdits::Between between = edits_.TrianglesBetween(u, v);
    Quadric all = quadrics_[u];
    all.Add(quadrics_[v]);
    Vec3 middle;
    double area = 0;
    for (const uint32_t t : between.triangles) {
      for (const VertexId w : edits_.corners(t)) {
        if (w.index() != u && w.index() != v)
          middle = middle + 0.5 * edits_.position(w.index()), all.Add(quadrics_[w.index()]);
      }
      area += 0.5 * Norm(edits_.AreaOf(edits_.corners(t)));
    }
    const double was = all.At(0.5 * (edits_.position(u) + edits_.position(v)));
    if (all.At(middle) > std::max(was, most_cost * area)) return false;
    edits_.Apply();
    return true;
  }

  // To where a vertex was that went near by: the nearest to the middle of the neighbours that makes its triangles rounder.
  bool MoveVertex(uint32_t u, double most_cost) {
    if (edits_.around(u).empty()) return false;
    const std::vector<uint32_t> neighbours = edits_.NeighboursOf(u);
    if (!AlongFeatures(u, neighbours).empty()) return false;
    Vec3 middle;
    std::vector<std::pair<double, std::pair<uint32_t, uint32_t>>>
        places;  // squared distance, vertex, onto which it was drawn
    for (const uint32_t v : neighbours)
      middle = middle + 1.0 / static_cast<double>(neighbours.size()) * edits_.position(v);
    const auto add = [&](uint32_t host) {
      for (const uint32_t w : gone_[host]) places.push_back({SquaredDistance(edits_.position(w), middle), {w, host}});
    };
    add(u);
    for (const uint32_t v : neighbours) add(v);
    const size_t most = std::min(places.size(), kMostPlaces);
    std::partial_sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(most), places.end());
    const double area = AreaAround(u), was = quadrics_[u].At(edits_.position(u));
    for (size_t i = 0; i < most; ++i) {
      const auto [w, host] = places[i].second;
      if (quadrics_[u].At(edits_.position(w)) > std::max(was, most_cost * area)) continue;
      if (!edits_.ProposeMove(u, w, kRounder)) continue;
      edits_.Apply();
      std::erase(gone_[host], w);
      gone_[w] = std::exchange(gone_[u], {});
      gone_[w].push_back(u);
      quadrics_[w] = quadrics_[u];
      return true;
    }
    return false;
  }

  LocalEdits edits_;
  std::vector<Quadric> quadrics_;
  std::vector<uint64_t> stamps_;
  std::vector<std::vector<uint32_t>> gone_;  // vertices that were drawn onto each
  std::priority_queue<Way> queue_;
  uint64_t looks_ = 0;
};

}  // namespace

absl::StatusOr<uint64_t> ThinOut(uint64_t most_triangles, HeldPiece& mesh, const Context& context) {
  return Thinning(mesh).Run(most_triangles, context);
}

}  // namespace meshfront
