#include "core/guidance/guidance_field.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace meshfront {
namespace {

using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3 RandomPoint(std::mt19937_64& random, double scale) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x = unit(random), y = unit(random), z = unit(random);
  return {scale * x, scale * y, scale * z};
}

// Samples in a cube with lengths over three decades, in no order.
std::vector<SizingSample> RandomSamples(int count, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponent(-3, 0);
  std::vector<SizingSample> samples;
  for (int i = 0; i < count; ++i) {
    const Vec3 position = RandomPoint(random, 1);
    samples.push_back({position, std::pow(10, exponent(random))});
  }
  return samples;
}

// A spiral over the unit sphere, neighbours next to each other, whose lengths oscillate from pole to pole, steeply enough to prune.
std::vector<SizingSample> SphereSamples(int count) {
  std::vector<SizingSample> samples;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, r = std::sqrt(1 - z * z);
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    samples.push_back({{r * std::cos(turn), r * std::sin(turn), z}, 0.02 * (1.5 + std::sin(40 * z))});
  }
  return samples;
}

GuidanceField FieldOf(std::vector<SizingSample> samples, const GuidanceOptions& options = {1.2, 0, 100}) {
  auto field = GuidanceField::Create(std::move(samples), options, {});
  EXPECT_TRUE(field.ok()) << field.status();
  return *std::move(field);
}

double BruteForce(absl::Span<const SizingSample> samples, const Vec3& x, const GuidanceOptions& options) {
  double g = options.max_length;
  for (const SizingSample& s : samples) {
    g = std::min(g, GradedLength(Distance(x, s.position), s.ideal_length, options.eta));
  }
  return std::max(g, options.min_length);
}

double UlpsApart(double a, double b) {
  return std::abs(a - b) / (std::numeric_limits<double>::epsilon() * 0.5 * std::max(a, b));
}

// Random samples and sphere samples, at several gradings: what every property below is checked on.
class GuidanceFieldProperty : public ::testing::TestWithParam<double> {
 protected:
  std::vector<std::vector<SizingSample>> Inputs() const {
    return {RandomSamples(3000, 1), RandomSamples(37, 2), SphereSamples(4000), RandomSamples(1, 3)};
  }
  GuidanceOptions Options() const { return {GetParam(), 0, 100}; }
};

TEST_P(GuidanceFieldProperty, EqualsBruteForceOverTheKeptSamplesInEveryBit) {
  for (const auto& samples : Inputs()) {
    const GuidanceField field = FieldOf(samples, Options());
    std::mt19937_64 random(7);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 x = RandomPoint(random, 1.3);
      ASSERT_EQ(field.At(x), BruteForce(field.kept_samples(), x, Options()));
    }
    for (const SizingSample& s : samples) {
      ASSERT_EQ(field.At(s.position), BruteForce(field.kept_samples(), s.position, Options()));
    }
  }
}

TEST_P(GuidanceFieldProperty, PruningChangesTheFieldByAtMost4Ulp) {
  for (const auto& samples : Inputs()) {
    const GuidanceField field = FieldOf(samples, Options());
    std::mt19937_64 random(8);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 x = RandomPoint(random, 1.3);
      ASSERT_LE(UlpsApart(field.At(x), BruteForce(samples, x, Options())), 4);
    }
    for (const SizingSample& s : samples) {
      ASSERT_LE(UlpsApart(field.At(s.position), BruteForce(samples, s.position, Options())), 4);
    }
  }
}

TEST_P(GuidanceFieldProperty, KeepsNoSampleThatAnotherKeptOneDominates) {
  for (const auto& samples : Inputs()) {
    const GuidanceField field = FieldOf(samples, Options());
    const auto kept = field.kept_samples();
    for (size_t i = 0; i < kept.size(); ++i) {
      for (size_t k = 0; k < i; ++k) {
        ASSERT_GT(GradedLength(Distance(kept[i].position, kept[k].position), kept[k].ideal_length, GetParam()),
                  kept[i].ideal_length / GetParam());
      }
    }
  }
}

