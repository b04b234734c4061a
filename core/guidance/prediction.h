// How many triangles a field will make of a surface, before the first is placed.
#pragma once

#include <array>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/base/ids.h"
#include "core/guidance/guidance_field.h"

namespace meshfront {

// The surface to be meshed, as plain arrays: faces index `positions`. Both outlive the call.
struct FaceSpans {
  absl::Span<const Vec3> positions;
  absl::Span<const std::array<VertexId, 3>> triangles;
};

// Output triangles per equilateral triangle of side g: what advancing fronts make of ∫ dA / (√3/4 g²) in practice, from edges
// that follow g of their first end, seams between fronts and the settling window. Fitted to runs of the engine.
inline constexpr double kTrianglesPerIdealTriangle = 1.0;

// The predicted count: kTrianglesPerIdealTriangle · ∫ dA / (√3/4 g²) over the faces, by quadrature on faces split until their
// edges are not longer than g (bounded: at most about two million evaluations of g). ≥ 0; +infinity when it leaves the range of
// double. The same value at any thread count. About one evaluation of g a vertex. Fails only when the context stops it.
absl::StatusOr<double> PredictTriangles(const FaceSpans& faces, const GuidanceField& field, const Context& context);

}  // namespace meshfront
