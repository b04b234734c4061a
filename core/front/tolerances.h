// Every tolerance of the front, with its unit and its reason.
#pragma once

namespace meshfront::front_tolerances {

// Half-height of a fence in multiples of the error bound ε (eq. 7): ε alone bounds one side only (sec. 3.4).
inline constexpr double kFenceHeightPerError = 2.0;
// … and at least this part of the edge's length: noise of the input, and the fit's allowance.
inline constexpr double kMinFenceHeightPerLength = 0.15;
// Fences whose normals differ by more than this (cosine) stand on another sheet: the far side of a thin plate.
inline constexpr double kOtherSheetCosine = -0.5;
// Edges whose normals agree by this (cosine of 45°) are seen alike from where either stands.
inline constexpr double kSameSlopeCosine = 0.7;
// A free vertex keeps this part of its ideal step away from every fence (sec. 3.4).
inline constexpr double kFreeClearance = 0.5;
// A working area reaches this many lengths of the edge that opened it.
inline constexpr double kAreaRadius = 10.0;
// A front edge looks for connection vertices within this many times its length or g.
inline constexpr double kSearchRange = 1.6;
// Sides of a connection triangle: at most this many times the guidance at their ends.
inline constexpr double kMaxSidePerGuidance = 1.7;

}  // namespace meshfront::front_tolerances
