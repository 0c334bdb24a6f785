// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/replay.hpp"

#include <boost/core/noncopyable.hpp>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/log_player.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/message_counts.hpp"
#include "common/node/program.hpp"
#include "modules/viewer/access.hpp"
#include "modules/viewer/foxglove/feed.hpp"
#include "modules/viewer/log_history.hpp"
#include "modules/viewer/playback.hpp"
#include "modules/viewer/viewer.hpp"

namespace nodmap::viewer {
namespace {

// Number of events delivered between two updates of the clients: about ten milliseconds of work.
constexpr std::int64_t kMaxEvents = 5000;

// The page and the recordings' values for its plots.
Site site_of(const std::vector<std::filesystem::path>& logs) {
  Site site;
  site.add("/history.json", {.content_type = "application/json; charset=utf-8",
                             .content = foxglove::to_text(log_history(logs))});
  return site;
}

class Replay : private boost::noncopyable {
 public:
  Replay(const Options& options, const ViewerParams& params)
      : player_(options.replay),
        events_(playback_events(options.replay)),
        site_(site_of(options.replay)),
        feed_(player_, store_, counts_, params.feed),
        viewer_(options, params, site_, store_, services()) {
    for (const std::string& damage : player_.damages()) {
      log::get().warn("{}", damage);
    }
  }

  void run() {
    time::SteadyTime last = time::steady_now();
    while (!node::stop_requested()) {
      viewer_.serve();
      const time::SteadyTime now = time::steady_now();
      play(now - std::exchange(last, now));
      viewer_.poll();
    }
  }

 private:
  [[nodiscard]] Services services();
  [[nodiscard]] Json parameters() const;
  std::string set_parameter(const std::string& name, const Json& value);
  void play(time::Duration duration);

  bus::LogPlayer player_;
  std::vector<std::string> events_;
  node::MessageCounts counts_;
  Site site_;
  foxglove::TopicStore store_;
  foxglove::Feed feed_;
  bool has_changed_ = false;    // a parameter was set, which the clients do not know yet
  bool has_gone_back_ = false;  // what is in the store lies in the future
  Viewer viewer_;
};

Services Replay::services() {
  return {.name = kProgram,
          .session_id = make_token(),
          .sends_time = true,
          .parameters = [this] { return parameters(); },
          .set_parameter = [this](const std::string& name,
                                  const Json& value) { return set_parameter(name, value); },
          .control = {},
          .controls_processes = false};
}

Json Replay::parameters() const {
  Json parameters = playback_parameters(player_);
  parameters.push_back({{"name", "playback.events"}, {"value", events_}});
  return parameters;
}

std::string Replay::set_parameter(const std::string& name, const Json& value) {
  const PlaybackChange change = set_playback_parameter(player_, name, value);
  has_changed_ = true;
  has_gone_back_ = has_gone_back_ || change.went_back;
  return change.refusal;
}

void Replay::play(time::Duration duration) {
  player_.advance(duration);
  if (std::exchange(has_gone_back_, false)) {
    store_.clear();
    feed_.reset();
  }
  player_.catch_up(kMaxEvents);
  viewer_.server().send_time(player_.now());
  if (std::exchange(has_changed_, false)) {
    viewer_.server().send_changed_parameters();
  }
}

}  // namespace

void run_replay(const Options& options, const ViewerParams& params) {
  Replay(options, params).run();
}

}  // namespace nodmap::viewer
