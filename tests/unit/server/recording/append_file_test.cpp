// SPDX-License-Identifier: Apache-2.0
#include "server/recording/append_file.hpp"

#include <gtest/gtest.h>

#include "tests/unit/server/recording/fixture.hpp"

namespace sonard::server {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(AppendFile, NeverOverwritesAFile) {
  const test::TemporaryFolder folder;
  std::error_code error;
  AppendFile::create(folder.path() / "a", error);
  EXPECT_FALSE(error);
  EXPECT_FALSE(AppendFile::create(folder.path() / "a", error).is_open());
  EXPECT_EQ(error, std::errc::file_exists);
}

TEST(AppendFile, EndsWithTheLastWholePieceWhenTheDiskIsFull) {
  const test::TemporaryFolder folder;
  std::error_code error;
  AppendFile file = AppendFile::create(folder.path() / "a", error);
  {
    const test::FileSizeLimit limit(1000);
    EXPECT_FALSE(file.append(Bytes(600, 1)));
    EXPECT_EQ(file.append(Bytes(600, 2)), std::errc::file_too_large);
    EXPECT_EQ(file.size(), 600U);
    EXPECT_FALSE(file.append(Bytes(400, 3)));
  }
  const Bytes written = test::contents(folder.path() / "a");
  ASSERT_EQ(written.size(), 1000U);
  EXPECT_EQ(written[599], 1);
  EXPECT_EQ(written[600], 3);
}

TEST(AppendFile, GoesOnBehindWhatIsThere) {
  const test::TemporaryFolder folder;
  test::write_file(folder.path() / "a", {1, 2, 3});
  std::error_code error;
  AppendFile file = AppendFile::open(folder.path() / "a", error);
  EXPECT_EQ(file.size(), 3U);
  EXPECT_FALSE(file.truncate(2));
  EXPECT_FALSE(file.append(Bytes{9}));
  EXPECT_FALSE(file.overwrite(0, Bytes{7}));
  EXPECT_EQ(test::contents(folder.path() / "a"), (Bytes{7, 2, 9}));
}

}  // namespace
}  // namespace sonard::server
