// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/message_log.hpp"

#include <utility>

#include "common/formats/atomic_file.hpp"
#include "common/formats/input_file.hpp"

namespace nodmap::bus {

MessageLogWriter::MessageLogWriter(std::filesystem::path file) : file_(std::move(file)) {
  const std::filesystem::path unfinished = formats::unfinished_name(file_);
  std::error_code ignored;
  std::filesystem::remove(unfinished, ignored);  // left behind by a process that was killed
  try {
    writer_.emplace(unfinished);
  } catch (const std::system_error& error) {
    error_ = error.code();
  }
}

MessageLogWriter::~MessageLogWriter() {
  if (writer_) {
    writer_.reset();
    std::error_code ignored;
    std::filesystem::remove(formats::unfinished_name(file_), ignored);
  }
}

void MessageLogWriter::write_bytes(time::Timestamp stamp, const std::string& channel) {
  if (!error_ && !writer_->write(time::to_utime(stamp), channel, bytes_)) {
    error_ = writer_->failure();
  }
}

std::error_code MessageLogWriter::replace() {
  if (!error_ && !(writer_->flush() && writer_->sync())) {
    error_ = writer_->failure();
  }
  if (error_) {
    return error_;
  }
  writer_.reset();
  return formats::replace_file_by(file_, formats::unfinished_name(file_));
}

const LogEvent* MessageLogReader::next() {
  const LogEvent* event = log_.next();
  if (event == nullptr && !log_.damage().empty()) {
    log_.require_event();  // a file of another kind is not damaged
    throw formats::InputFileError(log_.damage());
  }
  return event;
}

void MessageLogReader::require(bool holds, const std::string& problem) const {
  if (!holds) {
    throw formats::InputFileError(file_.string() + ": " + problem);
  }
}

}  // namespace nodmap::bus
