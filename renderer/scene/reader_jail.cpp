// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/reader_jail.hpp"

#include <fcntl.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <memory>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sonard::render {
namespace {

/// Calls that open a network connection, reach another process or change the file system.
constexpr std::array<const char*, 60> forbidden_calls{"socket",
                                                      "socketpair",
                                                      "connect",
                                                      "bind",
                                                      "io_uring_setup",
                                                      "fork",
                                                      "vfork",
                                                      "clone",
                                                      "clone3",
                                                      "execve",
                                                      "execveat",
                                                      "ptrace",
                                                      "kill",
                                                      "tkill",
                                                      "rt_sigqueueinfo",
                                                      "pidfd_open",
                                                      "setns",
                                                      "unshare",
                                                      "mount",
                                                      "umount2",
                                                      "pivot_root",
                                                      "chroot",
                                                      "bpf",
                                                      "keyctl",
                                                      "add_key",
                                                      "request_key",
                                                      "creat",
                                                      "openat2",
                                                      "truncate",
                                                      "rename",
                                                      "renameat",
                                                      "renameat2",
                                                      "link",
                                                      "linkat",
                                                      "symlink",
                                                      "symlinkat",
                                                      "unlink",
                                                      "unlinkat",
                                                      "mkdir",
                                                      "mkdirat",
                                                      "rmdir",
                                                      "mknod",
                                                      "mknodat",
                                                      "chmod",
                                                      "fchmod",
                                                      "fchmodat",
                                                      "chown",
                                                      "lchown",
                                                      "fchown",
                                                      "fchownat",
                                                      "setxattr",
                                                      "lsetxattr",
                                                      "fsetxattr",
                                                      "utimensat",
                                                      "process_vm_readv",
                                                      "process_vm_writev",
                                                      "open_by_handle_at",
                                                      "perf_event_open",
                                                      "userfaultfd",
                                                      "move_mount"};

[[noreturn]] void throw_failed(const char* call, int error = errno) {
  throw std::system_error(error, std::generic_category(), fmt::format("cannot confine the reader: {}", call));
}

void lower(decltype(RLIMIT_CPU) resource, rlim_t limit) {
  rlimit now{};
  ::getrlimit(resource, &now);
  const rlim_t hard = std::min(limit, now.rlim_max);
  const rlimit lowered{std::min(hard, now.rlim_cur), hard};
  if (::setrlimit(resource, &lowered) != 0) {
    throw_failed("setrlimit");
  }
}

/// Size of this process's address space in bytes.
std::uint64_t address_space_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit_resources(const ReaderJail& jail) {
  lower(RLIMIT_CORE, 0);
  lower(RLIMIT_CPU, jail.processor_limit_s);
  lower(RLIMIT_FSIZE, jail.memory_limit_bytes);  // the memory files that carry the result
  if (reader_memory_is_limited) {
    lower(RLIMIT_AS, address_space_bytes() + jail.memory_limit_bytes);
  }
  // A wall-clock limit: a waiting process uses no processor time, and on a busy machine it gets only a share.
  ::alarm(60 + 20 * jail.processor_limit_s);
}

void close_all_but(std::span<const int> kept) {
  if (const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC); nothing >= 0) {
    ::dup2(nothing, STDIN_FILENO);
  }
  std::vector<unsigned int> stops(kept.begin(), kept.end());
  std::ranges::sort(stops);
  unsigned int first = STDERR_FILENO + 1;
  for (const unsigned int stop : stops) {
    if (first < stop) {
      ::syscall(SYS_close_range, first, stop - 1, 0);
    }
    first = std::max(first, stop + 1);
  }
  ::syscall(SYS_close_range, first, ~0U, 0);
}

// glibc has no wrappers for Landlock.
int landlock_version() {
  return static_cast<int>(
      ::syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION));
}

void allow_reading(int rules, const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (fd < 0) {
    return;  // a file that does not exist cannot be read
  }
  struct stat status {};
  ::fstat(fd, &status);
  landlock_path_beneath_attr below{};
  below.parent_fd = fd;
  below.allowed_access =
      LANDLOCK_ACCESS_FS_READ_FILE | (S_ISDIR(status.st_mode) ? LANDLOCK_ACCESS_FS_READ_DIR : 0U);
  const long added = ::syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &below, 0);
  const int error = errno;
  ::close(fd);
  if (added != 0) {
    throw_failed("landlock_add_rule", error);
  }
}

void restrict_files(const std::vector<std::filesystem::path>& readable) {
  if (landlock_version() < 1) {
    return;
  }
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1U) - 1;  // all rights of its first version
  const int rules = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0));
  if (rules < 0) {
    throw_failed("landlock_create_ruleset");
  }
  for (const std::filesystem::path& path : readable) {
    allow_reading(rules, path);
  }
  if (::syscall(SYS_landlock_restrict_self, rules, 0) != 0) {
    throw_failed("landlock_restrict_self");
  }
  ::close(rules);
}

bool has_filters() {
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  return ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

void restrict_calls() {
  if (!has_filters()) {
    return;
  }
  const std::unique_ptr<void, decltype(&::seccomp_release)> filter(::seccomp_init(SCMP_ACT_ALLOW),
                                                                   &::seccomp_release);
  if (!filter) {
    throw_failed("seccomp_init", ENOMEM);
  }
  const auto forbid = [&](const char* name, std::span<const scmp_arg_cmp> arguments) {
    const int call = ::seccomp_syscall_resolve_name(name);
    const int error =
        call == __NR_SCMP_ERROR  // unknown to this libseccomp
            ? 0
            : ::seccomp_rule_add_array(filter.get(), SCMP_ACT_ERRNO(EACCES), call,
                                       static_cast<unsigned int>(arguments.size()), arguments.data());
    if (error != 0) {
      throw_failed(name, -error);
    }
  };
  for (const char* name : forbidden_calls) {
    forbid(name, {});
  }
  const auto forbid_flag = [&](scmp_datum_t mask, scmp_datum_t value) {
    forbid("open", std::array{scmp_arg_cmp{1, SCMP_CMP_MASKED_EQ, mask, value}});
    forbid("openat", std::array{scmp_arg_cmp{2, SCMP_CMP_MASKED_EQ, mask, value}});
  };
  forbid_flag(O_ACCMODE, O_WRONLY);
  forbid_flag(O_ACCMODE, O_RDWR);
  forbid_flag(O_CREAT, O_CREAT);
  forbid_flag(O_TRUNC, O_TRUNC);
  if (const int error = ::seccomp_load(filter.get()); error != 0) {
    throw_failed("seccomp_load", -error);
  }
}

}  // namespace

void enter_reader_jail(const ReaderJail& jail, std::span<const int> kept) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  close_all_but(kept);
  limit_resources(jail);
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) {
    throw_failed("prctl");
  }
  restrict_files(jail.readable);
  restrict_calls();
}

std::string missing_from_reader_jail() {
  std::vector<std::string_view> missing;
  if (landlock_version() < 1) {
    missing.emplace_back("Landlock, which denies readers access to other files");
  }
  if (!has_filters()) {
    missing.emplace_back("seccomp, which denies them access to networks and other processes");
  }
  return missing.empty()
             ? ""
             : fmt::format("mesh and image files are read with fewer safeguards: this kernel lacks {}",
                           fmt::join(missing, " and "));
}

}  // namespace sonard::render
