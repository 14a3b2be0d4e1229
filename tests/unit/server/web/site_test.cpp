// SPDX-License-Identifier: Apache-2.0
// The page while its drawing thread is blocked, and viewers that do not read.
#include "server/web/site.hpp"

#include <utility>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

namespace http = boost::beast::http;
using std::chrono::milliseconds;

/// A page whose drawings are made when the test calls draw_all().
struct Page {
  void draw_all() {
    for (const auto& drawing : std::exchange(drawings, {})) {
      drawing();
    }
  }

  http::status ask(const std::string& path) {
    HttpRequest request{http::verb::get, path, 11};
    request.set(http::field::host, "127.0.0.1");
    auto status = http::status::unknown;
    site.answer(request, {0x7F000001, 1},
                [&status](const HttpResponse& response) { status = response.result(); });
    return status;
  }

  std::vector<std::function<void()>> drawings;
  const render::World world{};
  Site site{WebConfig{},
            WebSources{.ask_status = [](const std::function<void(DaemonStatus)>& take) { take({}); },
                       .turn_recording = nullptr,
                       .identity = {},
                       .world = world},
            [this](const std::function<Text()>& make, const std::function<void(Text)>& take) {
              drawings.emplace_back([make, take] { take(make()); });
            }};
};

struct FakeViewer final : Viewer {
  void show(const std::shared_ptr<const ShownPing>&) override {}
  void show_picture(int, const Text& picture) override { shown.push_back(picture); }
  std::optional<TimePoint> waits_since() const override { return since; }
  void close() override { closed = true; }

  std::optional<TimePoint> since;
  std::vector<Text> shown;
  bool closed = false;
};

std::shared_ptr<const ShownPing> fan() {
  auto shown = std::make_shared<ShownPing>();
  PingRecord& record = shown->record;
  record.bearings_rad = {-0.5, 0.0, 0.5};
  record.settings.beams = 3;
  record.settings.bins = 20;
  record.settings.bin_m = 0.1;
  record.samples.assign(60, 100);
  return shown;
}

TEST(Site, AnswersMonitorsWhileTheDrawingThreadStandsStill) {
  Page page;
  page.site.show(fan());
  EXPECT_EQ(page.ask("/api/world"), http::status::unknown) << "waits for its drawing";
  EXPECT_EQ(page.site.picture_of(0, "bow"), nullptr);
  page.site.with_frame(page.site.last_pings(0), 500, [](const Text&) { FAIL() << "nothing is drawn yet"; });
  EXPECT_EQ(page.drawings.size(), 3U);
  for (const char* const path : {"/health", "/metrics", "/api/status"}) {
    EXPECT_EQ(page.ask(path), http::status::ok) << path;
  }
  EXPECT_EQ(page.ask("/ready"), http::status::service_unavailable) << "it has no head";
}

TEST(Site, DrawsAPictureAndAFrameOnceForAllViewers) {
  Page page;
  const auto viewer = std::make_shared<FakeViewer>();
  page.site.add(viewer);
  page.site.show(fan());
  int frames = 0;
  for (int i = 0; i < 60; ++i) {
    EXPECT_EQ(page.site.picture_of(0, "bow"), nullptr);
    page.site.with_frame(page.site.last_pings(0), 500, [&](const Text& frame) { frames += frame ? 1 : 0; });
  }
  EXPECT_EQ(page.drawings.size(), 2U);
  page.draw_all();
  EXPECT_EQ(frames, 60);
  ASSERT_EQ(viewer->shown.size(), 1U);
  EXPECT_NE(viewer->shown[0], nullptr);
  EXPECT_EQ(page.site.picture_of(0, "bow"), viewer->shown[0]);
  EXPECT_TRUE(page.drawings.empty());
}

TEST(Site, ClosesTheViewerThatReadsLeastBeforeMuchWaits) {
  Page page;
  const auto reads = std::make_shared<FakeViewer>(), slow = std::make_shared<FakeViewer>(),
             slowest = std::make_shared<FakeViewer>();
  slow->since = TimePoint{} + milliseconds{200};
  slowest->since = TimePoint{} + milliseconds{100};
  for (const auto& viewer : {reads, slow, slowest}) {
    page.site.add(viewer);
  }
  constexpr auto half = static_cast<std::ptrdiff_t>(Site::most_waiting_bytes / 2);
  page.site.count_waiting(half);
  page.site.count_waiting(half);
  EXPECT_FALSE(slowest->closed);
  page.site.count_waiting(1);
  EXPECT_TRUE(slowest->closed);
  EXPECT_FALSE(slow->closed || reads->closed);
}

}  // namespace
}  // namespace sonard::server
