// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/access.hpp"

#include <gtest/gtest.h>

namespace nodmap::viewer {
namespace access_test {

constexpr const char* kV1 = "foxglove.websocket.v1";

Request request(const std::string& target, const std::string& origin = "") {
  return {.target = target, .host = "127.0.0.1:8765", .origin = origin, .protocols = kV1};
}

const AccessPolicy kReadOnly{.loopback_only = true, .token = ""};
const AccessPolicy kWithControl{.loopback_only = true, .token = "secret"};

TEST(Access, ChoosesAnOfferedProtocol) {
  EXPECT_EQ(choose_protocol(kV1), kV1);
  EXPECT_EQ(choose_protocol("foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(choose_protocol("chat, foxglove.sdk.v1 ,foxglove.websocket.v1"), "foxglove.sdk.v1");
  EXPECT_FALSE(choose_protocol(""));
  EXPECT_FALSE(choose_protocol("foxglove.websocket.v10, ,"));
}

TEST(Access, AcceptsTheNamesOfThisHost) {
  for (const char* host : {"localhost", "localhost:8765", "127.0.0.1:1", "[::1]:8765", "[::1]"}) {
    EXPECT_TRUE(is_this_host(host)) << host;
  }
  for (const char* host : {"", "evil.example:8765", "localhost.evil.example", "127.0.0.1.evil", "[",
                           "[::1", "[::2]:1"}) {
    EXPECT_FALSE(is_this_host(host)) << host;
  }
}

TEST(Access, ANameReboundToThisHostIsRefused) {
  Request rebound = request("/", "http://evil.example:8765");
  rebound.host = "evil.example:8765";
  EXPECT_EQ(decide_access(rebound, kReadOnly).refusal, Refusal::kHost);
  EXPECT_EQ(decide_access(rebound, {.loopback_only = false, .token = ""}).refusal, Refusal::kNone);
}

TEST(Access, AnyOriginMayReadButOnlyOurPageMayControlAPlayback) {
  const Access foxglove = decide_access(request("/", "https://app.foxglove.dev"), kReadOnly);
  EXPECT_EQ(foxglove.refusal, Refusal::kNone);
  EXPECT_FALSE(foxglove.rights.may_play);
  EXPECT_FALSE(foxglove.rights.may_control);
  EXPECT_TRUE(decide_access(request("/", "http://127.0.0.1:8765"), kReadOnly).rights.may_play);
  EXPECT_TRUE(decide_access(request("/", "https://127.0.0.1:8765"), kReadOnly).rights.may_play);
  EXPECT_TRUE(decide_access(request("/"), kReadOnly).rights.may_play);
  EXPECT_FALSE(decide_access(request("/", "null"), kReadOnly).rights.may_play);
}

TEST(Access, ControlNeedsTheTokenAndOurOwnOrigin) {
  EXPECT_TRUE(decide_access(request("/?token=secret"), kWithControl).rights.may_control);
  EXPECT_TRUE(decide_access(request("/?a=b&token=secret&c", "http://127.0.0.1:8765"), kWithControl)
                  .rights.may_control);
  EXPECT_FALSE(decide_access(request("/"), kWithControl).rights.may_control);
  for (const char* wrong : {"/?token=Secret", "/?token=secre", "/?token=secrets", "/?token=x"}) {
    EXPECT_EQ(decide_access(request(wrong), kWithControl).refusal, Refusal::kToken) << wrong;
  }
  EXPECT_EQ(decide_access(request("/?token=secret", "http://evil.example"), kWithControl).refusal,
            Refusal::kToken);
  EXPECT_EQ(decide_access(request("/?token=secret"), kReadOnly).refusal, Refusal::kToken);
  EXPECT_FALSE(decide_access(request("/?token="), kReadOnly).rights.may_control);
  EXPECT_FALSE(decide_access(request("/?nottoken=secret"), kWithControl).rights.may_control);
}

TEST(Access, TokensAreLongAndDiffer) {
  const std::string token = make_token();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(token, make_token());
}

}  // namespace access_test
}  // namespace nodmap::viewer
