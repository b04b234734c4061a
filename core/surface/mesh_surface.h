// A triangle mesh as a surface (sec. 3.2): new vertices are placed where two spheres meet the mesh, reached by walking over the
// connected faces, never by searching space.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/base/ids.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"
#include "core/surface/mesh_walk.h"
#include "core/surface/self_meetings.h"
#include "core/surface/surface.h"
#include "core/surface/vertex_rings.h"

namespace meshfront {

// What the sizing of one place follows from; the facade makes a sizing sample of it.
struct CurvatureSample {
  Vec3 position;
  double max_curvature = 0;  // 1/length, ≥ 0
  double sheet_distance =
      0;                  // to the nearest other sheet (sheet_distance.h) within the search limit; +infinity when none
  double input_edge = 0;  // at a vertex: mean length of the input's edges there, where there is another sheet

  // Whether the distance was measured there; between vertices it is interpolated.
  bool is_vertex() const { return input_edge > 0; }
};

// How far another sheet matters: a fence is at most about this part of an edge high (4ξ at rho = 1, see the design).
inline constexpr double kSheetReachPerLength = 0.75, kLongestSheetReachPerDiagonal = 0.1;

// What happens within this part of a component's diagonal is taken to happen over that length: steps and doubled rows of vertices
// that nobody sees would otherwise ask for edges as short as they are.
inline constexpr double kLeastOfDiagonal = 2e-4;

// Immutable after ComputeCurvature; safe to read from many threads; deterministic at any thread count. Memory: the mesh, its
// adjacency (about 16 bytes a face), 24 bytes of normal, 8 of curvature and 28 of rings a vertex, and after a cut 12 bytes a face and 4 a vertex.
//   MESHFRONT_ASSIGN_OR_RETURN(auto surface, MeshSurface::Create(std::move(mesh), context));
//   MESHFRONT_RETURN_IF_ERROR(surface->ComputeCurvature(context));
//   MESHFRONT_ASSIGN_OR_RETURN(auto samples, surface->CurvatureSamples(ideal_length, true, context));
//   for (const SourcePoint& seed : surface->Seeds()) …
class MeshSurface final : public Surface {
 public:
  // Takes over an oriented manifold, perhaps with boundary (what RepairMesh returns). InvalidArgument: no triangle, an index out
  // of range, a coordinate that is not finite, or a size whose fourth power leaves the range of double (diagonal outside
  // [1e-70, 1e70]; scale the mesh first). O(n).
  static absl::StatusOr<std::unique_ptr<MeshSurface>> Create(TriangleMesh mesh, const Context& context);
  // With the mesh's adjacency where it is known.
  static absl::StatusOr<std::unique_ptr<MeshSurface>> Create(TriangleMesh mesh, std::optional<FaceAdjacency> adjacency,
                                                             const Context& context);
  // Cut open along creases (crease_cut.h): what follows is of the cut mesh, whose components are the smooth patches. No flag set:
  // as above.
  static absl::StatusOr<std::unique_ptr<MeshSurface>> Create(TriangleMesh mesh, FaceAdjacency adjacency,
                                                             const std::vector<bool>& creases, const Context& context);

  // The part that some of its faces make (`chosen`: one flag a face, at least one is set), in their order, as if the rest were not there,
  // but with the normals, curvatures and sizes of the whole, and its distances to other sheets. Where it was cut out of the whole it has a
  // border: rims whose vertices stay as they are. O(n).
  static std::unique_ptr<MeshSurface> CreatePart(std::shared_ptr<const MeshSurface> whole,
                                                 const std::vector<bool>& chosen);
  // Makes this a part, too: `other` is one of the same faces, cut open elsewhere.
  void TakeBorderFrom(const MeshSurface& other);

  // Fits the curvature of every vertex (curvature_fit.h), on the context's threads. To be called once, before anything that
  // tells a curvature: until then all are 0. Below 1 µs a vertex and core.
  absl::Status ComputeCurvature(const Context& context);
  // … of the vertices of some faces alone (`faces`: one flag each); 0 elsewhere.
  absl::Status ComputeCurvatureOf(const std::vector<bool>& faces, const Context& context);

