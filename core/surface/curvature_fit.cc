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
#include <memory>
#include <mutex>
#include <utility>

#include "core/base/processor.h"
#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/surface/vertex_normals.h"
#include "core/surface/vertex_rings.h"

namespace meshfront {
namespace {

constexpr size_t kGrain = 512;
// Where the rings turn this far, a ridge is narrower than they are and the fit averages it away (the rim of the bunny's ear: the fit
// says 172, the turn to a neighbour 330). Then at least this share of the largest turn of the normal per length counts; all of
// it, or everywhere, would follow noise.
constexpr double kFarTurnCosine = 0.3;
constexpr double kTurnShare = 0.55;
constexpr int kRings = 3;      // sec. 3.2
constexpr int kMostRings = 6;  // grown to while ill conditioned
constexpr int kTerms = 6;      // x², xy, y², x, y, 1
constexpr uint32_t kMinSamples = 7;
// Of the scaled system (unit diagonal): a pivot below this says that some term is not determined.
constexpr double kMinPivot = 1e-5;

// A vertex from which the normal turns by less than this angle (5°) to all around it, which are so many and so even, takes the mean of
// those among them that were fitted, if that is at least this share of the largest turn per length: fits look three edges far, and change
// little over one, but not where something small begins that is bent more.
constexpr double kAlikeShare = 0.4;
constexpr double kSmoothCosine = 0.9965, kMostUneven = 3;
constexpr size_t kFewestAround = 5, kMostAround = 8;

// Four doubles at a time; a vector type of the compiler, since it may not reorder sums of doubles by itself. Each lane rounds as a
// scalar does, so that the processor's width changes no bit.
typedef double Quad __attribute__((vector_size(32)));
constexpr uint32_t kLanes = 4;
inline double SumOf(const Quad& q) { return (q[0] + q[1]) + (q[2] + q[3]); }
inline double MaxOf(const Quad& q) { return std::max(std::max(q[0], q[1]), std::max(q[2], q[3])); }

// What the fit reads of a vertex, in one cache line: its place p, a third of the area A of the faces around it, and the unit normal
// times that, n.
struct alignas(64) Sample {
  Quad first;   // p.x, p.y, p.z, n.x
  Quad second;  // n.y, n.z, A, 0
};

struct Sources {
  std::vector<Sample> samples;
  absl::Span<const Vec3> positions;
  absl::Span<const Vec3> normals;
  const VertexRings& rings;
  const FaceAdjacency& adjacency;
  const LeastLengths& least;

