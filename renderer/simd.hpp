// SPDX-License-Identifier: Apache-2.0
#pragma once

// Hot loops are compiled three times, for baseline x86-64, AVX2 and AVX-512, and the best one is picked at
// load time. No multiply is fused with an add (-ffp-contract=off, cmake/targets.cmake): all give the same
// bits, so images do not depend on the machine. Sanitizers cannot intercept the load-time choice, and Clang
// 14 keeps one of the versions alone where a declaration came before; there the baseline is all there is. A
// test may define the macro beforehand, to compile one of the three; a whole build of one is that of
// -DSONARD_SIMD=sse2, avx2 or avx512f (tests/bench/instruction_sets.py).
#ifndef SONARD_SIMD_CLONES
#if defined(SONARD_SIMD_ONLY)
#define SONARD_SIMD_CLONES __attribute__((target(SONARD_SIMD_ONLY)))
#elif defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SONARD_SIMD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SONARD_SIMD_CLONES
#endif
#endif
