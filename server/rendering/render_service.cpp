// SPDX-License-Identifier: Apache-2.0
#include "server/rendering/render_service.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <deque>
#include <exception>
#include <fstream>
#include <future>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>

namespace sonard::server {
namespace {

constexpr std::size_t most_unknown_bodies = 16;

/// Pose of a hidden body, beyond the reach of any ping, so that the renderer drops the body. It is always the
/// same pose, so that an unchanged scene stays unchanged. Heads that share a renderer and hide different
/// bodies each move the body for their pings.
const render::Pose out_of_sight{{0.0, 0.0, -1e6}, {1.0, 0.0, 0.0, 0.0}};

/// True if the kernel may refuse memory to this process. Otherwise a request always succeeds and proves
/// nothing.
bool memory_is_limited() {
  static const bool strict = [] {
    int policy = 0;
    std::ifstream("/proc/sys/vm/overcommit_memory") >> policy;
    return policy == 2;
  }();
  rlimit limit{};
  return strict || (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY);
}

/// Tests for room for a ping's messages, records and pictures on other threads, which cannot give up a ping
/// half done.
/// @throws std::bad_alloc
void make_sure_of_room(const render::PingSamples& samples) {
  if (!memory_is_limited()) {
    return;
  }
  constexpr std::size_t at_least_bytes = 4 << 20;
  constexpr std::size_t copies = 12;
  const std::size_t bytes = at_least_bytes + copies * (samples.u8.size() + 2 * samples.u16.size() +
                                                       8 * samples.directions.range_m.size());
  void* volatile room = std::malloc(bytes);  // volatile: so that the allocation is not optimised away
  if (room == nullptr) {
    throw std::bad_alloc();
  }
  std::free(room);
}

}  // namespace

struct RenderService::Impl {
  struct WarmUp {
    std::vector<render::HeadRequest> first_pings;
    std::promise<void> done;
  };
  struct Entry {
    std::shared_ptr<const PosedPing> ping;  ///< null: a warm-up
    Done done;
    std::optional<WarmUp> warm_up{};  ///< set: a warm-up, without `done`
  };

  // Constant after the constructor.
  RenderServiceHooks hooks;
  std::size_t capacity = 0;

  // Shared; guarded by the mutex.
  std::mutex mutex;
  std::string description;
  std::condition_variable wake;
  std::deque<Entry> queue;
  bool stopping = false;

  // Used by the render thread only:
  std::set<std::string> unknown_bodies;

  std::thread thread;

  void run(const RendererFactory& make_renderer, std::promise<void> ready);
  std::optional<Entry> next();
  void describe(const PingRenderer& renderer);
  std::vector<render::HeadRequest> next_pings(const PosedPing& first);
  void serve(PingRenderer& renderer);
  void warm_up(PingRenderer& renderer, WarmUp& warm_up);
  void move_bodies(PingRenderer& renderer, const PosedPing& ping);
  RenderResult render(PingRenderer& renderer, const PosedPing& ping,
                      const std::vector<render::HeadRequest>& next);
  void close_queue();
};

RenderService::RenderService(const RendererFactory& make_renderer, int head_count, RenderServiceHooks hooks)
    : impl_(std::make_unique<Impl>()) {
  impl_->hooks = std::move(hooks);
  impl_->capacity = static_cast<std::size_t>(head_count);
  std::promise<void> ready;
  std::future<void> made = ready.get_future();
  impl_->thread = std::thread(&Impl::run, impl_.get(), std::cref(make_renderer), std::move(ready));
  try {
    made.get();
  } catch (...) {
    impl_->thread.join();
    throw;
  }
}

RenderService::~RenderService() {
  stop();
}

void RenderService::submit(PosedPing ping, Done done) {
  Impl::Entry entry{std::make_shared<const PosedPing>(std::move(ping)), std::move(done)};
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->stopping) {
      return;
    }
    if (impl_->queue.size() >= impl_->capacity) {
      throw std::logic_error("render queue is full: a head has more than one job outstanding");
    }
    impl_->queue.push_back(std::move(entry));
  }
  impl_->wake.notify_one();
}

void RenderService::warm_up(std::vector<render::HeadRequest> first_pings) {
  Impl::WarmUp warm_up{std::move(first_pings), {}};
  std::future<void> done = warm_up.done.get_future();
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->stopping) {
      throw std::future_error(std::future_errc::broken_promise);
    }
    impl_->queue.push_back({{}, {}, std::move(warm_up)});
  }
  impl_->wake.notify_one();
  done.get();
}

bool RenderService::withdraw(int head) {
  std::optional<Impl::Entry> forgotten;  // destroyed outside the lock: its callback owns other objects
  const std::lock_guard lock(impl_->mutex);
  const auto entry =
      std::find_if(impl_->queue.begin(), impl_->queue.end(),
                   [head](const Impl::Entry& waiting) { return waiting.ping && waiting.ping->head == head; });
  if (entry == impl_->queue.end()) {
    return false;
  }
  forgotten = std::move(*entry);
  impl_->queue.erase(entry);
  return true;
}

