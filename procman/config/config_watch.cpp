// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/config_watch.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "common/formats/input_file.hpp"

namespace nodmap::procman {
namespace {

constexpr time::Duration kLookPeriod = 250ms;

}  // namespace

ConfigWatch::ConfigWatch(std::filesystem::path file, time::Duration settle, time::SteadyTime now,
                         std::string deputy)
    : file_(std::move(file)),
      settle_(settle),
      deputy_(std::move(deputy)),
      in_use_(look()),
      seen_(in_use_),
      seen_since_(now) {}

std::optional<ConfigWatch::Stamp> ConfigWatch::look() const {
  std::error_code error;
  const auto written = std::filesystem::last_write_time(file_, error);
  if (error) {
    return std::nullopt;
  }
  const std::uintmax_t size = std::filesystem::file_size(file_, error);
  return error ? std::nullopt : std::optional(Stamp{written, size});
}

std::optional<ParsedConfig> ConfigWatch::poll(time::SteadyTime now) {
  if (now < look_due_) {
    return std::nullopt;
  }
  look_due_ = now + kLookPeriod;
  const std::optional<Stamp> stamp = look();
  if (stamp != seen_) {
    seen_ = stamp;
    seen_since_ = now;
  }
  if (!stamp || stamp == in_use_ || now - seen_since_ < settle_) {
    return std::nullopt;
  }
  try {
    ParsedConfig parsed = parse_config(formats::read_input(file_));
    need_commands(parsed);
    in_use_ = stamp;
    return parsed;
  } catch (const formats::InputFileError& error) {
    if (unreadable_ == stamp) {
      return std::nullopt;
    }
    unreadable_ = stamp;
    return ParsedConfig{{}, {{{}, error.what()}}};
  }
}

// An editor leaves an empty file if the disk is full: that must not stop a robot.
void ConfigWatch::need_commands(ParsedConfig& parsed) const {
  const bool has_command = std::ranges::any_of(
      parsed.config.commands,
      [this](const Command& command) { return deputy_.empty() || command.deputy == deputy_; });
  if (parsed.errors.empty() && !has_command) {
    parsed.errors.push_back(
        {{}, "there is no command" + (deputy_.empty() ? "" : " for the deputy " + deputy_)});
  }
}

}  // namespace nodmap::procman
