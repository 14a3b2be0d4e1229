// SPDX-License-Identifier: Apache-2.0
#include "server/recording/recorder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <deque>
#include <mutex>
#include <optional>
#include <semaphore>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/error/error.hpp"
#include "server/recording/glf_packing.hpp"
#include "server/recording/log_set.hpp"
#include "server/recording/recovery.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;

constexpr int nice_value = 5;  // about a third of the processor time of a competing serving thread
constexpr std::chrono::milliseconds look_again{100};  // chunks and syncs may be due without an event
constexpr std::chrono::seconds sync_period{1};
/// The wall clock was set if it differs by more. Otherwise the next files keep the offset, so that a ping has
/// one time, also if its pose is in one file and its image in the next.
constexpr std::chrono::milliseconds clocks_agree{1};
constexpr std::chrono::seconds report_period{2};

[[noreturn]] void fail(const std::string& text) {
  throw Error(ErrorKind::configuration, text, "recording.directory");
}

/// An exclusive lock on a folder; it ends with the process.
class DirectoryLock {
 public:
  explicit DirectoryLock(const fs::path& directory) {
    std::error_code error;
    fs::create_directories(directory, error);
    fd_ = error ? -1 : ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (!error && fd_ < 0) {
      error = {errno, std::generic_category()};
    }
    if (!error && access(directory.c_str(), W_OK) != 0) {
      error = {errno, std::generic_category()};
    }
    if (error) {
      fail(fmt::format("cannot write into {}: {}", directory.string(), error.message()));
    }
    if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      fail(fmt::format("another daemon records into {}", directory.string()));
    }
  }
  ~DirectoryLock() { ::close(fd_); }
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int fd_ = -1;
};

/// Why no logs can begin in a folder; empty if they can.
std::string obstacle(const fs::path& directory) {
  std::error_code error;
  const fs::space_info space = fs::space(directory, error);
  if (error) {
    return fmt::format("{} cannot be used ({}; create the folder again)", directory.string(),
                       error.message());
  }
  return space.available >= Recorder::least_room_bytes
             ? ""
             : fmt::format("{} has no space for new logs (free at least {} MiB)", directory.string(),
                           Recorder::least_room_bytes >> 20);
}

}  // namespace

struct Recorder::Impl {
  Impl(const RecordingConfig& recording, std::vector<HeadToRecord> recorded)
      : config(recording), heads(std::move(recorded)), lock(config.directory), queue(config.queue_bytes) {}

  void run();
  void record(const RecordingEvent& event);
  void look_after_logs();
  void begin_set(TimePoint now);
  void end_set();
  void pack_slice();
  void report_drops();
  void log_totals() const;
  void log_unwritten() const;
  RecorderCounters counters() const;

  const RecordingConfig config;
  const std::vector<HeadToRecord> heads;
  DirectoryLock lock;
  EventQueue queue;
  SteadyClock clock;
  std::atomic<bool> stopping{false};
  std::atomic<bool> abandoned{false};  // nothing more is written
  std::binary_semaphore ended{0};
  std::atomic<bool> on{true};
  std::atomic<std::uint64_t> images_pushed{0}, images{0}, images_lost{0}, logs_written{0}, logs_failed{0};
  std::mutex report;  // guards reported_at and drops_reported
  TimePoint reported_at{};
  std::uint64_t drops_reported = 0;

  // Used by the recorder's thread only:
  std::optional<LogSet> set;
  std::deque<GlfPacking> packings;
  std::chrono::nanoseconds unix_offset{0};  ///< of the newest set
  TimePoint synced_at{};
  bool without_room = false;

  std::thread thread;  // last member: it uses all of the above
};

Recorder::Recorder(const RecordingConfig& config, std::vector<HeadToRecord> heads)
    : impl_(std::make_shared<Impl>(config, std::move(heads))) {
  for (const fs::path& dat : recover_logs(config.directory)) {
    impl_->packings.emplace_back(dat, config.sync);
  }
  impl_->thread = std::thread([impl = impl_] {
    impl->run();
    impl->ended.release();
  });
}

Recorder::~Recorder() {
  stop();
}

void Recorder::push(RecordingEvent event) {
  if (!impl_->on) {
    return;
  }
  const bool image = std::holds_alternative<PingSent>(event.what);
  if (impl_->queue.push(std::move(event))) {
    impl_->images_pushed += image ? 1 : 0;
  } else {
    impl_->report_drops();  // here, because the recorder's thread may be waiting for the disk
  }
}

bool Recorder::stores_statuses(int head) const {
  return impl_->config.glf && impl_->heads.at(static_cast<std::size_t>(head)).glf != nullptr;
}

void Recorder::turn(bool on) {
  if (impl_->on.exchange(on) != on) {
    spdlog::info("recording: turned {}", on ? "on" : "off");
    impl_->queue.wake();
  }
}

