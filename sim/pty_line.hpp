// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/bytes.hpp"

namespace nodmap::sim {

/// A folder for the links to the pseudo-terminals, ours alone while this lives. Removes itself at
/// the end if it made the folder.
class LinkDir {
 public:
  /// Throws std::runtime_error when the folder cannot be made, or another simulator uses it.
  explicit LinkDir(std::filesystem::path path);
  ~LinkDir();
  LinkDir(const LinkDir&) = delete;
  LinkDir& operator=(const LinkDir&) = delete;
  LinkDir(LinkDir&&) = delete;
  LinkDir& operator=(LinkDir&&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Makes NAME point to a terminal. A link to a terminal that is there already was left by a
  /// simulator that was killed; anything else is not touched: throws std::runtime_error.
  void link(const std::string& name, const std::string& terminal) const;
  void unlink(const std::string& name) const;

 private:
  std::filesystem::path path_;
  bool made_ = false;
  int lock_ = -1;
};

/// A serial line as a pseudo-terminal: the drivers open the link, the bytes come and go here.
class PtyLine {
 public:
  PtyLine(const LinkDir& dir, std::string name) : dir_(dir), name_(std::move(name)) {}
  ~PtyLine() { unplug(); }
  PtyLine(const PtyLine&) = delete;
  PtyLine& operator=(const PtyLine&) = delete;
  PtyLine(PtyLine&&) = delete;
  PtyLine& operator=(PtyLine&&) = delete;

  /// A new terminal, and the link to it. Throws std::system_error or std::runtime_error.
  void plug_in();
  /// Whoever has it open is hung up; the link is gone.
  void unplug();
  [[nodiscard]] bool plugged_in() const { return device_ >= 0; }

  /// To be polled for what the host sends; -1 while unplugged.
  [[nodiscard]] int handle() const { return device_; }
  /// The rate that the host has set.
  [[nodiscard]] int host_baud() const;

  [[nodiscard]] Bytes read() const;
  /// What does not fit is lost, as on a line that nobody reads.
  void write(ByteView bytes) const;

 private:
  const LinkDir& dir_;
  std::string name_;
  int device_ = -1;
  // Kept open, so that the drivers can close and open it at will.
  int terminal_ = -1;
  bool linked_ = false;
};

}  // namespace nodmap::sim