void RenderService::stop() {
  impl_->close_queue();
  if (impl_->thread.joinable()) {
    impl_->thread.join();
  }
}

std::string RenderService::renderer_description() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->description;
}

void RenderService::Impl::describe(const PingRenderer& renderer) {
  std::string now = renderer.description();
  const std::lock_guard lock(mutex);
  description.swap(now);
}

void RenderService::Impl::close_queue() {
  std::deque<Entry> forgotten;  // destroyed outside the lock: the callbacks own objects of other classes
  {
    const std::lock_guard lock(mutex);
    stopping = true;
    forgotten.swap(queue);
  }
  wake.notify_one();
}

// The renderer lives and dies inside this function: its GL context belongs to this thread.
void RenderService::Impl::run(const RendererFactory& make_renderer, std::promise<void> ready) {
  std::unique_ptr<PingRenderer> renderer;
  try {
    renderer = make_renderer();
    describe(*renderer);
  } catch (...) {
    ready.set_exception(std::current_exception());
    return;
  }
  ready.set_value();  // make_renderer may be destroyed from here on

  try {
    serve(*renderer);
  } catch (const std::exception& error) {
    close_queue();
    hooks.post([on_failure = hooks.on_failure, what = std::string(error.what())] { on_failure(what); });
  }
}

std::optional<RenderService::Impl::Entry> RenderService::Impl::next() {
  std::unique_lock lock(mutex);
  wake.wait(lock, [this] { return stopping || !queue.empty(); });
  if (stopping) {
    return std::nullopt;
  }
  Entry entry = std::move(queue.front());
  queue.pop_front();
  return entry;
}

void RenderService::Impl::serve(PingRenderer& renderer) {
  while (std::optional<Entry> entry = next()) {
    if (entry->warm_up) {
      warm_up(renderer, *entry->warm_up);
      continue;
    }
    RenderResult result =
        render(renderer, *entry->ping,
               renderer.begins_pings() ? next_pings(*entry->ping) : std::vector<render::HeadRequest>());
    describe(renderer);
    if (result.error.empty() && hooks.observe) {
      hooks.observe(*entry->ping, result.samples);
    }
    // std::function needs copyable captures, so a pointer holds the samples.
    auto shared = std::make_shared<RenderResult>(std::move(result));
    hooks.post([done = std::move(entry->done), shared] { done(std::move(*shared)); });
  }
}

void RenderService::Impl::warm_up(PingRenderer& renderer, WarmUp& warm_up) {
  try {
    renderer.warm_up(warm_up.first_pings);
    describe(renderer);
    warm_up.done.set_value();
  } catch (...) {
    warm_up.done.set_exception(std::current_exception());
  }
}

/// This ping and the waiting pings that move no body; empty if this ping is the only one.
std::vector<render::HeadRequest> RenderService::Impl::next_pings(const PosedPing& first) {
  std::vector<std::shared_ptr<const PosedPing>> waiting;
  {
    const std::lock_guard lock(mutex);
    for (const Entry& entry : queue) {
      waiting.push_back(entry.ping);
    }
  }
  std::vector<render::HeadRequest> pings;
  for (const auto& ping : waiting) {  // copied without the lock
    if (ping == nullptr || ping->poses->bodies != first.poses->bodies ||
        ping->hidden_body != first.hidden_body) {
      break;
    }
    if (pings.empty()) {
      pings.push_back({first.head, first.request});
    }
    pings.push_back({ping->head, ping->request});
  }
  return pings;
}

/// @param next from next_pings()
RenderResult RenderService::Impl::render(PingRenderer& renderer, const PosedPing& ping,
                                         const std::vector<render::HeadRequest>& next) {
  RenderResult result;
  try {
    move_bodies(renderer, ping);
    if (next.size() > 1) {
      renderer.begin_pings(next);
    }
    result.samples = renderer.render_ping(ping.request, ping.head);
    make_sure_of_room(result.samples);
    result.statistics = renderer.last_statistics();
  } catch (const render::RequestError& error) {
    result.error = error.what();
  } catch (const std::bad_alloc&) {  // a too large request must not end other clients
    result.samples = {};
    renderer.forget(ping.head);
    result.error = "out of memory for this ping; use a shorter range or fewer bins";
  }
  return result;
}

void RenderService::Impl::move_bodies(PingRenderer& renderer, const PosedPing& ping) {
  for (const PosedBody& body : ping.poses->bodies) {
    // Names come from the network: invented names must not fill memory or log.
    if (!renderer.set_body_pose(body.name, body.T_world_body) &&
        unknown_bodies.size() < most_unknown_bodies && unknown_bodies.insert(body.name).second) {
      spdlog::warn("pose stream: body '{}' is not in the world (ignored)", body.name);
    }
  }
  if (!ping.hidden_body.empty()) {
    renderer.set_body_pose(ping.hidden_body, out_of_sight);
  }
}

}  // namespace sonard::server
