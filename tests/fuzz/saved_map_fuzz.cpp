// SPDX-License-Identifier: BSD-3-Clause
// Saved maps with wild values, and any bytes as a map of ROS. Each is refused with an error, or 2D
// or 6D SLAM begins in it, receives a scan and saves it again. The first byte chooses the map. Of a
// saved map, bytes are replaced: for each replacement two bytes of an offset and eight new bytes.
// A map of ROS is its map.yaml, a NUL, and its image.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/geometry/angle.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "modules/slam2d/back_end/saved_map_file.hpp"
#include "modules/slam2d/localiser_node.hpp"
#include "modules/slam2d/node.hpp"
#include "modules/slam6d/back_end/saved_map_file.hpp"
#include "modules/slam6d/node.hpp"
#include "tests/support/data_dir.hpp"

namespace {

using namespace nodmap;  // NOLINT(google-build-using-namespace): a program of one page
namespace fs = std::filesystem;

constexpr std::size_t kPatchBytes = 8;
constexpr double kHalfRoomM = 2.0;

// Delivers messages to one node, and forgets what it publishes.
class SilentBus final : public bus::Bus {
 public:
  template <class Message>
  void deliver(const std::string& channel, const Message& message) {
    std::vector<std::byte> bytes;
    bus::encode_into(bytes, message);
    handlers_.at(channel)(bytes);
  }

 private:
  bool send(const std::string& /*channel*/, std::span<const std::byte> /*bytes*/) override {
    return true;
  }
  void listen(const std::string& channel, BytesHandler handler, int /*queue_capacity*/) override {
    handlers_[channel] = std::move(handler);
  }

  std::map<std::string, BytesHandler> handlers_;
};

// Points 10 cm apart on the walls of a square room, and the walls' normals.
struct Room {
  std::vector<Eigen::Vector2f> points;
  std::vector<Eigen::Vector2f> normals;

