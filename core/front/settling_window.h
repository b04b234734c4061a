// What happens behind the front (engine sec. 6 and 11): triangles wait here while a front is near, are improved by local
// operations, audited, and then leave for the sink, for good.
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/base/context.h"
#include "core/front/audit.h"
#include "core/front/front_set.h"
#include "core/front/insertion_budget.h"
#include "core/front/refinement.h"
#include "core/geometry/loop_triangulation.h"
#include "core/mesh/mesh_sink.h"
#include "core/mesh/quality.h"

namespace meshfront {

struct SettlingOptions {
  bool flips = true, smooth = true, fit = true;
  double error_per_length = 1;  // of the longest edge of each triangle: the fit moves no vertex farther than that
  // … nor farther than that, absolute; triangles that are farther from the surface are refined, …
  double max_error = std::numeric_limits<double>::infinity();
  double min_edge = 0;  // … unless their edges become shorter than that, …
  // … or more vertices than so many, and half as many again for what is farthest off, the worst first. Where that is finite only those
  // far beyond max_error are: they make the maximum.
  double max_insertions = std::numeric_limits<double>::infinity();
  double predicted_triangles = 0;  // over which max_insertions are spread
  bool wedges = false;             // pieces say where on the surface their corners were made
};

// Totals over everything that has left the window.
struct SettledCounts {
  uint64_t vertices = 0, triangles = 0, flips = 0;
  uint64_t insertions = 0;          // vertices that the refinement added so far
  uint64_t by_kind[3] = {0, 0, 0};  // by TriangleKind
  double longest_edge = 0;
  double largest_deviation = 0;   // from the surface; with max_error only
  uint64_t beyond_max_error = 0;  // triangles that are farther from it than max_error, and could not be refined enough
  Vec3 farthest_place;            // the middle of the worst of them
  QualityAccumulator quality;
};

// A triangle that meets another one, and where.
struct Fault {
  WindowTriangleId triangle;
  Vec3 place;
};

// Called by: the advancing front, between working areas. Moves only vertices and edges that lie a few rings behind every front,
// so that the front never notices.
class SettlingWindow {
 public:
  SettlingWindow(const Surface& surface, FrontSet& fronts, const SettlingOptions& options, MeshSink& sink)
      : surface_(surface),
        fronts_(fronts),
        options_(options),
        sink_(sink),
        refinement_(surface, fronts, RefinedBeyond(options), options.min_edge, kMoveDepth,
                    !std::isfinite(options.max_insertions)),
        insertion_budget_(options.max_insertions, options.predicted_triangles) {}

  // Improves what has come to lie kMoveDepth rings or more behind the fronts since the last time, and audits what is to leave.
  // Returns both triangles of each pair that intersects, so that the front can take them back; none of their vertices is frozen.
  std::vector<Fault> Improve(const Context& context);
  // The triangles about to leave that are slivers still, and were not accepted; found by the last Improve.
  const std::vector<WindowTriangleId>& slivers() const { return slivers_; }
  // … and those that the refinement could not bring within max_error, where it may add what it takes.
  const std::vector<WindowTriangleId>& beyond() const { return beyond_; }
  // Sends what is kEmitDepth rings or more behind the fronts (`everything`: all) to the sink. The sink's status when it stops the job.
  absl::Status Emit(bool everything);
  // Intersecting triangles that could not be mended any more and were let go; their places.
  const std::vector<Vec3>& faults() const { return faults_; }
  // From now on the audit reports this triangle's place as a fault instead of returning it.
  void GiveUp(WindowTriangleId triangle) { fronts_.at(triangle).audit = AuditMark::kFault; }
  // … or no longer looks at it: the surface meets itself there.
  void Excuse(WindowTriangleId triangle) { fronts_.at(triangle).audit = AuditMark::kExcused; }
  uint64_t rim_insertions() const { return refinement_.rim_insertions(); }
  const SettledCounts& counts() const { return counts_; }

  // Rings between each vertex and the nearest front; Improve begins with it. Again before Emit when fronts have retreated since.
  void MeasureDepth();

  static constexpr uint32_t kMoveDepth = 3;
  static constexpr uint32_t kEmitDepth = 5;

 private:
  static constexpr uint32_t kNotAround = 0xffffffffu;

