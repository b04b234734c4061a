// 1. one mesh of the pieces, and the surface before it was cut; both by components    2. components that are not what they should be
// 3. the mixture, and where it meets itself though the surface does not: those components as well, until there are none
// The output's components share no vertex, so that any may be exchanged alone. With all exchanged, what is left is the input.
#include "core/own_faces.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "core/base/status_macros.h"
#include "core/geometry/intersection.h"
#include "core/geometry/triangle.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/self_intersection.h"
#include "core/surface/vertex_normals.h"

namespace meshfront {
namespace {

constexpr int kMaxRounds = 8;
constexpr size_t kMaxListedPairs = size_t{1} << 20;

// A mesh with a component for each triangle.
struct Labelled {
  std::vector<OutputVertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<TriangleKind> kinds;
  std::vector<uint32_t> component;  // of each triangle
  // Where the input has attributes, likewise: the wedges of its corners, and the face that it lies on.
  std::vector<std::array<OutputWedge, 3>> wedges;
  std::vector<uint32_t> faces;
};

// Wedges are numbered on from piece to piece.
void AddWedges(const HeldPiece& piece, std::vector<OutputWedge>& all, Labelled& made) {
  all.insert(all.end(), piece.wedges.begin(), piece.wedges.end());
  for (const CornerWedges& c : piece.corners) made.wedges.push_back({all[c[0]], all[c[1]], all[c[2]]});
  made.faces.insert(made.faces.end(), piece.faces.begin(), piece.faces.end());
}

Labelled LabelPieces(const std::vector<HeldPiece>& pieces) {
  Labelled made;
  std::vector<OutputWedge> all;
  for (const HeldPiece& piece : pieces) {
    made.vertices.insert(made.vertices.end(), piece.vertices.begin(), piece.vertices.end());
    made.triangles.insert(made.triangles.end(), piece.triangles.begin(), piece.triangles.end());
    made.kinds.insert(made.kinds.end(), piece.kinds.begin(), piece.kinds.end());
    AddWedges(piece, all, made);
  }
  for (const Triangle& t : made.triangles) made.component.push_back(made.vertices[t[0].index()].sheet);
  return made;
}

// Each corner of a face has a wedge of its own, so that seams stay seams.
void AddWedgesOfCorners(const std::vector<Vec3>& normals, Labelled& own) {
  for (uint32_t f = 0; f < own.triangles.size(); ++f) {
    const Triangle& t = own.triangles[f];
    own.wedges.push_back({OutputWedge{f, 0, 0, normals[t[0].index()]}, OutputWedge{f, 1, 0, normals[t[1].index()]},
                          OutputWedge{f, 0, 1, normals[t[2].index()]}});
    own.faces.push_back(f);
  }
}

// All corners of a patch at a vertex have the same one.
void AddWedgesOfPatches(const MeshSurface& surface, const std::vector<Vec3>& normals, Labelled& own) {
  constexpr double kWeights[3][2] = {{0, 0}, {1, 0}, {0, 1}};   // of a face's corners
  const std::vector<Triangle>& cut = surface.mesh().triangles;  // its vertices are those of one patch
  std::vector<std::optional<OutputWedge>> of_vertex(surface.mesh().positions.size());
  for (uint32_t f = 0; f < own.triangles.size(); ++f) {
    std::array<OutputWedge, 3>& wedges = own.wedges.emplace_back();
    for (int i = 0; i < 3; ++i) {
      std::optional<OutputWedge>& wedge = of_vertex[cut[f][i].index()];
      if (!wedge) wedge = OutputWedge{f, kWeights[i][0], kWeights[i][1], normals[own.triangles[f][i].index()]};
      wedges[i] = *wedge;
    }
    own.faces.push_back(f);
  }
}

Labelled LabelSurface(const MeshSurface& surface, bool has_wedges, bool shares_wedges) {
  const TriangleMesh mesh = surface.MeshBeforeCut();
  const std::vector<Vec3> normals = ComputeVertexNormals(mesh);
  Labelled own;
  for (size_t v = 0; v < mesh.positions.size(); ++v) own.vertices.push_back({mesh.positions[v], normals[v]});
  own.triangles = mesh.triangles;
  own.kinds.assign(own.triangles.size(), TriangleKind::kClosing);
  for (uint32_t f = 0; f < own.triangles.size(); ++f)
    own.component.push_back(surface.WholeComponentOf(surface.ComponentOf(FaceId(f))));
  if (has_wedges && shares_wedges) AddWedgesOfPatches(surface, normals, own);
  if (has_wedges && !shares_wedges) AddWedgesOfCorners(normals, own);
  return own;
}

// Adds triangles to a mesh, with those vertices that they use.
class Gatherer {
 public:
  explicit Gatherer(const Labelled& from) : from_(from), name_(from.vertices.size()) {}
  void Add(uint32_t triangle, Labelled& to) {
    Triangle t;
    for (int i = 0; i < 3; ++i) {
      const VertexId v = from_.triangles[triangle][i];
      VertexId& name = name_[v.index()];
      if (!name.valid()) {
        name = VertexId(to.vertices.size());
        to.vertices.push_back(from_.vertices[v.index()]);
      }
      t[i] = name;
    }
    to.triangles.push_back(t);
    to.kinds.push_back(from_.kinds[triangle]);
    to.component.push_back(from_.component[triangle]);
    if (!from_.wedges.empty()) to.wedges.push_back(from_.wedges[triangle]);
    if (!from_.faces.empty()) to.faces.push_back(from_.faces[triangle]);
  }