bool Recorder::on() const {
  return impl_->on;
}

bool Recorder::stop() {
  if (impl_->stopping.exchange(true)) {
    return !impl_->abandoned;
  }
  impl_->queue.wake();
  if (impl_->ended.try_acquire_for(impl_->config.stop_deadline)) {
    impl_->thread.join();
  } else {
    impl_->abandoned = true;
    impl_->thread.detach();
    impl_->log_unwritten();
  }
  impl_->log_totals();
  return !impl_->abandoned;
}

RecorderCounters Recorder::counters() const {
  return impl_->counters();
}

RecorderCounters Recorder::Impl::counters() const {
  return {queue.dropped(), images, images_lost, logs_written, logs_failed};
}

void Recorder::Impl::run() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), nice_value);
  for (bool last = false; !last;) {
    queue.wait(packings.empty() ? look_again : std::chrono::milliseconds{0});
    // Read before the queue is taken: events pushed before stop() and turn(false) are then in it.
    last = stopping;
    const bool off = !on;
    for (RecordingEvent& event : queue.take()) {
      if (abandoned) {
        return;
      }
      record(event);
      queue.done(event);
      event.what = StreamEnded{};  // frees its memory now
    }
    if (off && !on) {  // else it was turned on again, and the events may belong to new logs
      end_set();
    }
    look_after_logs();
    pack_slice();
  }
  if (!abandoned) {
    end_set();
  }
  while (!abandoned && !packings.empty()) {
    pack_slice();
  }
}

void Recorder::Impl::record(const RecordingEvent& event) {
  if (set && set->is_over(event.time)) {
    end_set();
  }
  if (!set) {
    if (!on) {  // pushed just before it was turned off: no log is made for it
      return;
    }
    begin_set(event.time);
  }
  set->write(event);
  set->flush(clock.now());
  if (std::holds_alternative<PingSent>(event.what)) {
    ++images;
    images_lost += set->any_good() ? 0 : 1;
  }
}

void Recorder::Impl::look_after_logs() {
  const TimePoint now = clock.now();
  if (set) {
    set->flush(now);
    if (config.sync == RecordingSync::every_second && now - synced_at >= sync_period) {
      set->sync();
      synced_at = now;
    }
  }
  report_drops();
}

void Recorder::Impl::begin_set(TimePoint now) {
  const std::string why = obstacle(config.directory);
  const bool room = why.empty();
  if (!room && !without_room) {
    spdlog::error("recording: {}: nothing is recorded, serving continues", why);
  }
  without_room = !room;
  const std::chrono::nanoseconds offset = unix_time_offset();
  if (std::chrono::abs(offset - unix_offset) > clocks_agree) {
    unix_offset = offset;
  }
  set.emplace(config, heads, unix_offset, now, room);
}

void Recorder::Impl::end_set() {
  if (!set) {
    return;
  }
  const LogSet::Closed closed = set->close();
  set.reset();
  logs_written += closed.written;
  logs_failed += closed.failed;
  for (const fs::path& dat : closed.dats) {
    packings.emplace_back(dat, config.sync);
  }
}

void Recorder::Impl::pack_slice() {
  if (!packings.empty() && !packings.front().step()) {
    packings.pop_front();
  }
}

/// Any thread; never blocks.
void Recorder::Impl::report_drops() {
  const std::unique_lock lock_report(report, std::try_to_lock);
  const TimePoint now = clock.now();
  if (!lock_report || (drops_reported > 0 && now - reported_at < report_period)) {
    return;
  }
  const DroppedEvents dropped = queue.dropped();
  if (dropped.total() > drops_reported) {
    reported_at = now;
    drops_reported = dropped.total();
    spdlog::warn("recording: disk too slow, dropped so far: images={} wire_pieces={} others={}",
                 dropped.images, dropped.pieces, dropped.others);
  }
}

void Recorder::Impl::log_unwritten() const {
  spdlog::error(
      "recording: the disk is too slow to end within stop_deadline_s={}, not on the disk: images={} bytes={} "
      "(the next start repairs the logs in {})",
      std::chrono::duration<double>(config.stop_deadline).count(), images_pushed - images, queue.bytes(),
      config.directory.string());
}

void Recorder::Impl::log_totals() const {
  const RecorderCounters total = counters();
  spdlog::info(
      "recording: ended images={} images_lost={} logs_written={} logs_failed={} dropped_images={} "
      "dropped_wire_pieces={} dropped_others={}",
      total.images, total.images_lost, total.logs_written, total.logs_failed, total.dropped.images,
      total.dropped.pieces, total.dropped.others);
}

void try_recording_into(const fs::path& directory) {
  std::error_code error;
  if (fs::exists(directory, error)) {
    const DirectoryLock lock(directory);
  }
}

}  // namespace sonard::server
