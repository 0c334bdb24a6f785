// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as an event log: each byte belongs to an event or is counted as skipped.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/bus/event_log.hpp"
#include "tests/fuzz/memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const nodmap::fuzz::MemoryFile file(data, size);
  nodmap::bus::LogReader reader(file.path());
  std::int64_t event_bytes = 0;
  while (const nodmap::bus::LogEvent* event = reader.next()) {
    event_bytes += nodmap::bus::LogWriter::event_bytes(std::string(event->channel), event->data);
  }
  if (event_bytes + reader.skipped_bytes() != static_cast<std::int64_t>(size)) {
    std::abort();
  }
  return 0;
}
