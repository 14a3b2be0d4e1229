// SPDX-License-Identifier: Apache-2.0
#pragma once

// Hot loops are compiled three times, for baseline x86-64, AVX2 and AVX-512; the best version is selected at
// load time. No multiply is fused with an add (-ffp-contract=off, cmake/targets.cmake), so all versions give
// the same bits, and images do not depend on the machine. Only the baseline is compiled with sanitizers,
// which cannot intercept the selection at load time, and with Clang: version 14 keeps only one version if a
// declaration precedes. A test may define the macro first, to compile one version. To build everything with
// one, use -DSONARD_SIMD=sse2, avx2 or avx512f (tests/bench/instruction_sets.py).
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