  const TriangleMesh& mesh() const { return mesh_; }
  const FaceAdjacency& adjacency() const { return adjacency_; }
  absl::Span<const Vec3> vertex_normals() const { return normals_; }          // unit, angle-weighted
  absl::Span<const double> vertex_areas() const { return areas_; }            // a third of the faces around
  absl::Span<const double> vertex_curvatures() const { return curvatures_; }  // maximum absolute principal curvature

  // Of the whole mesh, as the curvature was fitted with them; null before, and of parts.
  std::shared_ptr<const VertexRings> vertex_rings() const { return rings_; }

  // Starting points. `v` must have a face; `u`, `v` of AtFace are the weights of the face's second and third corner, ≥ 0, u + v ≤ 1.
  SourcePoint AtVertex(VertexId v) const;
  SourcePoint AtFace(FaceId face, double u, double v) const;

  // What the cut made two of: the half-edge across a crease, or kNoHalfEdge where the surface ends or goes on smoothly; and the
  // vertex of the mesh before the cut.
  uint32_t AcrossCrease(uint32_t half_edge) const {
    if (!is_cut() || adjacency_.OppositeOf(half_edge) != kNoHalfEdge) return kNoHalfEdge;
    return whole_opposite_[half_edge / 3][half_edge % 3];
  }
  uint32_t OriginalOf(VertexId v) const { return is_cut() ? originals_[v.index()] : v.index(); }
  bool is_cut() const { return !originals_.empty(); }

  // Of a part: whether the whole goes on across a half-edge; the vertices on its border, as OriginalOf, in increasing order; pairs of them
  // that an edge of the rest joins; and for each vertex one of the whole that it was.
  bool IsBorder(uint32_t half_edge) const { return !is_border_.empty() && is_border_[half_edge]; }
  absl::Span<const uint32_t> border_vertices() const { return border_vertices_; }
  absl::Span<const std::pair<uint32_t, uint32_t>> taken() const { return taken_; }
  absl::Span<const uint32_t> vertices_of_whole() const { return vertices_of_whole_; }

  size_t component_count() const { return components_.count; }
  uint32_t ComponentOf(FaceId face) const { return components_.label[face.index()]; }
  absl::Span<const double> component_diagonals() const { return component_diagonals_; }  // of their boxes
  // … and for each component that of the one which it was a part of before the cut.
  absl::Span<const double> whole_diagonals() const {
    return whole_diagonals_.empty() ? component_diagonals_ : whole_diagonals_;
  }
  // For a surface that is itself less than the whole: what the diagonal is for the component of a face.
  void SetWholeDiagonals(absl::FunctionRef<double(FaceId)> diagonal);
  // … and its number, in the order of their first faces: the same however the mesh was cut.
  uint32_t WholeComponentOf(uint32_t component) const {
    return whole_components_.empty() ? component : whole_components_[component];
  }
  // The mesh before the cut.
  TriangleMesh MeshBeforeCut() const;
  bool ComponentHasBoundary(uint32_t component) const { return component_has_boundary_[component]; }
  // A good place to begin at, for each component without boundary (or, with `all`, for each), in the order of components: the
  // centroid of a well-shaped face where the surface is flat for its size.
  std::vector<SourcePoint> Seeds(bool all = false) const;

