// Copies, maps and cuts of meshes (the "Changed" part of shapes.h).
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

// The standard fixes the generator's sequence but not the distributions, hence this one.
double UniformIn(std::mt19937_64& generator, double low, double high) {
  return low + (high - low) * (static_cast<double>(generator() >> 11) * 0x1p-53);
}

std::vector<uint32_t> RandomOrder(size_t count, std::mt19937_64& generator) {
  std::vector<uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (size_t i = count; i > 1; --i) std::swap(order[i - 1], order[generator() % i]);
  return order;
}

// The place between a (f < 0) and b (f > 0), or the other way round, where f vanishes.
double CrossingOf(const std::function<double(const Vec3&)>& f, const Vec3& a, const Vec3& b) {
  double low = 0, high = 1;
  const bool rising = f(a) < 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    ((f(Lerp(a, b, middle)) < 0) == rising ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Cuts a mesh along the zero line of a field, given by its values at the vertices.
class Clipper {
 public:
  Clipper(const TriangleMesh& mesh, const std::function<double(const Vec3&)>& f) : mesh_(mesh), f_(f) {
    for (const Vec3& p : mesh_.positions) values_.push_back(f(p));
    SnapNearVertices();
  }
  TriangleMesh Run() {
    const std::vector<Triangle> all = std::exchange(mesh_.triangles, {});
    for (const Triangle& t : all) AddKeptPart(t);
    return WithoutUnreferenced(mesh_);
  }

 private:
  // A crossing nearer to a vertex than this share of the edge takes the vertex along, else it would leave a sliver.
  static constexpr double kSnapShare = 0.25;

  bool Crosses(VertexId a, VertexId b) const { return values_[a.index()] * values_[b.index()] < 0; }
  void SnapNearVertices() {
    for (const Triangle& t : mesh_.triangles) {
      for (int i = 0; i < 3; ++i) {
        const VertexId a = t[i], b = t[(i + 1) % 3];
        if (!Crosses(a, b)) continue;
        const double s = CrossingOf(f_, mesh_.PositionAt(a), mesh_.PositionAt(b));
        if (s > kSnapShare && s < 1 - kSnapShare) continue;
        const uint32_t moved = s < 0.5 ? a.index() : b.index();
        mesh_.positions[moved] = Lerp(mesh_.PositionAt(a), mesh_.PositionAt(b), s);
        values_[moved] = 0;
      }
    }
  }
  VertexId VertexOn(VertexId a, VertexId b) {
    if (b < a) std::swap(a, b);
    const auto [it, added] = cuts_.try_emplace({a, b}, mesh_.positions.size());
    if (added) {
      const Vec3 p = mesh_.PositionAt(a), q = mesh_.PositionAt(b);
      mesh_.positions.push_back(Lerp(p, q, CrossingOf(f_, p, q)));
    }
    return it->second;
  }
  void AddKeptPart(const Triangle& t) {
    std::vector<VertexId> kept;
    bool inside = false;
    for (int i = 0; i < 3; ++i) {
      const VertexId a = t[i], b = t[(i + 1) % 3];
      inside |= values_[a.index()] < 0;
      if (values_[a.index()] <= 0) kept.push_back(a);
      if (Crosses(a, b)) kept.push_back(VertexOn(a, b));
    }
    if (!inside) return;
    for (size_t i = 2; i < kept.size(); ++i) mesh_.triangles.push_back({kept[0], kept[i - 1], kept[i]});
  }

  TriangleMesh mesh_;
  const std::function<double(const Vec3&)>& f_;
  std::vector<double> values_;
  std::map<std::pair<VertexId, VertexId>, VertexId> cuts_;
};

}  // namespace

TriangleMesh WithoutUnreferenced(const TriangleMesh& mesh) {
  TriangleMesh kept;
  std::vector<VertexId> renamed(mesh.positions.size());
  for (Triangle t : mesh.triangles) {
    for (VertexId& v : t) {
      VertexId& name = renamed[v.index()];
      if (!name.valid()) {
        name = VertexId(kept.positions.size());
        kept.positions.push_back(mesh.PositionAt(v));
      }
      v = name;
    }
    kept.triangles.push_back(t);
  }
  return kept;
}

TriangleMesh Clipped(const TriangleMesh& mesh, const std::function<double(const Vec3&)>& f) {
  return Clipper(mesh, f).Run();
}

TriangleMesh Joined(TriangleMesh a, const TriangleMesh& b) {
  const uint32_t offset = static_cast<uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (Triangle t : b.triangles) {
    for (VertexId& v : t) v = VertexId(v.index() + offset);
    a.triangles.push_back(t);
  }
  return a;
}

TriangleMesh Mapped(TriangleMesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& p : mesh.positions) p = map(p);
  return mesh;
}

