// SPDX-License-Identifier: Apache-2.0
// Simulates a disk with SLOW_DISK_BYTES_PER_S, for a program started with this library in LD_PRELOAD:
// pwrite() returns late. The library prints a line when the program ends by exit().
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <string_view>
#include <thread>

namespace {

ssize_t slow_pwrite(int fd, const void* bytes, std::size_t size, off_t offset) {
  static const char* const rate = std::getenv("SLOW_DISK_BYTES_PER_S");
  if (rate != nullptr) {
    std::this_thread::sleep_for(std::chrono::duration<double>(static_cast<double>(size) / std::atof(rate)));
  }
  return syscall(SYS_pwrite64, fd, bytes, size, offset);
}

[[gnu::destructor]] void report_exit() {
  constexpr std::string_view line = "slow disk: exit() has destroyed what the program had\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace

extern "C" ssize_t pwrite(int fd, const void* bytes, std::size_t size, off_t offset) {
  return slow_pwrite(fd, bytes, size, offset);
}

extern "C" ssize_t pwrite64(int fd, const void* bytes, std::size_t size, off_t offset) {
  return slow_pwrite(fd, bytes, size, offset);
}
