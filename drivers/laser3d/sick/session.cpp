// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::laser3d {
namespace {

constexpr int kAttempts = 3;
constexpr time::Duration kNakPause = 30ms;

// How long the sensor may take to answer (telegram listing, 3.2 and 7).
constexpr time::Duration kAnswerTimeout = 1s;
constexpr time::Duration kModeChangeTimeout = 3s;
constexpr time::Duration kConfigWriteTimeout = 15s;
// Shorter at a rate at which nothing has been received yet. Longer than the parser's expiry, so
// that a telegram hidden by a truncated one is found.
constexpr time::Duration kSearchTimeout = 600ms;
// Time for both ends to change their rate.
constexpr time::Duration kSettle = 250ms;

// The sensor's memory wears out. If the configuration still differs after this many writes, it
// never will agree: some firmware keeps a value of its own.
constexpr int kMaxConfigWrites = 2;

// A scan with fewer readings than this may equal the last one by chance.
constexpr int kReadingsThatVary = 10;

}  // namespace

SickSession::SickSession(const SickParams& params) : params_(params) {
  // First the rate that we set, then the rate after power-on, then rates that another program may
  // have set.
  for (const int baud : {params.baud, 9600, 500000, 38400, 19200}) {
    if (std::ranges::find(candidates_, baud) == candidates_.end()) {
      candidates_.push_back(baud);
    }
  }
}

SickSession::State SickSession::state() const {
  switch (step_) {
    case Step::kClosed:
      return State::kClosed;
    case Step::kStream:
      return State::kStreaming;
    case Step::kWait:
      return State::kWaiting;
    default:
      return State::kConnecting;
  }
}

SickOutput SickSession::open(time::SteadyTime now) {
  last_error_ = "being started";
  back_off_.succeeded();
  return search_from(0, now);
}

void SickSession::close() {
  step_ = Step::kClosed;
  last_error_ = "not connected";
}

SickOutput SickSession::shut_down(time::SteadyTime now) {
  return state() == State::kStreaming ? enter(Step::kStop, now) : enter(Step::kClosed, now);
}

SickOutput SickSession::poll(time::SteadyTime now) {
  if (step_ == Step::kClosed || now < deadline_) {
    return {};
  }
  switch (step_) {
    case Step::kWait:
      return search_from(0, now);
    case Step::kSettle:
      return enter(Step::kConfirmBaud, now);
    case Step::kStream:
      ++counts_.stream_stops;
      return fail("the stream of scans stopped", now);
    default:
      return retry(now);
  }
}

SickOutput SickSession::take(const SickTelegram& telegram, time::SteadyTime now) {
  if (step_ == Step::kClosed) {
    return {};
  }
  is_answering_ = true;
  if (telegram.reply == SickReply::kPowerOn) {
    ++counts_.power_ons;
    const auto here = std::ranges::find(candidates_, baud_);
    return search_from(static_cast<std::size_t>(here - candidates_.begin()), now);
  }
  if (telegram.reply == SickReply::kMeasuredValues) {
    return take_values(telegram, now);
  }
  switch (classify_answer(step_, telegram)) {
    case SickAnswer::kDone:
      return advance(telegram, now);
    case SickAnswer::kRefused:
      is_refused_ = true;
      deadline_ = std::min(deadline_, now + kNakPause);
      return {};
    case SickAnswer::kOther:
      break;
  }
  return {};
}

void SickSession::take_nak(time::SteadyTime now) {
  if (state() == State::kConnecting && step_ != Step::kSettle) {
    deadline_ = std::min(deadline_, now + kNakPause);
  }
}

time::Duration SickSession::timeout() const {
  switch (step_) {
    case Step::kSearch:
      return is_answering_ ? kModeChangeTimeout : kSearchTimeout;
    case Step::kWriteConfig:
      return kConfigWriteTimeout;
    case Step::kReadConfig:
      return kAnswerTimeout;
    case Step::kSettle:
      return kSettle;
    case Step::kStream:
      return stream_timeout();
    default:
      return kModeChangeTimeout;
  }
}

time::Duration SickSession::stream_timeout() const {
  constexpr time::Duration kShortest = 200ms;
  const SickGeometry geometry = geometry_of(params_.variant);
  // Ten bits per byte. On slow lines the sensor skips scans, so the next one may just have begun.
  const time::FineDuration frame =
      time::FineDuration(10s) * (2.0 * geometry.num_values() + 12.0) / baud_;
  const time::FineDuration period = frame + geometry.revolutions * kMirrorPeriod;
  return std::max(kShortest, std::chrono::duration_cast<time::Duration>(4.0 * period));
}

SickOutput SickSession::enter(Step step, time::SteadyTime now) {
  step_ = step;
  attempts_ = 0;
  is_refused_ = false;
  return ask(now);
}

SickOutput SickSession::ask(time::SteadyTime now) {
  ++attempts_;
  deadline_ = now + timeout();
  return {.baud = std::nullopt, .send = request_of(step_, params_, config_), .scan = std::nullopt};
}

