// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/machine.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <fstream>
#include <limits>
#include <sstream>
#include <thread>

namespace sonard::bench {

namespace {

/// The text after the colon in the first line of `file` that starts with `key`.
std::string value_in(const char* file, const std::string& key) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.compare(0, key.size(), key) == 0) {
      const std::size_t start = line.find_first_not_of(" \t", line.find(':') + 1);
      return start == std::string::npos ? "" : line.substr(start);
    }
  }
  return "";
}

std::string compiler() {
#ifdef __clang__
  return "clang " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

/// The widest vector instructions in the processor's flags.
std::string vector_units() {
  const std::string flags = value_in("/proc/cpuinfo", "flags") + " ";
  for (const char* unit : {"avx512f", "avx2", "avx", "sse4_2"}) {
    if (flags.find(std::string(" ") + unit + " ") != std::string::npos) {
      return unit;
    }
  }
  return "none known";
}

/// The vector instructions of the hot loops in this program (renderer/simd.hpp).
std::string vectors_of_program() {
#ifdef SONARD_SIMD_ONLY
  return SONARD_SIMD_ONLY " alone";
#elif defined(__x86_64__)
  return "the best of sse2, avx2 and avx512f";
#else
  return "this processor's";
#endif
}

}  // namespace

bool is_for_one_instruction_set() {
#ifdef SONARD_SIMD_ONLY
  return true;
#else
  return false;
#endif
}

std::string describe_machine() {
  utsname system{};
  uname(&system);
  std::string load;
  std::getline(std::ifstream("/proc/loadavg"), load);
  return fmt::format(
      "processor {} ({}), {} cores, {} MHz, memory {}\nvectors   {}\nsystem    {} {}, load {}\ncompiler  {}, "
      "{}\n",
      value_in("/proc/cpuinfo", "model name"), vector_units(), std::thread::hardware_concurrency(),
      value_in("/proc/cpuinfo", "cpu MHz"), value_in("/proc/meminfo", "MemTotal"), vectors_of_program(),
      static_cast<const char*>(system.sysname), static_cast<const char*>(system.release), load, compiler(),
      SONARD_BUILD_TYPE);
}

bool reset_peak_memory() {
  std::ofstream stream("/proc/self/clear_refs");
  stream << "5";  // proc(5): resets the peak resident set size
  stream.close();
  return stream.good();
}

double peak_memory_mib() {
  std::istringstream text(value_in("/proc/self/status", "VmHWM"));
  double kib = 0;
  return text >> kib ? kib / 1024 : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace sonard::bench
