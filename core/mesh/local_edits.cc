#include "core/mesh/local_edits.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/geometry/intersection.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

// A new triangle's normal against that of the one in whose place it is.
constexpr double kMinNormalCosine = 0.0;
// Triangles that changed since the tree was built are looked at one by one; beyond so many, and a part of all, it is built again.
constexpr size_t kMostChanged = 256, kTriangleSharesChanged = 64;
constexpr uint32_t kUnnamed = 0xffffffffu;

}  // namespace

LocalEdits::LocalEdits(HeldPiece& mesh)
    : mesh_(mesh),
      alive_(mesh.triangles.size()),
      is_alive_(mesh.triangles.size(), true),
      around_(mesh.vertices.size()) {
  for (const OutputVertex& v : mesh.vertices) positions_.push_back(v.position);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const VertexId v : mesh.triangles[t]) around_[v.index()].push_back(t);
  }
  NamePatches();
  BuildTree();
}

void LocalEdits::NamePatches() {
  if (mesh_.corners.empty()) return;
  patch_.assign(mesh_.triangles.size(), kUnnamed);
  std::vector<uint32_t> reached;
  for (uint32_t seed = 0; seed < patch_.size(); ++seed) {
    if (patch_[seed] == kUnnamed) patch_[seed] = seed, reached.push_back(seed);
    while (!reached.empty()) {
      const uint32_t t = reached.back();
      reached.pop_back();
      for (int i = 0; i < 3; ++i) {
        const uint32_t u = mesh_.triangles[t][i].index(), v = mesh_.triangles[t][(i + 1) % 3].index();
        if (IsFeature(u, v)) continue;
        for (const uint32_t s : TrianglesBetween(u, v).triangles) {
          if (patch_[s] == kUnnamed) patch_[s] = seed, reached.push_back(s);
        }
      }
    }
  }
  origin_.assign(around_.size(), {kUnnamed, kUnnamed});
  for (uint32_t v = 0; v < around_.size(); ++v) {
    const auto of = [&](uint32_t t) { return std::pair(patch_[t], mesh_.corners[t][CornerOf(mesh_.triangles[t], v)]); };
    const std::vector<uint32_t>& all = around_[v];
    if (!all.empty() && std::all_of(all.begin(), all.end(), [&](uint32_t t) { return of(t) == of(all[0]); }))
      origin_[v] = of(all[0]);
  }
}

Vec3 LocalEdits::AreaOf(const Corners& c) const {
  return AreaVector(positions_[c[0].index()], positions_[c[1].index()], positions_[c[2].index()]);
}

double LocalEdits::RatioOf(const Corners& c) const {
  return RadiusRatio(positions_[c[0].index()], positions_[c[1].index()], positions_[c[2].index()]);
}

int LocalEdits::CornerOf(const Corners& c, uint32_t v) {
  for (int i = 0; i < 3; ++i) {
    if (c[i].index() == v) return i;
  }
  return -1;
}

LocalEdits::Between LocalEdits::TrianglesBetween(uint32_t u, uint32_t v) const {
  Between between;
  for (const uint32_t t : around_[u]) {
    if (CornerOf(mesh_.triangles[t], v) >= 0 && between.count < 2) between.triangles[between.count++] = t;
  }
  return between;
}