 private:
  const Labelled& from_;
  std::vector<VertexId> name_;
};

TriangleMesh MeshOf(const Labelled& labelled) {
  TriangleMesh mesh;
  for (const OutputVertex& v : labelled.vertices) mesh.positions.push_back(v.position);
  mesh.triangles = labelled.triangles;
  return mesh;
}

// Of each component, by its number.
std::vector<TopologyReport> TopologiesOf(const Labelled& labelled, uint32_t components) {
  std::vector<Labelled> parts(components);
  Gatherer gatherer(labelled);  // no two components share a vertex
  for (uint32_t t = 0; t < labelled.triangles.size(); ++t) gatherer.Add(t, parts[labelled.component[t]]);
  std::vector<TopologyReport> topologies;
  for (const Labelled& part : parts) topologies.push_back(MeasureTopology(MeshOf(part)));
  return topologies;
}

bool IsAlike(const TopologyReport& a, const TopologyReport& b) {
  return a.manifold == b.manifold && a.oriented == b.oriented && a.components == b.components &&
         a.boundary_loops == b.boundary_loops && a.euler_characteristic == b.euler_characteristic;
}

struct Corners {
  Vec3 at[3];
};

class Exchange {
 public:
  Exchange(const std::vector<HeldPiece>& pieces, const MeshSurface& surface, const OwnFacesOptions& options)
      : surface_(surface),
        options_(options),
        made_(LabelPieces(pieces)),
        own_(LabelSurface(surface, !made_.faces.empty(), options.shares_wedges)) {
    for (const uint32_t c : own_.component) is_own_.resize(std::max<size_t>(is_own_.size(), c + 1));
  }

  absl::StatusOr<PartlyOwn> Run(const Context& context) {
    FindUnlike();
    FindFlat();
    for (int round = 1;; ++round) {
      Mix();
      MESHFRONT_ASSIGN_OR_RETURN(const bool is_done, AddMeetings(context));
      if (is_done) return Result();
      if (round == kMaxRounds) is_own_.assign(is_own_.size(), true);
    }
  }

 private:
  void FindUnlike() {
    const auto count = static_cast<uint32_t>(is_own_.size());
    const std::vector<TopologyReport> made = TopologiesOf(made_, count), own = TopologiesOf(own_, count);
    for (uint32_t c = 0; c < count; ++c)
      is_own_[c] = !IsAlike(made[c], own[c]) || std::binary_search(options_.wrong.begin(), options_.wrong.end(), c);
  }

  void FindFlat() {
    for (uint32_t t = 0; t < made_.triangles.size(); ++t) {
      const Corners c = CornersOf(made_, t);
      if (RadiusRatio(c.at[0], c.at[1], c.at[2]) < options_.flat_ratio) is_own_[made_.component[t]] = true;
    }
  }

