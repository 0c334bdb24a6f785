// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/node/background_job.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/occupancy/occupancy_map.hpp"
#include "modules/slam6d/occupancy/octomap_parts.hpp"
#include "modules/slam6d/params.hpp"

namespace nodmap::slam6d {

/// Keeps the occupancy map of the keyframes. Works on a thread of its own, on one piece of work at
/// a time, and hands the map out in parts: when it has changed, and again from time to time for
/// receivers that have started since. The map is made anew when keyframes have moved or have
/// another cloud, or when points of theirs turn out to have moved. Until then it keeps what dropped
/// keyframes have seen.
class OccupancyMapper {
 public:
  /// Saves the map, together with the keyframes it was made from.
  using Save = std::function<std::error_code(const OccupancyMap&)>;

  explicit OccupancyMapper(const OccupancyParams& params,
                           node::ResultsUsed results_used = node::ResultsUsed::kAtFixedMessage);

  [[nodiscard]] bool is_working() const { return work_.is_running(); }

  /// Starts to insert the keyframes that are not in the map yet, and to hand out the map if that
  /// is due, unless work is under way. Keyframes whose points have moved by less than
  /// `min_motion_m` stay where they are. `prepare_save`: called if it is time to save the map;
  /// returns the function that does so. Empty: the map is not saved.
  void update(std::span<const Keyframe> keyframes, time::Timestamp now, double min_motion_m,
              const std::function<Save()>& prepare_save = {});
  /// Starts to save the map as it is. No work may be under way.
  void save(const Save& save);

  /// As those of BackgroundJob; they return the outcome of saving, if the map was saved.
  [[nodiscard]] std::optional<std::error_code> count_message();
  [[nodiscard]] std::optional<std::error_code> take_early();
  [[nodiscard]] std::optional<std::error_code> take();

  /// The next part of the map that is being handed out.
  [[nodiscard]] std::optional<OctomapParts::Part> next_part();
  /// To be called at the end: hands out the map if it has changed since it was last handed out.
  void publish_last();

  /// May be called only while no work is under way.
  [[nodiscard]] const OccupancyMap& map() const { return map_; }
  void wait() const { work_.wait(); }

 private:
  /// The result of a piece of work.
  struct Result {
    std::optional<std::string> bt_file = std::nullopt;         ///< to be handed out
    std::optional<std::error_code> save_error = std::nullopt;  ///< if it was to be saved
  };
  /// A keyframe as it was inserted into the map, or is about to be.
  struct Mapped {
    std::size_t id;  ///< of the keyframe
    std::shared_ptr<const SweepCloud> cloud;
    geometry::SE3 T_map_base;
    std::vector<bool> is_moved;  ///< of its points
  };

  /// A piece of work: keyframes to be inserted, and what follows.
  struct Work {
    bool begins_anew = false;
    std::vector<Mapped> keyframes{};
    bool is_published = false;
    Save save{};  ///< empty: the map is not saved
  };

  void forget_dropped(std::span<const Keyframe> keyframes);
  [[nodiscard]] bool has_changed(std::span<const Keyframe> keyframes, double min_motion_m) const;
  [[nodiscard]] bool is_save_due(std::size_t num_keyframes) const;
  [[nodiscard]] bool begin_publishing(time::Timestamp now);
  [[nodiscard]] time::Timestamp newest_stamp() const;
  Result execute(const Work& work);
  std::optional<std::error_code> handle(const std::optional<Result>& result);

  OccupancyParams params_;
  OccupancyMap map_;
  std::vector<Mapped> mapped_;
  std::size_t num_saved_ = 0;  // keyframes there were when the map was last saved
  OctomapParts parts_;
  std::optional<time::Timestamp> published_at_;  // when the map was last handed out
  bool has_changed_since_ = false;               // what it contains
  node::BackgroundJob<Result> work_;             // on `map_`; last: it ends before what it works on
};

}  // namespace nodmap::slam6d
