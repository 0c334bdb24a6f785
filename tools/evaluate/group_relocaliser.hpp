// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "modules/slam2d/localise/relocaliser.hpp"

namespace nodmap::evaluate {

/// Locates the last of one or more successive scans in a known map, for measurements. Each scan is
/// placed on its own, and each place, moved by odometry, is tried for the others, too. Together the
/// scans distinguish places that look alike to a single scan. A place that one of them contradicts
/// is not believed.
class GroupRelocaliser {
 public:
  GroupRelocaliser(const slam2d::RelocaliserParams& params, const slam2d::MatcherParams& matcher)
      : params_(params), relocaliser_(params, matcher) {}

  [[nodiscard]] slam2d::Relocalisation locate(const slam2d::KnownMap& map,
                                              std::span<const slam2d::LevelScan> scans) const;

 private:
  using Candidate = slam2d::Relocaliser::Candidate;

  /// Where one scan fits.
  struct Alone {
    slam2d::Relocaliser::Candidates fits;
    slam2d::Relocalisation result;
  };
  /// How one scan fits a place.
  struct ScanFit {
    std::optional<Candidate> match;  ///< as the scan matches near there, if it does
    bool agrees = false;             ///< it fits there, and is not sure of another place
    bool is_sure = false;            ///< it alone tells that this is the place
  };
  /// How all scans together fit a place of the last one.
  struct GroupFit {
    Candidate candidate;   ///< as the last scan matches there; the mean scores of all
    bool agrees = true;    ///< each scan fits there, and none is sure of another place
    bool is_sure = false;  ///< one scan alone tells that this is the place
  };
  [[nodiscard]] slam2d::Relocalisation join(const slam2d::KnownMap& map,
                                            std::span<const slam2d::LevelScan> scans,
                                            std::span<const Alone> alone) const;
  [[nodiscard]] ScanFit fit(const slam2d::KnownMap& map, const slam2d::LevelScan& scan,
                            const Alone& alone, const geometry::SE2& T_map_base) const;
  [[nodiscard]] GroupFit fit(const slam2d::KnownMap& map, std::span<const slam2d::LevelScan> scans,
                             std::span<const Alone> alone, const geometry::SE2& T_map_last) const;

  slam2d::RelocaliserParams params_;
  slam2d::Relocaliser relocaliser_;
};

}  // namespace nodmap::evaluate
