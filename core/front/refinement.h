// Puts vertices where triangles are farther from the surface than they may be (engine sec. 3, error mode).
#pragma once

#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/functional/function_ref.h"
#include "absl/types/span.h"
#include "core/front/deviation.h"
#include "core/front/front_set.h"

namespace meshfront {

// Called by: the settling window, on triangles behind the fronts that nothing else moves at the time. Deterministic.
class Refinement {
 public:
  enum class Manner {
    kSides,       // halves sides, to be moved to better places afterwards
    kWorstPlace,  // puts the vertex where the surface is farthest, to stay there
    kAnyShape,    // the same, though slivers come of it
  };

  // `depth`: of vertices, from which on they may get new triangles; `min_edge`: no shorter ones are made; `certain`: that max_error is
  // kept is to be shown, not only seen.
  Refinement(const Surface& surface, FrontSet& fronts, double max_error, double min_edge, uint32_t depth, bool certain)
      : surface_(surface),
        fronts_(fronts),
        first_bound_(kAimedAt * max_error),
        min_edge_(min_edge),
        depth_(depth),
        certain_(certain),
        meter_(surface, first_bound_, certain) {}

  // Whether a triangle need not be measured; if so, writes down that it keeps the bound. Never where that is to be shown.
  bool NeedNotBeMeasured(WindowTriangleId t, const Vec3& centroid_foot);
  // Measures how far triangle and surface are apart, both ways, and writes it down at the triangle.
  Deviation Measure(WindowTriangleId t);
  // Writes down of a triangle that is beyond the bound what it is certainly within, about to a twentieth. How much it is below `known` is
  // not told apart.
  void Enclose(WindowTriangleId t, double known);
  // Measures the triangles and mends those that don't keep the bound, the worst first and once each: by moving their corners towards
  // the surface, by turning a side, or by new vertices, whichever does it first. Returns the new vertices.
  // `limit`: how many vertices there may be, about, before a triangle is refined that is so many times the bound off.
  std::vector<WindowVertexId> Refine(const std::vector<WindowTriangleId>& triangles, Manner manner,
                                     absl::FunctionRef<size_t(double excess)> limit);
  // Moves the vertices to where the triangles around them are rounder, as far as these stay within the bound.
  void RoundOff(const std::vector<WindowVertexId>& vertices);
  // Turns sides of the poor ones among the triangles, where the worst around is rounder once the corners have moved.
  void TurnAway(const std::vector<WindowTriangleId>& triangles);
  // Moves a vertex, if no triangle around it leaves the bound by that.
  bool TryMove(WindowVertexId v, const Vec3& place);
  // What it keeps, a little less than max_error.
  double bound() const { return max_error_; }
  // From now on it aims at so many times the bound that it was made for.
  void SetSlack(double factor) { max_error_ = factor * first_bound_, meter_.set_bound(max_error_); }
  // Vertices that rims have got by it so far.
  uint64_t rim_insertions() const { return rim_insertions_; }

 private:
  using Corners = std::array<WindowVertexId, 3>;
  std::array<PlaceAndFoot, 3> PlacesOf(const Corners& corners) const;
  Deviation MeasureCorners(const Corners& corners);
  // What a triangle was measured to deviate by itself, before details were looked at from the triangles around.
  struct Measurement {
    std::array<PlaceAndFoot, 3> places;
    double bound = -1;  // none yet
    Deviation deviation;
    std::vector<FarPlace> far_details;
  };
  Measurement& PlaceToRemember(const Corners& corners);
  void MeasureDetails(const Corners& corners, const std::vector<FarPlace>& details, Deviation& deviation);
  double DistanceAround(const Vec3& place, const Corners& corners, double enough) const;
  int TriesAt(const Vec3& place) const;
  double DistanceTo(const Corners& corners, const Vec3& place) const;
  double DistanceFartherOn(const Vec3& place, const Corners& corners, double enough, double least);
  double RatioOf(const Corners& corners) const;
  bool TryLift(WindowTriangleId t, Deviation deviation);
  bool LiftOnce(const Corners& corners, const PlaceAndFoot& worst);
  bool MayMove(WindowVertexId v) const;
  bool KeepsAround(const Corners& corners, double least_ratio);
  bool TryTurn(WindowTriangleId t);
  bool TryTurnSide(Link half_edge);
  struct Quad {
    bool is_free = false;  // neither settled nor near a front
    WindowVertexId a, b, c, d;
  };
  Quad QuadAround(Link half_edge) const;
  bool MayTurn(const Quad& q) const;
  size_t ValenceOf(WindowVertexId v) const;
  void EqualizeAround(WindowVertexId v);
  bool TryEqualize(Link half_edge);
  bool HasBetterValences(const Quad& q) const;
  void TurnTowards(WindowVertexId v);
  bool TryTurnAndRound(Link half_edge);
  void RoundOff(WindowVertexId v);
  double WorstAround(WindowVertexId v, const Vec3& place, double floor) const;
  double WorstAround(const Quad& q) const;
  double LeastRatioFor(WindowTriangleId t, Manner manner, double excess) const;
  void RefineAt(WindowTriangleId t, const Deviation& deviation, Manner manner);
  bool HalveSides(WindowTriangleId t, const Deviation& deviation);
  bool TrySplitRim(WindowTriangleId t, const SourcePoint& place);
  bool SplitAtWorst(WindowTriangleId t, const Deviation& deviation);
  bool MaySplit(Link half_edge) const;
  bool IsTouched(WindowTriangleId t) const { return t.index() < touched_.size() && touched_[t.index()] != 0; }
  void Touch(WindowTriangleId t);
  Link SideBetween(WindowVertexId from, WindowVertexId to) const;
  bool TrySplitSide(Link half_edge, const Vec3& target);
  double LeastAgreement(const Corners& corners) const;
  bool FitsBetween(const Vec3& place, const Vec3& normal, double least_agreement,
                   absl::Span<const std::array<WindowVertexId, 2>> opposite) const;
  bool CrowdsRim(const Vec3& place, absl::Span<const std::array<WindowVertexId, 2>> opposite) const;
  WindowVertexId NewVertex(const SourcePoint& source, WindowVertexId a, WindowVertexId b);

  const Surface& surface_;
  FrontSet& fronts_;
  // Of the bound. Who certifies the output encloses its distance to a fiftieth of the bound, say, and looks at the upper end.
  static constexpr double kAimedAt = 0.9799;

  const double first_bound_, min_edge_;
  double max_error_ = first_bound_;
  const uint32_t depth_;
  const bool certain_;
  DeviationMeter meter_;
  double least_ratio_ = 0;      // of new triangles
  bool is_far_beyond_ = false;  // what is being mended, for a count
  uint64_t rim_insertions_ = 0;
  // The same triangles are measured again: before they are mended, and in the rounds after that. By a hash of their corners.
  static constexpr size_t kRemembered = 1024;
  std::vector<Measurement> remembered_;
  std::vector<WindowVertexId> made_;                                    // by this call of Refine
  std::vector<uint8_t> touched_;                                        // triangle slots that this call has changed
  absl::flat_hash_map<std::tuple<double, double, double>, int> tries_;  // refinements for a detail, by its place
  // Scratch of DistanceFartherOn: when a vertex slot was seen last, and by squared distance what is to be visited.
  std::vector<uint32_t> seen_;
  uint32_t seen_now_ = 0;
  std::vector<std::pair<double, WindowVertexId>> queue_;
};

}  // namespace meshfront
