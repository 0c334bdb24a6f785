// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/event_log.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// A bus on a recording, without network or clock. Delivers the events in file order, as fast as
/// they are handled, and writes published messages to another log, stamped with the log time of the
/// event that caused them.
class ReplayBus : public Bus {
 public:
  /// Throws std::runtime_error if the log cannot be read or the output cannot be created.
  ReplayBus(const std::filesystem::path& log, const std::filesystem::path& out_log);

  /// Handles the next event; false at the end of the log.
  bool step();

  /// Log time of the event being handled; the epoch before the first event.
  [[nodiscard]] time::Timestamp log_time() const { return log_time_; }
  [[nodiscard]] std::int64_t events_read() const { return events_read_; }
  [[nodiscard]] const LogReader& reader() const { return reader_; }
  /// Whether everything published so far has reached the disk.
  [[nodiscard]] bool flush() { return writer_.flush(); }
  /// Why something published has not reached the disk.
  [[nodiscard]] const std::error_code& failure() const { return writer_.failure(); }

 private:
  bool send(const std::string& channel, std::span<const std::byte> bytes) override;
  void listen(const std::string& channel, BytesHandler handler, int queue_capacity) override;

  LogReader reader_;
  LogWriter writer_;
  std::map<std::string, std::vector<BytesHandler>, std::less<>> handlers_;
  time::Timestamp log_time_{};
  std::int64_t events_read_ = 0;
};

}  // namespace nodmap::bus
