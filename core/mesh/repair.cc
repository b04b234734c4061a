// From whatever came in to an oriented manifold:
//
// 1. IsClean: most meshes are; they pass untouched.
// 2. RepairPass, until it finds nothing more: faces without a usable position go (DropUnusable); spikes are moved
//    (MoveSpikes); the corners of a soup, and rims, that almost meet are made to (SnapSoup, SnapRims); needles and loose caps go
//    (DropNeedlesAndLooseCaps), duplicates go (DropDuplicates); the rest is paired edge by edge, oriented, welded and
//    given one vertex a fan (MakeOrientedManifold); caps inside are turned (FlipCaps); closed components that face
//    inwards are reversed (TurnOutwards).
// 3. DropUnreferencedVertices.
// Rejected: one pass; what a dropped face opens may let others be joined.
#include "core/mesh/repair.h"

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/mesh/mesh_edits.h"
#include "core/mesh/repair_degenerate.h"
#include "core/mesh/repair_outside.h"
#include "core/mesh/repair_pairing.h"
#include "core/mesh/repair_snap.h"
#include "core/mesh/repair_spikes.h"
#include "core/mesh/repair_survey.h"
#include "core/mesh/tolerances.h"

namespace meshfront {
namespace {

constexpr int kMostPasses = 8;

class ActionCounts {
 public:
  // True when there was something to count.
  bool Add(const char* what, uint64_t count) {
    if (count == 0) return false;
    for (RepairAction& action : actions_) {
      if (action.what == what) return action.count += count, true;
    }
    actions_.push_back({what, count});
    return true;
  }
  std::vector<RepairAction> Take() { return std::move(actions_); }

 private:
  std::vector<RepairAction> actions_;
};

uint64_t CountUnreferenced(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexId v : t) used[v.index()] = true;
  }
  return std::count(used.begin(), used.end(), false);
}

bool HasUnreferenced(const FaceAdjacency& adjacency) {
  return std::find(adjacency.outgoing.begin(), adjacency.outgoing.end(), kNoHalfEdge) != adjacency.outgoing.end();
}

// Faces of which no surface can be made, by kind.
bool DropUnusable(TriangleMesh& mesh, ActionCounts& actions) {
  uint64_t repeated = 0, not_finite = 0, huge = 0;
  std::vector<bool> unusable(mesh.triangles.size());
  for (size_t f = 0; f < unusable.size(); ++f) {
    const FaceState state = StateOf(mesh, mesh.triangles[f]);
    repeated += state == FaceState::kRepeatedIndex;
    not_finite += state == FaceState::kNotFinite;
    huge += state == FaceState::kHuge;
    unusable[f] = state != FaceState::kSound && state != FaceState::kZeroArea;
  }
  if (repeated + not_finite + huge > 0) DropTriangles(mesh, unusable);
  bool changed = actions.Add("dropped_non_finite_faces", not_finite);
  changed |= actions.Add("dropped_huge_faces", huge);
  return changed | actions.Add("dropped_degenerate_faces", repeated);
}

// Flags of the faces that stay go with them.
void DropFaces(TriangleMesh& mesh, const std::vector<bool>& dropped, std::vector<bool>& flags) {
  size_t kept = 0;
  for (size_t f = 0; f < dropped.size(); ++f) {
    if (!dropped[f]) flags[kept++] = flags[f];
  }
  flags.resize(kept);
  DropTriangles(mesh, dropped);
}

// The faces that hang on an edge of two others by one side, and on nothing else.
std::vector<bool> FindFlaps(const TriangleMesh& mesh) {
  std::vector<int> free_sides(mesh.triangles.size(), 0);
  std::vector<bool> hangs(mesh.triangles.size(), false);
  const std::vector<uint32_t> order = HalfEdgesByEdge(mesh);
  const auto ends = [&](uint32_t h) {
    return std::pair<VertexId, VertexId>(std::minmax({OriginOf(mesh, h), TargetOf(mesh, h)}));
  };
  for (size_t i = 0, end; i < order.size(); i = end) {
    for (end = i + 1; end < order.size() && ends(order[i]) == ends(order[end]);) ++end;
    if (end - i == 1) ++free_sides[order[i] / 3];
    for (size_t k = i; k < end && end - i > 2; ++k) hangs[order[k] / 3] = true;
  }
  for (size_t f = 0; f < hangs.size(); ++f) hangs[f] = hangs[f] && free_sides[f] == 2;
  return hangs;
}

