// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/uos_export.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <boost/core/noncopyable.hpp>
#include <fstream>
#include <system_error>
#include <utility>

#include "common/bus/codec.hpp"
#include "common/formats/user_error.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "nodmap/keyframe_6d_t.hpp"
#include "tools/convert/log_events.hpp"
#include "tools/convert/new_file.hpp"
#include "tools/convert/uos.hpp"

namespace nodmap::convert {
namespace {

// A result folder that gets its name only when it is complete, as a NewFile does.
class NewFolder : private boost::noncopyable {
 public:
  explicit NewFolder(std::filesystem::path path) : path_(std::move(path)), partial_path_(path_) {
    if (std::filesystem::exists(std::filesystem::symlink_status(path_))) {
      throw formats::UserError(path_.string() + ": exists; results are never overwritten");
    }
    partial_path_ += fmt::format(".{}.part", ::getpid());
    std::error_code error;
    std::filesystem::create_directory(partial_path_, error);
    if (error) {
      throw formats::UserError(path_.string() + ": " + error.message());
    }
  }
  ~NewFolder() {
    std::error_code ignored;  // after commit() there is nothing to remove
    std::filesystem::remove_all(partial_path_, ignored);
  }

  [[nodiscard]] const std::filesystem::path& partial_path() const { return partial_path_; }
  void commit() const { std::filesystem::rename(partial_path_, path_); }

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_path_;
};

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  require_written(out, file);
}

void write_scan(const nodmap::keyframe_6d_t& keyframe, const geometry::SE3& T_map_base,
                const std::filesystem::path& stem) {
  std::string points;
  for (std::size_t i = 0; i < keyframe.x_m.size(); ++i) {
    const Eigen::Vector3d p =
        to_uos(Eigen::Vector3f(keyframe.x_m[i], keyframe.y_m[i], keyframe.z_m[i]).cast<double>());
    points += fmt::format("{:.2f} {:.2f} {:.2f}\n", p.x(), p.y(), p.z());
  }
  const auto [position_cm, euler_deg] = to_uos_pose(T_map_base);
  write_file(stem.string() + ".3d", points);
  write_file(stem.string() + ".pose", fmt::format("{:.4f} {:.4f} {:.4f}\n{:.6f} {:.6f} {:.6f}\n",
                                                  position_cm.x(), position_cm.y(), position_cm.z(),
                                                  euler_deg.x(), euler_deg.y(), euler_deg.z()));
}

}  // namespace

void export_uos(const std::filesystem::path& map, const std::filesystem::path& out) {
  const NewFolder folder(out);
  const std::filesystem::path log =
      std::filesystem::is_directory(map) ? map / "keyframes.lcmlog" : map;
  int num_scans = 0;
  for_each_event(log, [&](const bus::LogEvent& event) {
    nodmap::keyframe_6d_t keyframe{};
    if (event.channel != "KEYFRAME_6D" || !bus::decode_into(keyframe, event.data)) {
      return;
    }
    const auto T_map_base = node::read_pose(keyframe.position_m, keyframe.orientation);
    if (!T_map_base) {
      throw formats::UserError(log.string() + ": an impossible pose");
    }
    write_scan(keyframe, *T_map_base,
               folder.partial_path() / fmt::format("scan{:03}", num_scans++));
  });
  if (num_scans == 0) {
    throw formats::UserError(log.string() + ": contains no keyframe of a 3D map");
  }
  folder.commit();
  log::get().info("{} scans in {}", num_scans, out.string());
}

}  // namespace nodmap::convert
