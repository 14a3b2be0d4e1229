// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/measurements.hpp"

#include <yaml-cpp/yaml.h>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

namespace sonard::bench {
namespace {

const Subject swell{"swell100k", "cpu", "default"};

TEST(Measurements, AreFoundBySubjectAndMetric) {
  Measurements measurements;
  measurements.add(swell, "ping_ms", 2.5, "ms");
  EXPECT_EQ(measurements.find(swell, "ping_ms"), 2.5);
  EXPECT_FALSE(measurements.find(swell, "samples"));
  EXPECT_FALSE(measurements.find({"swell100k", "gpu", "default"}, "ping_ms"));
  EXPECT_FALSE(measurements.find({"swell100k", "cpu", "fast"}, "ping_ms"));
  EXPECT_FALSE(measurements.find({"plane", "cpu", "default"}, "ping_ms"));
}

TEST(Measurements, WhatWasNotMeasuredIsLeftOut) {
  Measurements measurements;
  measurements.add(swell, "ping_ms", std::numeric_limits<double>::quiet_NaN(), "ms");
  measurements.add(swell, "samples", std::numeric_limits<double>::infinity(), "count");
  EXPECT_TRUE(measurements.all().empty());
  EXPECT_EQ(YAML::Load(measurements.to_json()).size(), 0U);
}

TEST(Measurements, AreWrittenAsAFlatList) {
  Measurements measurements;
  measurements.add(swell, "ping_ms", 0.125, "ms");
  measurements.add({R"(a "quoted" \ name)", "gpu", "fast"}, "samples", 131072, "count");
  const YAML::Node list = YAML::Load(measurements.to_json());  // JSON is YAML
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].size(), 6U);
  EXPECT_EQ(list[0]["scene"].as<std::string>(), "swell100k");
  EXPECT_EQ(list[0]["engine"].as<std::string>(), "cpu");
  EXPECT_EQ(list[0]["preset"].as<std::string>(), "default");
  EXPECT_EQ(list[0]["metric"].as<std::string>(), "ping_ms");
  EXPECT_EQ(list[0]["value"].as<double>(), 0.125);
  EXPECT_EQ(list[0]["unit"].as<std::string>(), "ms");
  EXPECT_EQ(list[1]["scene"].as<std::string>(), R"(a "quoted" \ name)");
  EXPECT_EQ(list[1]["value"].as<double>(), 131072.0);
}

TEST(Measurements, AFileThatCannotBeWrittenIsNamed) {
  try {
    write_json(Measurements{}, "/proc/nowhere/bench.json");
    FAIL() << "wrote into /proc";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/proc/nowhere/bench.json"), std::string::npos);
  }
}

}  // namespace
}  // namespace sonard::bench