// Of faces with the same three vertices, in whatever order, the first stays; none where they are a flap of no thickness that hangs on an
// edge of others.
uint64_t DropDuplicates(TriangleMesh& mesh) {
  struct Key {
    Triangle sorted;
    uint32_t face;
  };
  std::vector<Key> keys;
  keys.reserve(mesh.triangles.size());
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    keys.push_back({mesh.triangles[f], f});
    std::sort(keys.back().sorted.begin(), keys.back().sorted.end());
  }
  std::sort(keys.begin(), keys.end(),
            [](const Key& a, const Key& b) { return a.sorted != b.sorted ? a.sorted < b.sorted : a.face < b.face; });
  std::vector<bool> dropped(mesh.triangles.size(), false), is_doubled(mesh.triangles.size(), false);
  uint64_t count = 0;
  for (size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].sorted != keys[i - 1].sorted) continue;
    dropped[keys[i].face] = true, ++count;
    if (!dropped[keys[i - 1].face]) is_doubled[keys[i - 1].face] = true;
  }
  if (count == 0) return 0;
  DropFaces(mesh, dropped, is_doubled);
  std::vector<bool> flaps = FindFlaps(mesh);
  for (size_t f = 0; f < flaps.size(); ++f) {
    flaps[f] = flaps[f] && is_doubled[f];
    count += flaps[f];
  }
  DropFaces(mesh, flaps, is_doubled);
  return count;
}

bool AddPairingChanges(const PairingChanges& changes, ActionCounts& actions) {
  actions.Add("welded_vertices", changes.welded_vertices);
  actions.Add("split_non_manifold_edges", changes.split_edges);
  actions.Add("split_non_manifold_vertices", changes.split_vertices);
  actions.Add("reversed_faces", changes.reversed_faces);
  actions.Add("cut_non_orientable_edges", changes.cut_edges);
  actions.Add("dropped_non_manifold_faces", changes.dropped_faces);
  return changes.any();
}

std::vector<uint32_t> RimsOf(const FaceAdjacency& adjacency) {
  std::vector<uint32_t> rims;
  for (uint32_t h = 0; h < 3 * adjacency.opposite.size(); ++h) {
    if (adjacency.OppositeOf(h) == kNoHalfEdge) rims.push_back(h);
  }
  return rims;
}

// Whether a pass would change nothing but, perhaps, direction. `adjacency` is set then.
bool IsClean(const TriangleMesh& mesh, const MeshSurvey& survey, std::optional<FaceAdjacency>& adjacency) {
  adjacency.reset();
  if (survey.unsound_faces > 0 || MayHaveSpikes(survey)) return false;
  adjacency = FindManifoldAdjacency(mesh);
  if (!adjacency) return false;
  const std::vector<uint32_t> rims = RimsOf(*adjacency);
  const bool may_be_soup = 2 * rims.size() >= 3 * mesh.triangles.size();
  if (may_be_soup || HasCoincidentRims(mesh, rims)) return false;
  std::vector<uint32_t> rim_vertices;
  for (const uint32_t h : rims) rim_vertices.push_back(OriginOf(mesh, h).index());
  return !DoRimsAlmostMeet(mesh, rim_vertices);
}

// True when anything was changed.
bool RepairPass(TriangleMesh& mesh, const MeshSurvey& survey, ActionCounts& actions) {
  bool changed = DropUnusable(mesh, actions);
  if (MayHaveSpikes(survey)) changed |= actions.Add("moved_spike_vertices", MoveSpikes(mesh));
  changed |= actions.Add("snapped_vertices", SnapSoup(mesh));
  changed |= actions.Add("snapped_vertices", SnapRims(mesh));
  changed |= actions.Add("dropped_degenerate_faces", DropNeedlesAndLooseCaps(mesh));
  changed |= actions.Add("dropped_duplicate_faces", DropDuplicates(mesh));
  changed |= AddPairingChanges(MakeOrientedManifold(mesh), actions);
  const FlipChanges flips = FlipCaps(mesh);
  changed |= actions.Add("flipped_degenerate_faces", flips.flipped);
  if (actions.Add("dropped_degenerate_faces", flips.dropped)) {
    changed = true;
    AddPairingChanges(MakeOrientedManifold(mesh), actions);
  }
  return changed;
}

