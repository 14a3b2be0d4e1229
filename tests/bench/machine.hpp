// SPDX-License-Identifier: Apache-2.0
// Describes the machine of the measurements.
#pragma once

#include <string>

namespace sonard::bench {

/// Processor, cores, memory, system, compiler and build type, one line each.
std::string describe_machine();

/// Whether hot loops were compiled for one set of vector instructions only (renderer/simd.hpp).
bool is_for_one_instruction_set();

/// Resets the peak resident memory of this process. @return false if the kernel refuses
bool reset_peak_memory();

/// Peak resident memory since reset_peak_memory(), in MiB; NaN if it cannot be read.
double peak_memory_mib();

}  // namespace sonard::bench
