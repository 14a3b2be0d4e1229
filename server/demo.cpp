// SPDX-License-Identifier: Apache-2.0
#include "server/demo.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <deque>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <istream>
#include <memory>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/streambuf.hpp>

#include "common/text/printable.hpp"
#include "server/boost_process.hpp"
#include "server/daemon/exit_codes.hpp"
#include "server/error/error.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;

constexpr std::chrono::seconds longest_start{120};  // until the daemon is ready
constexpr std::chrono::seconds longest_end{5};      // of each program after SIGTERM

constexpr const char* list_file = "demo/list.yaml";  // in the folder of configurations

fs::path folder_of_programs() {
  return fs::canonical("/proc/self/exe").parent_path();
}

/// A program or a file of the demo is not beside sonard.
Error missing_part(const std::string& text) {
  return {ErrorKind::configuration, "demo: " + text};
}

/// @throws Error if a program that the demo starts is not beside sonard
void expect_programs() {
  for (const char* const name : {"posecast", "sonarview"}) {
    const fs::path program = folder_of_programs() / name;
    std::error_code ignored;
    if (!fs::exists(program, ignored)) {
      throw missing_part(
          fmt::format("{} does not exist (expected posecast and sonarview beside sonard)", program.string()));
    }
  }
}

/// Folder of the configurations. @throws Error
fs::path folder_of_configurations() {
  const fs::path programs = folder_of_programs();
  for (const char* const folder : {"../share/sonard/configs", "../../../configs"}) {
    std::error_code ignored;
    if (fs::exists(programs / folder / list_file, ignored)) {
      return fs::canonical(programs / folder);
    }
  }
  throw missing_part(fmt::format("{1} is neither in {0}/../share/sonard/configs nor in {0}/../../../configs",
                                 programs.string(), list_file));
}

/// A running program and its output lines.
class Part {
 public:
  /// @param take is called with each line
  Part(asio::io_context& io, const std::string& name, const std::vector<std::string>& arguments,
       const fs::path& out, std::function<void(const std::string&)> take)
      : name_(name), lines_(io), take_(std::move(take)) {
    if (!out.empty()) {
      log_.open(out / (name + ".log"));
    }
    child_ =
        process::child((folder_of_programs() / name).string(), process::args(arguments),
                       process::std_in<process::null, (process::std_out & process::std_err)> lines_, io,
                       process::on_exit = [this](int code, const std::error_code&) { exit_code_ = code; },
                       process::extend::on_exec_setup = [](auto&) { ::prctl(PR_SET_PDEATHSIG, SIGTERM); });
    read();
  }

  const std::string& name() const { return name_; }
  bool ended() const { return exit_code_.has_value(); }
  /// Of a program that a signal ended, 128 and the signal's number, as in a shell.
  int exit_code() const {
    const int status = child_.native_exit_code();
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : exit_code_.value_or(0);
  }
  std::string last_words() const { return fmt::format("  {}\n", fmt::join(tail_, "\n  ")); }
  void signal(int number) {
    if (!ended()) {
      ::kill(child_.id(), number);
    }
  }

 private:
  void read() {
    asio::async_read_until(lines_, buffer_, '\n',
                           [this](const boost::system::error_code& error, std::size_t) {
                             if (error) {
                               return;
                             }
                             std::istream in(&buffer_);
                             std::string line;
                             std::getline(in, line);
                             line = printable(line);
                             if (log_.is_open()) {
                               log_ << line << std::endl;
                             }
                             tail_.push_back(line);
                             if (tail_.size() > 15) {
                               tail_.pop_front();
                             }
                             take_(line);
                             read();
                           });
  }

  std::string name_;
  process::async_pipe lines_;
  asio::streambuf buffer_;
  std::function<void(const std::string&)> take_;
  std::ofstream log_;
  std::deque<std::string> tail_;
  std::optional<int> exit_code_;
  process::child child_;
};

/// Replaces each {key} of a template by its value in a line "summary key=value ...".
std::string filled_in(std::string text, const std::string& summary) {
  std::istringstream words(summary);
  for (std::string word; words >> word;) {
    if (const std::size_t sign = word.find('='); sign != std::string::npos) {
      const std::string key = "{" + word.substr(0, sign) + "}";
      if (const std::size_t at = text.find(key); at != std::string::npos) {
        text.replace(at, key.size(), word.substr(sign + 1));
      }
    }
  }
  return text;
}

/// The demo's exit code after one of its programs has ended: the daemon's own code and the network's failures
/// are not defects of sonard.
int exit_code_after(const Part& fallen) {
  const int code = fallen.exit_code();
  if (fallen.name() == "sonard") {
    const std::initializer_list<int> expected{exit_config, exit_network, exit_renderer, exit_output,
                                              exit_exhausted};
    return std::ranges::find(expected, code) != expected.end() ? code : exit_internal;
  }
  constexpr int no_socket = 1;  // of posecast and sonarview
  constexpr int no_head = 3;    // of sonarview
  return code == no_socket || code == no_head ? exit_network : exit_internal;
}

class Demo {
 public:
  Demo(const DemoOptions& options, const fs::path& configurations, const YAML::Node& entry)
      : options_(options), configurations_(configurations), entry_(entry) {}

  int run() {
    signals_.async_wait([this](const boost::system::error_code& error, int) { interrupted_ = !error; });
    start_daemon();
    if (wait([this] { return ready_; }, longest_start)) {
      fmt::print("demo: open {} in a browser ({})\n", page(),
                 options_.time ? fmt::format("for {} s", options_.time->count()) : "until Ctrl-C");
      std::fflush(stdout);
      start_poses();
      start_client();
      wait([] { return false; }, std::chrono::hours(1'000'000));
    }
    return finish();
  }

