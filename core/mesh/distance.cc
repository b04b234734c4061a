// Sampled distances. Samples are numbered: used vertices, then edge samples, then face samples; sample i of a kind lies
// in the i-th of equal parts of the total length or area, at a place that depends on seed and i alone. Blocks of
// samples are measured in parallel and summed in their order, so that threads change nothing. Within a block,
// neighbours in number are neighbours in space mostly: the last distance plus the step bounds the next search.
#include "core/mesh/distance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geometry/bvh.h"
#include "core/mesh/repair_survey.h"

namespace meshfront {
namespace {

constexpr size_t kBlock = 1024;

// The triangles that take part.
absl::StatusOr<TriangleMesh> UsableTriangles(const TriangleMesh& mesh, const char* name) {
  MESHFRONT_RETURN_IF_ERROR(ValidateIndices(mesh));
  TriangleMesh out;
  for (const Triangle& t : mesh.triangles) {
    const FaceState state = StateOf(mesh, t);
    if (state == FaceState::kSound || state == FaceState::kZeroArea) out.triangles.push_back(t);
  }
  if (out.triangles.empty())
    return absl::InvalidArgumentError(absl::StrCat("the ", name, " has no triangles to measure"));
  out.positions = mesh.positions;
  return out;
}

uint64_t Mixed(uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}
double UnitFrom(uint64_t bits) { return double(bits >> 11) * 0x1p-53; }

// Where `total * share` falls in running sums.
size_t IndexAt(const std::vector<double>& sums, double share) {
  const size_t i = std::upper_bound(sums.begin(), sums.end(), share * sums.back()) - sums.begin();
  return std::min(i, sums.size() - 1);
}

class Sampler {
 public:
  Sampler(const TriangleMesh& mesh, const DistanceOptions& options) : mesh_(mesh), seed_(Mixed(options.seed)) {
    std::vector<bool> used(mesh.positions.size(), false);
    for (const Triangle& t : mesh.triangles) {
      for (int i = 0; i < 3; ++i) {
        const Vec3 &a = mesh.PositionAt(t[i]), &b = mesh.PositionAt(t[(i + 1) % 3]);
        used[t[i].index()] = true;
        lengths_.push_back((lengths_.empty() ? 0 : lengths_.back()) + Distance(a, b));
      }
      areas_.push_back(
          (areas_.empty() ? 0 : areas_.back()) +
          Norm(Cross(mesh.PositionAt(t[1]) - mesh.PositionAt(t[0]), mesh.PositionAt(t[2]) - mesh.PositionAt(t[0]))));
    }
    for (uint32_t v = 0; v < used.size(); ++v) {
      if (used[v]) vertices_.push_back(v);
    }
    edge_samples_ = std::max<uint64_t>(options.samples / 10, 1);
    face_samples_ = std::max<uint64_t>(options.samples - std::min(options.samples, edge_samples_), 1);
  }

  size_t count() const { return vertices_.size() + edge_samples_ + face_samples_; }
  bool IsOnFace(size_t i) const { return i >= vertices_.size() + edge_samples_; }
  uint64_t face_samples() const { return face_samples_; }

  Vec3 At(size_t i) const {
    if (i < vertices_.size()) return mesh_.positions[vertices_[i]];
    const uint64_t bits = Mixed(seed_ ^ Mixed(i));
    i -= vertices_.size();
    if (i < edge_samples_) {
      const size_t h = IndexAt(lengths_, (double(i) + UnitFrom(bits)) / double(edge_samples_));
      return Lerp(Corner(h / 3, h % 3), Corner(h / 3, (h + 1) % 3), UnitFrom(Mixed(bits)));
    }
    i -= edge_samples_;
    const size_t f = IndexAt(areas_, (double(i) + UnitFrom(bits)) / double(face_samples_));
    // Even over the triangle: a random point of the parallelogram, its far half folded back.
    double u = UnitFrom(Mixed(bits)), v = UnitFrom(Mixed(Mixed(bits)));
    if (u + v > 1) u = 1 - u, v = 1 - v;
    return Corner(f, 0) + u * (Corner(f, 1) - Corner(f, 0)) + v * (Corner(f, 2) - Corner(f, 0));
  }

 private:
  const Vec3& Corner(size_t f, size_t i) const { return mesh_.PositionAt(mesh_.triangles[f][i % 3]); }

  const TriangleMesh& mesh_;
  const uint64_t seed_;
  std::vector<uint32_t> vertices_;
  std::vector<double> lengths_, areas_;  // running sums
  uint64_t edge_samples_ = 0, face_samples_ = 0;
};

struct BlockSums {
  double max = -1, sum = 0, sum_of_squares = 0;
  Vec3 max_at;
};

BlockSums MeasureBlock(const Sampler& sampler, const TriangleBvh& target, size_t begin, size_t end) {
  BlockSums out;
  Vec3 last;
  double last_distance = std::numeric_limits<double>::infinity();
  for (size_t i = begin; i < end; ++i) {
    const Vec3 p = sampler.At(i);
    const double bound = (last_distance + Distance(p, last)) * (1 + 1e-12);
    std::optional<ClosestHit> hit = target.FindClosestPoint(p, bound);
    if (!hit) hit = target.FindClosestPoint(p);
    const double distance = std::sqrt(hit->squared_distance);
    if (distance > out.max) out.max = distance, out.max_at = p;
    if (sampler.IsOnFace(i)) out.sum += distance, out.sum_of_squares += hit->squared_distance;
    last = p, last_distance = distance;
  }
  return out;
}

absl::StatusOr<DirectedDistance> MeasureOneWay(const TriangleMesh& from, const TriangleBvh& target,
                                               const DistanceOptions& options, const Context& context) {
  const Sampler sampler(from, options);
  std::vector<BlockSums> blocks((sampler.count() + kBlock - 1) / kBlock);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(sampler.count(), kBlock, context, [&](size_t begin, size_t end) {
    blocks[begin / kBlock] = MeasureBlock(sampler, target, begin, end);
  }));
  DirectedDistance out;
  out.samples = sampler.count();
  out.max = -1;
  double sum = 0, sum_of_squares = 0;
  for (const BlockSums& block : blocks) {
    if (block.max > out.max) out.max = block.max, out.max_at = block.max_at;
    sum += block.sum;
    sum_of_squares += block.sum_of_squares;
  }
  out.mean = sum / double(sampler.face_samples());
  out.rms = std::sqrt(sum_of_squares / double(sampler.face_samples()));
  return out;
}

}  // namespace

absl::StatusOr<DistanceReport> MeasureDistance(const TriangleMesh& mesh, const TriangleMesh& reference,
                                               const DistanceOptions& options, const Context& context) {
  MESHFRONT_ASSIGN_OR_RETURN(const TriangleMesh ours, UsableTriangles(mesh, "mesh"));
  MESHFRONT_ASSIGN_OR_RETURN(const TriangleMesh theirs, UsableTriangles(reference, "reference"));
  DistanceReport out;
  out.reference_diagonal = BoundingBox(theirs).Diagonal();
  {
    const TriangleBvh bvh(theirs.positions, theirs.triangles);
    MESHFRONT_ASSIGN_OR_RETURN(out.forward, MeasureOneWay(ours, bvh, options, context));
  }
  const TriangleBvh bvh(ours.positions, ours.triangles);
  MESHFRONT_ASSIGN_OR_RETURN(out.backward, MeasureOneWay(theirs, bvh, options, context));
  return out;
}

}  // namespace meshfront
