// SPDX-License-Identifier: Apache-2.0
#include "server/offline/output_folder.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

struct OutputFolderTest : testing::Test {
  test::TemporaryFolder temporary;
  OutputFolder folder{temporary.path() / "a" / "b"};

  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      found.push_back(entry.path().filename().string());
    }
    std::sort(found.begin(), found.end());
    return found;
  }
};

TEST_F(OutputFolderTest, HoldsWhatWasWritten) {
  EXPECT_FALSE(folder.has("x"));
  folder.write("x", std::string_view("a\0b", 3));
  EXPECT_TRUE(folder.has("x"));
  EXPECT_EQ(folder.read("x"), std::string("a\0b", 3));
  folder.write("x", "other");
  EXPECT_EQ(folder.read("x"), "other");
  EXPECT_THAT(names(), ElementsAre("x"));
}

TEST_F(OutputFolderTest, AnUnfinishedFileHasNoNameAndGoes) {
  {
    PartFile part(folder.path());
    part.write("half");
    EXPECT_THAT(names(), ElementsAre(StartsWith(".part-")));
  }
  EXPECT_THAT(names(), ElementsAre());
}

TEST_F(OutputFolderTest, WhatAKilledProcessLeavesIsNoFileAndCanBeRemoved) {
  if (fork() == 0) {
    PartFile part(folder.path());
    part.write("half");
    _exit(0);  // no destructor runs, as after SIGKILL
  }
  wait(nullptr);
  folder.write("x", "whole");
  EXPECT_EQ(names().size(), 2U);
  folder.remove_parts();
  EXPECT_THAT(names(), ElementsAre("x"));
}

TEST_F(OutputFolderTest, ARunThatIsTheSameMayGoOn) {
  folder.claim("{1}", false);
  folder.write("ping_000000.png", "picture");
  folder.claim("{1}", false);
  folder.claim("{1}", true);
  EXPECT_THAT(names(), ElementsAre("ping_000000.png", "run.json"));
}

TEST_F(OutputFolderTest, FramesWithoutARunAreRefused) {
  for (const char* name : {"ping_000000.png", "scan_000001.npy", "log_1980-01-01-000000.glf"}) {
    folder.write(name, "x");
    EXPECT_THAT(
        [&] { folder.claim("{1}", false); },
        testing::ThrowsMessage<Error>(AllOf(
            StartsWith(folder.path().string() + ": the folder contains frames or logs, but no run.json"),
            HasSubstr("--overwrite"))))
        << name;
    EXPECT_THAT(names(), ElementsAre(name));
    folder.claim("{1}", true);
    EXPECT_THAT(names(), ElementsAre("run.json"));
    folder.remove("run.json");
  }
  folder.write("notes.txt", "x");
  folder.claim("{1}", false);
  EXPECT_THAT(names(), ElementsAre("notes.txt", "run.json"));
}

TEST_F(OutputFolderTest, AnotherRunIsRefusedByName) {
  folder.claim("{1}", false);
  try {
    folder.claim("{2}", false);
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), StartsWith((folder.path() / "run.json").string() + ": "));
    EXPECT_THAT(error.what(), HasSubstr("--overwrite"));
  }
  EXPECT_EQ(folder.read("run.json"), "{1}");
}

TEST_F(OutputFolderTest, AnotherRunIsToldByWhatDiffers) {
  const auto complaint = [this](const std::string& before, const std::string& now) {
    folder.remove("run.json");
    folder.claim(before, false);
    try {
      folder.claim(now, false);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(complaint(R"({"head": "bow", "settings": {"range_m": 30.0, "bits": 8}})",
                        R"({"head": "bow", "settings": {"range_m": 50.0, "bits": 8}})"),
              HasSubstr("another run: settings.range_m was 30.0 and now is 50.0 (expected"));
  EXPECT_THAT(
      complaint(R"({"world_crc32": "1", "truth": false})", R"({"world_crc32": "2", "truth": true})"),
      HasSubstr("another run: truth was false and now is true; world is a different file, or was changed ("));
  EXPECT_THAT(complaint(R"({"head": "bow"})", R"({"head": "bow", "seed": 7})"),
              HasSubstr("another run: seed was not set and now is 7 ("));
  EXPECT_THAT(complaint(R"({"bodies_crc32": {"crab": "1"}})", R"({"bodies_crc32": {"crab": "2"}})"),
              HasSubstr("another run: bodies.crab is a different file, or was changed ("));
  EXPECT_THAT(complaint(R"({"a": 1, "b": 1, "c": 1, "d": 1, "e": 1, "f": 1, "g": 1})", "{}"),
              HasSubstr("e was 1 and now is not set; and 2 more ("));
  EXPECT_THAT(complaint("cut", "{}"), HasSubstr("another run: its run.json cannot be read ("));
}

TEST_F(OutputFolderTest, OverwritingTakesFramesAndLogsOfTheOtherRunAndNothingElse) {
  folder.claim("{1}", false);
  for (const char* name : {"ping_000000.png", "scan_000001.npy", "log_1980-01-01-000000.glf", "notes.txt"}) {
    folder.write(name, "x");
  }
  folder.claim("{2}", true);
  EXPECT_THAT(names(), ElementsAre("notes.txt", "run.json"));
  EXPECT_EQ(folder.read("run.json"), "{2}");
}

TEST_F(OutputFolderTest, OneLockAtATime) {
  std::atomic<bool> second_had_it = false;
  std::thread second;
  {
    const OutputFolder::Lock first(folder);
    second = std::thread([&] {
      const OutputFolder::Lock lock(folder);
      second_had_it = true;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_FALSE(second_had_it);
  }
  second.join();
  EXPECT_TRUE(second_had_it);
}

TEST_F(OutputFolderTest, ALockThatWasRemovedAsAPartIsTakenAnew) {
  auto first = std::make_unique<OutputFolder::Lock>(folder);
  std::atomic<bool> second_has_it = false;
  std::atomic<bool> end = false;
  std::thread second([&] {
    const OutputFolder::Lock lock(folder);
    second_has_it = true;
    while (!end) {
      std::this_thread::yield();
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // by now it most likely waits for the first
  folder.remove_parts();
  first.reset();
  while (!second_has_it) {
    std::this_thread::yield();
  }
  std::atomic<bool> third_had_it = false;
  std::thread third([&] {
    const OutputFolder::Lock lock(folder);
    third_had_it = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_FALSE(third_had_it) << "the second held a lock that nobody else sees";
  end = true;
  second.join();
  third.join();
  EXPECT_TRUE(third_had_it);
}

TEST(OutputFolder, SaysWhatItCannotMakeOrWrite) {
  try {
    OutputFolder("/proc/sonard");
    FAIL() << "made";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), StartsWith("/proc/sonard: cannot create the folder: "));
  }
  EXPECT_THROW(OutputFolder("/proc").write("x", "y"), Error);
}

TEST(OutputFolder, SaysWhatItCannotRead) {
  const test::TemporaryFolder temporary;
  EXPECT_THROW((void)OutputFolder(temporary.path()).read("missing"), Error);
}

}  // namespace
}  // namespace sonard::server