 private:
  std::string path(const char* key) const {
    return (configurations_ / entry_[key].as<std::string>()).string();
  }

  std::string page() const {
    return "http://" + YAML::LoadFile(path("configuration"))["web"]["bind"].as<std::string>();
  }

  void start_daemon() {
    parts_.push_back(std::make_unique<Part>(io_, "sonard",
                                            std::vector<std::string>{"run", path("configuration")},
                                            options_.out, [this](const std::string& line) {
                                              if (line.find("sonard ready") != std::string::npos) {
                                                ready_ = true;
                                                fmt::print("{}\n", line);
                                              }
                                            }));
  }

  void start_poses() {
    parts_.push_back(std::make_unique<Part>(io_, "posecast",
                                            std::vector<std::string>{path("trajectory"), "--loop"},
                                            options_.out, [](const std::string&) {}));
  }

  void start_client() {
    auto arguments = entry_["client"].as<std::vector<std::string>>();
    if (!options_.out.empty()) {
      arguments.insert(arguments.end(), {"--out", options_.out.string()});
      for (const YAML::Node& option : entry_["pictures"]) {
        arguments.push_back(option.as<std::string>());
      }
    }
    if (options_.time) {
      arguments.insert(arguments.end(), {"--seconds", std::to_string(options_.time->count())});
    }
    parts_.push_back(
        std::make_unique<Part>(io_, "sonarview", arguments, options_.out, [this](const std::string& line) {
          if (line.rfind("summary ", 0) == 0) {
            summary_ = line;
          }
          fmt::print("{}\n", line);
          std::fflush(stdout);
        }));
  }

  /// Waits until `done`, a signal, or the end of a program. @return true if done
  template <typename Done>
  bool wait(Done done, std::chrono::steady_clock::duration longest) {
    const auto end = std::chrono::steady_clock::now() + longest;
    const auto one_ended = [this] {
      return std::ranges::any_of(parts_, [](const auto& part) { return part->ended(); });
    };
    while (!done() && !interrupted_ && !one_ended() && std::chrono::steady_clock::now() < end) {
      io_.run_one_for(std::chrono::milliseconds(100));
    }
    return done();
  }

  /// Ends all programs, the client first, so that it can close its connection. @return exit code
  int finish() {
    const Part* const fallen = first_that_ended();
    for (std::size_t i = parts_.size(); i-- > 0;) {
      end(*parts_[i]);
    }
    const bool client_done = fallen != nullptr && fallen->name() == "sonarview" && fallen->exit_code() == 0;
    if (!interrupted_ && !client_done) {
      const Part& part = fallen == nullptr ? *parts_.front() : *fallen;
      fmt::print(stderr, "demo: {} {}. Its last output:\n{}", part.name(),
                 fallen == nullptr ? fmt::format("was not ready after {} s", longest_start.count())
                                   : "ended unexpectedly",
                 part.last_words());
      return fallen == nullptr ? exit_internal : exit_code_after(part);
    }
    if (!summary_.empty()) {
      fmt::print("demo: {}\n", filled_in(entry_["report"].as<std::string>(), summary_));
    }
    if (!options_.out.empty()) {
      fmt::print("demo: pictures and the output of the programs are in {}\n",
                 printable(options_.out.string()));
    }
    return exit_clean;
  }

  const Part* first_that_ended() const {
    for (const auto& part : parts_) {
      if (part->ended()) {
        return part.get();
      }
    }
    return nullptr;
  }

  void end(Part& part) {
    for (const int number : {SIGTERM, SIGKILL}) {
      part.signal(number);
      const auto end = std::chrono::steady_clock::now() + longest_end;
      while (!part.ended() && std::chrono::steady_clock::now() < end) {
        io_.run_one_for(std::chrono::milliseconds(100));
      }
    }
    io_.poll();  // reads its last lines
  }

  DemoOptions options_;
  fs::path configurations_;
  YAML::Node entry_;
  asio::io_context io_;
  asio::signal_set signals_{io_, SIGINT, SIGTERM};
  bool interrupted_ = false;
  bool ready_ = false;
  std::string summary_;
  std::vector<std::unique_ptr<Part>> parts_;  ///< in start order
};

}  // namespace

std::vector<std::string> demo_names() {
  std::vector<std::string> names;
  for (const auto& demo : YAML::LoadFile((folder_of_configurations() / list_file).string())) {
    names.push_back(demo.first.as<std::string>());
  }
  return names;
}

int run_demo(const DemoOptions& options) {
  const std::vector<std::string> names = demo_names();
  const std::string& name = options.name.empty() ? names.front() : options.name;
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    fmt::print(stderr, "demo: unknown demo '{}' (expected one of: {})\n", printable(name),
               printable(fmt::format("{}", fmt::join(names, ", "))));
    return exit_config;
  }
  expect_programs();
  std::error_code error;
  if (!options.out.empty() && !fs::create_directories(options.out, error) && error) {
    fmt::print(stderr, "demo: --out: cannot create the folder {}: {}\n", printable(options.out.string()),
               error.message());
    return exit_output;
  }
  const fs::path configurations = folder_of_configurations();
  return Demo(options, configurations, YAML::LoadFile((configurations / list_file).string())[name]).run();
}

}  // namespace sonard::server
