// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/log_events.hpp"

#include <stdexcept>

#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "common/node/progress.hpp"

namespace nodmap::convert {

std::int64_t for_each_event(const std::filesystem::path& log,
                            const std::function<void(const bus::LogEvent&)>& handle) {
  bus::LogReader reader(log);
  reader.require_event();
  node::Progress progress(log.filename().string(), reader.size_bytes());
  while (const bus::LogEvent* event = reader.next()) {
    if (node::stop_requested()) {
      throw std::runtime_error("stopped; nothing was written");
    }
    handle(*event);
    progress.show(reader.position_bytes());
  }
  if (reader.skipped_bytes() > 0) {
    log::get().warn("{}", reader.damage());
  }
  return reader.skipped_bytes();
}

}  // namespace nodmap::convert
