// 1. The cell size: grown until there are at most kCellsPerFace cells, and at most kRefsPerFace meetings of faces with cells.
// 2. Each vertex's cell (PlaceCorners), and so each face's range of cells. The face's unit normal, rounded outwards to bytes, joins the
// box of each cell of the range.
// 3. A segment is cut into pieces no longer than a cell; the cells of a piece's box are asked. A box of normals is opposed when the
// least dot product of the vector with its corners is.
// Rejected: the faces themselves in the cells, instead of the tree that follows; where limits vary, small cells repeat large faces.
#include "core/surface/normal_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/geometry/triangle.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr double kCellsPerFace = 2.0, kFewestCells = 4096;
constexpr uint64_t kRefsPerFace = 24, kFewestRefs = 1 << 16;
constexpr double kUnit = 127;  // of a component
// Boxes of segments are widened by this part of a cell: more than rounding moves a hit.
constexpr double kCellSlack = 1e-6;
// Components are rounded by one, and one more covers the rounding of the normal itself.
constexpr double kOpposedInUnits = (kOpposed + 1e-9) * kUnit;

}  // namespace

NormalGrid::NormalGrid(const FaceView& mesh, size_t vertex_count, const Box3& bounds, double cell_size)
    : mesh_(mesh), vertex_count_(vertex_count), bounds_(bounds) {
  const double diagonal = bounds.Diagonal();
  const double most_cells = std::max(kCellsPerFace * mesh.face_count, kFewestCells);
  Resize(cell_size > 0 ? std::max(cell_size, 1e-4 * diagonal) : diagonal);
  const auto cell_count = [&] { return double{1} * counts_[0] * counts_[1] * counts_[2]; };
  while (cell_count() > most_cells) Resize(1.25 * cell_size_);
  while (!Fill(std::max(kRefsPerFace * mesh.face_count, kFewestRefs))) Resize(2 * cell_size_);
}

// False when the faces meet more than `most_refs` cells together.
bool NormalGrid::Fill(uint64_t most_refs) {
  Normals none;
  std::memset(&none, 127, sizeof(none));
  cells_.assign(size_t{counts_[0]} * counts_[1] * counts_[2], none);
  PlaceCorners();
  uint64_t refs = 0;
  for (uint32_t f = 0; f < mesh_.face_count; ++f) {
    const Range range = RangeOfFace(f);
    uint64_t cells = 1;
    for (int i = 0; i < 3; ++i) cells *= static_cast<uint64_t>(range.last[i] - range.first[i] + 1);
    refs += cells;
    if (refs > most_refs) return false;
    const Normals own = NormalsOf(f);
    VisitCells(range, counts_, [&](size_t cell) {
      cells_[cell] = own < cells_[cell] ? own : cells_[cell];
      return false;
    });
  }
  return true;
}

void NormalGrid::Resize(double cell_size) {
  cell_size_ = cell_size;
  per_length_ = cell_size > 0 ? 1 / cell_size : 0;
  for (int i = 0; i < 3; ++i) {
    counts_[i] = static_cast<uint32_t>((bounds_.max[i] - bounds_.min[i]) * per_length_) + 1;
  }
}

// Of one face, rounded outwards.
inline NormalGrid::Normals NormalGrid::NormalsOf(uint32_t f) const {
  const Vec3 area = AreaVector(mesh_.Corner(f, 0), mesh_.Corner(f, 1), mesh_.Corner(f, 2));
  const double length = Norm(area);
  Normals own{-128, -128, -128, 0, -128, -128, -128, 0};  // without a direction: every one
  if (!(length > 0 && std::isfinite(1 / length))) return own;
  for (int i = 0; i < 3; ++i) {
    const int component = static_cast<int>(area[i] * (kUnit / length));  // towards zero
    own[i] = static_cast<int8_t>(std::max(component - 1, -128));
    own[4 + i] = static_cast<int8_t>(std::max(-component - 1, -128));
  }
  return own;
}

