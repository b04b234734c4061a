// Per vertex: 1. collect the 3-ring (RingCollector); 2. local frame: the area-weighted mean normal of the ring is z;
// 3. weighted least squares of z = a x² + b xy + c y² + d x + e y + f, by the moments of the weights and an LDLᵀ of the scaled
// 6 × 6 system (SolveScaled); 4. ill conditioned: one ring more and again; 5. principal curvatures from both fundamental forms;
// 6. clamp to what the mesh resolves. Where no system can be solved (a tetrahedron): the largest turn of the normal per length.
// The weights are the area around each sample, so that uneven sampling does not count twice, falling off from ring to ring, and
// falling with the turn of the normal, so that the far side of a thin limb has no say.
// Rejected: the fit forced through the vertex itself, as the prototype does it: noise at the vertex enters with full force.
// Rejected: the tensor of normal variation; a quarter of the cost, but low by a quarter where curvature is high, which is
// where it decides the field.
#include "core/surface/curvature_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/surface/vertex_rings.h"

namespace meshfront {
namespace {

constexpr size_t kGrain = 512;
// Where the rings turn this far, a ridge is narrower than they are and the fit averages it away (the rim of the bunny's ear: the fit
// says 172, the turn to a neighbour 330). Then at least this share of the largest turn of the normal per length counts; all of
// it, or everywhere, would follow noise.
constexpr double kFarTurnCosine = 0.3;
constexpr double kTurnShare = 0.55;
constexpr int kRings = 3;     // sec. 3.2
constexpr int kMaxRings = 6;  // grown to while ill conditioned
constexpr int kTerms = 6;     // x², xy, y², x, y, 1
constexpr uint32_t kMinSamples = 7;
// Of the scaled system (unit diagonal): a pivot below this says that some term is not determined.
constexpr double kMinPivot = 1e-5;

// What the fit reads of a vertex, side by side: its place, and the unit normal times a third of the faces around it.
struct Sample {
  Vec3 position, weighted_normal;
};

struct Sources {
  std::vector<Sample> samples;
  absl::Span<const Vec3> normals;
  VertexRings rings;
};

// An orthonormal frame around a unit vector.
struct Frame {
  Vec3 x, y, z;
  explicit Frame(const Vec3& normal) : z(normal) {
    const Vec3 other = std::abs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    x = Normalized(Cross(other, z));
    y = Cross(z, x);
  }
};

struct System {
  std::array<std::array<double, kTerms>, kTerms> matrix;  // lower triangle
  std::array<double, kTerms> right;
};

// The ring in its frame, scaled to the unit disk, one array each.
struct LocalSamples {
  // One more than fits, for the pad to an even count.
  double x[RingCollector::kCapacity + 1], y[RingCollector::kCapacity + 1], z[RingCollector::kCapacity + 1];
  double weight[RingCollector::kCapacity + 1];
  uint32_t count = 0;
};

// Two samples at a time; a vector type of the compiler, since it may not reorder sums of doubles by itself.
typedef double Pair __attribute__((vector_size(16)));
inline Pair LoadPair(const double* from) { return Pair{from[0], from[1]}; }
inline double SumOf(Pair p) { return p[0] + p[1]; }

// The normal equations from the 15 moments of the weights up to x⁴, x³y, … and the 6 with z.
System NormalEquations(LocalSamples& s) {
  s.x[s.count] = s.y[s.count] = s.z[s.count] = s.weight[s.count] = 0;
  Pair m40{}, m31{}, m22{}, m13{}, m04{}, m30{}, m21{}, m12{}, m03{}, m20{}, m11{}, m02{}, m10{}, m01{}, m00{};
  Pair z20{}, z11{}, z02{}, z10{}, z01{}, z00{};
  for (uint32_t i = 0; i < s.count; i += 2) {
    const Pair x = LoadPair(s.x + i), y = LoadPair(s.y + i), z = LoadPair(s.z + i), w = LoadPair(s.weight + i);
    const Pair xx = x * x, xy = x * y, yy = y * y;
    const Pair wx = w * x, wy = w * y, wxx = w * xx, wxy = w * xy, wyy = w * yy;
    m40 += wxx * xx, m31 += wxx * xy, m22 += wxx * yy, m13 += wxy * yy, m04 += wyy * yy;
    m30 += wxx * x, m21 += wxx * y, m12 += wxy * y, m03 += wyy * y;
    m20 += wxx, m11 += wxy, m02 += wyy, m10 += wx, m01 += wy, m00 += w;
    z20 += wxx * z, z11 += wxy * z, z02 += wyy * z, z10 += wx * z, z01 += wy * z, z00 += w * z;
  }
  System system;
  const double xy2 = SumOf(m22), x2y = SumOf(m21), xy_y = SumOf(m12), x2 = SumOf(m20), xy1 = SumOf(m11),
               y2 = SumOf(m02);
  system.matrix[0] = {SumOf(m40)};
  system.matrix[1] = {SumOf(m31), xy2};
  system.matrix[2] = {xy2, SumOf(m13), SumOf(m04)};
  system.matrix[3] = {SumOf(m30), x2y, xy_y, x2};
  system.matrix[4] = {x2y, xy_y, SumOf(m03), xy1, y2};
  system.matrix[5] = {x2, xy1, y2, SumOf(m10), SumOf(m01), SumOf(m00)};
  system.right = {SumOf(z20), SumOf(z11), SumOf(z02), SumOf(z10), SumOf(z01), SumOf(z00)};
  return system;
}

// Solves by LDLᵀ after scaling to a unit diagonal; false when ill conditioned or not finite.
bool SolveScaled(System& s, std::array<double, kTerms>& solution) {
  std::array<double, kTerms> scale, pivot;
  for (int i = 0; i < kTerms; ++i) {
    if (!(s.matrix[i][i] > 0)) return false;
    scale[i] = 1 / std::sqrt(s.matrix[i][i]);
  }
  for (int i = 0; i < kTerms; ++i) {
    for (int j = 0; j <= i; ++j) s.matrix[i][j] *= scale[i] * scale[j];
    s.right[i] *= scale[i];
  }
  for (int i = 0; i < kTerms; ++i) {  // in place: the unit lower triangle L
    for (int j = 0; j < i; ++j) {
      for (int k = 0; k < j; ++k) s.matrix[i][j] -= s.matrix[i][k] * s.matrix[j][k] * pivot[k];
      s.matrix[i][j] /= pivot[j];
    }
    pivot[i] = s.matrix[i][i];
    for (int k = 0; k < i; ++k) pivot[i] -= s.matrix[i][k] * s.matrix[i][k] * pivot[k];
    if (!(pivot[i] > kMinPivot)) return false;
  }
  for (int i = 0; i < kTerms; ++i) {
    solution[i] = s.right[i];
    for (int k = 0; k < i; ++k) solution[i] -= s.matrix[i][k] * solution[k];
  }
  for (int i = kTerms - 1; i >= 0; --i) {
    solution[i] /= pivot[i];
    for (int k = i + 1; k < kTerms; ++k) solution[i] -= s.matrix[k][i] * solution[k];
  }
  for (int i = 0; i < kTerms; ++i) solution[i] *= scale[i];
  return true;
}

Vec3 MeanNormal(const Sources& from, const RingCollector& ring) {
  const Vec3& own = from.normals[ring.vertex(0)];
  Vec3 sum;
  for (uint32_t i = 0; i < ring.size(); ++i) {
    const Vec3& normal = from.samples[ring.vertex(i)].weighted_normal;
    if (Dot(normal, own) > 0) sum += normal;
  }
  const double length = Norm(sum);
  return length > 0 ? sum / length : own;
}

// Fills in the samples that look the way of the frame; their coordinates are divided by the radius of the ring, which is
// returned.
double CollectLocal(const Sources& from, const RingCollector& ring, LocalSamples& local) {
  const Vec3& center = from.samples[ring.vertex(0)].position;
  const Frame frame(MeanNormal(from, ring));
  local.count = 0;
  double radius2 = 0;
  for (uint32_t i = 0; i < ring.size(); ++i) {
    const Sample& sample = from.samples[ring.vertex(i)];
    const double agreement = Dot(sample.weighted_normal, frame.z);
    const Vec3 d = sample.position - center;
    radius2 = std::max(radius2, SquaredNorm(d));
    const uint32_t at = local.count;
    local.x[at] = Dot(d, frame.x), local.y[at] = Dot(d, frame.y), local.z[at] = Dot(d, frame.z);
    local.weight[at] = (ring.ring_count() + 1 - ring.ring(i)) * agreement;
    local.count += agreement > 0;
  }
  const double radius = std::sqrt(radius2), scale = radius > 0 ? 1 / radius : 0;
  for (uint32_t i = 0; i < local.count; ++i) local.x[i] *= scale, local.y[i] *= scale, local.z[i] *= scale;
  return radius;
}

// Steps 2 to 5 for the ring as it is; negative when the system is ill conditioned.
double FitRing(const Sources& from, const RingCollector& ring) {
  LocalSamples local;
  const double radius = CollectLocal(from, ring, local);
  if (local.count < kMinSamples || !(radius > 0)) return -1;
  System system = NormalEquations(local);
  std::array<double, kTerms> c;
  if (!SolveScaled(system, c)) return -1;
  const double curvature = MaxCurvatureOfQuadratic(c[0], c[1], c[2], c[3], c[4]) / radius;
  return std::isfinite(curvature) ? curvature : -1;
}

double LargestTurn(const Sources& from, uint32_t v) {
  double turn = 0;
  for (const uint32_t neighbour : from.rings.Of(v)) {
    const double length = Distance(from.samples[v].position, from.samples[neighbour].position);
    if (length > 0) turn = std::max(turn, Distance(from.normals[v], from.normals[neighbour]) / length);
  }
  return turn;
}

// 2 / (a short incident edge): the circle whose diameter is that edge. The second quartile's first edge is short even where
// triangles are long and thin (a cylinder), and does not follow a single degenerate one.
double ResolvedCurvature(const Sources& from, uint32_t v) {
  std::array<double, VertexRings::kMaxDegree> lengths2;
  const absl::Span<const uint32_t> ring = from.rings.Of(v);
  for (size_t i = 0; i < ring.size(); ++i) {
    lengths2[i] = SquaredDistance(from.samples[v].position, from.samples[ring[i]].position);
  }
  const auto chosen = lengths2.begin() + static_cast<std::ptrdiff_t>(ring.size() / 4);
  std::nth_element(lengths2.begin(), chosen, lengths2.begin() + static_cast<std::ptrdiff_t>(ring.size()));
  return *chosen > 0 ? 2 / std::sqrt(*chosen) : 0;
}

bool TurnsFar(const Sources& from, const RingCollector& ring) {
  const Vec3& own = from.normals[ring.vertex(0)];
  for (uint32_t i = 1; i < ring.size(); ++i) {
    if (Dot(from.normals[ring.vertex(i)], own) < kFarTurnCosine) return true;
  }
  return false;
}

double MaxCurvatureAt(const Sources& from, uint32_t v, RingCollector& ring) {
  if (from.rings.Of(v).empty()) return 0;
  ring.Start(v);
  double curvature = -1;
  while (curvature < 0 && ring.ring_count() < kMaxRings && ring.Grow(from.rings)) {
    if (ring.ring_count() >= kRings) curvature = FitRing(from, ring);
  }
  if (curvature < 0) curvature = LargestTurn(from, v);
  if (TurnsFar(from, ring)) curvature = std::max(curvature, kTurnShare * LargestTurn(from, v));
  return std::min(curvature, ResolvedCurvature(from, v));
}

std::vector<Sample> WeightedSamples(const TriangleMesh& mesh, absl::Span<const Vec3> normals) {
  std::vector<Sample> samples(mesh.positions.size());
  std::vector<double> areas(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    const double third = TriangleArea(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])) / 3;
    for (const VertexId v : t) areas[v.index()] += third;
  }
  for (size_t v = 0; v < samples.size(); ++v) samples[v] = {mesh.positions[v], areas[v] * normals[v]};
  return samples;
}

}  // namespace

