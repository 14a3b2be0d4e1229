// SPDX-License-Identifier: Apache-2.0
#include "server/rendering/render_service.hpp"

#include <atomic>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/fake_renderer.hpp"
#include "tests/support/wait_for.hpp"

namespace sonard::server {
namespace {

using test::fake_renderer_factory;
using test::FakeRendererControl;

// Stands for the I/O thread. It collects posted tasks, and the test runs them.
class Inbox {
 public:
  Post post() {
    return [this](std::function<void()> task) {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(std::move(task));
    };
  }

  // Runs tasks until `done`. Returns false if that takes too long.
  bool run_until(const std::function<bool()>& done) {
    return test::wait_for([&] {
      run_pending();
      return done();
    });
  }

  void run_pending() {
    std::deque<std::function<void()>> tasks;
    {
      const std::lock_guard lock(mutex_);
      tasks.swap(tasks_);
    }
    for (const auto& task : tasks) {
      task();
    }
  }

 private:
  std::mutex mutex_;
  std::deque<std::function<void()>> tasks_;
};

PosedPing small_job(std::uint64_t number, int head = 0) {
  PosedPing job;
  job.head = head;
  job.request.ping_number = number;
  job.request.settings.aperture.beam_edges_rad = {0.2, 0.0, -0.2};
  job.request.settings.range.count = 3;
  return job;
}

struct Fixture : testing::Test {
  Inbox inbox;
  std::shared_ptr<FakeRendererControl> control = std::make_shared<FakeRendererControl>();
  std::string failure;

