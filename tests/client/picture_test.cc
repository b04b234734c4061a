// Pictures, by properties of their pixels.
#include <png.h>

#include <cmath>
#include <limits>

#include "client/cli/picture/before_after.h"
#include "client/cli/picture/wireframe.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::IsOk;

constexpr Color kWhite{255, 255, 255};
constexpr int kSize = 200;

Canvas Draw(const TriangleMesh& mesh, const View& view) {
  Canvas canvas(kSize, kSize, kWhite);
  DrawWireframe(mesh, view, {0, 0, kSize, kSize}, canvas);
  return canvas;
}

double ShareOf(const Canvas& canvas, const std::function<bool(Color)>& wanted) {
  int count = 0;
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) count += wanted(canvas.At(x, y));
  }
  return static_cast<double>(count) / (canvas.width() * canvas.height());
}

bool IsReddish(Color c) { return c.red > c.blue + 20; }
bool IsBluish(Color c) { return c.blue > c.red + 10; }

// Looking along -z at what lies around the origin.
View FromAbove(double half_extent) {
  View view;
  view.half_extent = half_extent;
  return view;
}

TEST(Wireframe, CoversTheDiskThatASphereShows) {
  const Canvas canvas = Draw(testing::Icosphere(4), FromAbove(1));
  const double share = ShareOf(canvas, [](Color c) { return c != kWhite; });
  EXPECT_NEAR(share, 3.14159 / 4, 0.02);
  EXPECT_NE(canvas.At(kSize / 2, kSize / 2), kWhite);
  EXPECT_EQ(canvas.At(2, 2), kWhite);
}

TEST(Wireframe, DrawsFacesSeenFromBehindInRed) {
  const Canvas front = Draw(testing::Sheet(2), FromAbove(1.2));
  const Canvas behind = Draw(testing::Reversed(testing::Sheet(2)), FromAbove(1.2));
  EXPECT_GT(ShareOf(front, IsBluish), 0.4);
  EXPECT_EQ(ShareOf(front, IsReddish), 0);
  EXPECT_GT(ShareOf(behind, IsReddish), 0.4);
}

TEST(Wireframe, HidesWhatLiesBehind) {
  // A sheet that faces away, below one that faces us: no red anywhere.
  const TriangleMesh below = testing::Moved(testing::Reversed(testing::Sheet(2)), {0, 0, -0.5});
  for (const TriangleMesh& both :
       {testing::Joined(testing::Sheet(2), below), testing::Joined(below, testing::Sheet(2))}) {
    EXPECT_EQ(ShareOf(Draw(both, FromAbove(1.2)), IsReddish), 0);
  }
}

TEST(Wireframe, DrawsEdgesDarkerThanFaces) {
  const Canvas canvas = Draw(testing::Sheet(2), FromAbove(1.2));
  const Color edge = canvas.At(kSize / 2, kSize / 2 + 20);  // on the line x = 0
  const Color face = canvas.At(kSize / 2 + 12, kSize / 2 - 30);
  EXPECT_LT(edge.green + 30, face.green);
}

TEST(Wireframe, ShowsSliversInAnotherColour) {
  const TriangleMesh slivers = testing::Mapped(testing::Sheet(4), [](const Vec3& p) { return Vec3{p.x, p.y * 20, 0}; });
  EXPECT_GT(ShareOf(Draw(slivers, FromAbove(1)), IsReddish), 0.3);
}

TEST(Wireframe, SurvivesFacesThatCannotBeDrawn) {
  TriangleMesh mesh = testing::Sheet(1);
  mesh.triangles.push_back({VertexId(0), VertexId(1), VertexId(99)});
  mesh.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  mesh.triangles.push_back({VertexId(0), VertexId(1), VertexId(mesh.positions.size() - 1)});
  mesh.positions.push_back({std::numeric_limits<double>::infinity(), 0, 1e300});
  mesh.triangles.push_back({VertexId(0), VertexId(1), VertexId(mesh.positions.size() - 1)});
  const View view = ChooseView(mesh);
  EXPECT_TRUE(std::isfinite(view.half_extent));
  EXPECT_GT(ShareOf(Draw(mesh, view), [](Color c) { return c != kWhite; }), 0.05);
}