double MaxCurvatureOfQuadratic(double a, double b, double c, double d, double e) {
  const double first_e = 1 + d * d, first_f = d * e, first_g = 1 + e * e;
  const double w = std::sqrt(1 + d * d + e * e);
  const double second_l = 2 * a / w, second_m = b / w, second_n = 2 * c / w;
  const double det = first_e * first_g - first_f * first_f;
  const double mean = (first_e * second_n - 2 * first_f * second_m + first_g * second_l) / (2 * det);
  const double gauss = (second_l * second_n - second_m * second_m) / det;
  return std::abs(mean) + std::sqrt(std::max(0.0, mean * mean - gauss));
}

absl::StatusOr<std::vector<double>> FitMaxCurvatures(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                                     absl::Span<const Vec3> normals, const Context& context) {
  MESHFRONT_ASSIGN_OR_RETURN(VertexRings rings, CreateVertexRings(mesh, adjacency, context));
  const Sources sources{WeightedSamples(mesh, normals), normals, std::move(rings)};
  std::vector<double> curvatures(mesh.positions.size());
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(curvatures.size(), kGrain, context, [&](size_t begin, size_t end) {
    RingCollector ring;
    for (size_t v = begin; v < end; ++v) curvatures[v] = MaxCurvatureAt(sources, static_cast<uint32_t>(v), ring);
  }));
  return curvatures;
}

}  // namespace meshfront