bool LocalEdits::IsFeature(uint32_t u, uint32_t v) const {
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

std::vector<uint32_t> LocalEdits::NeighboursOf(uint32_t v) const {
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

bool LocalEdits::IsRim(uint32_t v) const {
  for (const uint32_t w : NeighboursOf(v)) {
    if (TrianglesBetween(v, w).count < 2) return true;
  }
  return false;
}

LocalEdits::Corners LocalEdits::Moved(uint32_t t, uint32_t u, uint32_t v) const {
  Corners c = mesh_.triangles[t];
  c[CornerOf(c, u)] = VertexId(v);
  return c;
}

// ---- proposals ----

bool LocalEdits::ProposeMove(uint32_t u, uint32_t v, const TriangleShape& shape) {
  made_.clear();
  replaced_ = around_[u];
  for (const uint32_t t : around_[u]) {
    if (CornerOf(mesh_.triangles[t], v) < 0)
      made_.push_back({t, Moved(t, u, v), mesh_.corners.empty() ? CornerWedges{} : mesh_.corners[t]});
  }
  if (!KeepsLinks(u, v) || !KeepsWedges(u, v)) return false;
  GiveWedges(u, v);
  return KeepsShapes(shape) && KeepsFolds(shape) && MeetsNothing();
}

bool LocalEdits::ProposeFlip(uint32_t u, uint32_t v, const TriangleShape& shape) {
  made_.clear();
  const Between between = TrianglesBetween(u, v);
  replaced_.assign(between.triangles, between.triangles + between.count);
  if (between.count < 2 || IsFeature(u, v)) return false;
  // Of each triangle, the corner away from the edge, and the one where the edge starts, seen from it.
  int apex[2], start[2];
  for (int k = 0; k < 2; ++k) {
    const Corners& c = mesh_.triangles[between.triangles[k]];
    apex[k] = 3 - CornerOf(c, u) - CornerOf(c, v);
    start[k] = (apex[k] + 1) % 3;
  }
  const auto corner = [&](int k, int i) { return mesh_.triangles[between.triangles[k]][i]; };
  const auto wedge = [&](int k, int i) { return mesh_.corners.empty() ? 0 : mesh_.corners[between.triangles[k]][i]; };
  if (TrianglesBetween(corner(0, apex[0]).index(), corner(1, apex[1]).index()).count > 0) return false;
  if (corner(0, apex[0]) == corner(1, apex[1])) return false;
  for (int k = 0; k < 2; ++k) {
    made_.push_back({between.triangles[k],
                     {corner(k, apex[k]), corner(k, start[k]), corner(1 - k, apex[1 - k])},
                     {wedge(k, apex[k]), wedge(k, start[k]), wedge(1 - k, apex[1 - k])}});
  }
  return KeepsShapes(shape) && KeepsFolds(shape) && MeetsNothing();
}

// The link condition; and nothing is left with two triangles back to back, or without any.
bool LocalEdits::KeepsLinks(uint32_t u, uint32_t v) const {
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

// On each side of the way, the wedge of u and that of v: what is drawn onto v gets the latter for the former.
std::array<std::pair<uint32_t, uint32_t>, 2> LocalEdits::WedgesBeside(uint32_t u, uint32_t v) const {
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
bool LocalEdits::KeepsWedges(uint32_t u, uint32_t v) const {
  if (mesh_.corners.empty()) return true;
  if (around_[v].empty()) {
    return std::all_of(around_[u].begin(), around_[u].end(), [&](uint32_t t) { return patch_[t] == origin_[v].first; });
  }
  const auto [left, right] = WedgesBeside(u, v);
  if (left.first == right.first && left.second != right.second) return false;
  return std::all_of(around_[u].begin(), around_[u].end(), [&, a = left.first, b = right.first](uint32_t t) {
    const uint32_t wedge = mesh_.corners[t][CornerOf(mesh_.triangles[t], u)];
    return wedge == a || wedge == b;
  });
}

void LocalEdits::GiveWedges(uint32_t u, uint32_t v) {
  if (mesh_.corners.empty()) return;
  using Pair = std::pair<uint32_t, uint32_t>;
  const auto [left, right] =
      around_[v].empty() ? std::array<Pair, 2>{Pair{kUnnamed, 0}, Pair{0, origin_[v].second}} : WedgesBeside(u, v);
  for (Made& made : made_) {
    uint32_t& wedge = made.wedges[CornerOf(mesh_.triangles[made.triangle], u)];
    wedge = wedge == left.first ? left.second : right.second;
  }
}

bool LocalEdits::KeepsShapes(const TriangleShape& shape) const {
  double before = 1, after = 1;
  for (const uint32_t t : replaced_) before = std::min(before, RatioOf(mesh_.triangles[t]));
  for (const Made& made : made_) {
    after = std::min(after, RatioOf(made.corners));
    const Vec3 was = AreaOf(mesh_.triangles[made.triangle]), is = AreaOf(made.corners);
    if (Dot(was, is) <= kMinNormalCosine * Norm(was) * Norm(is)) return false;
  }
  return after > 0 && after >= std::min(shape.least_ratio, before) && after >= shape.gain * before;
}

// Over the sides of the triangles that are made, and of those that were there.
bool LocalEdits::KeepsFolds(const TriangleShape& shape) const {
  double before = 1, after = 1;
  for (const uint32_t t : replaced_) before = std::min(before, LeastFold(t, mesh_.triangles[t], false));
  for (const Made& made : made_) after = std::min(after, LeastFold(made.triangle, made.corners, true));
  return after >= std::min(before, shape.least_fold);
}

// The least cosine between the normals of a triangle and of those across its sides.
double LocalEdits::LeastFold(uint32_t t, const Corners& c, bool is_made) const {
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
  for (const Made& made : made_) {
    if (made.triangle != t) look(made.corners);
  }
  return least;
}

// ---- what lies near ----

bool LocalEdits::IsReplaced(uint32_t t) const {
  return std::find(replaced_.begin(), replaced_.end(), t) != replaced_.end();
}

bool LocalEdits::Meet(const Corners& a, const Corners& b) const {
  const Vec3 p[3] = {positions_[a[0].index()], positions_[a[1].index()], positions_[a[2].index()]};
  const Vec3 q[3] = {positions_[b[0].index()], positions_[b[1].index()], positions_[b[2].index()]};
  return TrianglesIntersect(p, q, SharedCornersOf(a, b));
}

bool LocalEdits::MeetsNothing() const {
  for (size_t i = 0; i < made_.size(); ++i) {
    for (size_t k = 0; k < i; ++k) {
      if (Meet(made_[i].corners, made_[k].corners)) return false;
    }
  }
  return std::none_of(made_.begin(), made_.end(), [&](const Made& made) { return MeetsAny(made.corners); });
}

bool LocalEdits::IsNear(const Corners& c, const Box3& box) const {
  const Vec3 &p = positions_[c[0].index()], &q = positions_[c[1].index()], &r = positions_[c[2].index()];
  const auto is_apart = [&](double Vec3::*axis) {
    return std::min({p.*axis, q.*axis, r.*axis}) > box.max.*axis ||
           std::max({p.*axis, q.*axis, r.*axis}) < box.min.*axis;
  };
  return !is_apart(&Vec3::x) && !is_apart(&Vec3::y) && !is_apart(&Vec3::z);
}

bool LocalEdits::MeetsAny(const Corners& c) const {
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

void LocalEdits::BuildTree() {
  was_ = mesh_.triangles;
  for (uint32_t t = 0; t < was_.size(); ++t) {
    if (!is_alive_[t]) was_[t] = {was_[t][0], was_[t][0], was_[t][0]};  // found, and passed over
  }
  tree_ = std::make_unique<TriangleBvh>(positions_, was_);
  is_changed_.assign(was_.size(), 0);
  changed_.clear();
}

// ---- edits ----

void LocalEdits::Apply() {
  for (const uint32_t t : replaced_) {
    for (const VertexId v : mesh_.triangles[t]) std::erase(around_[v.index()], t);
    is_alive_[t] = false;
  }
  for (const Made& made : made_) {
    is_alive_[made.triangle] = true;
    mesh_.triangles[made.triangle] = made.corners;
    if (!mesh_.corners.empty()) mesh_.corners[made.triangle] = made.wedges;
    for (const VertexId v : made.corners) around_[v.index()].push_back(made.triangle);
    if (!std::exchange(is_changed_[made.triangle], uint8_t{1})) changed_.push_back(made.triangle);
  }
  alive_ -= replaced_.size() - made_.size();
  if (changed_.size() > kMostChanged + alive_ / kTriangleSharesChanged) BuildTree();
}

void LocalEdits::Compact() {
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

}  // namespace meshfront
