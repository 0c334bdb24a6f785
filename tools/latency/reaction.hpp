// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/geometry/time.hpp"
#include "common/node/message_counts.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::latency {

/// A measured waiting time, and when it was measured.
struct Sample {
  time::Timestamp at{};
  time::Duration wait{};
};

/// Percentiles of waiting times, by nearest rank.
struct Summary {
  std::size_t n = 0;
  time::Duration min{};
  time::Duration p50{};
  time::Duration p99{};
  time::Duration max{};
};

[[nodiscard]] Summary summarize(std::span<const Sample> samples);

/// One percentile, `&Summary::p99` or another, in microseconds, in each of `parts` equal parts of
/// the time from the first sample to the last. A growing queue appears as increasing values; the
/// minimum shows nothing else, because no other work delays every message of a part. A part without
/// a sample is 0.
[[nodiscard]] std::vector<std::int64_t> us_over_time(std::span<const Sample> samples,
                                                     std::size_t parts,
                                                     time::Duration Summary::*percentile);

/// Measures the time from a scan on the bus to the map that contains it and to the following
/// command, from the times at which an observer received these messages. The same observer receives
/// both, so its own delay cancels out.
///
/// A DRIVE answers the oldest unanswered map that was received before it and whose measurement is
/// not newer than the command.
class Reaction {
 public:
  /// Adds a received message; ignores other channels and types.
  void add(std::string_view channel, std::span<const std::byte> data, time::Timestamp received);

  [[nodiscard]] const std::vector<Sample>& scan_to_map() const { return scan_to_map_; }
  [[nodiscard]] const std::vector<Sample>& scan_to_drive() const { return scan_to_drive_; }

  /// Number of messages missing in the sequence numbers, by channel.
  [[nodiscard]] const std::map<std::string, std::int64_t>& lost() const { return lost_; }
  [[nodiscard]] std::int64_t scans() const { return scans_; }
  [[nodiscard]] std::int64_t corrupt() const { return corrupt_; }

 private:
  struct Map {
    time::Timestamp stamp{};
    time::Timestamp scan_received{};
  };

  void add_scan(std::span<const std::byte> data, time::Timestamp received);
  void add_map(std::span<const std::byte> data, time::Timestamp received);
  void add_drive(std::span<const std::byte> data, time::Timestamp received);
  void add_odometry(std::span<const std::byte> data);
  void count_gap(const std::string& channel, std::int64_t seq);

  nodmap::scan_t scan_{};
  nodmap::egomap_t map_{};
  nodmap::drive_t drive_{};
  nodmap::odometry_t odometry_{};
  // A map refers to the scan by its number. Older scans will not be answered any more.
  std::deque<std::pair<std::int64_t, time::Timestamp>> open_scans_;  // scan_seq, received
  std::deque<Map> open_maps_;
  std::map<std::string, node::SequenceCounter> counters_;
  std::map<std::string, std::int64_t> lost_;
  std::vector<Sample> scan_to_map_;
  std::vector<Sample> scan_to_drive_;
  std::int64_t scans_ = 0;
  std::int64_t corrupt_ = 0;
};

}  // namespace nodmap::latency
