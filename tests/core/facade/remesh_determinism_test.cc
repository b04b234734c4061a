// Same input and options, same bits: at any thread count, run after run, whatever the sink does.
#include <string>

#include "core/remesh.h"
#include "tests/core/facade/zoo.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

class SameBits : public ::testing::TestWithParam<ZooShape> {};

CollectingSink Collect(const TriangleMesh& input, int threads, const RemeshOptions& options = {}) {
  CollectingSink sink;
  Context context;
  context.threads = threads;
  EXPECT_THAT(Remesh({input, options}, sink, context), IsOk());
  return sink;
}

void ExpectSame(const CollectingSink& a, const CollectingSink& b) {
  EXPECT_EQ(a.mesh.positions, b.mesh.positions);
  EXPECT_EQ(a.mesh.normals, b.mesh.normals);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.finalised, b.finalised);
}

TEST_P(SameBits, AtOneTwoAndFourThreads) {
  const TriangleMesh input = GetParam().make();
  const CollectingSink one = Collect(input, 1);
  ASSERT_FALSE(one.mesh.triangles.empty());
  ExpectSame(one, Collect(input, 2));
  ExpectSame(one, Collect(input, 4));
}

INSTANTIATE_TEST_SUITE_P(Zoo, SameBits, ::testing::ValuesIn(Zoo()), [](const auto& info) { return info.param.name; });

TEST(SameBits, WhereTrianglesAreRefined) {
  const TriangleMesh input = Cube(8);
  RemeshOptions options;
  options.max_error = Length{0.02, false};
  options.sizing = Sizing::kError;
  const CollectingSink one = Collect(input, 1, options);
  ASSERT_FALSE(one.mesh.triangles.empty());
  ExpectSame(one, Collect(input, 4, options));
  ExpectSame(one, Collect(input, 1, options));
}

TEST(SameBits, WhenTheCallerWatchesTheProgress) {
  const TriangleMesh input = GenusThree(48);
  CollectingSink watched;
  Context context;
  int calls = 0;
  context.progress = [&](const Progress&) { ++calls; };
  EXPECT_THAT(Remesh({input, {}}, watched, context), IsOk());
  EXPECT_GT(calls, 0);
  ExpectSame(Collect(input, 1), watched);
}

}  // namespace
}  // namespace meshfront::testing
