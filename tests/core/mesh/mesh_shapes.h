// Small meshes for the tests of this room, generated in code.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <random>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace meshfront::shapes {

inline TriangleMesh MeshOf(std::vector<Vec3> positions, std::initializer_list<std::array<int, 3>> faces) {
  TriangleMesh mesh;
  mesh.positions = std::move(positions);
  for (const auto& f : faces) mesh.triangles.push_back({VertexId(f[0]), VertexId(f[1]), VertexId(f[2])});
  return mesh;
}

inline TriangleMesh Tetrahedron() {
  return MeshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
}

// A torus of u × v quads around the z axis, radii 2 and 1, closed, genus 1.
inline TriangleMesh Torus(int u, int v) {
  TriangleMesh mesh;
  for (int i = 0; i < u; ++i) {
    for (int j = 0; j < v; ++j) {
      const double a = 2 * std::numbers::pi * i / u, b = 2 * std::numbers::pi * j / v;
      mesh.positions.push_back({(2 + std::cos(b)) * std::cos(a), (2 + std::cos(b)) * std::sin(a), std::sin(b)});
    }
  }
  const auto id = [&](int i, int j) { return VertexId((i % u) * v + j % v); };
  for (int i = 0; i < u; ++i) {
    for (int j = 0; j < v; ++j) {
      mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  return mesh;
}

// n × n quads over the unit square at height 0; one boundary loop.
inline TriangleMesh Grid(int n) {
  TriangleMesh mesh;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) mesh.positions.push_back({double(i) / n, double(j) / n, 0});
  }
  const auto id = [&](int i, int j) { return VertexId(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  return mesh;
}

// A closed double cone of n sides; vertex 0 is a hub with n edges.
inline TriangleMesh DoubleCone(int n) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 1}, {0, 0, -1}};
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    mesh.positions.push_back({std::cos(a), std::sin(a), 0});
  }
  for (int i = 0; i < n; ++i) {
    const VertexId p(2 + i), q(2 + (i + 1) % n);
    mesh.triangles.push_back({VertexId(0), p, q});
    mesh.triangles.push_back({VertexId(1), q, p});
  }
  return mesh;
}

// Both meshes in one, nothing shared, the second moved.
inline TriangleMesh Joined(const TriangleMesh& a, const TriangleMesh& b, const Vec3& offset = {}) {
  TriangleMesh out = a;
  for (const Vec3& p : b.positions) out.positions.push_back(p + offset);
  for (Triangle t : b.triangles) {
    for (VertexId& v : t) v = VertexId(v.index() + static_cast<uint32_t>(a.positions.size()));
    out.triangles.push_back(t);
  }
  return out;
}

inline void Reverse(Triangle& t) { std::swap(t[1], t[2]); }

// The same triangles in another order, each with another first corner.
inline TriangleMesh Shuffled(TriangleMesh mesh, uint32_t seed) {
  std::mt19937 random(seed);
  for (size_t i = mesh.triangles.size(); i > 1; --i) std::swap(mesh.triangles[i - 1], mesh.triangles[random() % i]);
  for (Triangle& t : mesh.triangles) {
    for (uint32_t turns = random() % 3; turns > 0; --turns) t = {t[1], t[2], t[0]};
  }
  return mesh;
}

// `faces` triangles with random corners among `vertices` vertices on a small grid: coinciding positions, repeated
// indices, duplicates, edges with many faces.
inline TriangleMesh RandomSoup(int vertices, int faces, uint32_t seed) {
  std::mt19937 random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < vertices; ++i) {
    mesh.positions.push_back({double(random() % 4), double(random() % 4), double(random() % 3)});
  }
  for (int i = 0; i < faces; ++i) {
    mesh.triangles.push_back(
        {VertexId(random() % vertices), VertexId(random() % vertices), VertexId(random() % vertices)});
  }
  return mesh;
}

}  // namespace meshfront::shapes
