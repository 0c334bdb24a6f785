// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/bus/sender_watch.hpp"
#include "common/node/message_counts.hpp"
#include "modules/viewer/foxglove/process_tables.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"
#include "procman/config/config.hpp"

namespace nodmap::foxglove {

/// Queue capacity of the viewer's subscriptions: far more than the messages of one period of
/// the viewer and a burst of parts.
inline constexpr int kFeedQueue = 512;

/// Subscribes to STATUS and PM_INFO, and posts the tables of processes and commands and the log of
/// health changes to a topic store. Of each name and host it shows the messages of one process, and
/// says so in the health of its STATUS if another process sends in its name.
class ProcessFeed : boost::noncopyable {
 public:
  /// Adds its topics. All three must outlive this object.
  ProcessFeed(bus::Bus& bus, TopicStore& store, node::MessageCounts& counts);

  /// Forgets all processes and hosts, because a recording starts again.
  void reset();

  /// Adds the commands of the process manager's configuration to the table of commands.
  void set_configured_commands(const procman::Config& config);

 private:
  void subscribe_status(bus::Bus& bus);
  void subscribe_info(bus::Bus& bus);
  void post_commands(time::Timestamp stamp);

  /// The senders of a channel, by the name in the message and the host.
  using Senders = std::map<std::pair<std::string, std::uint32_t>, bus::SenderWatch>;
  enum class Trust : std::uint8_t { kAlone, kContested, kRefused, kTooMany };

  [[nodiscard]] Trust follow(Senders& senders, const std::string& name) const;
  bus::Bus& bus_;
  TopicStore& store_;
  node::MessageCounts& counts_;
  ProcessTable processes_;
  CommandTable commands_;
  Senders status_senders_;
  Senders info_senders_;
  std::size_t commands_topic_ = 0;
};

}  // namespace nodmap::foxglove
