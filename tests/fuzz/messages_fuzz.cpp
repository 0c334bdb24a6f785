// SPDX-License-Identifier: BSD-3-Clause
// Valid messages with wild values, handled by navigator, explorer, map server, 2D SLAM and a
// deputy's supervisor. Each message is a plausible one of which bytes are replaced: its kind, the
// number of replacements, and for each of them an offset and eight bytes. Nothing may throw, every
// DRIVE must be finite, and PM_INFO must stay short enough to be received.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "modules/explorer/node.hpp"
#include "modules/map_server/node.hpp"
#include "modules/navigator/node.hpp"
#include "modules/slam2d/node.hpp"
#include "nodmap/clear_request_t.hpp"
#include "procman/deputy/supervisor.hpp"
#include "procman/protocol/messages.hpp"

namespace {

using namespace nodmap;  // NOLINT(google-build-using-namespace): a program of one page
using Bytes = std::vector<std::byte>;

constexpr time::Duration kPeriod = 10ms;
constexpr std::size_t kPatchBytes = 8;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

// Delivers bytes to the handlers of a channel, and checks what the nodes publish.
class CheckingBus final : public bus::Bus {
 public:
  void deliver(const std::string& channel, std::span<const std::byte> bytes) {
    for (const BytesHandler& handler : handlers_[channel]) {
      handler(bytes);
    }
  }

 private:
  bool send(const std::string& channel, std::span<const std::byte> bytes) override {
    nodmap::drive_t drive{};
    if (channel == "DRIVE") {
      require(bus::decode_into(drive, bytes));
      require(std::isfinite(drive.forward_mps) && std::isfinite(drive.yaw_rate_rad_s));
    }
    return true;
  }
  void listen(const std::string& channel, BytesHandler handler, int /*queue_capacity*/) override {
    handlers_[channel].push_back(std::move(handler));
  }

  std::map<std::string, std::vector<BytesHandler>> handlers_;
};

// A deputy that starts every command at once.
class FakeDeputy {
 public:
  explicit FakeDeputy(bus::Bus& bus) {
    bus.subscribe<procman_lcm::orders_t>(procman::kOrdersChannel, [this](const auto& message) {
      now_ += kPeriod;
      carry_out(supervisor_.take_orders(procman::from_message(message), 0s, now_));
      carry_out(supervisor_.poll(now_));
      procman::DeputyInfo info;
      info.commands = supervisor_.statuses();
      require(info.commands.size() <= procman::Supervisor::kMaxCommands);
      require(static_cast<std::size_t>(procman::to_message(info).getEncodedSize()) <=
              bus::LiveBus::kMaxMessageBytes);
    });
  }

 private:
  void carry_out(const procman::SupervisorActions& actions) {
    for (const procman::SupervisorAction& action : actions) {
      if (const auto* start = std::get_if<procman::StartCommand>(&action)) {
        supervisor_.started(start->id, ++pid_, now_);
      }
    }
  }

  procman::Supervisor supervisor_{"robot", false};
  time::SteadyTime now_;
  std::int32_t pid_ = 0;
};

template <class Message>
Bytes encoded(const Message& message) {
  Bytes bytes;
  bus::encode_into(bytes, message);
  return bytes;
}

// Makes plausible messages; each call is one period later than the last.
class Messages {
 public:
  // The channel and the bytes of the next message; `kind` may be any number.
  std::pair<std::string, Bytes> next(unsigned int kind) {
    ++seq_;
    stamp_ += kPeriod;
    switch (kind % 12) {
      case 0:
        return {"SCAN", encoded(scan())};
      case 1:
        return {"PITCH_COMMAND", encoded(nodmap::pitch_command_t{time::to_utime(stamp_), seq_, -0.4,
                                                                 0.1, 0.3, 1.0})};
      case 2:
        return {"PITCH_STATE", encoded(pitch_state())};
      case 3:
        return {"OBSTACLE_MAP", encoded(obstacle_map())};
      case 4:
        return {"BASE_SENSORS",
                encoded(stamped(nodmap::base_sensors_t{}, &nodmap::base_sensors_t::sensors_seq))};
      case 5:
        return {"GOAL", encoded(goal())};
      case 6:
        return {"POSE_2D", encoded(pose())};
      case 7:
        return {"STOP", encoded(stamped(nodmap::stop_t{}, &nodmap::stop_t::stop_seq))};
      case 8:
        return {"CLEAR_REQUEST",
                encoded(nodmap::clear_request_t{time::to_utime(stamp_), "x", {0, 0}, {1, 1}})};
      case 9:
        return {procman::kOrdersChannel, encoded(orders())};
      case 11:
        return {"MAP_2D", encoded(map_tile())};
      default:
        return {"ODOMETRY", encoded(odometry())};
    }
  }

 private:
  template <class Message>
  Message stamped(Message message, std::int64_t Message::*seq) const {
    message.utime = time::to_utime(stamp_);
    message.*seq = seq_;
    return message;
  }