  double LeastLengthAt(uint32_t v) const {
    return least.label.empty() ? 0 : least.of_component[least.label[FaceOfHalfEdge(adjacency.outgoing[v])]];
  }
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

// A ring's samples, one array each, filled up to whole quads with samples without weight.
struct RingSamples {
  static constexpr uint32_t kQuads = RingCollector::kCapacity / kLanes;
  Quad x[kQuads], y[kQuads], z[kQuads];  // from the centre; after Project in the frame
  Quad normal_x[kQuads], normal_y[kQuads], normal_z[kQuads];
  Quad weight[kQuads];  // by ring; after Project times the agreement with the frame
  uint32_t quads = 0;
  bool turns_far = false;  // some normal from that at the centre
};

void SetWeights(const RingCollector& ring, RingSamples& s) {
  double* const weights = reinterpret_cast<double*>(s.weight);
  for (int i = 0; i <= ring.ring_count(); ++i) {
    std::fill(weights + ring.begin(i), weights + ring.begin(i + 1), ring.ring_count() + 1.0 - i);
  }
  s.quads = (ring.size() + kLanes - 1) / kLanes;
  std::fill(weights + ring.size(), weights + kLanes * s.quads, 0.0);
}

// Fills in all but the weights; returns the sum of the weighted normals that agree with `own`. Also looks whether the ring turns far.
MESHFRONT_WIDE Vec3 Gather(const Sources& from, const RingCollector& ring, const Vec3& own, RingSamples& s) {
  const Sample* const samples = from.samples.data();
  const Quad center = samples[ring.vertex(0)].first;
  Quad sum_x{}, sum_y{}, sum_z{};
  decltype(sum_x < sum_y) far{};
  for (uint32_t i = 0; i < s.quads; ++i) {
    const std::array<uint32_t, kLanes> v = ring.FourFrom(kLanes * i);
    const Sample &a = samples[v[0]], &b = samples[v[1]], &c = samples[v[2]], &d = samples[v[3]];
    // Four by four, turned: lanes of pairs, then pairs of lanes.
    const Quad ab_even = __builtin_shufflevector(a.first, b.first, 0, 4, 2, 6);
    const Quad ab_odd = __builtin_shufflevector(a.first, b.first, 1, 5, 3, 7);
    const Quad cd_even = __builtin_shufflevector(c.first, d.first, 0, 4, 2, 6);
    const Quad cd_odd = __builtin_shufflevector(c.first, d.first, 1, 5, 3, 7);
    s.x[i] = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5) - center[0];
    s.y[i] = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5) - center[1];
    s.z[i] = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7) - center[2];
    const Quad nx = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
    const Quad ab_y_area = __builtin_shufflevector(a.second, b.second, 0, 4, 2, 6);
    const Quad cd_y_area = __builtin_shufflevector(c.second, d.second, 0, 4, 2, 6);
    const Quad ny = __builtin_shufflevector(ab_y_area, cd_y_area, 0, 1, 4, 5);
    const Quad area = __builtin_shufflevector(ab_y_area, cd_y_area, 2, 3, 6, 7);
    const Quad ab_z = __builtin_shufflevector(a.second, b.second, 1, 5, 3, 7);
    const Quad cd_z = __builtin_shufflevector(c.second, d.second, 1, 5, 3, 7);
    const Quad nz = __builtin_shufflevector(ab_z, cd_z, 0, 1, 4, 5);
    s.normal_x[i] = nx, s.normal_y[i] = ny, s.normal_z[i] = nz;
    const Quad along = nx * own.x + ny * own.y + nz * own.z;
    const auto agrees = (along > 0) & (s.weight[i] > 0);
    far |= along < kFarTurnCosine * area;
    sum_x += agrees ? nx : Quad{};
    sum_y += agrees ? ny : Quad{};
    sum_z += agrees ? nz : Quad{};
  }
  s.turns_far = (far[0] | far[1] | far[2] | far[3]) != 0;
  return {SumOf(sum_x), SumOf(sum_y), SumOf(sum_z)};
}

struct Projection {
  double squared_radius;
  double looking_up;  // how many samples have a weight
};

// Turns the samples into the frame; those that do not look its way get no weight.
MESHFRONT_WIDE Projection Project(const Frame& frame, RingSamples& s) {
  Quad radius2{}, looking_up{};
  for (uint32_t i = 0; i < s.quads; ++i) {
    const Quad x = s.x[i], y = s.y[i], z = s.z[i];
    const Quad agreement = s.normal_x[i] * frame.z.x + s.normal_y[i] * frame.z.y + s.normal_z[i] * frame.z.z;
    const Quad d2 = x * x + y * y + z * z;
    radius2 = d2 > radius2 ? d2 : radius2;
    const Quad weight = s.weight[i] * (agreement > 0 ? agreement : Quad{});
    looking_up += weight > 0 ? Quad{1, 1, 1, 1} : Quad{};
    s.weight[i] = weight;
    s.x[i] = x * frame.x.x + y * frame.x.y + z * frame.x.z;
    s.y[i] = x * frame.y.x + y * frame.y.y + z * frame.y.z;
    s.z[i] = x * frame.z.x + y * frame.z.y + z * frame.z.z;
  }
  return {MaxOf(radius2), SumOf(looking_up)};
}