TriangleMesh Moved(TriangleMesh mesh, const Vec3& shift) {
  return Mapped(std::move(mesh), [&](const Vec3& p) { return p + shift; });
}

TriangleMesh Scaled(TriangleMesh mesh, double factor) {
  return Mapped(std::move(mesh), [&](const Vec3& p) { return factor * p; });
}

TriangleMesh Rotated(TriangleMesh mesh, const Vec3& axis, double angle) {
  const Vec3 k = Normalized(axis);
  const double c = std::cos(angle), s = std::sin(angle);
  return Mapped(std::move(mesh), [&](const Vec3& p) { return c * p + s * Cross(k, p) + (1 - c) * Dot(k, p) * k; });
}

TriangleMesh Reversed(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh Sampled(const TriangleMesh& mesh, size_t count, uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<double> areas;  // summed up
  std::vector<Vec3> normals;
  double total = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 ab = mesh.PositionAt(t[1]) - mesh.PositionAt(t[0]), ac = mesh.PositionAt(t[2]) - mesh.PositionAt(t[0]);
    areas.push_back(total += Norm(Cross(ab, ac)));
    normals.push_back(Normalized(Cross(ab, ac)));
  }
  TriangleMesh points;
  for (size_t i = 0; i < count; ++i) {
    const auto f =
        static_cast<size_t>(std::upper_bound(areas.begin(), areas.end() - 1, total * unit()) - areas.begin());
    double u = unit(), v = unit();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Triangle& t = mesh.triangles[f];
    points.positions.push_back((1 - u - v) * mesh.PositionAt(t[0]) + u * mesh.PositionAt(t[1]) +
                               v * mesh.PositionAt(t[2]));
    points.normals.push_back(normals[f]);
  }
  return points;
}

TriangleMesh WithNoise(TriangleMesh mesh, double amplitude, uint64_t seed) {
  std::mt19937_64 generator(seed);
  for (Vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) p[axis] += UniformIn(generator, -amplitude, amplitude);
  }
  return mesh;
}

TriangleMesh Permuted(const TriangleMesh& mesh, uint64_t seed) {
  std::mt19937_64 generator(seed);
  const std::vector<uint32_t> new_name = RandomOrder(mesh.positions.size(), generator);
  TriangleMesh result;
  result.positions.resize(mesh.positions.size());
  for (size_t i = 0; i < new_name.size(); ++i) result.positions[new_name[i]] = mesh.positions[i];
  for (const uint32_t f : RandomOrder(mesh.triangles.size(), generator)) {
    const Triangle& t = mesh.triangles[f];
    const size_t first = generator() % 3;
    Triangle renamed;
    for (size_t i = 0; i < 3; ++i) renamed[i] = VertexId(new_name[t[(first + i) % 3].index()]);
    result.triangles.push_back(renamed);
  }
  return result;
}

TriangleMesh Soup(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (const Triangle& t : mesh.triangles) {
    Triangle own;
    for (int i = 0; i < 3; ++i) {
      own[i] = VertexId(soup.positions.size());
      soup.positions.push_back(mesh.PositionAt(t[i]));
    }
    soup.triangles.push_back(own);
  }
  return soup;
}

}  // namespace meshfront::testing