TEST_P(GuidanceFieldProperty, IsLipschitzWithOneMinusOneOverEta) {
  for (const auto& samples : Inputs()) {
    const GuidanceField field = FieldOf(samples, Options());
    std::mt19937_64 random(9);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 x = RandomPoint(random, 1.3), y = x + RandomPoint(random, i % 2 ? 0.01 : 1);
      const double slope = 1 - 1 / GetParam();
      ASSERT_LE(std::abs(field.At(x) - field.At(y)), slope * Distance(x, y) + 1e-15);
    }
  }
}

TEST_P(GuidanceFieldProperty, AnUpperBoundChangesNoBit) {
  for (const auto& samples : Inputs()) {
    const GuidanceField field = FieldOf(samples, Options());
    std::mt19937_64 random(10);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 x = RandomPoint(random, 1.2), y = x + RandomPoint(random, 0.05);
      const double bound = field.At(x) + (1 - 1 / GetParam()) * Distance(x, y);
      ASSERT_EQ(field.At(y, bound), field.At(y));
      ASSERT_EQ(field.At(y, field.At(y)), field.At(y));
    }
  }
}

// Balls from a thousandth of g to three times g, among the samples and away from them.
TEST_P(GuidanceFieldProperty, APatchHasTheValuesOfTheFieldInEveryBit) {
  for (const auto& samples : Inputs()) {
    for (const GuidanceOptions& options : {Options(), GuidanceOptions{GetParam(), 0.01, 0.3}}) {
      const GuidanceField field = FieldOf(samples, options);
      FieldPatch patch(field);
      std::mt19937_64 random(11);
      for (int i = 0; i < 400; ++i) {
        const Vec3 center = i % 2 ? RandomPoint(random, 1.3) : samples[i % samples.size()].position;
        const double radius = field.At(center) * (i % 3 == 0 ? 0.001 : i % 3 == 1 ? 0.5 : 3);
        patch.Cover(center, radius, i % 5 == 0 ? options.max_length : field.At(center));
        for (int k = 0; k < 20; ++k) {
          const Vec3 x = center + radius * Normalized(RandomPoint(random, 1));
          ASSERT_EQ(patch.At(x), field.At(x));
        }
        ASSERT_EQ(patch.At(center), field.At(center));
      }
    }
  }
}

