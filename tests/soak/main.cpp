// SPDX-License-Identifier: Apache-2.0
// sonard_soak HEAD PINGS: runs pings of a head in virtual time, with a new client every 300 pings. Prints the
// process's resources at each tenth. The exit code is 1 if they grow or anything else is wrong.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <string_view>

#include <fmt/format.h>

#include "tests/soak/footprint.hpp"
#include "tests/soak/soak.hpp"
#include "tests/soak/visitor.hpp"

namespace {

using namespace sonard::soak;

double growth_percent(std::size_t before, std::size_t after) {
  return 100.0 * (static_cast<double>(after) / static_cast<double>(before) - 1.0);
}

void print(const Soak& soak, const Footprint& held) {
  using hours = std::chrono::duration<double, std::ratio<3600>>;
  fmt::print(
      "{:9} pings {:6} clients {:8.2f} h   resident {:6} KiB  heap {:8} B  threads {}  descriptors {}\n",
      soak.pings(), soak.visits(), hours(soak.now()).count(), held.resident_bytes / 1024, held.heap_bytes,
      held.threads, held.descriptors);
  std::fflush(stdout);
}

/// Compares the resources at each tenth with the first tenth.
bool run(HeadUnderSoak& head, std::uint64_t pings) {
  constexpr double most_growth_percent = 1.0;
  constexpr std::uint64_t parts = 10;
  Soak soak(head);
  print(soak, footprint());  // once before the first tenth, because printing allocates memory too
  Footprint first;
  bool good = true;
  for (std::uint64_t part = 1; part <= parts; ++part) {
    soak.run_until(pings * part / parts);
    const Footprint held = footprint();
    first = part == 1 ? held : first;
    print(soak, held);
    good = good && growth_percent(first.resident_bytes, held.resident_bytes) < most_growth_percent &&
           held.threads == first.threads && held.descriptors == first.descriptors;
    if (part == parts) {
      fmt::print("resident memory grew by {:.2f} % and the heap by {:.2f} %; {}\n",
                 growth_percent(first.resident_bytes, held.resident_bytes),
                 growth_percent(first.heap_bytes, held.heap_bytes), good ? "good" : "NOT GOOD");
    }
  }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  const auto types = types_under_soak();
  const std::string_view name = argc == 3 ? argv[1] : "";
  const std::uint64_t pings = argc == 3 ? std::strtoull(argv[2], nullptr, 10) : 0;
  const auto type = std::ranges::find(types, name, &TypeUnderSoak::name);
  if (type == types.end() || pings == 0) {
    fmt::print(stderr, "Usage: sonard_soak HEAD PINGS; HEAD is an entry of cmake/devices.cmake\n");
    return 64;
  }
  try {
    return run(*type->make(), pings) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return 1;
  }
}