  bool IsReached(const WindowVertex& v) const;
  bool IsReached(WindowTriangleId t) const;
  void ChooseVertices();
  void GatherAround(const std::vector<uint8_t>& wanted);
  void Polish(const Context& context, bool begins_with_flips);
  bool IsAround(WindowTriangleId t) const { return place_in_around_[t.index()] != kNotAround; }
  void FlipSweep();
  bool TryFlip(Link half_edge);
  void SmoothSweep();
  void SearchSweep();
  void RemovalSweep();
  bool TryRemoval(WindowVertexId v);
  bool FillRing(const std::vector<WindowVertexId>& ring, double least_agreement, double& worst,
                std::vector<ClosureStep>& steps) const;
  void FindFeet();
  void FitSweep();
  void FitVertex(WindowVertexId id);
  bool GatherRing(WindowVertexId v);  // fills ring_; false when the fan is not closed
  template <class Measure>
  double WorstAround(const Vec3& place, const Vec3& normal, Measure measure, double floor) const;
  template <class Measure>
  bool TryMove(WindowVertexId v, const Vec3& target, Measure measure, double& worst);
  double SquaredSineOf(WindowTriangleId t) const;
  void NoteChange(WindowTriangleId t);
  using MovedVertices = std::vector<std::pair<WindowVertexId, Vec3>>;  // and where they were
  std::vector<Fault> Audit();
  void Unfit(const WindowTrianglePairs& pairs, bool gently, MovedVertices& moved);
  void Place(WindowVertexId v, const Vec3& place);
  WindowTrianglePairs AuditUnfitted(WindowTrianglePairs pairs);
  Vec3 WhereTheyMeet(WindowTriangleId s, WindowTriangleId t) const;
  bool Leaves(WindowTriangleId t) const;
  CornerWedges WedgesOf(const WindowTriangle& t, std::vector<OutputWedge>& wedges);
  VertexId NameOf(const WindowVertex& v, std::vector<OutputVertex>& vertices);
  void KeepMaxError(const Context& context);
  void PaceInsertions();
  std::vector<WindowTriangleId> DoubtfulTriangles();
  static double RefinedBeyond(const SettlingOptions& options);
  size_t InsertionsLeft(double excess) const;
  void RoundOff(const std::vector<WindowTriangleId>& triangles);
  void ChooseNear(const std::vector<WindowVertexId>& made);
  void FindSlivers();
  void FindBeyond();
  bool MayBeLargest(double deviation) const;
  bool IsBeyond(WindowTriangleId t);
  bool IsBeyondMended() const;

  // The ring around a vertex: the corners opposite in each triangle, in order around it.
  struct Spoke {
    Vec3 from, to;               // the triangle is (vertex, from, to)
    double opposite2, opposite;  // squared distance between the two, and distance
    WindowTriangleId triangle;
    int corner;  // the vertex's in it
  };

  const Surface& surface_;
  FrontSet& fronts_;
  const SettlingOptions options_;
  MeshSink& sink_;
  Refinement refinement_;
  const InsertionBudget insertion_budget_;
  SettledCounts counts_;
  double slack_ = 1;  // of what is refined, where insertions are counted
  std::vector<Spoke> ring_;
  std::vector<WindowVertexId> chosen_;     // what this call of Improve moves, by id
  std::vector<WindowTriangleId> around_;   // the triangles that have a chosen corner, by id
  std::vector<Vec3> feet_;                 // of the centroids of around_, which the fit compares with; else empty
  std::vector<uint32_t> place_in_around_;  // of every triangle slot
  // What the sweeps of one Improve need not look at again. The clock counts sweeps of flips and removals.
  uint32_t clock_ = 0, last_flips_ = 0, last_removals_ = 0;
  std::vector<uint32_t> changed_;  // of every triangle slot: when a corner moved, or it was made
  std::vector<double> sines_;  // of every triangle slot: of its smallest angle, squared, as of the last sweep of flips
  std::vector<uint8_t> is_search_due_;  // of every vertex slot: something around it changed
  std::vector<WindowTriangleId> slivers_, beyond_;
  std::vector<Vec3> faults_;
  uint32_t next_output_ = 0, next_wedge_ = 0;
};

}  // namespace meshfront