// The normal equations of the samples times `scale`, from the 15 moments of the weights up to x⁴, x³y, … and the 6 with z.
MESHFRONT_WIDE void FormNormalEquations(const RingSamples& s, double scale, System& system) {
  Quad m40{}, m31{}, m22{}, m13{}, m04{}, m30{}, m21{}, m12{}, m03{}, m20{}, m11{}, m02{}, m10{}, m01{}, m00{};
  Quad z20{}, z11{}, z02{}, z10{}, z01{}, z00{};
  for (uint32_t i = 0; i < s.quads; ++i) {
    const Quad x = scale * s.x[i], y = scale * s.y[i], z = scale * s.z[i], w = s.weight[i];
    const Quad xx = x * x, xy = x * y, yy = y * y;
    const Quad wx = w * x, wy = w * y, wxx = w * xx, wxy = w * xy, wyy = w * yy;
    m40 += wxx * xx, m31 += wxx * xy, m22 += wxx * yy, m13 += wxy * yy, m04 += wyy * yy;
    m30 += wxx * x, m21 += wxx * y, m12 += wxy * y, m03 += wyy * y;
    m20 += wxx, m11 += wxy, m02 += wyy, m10 += wx, m01 += wy, m00 += w;
    z20 += wxx * z, z11 += wxy * z, z02 += wyy * z, z10 += wx * z, z01 += wy * z, z00 += w * z;
  }
  const double xy2 = SumOf(m22), x2y = SumOf(m21), xy_y = SumOf(m12), x2 = SumOf(m20), xy1 = SumOf(m11),
               y2 = SumOf(m02);
  system.matrix[0] = {SumOf(m40)};
  system.matrix[1] = {SumOf(m31), xy2};
  system.matrix[2] = {xy2, SumOf(m13), SumOf(m04)};
  system.matrix[3] = {SumOf(m30), x2y, xy_y, x2};
  system.matrix[4] = {x2y, xy_y, SumOf(m03), xy1, y2};
  system.matrix[5] = {x2, xy1, y2, SumOf(m10), SumOf(m01), SumOf(m00)};
  system.right = {SumOf(z20), SumOf(z11), SumOf(z02), SumOf(z10), SumOf(z01), SumOf(z00)};
}

// Solves by LDLᵀ after scaling to a unit diagonal; false when ill conditioned or not finite.
bool SolveScaled(System& s, std::array<double, kTerms>& solution) {
  std::array<double, kTerms> scale, pivot, per_pivot;
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
      s.matrix[i][j] *= per_pivot[j];
    }
    pivot[i] = s.matrix[i][i];
    for (int k = 0; k < i; ++k) pivot[i] -= s.matrix[i][k] * s.matrix[i][k] * pivot[k];
    if (!(pivot[i] > kMinPivot)) return false;
    per_pivot[i] = 1 / pivot[i];
  }
  for (int i = 0; i < kTerms; ++i) {
    solution[i] = s.right[i];
    for (int k = 0; k < i; ++k) solution[i] -= s.matrix[i][k] * solution[k];
  }
  for (int i = kTerms - 1; i >= 0; --i) {
    solution[i] *= per_pivot[i];
    for (int k = i + 1; k < kTerms; ++k) solution[i] -= s.matrix[k][i] * solution[k];
  }
  for (int i = 0; i < kTerms; ++i) solution[i] *= scale[i];
  return true;
}

// Steps 2 to 5 for the ring as it is; negative when the system is ill conditioned.
double FitRing(const Sources& from, const RingCollector& ring, RingSamples& samples) {
  const Vec3& own_normal = from.normals[ring.vertex(0)];
  SetWeights(ring, samples);
  const Vec3 sum = Gather(from, ring, own_normal, samples);
  const double length = Norm(sum);
  const Projection projection = Project(Frame(length > 0 ? sum / length : own_normal), samples);
  const double radius = std::sqrt(projection.squared_radius);
  if (projection.looking_up < kMinSamples || !(radius > 0)) return -1;
  System system;
  FormNormalEquations(samples, 1 / radius, system);
  std::array<double, kTerms> c;
  if (!SolveScaled(system, c)) return -1;
  const double curvature = MaxCurvatureOfQuadratic(c[0], c[1], c[2], c[3], c[4]) / radius;
  return std::isfinite(curvature) ? curvature : -1;
}

double LargestTurn(const Sources& from, uint32_t v) {
  double turn = 0;
  const double least = from.LeastLengthAt(v);
  for (const uint32_t neighbour : from.rings.Of(v)) {
    const double length = std::max(least, Distance(from.positions[v], from.positions[neighbour]));
    if (length > 0) turn = std::max(turn, Distance(from.normals[v], from.normals[neighbour]) / length);
  }
  return turn;
}

