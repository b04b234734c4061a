// Every tolerance of this room, with its unit and its reason.
#pragma once

namespace meshfront {

// A triangle whose doubled area is at most this times its longest side squared has no area: about what rounding leaves
// of collinear points. Far below any triangle that is merely thin (a stretched mesh has 1e-8).
inline constexpr double kZeroAreaRatio = 1e-14;
// A side at most this times the longest side of its triangle is as good as a point.
inline constexpr double kZeroSideRatio = 1e-14;
// Coordinates beyond this can't be squared with room to spare.
inline constexpr double kLargestCoordinate = 1e150;
// Nor the differences of a mesh whose bounding box has a smaller diagonal.
inline constexpr double kSmallestDiagonal = 1e-150;
// A vertex farther from its neighbours than this many times their spread and the spread of all vertices is a spike: a
// broken number, not a shape.
inline constexpr double kSpikeRatio = 1e6;

// Corners of a soup this close, in median sides and in shortest sides, are meant to be one: rounding of a few digits
// leaves less, and no triangle is thinner than that.
inline constexpr double kSnapToMedianSide = 1e-3;
inline constexpr double kSnapToShortestSide = 0.25;

// Rims this close, in diagonals and in the shortest sides at them, are one: about the rounding of binary32.
inline constexpr double kSnapRimsToDiagonal = 1e-7;
inline constexpr double kSnapRimsToSide = 1e-3;

// Slivers (repair_slivers.h) are thinner than this (height by longest side), and not higher than so many reaches: what is folded over
// by that much is still within one reach of what is below.
inline constexpr double kSliverAspect = 0.1;
inline constexpr double kFlapReaches = 10;
// A sliver's normal is wrong when it is 26° (cosine) off a neighbour's.
inline constexpr double kSliverAgrees = 0.9;
// The faces across both long sides of a thin sheet's wall are more than 120° apart (cosine).
inline constexpr double kWallCosine = -0.5;
// Where two slivers share a short side, it is a step in a hair-thin strip, and may be so many reaches long.
inline constexpr double kStepReaches = 3;
// What a step against slivers may turn another triangle by (cosine), and how thin it may make another sliver, against its aspect
// before.
inline constexpr double kLeastSliverTurn = 0.7;
inline constexpr double kLeastSliverAspectKept = 0.5;

}  // namespace meshfront