// A dot whose place is no number, since infinities meet on its way there, and one beyond any int.
TEST(Wireframe, SkipsDotsOutsideThePicture) {
  View view = FromAbove(1);
  view.center = {-1e308, 0, 0};
  TriangleMesh middle;
  middle.positions = {view.center};
  TriangleMesh more = middle;
  more.positions.push_back({1.7e308, 0, 0});
  more.positions.push_back({-1e308, 1e300, 0});
  const auto is_drawn = [](Color c) { return c != kWhite; };
  EXPECT_GT(ShareOf(Draw(middle, view), is_drawn), 0);
  EXPECT_EQ(ShareOf(Draw(more, view), is_drawn), ShareOf(Draw(middle, view), is_drawn));
}

TEST(View, FitsTheShapeAndIsOrthonormal) {
  for (const TriangleMesh& mesh :
       {testing::ThinSlab(10), testing::Scaled(testing::Torus(1, 0.2, 30, 10), 1e-6), TriangleMesh{}}) {
    const View view = ChooseView(mesh);
    EXPECT_NEAR(Dot(Cross(view.right, view.up), view.toward), 1, 1e-12);
    for (const Vec3& p : mesh.positions) {
      EXPECT_LE(std::abs(Dot(p - view.center, view.right)), view.half_extent);
      EXPECT_LE(std::abs(Dot(p - view.center, view.up)), view.half_extent);
    }
  }
}

TEST(View, LooksAtTheBroadSideOfASlab) {
  const TriangleMesh slab = testing::ThinSlab(10);  // thin along z
  EXPECT_GT(std::abs(ChooseView(slab).toward.z), 0.5);
}

TEST(Canvas, DrawsTextWhereItIsToldAndClipsTheRest) {
  Canvas canvas(60, 20, kWhite);
  canvas.DrawText(1, 1, 2, "I", {0, 0, 0});
  EXPECT_EQ(canvas.At(5, 6), (Color{0, 0, 0}));
  EXPECT_EQ(canvas.At(1, 6), kWhite);
  canvas.DrawText(50, 15, 3, "clipped", {0, 0, 0});
  EXPECT_EQ(Canvas::TextWidth("AB", 2), 22);
}

TEST(Canvas, EncodesAPngThatDecodesToTheSamePixels) {
  Canvas canvas(31, 17, {1, 2, 3});
  canvas.Set(30, 16, {200, 100, 50});
  std::string bytes;
  ASSERT_THAT(canvas.EncodePng(&bytes), IsOk());
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
  image.format = PNG_FORMAT_RGB;
  std::vector<Color> pixels(31 * 17);
  ASSERT_EQ(PNG_IMAGE_SIZE(image), pixels.size() * sizeof(Color));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  EXPECT_EQ(pixels.front(), (Color{1, 2, 3}));
  EXPECT_EQ(pixels.back(), (Color{200, 100, 50}));
}

TEST(BeforeAfterPicture, ShowsBothFromTheSameSide) {
  BeforeAfterPicture picture;
  const TriangleMesh mesh = testing::Torus(1, 0.3, 40, 16);
  picture.DrawBefore(mesh);
  picture.DrawAfter(mesh);
  const int half = BeforeAfterPicture::kWidth / 2;
  int differing = 0;
  for (int y = BeforeAfterPicture::kCaption + 20; y < BeforeAfterPicture::kHeight; ++y) {
    for (int x = 30; x < half - 30; ++x) differing += picture.canvas().At(x, y) != picture.canvas().At(x + half, y);
  }
  EXPECT_EQ(differing, 0);
}

}  // namespace
}  // namespace meshfront
