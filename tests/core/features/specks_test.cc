// Which clusters of small patches are noise, rule by rule: blocks of squares that creases cut out of a sheet.
#include "core/features/specks.h"

#include <algorithm>
#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

constexpr uint32_t kFew = 40, kMany = 1000;  // the most faces of a patch that can be a speck, as FindCreases asks

// A sheet of n × n squares, and which of its half-edges are creases. Squares are counted from a corner.
class CreasedSheet {
 public:
  explicit CreasedSheet(int n) : n_(n), mesh_(testing::Sheet(n)) {
    adjacency_ = CreateAdjacency(mesh_);
    creases_.resize(3 * mesh_.triangles.size());
  }

  // Cuts out the squares [x, x + width) × [y, y + height).
  CreasedSheet& CutOut(int x, int y, int width, int height) {
    const auto is_in = [&](uint32_t f) {
      const auto [i, k] = SquareOf(f);
      return i >= x && i < x + width && k >= y && k < y + height;
    };
    MarkBetween([&](uint32_t f, uint32_t g) { return is_in(f) != is_in(g); });
    return *this;
  }
  // Cuts the sheet in two below row y, except through the squares [from, to).
  CreasedSheet& CutBelow(int y, int from, int to) {
    MarkBetween([&](uint32_t f, uint32_t g) {
      const auto [i, k] = SquareOf(f);
      return (k < y) != (SquareOf(g).second < y) && (i < from || i >= to);
    });
    return *this;
  }
  // A crease along the diagonal of a square.
  CreasedSheet& MarkDiagonal(int x, int y) {
    MarkBetween([&](uint32_t f, uint32_t g) { return SquareOf(f) == std::pair{x, y} && SquareOf(g) == SquareOf(f); });
    return *this;
  }
  // Squares become that much lower.
  CreasedSheet& Squeeze(double share) {
    mesh_ = testing::Mapped(mesh_, [&](const Vec3& p) { return Vec3{p.x, share * p.y, p.z}; });
    return *this;
  }
  // The squares of the sheet, as large as they are in these columns and rows, become so many times as large elsewhere.
  CreasedSheet& Refine(int x, int y, int width, int height, double share) {
    const auto shrunk = [&](double at, int from, int count) {
      const double start = -1 + 2.0 * from / n_, end = start + 2.0 * count / n_, middle = 0.5 * (start + end);
      return at < start || at > end ? at : middle + share * (at - middle);
    };
    mesh_ = testing::Mapped(mesh_, [&](const Vec3& p) {
      const bool is_in = shrunk(p.x, x, width) != p.x || shrunk(p.y, y, height) != p.y;
      return is_in ? Vec3{shrunk(p.x, x, width), shrunk(p.y, y, height), p.z} : p;
    });
    return *this;
  }

  // How many creases are found to be noise, each edge once.
  size_t SpecksOf(uint32_t most_faces) const {
    const std::vector<bool> found = FindSpecks(mesh_, adjacency_, creases_, most_faces);
    size_t count = 0;
    for (uint32_t h = 0; h < found.size(); ++h) {
      if (!found[h]) continue;
      EXPECT_TRUE(creases_[h] && found[adjacency_.OppositeOf(h)]) << h;
      ++count;
    }
    return count / 2;
  }
  size_t Creases() const { return static_cast<size_t>(std::count(creases_.begin(), creases_.end(), true)) / 2; }

 private:
  std::pair<int, int> SquareOf(uint32_t f) const {
    const Triangle& t = squares_.triangles[f];
    const Vec3 c = (squares_.PositionAt(t[0]) + squares_.PositionAt(t[1]) + squares_.PositionAt(t[2])) / 3.0;
    return {static_cast<int>(0.5 * n_ * (c.x + 1)), static_cast<int>(0.5 * n_ * (c.y + 1))};
  }
  template <class Pick>
  void MarkBetween(const Pick& pick) {
    for (uint32_t h = 0; h < creases_.size(); ++h) {
      const uint32_t across = adjacency_.OppositeOf(h);
      if (across != kNoHalfEdge && pick(h / 3, across / 3)) creases_[h] = creases_[across] = true;
    }
  }

