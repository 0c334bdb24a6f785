// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "procman/config/parser.hpp"
#include "procman/protocol/fleet.hpp"

namespace nodmap::procman::test {

/// A sheriff's fleet: two commands on the deputy "h" and one on "other".
class FleetTest : public ::testing::Test {
 protected:
  Config config_ = parse_config(R"(
      cmd "a" { exec = "x"; host = "h"; }
      cmd "r" { exec = "y"; host = "h"; auto_respawn = "true"; }
      cmd "far" { exec = "z"; host = "other"; })")
                       .config;
  FleetTest() { fleet_.take_command(now_); }

  Fleet fleet_{config_, "me:1:1000"};
  time::SteadyTime now_{100s};

  static CommandStatus status(const std::string& id, int pid, int run, int wait_status = 0) {
    CommandStatus made;
    made.spec.id = id;
    made.pid = pid;
    made.actual_run = run;
    made.wait_status = wait_status;
    return made;
  }
  bool report(std::vector<CommandStatus> commands, const std::string& deputy = "h") {
    DeputyInfo info;
    info.deputy_id = deputy;
    info.commands = std::move(commands);
    return fleet_.take_info(info, now_);
  }
  [[nodiscard]] CommandOrder order(const std::string& id) const {
    const Orders orders = fleet_.orders_for("h", {}).value();
    for (const CommandOrder& found : orders.commands) {
      if (found.spec.id == id) {
        return found;
      }
    }
    return {};
  }
  // Another sheriff gives orders, and repeats them a second later.
  void receive_orders(const std::string& sheriff_id, const std::string& deputy = "h") {
    fleet_.take_orders({{}, deputy, sheriff_id, {}}, now_);
    now_ += 1s;
    fleet_.take_orders({{}, deputy, sheriff_id, {}}, now_);
  }
  [[nodiscard]] std::optional<std::string> other_sheriff() const {
    return fleet_.other_sheriffs().running(now_);
  }
  [[nodiscard]] std::string state(const std::string& id) const {
    return name_of(fleet_.state_of(id, now_));
  }
};

}  // namespace nodmap::procman::test
