// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::laser3d {
namespace {

constexpr int kAttempts = 3;
constexpr std::int64_t kNakPauseUs = 30'000;

// How long the sensor may take to answer (telegram listing, 3.2 and 7).
constexpr std::int64_t kAnswerUs = 1'000'000;
constexpr std::int64_t kModeChangeUs = 3'000'000;
constexpr std::int64_t kConfigWriteUs = 15'000'000;
// At a rate at which nothing has been heard yet it is not worth waiting that long. More than the
// parser's expiry: what a cut telegram hides has come out by then.
constexpr std::int64_t kSearchUs = 600'000;
// Both ends need a moment to change their rate.
constexpr std::int64_t kSettleUs = 250'000;

// The sensor's memory wears. A configuration that is not as wanted after so many writes never will
// be: some firmware keeps a value of its own.
constexpr int kMostConfigWrites = 2;

// A scan with fewer readings than this may well equal the last one.
constexpr int kReadingsThatVary = 10;

}  // namespace

SickSession::SickSession(const SickParams& params) : params_(params) {
  // Where it was left, then where power-on puts it, then where another program may have left it.
  for (const int baud : {params.baud, 9600, 500000, 38400, 19200}) {
    if (std::find(candidates_.begin(), candidates_.end(), baud) == candidates_.end()) {
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

SickOutput SickSession::open(std::int64_t now_us) {
  last_error_ = "being started";
  back_off_.succeeded();
  return search_from(0, now_us);
}

void SickSession::close() {
  step_ = Step::kClosed;
  last_error_ = "not connected";
}

SickOutput SickSession::shut_down(std::int64_t now_us) {
  return state() == State::kStreaming ? enter(Step::kStop, now_us) : enter(Step::kClosed, now_us);
}

SickOutput SickSession::poll(std::int64_t now_us) {
  if (step_ == Step::kClosed || now_us < deadline_us_) {
    return {};
  }
  switch (step_) {
    case Step::kWait:
      return search_from(0, now_us);
    case Step::kSettle:
      return enter(Step::kConfirmBaud, now_us);
    case Step::kStream:
      ++counts_.stream_stops;
      return fail("the stream of scans stopped", now_us);
    default:
      return retry(now_us);
  }
}

SickOutput SickSession::take(const SickTelegram& telegram, std::int64_t now_us) {
  if (step_ == Step::kClosed) {
    return {};
  }
  heard_ = true;
  if (telegram.reply == SickReply::kPowerOn) {
    ++counts_.power_ons;
    const auto here = std::find(candidates_.begin(), candidates_.end(), baud_);
    return search_from(static_cast<std::size_t>(here - candidates_.begin()), now_us);
  }
  if (telegram.reply == SickReply::kMeasuredValues) {
    return take_values(telegram, now_us);
  }
  switch (classify_answer(step_, telegram)) {
    case SickAnswer::kDone:
      return advance(telegram, now_us);
    case SickAnswer::kRefused:
      refused_ = true;
      deadline_us_ = std::min(deadline_us_, now_us + kNakPauseUs);
      return {};
    case SickAnswer::kOther:
      break;
  }
  return {};
}

void SickSession::take_nak(std::int64_t now_us) {
  if (state() == State::kConnecting && step_ != Step::kSettle) {
    deadline_us_ = std::min(deadline_us_, now_us + kNakPauseUs);
  }
}

std::int64_t SickSession::timeout_us() const {
  switch (step_) {
    case Step::kSearch:
      return heard_ ? kModeChangeUs : kSearchUs;
    case Step::kWriteConfig:
      return kConfigWriteUs;
    case Step::kReadConfig:
      return kAnswerUs;
    case Step::kSettle:
      return kSettleUs;
    case Step::kStream:
      return stream_timeout_us();
    default:
      return kModeChangeUs;
  }
}

std::int64_t SickSession::stream_timeout_us() const {
  constexpr std::int64_t kShortestUs = 200'000;
  const SickGeometry geometry = geometry_of(params_.variant);
  // Ten bits for each byte; slow lines skip scans, so the next one may just have begun.
  const double frame_us = 1e7 * (2.0 * geometry.num_values() + 12.0) / baud_;
  const double period_us = frame_us + geometry.revolutions * kMirrorPeriodUs;
  return std::max(kShortestUs, static_cast<std::int64_t>(4.0 * period_us));
}

SickOutput SickSession::enter(Step step, std::int64_t now_us) {
  step_ = step;
  attempts_ = 0;
  refused_ = false;
  return ask(now_us);
}

SickOutput SickSession::ask(std::int64_t now_us) {
  ++attempts_;
  deadline_us_ = now_us + timeout_us();
  return {.baud = std::nullopt, .send = request_of(step_, params_, config_), .scan = std::nullopt};
}

SickOutput SickSession::retry(std::int64_t now_us) {
  if (attempts_ < kAttempts) {
    ++counts_.retries;
    return ask(now_us);
  }
  switch (step_) {
    case Step::kSearch:
      if (candidate_ + 1 < candidates_.size()) {
        return search_from(candidate_ + 1, now_us);
      }
      break;
    case Step::kStop:
    case Step::kSlowDown:
      return enter(Step::kClosed, now_us);
    default:
      break;
  }
  return fail((refused_ ? "the sensor refused to " : "the sensor did not ") +
                  std::string(purpose_of(step_)),
              now_us);
}

SickOutput SickSession::search_from(std::size_t candidate, std::int64_t now_us) {
  candidate_ = candidate;
  baud_ = candidates_[candidate];
  heard_ = false;
  SickOutput output = enter(Step::kSearch, now_us);
  output.baud = baud_;
  return output;
}

SickOutput SickSession::advance(const SickTelegram& telegram, std::int64_t now_us) {
  switch (step_) {
    case Step::kSearch:
      return enter(baud_ == params_.baud ? Step::kReadConfig : Step::kSetBaud, now_us);
    case Step::kSetBaud: {
      baud_ = params_.baud;
      SickOutput output = enter(Step::kSettle, now_us);
      output.baud = baud_;
      return output;
    }
    case Step::kConfirmBaud:
      return enter(Step::kReadConfig, now_us);
    case Step::kReadConfig:
    case Step::kInstall:
    case Step::kWriteConfig:
    case Step::kLeaveInstall:
      return after_config(telegram, now_us);
    case Step::kSetVariant:
      return enter(Step::kStartStream, now_us);
    case Step::kStartStream:
      ++counts_.connections;
      return enter(Step::kStream, now_us);
    case Step::kStop:
      return enter(baud_ == 9600 ? Step::kClosed : Step::kSlowDown, now_us);
    default:
      return enter(Step::kClosed, now_us);
  }
}

SickOutput SickSession::after_config(const SickTelegram& telegram, std::int64_t now_us) {
  switch (step_) {
    case Step::kReadConfig:
      config_ = read_config(telegram);
      if (!config_) {
        return fail("the configuration cannot be read", now_us);
      }
      if (*config_ == wanted_config(*config_, params_)) {
        writes_since_wanted_ = 0;
        return enter(Step::kSetVariant, now_us);
      }
      if (writes_since_wanted_ >= kMostConfigWrites) {
        return fail("the configuration does not stay as written", now_us);
      }
      return enter(Step::kInstall, now_us);
    case Step::kInstall:
      ++counts_.config_writes;
      ++writes_since_wanted_;
      return enter(Step::kWriteConfig, now_us);
    case Step::kWriteConfig:
      if (read_config(telegram) != wanted_config(*config_, params_)) {
        return fail("the configuration was not taken as sent", now_us);
      }
      return enter(Step::kLeaveInstall, now_us);
    default:
      return enter(Step::kSetVariant, now_us);
  }
}

SickOutput SickSession::take_values(const SickTelegram& telegram, std::int64_t now_us) {
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
  if (is_frozen(telegram, *scan)) {
    ++counts_.freezes;
    return fail("the measurement is frozen", now_us);
  }
  ++counts_.scans;
  last_error_.clear();
  back_off_.succeeded();
  deadline_us_ = now_us + stream_timeout_us();
  return {.baud = std::nullopt, .send = {}, .scan = std::move(scan)};
}

bool SickSession::is_expected_count(std::size_t count) const {
  const auto expected = static_cast<std::size_t>(geometry_of(params_.variant).num_values());
  return params_.interlaced ? count == 180 || count == 181 : count == expected;
}

bool SickSession::is_frozen(const SickTelegram& telegram, const SickScan& scan) {
  const auto values = ByteView(telegram.data).first(2 + 2 * scan.ranges_m.size());
  // Each interlaced scan is shifted by a quarter of a degree, and the fifth is shifted as the first
  // was: a scan is compared with the last one of the same quarter. Repetitions are counted over all
  // quarters, so that noticing a freeze takes four scans longer, not four times as long.
  Bytes& last = last_values_[static_cast<std::size_t>(scan.quarter.value_or(0))];
  const bool equal = std::equal(values.begin(), values.end(), last.begin(), last.end());
  const auto readings = std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(),
                                      [](float range_m) { return std::isfinite(range_m); });
  equal_scans_ = equal && readings >= kReadingsThatVary ? equal_scans_ + 1 : 0;
  last.assign(values.begin(), values.end());
  return equal_scans_ >= params_.frozen_scans;
}

SickOutput SickSession::fail(std::string reason, std::int64_t now_us) {
  last_error_ = std::move(reason);
  SickOutput output = enter(Step::kWait, now_us);
  back_off_.failed(now_us);
  deadline_us_ = now_us + back_off_.wait_us(now_us);
  return output;
}

}  // namespace nodmap::laser3d
