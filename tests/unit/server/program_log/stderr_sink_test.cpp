// SPDX-License-Identifier: Apache-2.0
// If the reader of the log stops, no caller waits, and the log later states how many lines were dropped.
#include "server/program_log/stderr_sink.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>

namespace sonard::server {
namespace {

using testing::HasSubstr;

struct Ends {
  int read = -1, write = -1;

  static Ends of_pipe() {
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe(ends.data()), 0);
    return {ends[0], ends[1]};
  }
  static Ends of_socket() {
    std::array<int, 2> ends{};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    return {ends[0], ends[1]};
  }
  void close() const {
    ::close(read);
    ::close(write);
  }
  std::string take() const {
    fcntl(read, F_SETFL, O_NONBLOCK);
    std::string all;
    std::array<char, 65536> some{};
    for (ssize_t length = 0; (length = ::read(read, some.data(), some.size())) > 0;) {
      all.append(some.data(), static_cast<std::size_t>(length));
    }
    return all;
  }
};

spdlog::logger logger_on(int descriptor) {
  spdlog::logger logger("test", std::make_shared<StderrSink>(descriptor));
  logger.set_pattern("%v");
  return logger;
}

class StderrSinkTest : public testing::TestWithParam<bool> {
 protected:
  Ends ends = GetParam() ? Ends::of_socket() : Ends::of_pipe();
  ~StderrSinkTest() override { ends.close(); }
};
INSTANTIATE_TEST_SUITE_P(kinds, StderrSinkTest, testing::Bool(),
                         [](const auto& kind) { return std::string(kind.param ? "socket" : "pipe"); });

TEST_P(StderrSinkTest, WritesLines) {
  spdlog::logger logger = logger_on(ends.write);
  logger.info("one");
  logger.info("two");
  EXPECT_EQ(ends.take(), "one\ntwo\n");
}

/// Has no memory for lines that begin with "long".
struct LongLinesFail final : spdlog::formatter {
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    const std::string_view text(message.payload.data(), message.payload.size());
    if (text.starts_with("long")) {
      throw std::bad_alloc();
    }
    line.append(text.data(), text.data() + text.size());
    line.push_back('\n');
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<LongLinesFail>(); }
};

TEST_P(StderrSinkTest, LinesWithoutMemoryAreDroppedAndCounted) {
  const auto sink = std::make_shared<StderrSink>(ends.write);
  spdlog::logger logger("test", sink);
  logger.set_formatter(std::make_unique<LongLinesFail>());
  logger.info("long line");
  logger.info("long line");
  sink->drop_line();
  EXPECT_EQ(ends.take(), "");
  logger.info("next");
  logger.info("last");
  EXPECT_EQ(ends.take(), "log: 3 lines were dropped, because memory ran out\nnext\nlast\n");
}

TEST_P(StderrSinkTest, AReaderThatStopsBlocksNobodyAndIsToldWhatItMissed) {
  spdlog::logger logger = logger_on(ends.write);
  constexpr int lines = 20'000;  // far more than the buffer holds
  for (int i = 0; i < lines; ++i) {
    logger.info("line {:06} {}", i, std::string(60, '.'));
  }
  const std::string first = ends.take();
  EXPECT_THAT(first, HasSubstr("line 000000"));
  const auto whole = static_cast<int>(first.size() / 73);
  EXPECT_EQ(first.size() % 73, 0U) << "whole lines";
  logger.info("last");
  EXPECT_EQ(ends.take(), "log: " + std::to_string(lines - whole) +
                             " lines were dropped, because stderr was blocked\nlast\n");
}

TEST_P(StderrSinkTest, TheDescriptorItselfStaysAsItWas) {
  const int before = fcntl(ends.write, F_GETFL);
  logger_on(ends.write).info("x");
  EXPECT_EQ(fcntl(ends.write, F_GETFL), before) << "a shell may share it";
  EXPECT_EQ(before & O_NONBLOCK, 0);
}

TEST(StderrSinkFile, AppendsWhereOthersWriteToo) {
  std::string name = "/tmp/sonard_stderr_sink_XXXXXX";
  const int file = mkstemp(name.data());
  ASSERT_GE(file, 0);
  spdlog::logger logger = logger_on(file);
  logger.info("one");
  EXPECT_EQ(write(file, "other\n", 6), 6);
  logger.info("two");
  std::array<char, 64> text{};
  EXPECT_EQ(pread(file, text.data(), text.size(), 0), 14);
  EXPECT_STREQ(text.data(), "one\nother\ntwo\n");
  close(file);
  unlink(name.c_str());
}

}  // namespace
}  // namespace sonard::server
