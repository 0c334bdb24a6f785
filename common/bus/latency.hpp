// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace nodmap::bus {

/// Collects durations in histograms of fixed size: those since the last report, and all before. The
/// bins are a sixteenth of an octave wide, so percentiles are accurate to 5 %. Recording takes a
/// few nanoseconds and never allocates.
class LatencyMeter {
 public:
  struct Summary {
    double p50_us = 0.0;
    double p99_us = 0.0;
    double max_us = 0.0;
    std::int64_t count = 0;
  };

  /// Measures the time from its construction to its destruction.
  class Scope : private boost::noncopyable {
   public:
    explicit Scope(LatencyMeter& meter) : meter_(meter), start_(std::chrono::steady_clock::now()) {}
    ~Scope() { meter_.record(std::chrono::steady_clock::now() - start_); }

   private:
    LatencyMeter& meter_;
    std::chrono::steady_clock::time_point start_;
  };

  void record(std::chrono::nanoseconds duration) { recent_.record(duration); }

  /// Of all durations.
  [[nodiscard]] Summary summary() const;

  /// Of the durations since the last call.
  [[nodiscard]] Summary summary_since_last();

 private:
  class Histogram {
   public:
    void record(std::chrono::nanoseconds duration);
    void add(const Histogram& other);
    [[nodiscard]] Summary summary() const;

   private:
    static constexpr std::size_t kBinsPerOctave = 16;
    static constexpr std::size_t kBins = 40 * kBinsPerOctave;  // 1 ns to 2^40 ns, 18 minutes

    [[nodiscard]] double percentile_us(double share) const;

    std::array<std::uint32_t, kBins> bins_{};
    std::int64_t count_ = 0;
    std::int64_t max_ns_ = 0;
  };

  Histogram recent_;  // since the last call of summary_since_last()
  Histogram before_;
};

}  // namespace nodmap::bus
