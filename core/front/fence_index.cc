#include "core/front/fence_index.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/front/tolerances.h"
#include "core/guidance/sizing.h"

namespace meshfront {
namespace {

using namespace front_tolerances;

constexpr double kCellPerLevel = 8.0;  // cell size in multiples of 2^level; coarse cells win (few empty look-ups)
constexpr int kLevelOffset = 1080;     // exponent -1074 and below becomes level >= 0

double CellSize(int level) { return std::ldexp(kCellPerLevel, level - kLevelOffset); }

int64_t CellCoordinate(double x, double size) {
  return static_cast<int64_t>(std::floor(std::clamp(x / size, -1e15, 1e15)));
}

}  // namespace

double FenceHalfHeight(double length, double max_curvature) {
  return std::max(kFenceHeightPerError * ErrorBound(length, max_curvature), kMinFenceHeightPerLength * length);
}

bool CrossesFence(const NewEdge& edge, const Fence& fence) {
  if (Dot(edge.normal, fence.normal) < kOtherSheetCosine) return false;
  const Vec3 m = edge.normal + fence.normal;  // its length does not matter: only signs and ratios are used
  const Vec3 d = edge.end - edge.start, f = fence.end - fence.start;
  const Vec3 md = Cross(m, d), mf = Cross(m, f);
  const double start_side = Dot(md, fence.start - edge.start), end_side = Dot(md, fence.end - edge.start);
  if ((start_side > 0) == (end_side > 0)) return false;
  const double from_side = Dot(mf, edge.start - fence.start), to_side = Dot(mf, edge.end - fence.start);
  if ((from_side > 0) == (to_side > 0)) return false;
  const double s = from_side / (from_side - to_side), t = start_side / (start_side - end_side);
  const Vec3 gap = edge.start + s * d - (fence.start + t * f);
  const double height = std::max(edge.half_height, fence.half_height);
  return SquaredNorm(gap) <= height * height;
}

double DistanceToFence(const Vec3& p, const Vec3& normal, const Fence& fence) {
  if (Dot(normal, fence.normal) < kOtherSheetCosine) return std::numeric_limits<double>::infinity();
  const Vec3 f = fence.end - fence.start, w = p - fence.start;
  const double t = std::clamp(Dot(w, f) / SquaredNorm(f), 0.0, 1.0);
  return Norm(w - t * f);
}

double ClockwiseTurn(const Vec3& normal, const Vec3& from, const Vec3& to) {
  const double x = Dot(from, to) - Dot(from, normal) * Dot(to, normal);
  const double y = Dot(normal, Cross(to, from));
  const double sum = std::abs(x) + std::abs(y);
  if (sum == 0) return 0;
  if (y >= 0) return x >= 0 ? y / sum : 1 - x / sum;
  const double turn = x < 0 ? 2 - y / sum : 3 + x / sum;
  return turn < 4 ? turn : 0;
}

FenceIndex::FenceIndex(const FrontSet& fronts) : fronts_(&fronts), buckets_(1024, kNone), members_(kLevels) {}

uint64_t FenceIndex::CellOf(int level, int64_t x, int64_t y, int64_t z) const {
  uint64_t h = static_cast<uint64_t>(x) * 0x9e3779b97f4a7c15ull;
  h = (h ^ (h >> 29)) + static_cast<uint64_t>(y) * 0xbf58476d1ce4e5b9ull;
  h = (h ^ (h >> 31)) + static_cast<uint64_t>(z) * 0x94d049bb133111ebull;
  h = (h ^ (h >> 30)) + static_cast<uint64_t>(level) * 0xd6e8feb86659fd93ull;
  return (h ^ (h >> 32)) * 0x2545f4914f6cdd1dull >> 3;
}

void FenceIndex::LinkSlot(uint32_t slot) {
  uint32_t& head = Bucket(slots_[slot].cell);
  slots_[slot].prev = kNone;
  slots_[slot].next = head;
  if (head != kNone) slots_[head].prev = slot;
  head = slot;
}

void FenceIndex::Rehash() {
  buckets_.assign(2 * buckets_.size(), kNone);
  for (uint32_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].level >= 0) LinkSlot(i);
  }
}

