// Remeshes an octahedron with the installed core: exit code 0 when the result is closed.
#include <cstdio>
#include <utility>

#include "core/remesh.h"

int main() {
  using meshfront::VertexId;
  meshfront::Problem problem;
  problem.mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const int faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (const auto& f : faces) problem.mesh.triangles.push_back({VertexId(f[0]), VertexId(f[1]), VertexId(f[2])});
  meshfront::CollectingSink sink;
  const auto report = meshfront::Remesh(std::move(problem), sink, {});
  if (!report.ok()) {
    std::fprintf(stderr, "%s\n", report.status().ToString().c_str());
    return 1;
  }
  return report->output.closed ? 0 : 1;
}
