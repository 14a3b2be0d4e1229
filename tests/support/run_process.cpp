// SPDX-License-Identifier: Apache-2.0
#include "tests/support/run_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <memory>
#include <system_error>
#include <thread>

namespace sonard::test {
namespace {

/// An unnamed file for the output of the program. A pipe could fill up and block the program.
class Capture {
 public:
  Capture() : file_(std::tmpfile(), &std::fclose) {
    if (file_ == nullptr) {
      throw std::system_error(errno, std::generic_category(), "tmpfile");
    }
  }
  int descriptor() const { return fileno(file_.get()); }
  std::string text() const {
    std::string all;
    std::rewind(file_.get());
    for (int c = std::fgetc(file_.get()); c != EOF; c = std::fgetc(file_.get())) {
      all += static_cast<char>(c);
    }
    return all;
  }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

pid_t start(const std::vector<std::string>& command, const Capture& out, const Capture& err) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, out.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, err.descriptor(), STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);  // no socket of the test is inherited
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, arguments.front(), &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) {
    throw std::system_error(error, std::generic_category(), command.front());
  }
  return pid;
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& command, std::chrono::milliseconds deadline) {
  const Capture out;
  const Capture err;
  const pid_t pid = start(command, out, err);
  const auto give_up = std::chrono::steady_clock::now() + deadline;

  ProcessResult result;
  int status = 0;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    if (!result.timed_out && std::chrono::steady_clock::now() > give_up) {
      result.timed_out = true;
      kill(pid, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{5});
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = out.text();
  result.err = err.text();
  return result;
}

}  // namespace sonard::test