  nodmap::scan_t scan() const {
    scan::Scan scan;
    scan.stamp = stamp_ - kPeriod;
    scan.seq = seq_;
    scan.angle_first_rad = -1.57;
    scan.angle_step_rad = geometry::deg_to_rad(5.0);
    scan.range_max_m = 30.0;
    scan.ranges_m.assign(37, 3.0F);
    return node::write_scan(scan);
  }

  nodmap::pitch_state_t pitch_state() const {
    nodmap::pitch_state_t state{};
    state.sweep_count = stamp_.time_since_epoch() / 350ms;
    return stamped(state, &nodmap::pitch_state_t::state_seq);
  }

  nodmap::odometry_t odometry() const {
    return stamped(node::write_odometry(stamp_, geometry::SE3::Identity()),
                   &nodmap::odometry_t::odometry_seq);
  }

  nodmap::egomap_t obstacle_map() const {
    nodmap::egomap_t map{};
    map.bin_first_rad = -geometry::kPi;
    map.bin_step_rad = geometry::deg_to_rad(10.0);
    map.orientation[0] = 1.0;
    map.num_bins = 36;
    map.distance_m.assign(36, std::numeric_limits<float>::infinity());
    map.point_x_m = map.point_y_m = map.point_z_m = map.age_s =
        std::vector<float>(36, std::numeric_limits<float>::quiet_NaN());
    return stamped(map, &nodmap::egomap_t::scan_seq);
  }

  nodmap::grid_chunk_t map_tile() const {
    constexpr std::int32_t kSide = 40;
    nodmap::grid_chunk_t tile{};
    tile.utime = time::to_utime(stamp_);
    tile.map_revision = seq_;
    tile.num_chunks = 1;
    tile.cell_size_m = 0.05;
    tile.origin_x_m = tile.origin_y_m = -1.0;
    tile.grid_width = tile.grid_height = tile.tile_width = tile.tile_height = kSide;
    tile.num_cells = kSide * kSide;
    tile.cells.assign(static_cast<std::size_t>(tile.num_cells), 0);
    return tile;
  }

  nodmap::goal_t goal() const {
    nodmap::goal_t goal{};
    goal.is_active = 1;
    goal.position_m[0] = 3.0;
    goal.tolerance_m = 0.3;
    return stamped(goal, &nodmap::goal_t::goal_seq);
  }

  nodmap::pose_t pose() const {
    nodmap::pose_t pose{};
    pose.utime = time::to_utime(stamp_);
    pose.orientation[0] = pose.odom_orientation[0] = 1.0;
    return pose;
  }

  procman_lcm::orders_t orders() const {
    procman::Orders orders{stamp_, "robot", "x:1:1", {}};
    for (const char* id : {"a", "b"}) {
      procman::CommandOrder& order = orders.commands.emplace_back();
      order.spec.id = id;
      order.spec.exec = "x";
      order.desired_run = 1;
    }
    return procman::to_message(orders);
  }

  time::Timestamp stamp_{1000s};
  std::int64_t seq_ = 0;
};

// Takes bytes from the front, fewer at the end.
std::span<const std::byte> take(std::span<const std::byte>& from, std::size_t count) {
  const auto taken = from.first(std::min(count, from.size()));
  from = from.subspan(taken.size());
  return taken;
}

// Replaces bytes after the fingerprint.
void replace(Bytes& bytes, std::span<const std::byte> patch) {
  if (patch.size() <= 2) {
    return;
  }
  const std::size_t body = bytes.size() - bus::kFingerprintBytes;
  const auto offset =
      std::to_integer<std::size_t>(patch[0]) << 8U | std::to_integer<std::size_t>(patch[1]);
  const std::size_t at = bus::kFingerprintBytes + offset % body;
  const auto values = patch.subspan(2, std::min(patch.size() - 2, bytes.size() - at));
  std::ranges::copy(values, bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

// Without the local map the robot drives by OBSTACLE_MAP alone, and so after a few messages.
navigator::NavigatorParams navigator_params(bool use_local_map) {
  navigator::NavigatorParams params;
  params.local_map.use = use_local_map;
  return params;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  nodmap::log::get().set_level(spdlog::level::off);
  CheckingBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, {}};
  navigator::NavigatorNode navigator(context, navigator_params(size % 2 != 0));
  explorer::ExplorerNode::Params exploration;
  exploration.start = true;
  const explorer::ExplorerNode explorer(context, exploration);
  map_server::MapServerNode map_server(context, {});
  slam2d::Slam2dNode slam2d(context, slam2d::Slam2dParams{});
  const FakeDeputy deputy(bus);
  Messages messages;
  std::span<const std::byte> rest = std::as_bytes(std::span(data, size));
  while (!rest.empty()) {
    const auto head = std::to_integer<unsigned int>(take(rest, 1)[0]);
    auto [channel, bytes] = messages.next(head & 15U);
    for (unsigned int i = 0; i < head >> 4U && !rest.empty(); ++i) {
      replace(bytes, take(rest, 2 + kPatchBytes));
    }
    bus.deliver(channel, bytes);
  }
  return 0;
}
