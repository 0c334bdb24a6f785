// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/level_laser_slam.hpp"

#include <limits>

#include "common/node/messages.hpp"
#include "nodmap/odometry_t.hpp"

namespace nodmap::trial {

LevelLaserSlam::LevelLaserSlam(const sim::World& world, const AllParams& params, std::uint64_t seed,
                               const geometry::PoseHistory& T_world_base, bus::LoopNetwork& network,
                               const std::filesystem::path& log)
    : world_(world),
      caster_(world),
      rangefinder_(params.sim.model.laser, seed),
      T_world_base_(T_world_base),
      input_(network),
      network_(log, {}),
      output_(network_),
      slam_("slam2d", network_, [params = params.slam2d](node::Context& context) {
        return std::make_unique<slam2d::Slam2dNode>(context, params);
      }) {
  input_.subscribe<nodmap::odometry_t>("ODOMETRY", [this](const nodmap::odometry_t& message) {
    const time::Timestamp now = time::from_utime(message.utime);
    network_.set_time({now, time::SteadyTime(now.time_since_epoch())});
    output_.publish("ODOMETRY", message);
    network_.deliver();
  });
  input_.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { forward_scan(message); });
}

void LevelLaserSlam::forward_scan(const nodmap::scan_t& message) {
  scan::Scan scan;
  if (!node::read_scan(message, scan)) {
    return;
  }
  const auto T_world_first = T_world_base_.at(scan.stamp);
  const auto T_world_last = T_world_base_.at(scan.last_stamp());
  if (!T_world_first || !T_world_last) {
    return;
  }
  scan.pitch_first_rad = scan.pitch_last_rad = 0.0;
  const std::vector<sim::ActorState> actors = actors_at(scan.mid_stamp());
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const geometry::SE3 T_world_laser =
        geometry::interpolate(*T_world_first, *T_world_last, scan.fraction(beam)) *
        scan.T_base_mount * Eigen::Translation3d(scan.mirror_offset_m);
    const sim::Echo echo =
        rangefinder_.measure(caster_, T_world_laser, scan.angle_rad(beam), actors);
    scan.ranges_m[beam] = echo.kind == sim::Echo::Kind::kRange
                              ? static_cast<float>(echo.range_m)
                              : std::numeric_limits<float>::infinity();
  }
  output_.publish("SCAN", node::write_scan(scan));
  network_.deliver();
}

std::vector<sim::ActorState> LevelLaserSlam::actors_at(time::Timestamp stamp) const {
  const double time_s = time::seconds(stamp - kStart.wall);
  std::vector<sim::ActorState> states;
  for (std::size_t i = 0; i < world_.actors.size(); ++i) {
    const sim::Actor& actor = world_.actors[i];
    if (actor.is_present(time_s)) {
      states.push_back(
          {actor.position(time_s), actor.radius_m, actor.height_m, i, actor.reflectivity});
    }
  }
  return states;
}

void LevelLaserSlam::finish(const std::filesystem::path& dir) {
  slam_.node()->finish();
  std::filesystem::create_directory(dir);
  slam_.node()->write_results(dir);
}

}  // namespace nodmap::trial
