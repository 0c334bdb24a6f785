// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/geometry/time.hpp"
#include "procman/config/parser.hpp"

namespace nodmap::procman {

/// Detects that a configuration file in use was edited.
class ConfigWatch {
 public:
  /// How long deputies wait, and how long those who give them orders: the deputies must know a new
  /// exec line before it is ordered.
  static constexpr time::Duration kDeputySettle = 500ms;
  static constexpr time::Duration kSheriffSettle = 2s;

  /// A change is reported once the file has stayed the same for `settle`, because editors write in
  /// pieces. `deputy`: whose commands count; empty: all.
  ConfigWatch(std::filesystem::path file, time::Duration settle, time::SteadyTime now,
              std::string deputy = {});

  /// The new content with its errors, once after each change; else empty. No commands are an error,
  /// too. Of a file that cannot be read (its owner may still allow it) it reports that error once,
  /// and tries again. Looks at the file at most four times a second.
  [[nodiscard]] std::optional<ParsedConfig> poll(time::SteadyTime now);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  /// What changes when the file is written.
  struct Stamp {
    std::filesystem::file_time_type written;
    std::uintmax_t size = 0;
    bool operator==(const Stamp&) const = default;
  };

  [[nodiscard]] std::optional<Stamp> look() const;
  void need_commands(ParsedConfig& parsed) const;

  std::filesystem::path file_;
  time::Duration settle_;
  std::string deputy_;
  std::optional<Stamp> in_use_;
  std::optional<Stamp> unreadable_;  // could not be read, which was reported
  std::optional<Stamp> seen_;
  time::SteadyTime seen_since_;
  time::SteadyTime look_due_;
};

}  // namespace nodmap::procman
