// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping_dump.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "protocol/npy/npy_file.hpp"

namespace sonard::server {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A temporary folder, deleted when the test ends.
struct PingDumpTest : testing::Test {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("sonard-ping-dump-" + std::to_string(getpid()));

  ~PingDumpTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

// CRC-32 of zlib returns CBF43926 for "123456789", the check string of CRC catalogues.
TEST(SamplesCrc32, IsThatOfZlib) {
  render::PingSamples samples;
  samples.u8 = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(samples_crc32(samples), 0xCBF43926u);
}

TEST(SamplesCrc32, Takes16BitSamplesMostSignificantByteFirst) {
  render::PingSamples eight;
  eight.u8 = {'1', '2', '3', '4'};
  render::PingSamples sixteen;
  sixteen.u16 = {'1' << 8 | '2', '3' << 8 | '4'};
  EXPECT_EQ(samples_crc32(sixteen), samples_crc32(eight));
}

TEST_F(PingDumpTest, WritesNumpyFileAndIndexRow) {
  PingDump dump(folder, "bow");
  PosedPing ping;
  ping.request.ping_number = 257;
  ping.transmit_us = 1234567;
  PosesUsed poses;
  poses.stamp_ns = 5678;
  ping.poses = std::make_shared<const PosesUsed>(poses);
  render::PingSamples samples;
  samples.beams = 3;
  samples.bins = 3;
  samples.u8 = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  dump.write(ping, samples);
  EXPECT_EQ(contents(folder / "bow.csv"),
            "number,id,transmit_us,lines,beams,crc32,pose_ns\n257,1,1234567,3,3,cbf43926,5678\n");

  // NumPy format 1.0: magic, version, header length. Preamble and header together are a multiple of 64 bytes.
  const std::string file = contents(folder / "bow-00000257.npy");
  ASSERT_EQ(file.size(), 128u + 9u);
  EXPECT_EQ(file.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  const std::string dictionary = "{'descr': '|u1', 'fortran_order': False, 'shape': (3, 3), }";
  EXPECT_EQ(file.substr(10, dictionary.size()), dictionary);
  EXPECT_EQ(file[127], '\n');
  EXPECT_EQ(file.substr(128), "123456789");
}

TEST_F(PingDumpTest, FolderThatCannotBeMadeIsAnErrorThatNamesIt) {
  std::ofstream(folder) << "in the way";
  try {
    PingDump dump(folder, "bow");
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(folder.string()), std::string::npos);
  }
}

TEST_F(PingDumpTest, WritesRangesAndIntensitiesOfDirections) {
  PingDump dump(folder, "bow");
  render::PingSamples samples;
  samples.directions = {3, 2, {1, 2, 3, 4, 5, 6}, {.1F, .2F, .3F, .4F, .5F, .6F}};
  dump.write({}, samples);
  const auto table = npy::parse(contents(folder / "bow-00000000.npy"));
  ASSERT_TRUE(table);
  EXPECT_EQ(*table, (npy::Table{4, 3, {}, {}, {1, 2, 3, 4, 5, 6, .1F, .2F, .3F, .4F, .5F, .6F}}));
  samples.directions.intensity[5] = 0;
  EXPECT_EQ(contents(folder / "bow.csv").find(fmt::format(",{:08x},", samples_crc32(samples))),
            std::string::npos);
}

}  // namespace
}  // namespace sonard::server
