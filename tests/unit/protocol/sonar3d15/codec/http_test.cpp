// SPDX-License-Identifier: Apache-2.0
// Requests in any pieces, and those that end a connection (acceptance 10).
#include "protocol/sonar3d15/http.hpp"

#include <gtest/gtest.h>

namespace sonard::sonar3d15 {
namespace {

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string text_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

/// The status of the last reply to these bytes.
int fault_of(const std::string& text) {
  RequestBuffer buffer;
  buffer.append(bytes_of(text));
  const auto request = buffer.next();
  return request && !request->has_value() ? request->error() : 0;
}

TEST(Http, ARequestInSinglesBytesIsWholeAtItsLastByte) {
  const std::string text =
      "POST /api/v1/integration/acoustics/enabled?x=1 HTTP/1.1\r\nHost: 10.0.0.1\r\ncontent-LENGTH:  4 "
      "\r\n\r\ntrue";
  RequestBuffer buffer;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    buffer.append(bytes_of(text.substr(i, 1)));
    ASSERT_FALSE(buffer.next()) << i;
  }
  buffer.append(bytes_of(text.substr(text.size() - 1)));
  const auto request = buffer.next();
  ASSERT_TRUE(request && *request);
  EXPECT_EQ((*request)->method, "POST");
  EXPECT_EQ((*request)->path, "/api/v1/integration/acoustics/enabled");
  EXPECT_EQ((*request)->body, "true");
  EXPECT_TRUE((*request)->stays);
  EXPECT_FALSE(buffer.next());
}

TEST(Http, RequestsInOnePieceFollowEachOther) {
  RequestBuffer buffer;
  buffer.append(encode(Request{"POST", "/a", "1", true}));
  buffer.append(encode(Request{"GET", "/b", "", false}));
  const auto first = buffer.next(), second = buffer.next();
  ASSERT_TRUE(first && *first && second && *second);
  EXPECT_EQ((*first)->body, "1");
  EXPECT_EQ((*second)->path, "/b");
  EXPECT_FALSE((*second)->stays);
}

TEST(Http, AConnectionOfVersion10EndsAndAProxyNamesTheHost) {
  RequestBuffer buffer;
  buffer.append(bytes_of("GET http://sonar:80/udp?a=b HTTP/1.0\r\n\r\n"));
  const auto request = buffer.next();
  ASSERT_TRUE(request && *request);
  EXPECT_EQ((*request)->path, "/udp");
  EXPECT_FALSE((*request)->stays);
}

TEST(Http, WhatCannotBeReadEndsTheConnection) {
  EXPECT_EQ(fault_of("\x16\x03\x01 TLS\r\n\r\n"), 400);
  EXPECT_EQ(fault_of("GET / HTTP/2\r\n\r\n"), 400);
  EXPECT_EQ(fault_of("GET  HTTP/1.1\r\n\r\n"), 400);
  EXPECT_EQ(fault_of("POST /a HTTP/1.1\r\nContent-Length: -1\r\n\r\n"), 400);
  EXPECT_EQ(fault_of("POST /a HTTP/1.1\r\nContent-Length: 4x\r\n\r\n"), 400);
  EXPECT_EQ(fault_of("POST /a HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n"), 501);
  EXPECT_EQ(fault_of("POST /a HTTP/1.1\r\n\r\ntrue"), 411);
  EXPECT_EQ(fault_of("POST /a HTTP/1.1\r\nContent-Length: 1048576\r\n\r\n"), 413);
  EXPECT_EQ(fault_of("POST /a HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n\r\n"), 413);
  EXPECT_EQ(fault_of("GET /" + std::string(9000, 'a')), 431);
  EXPECT_EQ(fault_of("GET /" + std::string(9000, 'a') + " HTTP/1.1\r\n\r\n"), 431);
  EXPECT_EQ(fault_of("GET /" + std::string(8000, 'a')), 0);
}

TEST(Http, NothingIsReadAfterAFault) {
  RequestBuffer buffer;
  buffer.append(bytes_of("nonsense\r\n\r\n"));
  EXPECT_TRUE(buffer.next());
  buffer.append(encode(Request{"GET", "/", "", true}));
  EXPECT_FALSE(buffer.next());
}

TEST(Http, RepliesHaveALengthUnlessTheyAreEmpty) {
  EXPECT_EQ(text_of(encode(Reply{204, ""}, true)), "HTTP/1.1 204 No Content\r\n\r\n");
  EXPECT_EQ(text_of(encode(Reply{200, "true"}, false)),
            "HTTP/1.1 200 OK\r\nContent-Type: application/json; charset=utf-8\r\nContent-Length: 4\r\n"
            "Connection: close\r\n\r\ntrue");
  const auto reply = decode_reply(encode(Reply{409, "\"no\""}, true));
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 409);
  EXPECT_EQ(reply->body, "\"no\"");
  std::vector<std::uint8_t> cut = encode(Reply{200, "true"}, true);
  cut.pop_back();
  EXPECT_FALSE(decode_reply(cut));
}

}  // namespace
}  // namespace sonard::sonar3d15
