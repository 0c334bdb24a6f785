// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/latency.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::bus {

void LatencyMeter::Histogram::record(std::chrono::nanoseconds duration) {
  const std::int64_t ns = std::max<std::int64_t>(1, duration.count());
  const double octave = std::log2(static_cast<double>(ns));
  const auto bin = static_cast<std::size_t>(octave * static_cast<double>(kBinsPerOctave));
  ++bins_.at(std::min(bin, kBins - 1));
  ++count_;
  max_ns_ = std::max(max_ns_, ns);
}

void LatencyMeter::Histogram::add(const Histogram& other) {
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    bins_.at(bin) += other.bins_.at(bin);
  }
  count_ += other.count_;
  max_ns_ = std::max(max_ns_, other.max_ns_);
}

LatencyMeter::Summary LatencyMeter::Histogram::summary() const {
  return {percentile_us(0.50), percentile_us(0.99), static_cast<double>(max_ns_) / 1000.0, count_};
}

double LatencyMeter::Histogram::percentile_us(double share) const {
  if (count_ == 0) {
    return 0.0;
  }
  const double wanted = share * static_cast<double>(count_);
  double seen = 0.0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += static_cast<double>(bins_.at(bin));
    if (seen >= wanted) {
      // The middle of the bin, but never more than the maximum.
      const double octave = (static_cast<double>(bin) + 0.5) / static_cast<double>(kBinsPerOctave);
      return std::min(std::exp2(octave), static_cast<double>(max_ns_)) / 1000.0;
    }
  }
  return static_cast<double>(max_ns_) / 1000.0;
}

LatencyMeter::Summary LatencyMeter::summary() const {
  Histogram all = before_;
  all.add(recent_);
  return all.summary();
}

LatencyMeter::Summary LatencyMeter::summary_since_last() {
  const Summary summary = recent_.summary();
  before_.add(recent_);
  recent_ = {};
  return summary;
}

}  // namespace nodmap::bus
