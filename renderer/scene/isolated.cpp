// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/isolated.hpp"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "common/text/printable.hpp"

namespace sonard::render {
namespace {

enum class Outcome : char { returned = 'R', threw = 'T' };

/// @throws IsolatedFailure; std::system_error if a limit of the process is the cause, not the file
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

[[noreturn]] void run_child(const std::function<std::string()>& work, const ReaderJail& jail,
                            const std::function<void()>& prepare, const MemoryFile& result, int log_fd) {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  ::dup2(log_fd, STDOUT_FILENO);
  ::dup2(log_fd, STDERR_FILENO);
  bool stored = false;
  const auto store = [&](Outcome outcome, std::string_view bytes) {
    const char tag = static_cast<char>(outcome);
    stored = result.append(&tag, 1) && result.append(bytes.data(), bytes.size());
  };
  try {
    if (prepare) {
      prepare();
    }
    enter_reader_jail(jail, std::array{result.fd()});
    store(Outcome::returned, work());
  } catch (const std::bad_alloc&) {
    store(Outcome::threw, fmt::format("reading it takes more than {} MiB of memory, the limit of a reader",
                                      jail.memory_limit_bytes >> 20U));
  } catch (const std::exception& error) {
    store(Outcome::threw, error.what());
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

IsolatedResult run_isolated(const std::function<std::string()>& work, const ReaderJail& jail,
                            const std::function<void()>& prepare) {
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
    run_child(work, jail, prepare, result, log.fd());
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
    throw IsolatedFailure(printable(bytes));
  }
  return {std::move(bytes), log.content()};
}

}  // namespace sonard::render