void FenceIndex::Insert(FrontEdgeId edge) {
  if (slots_.size() <= edge.index()) {
    slots_.resize(std::max<size_t>(edge.index() + 1, 2 * slots_.size()));
    fences_.resize(slots_.size());
  }
  Slot& s = slots_[edge.index()];
  const WindowVertexId from = fronts_->From(edge), to = fronts_->To(edge);
  const WindowVertex &a = fronts_->at(from), &b = fronts_->at(to);
  const double length = Distance(a.position, b.position);
  fences_[edge.index()] = {edge,
                           fronts_->IdentityOf(from),
                           fronts_->IdentityOf(to),
                           a.sheet,
                           a.position,
                           b.position,
                           Normalized(a.source.normal + b.source.normal),
                           FenceHalfHeight(length, std::max(a.max_curvature, b.max_curvature))};
  s.middle = 0.5 * (a.position + b.position);
  s.half_length = 0.5 * length;
  // ilogb of an infinite length is the largest int.
  s.level = std::clamp(length > 0 ? std::min(std::ilogb(length), kLevels) + kLevelOffset : 0, 0, kLevels - 1);
  const double size = CellSize(s.level);
  s.cell = CellOf(s.level, CellCoordinate(s.middle.x, size), CellCoordinate(s.middle.y, size),
                  CellCoordinate(s.middle.z, size));
  if (members_[s.level].empty()) {
    levels_in_use_.insert(std::lower_bound(levels_in_use_.begin(), levels_in_use_.end(), s.level), s.level);
  }
  s.place = static_cast<uint32_t>(members_[s.level].size());
  members_[s.level].push_back(edge.index());
  if (++count_ > buckets_.size())
    Rehash();
  else
    LinkSlot(edge.index());
}

void FenceIndex::Erase(FrontEdgeId edge) {
  if (edge.index() >= slots_.size()) return;
  Slot& s = slots_[edge.index()];
  if (s.level < 0) return;
  if (s.prev != kNone)
    slots_[s.prev].next = s.next;
  else
    Bucket(s.cell) = s.next;
  if (s.next != kNone) slots_[s.next].prev = s.prev;
  --count_;
  std::vector<uint32_t>& members = members_[s.level];
  slots_[members.back()].place = s.place;
  members[s.place] = members.back();
  members.pop_back();
  if (members.empty()) {
    levels_in_use_.erase(std::lower_bound(levels_in_use_.begin(), levels_in_use_.end(), s.level));
  }
  s.level = -1;
}

void FenceIndex::Query(const Vec3& center, double radius, std::vector<FrontEdgeId>& found) const {
  for (const int level : levels_in_use_) {
    const double size = CellSize(level), reach = radius + size / kCellPerLevel;
    int64_t low[3], high[3];
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = CellCoordinate(center[axis] - reach, size);
      high[axis] = CellCoordinate(center[axis] + reach, size);
      cells *= static_cast<double>(high[axis] - low[axis] + 1);
    }
    const auto consider = [&](uint32_t i) {
      const double r = radius + slots_[i].half_length;
      if (SquaredDistance(slots_[i].middle, center) <= r * r) found.push_back(FrontEdgeId(i));
    };
    if (cells >= static_cast<double>(members_[level].size())) {
      for (const uint32_t i : members_[level]) consider(i);
      continue;
    }
    for (int64_t x = low[0]; x <= high[0]; ++x) {
      for (int64_t y = low[1]; y <= high[1]; ++y) {
        for (int64_t z = low[2]; z <= high[2]; ++z) {
          const uint64_t cell = CellOf(level, x, y, z);
          for (uint32_t i = buckets_[cell & (buckets_.size() - 1)]; i != kNone; i = slots_[i].next) {
            if (slots_[i].cell == cell && slots_[i].level == level) consider(i);
          }
        }
      }
    }
  }
}

}  // namespace meshfront