// Says which defect left nothing to mesh.
absl::Status NothingLeft(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return absl::InvalidArgumentError("the mesh has no triangles");
  uint64_t not_finite = 0, huge = 0, degenerate = 0;
  for (const Triangle& t : mesh.triangles) {
    const FaceState state = StateOf(mesh, t);
    not_finite += state == FaceState::kNotFinite;
    huge += state == FaceState::kHuge;
    degenerate += state == FaceState::kZeroArea || state == FaceState::kRepeatedIndex;
  }
  if (huge > 0 && huge >= not_finite && huge >= degenerate) {
    const Vec3& p = mesh.PositionAt(mesh.triangles[0][0]);
    return absl::InvalidArgumentError(absl::StrCat(
        "none of the ", mesh.triangles.size(), " triangles can be meshed: ", huge, " have coordinates beyond ±",
        kLargestCoordinate, ", the most that can be computed with (a corner of triangle 0 is at ", p.x, " ", p.y, " ",
        p.z, ")"));
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "none of the ", mesh.triangles.size(), " triangles can be meshed: ", degenerate, " have no area, ", not_finite,
      " have a corner that is not finite; the first: ", FindDefects(mesh, 1).defects[0].message));
}

// Looks for a face to mesh, before anything is changed.
absl::Status ValidateMeshable(const TriangleMesh& mesh, const MeshSurvey& survey) {
  const Vec3 size = survey.box.empty() ? Vec3{} : survey.box.max - survey.box.min;
  const double largest = std::max({size.x, size.y, size.z});  // the diagonal's square could vanish
  if (largest > 0 && largest < kSmallestDiagonal) {
    return absl::InvalidArgumentError(absl::StrCat("the mesh is ", largest, " across; it must be at least ",
                                                   kSmallestDiagonal, " to be computed with"));
  }
  return survey.unsound_faces < mesh.triangles.size() ? absl::OkStatus() : NothingLeft(mesh);
}

// `original`: where the mesh goes as it came before the first change; null: nowhere.
absl::StatusOr<RepairResult> Repair(TriangleMesh mesh, bool turns_outwards, std::optional<TriangleMesh>* original,
                                    const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(ValidateIndices(mesh));
  MeshSurvey survey = Survey(mesh);
  MESHFRONT_RETURN_IF_ERROR(ValidateMeshable(mesh, survey));
  const uint64_t triangles = mesh.triangles.size();
  ActionCounts actions;
  const uint64_t unreferenced = CountUnreferenced(mesh);
  std::optional<FaceAdjacency> adjacency;
  uint64_t components = 0;
  for (int pass = 0;; ++pass) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    if (pass > 0) survey = Survey(mesh);
    const bool clean = IsClean(mesh, survey, adjacency);
    if (pass == 0 && original != nullptr && (!clean || unreferenced > 0 || turns_outwards)) *original = mesh;
    if (!clean && pass < kMostPasses && RepairPass(mesh, survey, actions)) continue;
    if (!adjacency) adjacency = FindManifoldAdjacency(mesh);
    if (!adjacency) return absl::InternalError("repair did not arrive at a manifold; please report this mesh");
    if (turns_outwards) {
      const OutwardTurns turns = TurnOutwards(mesh, *adjacency);
      components = turns.components;
      if (actions.Add("reversed_components", turns.reversed)) adjacency = CreateAdjacency(mesh);
    }
    break;
  }
  if (mesh.triangles.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("nothing is left of the mesh's ", triangles, " triangles after repair"));
  }
  actions.Add("unreferenced_vertices", unreferenced);
  if (HasUnreferenced(*adjacency)) DropUnreferencedVertices(mesh, *adjacency);
  return RepairResult{std::move(mesh), actions.Take(), *std::move(adjacency), components};
}

}  // namespace

absl::StatusOr<RepairResult> RepairMesh(TriangleMesh mesh, const Context& context) {
  return Repair(std::move(mesh), true, nullptr, context);
}

absl::StatusOr<RepairResult> RepairMeshAsOriented(TriangleMesh mesh, const Context& context,
                                                  std::optional<TriangleMesh>* original) {
  return Repair(std::move(mesh), false, original, context);
}

}  // namespace meshfront
