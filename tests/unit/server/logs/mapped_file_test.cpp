// SPDX-License-Identifier: Apache-2.0
#include "server/logs/mapped_file.hpp"

#include <sys/stat.h>

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/logs/log_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/without_rights.hpp"

namespace sonard::server {
namespace {

TEST(MappedFile, HoldsTheBytesOfTheFile) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "a") << "abc";
  const MappedFile file(folder.path() / "a");
  EXPECT_FALSE(file.error());
  EXPECT_THAT(file.bytes(), testing::ElementsAre('a', 'b', 'c'));
}

TEST(MappedFile, IsEmptyWithoutAnErrorForAnEmptyFile) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "a").flush();
  const MappedFile file(folder.path() / "a");
  EXPECT_FALSE(file.error());
  EXPECT_TRUE(file.bytes().empty());
}

TEST(MappedFile, SaysWhyItIsEmpty) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(MappedFile(folder.path() / "b").error(), std::errc::no_such_file_or_directory);
  EXPECT_EQ(MappedFile(folder.path()).error(), std::errc::invalid_argument);
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(MappedFile(folder.path() / "pipe").error(), std::errc::invalid_argument);
}

TEST(LogFile, NamesTheMissingRight) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "a.mcap") << "\x89MCAP";
  std::filesystem::permissions(folder.path() / "a.mcap", std::filesystem::perms::none);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const test::WithoutRights nobody;
  try {
    const LogFile log(folder.path() / "a.mcap");
    FAIL() << "it was read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::EndsWith("a.mcap: cannot be opened: Permission denied"));
  }
}

}  // namespace
}  // namespace sonard::server
