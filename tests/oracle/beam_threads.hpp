// SPDX-License-Identifier: Apache-2.0
// Computes each beam on one thread. Beams are independent, so the result does not depend on the number of
// threads.
#pragma once

#include <functional>

namespace sonard::oracle {

/// Calls `compute(i)` once for every i in [0, count) on `threads` threads (0: one per core). Rethrows the
/// first exception after all threads have ended.
void for_each_beam(int count, unsigned threads, const std::function<void(int)>& compute);

}  // namespace sonard::oracle
