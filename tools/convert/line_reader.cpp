// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/line_reader.hpp"

#include <stdexcept>
#include <system_error>

#include "common/node/log.hpp"
#include "common/node/program.hpp"

namespace nodmap::convert {
namespace {

constexpr std::int64_t kSkippedInFull = 20;

std::int64_t size_bytes(const std::filesystem::path& path) {
  std::error_code unknown;  // only the progress bar needs the size
  const auto size = std::filesystem::file_size(path, unknown);
  return unknown ? 0 : static_cast<std::int64_t>(size);
}

}  // namespace

LineReader::LineReader(const std::filesystem::path& path)
    : path_(path), lines_(path), progress_(path.filename().string(), size_bytes(path)) {}

bool LineReader::next() {
  if (node::stop_requested()) {
    throw std::runtime_error("stopped; nothing was written");
  }
  if (!lines_.next()) {
    return false;
  }
  position_bytes_ += static_cast<std::int64_t>(line().size()) + 1;
  progress_.show(position_bytes_);
  return true;
}

void LineReader::skip_line(std::string_view why) {
  if (++num_skipped_ <= kSkippedInFull) {
    log::get().warn("{}: skipped: {}", lines_.place(), why);
  }
  if (num_skipped_ == kSkippedInFull) {
    log::get().warn("{}: further lines are only counted", path_.string());
  }
}

}  // namespace nodmap::convert