// Squared length of a short edge around a vertex: the second quartile's first. `kKept` = neighbours / 4 + 1.
template <size_t kKept>
double ShortSquaredEdge(const Sources& from, uint32_t v) {
  double shortest2[kKept];  // in order
  std::fill_n(shortest2, kKept, INFINITY);
  const Vec3 center = from.positions[v];
  for (const uint32_t neighbour : from.rings.Of(v)) {
    double length2 = SquaredDistance(center, from.positions[neighbour]);
    for (size_t i = 0; i < kKept; ++i) {
      const double longer = std::max(shortest2[i], length2);
      shortest2[i] = std::min(shortest2[i], length2);
      length2 = longer;
    }
  }
  return shortest2[kKept - 1];
}
double ShortSquaredEdge(const Sources& from, uint32_t v) {
  static_assert(VertexRings::kMaxDegree == 32);
  switch (from.rings.Of(v).size() / 4) {
    case 0:
      return ShortSquaredEdge<1>(from, v);
    case 1:
      return ShortSquaredEdge<2>(from, v);
    case 2:
      return ShortSquaredEdge<3>(from, v);
    case 3:
      return ShortSquaredEdge<4>(from, v);
    case 4:
      return ShortSquaredEdge<5>(from, v);
    case 5:
      return ShortSquaredEdge<6>(from, v);
    case 6:
      return ShortSquaredEdge<7>(from, v);
    case 7:
      return ShortSquaredEdge<8>(from, v);
    default:
      return ShortSquaredEdge<9>(from, v);
  }
}

// 2 / (a short incident edge): the circle whose diameter is that edge. The second quartile's first edge is short even where
// triangles are long and thin (a cylinder), and does not follow a single degenerate one.
double ResolvedCurvature(const Sources& from, uint32_t v) {
  const double shortest2 = ShortSquaredEdge(from, v);
  return shortest2 > 0 ? 2 / std::max(std::sqrt(shortest2), from.LeastLengthAt(v)) : 0;
}

double MaxCurvatureAt(const Sources& from, uint32_t v, RingCollector& ring, RingSamples& samples) {
  if (from.rings.Of(v).empty()) return 0;
  ring.Start(v);
  double curvature = -1;
  while (curvature < 0 && ring.ring_count() < kMostRings && ring.Grow(from.rings)) {
    if (ring.ring_count() >= kRings) curvature = FitRing(from, ring, samples);
  }
  if (curvature < 0) return std::min(LargestTurn(from, v), ResolvedCurvature(from, v));
  if (samples.turns_far) curvature = std::max(curvature, kTurnShare * LargestTurn(from, v));
  return std::min(curvature, ResolvedCurvature(from, v));
}

// One collector a thread, handed from block to block.
class CollectorPool {
 public:
  explicit CollectorPool(size_t vertex_count) : vertex_count_(vertex_count) {}

  std::unique_ptr<RingCollector> Take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<RingCollector>(vertex_count_);
    std::unique_ptr<RingCollector> last = std::move(free_.back());
    free_.pop_back();
    return last;
  }
  void GiveBack(std::unique_ptr<RingCollector> collector) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(collector));
  }

 private:
  const size_t vertex_count_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<RingCollector>> free_;
};

std::vector<Sample> WeightedSamples(const TriangleMesh& mesh, absl::Span<const Vec3> normals,
                                    absl::Span<const double> areas) {
  std::vector<Sample> samples(mesh.positions.size());
  for (size_t v = 0; v < samples.size(); ++v) {
    const Vec3& p = mesh.positions[v];
    const Vec3 n = areas[v] * normals[v];
    samples[v].first = Quad{p.x, p.y, p.z, n.x};
    samples[v].second = Quad{n.y, n.z, areas[v], 0};
  }
  return samples;
}

// Where a vertex has its curvature from.
enum class Source : uint8_t { kNone, kFit, kNeighbours };

