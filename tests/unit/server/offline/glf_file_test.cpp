// SPDX-License-Identifier: Apache-2.0
#include "server/offline/glf_file.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/glf/log_view.hpp"
#include "tests/support/temporary_folder.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;

/// An image at `time_s`, in seconds since 1980, with pixels that do not compress.
glf::ImageRecord image_at(double time_s) {
  glf::ImageRecord image;
  image.origin = {time_s, 513, 100};
  image.transmit_time_s = time_s;
  image.lines = 50;
  image.beams = 64;
  std::uint32_t state = static_cast<std::uint32_t>(time_s) + 1;
  for (std::uint32_t i = 0; i < image.lines * image.beams; ++i) {
    state = state * 1'664'525U + 1'013'904'223U;
    image.pixels.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  for (std::uint32_t beam = 0; beam < image.beams; ++beam) {
    image.bearings_rad.push_back(1.0 - 0.03 * beam);
  }
  image.modulation_frequency_hz = 90'422;
  image.sound_speed_mps = 1500.0F;
  return image;
}

std::vector<std::uint8_t> bytes_of(const OutputFolder& folder, const std::string& name) {
  const std::string text = folder.read(name);
  return {text.begin(), text.end()};
}

TEST(GlfFile, HoldsItsRecordsAndNothingElseStays) {
  const test::TemporaryFolder temporary;
  const OutputFolder folder(temporary.path());
  GlfFile log(folder, "test 1");
  // 40 records of more than 3 kB each: more than one block of the archive.
  for (int i = 0; i < 40; ++i) {
    log.add(image_at(86'400.0 + i));
  }
  EXPECT_THAT(log.close(), ElementsAre("log_1980-01-02-000000.glf"));
  EXPECT_THAT(temporary.names(), ElementsAre("log_1980-01-02-000000.glf"));

  const std::vector<std::uint8_t> bytes = bytes_of(folder, "log_1980-01-02-000000.glf");
  const auto view = glf::LogView::open(bytes);
  ASSERT_TRUE(view);
  ASSERT_EQ(view->index().records.size(), 40U);
  EXPECT_TRUE(view->index().closed);
  EXPECT_EQ(*view->image(view->index().records.back()), image_at(86'400.0 + 39));
}

TEST(GlfFile, GoesOnInAnotherLogWhereOneIsFull) {
  const test::TemporaryFolder temporary;
  const OutputFolder folder(temporary.path());
  GlfFile log(folder, "test 1", 10'000);
  for (int i = 0; i < 5; ++i) {
    log.add(image_at(i));
  }
  EXPECT_THAT(log.close(), ElementsAre("log_1980-01-01-000000.glf", "log_1980-01-01-000002.glf",
                                       "log_1980-01-01-000004.glf"));
}

TEST(GlfFile, WithoutRecordsThereIsNone) {
  const test::TemporaryFolder temporary;
  const OutputFolder folder(temporary.path());
  EXPECT_THAT(GlfFile(folder, "test 1").close(), ElementsAre());
  EXPECT_THAT(temporary.names(), ElementsAre());
}

}  // namespace
}  // namespace sonard::server
