// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/isolated.hpp"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>
#include <system_error>
#include <utility>

namespace sonard::render {
namespace {

enum class Outcome : char { returned = 'R', threw = 'T' };

/// @throws IsolatedFailure; std::system_error where it is a limit of the process, and not the file
[[noreturn]] void throw_failed(const std::string& call) {
  const int error = errno;
  if (error == EMFILE || error == ENFILE || error == ENOMEM || error == EAGAIN) {
    throw std::system_error(error, std::generic_category(), call);
  }
  throw IsolatedFailure(call + ": " + std::generic_category().message(error));
}

/// A file in memory that parent and child share.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name) : fd_(::memfd_create(name, MFD_CLOEXEC)) {
    if (fd_ < 0) {
      throw_failed("memfd_create");
    }
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int fd() const { return fd_; }

  bool append(const char* data, std::size_t size) const {
    while (size > 0) {
      const ssize_t n = ::write(fd_, data, size);
      if (n < 0 && errno == EINTR) {
        continue;
      }
      if (n <= 0) {
        return false;
      }
      data += n;
      size -= static_cast<std::size_t>(n);
    }
    return true;
  }

  std::string content() const {
    const off_t end = ::lseek(fd_, 0, SEEK_END);
    std::string bytes(end > 0 ? static_cast<std::size_t>(end) : 0, '\0');
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n = ::pread(fd_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
      if (n < 0 && errno == EINTR) {
        continue;
      }
      if (n <= 0) {
        break;
      }
      done += static_cast<std::size_t>(n);
    }
    bytes.resize(done);
    return bytes;
  }

 private:
  int fd_;
};

void confine_child(int log_fd, unsigned int processor_limit_s) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const rlimit processor{processor_limit_s, processor_limit_s};
  ::setrlimit(RLIMIT_CPU, &processor);
  // Work that waits for something uses no processor time; a busy machine gives a share of one.
  ::alarm(60 + 20 * processor_limit_s);
  ::dup2(log_fd, STDOUT_FILENO);
  ::dup2(log_fd, STDERR_FILENO);
}

[[noreturn]] void run_child(const std::function<std::string()>& work, const MemoryFile& result, int log_fd,
                            unsigned int processor_limit_s) {
  confine_child(log_fd, processor_limit_s);
  bool stored = false;
  try {
    const std::string bytes = work();
    const char tag = static_cast<char>(Outcome::returned);
    stored = result.append(&tag, 1) && result.append(bytes.data(), bytes.size());
  } catch (const std::exception& error) {
    const char tag = static_cast<char>(Outcome::threw);
    stored = result.append(&tag, 1) && result.append(error.what(), std::strlen(error.what()));
  } catch (...) {
    stored = false;
  }
  std::cout.flush();
  std::fflush(nullptr);
  // Not exit(): the destructors of this process belong to the parent.
  ::_exit(stored ? 0 : 1);
}

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) {
      throw_failed("waitpid");
    }
  }
  return status;
}

}  // namespace

IsolatedResult run_isolated(const std::function<std::string()>& work, unsigned int processor_limit_s) {
  const MemoryFile result("sonard-result");
  const MemoryFile log("sonard-log");
  // Buffered text would otherwise be written twice.
  std::cout.flush();
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) {
    throw_failed("fork");
  }
  if (child == 0) {
    run_child(work, result, log.fd(), processor_limit_s);
  }
  const int status = wait_for(child);
  if (WIFSIGNALED(status)) {
    const int signal_number = WTERMSIG(status);
    if (signal_number == SIGXCPU || signal_number == SIGALRM || signal_number == SIGKILL) {
      throw IsolatedFailure("the reader was stopped: it used too much time or memory");
    }
    throw IsolatedFailure("the reader crashed (signal " + std::to_string(signal_number) +
                          "): the file is damaged or of another format");
  }
  std::string bytes = result.content();
  if (WEXITSTATUS(status) != 0 || bytes.empty()) {
    throw IsolatedFailure("the reader ended without a result: the file is damaged or of another format");
  }
  const auto outcome = static_cast<Outcome>(bytes.front());
  bytes.erase(0, 1);
  if (outcome == Outcome::threw) {
    throw IsolatedFailure(bytes);
  }
  return {std::move(bytes), log.content()};
}

}  // namespace sonard::render
