// SPDX-License-Identifier: Apache-2.0
// docs/acoustics.md and docs/gallery.md, their pictures, and the tables that define the pictures have the
// same names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tests/pictures/effects/effects.hpp"
#include "tests/pictures/gallery/scenes.hpp"

namespace sonard::pictures {
namespace {

const std::filesystem::path docs = SONARD_SOURCE_DIR "/docs";
using Names = std::set<std::string>;

/// The first group of every match in a page.
Names matches(const std::string& page, const std::string& pattern) {
  std::ostringstream text;
  text << std::ifstream(docs / page).rdbuf();
  const std::string read = text.str();
  const std::regex expression(pattern);
  Names found;
  for (std::sregex_iterator match(read.begin(), read.end(), expression), end; match != end; ++match) {
    found.insert((*match)[1]);
  }
  return found;
}

Names files_in(const std::string& folder) {
  Names names;
  for (const auto& entry : std::filesystem::directory_iterator(docs / "images" / folder)) {
    EXPECT_EQ(entry.path().extension(), ".png");
    EXPECT_LT(entry.file_size(), 350'000U) << entry.path();
    EXPECT_FALSE(cv::imread(entry.path().string()).empty()) << entry.path();
    names.insert(entry.path().stem().string());
  }
  return names;
}

TEST(AcousticsPage, HasEveryPictureOnceInASection) {
  Names names;
  for (const EffectPicture& picture : effect_pictures()) {
    EXPECT_TRUE(names.insert(picture.name).second) << picture.name << " is there twice";
  }
  ASSERT_GE(names.size(), 5U);
  EXPECT_EQ(matches("acoustics.md", R"(\n!\[[^\]]+\]\(images/acoustics/(\w+)\.png\))"), names);
  EXPECT_EQ(files_in("acoustics"), names);
}

TEST(AcousticsPage, HasASectionForEachRow) {
  Names sections;
  for (std::string title : matches("acoustics.md", R"(\n## ([^\n]+))")) {
    for (char& c : title) {
      c = c == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    sections.insert(title);
  }
  sections.erase("how-real-it-is");  // about all rows
  EXPECT_EQ(matches("acoustics.md", R"(\n\| \[[^\]]+\]\(#([^)]+)\) \|)"), sections);
}

TEST(GalleryPage, HasTheSixScenes) {
  Names names;
  Names configs;
  for (const GalleryScene& scene : gallery_scenes()) {
    names.insert(scene.name);
    configs.insert(scene.config);
  }
  EXPECT_EQ(names.size(), 6U);
  EXPECT_EQ(matches("gallery.md", R"(\n!\[[^\]]+\]\(images/gallery/(\w+)\.png\))"), names);
  EXPECT_EQ(matches("gallery.md", R"(\n`configs/([\w-]+\.yaml)`, )"), configs);
  EXPECT_EQ(files_in("gallery"), names);
}

}  // namespace
}  // namespace sonard::pictures