// Whether the surface hardly turns from a vertex to those around it, which lie about evenly.
bool IsSmoothAround(const Sources& from, uint32_t v) {
  const absl::Span<const uint32_t> ring = from.rings.Of(v);
  if (ring.size() < kFewestAround || ring.size() > kMostAround || from.adjacency.IsRimVertex(v)) return false;
  double least_cosine = 1, shortest2 = INFINITY, longest2 = 0;
  for (const uint32_t u : ring) {
    least_cosine = std::min(least_cosine, Dot(from.normals[v], from.normals[u]));
    const double length2 = SquaredDistance(from.positions[v], from.positions[u]);
    shortest2 = std::min(shortest2, length2), longest2 = std::max(longest2, length2);
  }
  return least_cosine >= kSmoothCosine && longest2 <= kMostUneven * kMostUneven * shortest2;
}

// Greedily in the order of the vertices, so that it depends on the mesh alone.
std::vector<Source> ChooseSources(const Sources& from, const std::vector<bool>& wanted) {
  std::vector<Source> source_of(from.positions.size(), Source::kNone);
  for (uint32_t v = 0; v < source_of.size(); ++v) {
    if (!wanted.empty() && !wanted[v]) continue;
    bool has_fit = false;
    for (const uint32_t u : from.rings.Of(v)) has_fit |= source_of[u] == Source::kFit;
    source_of[v] = has_fit && IsSmoothAround(from, v) ? Source::kNeighbours : Source::kFit;
  }
  return source_of;
}

// Of the normal, by the square of the length over which it does.
double LargestSquaredTurn(const Sources& from, uint32_t v) {
  double largest = 0;
  const double least = from.LeastLengthAt(v), least2 = least * least;
  for (const uint32_t u : from.rings.Of(v)) {
    const double length2 = std::max(least2, SquaredDistance(from.positions[v], from.positions[u]));
    largest = std::max(largest, SquaredDistance(from.normals[v], from.normals[u]) / length2);
  }
  return largest;
}

double MeanOfFits(absl::Span<const uint32_t> ring, absl::Span<const double> curvatures,
                  absl::Span<const Source> source_of) {
  double sum = 0, count = 0;
  for (const uint32_t u : ring) {
    if (source_of[u] == Source::kFit) sum += curvatures[u], count += 1;  // others are being written
  }
  return sum / count;
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
                                                     absl::Span<const Vec3> normals, const Context& context,
                                                     const LeastLengths& least, const std::vector<bool>& wanted) {
  MESHFRONT_ASSIGN_OR_RETURN(const VertexRings rings, CreateVertexRings(mesh, adjacency, context));
  return FitMaxCurvatures(mesh, adjacency, rings, normals, ComputeVertexAreas(mesh), context, least, wanted);
}

absl::StatusOr<std::vector<double>> FitMaxCurvatures(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                                     const VertexRings& rings, absl::Span<const Vec3> normals,
                                                     absl::Span<const double> areas, const Context& context,
                                                     const LeastLengths& least, const std::vector<bool>& wanted) {
  const Sources sources{WeightedSamples(mesh, normals, areas), mesh.positions, normals, rings, adjacency, least};
  std::vector<double> curvatures(mesh.positions.size());
  const std::vector<Source> source_of = ChooseSources(sources, wanted);
  CollectorPool collectors(mesh.positions.size());
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(curvatures.size(), kGrain, context, [&](size_t begin, size_t end) {
    std::unique_ptr<RingCollector> ring = collectors.Take();
    RingSamples samples;
    for (size_t v = begin; v < end; ++v) {
      if (source_of[v] == Source::kFit)
        curvatures[v] = MaxCurvatureAt(sources, static_cast<uint32_t>(v), *ring, samples);
    }
    collectors.GiveBack(std::move(ring));
  }));
  // Of fits alone, which stay as they are.
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(curvatures.size(), kGrain, context, [&](size_t begin, size_t end) {
    std::unique_ptr<RingCollector> ring = collectors.Take();
    RingSamples samples;
    for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
      if (source_of[v] != Source::kNeighbours) continue;
      const double mean = MeanOfFits(rings.Of(v), curvatures, source_of);
      const bool is_alike = mean * mean >= kAlikeShare * kAlikeShare * LargestSquaredTurn(sources, v);
      curvatures[v] = is_alike ? mean : MaxCurvatureAt(sources, v, *ring, samples);
    }
    collectors.GiveBack(std::move(ring));
  }));
  return curvatures;
}

}  // namespace meshfront
