// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/mcap_export.hpp"

#include <cstdint>
#include <stdexcept>

#include "common/bus/log_player.hpp"
#include "common/formats/user_error.hpp"
#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "modules/viewer/foxglove/feed.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"
#include "tools/convert/mcap_writer.hpp"
#include "tools/convert/new_file.hpp"

namespace nodmap::convert {
namespace {

// Coarser than on the screen: each message contains a whole trail, so trails would otherwise be
// most of the file.
constexpr double kTrailSpacingM = 1.0;
// Between two looks whether to stop.
constexpr std::int64_t kEventsAtOnce = 10'000;

std::uint64_t nanoseconds(time::Timestamp stamp) {
  const std::int64_t utime = time::to_utime(stamp);
  return utime > 0 ? 1000U * static_cast<std::uint64_t>(utime) : 0U;
}

}  // namespace

void export_mcap(const std::filesystem::path& log, const std::filesystem::path& out) {
  bus::LogPlayer player({log});
  for (const std::string& damage : player.damages()) {
    nodmap::log::get().warn("{}", damage);
  }
  NewFile file(out);
  McapWriter writer(file.partial_path());
  foxglove::TopicStore store;
  node::MessageCounts counts;
  const foxglove::Feed feed(player, store, counts,
                            {.cloud_spacing_m = 0.0, .trail_spacing_m = kTrailSpacingM});
  for (const foxglove::Topic& topic : store.topics()) {
    writer.add_channel({topic.name, topic.schema_name, foxglove::schema_text(topic.schema_name)});
  }
  store.listen([&](std::size_t topic, foxglove::Post& post) {
    writer.write(static_cast<std::uint16_t>(topic), nanoseconds(player.logged_time()),
                 nanoseconds(post.stamp()), post.text());
  });
  (void)player.seek(player.duration());
  while (!player.catch_up(kEventsAtOnce)) {
    if (node::stop_requested()) {
      throw std::runtime_error("stopped; nothing was written");
    }
  }
  if (writer.num_messages() == 0) {
    throw formats::UserError(log.string() + ": contains no message of ours");
  }
  writer.finish();
  file.commit();
  nodmap::log::get().info("{} messages on {} topics", writer.num_messages(), store.topics().size());
}

}  // namespace nodmap::convert
