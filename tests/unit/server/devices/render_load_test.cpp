// SPDX-License-Identifier: Apache-2.0
#include "server/devices/render_load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace sonard::server {
namespace {

using Preset = render::Sampling::Preset;
using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A client that requests a ping every `interval`, or as soon as the last one has arrived.
class Client {
 public:
  explicit Client(RenderLoad& load) : load_(load) {}

  /// @return the lines for the operator
  template <class TakenBy>
  std::vector<std::string> ask(std::chrono::seconds duration, milliseconds interval, TakenBy taken_by) {
    std::vector<std::string> lines;
    for (const TimePoint end = now_ + duration; now_ < end;) {
      const TimePoint asked = now_;
      load_.submitted(now_, interval);
      now_ += milliseconds(taken_by(load_.preset()));
      if (const std::optional<Notice> news = load_.answered(now_)) {
        lines.push_back(news->text);
      }
      now_ = std::max(now_, asked + interval);
    }
    return lines;
  }

 private:
  RenderLoad& load_;
  TimePoint now_{std::chrono::seconds(1000)};
};

int milliseconds_of(Preset preset) {
  return preset == Preset::fast ? 50 : preset == Preset::normal ? 120 : 900;
}

render::SonarSettings with(Preset preset) {
  render::SonarSettings settings;
  settings.sampling.preset = preset;
  return settings;
}

TEST(RenderLoad, AdvisesOnlyWhatIsNotSetAlready) {
  render::SonarSettings settings = with(Preset::fast);
  settings.model = render::Model::physical;
  settings.aperture.azimuth = render::Aperture::Azimuth::array;
  const auto advice = [&] {
    RenderLoad load(settings, false);
    return Client(load).ask(std::chrono::seconds(3), milliseconds(40), milliseconds_of).at(0);
  };
  EXPECT_THAT(advice(),
              HasSubstr("acoustics.fine_beams: 1, acoustics.physical.multipath.level: off, or a GPU"));
  settings.aperture.fine_beams = 1;
  EXPECT_THAT(advice(),
              ::testing::EndsWith("more compression), acoustics.physical.multipath.level: off, or a GPU"));
  settings.physical.multipath.level = render::MultipathSettings::Level::off;
  EXPECT_THAT(advice(), ::testing::EndsWith("more compression), or a GPU"));
}

TEST(RenderLoad, AdvisesFewerDirectionsWhereAHeadHasNeitherBinsNorMirrors) {
  render::SonarSettings settings = with(Preset::fast);
  settings.model = render::Model::physical;
  settings.directions.columns = settings.directions.rows = 2;
  RenderLoad load(settings, false);
  Client client(load);
  const auto lines = client.ask(std::chrono::seconds(3), milliseconds(40), milliseconds_of);
  EXPECT_THAT(
      lines,
      ElementsAre(::testing::EndsWith("; try fewer directions (device.width, device.height), or a GPU")));
}

TEST(RenderLoad, SaysOnceWhatToDoWhereAClientAsksForTooMuch) {
  RenderLoad load(with(Preset::normal), false);
  Client client(load);
  const auto lines = client.ask(std::chrono::seconds(20), milliseconds(60), milliseconds_of);
  ASSERT_THAT(lines, ElementsAre(HasSubstr("sampling.preset: fast")));
  EXPECT_THAT(lines[0], HasSubstr("too slow: 8.3 of 16.7 requested pings per second, 120 ms per ping"));
  EXPECT_EQ(load.preset(), Preset::normal);
}

TEST(RenderLoad, NamesNoFasterPresetWhereThereIsNone) {
  RenderLoad load(with(Preset::fast), true);
  Client client(load);
  const auto lines = client.ask(std::chrono::seconds(20), milliseconds(30), milliseconds_of);
  ASSERT_THAT(lines, ElementsAre(HasSubstr("try fewer range bins")));
  EXPECT_THAT(lines[0], ::testing::Not(HasSubstr("sampling.")));
}

TEST(RenderLoad, IsSilentWhereTheRateIsReachedJustSo) {
  RenderLoad load(with(Preset::fast), false);
  Client client(load);
  EXPECT_THAT(client.ask(std::chrono::seconds(20), milliseconds(52), milliseconds_of), IsEmpty());
}

TEST(RenderLoad, IsSilentWhereThereIsTime) {
  RenderLoad load(with(Preset::normal), true);
  Client client(load);
  EXPECT_THAT(client.ask(std::chrono::seconds(20), milliseconds(200), milliseconds_of), IsEmpty());
}

TEST(RenderLoad, StepsDownAndComesBackWhenThereIsTime) {
  RenderLoad load(with(Preset::reference), true);
  Client client(load);
  const auto down = client.ask(std::chrono::seconds(20), milliseconds(60), milliseconds_of);
  ASSERT_THAT(down, ElementsAre(HasSubstr("from reference to default"), HasSubstr("from default to fast")));
  EXPECT_EQ(load.preset(), Preset::fast);
  const auto back = client.ask(std::chrono::seconds(20), milliseconds(500), milliseconds_of);
  ASSERT_THAT(back, ElementsAre(HasSubstr("from fast back to default")))
      << "`reference` would take nine tenths of a second of every half";
  EXPECT_EQ(load.preset(), Preset::normal);
}

TEST(RenderLoad, DoesNotSwingToAndFro) {
  RenderLoad load(with(Preset::normal), true);
  Client client(load);
  EXPECT_THAT(client.ask(std::chrono::seconds(120), milliseconds(110), milliseconds_of),
              ElementsAre(HasSubstr("from default to fast")));
}

TEST(RenderLoad, AnIdleClientChangesNothing) {
  RenderLoad load(with(Preset::normal), true);
  EXPECT_EQ(load.answered(TimePoint(1)), std::nullopt);
  Client client(load);
  EXPECT_THAT(client.ask(std::chrono::seconds(60), std::chrono::seconds(20), milliseconds_of), IsEmpty());
}

}  // namespace
}  // namespace sonard::server
