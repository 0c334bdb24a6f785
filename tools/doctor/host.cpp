// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/host.hpp"

#include <algorithm>

#include "tools/doctor/channel_loads.hpp"

namespace nodmap::doctor {

Finding check_present(const std::string& check, const std::string& what, bool is_present,
                      const std::string& purpose, const std::string& command) {
  if (is_present) {
    return {check, Status::kOk, what + " is there.", ""};
  }
  return {check, Status::kWarn, what + " is missing; " + purpose + ".", command};
}

Finding check_spy_script(const std::optional<std::string>& script) {
  if (!script) {
    return {"lcm-spy", Status::kWarn, "lcm-spy is missing; it shows the messages on the channels.",
            "sudo apt install liblcm-bin"};
  }
  if (script->find("-Xincgc") != std::string::npos) {
    return {
        "lcm-spy", Status::kWarn,
        "The packaged lcm-spy uses the option -Xincgc, which Java does not have since version 9.",
        "./nodmap spy"};
  }
  return {"lcm-spy", Status::kOk, "lcm-spy is installed.", ""};
}

Finding check_disk(const std::string& dir, std::int64_t available_bytes) {
  constexpr std::int64_t kMegabyte = 1'000'000;
  constexpr std::int64_t kTooLittle = 200 * kMegabyte;
  constexpr std::int64_t kLittle = 5000 * kMegabyte;
  const std::int64_t minutes =
      available_bytes / std::max(std::int64_t{1}, steady_bytes_per_s()) / 60;
  const std::string sentence = dir + " has room for " +
                               std::to_string(available_bytes / kMegabyte) + " MB, about " +
                               std::to_string(minutes) + " min of all channels.";
  const std::string command =
      "du -sh " + dir + "/* | sort -h  # and: nodmap-logger --set quota_mb=1000 --set split_mb=100";
  if (available_bytes < kTooLittle) {
    return {"disk", Status::kFail, sentence, command};
  }
  if (available_bytes < kLittle) {
    return {"disk", Status::kWarn, sentence, command};
  }
  return {"disk", Status::kOk, sentence, ""};
}

Finding check_realtime(bool is_permitted) {
  if (is_permitted) {
    return {"realtime", Status::kOk, "Real-time priority is permitted.", ""};
  }
  return {
      "realtime", Status::kWarn,
      "Real-time priority is not permitted: on a busy machine the robot halts for lack of scans.",
      "echo \"$USER - rtprio 50\" | sudo tee /etc/security/limits.d/nodmap.conf  # then log in "
      "again"};
}

Finding check_serial_workers(bool may_raise) {
  if (may_raise) {
    return {
        "serial workers", Status::kOk,
        "The priority of the kernel threads that transfer the bytes of serial ports may be raised.",
        ""};
  }
  return {"serial workers", Status::kWarn,
          "The priority of the kernel threads that transfer the bytes of serial ports may not be "
          "raised: on a busy machine scans are late.",
          "sudo systemctl start nodmap-deputy  # or run nodmap-deputy as root, or with "
          "CAP_SYS_NICE"};
}

Finding check_clock(bool is_synchronized) {
  if (is_synchronized) {
    return {"clock", Status::kOk, "The clock is synchronised.", ""};
  }
  return {"clock", Status::kWarn,
          "The clock is not synchronised, which matters when there is a second host.",
          "sudo apt install systemd-timesyncd; sudo timedatectl set-ntp true"};
}

}  // namespace nodmap::doctor
