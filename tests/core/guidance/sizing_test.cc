#include "core/guidance/sizing.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "gtest/gtest.h"

namespace meshfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMaxAngle = 2 * std::numbers::pi / 3;

TEST(Sizing, IdealLengthIsTheChordOfTheOsculatingCircle) {
  // A circle of radius 2: a chord that subtends 60° is as long as the radius.
  EXPECT_NEAR(IdealLength(std::numbers::pi / 3, 0.5), 2, 1e-15);
  EXPECT_NEAR(IdealLength(kMaxAngle, 1), std::sqrt(3), 1e-15);
  EXPECT_EQ(IdealLength(0.8, 0), kInfinity);
}

TEST(Sizing, SubtendedAngleInvertsIdealLength) {
  for (double rho : {1e-9, 1e-3, 0.2, 0.8, 1.5, 2.0}) {
    for (double curvature : {1e-6, 0.3, 1e5}) {
      EXPECT_NEAR(SubtendedAngle(IdealLength(rho, curvature), curvature) / rho, 1, 1e-14);
    }
  }
}

TEST(Sizing, SubtendedAngleIsClampedToAThirdOfTheCircle) {
  EXPECT_EQ(SubtendedAngle(5, 1), kMaxAngle);
  EXPECT_EQ(SubtendedAngle(5, 0), 0);
  EXPECT_LE(SubtendedAngle(std::sqrt(3.0), 1), kMaxAngle);
}

TEST(Sizing, ErrorPerLengthIsEquation6) {
  for (double rho : {0.1, 0.5, 1.0, 1.5, 2.0}) {
    const double printed = (1 - std::sqrt((1 + 2 * std::cos(rho)) / 3)) / (2 * std::sin(rho / 2));
    EXPECT_NEAR(ErrorPerLength(rho) / printed, 1, 1e-12) << rho;
  }
  EXPECT_EQ(ErrorPerLength(0), 0);
  EXPECT_NEAR(ErrorPerLength(kMaxAngle), 1 / std::sqrt(3.0), 1e-7);  // the root's slope is infinite there
}

TEST(Sizing, ErrorPerLengthKeepsItsDigitsAtSmallAngles) {
  // ξ → ρ/6 as ρ → 0; the formula as printed gives 0 or noise here.
  for (double rho : {1e-6, 1e-9, 1e-100}) EXPECT_NEAR(ErrorPerLength(rho) / (rho / 6), 1, 1e-11);
}

TEST(Sizing, ErrorPerLengthGrowsWithTheAngle) {
  double last = 0;
  for (int i = 1; i <= 2000; ++i) {
    const double now = ErrorPerLength(kMaxAngle * i / 2000);
    EXPECT_GT(now, last);
    last = now;
  }
}

TEST(Sizing, ErrorBoundIsLengthTimesErrorPerLength) {
  for (double length : {1e-5, 0.3, 1.0, 1.7}) {
    EXPECT_NEAR(ErrorBound(length, 1) / (length * ErrorPerLength(SubtendedAngle(length, 1))), 1, 1e-13);
  }
  EXPECT_EQ(ErrorBound(3, 0), 0);
}

TEST(Sizing, LengthForErrorInvertsErrorBound) {
  for (double curvature : {1e-4, 1.0, 300.0}) {
    for (double share : {1e-12, 1e-6, 1e-3, 0.1, 0.5, 0.9}) {
      const double error = share / curvature;
      EXPECT_NEAR(ErrorBound(LengthForError(error, curvature), curvature) / error, 1, 1e-9) << share;
    }
  }
}

TEST(Sizing, LengthForErrorEndsAtTheLargestChord) {
  // Beyond one radius of error nothing longer than √3 radii has a bound.
  EXPECT_DOUBLE_EQ(LengthForError(1, 1), std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(LengthForError(7, 1), std::sqrt(3.0));
  EXPECT_EQ(LengthForError(0.1, 0), kInfinity);
  EXPECT_EQ(LengthForError(0, 1), 0);
  double last = 0;
  for (int i = 1; i <= 1000; ++i) {
    const double now = LengthForError(i * 1e-3, 1);
    EXPECT_GT(now, last);
    last = now;
  }
}

TEST(Sizing, GradedLengthInterpolatesEquations2And3) {
  // ĝ(l) = l, ĝ(l(1 + η)) = ηl, ĝ(l(1 + η + η²)) = η²l.
  for (double eta : {1.05, 1.2, 1.9}) {
    const double l = 0.37;
    EXPECT_NEAR(GradedLength(l, l, eta), l, 1e-15);
    EXPECT_NEAR(GradedLength(l * (1 + eta), l, eta), eta * l, 1e-15);
    EXPECT_NEAR(GradedLength(l * (1 + eta + eta * eta), l, eta), eta * eta * l, 1e-15);
  }
}

}  // namespace
}  // namespace meshfront
