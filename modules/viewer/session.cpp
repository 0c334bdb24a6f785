// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/session.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "modules/viewer/foxglove/foxglove.hpp"
#include "modules/viewer/json.hpp"

namespace nodmap::viewer {
namespace {

// Operation codes, the first bytes of binary frames.
constexpr char kMessageData = 1;
constexpr char kTime = 2;
constexpr int kStatusError = 2;

std::uint64_t nanoseconds(time::Timestamp stamp) {
  return 1000U * static_cast<std::uint64_t>(std::max<std::int64_t>(time::to_utime(stamp), 0));
}

// An unsigned 32-bit number; empty if the value is none.
std::optional<std::uint32_t> to_id(const Json& value) {
  const bool is_id = value.is_number_unsigned() &&
                     value.get<std::uint64_t>() <= std::numeric_limits<std::uint32_t>::max();
  return is_id ? std::optional(value.get<std::uint32_t>()) : std::nullopt;
}

// The number of this name; empty if there is none.
std::optional<std::uint32_t> id_in(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found == object.end() ? std::nullopt : to_id(*found);
}

// The objects in the list of this name; empty if there is no such list.
std::vector<Json> objects_in(const Json& message, const char* name) {
  std::vector<Json> objects;
  const auto found = message.find(name);
  if (found != message.end() && found->is_array()) {
    std::copy_if(found->begin(), found->end(), std::back_inserter(objects),
                 [](const Json& item) { return item.is_object(); });
  }
  return objects;
}

// The numbers in the list of this name.
std::vector<std::uint32_t> ids_in(const Json& message, const char* name) {
  std::vector<std::uint32_t> ids;
  const auto found = message.find(name);
  if (found != message.end() && found->is_array()) {
    for (const Json& item : *found) {
      if (const auto id = to_id(item)) {
        ids.push_back(*id);
      }
    }
  }
  return ids;
}

Json channel_json(std::size_t topic, const foxglove::Topic& what) {
  return {{"id", topic + 1},
          {"topic", what.name},
          {"encoding", "json"},
          {"schemaName", what.schema_name},
          {"schema", foxglove::schema_text(what.schema_name)},
          {"schemaEncoding", "jsonschema"}};
}

}  // namespace

Session::Session(const foxglove::TopicStore& store, const Services& services, Rights rights)
    : store_(store), services_(services), rights_(rights) {
  greet();
}

void Session::greet() {
  Json capabilities = Json::array();
  if (services_.sends_time) {
    capabilities.push_back("time");
  }
  if (services_.parameters) {
    capabilities.push_back("parameters");
    capabilities.push_back("parametersSubscribe");
  }
  if (rights_.may_control) {
    capabilities.push_back("services");
  }
  Json metadata(services_.metadata);
  if (rights_.may_control && services_.controls_processes) {
    metadata["process_control"] = "true";
  }
  send({{"op", "serverInfo"},
        {"name", services_.name},
        {"capabilities", std::move(capabilities)},
        {"supportedEncodings", Json::array({"json"})},
        {"metadata", std::move(metadata)},
        {"sessionId", services_.session_id}});
  Json channels = Json::array();
  for (std::size_t topic = 0; topic < store_.topics().size(); ++topic) {
    channels.push_back(channel_json(topic, store_.topics()[topic]));
  }
  send({{"op", "advertise"}, {"channels", std::move(channels)}});
  if (rights_.may_control) {
    send({{"op", "advertiseServices"}, {"services", Json::array({control_service()})}});
  }
}

void Session::send(const Json& message) {
  send(Frame{.is_binary = false, .head = foxglove::to_text(message), .post = nullptr});
}

void Session::send(Frame frame) {
  if (waiting_.size() < kMaxWaiting) {
    waiting_.push_back(std::move(frame));
  }
}

void Session::refuse(const std::string& reason) {
  ++refused_;
  send({{"op", "status"}, {"level", kStatusError}, {"message", reason}});
}

void Session::receive_text(std::string_view text) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) {
    refuse("not a JSON object");
    return;
  }
  handle(message);
}

void Session::handle(const Json& message) {
  using Handler = void (Session::*)(const Json&);
  static constexpr std::pair<std::string_view, Handler> kHandlers[] = {
      {"subscribe", &Session::subscribe},
      {"unsubscribe", &Session::unsubscribe},
      {"getParameters", &Session::send_parameters},
      {"setParameters", &Session::set_parameters}};
  const std::string op = text_in(message, "op");
  for (const auto& [name, handler] : kHandlers) {
    if (op == name) {
      (this->*handler)(message);
      return;
    }
  }
  if (op == "subscribeParameterUpdates" || op == "unsubscribeParameterUpdates") {
    wants_parameters_ = op == "subscribeParameterUpdates";
    return;
  }
  refuse("unknown op");
}

