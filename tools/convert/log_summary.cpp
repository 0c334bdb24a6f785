// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/log_summary.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <iomanip>
#include <optional>
#include <span>

#include "common/bus/codec.hpp"
#include "tools/convert/log_events.hpp"

namespace nodmap::convert {
namespace {

const bus::MessageType* find_type(std::span<const std::byte> message) {
  const std::int64_t fingerprint = bus::fingerprint_of(message);
  const auto types = bus::message_types();
  const auto found = std::ranges::find_if(
      types, [&](const bus::MessageType& type) { return type.fingerprint == fingerprint; });
  return found == types.end() ? nullptr : &*found;
}

std::string type_name(const bus::MessageType* type, std::span<const std::byte> message) {
  if (type != nullptr) {
    return std::string(type->name);
  }
  char text[32];
  std::snprintf(text, sizeof text, "? %016" PRIx64,
                static_cast<std::uint64_t>(bus::fingerprint_of(message)));
  return text;
}

// The time of measurement, with which most of our messages begin.
time::Timestamp measured(std::span<const std::byte> message) {
  return time::from_utime(bus::fingerprint_of(message.subspan(bus::kFingerprintBytes)));
}

}  // namespace

void LogSummary::add(const bus::LogEvent& event) {
  ChannelSummary& channel = channels[event.channel];
  const bus::MessageType* type = find_type(event.data);
  const time::Timestamp logged = time::from_utime(event.log_utime_us);
  if (channel.count++ == 0) {
    channel.type = type_name(type, event.data);
    channel.first = logged;
    channel.last = logged;
    channel.previous = logged;
    channel.last_measured = time::Timestamp(-time::kLimit);
  }
  channel.size_bytes += static_cast<std::int64_t>(event.data.size());
  channel.longest_gap = std::max(channel.longest_gap, logged - channel.previous);
  channel.previous = logged;
  channel.first = std::min(channel.first, logged);
  channel.last = std::max(channel.last, logged);  // in glued logs the time steps back
  if (type_name(type, event.data) != channel.type) {
    ++channel.corrupt;  // a channel has one type only
    return;
  }
  if (type == nullptr) {
    return;
  }
  if (!bus::fits_layout(type->fields, event.data.subspan(bus::kFingerprintBytes))) {
    ++channel.corrupt;
    return;
  }
  if (!type->begins_with_utime) {
    return;
  }
  channel.steps_back += measured(event.data) < channel.last_measured ? 1 : 0;
  channel.last_measured = measured(event.data);
}

LogSummary summarize_log(const std::filesystem::path& log) {
  LogSummary summary;
  summary.skipped_bytes =
      for_each_event(log, [&summary](const bus::LogEvent& event) { summary.add(event); });
  return summary;
}

void print(std::ostream& out, const LogSummary& summary) {
  constexpr int kNameWidth = 18;
  constexpr int kWidth = 11;
  time::Timestamp first(time::kLimit);
  time::Timestamp last(-time::kLimit);
  out << std::left << std::setw(kNameWidth) << "channel" << std::setw(2 * kWidth) << "type"
      << std::right;
  for (const char* title : {"count", "rate Hz", "gap s", "kB", "corrupt", "steps back"}) {
    out << std::setw(kWidth) << title;
  }
  out << "\n" << std::fixed;
  for (const auto& [name, channel] : summary.channels) {
    out << std::left << std::setw(kNameWidth) << name << std::setw(2 * kWidth) << channel.type
        << std::right << std::setw(kWidth) << channel.count << std::setprecision(2)
        << std::setw(kWidth) << channel.rate_hz() << std::setprecision(3) << std::setw(kWidth)
        << time::seconds(channel.longest_gap) << std::setw(kWidth) << channel.size_bytes / 1000
        << std::setw(kWidth) << channel.corrupt << std::setw(kWidth) << channel.steps_back << "\n";
    first = std::min(first, channel.first);
    last = std::max(last, channel.last);
  }
  const double duration_s = summary.channels.empty() ? 0.0 : time::seconds(last - first);
  out << "duration " << std::setprecision(3) << duration_s << " s, " << summary.skipped_bytes
      << " bytes skipped\n";
}

}  // namespace nodmap::convert
