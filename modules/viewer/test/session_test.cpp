// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace nodmap::viewer {
namespace session_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Of all calls.
constexpr time::Duration kAge = 300ms;

class SessionTest : public ::testing::Test {
 protected:
  SessionTest() {
    scan_ = store_.add({"SCAN", "foxglove.LaserScan"});
    cloud_ = store_.add({"CLOUD", "foxglove.PointCloud", foxglove::Keep::kAll, 10});
    services_.name = "viewer";
    services_.session_id = "42";
  }

  Session greeted(Rights rights = {}) {
    Session session(store_, services_, rights);
    (void)session.next();
    (void)session.next();
    return session;
  }

  void post(std::size_t topic, std::int64_t utime, const std::string& text) {
    store_.post(topic, time::from_utime(utime), [text] { return text; });
  }

  static Json text_frame(Session& session) {
    const auto frame = session.next();
    return frame && !frame->is_binary ? Json::parse(frame->head) : Json();
  }

  // A service call with the id 7.
  static std::string call(const std::string& payload, char service = 1,
                          const std::string& encoding = "json") {
    return std::string{2, service, 0, 0, 0, 7, 0, 0, 0, static_cast<char>(encoding.size()),
                       0, 0,       0} +
           encoding + payload;
  }

  static void receive(Session& session, const std::string& message) {
    session.receive_binary(std::as_bytes(std::span(message)), kAge);
  }

  foxglove::TopicStore store_;
  Services services_;
  std::size_t scan_ = 0;
  std::size_t cloud_ = 0;
};

TEST_F(SessionTest, BeginsWithServerInfoAndTheListOfChannels) {
  Session session(store_, services_, {});
  const Json info = text_frame(session);
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["capabilities"], Json::array());
  EXPECT_EQ(info["sessionId"], "42");
  const Json channels = text_frame(session)["channels"];
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_EQ(channels[0]["topic"], "SCAN");
  EXPECT_EQ(channels[0]["encoding"], "json");
  EXPECT_EQ(channels[0]["schemaEncoding"], "jsonschema");
  EXPECT_EQ(Json::parse(channels[0]["schema"].get<std::string>())["type"], "object");
  EXPECT_FALSE(session.next());
}

// The layout of the specification: op, subscription, nanoseconds, payload; little-endian.
TEST_F(SessionTest, SendsSubscribedTopics) {
  Session session = greeted();
  post(scan_, 0x0102, "{}");
  EXPECT_FALSE(session.next());
  session.receive_text(R"({"op":"subscribe","subscriptions":[{"id":513,"channelId":1}]})");
  const auto frame = session.next();
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->is_binary);
  // 0x0102 us are 258000 ns: 0x03EFD0.
  EXPECT_EQ(frame->head, std::string("\x01\x01\x02\x00\x00\xD0\xEF\x03\x00\x00\x00\x00\x00", 13));
  EXPECT_EQ(frame->post->text(), "{}");
  EXPECT_FALSE(session.next());
}

TEST_F(SessionTest, ASlowClientMissesReplacedMessagesButNoKeyframe) {
  Session session = greeted();
  session.receive_text(
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]})");
  for (int i = 0; i < 3; ++i) {
    post(scan_, i, "scan" + std::to_string(i));
    post(cloud_, i, "cloud" + std::to_string(i));
  }
  std::vector<std::string> sent;
  while (const auto frame = session.next()) {
    sent.push_back(frame->post->text());
  }
  EXPECT_THAT(sent, ::testing::UnorderedElementsAre("scan2", "cloud0", "cloud1", "cloud2"));
}

TEST_F(SessionTest, TopicsAreSentInTurn) {
  Session session = greeted();
  session.receive_text(
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]})");
  for (int i = 0; i < 5; ++i) {
    post(cloud_, i, "cloud");
  }
  post(scan_, 0, "scan");
  const std::string first = session.next()->post->text();
  const std::string second = session.next()->post->text();
  // A long history does not delay the other topics.
  EXPECT_NE(first, second);
}

TEST_F(SessionTest, MessagesWaitForTheNextUpdateButAnswersDoNot) {
  Session session = greeted();
  session.receive_text(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]})");
  post(scan_, 1, "old");
  session.receive_text("nonsense");
  const auto answer = session.next(false);
  ASSERT_TRUE(answer);
  EXPECT_FALSE(answer->is_binary);
  EXPECT_FALSE(session.next(false));
  post(scan_, 2, "new");
  const auto frame = session.next(true);
  ASSERT_TRUE(frame && frame->post);
  EXPECT_EQ(frame->post->text(), "new");
  EXPECT_FALSE(session.next(true)) << "the replaced message is not sent";
}

