// SPDX-License-Identifier: Apache-2.0
// A disk that hangs: this program's pwrite() waits until the test lets it go on.
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <future>

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "server/recording/recorder.hpp"
#include "tests/support/wait_for.hpp"
#include "tests/unit/server/recording/fixture.hpp"

namespace {

std::atomic<bool> disk_hangs{false};
std::atomic<int> writes_waiting{0};

}  // namespace

extern "C" ssize_t pwrite(int fd, const void* bytes, size_t size, off_t offset) {
  ++writes_waiting;
  disk_hangs.wait(true);
  --writes_waiting;
  return syscall(SYS_pwrite64, fd, bytes, size, offset);
}

namespace sonard::server {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;

struct SlowDisk : testing::Test {
  test::TemporaryFolder folder;
  RecordingConfig config;
  SteadyClock clock;
  std::ostringstream log;
  std::shared_ptr<spdlog::logger> before = spdlog::default_logger();

  SlowDisk() {
    config.directory = folder.path();
    config.sync = RecordingSync::never;
    config.stop_deadline = milliseconds{200};
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  }
  ~SlowDisk() override {
    hang(false);
    spdlog::set_default_logger(before);
  }

  static void hang(bool on) {
    disk_hangs = on;
    disk_hangs.notify_all();
  }
  /// A recorder whose thread waits for the disk.
  std::unique_ptr<Recorder> waiting_recorder() {
    hang(true);
    auto recorder = std::make_unique<Recorder>(config, test::one_head());
    recorder->push(test::ping_event(0, 200, clock.now()));
    EXPECT_TRUE(test::wait_for([] { return writes_waiting > 0; }));
    return recorder;
  }
};

TEST_F(SlowDisk, RecorderEndsByItsDeadlineAndLogsWhatIsNotWritten) {
  const auto recorder = waiting_recorder();
  recorder->push(test::ping_event(1, 200, clock.now()));
  auto ended = std::async(std::launch::async, [&] { return recorder->stop(); });
  const bool in_time = ended.wait_for(seconds{5}) == std::future_status::ready;
  if (!in_time) {
    hang(false);
  }
  EXPECT_TRUE(in_time);
  EXPECT_FALSE(ended.get());
  EXPECT_NE(log.str().find("not on the disk: images=2 "), std::string::npos) << log.str();
  EXPECT_FALSE(recorder->stop()) << "called again";
  hang(false);
  EXPECT_TRUE(test::wait_for([] { return writes_waiting == 0; }));
}

TEST_F(SlowDisk, DropsAreLoggedWhileTheDiskHangs) {
  config.queue_bytes = 100'000;
  const auto recorder = waiting_recorder();
  for (std::uint64_t number = 1; number < 10; ++number) {
    recorder->push(test::ping_event(number, 200, clock.now()));
  }
  EXPECT_NE(log.str().find("disk too slow, dropped so far: images="), std::string::npos) << log.str();
  hang(false);
}

TEST_F(SlowDisk, AFolderThatWasRemovedIsNamed) {
  Recorder recorder(config, test::one_head());
  std::filesystem::remove_all(config.directory);
  recorder.push(test::ping_event(0, 200, clock.now()));
  recorder.stop();
  EXPECT_NE(log.str().find("cannot be used (No such file or directory; create the folder again)"),
            std::string::npos)
      << log.str();
  EXPECT_EQ(log.str().find("no space"), std::string::npos) << log.str();
}

}  // namespace
}  // namespace sonard::server
