// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/time.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"
#include "modules/viewer/service_call.hpp"

namespace nodmap::viewer {

/// The answer to a request, in words for people.
struct Answer {
  bool ok = false;
  std::string text;
};

/// What a viewer offers its clients besides reading.
struct Services {
  std::string name;
  std::string session_id;  ///< the same for all sessions of one process
  /// Whether the viewer is the source of time (it plays a recording).
  bool sends_time = false;
  /// The state of the playback: a list of {name, value}; empty where nothing is played.
  std::function<Json()> parameters;
  /// Sets one; returns why not, or nothing.
  std::function<std::string(const std::string& name, const Json& value)> set_parameter;
  /// Does what a client with control asks for, and answers.
  std::function<Answer(const Json& request)> control;
  /// Whether that goes for processes and recordings, too.
  bool controls_processes = false;
};

/// What one client may do.
struct Rights {
  bool play = false;     ///< steer the playback
  bool control = false;  ///< ask for what the robot is to do
};

/// One frame for the socket. `head` goes before the payload, which is shared with other sessions.
struct Frame {
  bool is_binary = false;
  std::string head;
  std::shared_ptr<foxglove::Post> post;  ///< its text follows the head; may be null
};

/// One client of Foxglove's WebSocket protocol (`foxglove.websocket.v1`), without its socket: what
/// the client sends goes in, frames to send come out. Nothing a client sends makes it throw or grow
/// without bound.
/// Source: https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md
class Session {
 public:
  static constexpr std::size_t kMaxSubscriptions = 256;
  /// Answers that wait for a client that does not read; more are dropped.
  static constexpr std::size_t kMaxWaiting = 64;

  /// Both must outlive this object.
  Session(const foxglove::TopicStore& store, const Services& services, Rights rights);

  void receive_text(std::string_view text);
  void receive_binary(std::span<const std::byte> bytes);

  /// The next frame to send, if any. Subscribed topics are served one after the other; without
  /// news only answers go out, the time, and what is sent once: of CLOUD and log all messages.
  [[nodiscard]] std::optional<Frame> next(bool with_news = true);

  /// Sends the client the time of the recording, with the next frames.
  void send_time(time::Timestamp stamp);
  /// Sends the parameters to a client that has subscribed to them.
  void send_changed_parameters();

  /// How many of the client's messages were refused.
  [[nodiscard]] std::int64_t refused() const { return refused_; }

 private:
  struct Subscription {
    std::uint32_t id = 0;
    std::size_t topic = 0;
    std::uint64_t cursor = 0;
  };

  void send(const Json& message);
  void send(Frame frame);
  void refuse(const std::string& reason);
  void greet();
  void handle(const Json& message);
  void subscribe(const Json& message);
  void unsubscribe(const Json& message);
  void send_parameters(const Json& message);
  void set_parameters(const Json& message);
  void answer(const ServiceCall& call);
  void fail(const ServiceCall& call, const std::string& reason);

  const foxglove::TopicStore& store_;
  const Services& services_;
  Rights rights_;
  std::deque<Frame> waiting_;
  std::vector<Subscription> subscriptions_;
  bool wants_parameters_ = false;
  std::size_t turn_ = 0;
  std::optional<time::Timestamp> time_;
  std::int64_t refused_ = 0;
};

}  // namespace nodmap::viewer
