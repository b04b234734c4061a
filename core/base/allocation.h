// How a program that meshes wants the allocator to behave. For main functions only.
#pragma once

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace meshfront {

// Arrays above a mebibyte get pages of their own, which go back to the system when they are freed. By default glibc raises that
// threshold to the largest array freed so far, and what a stage leaves behind fragments the heap of the next one: igea at rho
// 0.05 peaked 15 MB higher. Costs nothing measurable: such arrays are few.
inline void ReturnLargeArraysToTheSystem() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
}

}  // namespace meshfront
