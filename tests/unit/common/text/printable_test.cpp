// SPDX-License-Identifier: Apache-2.0
#include "common/text/printable.hpp"

#include <gtest/gtest.h>

namespace sonard {
namespace {

TEST(Printable, LeavesTextAsItIs) {
  for (const char* text : {"", "bow", "a\\b 'c' \"d\"", "Gerät, 声纳, 🐬"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, MakesOneLineThatCommandsNoTerminal) {
  EXPECT_EQ(printable("a\nb\r\tc"), "a\\nb\\x0d\\tc");
  EXPECT_EQ(printable("\x1b[2J\x07\x7f"), "\\x1b[2J\\x07\\x7f");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\x9b31m")
      << "CSI as one character (ECMA-48)";
  EXPECT_EQ(printable("\xe2\x80\xae"), "\\u202e") << "RIGHT-TO-LEFT OVERRIDE";
  EXPECT_EQ(printable("\xe2\x80\xa8"), "\\u2028") << "LINE SEPARATOR";
}

// Ill-formed bytes after table 3-7 of the Unicode standard.
TEST(Printable, ShowsBytesThatAreNoUtf8) {
  EXPECT_EQ(printable("\xff"), "\\xff");
  EXPECT_EQ(printable("\x80z"), "\\x80z");
  EXPECT_EQ(printable("\xc3"), "\\xc3") << "cut off";
  EXPECT_EQ(printable("\xc0\x8a"), "\\xc0\\x8a") << "a line feed, longer than it need be";
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "a surrogate";
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond U+10FFFF";
}

}  // namespace
}  // namespace sonard
