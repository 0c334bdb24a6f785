// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/nod_import.hpp"

#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "tools/convert/line_reader.hpp"
#include "tools/convert/nod.hpp"
#include "tools/convert/recording.hpp"
#include "tools/convert/sick.hpp"

namespace nodmap::convert {
namespace {

class NodImport {
 public:
  NodImport(Recording& recording, LineReader& lines) : recording_(recording), lines_(lines) {}

  void operator()(const NodScan& line) { add(line.scan); }
  void operator()(NodSlice& line) {
    line.scan.stamp = kUntimedStart + recording_.num_scans() * kSickFinePeriod;
    add(line.scan);
  }
  void operator()(const NodUnreadable& line) { lines_.skip_line(line.why); }
  void operator()(const NodOther&) {}

 private:
  void add(const scan::Scan& scan) {
    recording_.add_odometry(node::write_odometry(scan.stamp, geometry::SE3::Identity()));
    recording_.add_scan(node::write_scan(scan));
  }

  Recording& recording_;
  LineReader& lines_;
};

}  // namespace

void import_nod(const std::filesystem::path& in, const std::filesystem::path& out) {
  Recording recording(out);
  LineReader lines(in);
  NodImport import(recording, lines);
  while (lines.next()) {
    NodLine line = parse_nod_line(lines.line());
    std::visit(import, line);
  }
  recording.commit(in, "no line NOD or SLICE");
  log::get().info("{} scans, {} lines skipped", recording.num_scans(), lines.num_skipped());
}

}  // namespace nodmap::convert
