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

}  // namespace meshfront
