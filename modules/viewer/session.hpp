// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/time.hpp"
#include "modules/viewer/answer.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"
#include "modules/viewer/service_call.hpp"

namespace nodmap::viewer {

/// What a viewer offers its clients in addition to reading.
struct Services {
  std::string name;
  std::string session_id;  ///< the same for all sessions of one process
  /// Whether the viewer sends the time, because it plays a recording.
  bool sends_time = false;
  /// The state of the playback: a list of {name, value}; empty without a playback.
  std::function<Json()> parameters;
  /// Sets a parameter; returns why this was refused, or an empty text.
  std::function<std::string(const std::string& name, const Json& value)> set_parameter;
  /// Executes a request of a client with control, which is at most `age` old, and answers it.
  std::function<Answer(const Json& request, time::Duration age)> control;
  /// Whether requests may also control processes and recordings.
  bool controls_processes = false;
  /// What our page wants to know, by name.
  std::map<std::string, std::string> metadata{};
};

/// The rights of one client.
struct Rights {
  bool may_play = false;     ///< control the playback
  bool may_control = false;  ///< control the robot
};

/// One frame to send: `head`, then the payload, which is shared with other sessions.
struct Frame {
  bool is_binary = false;
  std::string head;
  std::shared_ptr<foxglove::Post> post;  ///< its text follows the head; may be null
};

/// One client of Foxglove's WebSocket protocol (`foxglove.websocket.v1`), without its socket:
/// received messages in, frames to send out. No message from a client makes it throw or grow
/// without limit. Source: https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md
class Session {
 public:
  static constexpr std::size_t kMaxSubscriptions = 256;
  /// Greatest number of answers that wait for a slow client; further ones are dropped.
  static constexpr std::size_t kMaxWaiting = 64;

  /// Both must outlive this object.
  Session(const foxglove::TopicStore& store, const Services& services, Rights rights);

  void receive_text(std::string_view text);
  /// `age`: the greatest that the message can have.
  void receive_binary(std::span<const std::byte> bytes, time::Duration age);

  /// The next frame to send, if any. Subscribed topics are served in turn. Without `with_news` it
  /// returns only answers, the time, and messages of CLOUD and log, which must all be sent.
  [[nodiscard]] std::optional<Frame> next(bool with_news = true);

  /// Sends the client the time of the recording before the next frames.
  void send_time(time::Timestamp stamp);
  /// Sends the parameters to a client that has subscribed to them.
  void send_changed_parameters();

  /// Number of the client's messages that were refused.
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
  void answer(const ServiceCall& call, time::Duration age);
  void fail(const ServiceCall& call, const std::string& reason);

  const foxglove::TopicStore& store_;
  const Services& services_;
  Rights rights_;
  std::deque<Frame> waiting_;
  std::vector<Subscription> subscriptions_;
  bool wants_parameters_ = false;
  std::size_t served_ = 0;
  std::optional<time::Timestamp> time_;
  std::int64_t refused_ = 0;
};

}  // namespace nodmap::viewer