  int n_;
  TriangleMesh mesh_;
  const TriangleMesh squares_ = mesh_;  // before anything moves
  FaceAdjacency adjacency_;
  std::vector<bool> creases_;
};

// Four corners among eight edges: they zigzag.
TEST(FindSpecks, TakeAFewFacesWithCornersInALargePatch) {
  EXPECT_EQ(CreasedSheet(20).CutOut(8, 8, 2, 2).SpecksOf(kFew), 8u);
}

TEST(FindSpecks, LeaveThemInAPatchOfAHundredFaces) { EXPECT_EQ(CreasedSheet(8).CutOut(3, 3, 2, 2).SpecksOf(kFew), 0u); }

TEST(FindSpecks, LeaveWhatLiesBetweenTwoPatches) {
  const CreasedSheet sheet = CreasedSheet(20).CutOut(8, 9, 2, 2).CutBelow(10, 8, 10);
  ASSERT_EQ(sheet.Creases(), 8u + 18u);
  EXPECT_EQ(sheet.SpecksOf(kFew), 0u);
}

TEST(FindSpecks, LeaveWhatIsMuchFinerThanWhatLiesAround) {
  EXPECT_EQ(CreasedSheet(20).CutOut(8, 8, 2, 2).Refine(8, 8, 2, 2, 0.6).SpecksOf(kFew), 8u);
  EXPECT_EQ(CreasedSheet(20).CutOut(8, 8, 2, 2).Refine(8, 8, 2, 2, 0.1).SpecksOf(kFew), 0u);
}

TEST(FindSpecks, TakeWhatNobodySeesHoweverFine) {
  EXPECT_EQ(CreasedSheet(20).CutOut(8, 8, 2, 2).Refine(8, 8, 2, 2, 0.01).SpecksOf(kFew), 8u);
  EXPECT_EQ(CreasedSheet(8).CutOut(3, 3, 2, 2).Refine(3, 3, 2, 2, 0.004).SpecksOf(kFew), 0u) << "in a small patch";
}

TEST(FindSpecks, TakeManyFacesWithCornersInAHundredTimesAsMany) {
  // 50 faces, 4 corners among 20 edges.
  EXPECT_EQ(CreasedSheet(52).CutOut(20, 20, 5, 5).SpecksOf(kMany), 20u);
  EXPECT_EQ(CreasedSheet(48).CutOut(20, 20, 5, 5).SpecksOf(kMany), 0u);
}

TEST(FindSpecks, TakeManyFacesWithAWedgeInAHundredTimesAsMany) {
  // 200 faces, 4 corners among 40 edges; the diagonals of the low squares are 11° from their sides.
  const auto sheet = [](int n) { return CreasedSheet(n).CutOut(20, 20, 10, 10).Squeeze(0.2); };
  EXPECT_EQ(sheet(102).SpecksOf(kMany), 0u) << "no wedge";
  EXPECT_EQ(sheet(102).MarkDiagonal(20, 20).SpecksOf(kMany), 41u);
  EXPECT_EQ(sheet(98).MarkDiagonal(20, 20).SpecksOf(kMany), 0u);
}

TEST(FindSpecks, TakeAFewFacesInAThousandTimesAsManyHoweverTheyRun) {
  // 28 faces, 4 corners among 30 edges.
  EXPECT_EQ(CreasedSheet(120).CutOut(20, 20, 14, 1).SpecksOf(kFew), 30u);
  EXPECT_EQ(CreasedSheet(116).CutOut(20, 20, 14, 1).SpecksOf(kFew), 0u);
}

TEST(FindSpecks, CountPatchesThatTouchAsOne) {
  // Six blocks of eight faces in a row.
  CreasedSheet sheet(40);
  for (int i = 0; i < 6; ++i) sheet.CutOut(10 + 2 * i, 10, 2, 2);
  EXPECT_EQ(sheet.SpecksOf(kFew), 0u) << "48 faces in all";
}

}  // namespace
}  // namespace meshfront
