// SPDX-License-Identifier: Apache-2.0
// A child process of a test.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

extern char** environ;

namespace sonard::test {

/// A child process. Its standard output and error go to a file. The destructor kills it if it still runs.
class ChildProcess {
 public:
  /// @param arguments the first one is the path of the program
  explicit ChildProcess(std::vector<std::string> arguments)
      : output_file_(testing::TempDir() + "child_" + std::to_string(getpid()) + "_" +
                     std::to_string(++count_)) {
    std::vector<char*> argv;
    for (std::string& argument : arguments) {
      argv.push_back(argument.data());
    }
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, output_file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    EXPECT_EQ(posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), environ), 0) << argv[0];
    posix_spawn_file_actions_destroy(&actions);
  }
  ~ChildProcess() {
    if (!exit_status()) {
      send(SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    std::filesystem::remove(output_file_);
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void send(int signal) const { kill(pid_, signal); }

  /// nullopt while it runs; -1 if a signal ended it.
  std::optional<int> exit_status() {
    int status = 0;
    if (!ended_ && waitpid(pid_, &status, WNOHANG) == pid_) {
      ended_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    return ended_;
  }

  std::string output() const {
    std::ifstream file{output_file_};
    return {std::istreambuf_iterator<char>{file}, {}};
  }

 private:
  static inline int count_ = 0;
  std::string output_file_;
  pid_t pid_ = -1;
  std::optional<int> ended_;
};

}  // namespace sonard::test
