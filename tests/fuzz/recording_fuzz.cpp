// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a recording of another program; the first byte chooses between CARMEN, a nodding
// scanner and 3DTK. The result is an event log or an error message.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "common/node/log.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/convert/carmen_import.hpp"
#include "tools/convert/nod_import.hpp"
#include "tools/convert/uos_import.hpp"

namespace {

void import(std::uint8_t kind, const std::filesystem::path& dir, const std::filesystem::path& out) {
  if (kind % 3 == 0) {
    nodmap::convert::import_carmen(dir / "scan000.3d", out);
  } else if (kind % 3 == 1) {
    nodmap::convert::import_nod(dir / "scan000.3d", out);
  } else {
    nodmap::convert::import_uos(dir, out, {});
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const nodmap::test::TemporaryDir kDir;
  spdlog::set_level(spdlog::level::off);
  if (size == 0) {
    return 0;
  }
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  // For 3DTK: a scan, followed by its pose.
  const std::size_t middle = std::min(text.size(), text.find('P'));
  std::ofstream(kDir.path() / "scan000.3d") << text.substr(0, middle);
  std::ofstream(kDir.path() / "scan000.pose")
      << text.substr(middle == text.size() ? middle : middle + 1);
  std::ofstream(kDir.path() / "scan001.3d") << text.substr(0, middle);
  std::ofstream(kDir.path() / "scan001.pose") << "0 0 0 0 0 0\n";
  const std::filesystem::path out = kDir.path() / "out.lcmlog";
  try {
    import(data[0], kDir.path(), out);
  } catch (const std::runtime_error&) {
  }
  std::filesystem::remove(out);
  return 0;
}