  Room() {
    for (const double yaw : {0.0, 0.5, 1.0, 1.5}) {
      const Eigen::Rotation2Dd side(yaw * geometry::kPi);
      for (double y = -kHalfRoomM; y <= kHalfRoomM; y += 0.1) {
        points.emplace_back((side * Eigen::Vector2d(kHalfRoomM, y)).cast<float>());
        normals.emplace_back((side * Eigen::Vector2d(-1.0, 0.0)).cast<float>());
      }
    }
  }
};

slam2d::SavedMap map_2d() {
  const Room room;
  slam2d::SavedMap map;
  for (int k = 0; k < 3; ++k) {
    slam2d::Keyframe keyframe{.stamp = time::Timestamp(1s * k)};
    keyframe.points_base = slam2d::SharedPoints(room.points);
    keyframe.normals_base = slam2d::SharedPoints(room.normals);
    map.keyframes.push_back(std::move(keyframe));
  }
  for (std::size_t k = 1; k < 3; ++k) {
    map.steps.push_back({.from = k - 1,
                         .to = k,
                         .T_from_to = {},
                         .information = 400.0 * Eigen::Matrix3d::Identity()});
  }
  map.submaps = {{0, 2}, {1, 3}};
  map.loops = {
      {{.from = 0, .to = 1, .T_from_to = {}, .information = Eigen::Matrix3d::Identity()}, 0.9}};
  map.cleared = {{{{-1.0, -1.0}, {0.0, 0.0}}, 1}};
  return map;
}

slam6d::SavedMap map_6d() {
  const Room room;
  slam6d::SavedMap map;
  for (int k = 0; k < 2; ++k) {
    auto cloud = std::make_shared<slam6d::SweepCloud>();
    cloud->stamp = time::Timestamp(1s * k);
    for (const float z : {0.0F, 0.2F, 0.4F}) {
      for (const Eigen::Vector2f& p : room.points) {
        cloud->points.emplace_back(p.x(), p.y(), z);
      }
      cloud->lines.push_back({Eigen::Vector3f(0.1F, 0.0F, 0.4F), cloud->points.size()});
    }
    map.keyframes.push_back({.cloud = std::move(cloud)});
  }
  const slam6d::Matrix6d information = 400.0 * slam6d::Matrix6d::Identity();
  map.steps = {{.from = 0, .to = 1, .information = information}};
  map.loops = {{.from = 1, .to = 0, .information = information, .may_be_wrong = true}};
  return map;
}

std::string contents_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class Map>
std::string saved(const Map& map) {
  const test::TemporaryDir dir;
  if (write_saved_map(dir.path(), map)) {
    std::abort();
  }
  return contents_of(dir.path() / "keyframes.lcmlog");
}

std::string patched(std::string bytes, std::string_view patches) {
  while (patches.size() > 2) {
    const std::string_view patch = patches.substr(0, 2 + kPatchBytes);
    patches.remove_prefix(patch.size());
    const auto offset = static_cast<std::size_t>(static_cast<unsigned char>(patch[0])) << 8U |
                        static_cast<std::size_t>(static_cast<unsigned char>(patch[1]));
    bytes.replace(offset % bytes.size(), patch.size() - 2, patch.substr(2));
  }
  return bytes;
}

// What a level laser sees in the middle of the room.
scan::Scan scan_of_room(time::Timestamp stamp, std::int64_t seq) {
  scan::Scan scan;
  scan.stamp = stamp;
  scan.seq = seq;
  scan.angle_first_rad = -0.5 * geometry::kPi;
  scan.angle_step_rad = geometry::deg_to_rad(1.0);
  scan.range_max_m = 30.0;
  for (int i = 0; i <= 180; ++i) {
    const double angle = scan.angle_first_rad + i * scan.angle_step_rad;
    const double range_m =
        kHalfRoomM / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    scan.ranges_m.push_back(static_cast<float>(range_m));
  }
  return scan;
}

// Begins in the map, receives a few scans and saves.
template <class Node, class Params>
void run(const Params& params, const node::MapOptions& options, const fs::path& out) {
  SilentBus bus;
  node::MessageCounts counts;
  node::Context context{bus, counts, {}};
  Node node(context, params, options);
  for (std::int64_t seq = 0; seq < 5; ++seq) {
    const time::Timestamp stamp(1000s + 50ms * seq);
    auto odometry = node::write_odometry(stamp, geometry::SE3::Identity());
    odometry.odometry_seq = seq;
    bus.deliver("ODOMETRY", odometry);
    bus.deliver("SCAN", node::write_scan(scan_of_room(stamp - 20ms, seq)));
  }
  node.finish();
  node.write_results(out);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::TemporaryDir kDir;
  static const std::array<std::string, 2> kSaved = {saved(map_2d()), saved(map_6d())};
  nodmap::log::get().set_level(spdlog::level::off);
  if (size == 0) {
    return 0;
  }
  const unsigned int kind = data[0] % 3U;
  const std::string_view rest(reinterpret_cast<const char*>(data + 1), size - 1);
  const fs::path out = kDir.path() / "out";
  fs::create_directories(out);
  try {
    if (kind < 2) {
      const fs::path file = kDir.path() / "keyframes.lcmlog";
      std::ofstream(file, std::ios::binary) << patched(kSaved.at(kind), rest);
      const node::MapOptions options{.localise_in = {}, .map_in = file, .T_map_start = {}};
      if (kind == 0) {
        run<slam2d::Slam2dNode>(slam2d::Slam2dParams{}, options, out);
      } else {
        run<slam6d::Slam6dNode>(slam6d::Slam6dParams{}, options, out);
      }
    } else {
      const std::size_t middle = std::min(rest.size(), rest.find('\0'));
      std::ofstream(kDir.path() / "map.yaml") << rest.substr(0, middle);
      std::ofstream(kDir.path() / "map.pgm") << rest.substr(std::min(rest.size(), middle + 1));
      run<slam2d::LocaliserNode>(
          slam2d::Slam2dParams{},
          {.localise_in = kDir.path() / "map.yaml", .map_in = {}, .T_map_start = {}}, out);
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