TEST_P(GuidanceFieldProperty, WithOtherLengthsIsTheFieldOfThoseInEveryBit) {
  for (const auto& samples : Inputs()) {
    const GuidanceField field = FieldOf(samples, Options());
    std::vector<SizingSample> changed(field.kept_samples().begin(), field.kept_samples().end());
    std::vector<double> lengths;
    for (size_t i = 0; i < changed.size(); ++i) {
      changed[i].ideal_length *= i % 7 == 0 ? 0.3 : 1.7;
      lengths.push_back(changed[i].ideal_length);
    }
    const GuidanceOptions options{GetParam(), 0, 0.8};
    const GuidanceField other = field.WithLengths(lengths, options.max_length);
    std::mt19937_64 random(12);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 x = RandomPoint(random, 1.3);
      ASSERT_EQ(other.At(x), BruteForce(changed, x, options));
      ASSERT_EQ(field.At(x), BruteForce(field.kept_samples(), x, Options()));  // is left as it was
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Eta, GuidanceFieldProperty, ::testing::Values(1.01, 1.2, 1.9));

TEST(GuidanceField, IsTheIdealLengthOneEdgeAwayFromALoneSample) {
  const GuidanceField field = FieldOf({{{1, 2, 3}, 0.5}});
  EXPECT_DOUBLE_EQ(field.At({1.5, 2, 3}), 0.5);
  EXPECT_DOUBLE_EQ(field.At({1, 2 + 0.5 * 2.2, 3}), 0.6);
  EXPECT_DOUBLE_EQ(field.At({1, 2, 3}), 0.5 / 1.2);
}

TEST(GuidanceField, PrunesMostSamplesOfASmoothField) {
  EXPECT_LT(FieldOf(SphereSamples(20000)).kept_samples().size(), 20000 / 3);
}

TEST(GuidanceField, KeepsTheSameSamplesInAnyOrder) {
  std::vector<SizingSample> samples = SphereSamples(3000);
  const GuidanceField field = FieldOf(samples);
  std::shuffle(samples.begin(), samples.end(), std::mt19937_64(3));
  const GuidanceField shuffled = FieldOf(samples);
  ASSERT_EQ(field.kept_samples().size(), shuffled.kept_samples().size());
  for (size_t i = 0; i < field.kept_samples().size(); ++i) {
    EXPECT_EQ(field.kept_samples()[i].position, shuffled.kept_samples()[i].position);
  }
}

TEST(GuidanceField, KeepsOneOfManyEqualSamples) {
  const std::vector<SizingSample> samples(500, SizingSample{{1, 1, 1}, 0.2});
  EXPECT_EQ(FieldOf(samples).kept_samples().size(), 1);
}

TEST(GuidanceField, IsClampedFromBothSides) {
  // One short sample at the origin: the lower clamp around it, the upper one far away.
  const GuidanceField field = FieldOf({{{0, 0, 0}, 0.1}}, {1.2, 0.3, 2.0});
  EXPECT_EQ(field.At({0, 0, 0}), 0.3);
  EXPECT_EQ(field.At({1e6, 0, 0}), 2.0);
  EXPECT_DOUBLE_EQ(field.At({4, 0, 0}), GradedLength(4, 0.1, 1.2));
}

TEST(GuidanceField, IgnoresFlatSamplesAndThoseAboveTheClamp) {
  const GuidanceField field = FieldOf({{{0, 0, 0}, kInfinity}, {{1, 0, 0}, 3}, {{2, 0, 0}, 1}}, {1.2, 0, 2.5});
  ASSERT_EQ(field.kept_samples().size(), 1);
  EXPECT_EQ(field.kept_samples()[0].ideal_length, 1);
}

TEST(GuidanceField, IsTheUpperClampWithoutSamples) {
  EXPECT_EQ(FieldOf({}, {1.2, 0, 0.25}).At({3, 4, 5}), 0.25);
  EXPECT_EQ(FieldOf({}, {1.2, 0.25, 0.25}).At({3, 4, 5}), 0.25);
}

TEST(GuidanceField, RefusesOptionsOutOfRange) {
  for (const GuidanceOptions& options : std::vector<GuidanceOptions>{{1, 0, 1},
                                                                     {2, 0, 1},
                                                                     {NAN, 0, 1},
                                                                     {1.2, -1, 1},
                                                                     {1.2, 2, 1},
                                                                     {1.2, 0, 0},
                                                                     {1.2, 0, kInfinity},
                                                                     {1.2, 0, NAN}}) {
    EXPECT_EQ(GuidanceField::Create({}, options, {}).status().code(), absl::StatusCode::kInvalidArgument);
  }
}

TEST(GuidanceField, RefusesSamplesThatAreNoSamples) {
  EXPECT_THAT(GuidanceField::Create({{{0, 0, 0}, 1}, {{0, 0, 0}, 0}}, {1.2, 0, 1}, {}).status().message(),
              HasSubstr("sizing sample 1 has ideal length 0"));
  EXPECT_FALSE(GuidanceField::Create({{{0, 0, 0}, NAN}}, {1.2, 0, 1}, {}).ok());
  EXPECT_FALSE(GuidanceField::Create({{{0, NAN, 0}, 1}}, {1.2, 0, 1}, {}).ok());
}

TEST(GuidanceField, StopsWhenItsContextSaysSo) {
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  EXPECT_EQ(GuidanceField::Create(RandomSamples(10, 1), {1.2, 0, 1}, context).status().code(),
            absl::StatusCode::kCancelled);
}

TEST(GuidanceField, SurvivesHugeAndTinyCoordinates) {
  const GuidanceField field = FieldOf({{{1e200, 0, 0}, 1e-300}, {{-1e200, 0, 0}, 1}, {{1e-300, 0, 0}, 1e-10}});
  EXPECT_DOUBLE_EQ(field.At({0, 0, 0}), 1e-10 / 1.2);
  EXPECT_EQ(field.At({NAN, 0, 0}), 100);
}

}  // namespace
}  // namespace meshfront