// A client forgets everything when the time steps back: a history sent before the new time would be
// lost.
TEST_F(SessionTest, TheTimeIsSentBeforeAHistory) {
  Session session = greeted();
  session.receive_text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})");
  post(cloud_, 1, "cloud");
  session.send_time(time::from_utime(2));
  const auto time = session.next(false);
  ASSERT_TRUE(time);
  EXPECT_FALSE(time->post);
  const auto cloud = session.next(false);
  ASSERT_TRUE(cloud && cloud->post);
  EXPECT_EQ(cloud->post->text(), "cloud");
}

TEST_F(SessionTest, AHistoryIsAlsoSentBetweenTwoUpdates) {
  Session session = greeted();
  session.receive_text(
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]})");
  post(scan_, 1, "scan");
  for (int i = 0; i < 3; ++i) {
    post(cloud_, i, "cloud" + std::to_string(i));
  }
  std::vector<std::string> sent;
  while (const auto frame = session.next(false)) {
    sent.push_back(frame->post->text());
  }
  EXPECT_THAT(sent, ::testing::ElementsAre("cloud0", "cloud1", "cloud2"));
}

TEST_F(SessionTest, AfterUnsubscribingNothingIsSent) {
  Session session = greeted();
  session.receive_text(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1}]})");
  session.receive_text(R"({"op":"unsubscribe","subscriptionIds":[7]})");
  post(scan_, 1, "{}");
  EXPECT_FALSE(session.next());
  EXPECT_EQ(session.refused(), 0);
}

class Nonsense : public SessionTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(Nonsense, IsAnsweredWithAStatusAndCounted) {
  Session session = greeted({.may_play = true, .may_control = false});
  session.receive_text(GetParam());
  const Json answer = text_frame(session);
  EXPECT_EQ(answer["op"], "status");
  EXPECT_EQ(answer["level"], 2);
  EXPECT_EQ(session.refused(), 1);
}

INSTANTIATE_TEST_SUITE_P(
    All, Nonsense,
    ::testing::Values(
        "", "nonsense", "[1]", "\"op\"", "{}", R"({"op":1})", R"({"op":"explode"})",
        R"({"op":"subscribe","subscriptions":[{"id":0}]})",
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":0}]})",
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":"a","channelId":1}]})",
        R"({"op":"advertise","channels":[{"id":1,"encoding":"json","topic":"DRIVE"}]})",
        R"({"op":"setParameters","parameters":[{"name":"x","value":1}]})",
        "{\"op\":\"subscribe\xFF\"}"));

