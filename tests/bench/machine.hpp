// SPDX-License-Identifier: Apache-2.0
// What the numbers were measured on.
#pragma once

#include <string>

namespace sonard::bench {

/// Processor, cores, memory, system, compiler and build type, one line each.
std::string describe_machine();

/// Whether hot loops were compiled for one set of vector instructions alone (renderer/simd.hpp).
bool is_for_one_instruction_set();

/// Starts to watch the largest resident memory of this process anew. @return false where the kernel refuses.
bool reset_peak_memory();

/// Largest resident memory since reset_peak_memory(); NaN where it cannot be read.
double peak_memory_mib();

}  // namespace sonard::bench
