// SPDX-License-Identifier: BSD-3-Clause
#include "tools/latency/reaction.hpp"

#include <algorithm>

#include "common/bus/codec.hpp"
#include "common/statistics/quantile.hpp"

namespace nodmap::latency {
namespace {

constexpr std::size_t kMaxOpen = 256;  // 3.4 s of scans; later answers do not count

template <class Entry>
void push_bounded(std::deque<Entry>& queue, const Entry& entry) {
  queue.push_back(entry);
  if (queue.size() > kMaxOpen) {
    queue.pop_front();
  }
}

}  // namespace

Summary summarize(std::span<const Sample> samples) {
  if (samples.empty()) {
    return {};
  }
  std::vector<time::Duration> waits;
  waits.reserve(samples.size());
  for (const Sample& sample : samples) {
    waits.push_back(sample.wait);
  }
  const auto [min, max] = std::ranges::minmax(waits);
  return {waits.size(), min, statistics::quantile(waits, 0.50), statistics::quantile(waits, 0.99),
          max};
}

std::vector<std::int64_t> us_over_time(std::span<const Sample> samples, std::size_t parts,
                                       time::Duration Summary::*percentile) {
  std::vector<std::int64_t> values(parts, 0);
  std::vector<std::vector<Sample>> split(parts);
  if (samples.empty() || parts == 0) {
    return values;
  }
  const time::Timestamp first = samples.front().at;
  const time::Duration span = std::max<time::Duration>(samples.back().at - first, 1us);
  for (const Sample& sample : samples) {
    const double share = time::FineDuration(sample.at - first) / time::FineDuration(span);
    const double part =
        std::clamp(share * static_cast<double>(parts), 0.0, static_cast<double>(parts) - 1.0);
    split[static_cast<std::size_t>(part)].push_back(sample);
  }
  std::ranges::transform(split, values.begin(), [percentile](const auto& part) {
    return time::to_us(summarize(part).*percentile);
  });
  return values;
}

void Reaction::add(std::string_view channel, std::span<const std::byte> data,
                   time::Timestamp received) {
  if (channel == "SCAN") {
    add_scan(data, received);
  } else if (channel == "OBSTACLE_MAP") {
    add_map(data, received);
  } else if (channel == "DRIVE") {
    add_drive(data, received);
  } else if (channel == "ODOMETRY") {
    add_odometry(data);
  }
}

void Reaction::add_scan(std::span<const std::byte> data, time::Timestamp received) {
  if (!bus::decode_into(scan_, data)) {
    ++corrupt_;
    return;
  }
  ++scans_;
  count_gap("SCAN", scan_.scan_seq);
  push_bounded(open_scans_, {scan_.scan_seq, received});
}

void Reaction::add_map(std::span<const std::byte> data, time::Timestamp received) {
  if (!bus::decode_into(map_, data)) {
    ++corrupt_;
    return;
  }
  const auto scan = std::ranges::find(open_scans_, map_.scan_seq,
                                      &std::pair<std::int64_t, time::Timestamp>::first);
  if (scan == open_scans_.end()) {
    return;  // its scan was sent before we listened
  }
  const time::Timestamp scan_received = scan->second;
  // Earlier scans that were skipped will not be answered either.
  open_scans_.erase(open_scans_.begin(), std::next(scan));
  scan_to_map_.push_back({received, received - scan_received});
  push_bounded(open_maps_, {time::from_utime(map_.utime), scan_received});
}

void Reaction::add_drive(std::span<const std::byte> data, time::Timestamp received) {
  if (!bus::decode_into(drive_, data)) {
    ++corrupt_;
    return;
  }
  count_gap("DRIVE", drive_.drive_seq);
  while (!open_maps_.empty() && open_maps_.front().stamp <= time::from_utime(drive_.utime)) {
    scan_to_drive_.push_back({received, received - open_maps_.front().scan_received});
    open_maps_.pop_front();
  }
}

void Reaction::add_odometry(std::span<const std::byte> data) {
  if (!bus::decode_into(odometry_, data)) {
    ++corrupt_;
    return;
  }
  count_gap("ODOMETRY", odometry_.odometry_seq);
}

void Reaction::count_gap(const std::string& channel, std::int64_t seq) {
  const std::int64_t gap = counters_[channel].lost_before(seq);
  if (gap > 0) {
    lost_[channel] += gap;
  }
}

}  // namespace nodmap::latency
