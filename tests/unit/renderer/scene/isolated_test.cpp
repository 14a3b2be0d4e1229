// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/isolated.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iostream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

TEST(Isolated, HandsBackBytesAndLog) {
  const std::string big(3'000'000, 'x');
  const IsolatedResult result = run_isolated(
      [&] {
        std::cerr << "remark\n";
        return big;
      },
      {.processor_limit_s = 10});
  EXPECT_EQ(result.bytes, big);
  EXPECT_NE(result.log.find("remark"), std::string::npos);
}

TEST(Isolated, PassesOnAnException) {
  try {
    run_isolated([]() -> std::string { throw std::runtime_error("no such thing"); },
                 {.processor_limit_s = 10});
    FAIL();
  } catch (const IsolatedFailure& failure) {
    EXPECT_STREQ(failure.what(), "no such thing");
  }
}

TEST(Isolated, SurvivesACrash) {
  EXPECT_THROW(run_isolated(
                   []() -> std::string {
                     std::raise(SIGSEGV);
                     return {};
                   },
                   {.processor_limit_s = 10}),
               IsolatedFailure);
}

TEST(Isolated, SurvivesAnExit) {
  EXPECT_THROW(run_isolated([]() -> std::string { ::_exit(0); }, {.processor_limit_s = 10}), IsolatedFailure);
}

TEST(Isolated, EndsAnEndlessLoop) {
  EXPECT_THROW(run_isolated(
                   []() -> std::string {
                     for (volatile int i = 0;;) {
                       i = i + 1;
                     }
                   },
                   {.processor_limit_s = 1}),
               IsolatedFailure);
}

TEST(Isolated, LeavesThisProcessAlone) {
  int value = 1;
  run_isolated(
      [&] {
        value = 2;
        return std::string("done");
      },
      {.processor_limit_s = 10});
  EXPECT_EQ(value, 1);
}

/// Result of `work` in a child process that may read `folder` only.
std::string said_in_jail(const std::filesystem::path& folder, const std::function<std::string()>& work) {
  ReaderJail jail;
  jail.readable = {folder};
  return run_isolated(work, jail).bytes;
}

bool can_read(const std::filesystem::path& file) {
  return std::ifstream(file).get() != std::ifstream::traits_type::eof();
}

TEST(ReaderJail, LetsOneFolderBeRead) {
  if (missing_from_reader_jail().find("Landlock") != std::string::npos) {
    GTEST_SKIP() << missing_from_reader_jail();
  }
  const test::TempFolder world, elsewhere;
  const auto inside = world.write("meshes/hull.stl", "x"), outside = elsewhere.write("secret", "x");
  std::filesystem::create_symlink(outside, world.path() / "link");
  EXPECT_EQ(said_in_jail(world.path(), [&] { return can_read(inside) ? "read" : "refused"; }), "read");
  for (const std::filesystem::path& file :
       {outside, world.path() / "link", std::filesystem::path("/etc/passwd")}) {
    ASSERT_TRUE(can_read(file));
    EXPECT_EQ(said_in_jail(world.path(), [&] { return can_read(file) ? "read" : "refused"; }), "refused")
        << file;
  }
}

TEST(ReaderJail, LetsNothingBeWritten) {
  const test::TempFolder world;
  const auto file = world.write("hull.stl", "x");
  const std::string said = said_in_jail(world.path(), [&]() -> std::string {
    const std::string made = world.path() / "made";
    for (const int flags : {O_WRONLY, O_RDWR, O_WRONLY | O_TRUNC, O_RDONLY | O_TRUNC}) {
      if (::open(file.c_str(), flags) >= 0) {
        return "opened";
      }
    }
    return ::open(made.c_str(), O_CREAT | O_WRONLY, 0600) >= 0 || ::mkdir(made.c_str(), 0700) == 0 ||
                   ::unlink(file.c_str()) == 0 || ::rename(file.c_str(), made.c_str()) == 0 ||
                   ::truncate(file.c_str(), 0) == 0
               ? "written"
               : "refused";
  });
  EXPECT_EQ(said, "refused");
  EXPECT_EQ(std::filesystem::file_size(file), 1U);
}

TEST(ReaderJail, HasNoNetworkAndStartsNoProcess) {
  const std::string said = said_in_jail("/nowhere", []() -> std::string {
    for (const int family : {AF_INET, AF_INET6, AF_UNIX, AF_NETLINK}) {
      if (::socket(family, SOCK_DGRAM, 0) >= 0) {
        return "a socket of family " + std::to_string(family);
      }
    }
    const pid_t child = ::fork();
    if (child == 0) {
      ::_exit(0);
    }
    return child > 0 ? "a process" : ::kill(::getppid(), 0) == 0 ? "a signal" : "nothing";
  });
  EXPECT_EQ(said, "nothing");
}

TEST(ReaderJail, InheritsNoDescriptor) {
  const int open = ::open("/dev/null", O_RDONLY);  // NOLINT(cppcoreguidelines-init-variables)
  const std::string said = said_in_jail("/nowhere", [&]() -> std::string {
    char byte = 0;
    return ::fcntl(open, F_GETFD) < 0 && ::read(STDIN_FILENO, &byte, 1) == 0 ? "closed" : "open";
  });
  ::close(open);
  EXPECT_EQ(said, "closed");
}

TEST(ReaderJail, HasAnEndOfMemory) {
  if (!reader_memory_is_limited) {
    GTEST_SKIP() << "a sanitizer takes all of the address space";
  }
  ReaderJail jail;
  jail.memory_limit_bytes = std::uint64_t{64} << 20U;
  try {
    run_isolated([] { return std::string(std::size_t{200} << 20U, 'x'); }, jail);
    FAIL();
  } catch (const IsolatedFailure& failure) {
    EXPECT_THAT(failure.what(), testing::HasSubstr("takes more than 64 MiB of memory"));
  }
}

}  // namespace
}  // namespace sonard::render