  // Where to sample the field: every vertex, then points on the edges and faces that are longer than three times `ideal_length` of
  // the curvature there (at most 8 along an edge, and at most 4 × the vertices + 200,000 in all). With `with_thickness` each vertex
  // gets the distance to the nearest other sheet, looked for up to 0.75 × its ideal length (at most a tenth of the diagonal).
  // FailedPrecondition before ComputeCurvature. `ideal_length` is called from one thread.
  absl::StatusOr<std::vector<CurvatureSample>> CurvatureSamples(
      absl::FunctionRef<double(double max_curvature)> ideal_length, bool with_thickness, const Context& context) const;
  // The two parts of it, for callers that sample more than once or with other curvatures of the vertices: the distances of every
  // vertex, looked for within its limit; and the samples with these (empty: none was measured).
  absl::StatusOr<std::vector<double>> SheetDistances(absl::Span<const double> limits, const Context& context) const;
  absl::StatusOr<std::vector<CurvatureSample>> CurvatureSamples(absl::Span<const double> curvatures,
                                                                absl::Span<const double> ideal_lengths,
                                                                absl::Span<const double> sheet_distances,
                                                                const Context& context) const;

  // Surface: see there. FindApex below 1 µs, Snap below 0.5 µs where edges are up to five of the input long.
  std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                      double radius_b) const override;
  SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override;
  SourcePoint Foot(const SourcePoint& start, const Vec3& target) const override;
  bool Reaches(const SourcePoint& start, const SourcePoint& place, double tolerance) const override;
  // Interpolated linearly between the face's corners; the field, not this, is what keeps edges short at peaks.
  double MaxCurvatureAt(const SourcePoint& p) const override;
  bool IsOnBoundary(const SourcePoint& p) const override;
  uint32_t SheetOf(const SourcePoint& p) const override { return components_.label[FaceOf(p)]; }
  bool HasWays() const override { return true; }
  bool TraceWay(const SourcePoint& a, const SourcePoint& b, std::vector<WayPiece>& way) const override;
  // About 0.1 µs a face over the triangle.
  bool FindFarPlaces(const SourcePoint& start, const std::array<Vec3, 3>& triangle, double bound, double beside,
                     std::vector<FarPlace>& far, std::vector<DoubtfulPart>* doubtful) const override;
  double DistanceToPieceOf(const SourcePoint& p, const Vec3& place) const override;
  // Finds all places where it does at the first call, as long as the index takes; then fast.
  bool MeetsItselfNear(const Vec3& place, double radius, const Context& context) const override;
  // The same but for seams, at which sheets were parted that had an edge in common: where both are made they have the same vertices there.
  bool DoFacesMeetNear(const Vec3& place, double radius, const Context& context) const;

 private:
  MeshSurface(TriangleMesh mesh, FaceAdjacency adjacency);
  FaceView View() const;
  const SelfMeetings& MeetingsFound(const Context& context) const;
  void MeasureWholeComponents();
  absl::StatusOr<std::vector<double>> SheetDistancesInWhole(absl::Span<const double> limits,
                                                            const Context& context) const;
  SourcePoint Place(const FaceHit& hit) const;
  uint32_t FaceOf(const SourcePoint& p) const { return p.patch < mesh_.triangles.size() ? p.patch : 0; }

  TriangleMesh mesh_;
  FaceAdjacency adjacency_;
  std::vector<uint32_t> originals_;  // as in CreaseCut; empty when nothing was cut, as the next
  std::vector<std::array<uint32_t, 3>> whole_opposite_;
  std::vector<Vec3> normals_;
  std::vector<double> areas_;  // of vertices
  std::vector<double> curvatures_;
  std::shared_ptr<const VertexRings> rings_;
  FaceComponents components_;
  std::vector<bool> component_has_boundary_;
  std::vector<double> component_diagonals_, whole_diagonals_;  // the latter empty when nothing was cut, and of no part
  std::vector<uint32_t> whole_components_;                     // empty when nothing was cut
  bool has_curvature_ = false;
  // Of a part only.
  std::vector<bool> is_border_;
  std::vector<uint32_t> border_vertices_, vertices_of_whole_;
  std::vector<std::pair<uint32_t, uint32_t>> taken_;
  std::shared_ptr<const MeshSurface> whole_;
  mutable std::once_flag meetings_once_;
  mutable std::unique_ptr<SelfMeetings> meetings_;
};

}  // namespace meshfront
