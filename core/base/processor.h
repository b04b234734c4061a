// Kernels that are compiled twice, the wider for processors that have it, chosen when the program starts.
#pragma once

// Before a function: also compile it for AVX2. For loops over vectors with fixed lanes, where the width changes no bit (there is no
// contraction to fused multiply-add, see cmake/compile_options.cmake). What it calls must be inlined to profit. The sanitizers'
// start comes after the choice is made, so they do without.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__linux__) && \
    !defined(MESHFRONT_SANITIZED)
#define MESHFRONT_WIDE __attribute__((target_clones("default", "avx2")))
#else
#define MESHFRONT_WIDE
#endif
