// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// Writes an event log of messages that belong together, such as a saved map. It replaces an
/// existing file only when it is complete and on the disk.
class MessageLogWriter : private boost::noncopyable {
 public:
  explicit MessageLogWriter(std::filesystem::path file);
  /// Without replace(), the existing file stays and the new one is removed.
  ~MessageLogWriter();

  template <class Message>
  void write(time::Timestamp stamp, const std::string& channel, const Message& message) {
    encode_into(bytes_, message);
    write_bytes(stamp, channel);
  }

  /// Completes the file and replaces the existing one with it. Returns the first write error, if
  /// any; the existing file then stays.
  [[nodiscard]] std::error_code replace();

 private:
  void write_bytes(time::Timestamp stamp, const std::string& channel);

  std::filesystem::path file_;
  std::optional<LogWriter> writer_;
  std::error_code error_;
  std::vector<std::byte> bytes_;
};

/// Reads a file of a MessageLogWriter; no part of it may be missing. Every error is a
/// formats::InputFileError that names the file.
class MessageLogReader : private boost::noncopyable {
 public:
  explicit MessageLogReader(const std::filesystem::path& file) : file_(file), log_(file) {}

  /// The next event, or null at the end. At the end, throws if any part of the file is damaged.
  [[nodiscard]] const LogEvent* next();

  /// Throws if the event is not a valid message.
  template <class Message>
  [[nodiscard]] Message decode(const LogEvent& event) const {
    Message message{};
    require(decode_into(message, event.data),
            "event " + std::to_string(event.event_number) + " is not a valid " + event.channel);
    return message;
  }

  /// Throws with `problem` unless `holds`. For checks of the messages' content.
  void require(bool holds, const std::string& problem) const;

 private:
  std::filesystem::path file_;
  LogReader log_;
};

/// What a `Reader` makes of all events of a file: constructed with a MessageLogReader, it gets each
/// event by add(), then finish(). `path`: the file, or a folder that contains it as `name`.
template <class Reader>
[[nodiscard]] auto read_message_log(const std::filesystem::path& path, const std::string& name) {
  std::error_code unknown;  // opening the file will report it
  MessageLogReader log(std::filesystem::is_directory(path, unknown) ? path / name : path);
  Reader reader(log);
  while (const LogEvent* event = log.next()) {
    reader.add(*event);
  }
  return reader.finish();
}

}  // namespace nodmap::bus
