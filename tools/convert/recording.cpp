// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/recording.hpp"

#include <system_error>

#include "common/formats/user_error.hpp"

namespace nodmap::convert {

Recording::Recording(const std::filesystem::path& path)
    : file_(path), writer_(file_.partial_path()) {}

void Recording::add_scan(nodmap::scan_t message) {
  message.scan_seq = num_scans_++;
  add("SCAN", message);
}

void Recording::add_odometry(nodmap::odometry_t message) {
  message.odometry_seq = num_odometry_++;
  add("ODOMETRY", message);
}

void Recording::commit(const std::filesystem::path& in, const std::string& hint) {
  if (writer_.num_events() == 0) {
    throw formats::UserError(in.string() + ": contains nothing that can be used: " + hint);
  }
  if (!writer_.flush()) {
    throw std::system_error(writer_.failure(), file_.partial_path().string() + ": cannot write");
  }
  file_.commit();
}

void Recording::write(const std::string& channel, std::int64_t utime_us) {
  log_utime_us_ = std::max(log_utime_us_.value_or(utime_us), utime_us);
  if (!writer_.write(*log_utime_us_, channel, buffer_)) {
    throw std::system_error(writer_.failure(), file_.partial_path().string() + ": cannot write");
  }
}

}  // namespace nodmap::convert
