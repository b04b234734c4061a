// Polylines in space, and their resampling by edge length: the advancing front in one dimension less (sec. 3.3).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// Edge length wanted at a place, > 0.
using LengthField = absl::FunctionRef<double(const Vec3&)>;

// A place on a polyline: share `t` in [0, 1) of the segment from vertex `segment` to the next.
struct CurvePoint {
  uint32_t segment = 0;
  double t = 0;
  friend bool operator==(const CurvePoint&, const CurvePoint&) = default;
};

// A polyline, closed (its last vertex joined to the first; indices up to twice the size run around it again) or open.
class Curve {
 public:
  // At least three vertices, two of an open one.
  explicit Curve(std::vector<Vec3> vertices, bool closed = true);

  bool closed() const { return closed_; }
  size_t size() const { return vertices_.size(); }
  const Vec3& operator[](size_t i) const { return vertices_[i % vertices_.size()]; }
  double length() const { return closed_ ? arcs_.back() : arcs_[size() - 1]; }
  Vec3 At(const CurvePoint& p) const {
    return p.t > 0 ? Lerp((*this)[p.segment], (*this)[p.segment + 1], p.t) : (*this)[p.segment];
  }
  // Length along the curve from vertex 0, continued when the index runs around.
  double ArcAt(const CurvePoint& p) const;
  // The place at this length along the curve, in [0, 2 length], [0, length] of an open one; its segment may be up to twice the size.
  CurvePoint PointAtArc(double arc) const;

 private:
  double ArcOfVertex(size_t i) const {
    return arcs_[i % size()] + (i >= size() ? length() * static_cast<double>(i / size()) : 0);
  }

  std::vector<Vec3> vertices_;
  bool closed_;
  std::vector<double> arcs_;  // of every vertex, and of the first one again last
};

// Vertices at which the curve turns by more than 45°, seen by chords of half the edge length and of the whole, and that have
// no sharper one within 0.6 edge lengths. In increasing order. Stops with the context.
absl::StatusOr<std::vector<uint32_t>> FindCorners(const Curve& curve, LengthField field, const Context& context);

struct CurveLimits {
  size_t least = 1;  // points
  // Chords that leave a skipped vertex farther aside are divided there, as long as that makes none shorter than `shortest`.
  double max_sagitta = std::numeric_limits<double>::infinity();
  double shortest = 0;
};

// Points along the curve such that the chord from each to the next is about the field's length at the first, the corners
// exactly, and pieces between corners divided evenly. At least three points, distinct and in the order of the curve, in which
// the first may be any vertex; skipped vertices lie within about a fifth of g from their chord, unless that took points closer
// than 0.6 g to each other. A curve too small for its field gives the three vertices that span it. Of an open curve the first end
// is the first point, the last end is none. ResourceExhausted beyond 2^22 points; stops with the context. O(vertices + points).
absl::StatusOr<std::vector<CurvePoint>> ResampleCurve(const Curve& curve, LengthField field, const Context& context,
                                                      const CurveLimits& limits = {});

// Curvature at each vertex (1/length), of the circle fitted to the vertices around; not across corners, where it
// is 0. At most 2 / mean edge around.
std::vector<double> CurveCurvatures(const Curve& curve);

// Vertices where two straight sides meet at an angle: one flag per vertex.
std::vector<bool> FindSharpVertices(const Curve& curve);

// For each vertex the longest chord, at most its `longest`, that stands for the curve around it as well as `ideal_length` asks (see
// curve_sagitta.cc), at least the shorter edge there; its `longest` at sharp vertices. Stops with the context. A few µs a
// vertex, at most 0.3 ms on hostile curves.
absl::StatusOr<std::vector<double>> LongestChords(const Curve& curve, absl::Span<const double> longest,
                                                  absl::FunctionRef<double(double max_curvature)> ideal_length,
                                                  const Context& context);

}  // namespace meshfront
