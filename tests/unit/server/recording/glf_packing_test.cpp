// SPDX-License-Identifier: Apache-2.0
#include "server/recording/glf_packing.hpp"

#include <gtest/gtest.h>

#include "protocol/glf/codec.hpp"
#include "protocol/glf/log_view.hpp"
#include "tests/unit/server/recording/fixture.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

const std::string dat_name = "data_2026-11-20-142233_bow.dat";
const std::string glf_name = "log_2026-11-20-142233_bow.glf";

// A .dat of records of 60 kB that do not compress.
Bytes dat_of(int images) {
  Bytes dat;
  for (int number = 0; number < images; ++number) {
    glf::ImageRecord image;
    image.origin = {1000.0 + number, 601, 100};
    image.lines = 240;
    image.beams = 250;
    for (int i = 0; i < 60'000; ++i) {
      image.pixels.push_back(test::sample(static_cast<std::uint64_t>(number), i / 250, i % 250));
    }
    image.bearings_rad.assign(250, 0.5);
    const Bytes record = glf::encode(image);
    dat.insert(dat.end(), record.begin(), record.end());
  }
  return dat;
}

struct GlfPackingTest : testing::Test {
  test::TemporaryFolder folder;
  fs::path dat = folder.path() / dat_name;
  fs::path packed = folder.path() / glf_name;

  // Packs the .dat and returns the number of steps.
  int pack(RecordingSync sync = RecordingSync::never) const {
    GlfPacking packing(dat, sync);
    int steps = 1;
    while (packing.step()) {
      ++steps;
    }
    return steps;
  }

  // Checks that the .glf holds these images, and that the folder holds no other file.
  void expect_packed(std::size_t images) const {
    EXPECT_EQ(folder.names(), std::vector<std::string>{glf_name});
    const Bytes bytes = test::contents(packed);
    const auto log = glf::LogView::open(bytes);
    ASSERT_TRUE(log);
    EXPECT_TRUE(log->index().closed);
    ASSERT_EQ(log->index().records.size(), images);
    for (std::size_t i = 0; i < images; ++i) {
      const auto image = log->image(log->index().records[i]);
      ASSERT_TRUE(image);
      EXPECT_EQ(image->origin.time_s, 1000.0 + static_cast<double>(i));
      EXPECT_EQ(image->pixels[777], test::sample(i, 777 / 250, 777 % 250));
    }
  }
};

TEST_F(GlfPackingTest, PacksSliceBySlice) {
  test::write_file(dat, dat_of(60));  // 3.7 MB: four slices
  EXPECT_EQ(pack(RecordingSync::on_close), 1 + 4 + 1);
  expect_packed(60);
}

TEST_F(GlfPackingTest, SaysWhoWroteItAndWhen) {
  test::write_file(dat, dat_of(3));
  pack();
  const Bytes bytes = test::contents(packed);
  const auto log = glf::LogView::open(bytes);
  ASSERT_TRUE(log);
  EXPECT_NE(log->config_xml().find("<creationTime>1000.000</creationTime>"), std::string::npos);
  EXPECT_NE(log->config_xml().find("<closeTime>1002.000</closeTime>"), std::string::npos);
  EXPECT_NE(log->config_xml().find("Gemini - 601"), std::string::npos);
}

TEST_F(GlfPackingTest, CutsOffWhatIsNoWholeRecord) {
  Bytes bytes = dat_of(3);
  bytes.resize(bytes.size() - 100);
  test::write_file(dat, bytes);
  pack();
  expect_packed(2);
}

TEST_F(GlfPackingTest, OfNothingIsNothing) {
  Bytes bytes = dat_of(1);
  bytes.resize(100);
  test::write_file(dat, bytes);
  pack();
  EXPECT_TRUE(folder.names().empty());
}

TEST_F(GlfPackingTest, BeginsAgainWhereverItWasInterrupted) {
  const Bytes bytes = dat_of(60);
  for (int steps = 1; steps <= 5; ++steps) {
    test::write_file(dat, bytes);
    {
      GlfPacking packing(dat, RecordingSync::never);
      for (int i = 0; i < steps; ++i) {
        ASSERT_TRUE(packing.step());
      }
    }
    EXPECT_TRUE(fs::exists(dat));
    EXPECT_FALSE(fs::exists(packed));
    pack();
    expect_packed(60);
    fs::remove(packed);
  }
}

TEST_F(GlfPackingTest, LeavesTheDatWhereThereIsNoRoom) {
  const Bytes bytes = dat_of(60);
  test::write_file(dat, bytes);
  {
    const test::FileSizeLimit limit(bytes.size() +
                                    100);  // enough for the .dat, but not for the archive around it
    pack();
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{dat_name});
  pack();
  expect_packed(60);
}

}  // namespace
}  // namespace sonard::server
