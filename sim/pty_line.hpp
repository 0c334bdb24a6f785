// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {

/// A folder for the links to the pseudo-terminals, locked for this process. Removed at the end if
/// it was created here.
class LinkDir : private boost::noncopyable {
 public:
  /// Throws std::runtime_error if the folder cannot be created or another simulator uses it.
  explicit LinkDir(std::filesystem::path path);
  ~LinkDir();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Links NAME to a terminal. Replaces a link to a terminal, left by a simulator that was killed;
  /// throws std::runtime_error if NAME is anything else.
  void link(const std::string& name, const std::string& terminal) const;
  void unlink(const std::string& name) const;

 private:
  std::filesystem::path path_;
  bool is_made_ = false;
  int lock_ = -1;
};

/// A serial line as a pseudo-terminal: the drivers open the link; this class has the other end.
class PtyLine : private boost::noncopyable {
 public:
  PtyLine(const LinkDir& dir, std::string name) : dir_(dir), name_(std::move(name)) {}
  ~PtyLine() { unplug(); }

  /// Opens a new terminal and links to it. Throws std::system_error or std::runtime_error.
  void plug_in();
  /// Hangs up the terminal and removes the link.
  void unplug();
  [[nodiscard]] bool is_plugged_in() const { return device_ >= 0; }

  /// File descriptor to poll for bytes from the host; -1 while unplugged.
  [[nodiscard]] int handle() const { return device_; }
  /// The rate that the host has set.
  [[nodiscard]] int host_baud() const;

  [[nodiscard]] Bytes read() const;
  /// Sends bytes to the host; those that do not fit are lost, as on a line without a reader.
  void write(ByteView bytes) const;

 private:
  const LinkDir& dir_;
  std::string name_;
  int device_ = -1;
  // Kept open, so that the drivers can close and reopen it.
  int terminal_ = -1;
  bool is_linked_ = false;
};

}  // namespace nodmap::sim
