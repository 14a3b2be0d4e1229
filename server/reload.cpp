// SPDX-License-Identifier: Apache-2.0
#include "server/reload.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/boost_process.hpp"
#include "server/config/loader.hpp"
#include "server/config/overlaps.hpp"
#include "server/daemon/process.hpp"
#include "server/devices/types/types.hpp"
#include "server/recording/recorder.hpp"
#include "server/try_bind.hpp"

namespace sonard::server {
namespace {

// Environment variables with the numbers of the descriptors that hold the texts.
constexpr const char* text_variable = "SONARD_CONFIG_FD";
constexpr const char* fallback_variable = "SONARD_FALLBACK_CONFIG_FD";

/// A text in memory; child processes and the next program of this process inherit it.
class InheritableText {
 public:
  explicit InheritableText(const std::string& text) : fd_(memfd_create("sonard-config", 0)) {
    std::size_t done = 0;
    while (fd_ >= 0 && done < text.size()) {
      const ssize_t written = pwrite(fd_, text.data() + done, text.size() - done, static_cast<off_t>(done));
      if (written <= 0) {
        break;
      }
      done += static_cast<std::size_t>(written);
    }
    if (fd_ < 0 || done < text.size()) {
      throw std::system_error(errno, std::generic_category(), "cannot pass on the configuration");
    }
  }
  ~InheritableText() { ::close(fd_); }
  InheritableText(const InheritableText&) = delete;
  InheritableText& operator=(const InheritableText&) = delete;

  std::string number() const { return std::to_string(fd_); }

 private:
  int fd_;
};

/// The text of the descriptor that a variable names; nullopt if it is not set. Removes the variable and
/// closes the descriptor.
std::optional<std::string> take_text(const char* variable) {
  const char* const number = std::getenv(variable);
  if (number == nullptr) {
    return std::nullopt;
  }
  const int fd = std::atoi(number);
  unsetenv(variable);
  std::string text;
  std::array<char, 65'536> bytes{};
  ssize_t count = 0;
  while (fd > STDERR_FILENO &&
         (count = pread(fd, bytes.data(), bytes.size(), static_cast<off_t>(text.size()))) > 0) {
    text.append(bytes.data(), static_cast<std::size_t>(count));
  }
  if (fd <= STDERR_FILENO || count < 0) {
    throw std::system_error(EBADF, std::generic_category(), fmt::format("{}={}", variable, number));
  }
  ::close(fd);
  return text;
}

/// Runs `sonard check --no-network` on a configuration text. Its lines go to the log as warnings.
/// @return nullopt if the check passed; else its first line, or its exit code if it printed nothing
std::optional<std::string> checked_apart(const std::filesystem::path& file, const std::string& text,
                                         const std::stop_token& stop) {
  const InheritableText handed_on(text);
  process::environment environment = boost::this_process::environment();
  environment[text_variable] = handed_on.number();
  process::ipstream problems;
  process::group group;  // includes the processes that read its meshes
  process::child check("/proc/self/exe", "check", "--no-network", file.string(), environment, group,
                       process::std_in<process::null, process::std_out> process::null,
                       process::std_err > problems);
  std::optional<std::string> first;
  {
    const std::stop_callback end(stop, [&group] { ::kill(-group.native_handle(), SIGKILL); });
    for (std::string line; std::getline(problems, line);) {
      spdlog::warn("{}", line);
      first = first.value_or(line);
    }
  }
  check.wait();
  if (check.exit_code() == 0) {
    return std::nullopt;
  }
  return first.value_or(fmt::format("the check ended with exit code {}", check.exit_code()));
}

/// True if a socket of the running daemon conflicts with another. It is free once the daemon restarts.
bool holds(const PlannedSocket& held, const PlannedSocket& wanted) {
  return held.transport == wanted.transport && held.endpoint.port == wanted.endpoint.port &&
         (held.endpoint.address == wanted.endpoint.address || held.endpoint.address == 0 ||
          wanted.endpoint.address == 0);
}

/// The first socket or recording folder that `wanted` needs, `in_use` does not hold, and cannot be had;
/// nullopt if there is no such problem.
std::optional<std::string> missing(const LoadedConfig& wanted, const DaemonConfig& in_use) {
  const std::vector<PlannedSocket> held = own_sockets();  // heads may have followed their interfaces
  for (const PlannedSocket& socket : planned_sockets(wanted.config)) {
    if (std::ranges::none_of(held, [&](const PlannedSocket& other) { return holds(other, socket); })) {
      if (const auto why = obstacle_to_binding(socket)) {
        return wanted.problem_with(socket.key, *why);
      }
    }
  }
  const auto& recording = wanted.config.recording;
  std::error_code ignored;
  if (recording && !(in_use.recording && std::filesystem::equivalent(recording->directory,
                                                                     in_use.recording->directory, ignored))) {
    try {
      try_recording_into(recording->directory);
    } catch (const Error& error) {
      return wanted.problem_with(error.where, error.what());
    }
  }
  return std::nullopt;
}

/// Replaces the process. Returns only if SIGINT or SIGTERM has arrived.
void begin_anew_with(const std::string& text, const std::string* fallback, char** argv) {
  const InheritableText handed_on(text);
  setenv(text_variable, handed_on.number().c_str(), 1);
  std::optional<InheritableText> way_back;
  if (fallback != nullptr) {
    setenv(fallback_variable, way_back.emplace(*fallback).number().c_str(), 1);
  }
  std::signal(SIGHUP, SIG_IGN);  // until the new program has set its handler
  hold_orders_to_end();          // later signals go to the new program
  if (!ordered_to_end()) {
    ::execv("/proc/self/exe", argv);
    throw std::system_error(errno, std::generic_category(), "cannot restart");
  }
}

}  // namespace

InheritedConfig inherit_config() {
  return {take_text(text_variable), take_text(fallback_variable)};
}

Reload::Reload(const DaemonConfig& in_use, std::string text) : in_use_(in_use), text_(std::move(text)) {}

std::optional<std::string> Reload::check(const std::stop_token& stop) {
  try {
    std::string text = read_config(in_use_.file);
    if (auto problem = checked_apart(in_use_.file, text, stop)) {
      return problem;
    }
    if (auto problem = missing(load_config(in_use_.file, text, head_types()), in_use_)) {
      return problem;
    }
    checked_ = std::move(text);
    return std::nullopt;
  } catch (const std::exception& error) {
    return error.what();
  }
}

void Reload::begin_anew(char** argv) const {
  begin_anew_with(checked_, &text_, argv);
}

void go_back_to(const std::string& fallback, char** argv) {
  begin_anew_with(fallback, nullptr, argv);
}

}  // namespace sonard::server