  RenderServiceHooks hooks() {
    RenderServiceHooks hooks;
    hooks.post = inbox.post();
    hooks.on_failure = [this](const std::string& what) { failure = what; };
    return hooks;
  }
};

using RenderServiceTest = Fixture;

// The renderer may start on waiting jobs too, up to the first one with other poses of bodies.
TEST_F(RenderServiceTest, TellsTheRendererWhatComesNext) {
  std::promise<void> all_submitted;
  std::future<void> go = all_submitted.get_future();
  control->before_ping = [&](const render::PingRequest& request, int) {
    if (request.ping_number == 0) {
      go.wait();
    }
  };
  int answers = 0;
  {
    RenderService service(fake_renderer_factory(control), 5, hooks());
    for (int head = 0; head < 5; ++head) {
      PosedPing job = small_job(static_cast<std::uint64_t>(head), head);
      if (head == 4) {
        job.poses = std::make_shared<const PosesUsed>(PosesUsed{{}, {}, {}, {{"boat", {}}}});
      }
      service.submit(std::move(job), [&](const RenderResult&) { ++answers; });
    }
    all_submitted.set_value();
    EXPECT_TRUE(inbox.run_until([&] { return answers == 5; }));
  }
  // Ping 0 may have begun before the other jobs arrived.
  ASSERT_GE(control->begun.size(), 2U);
  EXPECT_EQ(control->begun[control->begun.size() - 2], (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(control->begun.back(), (std::vector<int>{2, 3}));
}

TEST_F(RenderServiceTest, RendersOnItsOwnThreadAndAnswersOnOurs) {
  std::thread::id renderer_thread;
  control->before_ping = [&](const render::PingRequest&, int) {
    renderer_thread = std::this_thread::get_id();
  };
  RenderService service(fake_renderer_factory(control), 1, hooks());
  EXPECT_EQ(service.renderer_description(), "fake");
  std::optional<RenderResult> result;
  std::thread::id answer_thread;
  service.submit(small_job(5), [&](RenderResult r) {
    result = std::move(r);
    answer_thread = std::this_thread::get_id();
  });
  ASSERT_TRUE(inbox.run_until([&] { return result.has_value(); }));
  EXPECT_EQ(answer_thread, std::this_thread::get_id());
  EXPECT_NE(renderer_thread, std::this_thread::get_id());
  EXPECT_EQ(result->error, "");
  // fake_sample(5, line, beam) = 35 + 3 line + beam
  EXPECT_EQ(result->samples.u8, (std::vector<std::uint8_t>{35, 36, 38, 39, 41, 42}));
}

TEST_F(RenderServiceTest, CallerGetsTheReasonWhenTheRendererCannotBeMade) {
  const RendererFactory failing = []() -> std::unique_ptr<PingRenderer> {
    throw render::RendererError("no GL");
  };
  try {
    RenderService service(failing, 1, hooks());
    FAIL() << "no exception";
  } catch (const render::RendererError& error) {
    EXPECT_STREQ(error.what(), "no GL");
  }
}

TEST_F(RenderServiceTest, RendererIsMadeAndDestroyedOnTheSameThread) {
  struct Probe final : PingRenderer {
    explicit Probe(std::thread::id& destroyed) : destroyed_on(destroyed) {}
    ~Probe() override { destroyed_on = std::this_thread::get_id(); }
    std::string description() const override { return "probe"; }
    bool set_body_pose(const std::string&, const render::Pose&) override { return true; }
    render::PingSamples render_ping(const render::PingRequest&, int) override { return {}; }
    render::PingStatistics last_statistics() const override { return {}; }
    std::thread::id& destroyed_on;
  };
  std::thread::id made_on;
  std::thread::id destroyed_on;
  {
    RenderService service(
        [&] {
          made_on = std::this_thread::get_id();
          return std::make_unique<Probe>(destroyed_on);
        },
        1, hooks());
  }
  EXPECT_EQ(made_on, destroyed_on);
  EXPECT_NE(made_on, std::this_thread::get_id());
}

TEST_F(RenderServiceTest, RequestErrorFailsOnePingOnly) {
  control->before_ping = [](const render::PingRequest& request, int) {
    if (request.ping_number == 1) {
      throw render::RequestError("range is not positive");
    }
  };
  RenderService service(fake_renderer_factory(control), 1, hooks());
  std::vector<std::string> errors;
  for (std::uint64_t number = 1; number <= 2; ++number) {
    service.submit(small_job(number), [&](RenderResult result) { errors.push_back(result.error); });
    ASSERT_TRUE(inbox.run_until([&] { return errors.size() == number; }));
  }
  EXPECT_EQ(errors, (std::vector<std::string>{"range is not positive", ""}));
  EXPECT_EQ(failure, "");
}

TEST_F(RenderServiceTest, MemoryThatRunsOutFailsOnePingOnly) {
  control->before_ping = [](const render::PingRequest& request, int) {
    if (request.ping_number == 1) {
      throw std::bad_alloc();
    }
  };
  RenderService service(fake_renderer_factory(control), 2, hooks());
  std::vector<std::string> errors(2, "none yet");
  for (const int head : {0, 1}) {
    service.submit(small_job(static_cast<std::uint64_t>(1 + head), head),
                   [&errors, head](const RenderResult& result) {
                     errors[static_cast<std::size_t>(head)] = result.error;
                   });
  }
  ASSERT_TRUE(inbox.run_until([&] { return errors[1] != "none yet"; }));
  EXPECT_NE(errors[0].find("out of memory for this ping"), std::string::npos) << errors[0];
  EXPECT_EQ(errors[1], "");
  EXPECT_EQ(control->forgotten, 1);
  EXPECT_EQ(failure, "");
}

TEST_F(RenderServiceTest, TellsWhichEngineMadeTheNewestPing) {
  control->before_ping = [this](const render::PingRequest& request, int) {
    control->engine = request.ping_number == 2 ? "cpu, because the GPU is lost" : "gpu";
  };
  RenderService service(fake_renderer_factory(control), 1, hooks());
  EXPECT_EQ(service.renderer_description(), "fake");
  for (const auto& [number, engine] : std::vector<std::pair<std::uint64_t, std::string>>{
           {1, "gpu"}, {2, "cpu, because the GPU is lost"}, {3, "gpu"}}) {
    bool answered = false;
    service.submit(small_job(number), [&](const RenderResult&) { answered = true; });
    ASSERT_TRUE(inbox.run_until([&] { return answered; }));
    EXPECT_EQ(service.renderer_description(), engine);
  }
}

TEST_F(RenderServiceTest, RendererErrorIsReportedOnceAndEndsTheService) {
  control->before_ping = [](const render::PingRequest&, int) { throw render::RendererError("context lost"); };
  RenderService service(fake_renderer_factory(control), 2, hooks());
  bool answered = false;
  service.submit(small_job(1, 0), [&](const RenderResult&) { answered = true; });
  service.submit(small_job(1, 1), [&](const RenderResult&) { answered = true; });
  ASSERT_TRUE(inbox.run_until([&] { return !failure.empty(); }));
  EXPECT_EQ(failure, "context lost");
  service.submit(small_job(2, 0), [&](const RenderResult&) { answered = true; });
  service.stop();
  inbox.run_pending();
  EXPECT_FALSE(answered);
  EXPECT_TRUE(control->destroyed);
}

TEST_F(RenderServiceTest, QueueIsBoundedByTheNumberOfStreams) {
  std::promise<void> release;
  std::promise<void> entered;
  control->before_ping = [&, first = true](const render::PingRequest&, int) mutable {
    if (std::exchange(first, false)) {
      entered.set_value();
      release.get_future().wait();
    }
  };
  RenderService service(fake_renderer_factory(control), 2, hooks());
  service.submit(small_job(1), [](const RenderResult&) {});
  ASSERT_EQ(entered.get_future().wait_for(std::chrono::seconds{10}), std::future_status::ready);
  service.submit(small_job(2), [](const RenderResult&) {});
  service.submit(small_job(3), [](const RenderResult&) {});
  EXPECT_THROW(service.submit(small_job(4), [](const RenderResult&) {}), std::logic_error);
  release.set_value();
}

TEST_F(RenderServiceTest, StopForgetsWaitingJobsAndFinishesTheCurrentOne) {
  std::promise<void> release;
  std::promise<void> entered;
  control->before_ping = [&](const render::PingRequest& request, int) {
    if (request.ping_number == 1) {
      entered.set_value();
      release.get_future().wait();
    }
  };
  RenderService service(fake_renderer_factory(control), 2, hooks());
  service.submit(small_job(1), [](const RenderResult&) {});
  auto token = std::make_shared<int>();
  const std::weak_ptr<int> waiting_job = token;
  service.submit(small_job(2), [token](const RenderResult&) {});
  token.reset();
  ASSERT_EQ(entered.get_future().wait_for(std::chrono::seconds{10}), std::future_status::ready);
  std::thread stopper([&] { service.stop(); });
  EXPECT_TRUE(test::wait_for([&] { return waiting_job.expired(); }));
  release.set_value();
  stopper.join();
  EXPECT_EQ(control->pings, 1);
  EXPECT_TRUE(control->destroyed);
}

TEST_F(RenderServiceTest, ObserverSeesEachPingBeforeItIsHandedBack) {
  std::vector<std::uint64_t> observed;
  RenderServiceHooks with_observer = hooks();
  with_observer.observe = [&](const PosedPing& ping, const render::PingSamples& samples) {
    observed.push_back(ping.request.ping_number);
    EXPECT_EQ(samples.u8.size(), 6u);
  };
  RenderService service(fake_renderer_factory(control), 1, with_observer);
  bool answered = false;
  service.submit(small_job(9), [&](const RenderResult&) { answered = true; });
  ASSERT_TRUE(inbox.run_until([&] { return answered; }));
  service.stop();
  EXPECT_EQ(observed, std::vector<std::uint64_t>{9});
}

// For the thread sanitizer: services are created and stopped with work in all states.
TEST_F(RenderServiceTest, SurvivesManyShortLives) {
  for (int life = 0; life < 300; ++life) {
    std::atomic<int> answers{0};
    RenderService service(fake_renderer_factory(control), 3, hooks());
    for (int head = 0; head < life % 4; ++head) {
      service.submit(small_job(1, head), [&](const RenderResult&) { ++answers; });
    }
    if (life % 3 == 0) {
      inbox.run_pending();
    }
    service.stop();
    inbox.run_pending();
    EXPECT_LE(answers, 3);
  }
}

}  // namespace
}  // namespace sonard::server
