#include "core/mesh/repair_spikes.h"

#include <algorithm>
#include <vector>

#include "core/mesh/tolerances.h"

namespace meshfront {
namespace {

double MedianOf(std::vector<double>& values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// What surrounds a vertex: the other corners of its triangles.
struct Neighbours {
  Box3 box;
  Vec3 sum;
  double count = 0;
};

std::vector<Neighbours> NeighboursOf(const TriangleMesh& mesh) {
  std::vector<Neighbours> out(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      Neighbours& n = out[t[i].index()];
      for (int k = 1; k < 3; ++k) {
        const Vec3& p = mesh.PositionAt(t[(i + k) % 3]);
        n.box.Extend(p);
        n.sum += p;
        n.count += 1;
      }
    }
  }
  return out;
}

// The median distance of the used vertices from their componentwise median: a size that a few wild ones can't change.
double TypicalSize(const TriangleMesh& mesh, const std::vector<Neighbours>& neighbours) {
  Vec3 middle;
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (size_t v = 0; v < neighbours.size(); ++v) {
      if (neighbours[v].count > 0) values.push_back(mesh.positions[v][axis]);
    }
    middle[axis] = MedianOf(values);
  }
  values.clear();
  for (size_t v = 0; v < neighbours.size(); ++v) {
    if (neighbours[v].count > 0) values.push_back(Distance(mesh.positions[v], middle));
  }
  return MedianOf(values);
}

}  // namespace

bool MayHaveSpikes(const MeshSurvey& survey) { return survey.longest_side > 0.1 * kSpikeRatio * survey.median_side; }

uint64_t MoveSpikes(TriangleMesh& mesh) {
  const std::vector<Neighbours> neighbours = NeighboursOf(mesh);
  const double size = TypicalSize(mesh, neighbours);
  uint64_t moved = 0;
  for (size_t v = 0; v < neighbours.size(); ++v) {
    const Neighbours& n = neighbours[v];
    if (n.count < 6) continue;  // fewer than three triangles: nothing tells which corner is wrong
    const Vec3 middle = n.sum / n.count;
    const double distance = Distance(mesh.positions[v], middle);
    if (distance > kSpikeRatio * n.box.Diagonal() && distance > kSpikeRatio * size) mesh.positions[v] = middle, ++moved;
  }
  return moved;
}

}  // namespace meshfront
