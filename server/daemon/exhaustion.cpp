// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/exhaustion.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <latch>
#include <new>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <boost/system/system_error.hpp>

#include "common/text/printable.hpp"
#include "server/daemon/exit_codes.hpp"

namespace sonard::server {
namespace {

/// " (limit of this process: 15, ulimit -n)"; empty if there is no such limit.
std::string limit_text(__rlimit_resource resource, rlim_t unit, std::string_view counted,
                       std::string_view command) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) {
    return "";
  }
  return fmt::format(" (limit of this process: {}{}, {})", limit.rlim_cur / unit, counted, command);
}

std::string out_of_memory() {
  const std::string limit = limit_text(RLIMIT_AS, rlim_t{1} << 20, " MiB", "ulimit -v");
  return "out of memory" + (limit.empty() ? " (of this machine, or of the container)" : limit);
}

std::string out_of_threads() {
  return fmt::format("out of threads{}, or of memory for them{}",
                     limit_text(RLIMIT_NPROC, 1, " of its user", "ulimit -u; a container has pids.max"),
                     limit_text(RLIMIT_AS, rlim_t{1} << 20, " MiB", "ulimit -v"));
}

std::optional<std::string> sentence_for(const std::error_code& code, std::string_view what) {
  if (code == std::errc::not_enough_memory) {
    return out_of_memory();
  }
  if (code == std::errc::too_many_files_open) {
    return fmt::format("out of file descriptors{}: {}", limit_text(RLIMIT_NOFILE, 1, "", "ulimit -n"), what);
  }
  if (code == std::errc::too_many_files_open_in_system) {
    return fmt::format("out of file descriptors (of this machine: fs.file-max): {}", what);
  }
  if (code == std::errc::resource_unavailable_try_again) {  // a thread or process could not be started
    return out_of_threads();
  }
  return std::nullopt;
}

/// Embree's thread library throws exceptions that carry the error only in their text.
bool tells_of_no_thread(const std::exception& error) {
  return std::string_view(error.what())
      .ends_with(std::make_error_code(std::errc::resource_unavailable_try_again).message());
}

[[noreturn]] void on_terminate() {
  try {
    if (std::current_exception()) {
      std::rethrow_exception(std::current_exception());
    }
  } catch (const std::exception& error) {
    auto sentence = exhausted(error);
    if (!sentence && tells_of_no_thread(error)) {
      sentence = out_of_threads();
    }
    if (sentence) {
      fmt::print(stderr, "{}\n", *sentence);
      _exit(exit_exhausted);
    }
    fmt::print(stderr, "defect: {}\n", printable(error.what()));
  } catch (...) {
  }
  std::abort();
}

}  // namespace

std::optional<std::string> exhausted(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    return out_of_memory();
  }
  if (const auto* const of_system = dynamic_cast<const std::system_error*>(&error)) {
    return sentence_for(of_system->code(), error.what());
  }
  if (const auto* const of_boost = dynamic_cast<const boost::system::system_error*>(&error)) {
    return sentence_for({of_boost->code().value(), std::system_category()}, error.what());
  }
  return std::nullopt;
}

void make_sure_of_threads(unsigned count) {
  std::latch all_started{1};
  std::vector<std::jthread> threads;
  try {
    for (unsigned i = 0; i < count; ++i) {
      threads.emplace_back([&] { all_started.wait(); });
    }
  } catch (...) {
    all_started.count_down();
    throw;
  }
  all_started.count_down();
}

void end_by_sentence_when_exhausted() {
  std::set_terminate(&on_terminate);
}

}  // namespace sonard::server
