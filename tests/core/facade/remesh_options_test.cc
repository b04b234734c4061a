// What the facade refuses, and in which words: the field, its value, the rule.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/remesh.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr absl::StatusCode kInvalid = absl::StatusCode::kInvalidArgument;

RemeshOptions With(const std::function<void(RemeshOptions&)>& change) {
  RemeshOptions options;
  change(options);
  return options;
}

TEST(RemeshOptions, AreSoundByDefault) { EXPECT_THAT(ValidateOptions({}), IsOk()); }

TEST(RemeshOptions, NameTheFieldTheValueAndTheRule) {
  const absl::Status status = ValidateOptions(With([](auto& o) { o.eta = 2.5; }));
  EXPECT_THAT(status, StatusIs(kInvalid, "options.eta is 2.5"));
  EXPECT_THAT(status, StatusIs(kInvalid, "(1, 2)"));
}

TEST(RemeshOptions, RefuseARhoOutOfRange) {
  for (const double rho : {0.0, -0.5, 2.1, 100.0, kNan, kInfinity, -kInfinity}) {
    EXPECT_THAT(ValidateOptions(With([&](auto& o) { o.rho = rho; })), StatusIs(kInvalid, "options.rho")) << rho;
  }
  EXPECT_THAT(ValidateOptions(With([](auto& o) { o.rho = 2.0943; })), IsOk());
}

TEST(RemeshOptions, RefuseAnEtaOutOfRange) {
  for (const double eta : {1.0, 2.0, 0.0, -1.0, kNan, kInfinity}) {
    EXPECT_THAT(ValidateOptions(With([&](auto& o) { o.eta = eta; })), StatusIs(kInvalid, "options.eta")) << eta;
  }
}

TEST(RemeshOptions, RefuseLengthsThatAreNone) {
  for (const double value : {0.0, -1.0, kNan, kInfinity}) {
    const Length length{value, false};
    EXPECT_THAT(ValidateOptions(With([&](auto& o) { o.min_edge = length; })), StatusIs(kInvalid, "options.min_edge"))
        << value;
    EXPECT_THAT(ValidateOptions(With([&](auto& o) { o.max_edge = length; })), StatusIs(kInvalid, "options.max_edge"))
        << value;
    EXPECT_THAT(ValidateOptions(With([&](auto& o) { o.sizing = Sizing::kUniform, o.edge_length = length; })),
                StatusIs(kInvalid, "options.edge_length"))
        << value;
  }
}

TEST(RemeshOptions, RefuseAClampThatIsEmptyOnceLengthsAreKnown) {
  CollectingSink sink;
  const RemeshOptions options = With([](auto& o) { o.min_edge = Length{0.2, false}, o.max_edge = Length{0.01, true}; });
  EXPECT_THAT(Remesh({Icosphere(2), options}, sink, {}), StatusIs(kInvalid, "options.min_edge is 0.2"));
}

TEST(RemeshOptions, RefuseAnEdgeLengthWithoutUniformSizing) {
  EXPECT_THAT(ValidateOptions(With([](auto& o) {
                o.edge_length = Length{0.1, false};
              })),
              StatusIs(kInvalid, "options.edge_length"));
  EXPECT_THAT(ValidateOptions(With([](auto& o) { o.sizing = Sizing::kUniform; })),
              StatusIs(kInvalid, "options.edge_length"));
}

TEST(RemeshOptions, AreCheckedByTheFacadeItself) {
  CollectingSink sink;
  EXPECT_THAT(Remesh({Icosphere(2), With([](auto& o) { o.rho = -1; })}, sink, {}),
              StatusIs(kInvalid, "options.rho is -1"));
  EXPECT_THAT(EstimateRemesh({Icosphere(2), With([](auto& o) { o.rho = -1; })}, {}),
              StatusIs(kInvalid, "options.rho is -1"));
}

TEST(RemeshInput, MustHaveATriangleOrAFewPoints) {
  CollectingSink sink;
  EXPECT_THAT(Remesh({}, sink, {}), StatusIs(kInvalid, "the point set has 0 points; it must have at least 4"));
}

TEST(RemeshInput, IsRefusedWithThePlaceWhenItMayNotBeRepaired) {
  // A third triangle on an edge of a tetrahedron.
  TriangleMesh fin;
  fin.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  for (const auto& [a, b, c] : std::vector<std::array<int, 3>>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 1, 4}}) {
    fin.triangles.push_back({VertexId(a), VertexId(b), VertexId(c)});
  }
  CollectingSink sink;
  EXPECT_THAT(Remesh({fin, With([](auto& o) { o.repair = false; })}, sink, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, "edge"));
  EXPECT_TRUE(sink.mesh.triangles.empty());
}

TEST(RemeshInput, WithIndicesOutOfRangeIsRefused) {
  TriangleMesh mesh = Icosphere(1);
  mesh.triangles[5][1] = VertexId(4000000);
  CollectingSink sink;
  EXPECT_THAT(Remesh({mesh, {}}, sink, {}), StatusIs(kInvalid, ""));
}

// A sphere drawn out to a needle, on which not even the first triangle has a place.
TEST(RemeshInput, OnWhichNoTriangleCanStandIsRefused) {
  const TriangleMesh needle = Mapped(UvSphere(20, 18), [](const Vec3& p) { return Vec3{1e8 * p.x, p.y, p.z}; });
  CollectingSink sink;
  EXPECT_THAT(Remesh({needle, {}}, sink, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, "not one triangle could be meshed"));
  EXPECT_TRUE(sink.mesh.triangles.empty());
}

TEST(RemeshInput, WithAFewWildVerticesIsMendedOrRefusedButNeverCrashes) {
  for (const double wild : {kNan, kInfinity, 1e300, -1e308}) {
    TriangleMesh mesh = Icosphere(3);
    mesh.positions[17].y = wild;
    CollectingSink sink;
    const absl::StatusOr<Report> report = Remesh({mesh, {}}, sink, {});
    for (const Vec3& p : sink.mesh.positions) ASSERT_TRUE(IsFinite(p)) << wild;
    EXPECT_TRUE(report.ok() || !report.status().message().empty());
  }
}

TEST(RemeshInput, ThatMeetsItselfIsWarnedOf) {
  for (const double apart : {1.5, 2.5}) {
    CollectingSink sink;
    const absl::StatusOr<Report> report =
        Remesh({Joined(Icosphere(4), Moved(Icosphere(4), {apart, 0, 0})), {}}, sink, {});
    ASSERT_THAT(report, IsOk());
    const auto warning = ::testing::Contains(::testing::HasSubstr("the input meets itself, and so may the result"));
    if (apart < 2)
      EXPECT_THAT(report->warnings, warning);
    else
      EXPECT_THAT(report->warnings, ::testing::Not(warning));
  }
}

}  // namespace
}  // namespace meshfront::testing
