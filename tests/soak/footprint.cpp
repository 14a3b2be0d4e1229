// SPDX-License-Identifier: Apache-2.0
#include "tests/soak/footprint.hpp"

#include <malloc.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace sonard::soak {
namespace {

std::size_t entries(const char* folder) {
  const std::filesystem::directory_iterator begin(folder);
  return static_cast<std::size_t>(std::distance(begin, std::filesystem::directory_iterator{}));
}

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size_pages = 0;
  std::size_t resident_pages = 0;
  if (!(statm >> size_pages >> resident_pages)) {
    throw std::runtime_error("/proc/self/statm cannot be read");
  }
  return resident_pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

Footprint footprint() {
  const struct mallinfo2 heap = mallinfo2();
  return {resident_bytes(), heap.uordblks + heap.hblkhd, entries("/proc/self/task"),
          entries("/proc/self/fd")};
}

}  // namespace sonard::soak
