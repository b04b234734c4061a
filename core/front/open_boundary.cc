// A front that touches neither rim nor crease is a loop of its own. What is left of the edges is as many loops as it has connected
// parts.
#include "core/front/open_boundary.h"

#include <algorithm>
#include <map>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

class BoundaryMeter {
 public:
  explicit BoundaryMeter(const FrontSet& fronts) : fronts_(fronts) {}

  OpenBoundary Run(absl::Span<const RimEdge> rims) {
    for (const std::vector<FrontEdgeId>& loop : OpenLoops(fronts_)) AddLoop(loop);
    for (const RimEdge& rim : rims) {
      if (!bare_.contains(rim)) Join(rim.first, rim.second);
    }
    for (const auto& [u, v] : fronts_.BareCreases()) Join(FrontSet::IdentityOfJoint(u), FrontSet::IdentityOfJoint(v));
    measured_.loops += CountParts();
    measured_.edges += joined_.size();
    measured_.pinched_vertices = static_cast<uint64_t>(
        std::count_if(ends_.begin(), ends_.end(), [](const auto& end) { return end.second > 2; }));
    return measured_;
  }

 private:
  // Vertices inside a patch get names that no vertex on a rim had before them.
  uint64_t NameOf(WindowVertexId v) const {
    const bool is_inner = !fronts_.at(v).on_rim;
    return uint64_t{fronts_.IdentityOf(v)} | uint64_t{is_inner} << 32;
  }
  void CountEnds(uint64_t from, uint64_t to) { ++ends_[from], ++ends_[to]; }
  void Join(uint64_t from, uint64_t to) {
    joined_.push_back({from, to});
    CountEnds(from, to);
  }
  void AddLoop(const std::vector<FrontEdgeId>& loop);
  uint64_t CountParts() const;

  const FrontSet& fronts_;
  OpenBoundary measured_;
  std::vector<std::pair<uint64_t, uint64_t>> joined_;  // edges whose loops are not known yet
  absl::flat_hash_set<RimEdge> bare_;                  // edges of rims without a triangle
  std::map<uint64_t, int> ends_;                       // of the boundary's edges at each vertex
};

void BoundaryMeter::AddLoop(const std::vector<FrontEdgeId>& loop) {
  const bool is_apart = std::none_of(loop.begin(), loop.end(), [&](FrontEdgeId e) {
    return fronts_.at(e).owner.is_rim() || fronts_.at(fronts_.From(e)).joint != kNoJoint;
  });
  measured_.loops += is_apart;
  for (const FrontEdgeId e : loop) {
    const WindowVertexId from = fronts_.From(e), to = fronts_.To(e);
    if (is_apart)
      CountEnds(NameOf(from), NameOf(to)), ++measured_.edges;
    else if (fronts_.at(e).owner.is_rim())
      bare_.insert({fronts_.IdentityOf(from), fronts_.IdentityOf(to)});
    else
      Join(NameOf(from), NameOf(to));
  }
}

uint64_t BoundaryMeter::CountParts() const {
  absl::flat_hash_map<uint64_t, uint32_t> places;
  const auto place_of = [&](uint64_t name) {
    return places.try_emplace(name, static_cast<uint32_t>(places.size())).first->second;
  };
  UnionFind parts(2 * joined_.size());
  uint64_t united = 0;
  for (const auto& [from, to] : joined_) {
    const uint32_t u = place_of(from), v = place_of(to);
    united += parts.Unite(u, v);
  }
  return places.size() - united;
}

}  // namespace

std::vector<std::vector<FrontEdgeId>> OpenLoops(const FrontSet& fronts) {
  std::vector<std::vector<FrontEdgeId>> loops;
  std::vector<bool> seen(fronts.edge_slots(), false);
  for (uint32_t i = 0; i < seen.size(); ++i) {
    if (seen[i] || !fronts.at(FrontEdgeId(i)).alive) continue;
    loops.push_back(fronts.LoopOf(FrontEdgeId(i)));
    for (const FrontEdgeId e : loops.back()) seen[e.index()] = true;
  }
  return loops;
}

OpenBoundary MeasureBoundary(const FrontSet& fronts, absl::Span<const RimEdge> rims) {
  return BoundaryMeter(fronts).Run(rims);
}

}  // namespace meshfront
