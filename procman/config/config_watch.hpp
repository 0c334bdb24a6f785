// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "common/geometry/time.hpp"
#include "procman/config/parser.hpp"

namespace nodmap::procman {

/// Notices that a configuration's file was edited while it is in use.
class ConfigWatch {
 public:
  /// A change is told once the file has stayed as it is for `settle`: editors write in pieces.
  ConfigWatch(std::filesystem::path file, time::Duration settle, time::SteadyTime now);

  /// The file as it is now, read anew with its errors, once after each change; nothing otherwise,
  /// and while there is no such file. Looks at the file a few times a second at most.
  [[nodiscard]] std::optional<ParsedConfig> poll(time::SteadyTime now);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  /// What changes when somebody writes the file.
  struct Stamp {
    std::filesystem::file_time_type written;
    std::uintmax_t size = 0;
    bool operator==(const Stamp&) const = default;
  };

  [[nodiscard]] std::optional<Stamp> look() const;

  std::filesystem::path file_;
  time::Duration settle_;
  std::optional<Stamp> in_use_;
  std::optional<Stamp> seen_;
  time::SteadyTime seen_since_;
  time::SteadyTime look_due_;
};

}  // namespace nodmap::procman