// Monotone in each coordinate, so that a point of a box lies in a cell of the box's range.
inline NormalGrid::Range NormalGrid::RangeOf(const Vec3& min, const Vec3& max) const {
  const auto cell = [&](double x, double lowest, uint32_t count) {
    return static_cast<int>(std::max(0.0, std::min((x - lowest) * per_length_, count - 1.0)));
  };
  const Vec3& low = bounds_.min;
  return {{cell(min.x, low.x, counts_[0]), cell(min.y, low.y, counts_[1]), cell(min.z, low.z, counts_[2])},
          {cell(max.x, low.x, counts_[0]), cell(max.y, low.y, counts_[1]), cell(max.z, low.z, counts_[2])}};
}

inline NormalGrid::Range NormalGrid::RangeOfFace(uint32_t f) const {
  const Corner &a = corners_[mesh_.triangles[f][0].index()], &b = corners_[mesh_.triangles[f][1].index()],
               &c = corners_[mesh_.triangles[f][2].index()];
  const Corner ab = a < b ? a : b, least = ab < c ? ab : c;
  return {{least[0], least[1], least[2]}, {-least[4], -least[5], -least[6]}};
}

void NormalGrid::PlaceCorners() {
  corners_.resize(vertex_count_);
  for (size_t v = 0; v < vertex_count_; ++v) {
    const std::array<int, 3> cell = RangeOf(mesh_.positions[v], mesh_.positions[v]).first;
    for (int i = 0; i < 3; ++i) {
      corners_[v][i] = static_cast<int16_t>(cell[i]);
      corners_[v][4 + i] = static_cast<int16_t>(-cell[i]);
    }
  }
}

template <class Visit>
bool NormalGrid::VisitCells(const Range& range, const std::array<uint32_t, 3>& counts, Visit&& visit) {
  for (int z = range.first[2]; z <= range.last[2]; ++z) {
    for (int y = range.first[1]; y <= range.last[1]; ++y) {
      const size_t row = (static_cast<size_t>(z) * counts[1] + y) * counts[0];
      for (int x = range.first[0]; x <= range.last[0]; ++x) {
        if (visit(row + x)) return true;
      }
    }
  }
  return false;
}

template <class Visit>
bool NormalGrid::VisitSegment(const Vec3& from, const Vec3& to, Visit&& visit) const {
  const int pieces = 1 + static_cast<int>(Distance(from, to) * per_length_);
  const Vec3 step = (1.0 / pieces) * (to - from);
  const double slack = kCellSlack * cell_size_;
  const Vec3 widen{slack, slack, slack};
  for (int i = 0; i < pieces; ++i) {
    const Vec3 a = from + i * step, b = from + (i + 1) * step;
    if (VisitCells(RangeOf(Min(a, b) - widen, Max(a, b) + widen), counts_, visit)) return true;
  }
  return false;
}

// The least dot product of a vector with the normals of a box: which bytes count, and how much.
class NormalGrid::Opposition {
 public:
  explicit Opposition(const Vec3& normal)
      : x_(normal.x > 0 ? 0 : 4),
        y_(normal.y > 0 ? 1 : 5),
        z_(normal.z > 0 ? 2 : 6),
        weights_{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)} {}
  bool MayBeIn(const Normals& cell) const {
    return weights_.x * cell[x_] + weights_.y * cell[y_] + weights_.z * cell[z_] < kOpposedInUnits;
  }

 private:
  int x_, y_, z_;
  Vec3 weights_;
};

bool NormalGrid::MayMeetOpposed(const Vec3& from, const Vec3& to, const Vec3& normal) const {
  const Opposition opposition(normal);
  return VisitSegment(from, to, [&](size_t cell) { return opposition.MayBeIn(cells_[cell]); });
}

void NormalGrid::MarkOpposed(const Vec3& from, const Vec3& to, const Vec3& normal) {
  marked_.resize(cells_.size(), 0);
  const Opposition opposition(normal);
  VisitSegment(from, to, [&](size_t cell) {
    marked_[cell] |= opposition.MayBeIn(cells_[cell]);
    return false;
  });
}

std::vector<uint32_t> NormalGrid::FacesInMarked() const {
  std::vector<uint32_t> faces;
  if (marked_.empty()) return faces;
  for (uint32_t f = 0; f < mesh_.face_count; ++f) {
    if (VisitCells(RangeOfFace(f), counts_, [&](size_t cell) { return marked_[cell] != 0; })) faces.push_back(f);
  }
  return faces;
}

}  // namespace meshfront
