// SPDX-License-Identifier: Apache-2.0
#include "renderer/usable_cores.hpp"

#include <sched.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <thread>

namespace sonard::render {
namespace {

/// The process's own control group, as a container sees it.
constexpr const char* quota_file = "/sys/fs/cgroup/cpu.max";

unsigned cores_of_schedule() {
  cpu_set_t set;
  CPU_ZERO(&set);
  // Fails if the machine has more cores than the set has bits.
  return sched_getaffinity(0, sizeof set, &set) == 0 ? static_cast<unsigned>(CPU_COUNT(&set))
                                                     : std::thread::hardware_concurrency();
}

}  // namespace

unsigned usable_cores() {
  std::ifstream file(quota_file);
  const unsigned quota = cores_of_quota(std::string{std::istreambuf_iterator<char>(file), {}});
  const unsigned cores = std::max(1U, cores_of_schedule());
  return quota == 0 ? cores : std::min(cores, quota);
}

unsigned cores_of_quota(std::string_view cpu_max) {
  std::uint32_t quota_us = 0;
  std::uint32_t period_us = 0;
  const char* end = cpu_max.data() + cpu_max.size();
  const auto [after, error] = std::from_chars(cpu_max.data(), end, quota_us);
  if (error != std::errc() || after == end || *after != ' ' ||
      std::from_chars(after + 1, end, period_us).ec != std::errc() || period_us == 0) {
    return 0;
  }
  return std::max(1U, quota_us / period_us + (quota_us % period_us == 0 ? 0U : 1U));
}

}  // namespace sonard::render
