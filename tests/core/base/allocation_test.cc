// What the allocator does with an array that is freed. Each in a process of its own: it stays so.
#include "core/base/allocation.h"

#include <cstdlib>
#include <vector>

#include "gtest/gtest.h"

namespace meshfront {
namespace {

#if defined(__GLIBC__) && !defined(MESHFRONT_SANITIZED)

// Pages that the process has got as arrays of their own, while there is one of eight mebibytes.
size_t OwnPagesOfAnArray() {
  std::vector<char> array(8 << 20);
  return mallinfo2().hblkhd;
}

TEST(AllocationDeathTest, ReusedLargeArraysComeFromTheHeap) {
  EXPECT_EXIT(
      {
        ReuseLargeArrays();
        std::exit(OwnPagesOfAnArray() == 0 ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(AllocationDeathTest, ReturnedLargeArraysHavePagesOfTheirOwn) {
  EXPECT_EXIT(
      {
        ReturnLargeArraysToTheSystem();
        std::exit(OwnPagesOfAnArray() >= 8 << 20 ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

#endif

}  // namespace
}  // namespace meshfront
