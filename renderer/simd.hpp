#pragma once

// Hot loops are compiled twice, for baseline x86-64 and for AVX2, and the better one is picked at load time.
// FMA is left out on purpose: without it both give the same bits, so images do not depend on the machine.
// Sanitizers cannot intercept the load-time choice, so their builds keep the baseline.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#if defined(__has_feature)
#if !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer)
#define SONARD_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#endif
#else
#define SONARD_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#endif
#endif
#ifndef SONARD_SIMD_CLONES
#define SONARD_SIMD_CLONES
#endif