TEST_F(SessionTest, DeeplyNestedJsonIsRefused) {
  Session session = greeted();
  session.receive_text(std::string(60'000, '['));
  EXPECT_EQ(session.refused(), 1);
}

TEST_F(SessionTest, TheNumberOfSubscriptionsIsLimited) {
  Session session = greeted();
  for (std::size_t i = 0; i <= Session::kMaxSubscriptions; ++i) {
    session.receive_text(R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(i) +
                         R"(,"channelId":1}]})");
  }
  EXPECT_EQ(session.refused(), 1);
}

TEST_F(SessionTest, TheNumberOfUnreadAnswersIsLimited) {
  Session session = greeted();
  for (int i = 0; i < 1000; ++i) {
    session.receive_text("nonsense");
  }
  std::size_t waiting = 0;
  while (session.next()) {
    ++waiting;
  }
  EXPECT_EQ(waiting, Session::kMaxWaiting);
  EXPECT_EQ(session.refused(), 1000);
}

TEST_F(SessionTest, WithoutControlCallsAreRefused) {
  int asked = 0;
  services_.control = [&asked](const Json&, time::Duration) {
    ++asked;
    return Answer{.ok = true, .text = ""};
  };
  Session session = greeted({.may_play = true, .may_control = false});
  receive(session, call(R"({"do":"stop"})"));
  EXPECT_EQ(asked, 0);
  EXPECT_EQ(session.refused(), 1);
  const Json failure = text_frame(session);
  EXPECT_EQ(failure["op"], "serviceCallFailure");
  EXPECT_EQ(failure["callId"], 7);
  EXPECT_THAT(failure["message"].get<std::string>(), HasSubstr("only read"));
}

TEST_F(SessionTest, WithControlCallsAreAnswered) {
  services_.control = [](const Json& request, time::Duration age) {
    EXPECT_EQ(age, kAge);
    return Answer{.ok = request["do"] == "stop", .text = "CommandOutput."};
  };
  services_.controls_processes = true;
  services_.metadata = {{"gap_s", "1.0"}};
  Session session(store_, services_, {.may_play = true, .may_control = true});
  const Json info = text_frame(session);
  EXPECT_EQ(info["capabilities"], Json::array({"services"}));
  EXPECT_EQ(info["metadata"], Json({{"process_control", "true"}, {"gap_s", "1.0"}}));
  (void)session.next();
  EXPECT_EQ(text_frame(session)["services"][0]["name"], "control");
  receive(session, call(R"({"do":"stop"})"));
  const auto frame = session.next();
  ASSERT_TRUE(frame && frame->is_binary);
  const std::string head("\x03\x01\0\0\0\x07\0\0\0\x04\0\0\0json", 17);
  EXPECT_EQ(frame->head, head + R"({"ok":true,"text":"CommandOutput."})");
  EXPECT_EQ(session.refused(), 0);
  receive(session, call(R"({"do":"fly"})"));
  EXPECT_EQ(session.next()->head, head + R"({"ok":false,"text":"CommandOutput."})");
  EXPECT_EQ(session.refused(), 1);
}

TEST_F(SessionTest, InvalidCallsAreCountedAndAnswered) {
  int asked = 0;
  services_.control = [&asked](const Json&, time::Duration) {
    ++asked;
    return Answer{.ok = true, .text = ""};
  };
  Session session = greeted({.may_play = true, .may_control = true});
  (void)session.next();
  receive(session, call("[1]"));
  receive(session, call("no JSON"));
  receive(session, call("{}", 2));  // another service
  receive(session, call("{}", 1, "cdr"));
  const std::string good = call("{}");
  for (std::size_t size = 0; size < 17; ++size) {  // truncated before the payload
    receive(session, good.substr(0, size));
  }
  receive(session, "\x01" + good.substr(1));
  std::string too_long = good;
  too_long[12] = '\x7F';  // of the encoding
  receive(session, too_long);
  EXPECT_EQ(asked, 0);
  EXPECT_EQ(session.refused(), 4 + 17 + 2);
}

TEST_F(SessionTest, ParametersAreReadByAllAndSetOnlyByClientsWithTheRight) {
  double speed = 1.0;
  services_.parameters = [&speed] {
    return Json::array({{{"name", "playback.speed"}, {"value", speed}}});
  };
  services_.set_parameter = [&speed](const std::string&, const Json& value) {
    speed = value.get<double>();
    return std::string();
  };
  const std::string set =
      R"({"op":"setParameters","parameters":[{"name":"playback.speed","value":2}]})";
  Session reader = greeted();
  reader.receive_text(R"({"op":"getParameters","parameterNames":[],"id":"x"})");
  const Json answer = text_frame(reader);
  EXPECT_EQ(answer["id"], "x");
  EXPECT_EQ(answer["parameters"][0]["value"], 1.0);
  reader.receive_text(set);
  EXPECT_EQ(speed, 1.0);
  EXPECT_EQ(reader.refused(), 1);
  Session player = greeted({.may_play = true, .may_control = false});
  player.receive_text(set);
  EXPECT_EQ(speed, 2.0);
  EXPECT_EQ(player.refused(), 0);
}

TEST_F(SessionTest, ChangedParametersAreSentToSubscribers) {
  services_.parameters = [] { return Json::array(); };
  Session session = greeted();
  session.send_changed_parameters();
  EXPECT_FALSE(session.next());
  session.receive_text(R"({"op":"subscribeParameterUpdates","parameterNames":[]})");
  session.send_changed_parameters();
  EXPECT_EQ(text_frame(session)["op"], "parameterValues");
  session.receive_text(R"({"op":"unsubscribeParameterUpdates","parameterNames":[]})");
  session.send_changed_parameters();
  EXPECT_FALSE(session.next());
}

TEST_F(SessionTest, SendsTheRequestedParameters) {
  services_.parameters = [] {
    return Json::array({{{"name", "a"}, {"value", 1}}, {{"name", "b"}, {"value", 2}}});
  };
  Session session = greeted();
  session.receive_text(R"({"op":"getParameters","parameterNames":["b","none"]})");
  EXPECT_EQ(text_frame(session)["parameters"], Json::array({{{"name", "b"}, {"value", 2}}}));
  session.receive_text(R"({"op":"getParameters","parameterNames":[]})");
  EXPECT_EQ(text_frame(session)["parameters"].size(), 2U);
}

TEST_F(SessionTest, SendsTheNewestTimeOnce) {
  Session session = greeted();
  session.send_time(time::from_utime(1));
  session.send_time(time::from_utime(2));
  const auto frame = session.next();
  ASSERT_TRUE(frame && frame->is_binary);
  EXPECT_EQ(frame->head, std::string("\x02\xD0\x07\x00\x00\x00\x00\x00\x00", 9));
  EXPECT_FALSE(session.next());
}

}  // namespace session_test
}  // namespace nodmap::viewer