void Session::subscribe(const Json& message) {
  for (const Json& wish : objects_in(message, "subscriptions")) {
    const auto id = id_in(wish, "id");
    const auto channel = id_in(wish, "channelId");
    if (!id || !channel || *channel == 0 || *channel > store_.topics().size()) {
      refuse("subscription to an unknown channel");
    } else if (std::ranges::any_of(subscriptions_,
                                   [&](const Subscription& s) { return s.id == *id; })) {
      refuse("subscription id is in use");
    } else if (subscriptions_.size() >= kMaxSubscriptions) {
      refuse("too many subscriptions");
    } else {
      subscriptions_.push_back({*id, *channel - 1, 0});
    }
  }
}

void Session::unsubscribe(const Json& message) {
  for (const std::uint32_t id : ids_in(message, "subscriptionIds")) {
    std::erase_if(subscriptions_, [id](const Subscription& s) { return s.id == id; });
  }
}

void Session::receive_binary(std::span<const std::byte> bytes, time::Duration age) {
  if (const auto call = read_service_call(bytes)) {
    answer(*call, age);
  } else {
    refuse("unknown binary op");
  }
}

void Session::answer(const ServiceCall& call, time::Duration age) {
  if (!rights_.may_control || !services_.control) {
    fail(call, "this connection may only read");
    return;
  }
  if (call.service_id != kControlService || call.encoding != "json") {
    fail(call, "no such service, or not in JSON");
    return;
  }
  const Json request = Json::parse(call.payload, nullptr, false);
  const Answer answer = request.is_object() ? services_.control(request, age)
                                            : Answer{.ok = false, .text = "Not a JSON object."};
  refused_ += answer.ok ? 0 : 1;
  send(Frame{.is_binary = true,
             .head = service_answer(call, {{"ok", answer.ok}, {"text", answer.text}}),
             .post = nullptr});
}

void Session::fail(const ServiceCall& call, const std::string& reason) {
  ++refused_;
  send(service_failure(call, reason));
}

void Session::send_parameters(const Json& message) {
  Json parameters = services_.parameters ? services_.parameters() : Json::array();
  // An empty or missing list of names requests all parameters.
  if (const auto names = message.find("parameterNames");
      names != message.end() && names->is_array() && !names->empty()) {
    std::erase_if(parameters.get_ref<Json::array_t&>(), [&names](const Json& parameter) {
      return std::find(names->begin(), names->end(), parameter["name"]) == names->end();
    });
  }
  Json answer = {{"op", "parameterValues"}, {"parameters", std::move(parameters)}};
  if (const std::string id = text_in(message, "id"); !id.empty()) {
    answer["id"] = id;
  }
  send(answer);
}

void Session::set_parameters(const Json& message) {
  for (const Json& parameter : objects_in(message, "parameters")) {
    if (!rights_.may_play || !services_.set_parameter) {
      refuse("this connection may not set parameters");
      continue;
    }
    const auto value = parameter.find("value");
    const std::string reason = services_.set_parameter(text_in(parameter, "name"),
                                                       value == parameter.end() ? Json() : *value);
    if (!reason.empty()) {
      refuse(reason);
    }
  }
  if (!text_in(message, "id").empty()) {
    send_parameters(message);
  }
}

void Session::send_time(time::Timestamp stamp) {
  time_ = stamp;
}

void Session::send_changed_parameters() {
  if (wants_parameters_) {
    send_parameters(Json::object());
  }
}

std::optional<Frame> Session::next(bool with_news) {
  if (!waiting_.empty()) {
    Frame frame = std::move(waiting_.front());
    waiting_.pop_front();
    return frame;
  }
  // Before the messages that follow it, because a client forgets everything when the time goes
  // back.
  if (time_) {
    Frame frame{.is_binary = true, .head = {kTime}, .post = nullptr};
    append_little_endian(frame.head, nanoseconds(*time_));
    time_.reset();
    return frame;
  }
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    served_ = (served_ + 1) % subscriptions_.size();
    Subscription& subscription = subscriptions_[served_];
    const bool is_once = store_.topics()[subscription.topic].keep == foxglove::Keep::kAll;
    if (!with_news && !is_once) {
      continue;
    }
    if (auto post = store_.next(subscription.topic, subscription.cursor)) {
      Frame frame{.is_binary = true, .head = {kMessageData}, .post = std::move(post)};
      append_little_endian(frame.head, subscription.id);
      append_little_endian(frame.head, nanoseconds(frame.post->stamp()));
      return frame;
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::viewer