SickOutput SickSession::retry(time::SteadyTime now) {
  if (attempts_ < kAttempts) {
    ++counts_.retries;
    return ask(now);
  }
  switch (step_) {
    case Step::kSearch:
      if (candidate_ + 1 < candidates_.size()) {
        return search_from(candidate_ + 1, now);
      }
      break;
    case Step::kStop:
    case Step::kSlowDown:
      return enter(Step::kClosed, now);
    default:
      break;
  }
  return fail((is_refused_ ? "the sensor refused to " : "the sensor did not ") +
                  std::string(purpose_of(step_)),
              now);
}

SickOutput SickSession::search_from(std::size_t candidate, time::SteadyTime now) {
  candidate_ = candidate;
  baud_ = candidates_[candidate];
  is_answering_ = false;
  SickOutput output = enter(Step::kSearch, now);
  output.baud = baud_;
  return output;
}

SickOutput SickSession::advance(const SickTelegram& telegram, time::SteadyTime now) {
  switch (step_) {
    case Step::kSearch:
      return enter(baud_ == params_.baud ? Step::kReadConfig : Step::kSetBaud, now);
    case Step::kSetBaud: {
      baud_ = params_.baud;
      SickOutput output = enter(Step::kSettle, now);
      output.baud = baud_;
      return output;
    }
    case Step::kConfirmBaud:
      return enter(Step::kReadConfig, now);
    case Step::kReadConfig:
    case Step::kInstall:
    case Step::kWriteConfig:
    case Step::kLeaveInstall:
      return after_config(telegram, now);
    case Step::kSetVariant:
      return enter(Step::kStartStream, now);
    case Step::kStartStream:
      ++counts_.connections;
      return enter(Step::kStream, now);
    case Step::kStop:
      return enter(baud_ == 9600 ? Step::kClosed : Step::kSlowDown, now);
    default:
      return enter(Step::kClosed, now);
  }
}

SickOutput SickSession::after_config(const SickTelegram& telegram, time::SteadyTime now) {
  switch (step_) {
    case Step::kReadConfig:
      config_ = read_config(telegram);
      if (!config_) {
        return fail("the configuration cannot be read", now);
      }
      if (*config_ == wanted_config(*config_, params_)) {
        writes_since_wanted_ = 0;
        return enter(Step::kSetVariant, now);
      }
      if (writes_since_wanted_ >= kMaxConfigWrites) {
        return fail("the sensor does not keep the configuration", now);
      }
      return enter(Step::kInstall, now);
    case Step::kInstall:
      ++counts_.config_writes;
      ++writes_since_wanted_;
      return enter(Step::kWriteConfig, now);
    case Step::kWriteConfig:
      if (read_config(telegram) != wanted_config(*config_, params_)) {
        return fail("the sensor has stored a different configuration than it was sent", now);
      }
      return enter(Step::kLeaveInstall, now);
    default:
      return enter(Step::kSetVariant, now);
  }
}

SickOutput SickSession::take_values(const SickTelegram& telegram, time::SteadyTime now) {
  if (step_ != Step::kStream) {
    ++counts_.unexpected_scans;
    return {};
  }
  std::optional<SickScan> scan =
      read_scan(telegram, params_.interlaced ? kInterlacedMode : params_.reach);
  if (!scan || !is_expected_count(scan->ranges_m.size())) {
    ++counts_.unexpected_scans;
    return {};
  }
  if (watch_for_frozen_scans(telegram, *scan)) {
    ++counts_.freezes;
    return fail("the measurement is frozen", now);
  }
  ++counts_.scans;
  last_error_.clear();
  back_off_.succeeded();
  deadline_ = now + stream_timeout();
  return {.baud = std::nullopt, .send = {}, .scan = std::move(scan)};
}

bool SickSession::is_expected_count(std::size_t count) const {
  const auto expected = static_cast<std::size_t>(geometry_of(params_.variant).num_values());
  return params_.interlaced ? count == 180 || count == 181 : count == expected;
}

bool SickSession::watch_for_frozen_scans(const SickTelegram& telegram, const SickScan& scan) {
  const auto values = ByteView(telegram.data).first(2 + 2 * scan.ranges_m.size());
  // Each interlaced scan is shifted by a quarter of a degree, and the fifth is shifted as the first
  // was: a scan is compared with the last one of the same quarter. Repetitions are counted over all
  // quarters, so that noticing a freeze takes four scans longer, not four times as long.
  Bytes& last = last_values_[static_cast<std::size_t>(scan.quarter.value_or(0))];
  const bool equal = std::ranges::equal(values, last);
  const auto readings =
      std::ranges::count_if(scan.ranges_m, [](float range_m) { return std::isfinite(range_m); });
  equal_scans_ = equal && readings >= kReadingsThatVary ? equal_scans_ + 1 : 0;
  last.assign(values.begin(), values.end());
  return equal_scans_ >= params_.frozen_scans;
}

SickOutput SickSession::fail(std::string reason, time::SteadyTime now) {
  last_error_ = std::move(reason);
  SickOutput output = enter(Step::kWait, now);
  back_off_.failed(now);
  deadline_ = now + back_off_.wait(now);
  return output;
}

}  // namespace nodmap::laser3d
