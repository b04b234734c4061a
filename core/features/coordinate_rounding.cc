// 1. of some coordinates, FewestDecimals: with how many digits behind the point (before it where there are fewer) a text gives that number;
// 2. of nearly all of them, the most such digits and the most significant ones: a text has either so many or so many;
// 3. whether nearly all are floats, to as many digits as the text has.
// 4. whether the digits are so few that an edge is only a few spacings long: such numbers were meant, as on a grid.
// Rejected: asking the reader of the file. What comes over the wire has no file, and what was read and written again has another one.
#include "core/features/coordinate_rounding.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/features/tolerances.h"

namespace meshfront {
namespace {

constexpr int kMostDigits = 15;    // of which every decimal number is one double, and another than its neighbours
constexpr int kMostDecimals = 22;  // powers of ten up to here are exact
constexpr int kFewestDecimals = -kMostDecimals;

double PowerOfTen(int exponent) {
  static constexpr std::array<double, kMostDecimals + 1> kPowers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const int clamped = std::clamp(exponent, -kMostDecimals, kMostDecimals);
  return clamped >= 0 ? kPowers[clamped] : 1 / kPowers[-clamped];
}

// Digits before the point: 3 of 123, 0 of 0.5, -1 of 0.05.
int DigitsBeforePoint(double x) {
  int digits = -kMostDecimals;
  while (digits < kMostDecimals && std::abs(x) >= PowerOfTen(digits)) ++digits;
  return digits;
}

bool HasDecimals(double x, int decimals) {
  const double power = PowerOfTen(std::abs(decimals));
  return decimals >= 0 ? std::round(x * power) / power == x : std::round(x / power) * power == x;
}

// kMostDecimals where no text of kMostDigits gives it.
int FewestDecimals(double x) {
  const int before = DigitsBeforePoint(x);
  for (int decimals = std::max(kFewestDecimals, 1 - before);
       decimals <= std::min(kMostDigits - before, kMostDecimals - 1); ++decimals) {
    if (HasDecimals(x, decimals)) return decimals;
  }
  return kMostDecimals;
}

// That at most a few are larger than.
int MostOf(std::vector<int>& values) {
  const auto at = values.begin() + static_cast<ptrdiff_t>(kShareAsWritten * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<double> SomeCoordinates(const TriangleMesh& mesh) {
  const size_t step = std::max<size_t>(1, mesh.positions.size() / kVerticesForRounding);
  std::vector<double> some;
  for (size_t v = 0; v < mesh.positions.size(); v += step) {
    const Vec3& p = mesh.positions[v];
    for (const double x : {p.x, p.y, p.z}) {
      if (x != 0) some.push_back(x);
    }
  }
  return some;
}

// Between the corners of some faces.
double MiddleEdgeLength(const TriangleMesh& mesh) {
  const size_t step = std::max<size_t>(1, mesh.triangles.size() / kVerticesForRounding);
  std::vector<double> lengths;
  for (size_t t = 0; t < mesh.triangles.size(); t += step) {
    for (int i = 0; i < 3; ++i)
      lengths.push_back(
          Distance(mesh.PositionAt(mesh.triangles[t][i]), mesh.PositionAt(mesh.triangles[t][(i + 1) % 3])));
  }
  if (lengths.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = lengths.begin() + static_cast<ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

// By its bits: g++ 12 takes the way to float and back for nothing where it does two of them at a time.
double NearestFloat(double x) { return std::bit_cast<float>(std::bit_cast<uint32_t>(static_cast<float>(x))); }

double SpacingOfFloats(double x) {
  const float magnitude = static_cast<float>(std::abs(x));
  return static_cast<double>(std::nextafter(magnitude, std::numeric_limits<float>::infinity())) - magnitude;
}

}  // namespace

CoordinateRounding::CoordinateRounding(const TriangleMesh& mesh) {
  const std::vector<double> some = SomeCoordinates(mesh);
  if (some.empty()) return;
  std::vector<int> decimals, digits;
  for (const double x : some) {
    decimals.push_back(FewestDecimals(x));
    digits.push_back(decimals.back() == kMostDecimals ? kMostDigits + 1 : decimals.back() + DigitsBeforePoint(x));
  }
  digits_ = MostOf(digits);
  is_decimal_ = digits_ <= kMostDigits;
  if (is_decimal_) behind_point_ = PowerOfTen(-MostOf(decimals));
  const auto floats = std::count_if(some.begin(), some.end(), [&](double x) {
    return std::abs(x - NearestFloat(x)) <= 0.5 * SpacingAt(x);  // of its digits, as yet
  });
  is_float_ = static_cast<double>(floats) >= kShareAsWritten * static_cast<double>(some.size());
  if (is_decimal_ && behind_point_ * kSpacingsOfAnEdge >= MiddleEdgeLength(mesh)) is_decimal_ = false;
}

double CoordinateRounding::SpacingAt(double x) const {
  if (x == 0) return is_decimal_ ? behind_point_ : 0;
  double spacing = 0;
  if (is_decimal_) spacing = std::max(behind_point_, PowerOfTen(DigitsBeforePoint(x) - digits_));
  return is_float_ ? std::max(spacing, SpacingOfFloats(x)) : spacing;
}

double CoordinateRounding::TiltOf(const TriangleMesh& mesh, uint32_t face, const Vec3& normal) const {
  const Triangle& t = mesh.triangles[face];
  double aside = 0, longest = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &p = mesh.PositionAt(t[i]), &q = mesh.PositionAt(t[(i + 1) % 3]);
    aside = std::max(aside, std::abs(normal.x) * SpacingAt(p.x) + std::abs(normal.y) * SpacingAt(p.y) +
                                std::abs(normal.z) * SpacingAt(p.z));
    longest = std::max(longest, Distance(p, q));
  }
  const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
  const double height = Norm(Cross(b - a, c - a)) / longest;
  // One corner half the spacing to one side, the others as far to the other.
  return height > 0 ? aside / height : std::numeric_limits<double>::infinity();
}

}  // namespace meshfront