  void Mix() {
    mixed_ = {};
    for (const bool own : {false, true}) {
      const Labelled& from = own ? own_ : made_;
      Gatherer gatherer(from);
      for (uint32_t t = 0; t < from.triangles.size(); ++t) {
        if (is_own_[from.component[t]] == own) gatherer.Add(t, mixed_);
      }
    }
  }

  // False: others have become the surface's own.
  absl::StatusOr<bool> AddMeetings(const Context& context) {
    MESHFRONT_ASSIGN_OR_RETURN(const SelfIntersections found,
                               FindSelfIntersections(MeshOf(mixed_), kMaxListedPairs, context));
    bool is_done = true;
    for (const auto& [f, g] : found.first_pairs) {
      const uint32_t c = mixed_.component[f.index()], d = mixed_.component[g.index()];
      if (is_own_[c] && is_own_[d]) continue;
      const Corners a = CornersOf(mixed_, f.index()), b = CornersOf(mixed_, g.index());
      if (MayMeet(a, b, context)) continue;
      is_own_[c] = is_own_[d] = true;
      is_done = false;
    }
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    return is_done;
  }

  // Whether the surface's faces meet within the bound of all that these have in common. Its seams don't count: beside faces of its own
  // the vertices on a seam are others.
  bool MayMeet(const Corners& a, const Corners& b, const Context& context) const {
    const Vec3 place = PlaceOfMeeting(a.at, b.at);
    const std::array<Vec3, 2> ends = CommonStretch(a.at, b.at).value_or(std::array{place, place});
    return std::all_of(ends.begin(), ends.end(),
                       [&](const Vec3& end) { return surface_.DoFacesMeetNear(end, options_.bound, context); });
  }

  PartlyOwn Result() const {
    PartlyOwn result;
    std::vector<VertexId> all;
    for (uint32_t v = 0; v < mixed_.vertices.size(); ++v) all.push_back(VertexId(v));
    MeshPiece whole{mixed_.vertices, mixed_.triangles, all, 0, mixed_.kinds};
    std::vector<OutputWedge> wedges;
    std::vector<CornerWedges> corners;
    NumberWedges(wedges, corners);
    whole.wedges = wedges, whole.corners = corners, whole.faces = mixed_.faces;
    result.pieces.emplace_back(whole);
    result.topology = MeasureTopology(MeshOf(mixed_));
    QualityAccumulator quality;
    for (uint32_t t = 0; t < mixed_.triangles.size(); ++t) {
      const Corners c = CornersOf(mixed_, t);
      quality.Add(c.at[0], c.at[1], c.at[2]);
      ++result.by_kind[static_cast<int>(mixed_.kinds[t])];
      result.faces += is_own_[mixed_.component[t]];
    }
    result.quality = quality.Report();
    result.components = std::count(is_own_.begin(), is_own_.end(), true);
    return result;
  }

  // Corners with the same wedge share it again.
  void NumberWedges(std::vector<OutputWedge>& wedges, std::vector<CornerWedges>& corners) const {
    std::map<std::tuple<uint32_t, double, double>, uint32_t> numbers;
    for (const auto& of_triangle : mixed_.wedges) {
      CornerWedges& c = corners.emplace_back();
      for (int i = 0; i < 3; ++i) {
        const OutputWedge& w = of_triangle[i];
        const auto [at, is_new] = numbers.try_emplace({w.face, w.u, w.v}, static_cast<uint32_t>(wedges.size()));
        if (is_new) wedges.push_back(w);
        c[i] = at->second;
      }
    }
  }

  static Corners CornersOf(const Labelled& of, uint32_t triangle) {
    Corners corners;
    for (int i = 0; i < 3; ++i) corners.at[i] = of.vertices[of.triangles[triangle][i].index()].position;
    return corners;
  }

  const MeshSurface& surface_;
  const OwnFacesOptions options_;
  const Labelled made_, own_;
  std::vector<bool> is_own_;  // of each component
  Labelled mixed_;
};

}  // namespace

absl::StatusOr<PartlyOwn> PutOwnFacesIn(const std::vector<HeldPiece>& pieces, const MeshSurface& surface,
                                        const OwnFacesOptions& options, const Context& context) {
  return Exchange(pieces, surface, options).Run(context);
}

}  // namespace meshfront
