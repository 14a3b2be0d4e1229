// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/json.hpp"

#include <gtest/gtest.h>

namespace sonard::dvl_a50 {
namespace {

void append(JsonStream& stream, std::string_view text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  stream.append(bytes);
}

std::vector<std::string> objects(JsonStream& stream) {
  std::vector<std::string> found;
  while (auto object = stream.next()) {
    found.push_back(*std::move(object));
  }
  return found;
}

using Texts = std::vector<std::string>;

TEST(DvlJsonStream, FindsObjectsWhateverSeparatesThem) {
  JsonStream stream;
  append(stream, "{\"a\":1}{\"b\":{\"c\":2}}\r\n  {}\n");
  EXPECT_EQ(objects(stream), (Texts{"{\"a\":1}", "{\"b\":{\"c\":2}}", "{}"}));
  EXPECT_EQ(stream.dropped(), 0U);
  append(stream, "junk {\"d\":3}!");
  EXPECT_EQ(objects(stream), Texts{"{\"d\":3}"});
  EXPECT_EQ(stream.dropped(), 5U);
}

TEST(DvlJsonStream, BracesAndQuotesInTextsAreNoBraces) {
  JsonStream stream;
  append(stream, R"({"a":"}{\"}\\"}{"b":2})");
  EXPECT_EQ(objects(stream), (Texts{R"({"a":"}{\"}\\"})", R"({"b":2})"}));
}

TEST(DvlJsonStream, KeepsWhatIsCutAnywhere) {
  const std::string text = R"({"a":"\"}"} {"b":[{}]})";
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    JsonStream stream;
    append(stream, text.substr(0, cut));
    Texts found = objects(stream);
    append(stream, text.substr(cut));
    for (const std::string& object : objects(stream)) {
      found.push_back(object);
    }
    EXPECT_EQ(found, (Texts{R"({"a":"\"}"})", R"({"b":[{}]})"})) << cut;
  }
}

TEST(DvlJsonStream, AnObjectWithoutAnEndOverflows) {
  JsonStream stream;
  append(stream, "{\"a\":\"");
  EXPECT_TRUE(objects(stream).empty());
  append(stream, std::string(JsonStream::most_bytes - 6, 'x'));
  EXPECT_FALSE(stream.overflowed());
  append(stream, "x");
  EXPECT_TRUE(stream.overflowed());
  append(stream, "\"}");
  EXPECT_TRUE(objects(stream).empty());
}

TEST(DvlJson, ValuesOfEveryType) {
  const auto json =
      parse_json(R"( {"n": -1.5e1, "t": true, "f":false, "z":null, "s":"a\n\u0041", "l":[1, []], "o":{}} )");
  ASSERT_TRUE(json);
  EXPECT_EQ(*json->find("n")->as<double>(), -15.0);
  EXPECT_TRUE(*json->find("t")->as<bool>());
  EXPECT_FALSE(*json->find("f")->as<bool>());
  EXPECT_NE(json->find("z")->as<std::nullptr_t>(), nullptr);
  EXPECT_EQ(*json->find("s")->as<std::string>(), "a\nA");
  EXPECT_EQ(json->find("l")->as<Json::List>()->size(), 2U);
  EXPECT_TRUE(json->find("o")->as<Json::Members>()->empty());
  EXPECT_EQ(json->find("missing"), nullptr);
}

TEST(DvlJson, WhatIsNoJson) {
  for (const char* const text : {"", "{", "{\"a\"}", "{\"a\":}", "[1,]", "{\"a\":1,}", "nan", "-", "1e999",
                                 "tru", "\"a", "\"\\u00\"", "{} {}", "+1", "{a:1}"}) {
    EXPECT_FALSE(parse_json(text)) << text;
  }
  EXPECT_FALSE(parse_json(std::string(100'000, '[')));
}

TEST(DvlJson, TextsAndNumbersReadBack) {
  EXPECT_EQ(*parse_json(json_text("a\"\\b"))->as<std::string>(), "a\"\\b");
  for (const double number : {0.1, -125.0, 1e-06, 1e20, 2.001829019472139}) {
    EXPECT_EQ(*parse_json(json_number(number))->as<double>(), number);
  }
  EXPECT_EQ(json_number(125), "125.0");
}

}  // namespace
}  // namespace sonard::dvl_a50
