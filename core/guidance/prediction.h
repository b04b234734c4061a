// How many triangles a field will make of a surface, before the first is placed.
#pragma once

#include <array>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/base/ids.h"
#include "core/guidance/guidance_field.h"

namespace meshfront {

// The surface to be meshed, as plain arrays: faces index `positions`. All outlive the call.
struct FaceSpans {
  absl::Span<const Vec3> positions;
  absl::Span<const std::array<VertexId, 3>> triangles;
  absl::Span<const double> curvatures = {};  // largest, of each position, ≥ 0; empty: flat
};

// Output triangles per equilateral triangle of side g on a plane of constant g, from seams between fronts and the settling
// window. Fitted to runs of the engine, like all of this.
inline constexpr double kTrianglesPerIdealTriangle = 1.0225;
// The same for edges g that subtend `length_curvature` (= g κ) on the surface, whose chords span more than their length, and
// where g has this squared gradient over an edge to either side: an edge has the length that g has at its older end, and triangles
// grow by the inverse square of that.
double TrianglesPerIdealTriangle(double length_curvature, double squared_gradient);
// The median edge of the output where g is constant, in parts of g. Fitted likewise.
inline constexpr double kMedianEdgePerGuidance = 0.998;

// How many pieces of the surface are checked, about: what comes of them is then certain to three tenths of a percent.
inline constexpr size_t kCheckedPieces = 2048;

// The predicted count, ∫ dA / (√3/4 g²) · TrianglesPerIdealTriangle over the faces, by quadrature on faces split until their
// edges are not longer than g (bounded: at most about two million evaluations of g). ≥ 0; +infinity when it leaves the range of
// double. The same value at any thread count. About one evaluation of g a vertex, and 20,000. Within 3 % of the engine's count
// at eta up to 1.3, 8 % at 1.5, 10 % below 2,000 triangles. Fails only when the context stops it.
absl::StatusOr<double> PredictTriangles(const FaceSpans& faces, const GuidanceField& field, const Context& context,
                                        size_t checked_pieces = kCheckedPieces);

// Places that stand for a surface, each for so much area with so large a curvature. Of one size.
struct PlaceSpans {
  absl::Span<const Vec3> positions;
  absl::Span<const double> areas, curvatures;
};

// Coarser, to compare fields: triangles of side g on places, as many as TrianglesPerIdealTriangle says of their bends alone. The same at
// any thread count; one evaluation of g a place. Fails only when the context stops it.
absl::StatusOr<double> CountOnPlaces(const PlaceSpans& places, const GuidanceField& field, const Context& context);

}  // namespace meshfront
