// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/messages.hpp"

namespace nodmap::procman {
namespace {

CommandSpec spec_of(const procman_lcm::cmd_t& message) {
  return {.id = message.command_id,
          .exec = message.exec_str,
          .group = message.group,
          .auto_respawn = message.auto_respawn != 0,
          .stop_signal = message.stop_signal,
          .stop_time_allowed_s = static_cast<double>(message.stop_time_allowed)};
}

procman_lcm::cmd_t message_of(const CommandSpec& spec) {
  procman_lcm::cmd_t message{};
  message.command_id = spec.id;
  message.exec_str = spec.exec;
  message.group = spec.group;
  message.auto_respawn = static_cast<std::int8_t>(spec.auto_respawn ? 1 : 0);
  message.stop_signal = static_cast<std::int8_t>(spec.stop_signal);
  message.stop_time_allowed = static_cast<float>(spec.stop_time_allowed_s);
  return message;
}

}  // namespace

Discovery from_message(const procman_lcm::discovery_t& message) {
  return {time::from_utime(message.utime), message.transmitter_id, message.nonce};
}

DeputyInfo from_message(const procman_lcm::deputy_info_t& message) {
  DeputyInfo info{.stamp = time::from_utime(message.utime),
                  .deputy_id = message.deputy_id,
                  .cpu_load = message.cpu_load,
                  .memory = {.total_bytes = message.phys_mem_total_bytes,
                             .free_bytes = message.phys_mem_free_bytes,
                             .swap_total_bytes = message.swap_total_bytes,
                             .swap_free_bytes = message.swap_free_bytes},
                  .commands = {}};
  for (const procman_lcm::cmd_status_t& command : message.cmds) {
    info.commands.push_back({spec_of(command.cmd), command.pid, command.actual_runid,
                             command.exit_code, command.cpu_usage, command.mem_vsize_bytes,
                             command.mem_rss_bytes});
  }
  return info;
}

Orders from_message(const procman_lcm::orders_t& message) {
  Orders orders{time::from_utime(message.utime), message.deputy_id, message.sheriff_id, {}};
  for (const procman_lcm::cmd_desired_t& command : message.cmds) {
    orders.commands.push_back(
        {spec_of(command.cmd), command.desired_runid, command.force_quit != 0});
  }
  return orders;
}

Output from_message(const procman_lcm::output_t& message) {
  Output output{time::from_utime(message.utime), message.deputy_id, {}};
  for (std::size_t i = 0; i < message.command_ids.size(); ++i) {
    output.outputs.push_back({message.command_ids[i], message.text[i]});
  }
  return output;
}

procman_lcm::discovery_t to_message(const Discovery& discovery) {
  procman_lcm::discovery_t message{};
  message.utime = time::to_utime(discovery.stamp);
  message.transmitter_id = discovery.transmitter_id;
  message.nonce = discovery.nonce;
  return message;
}

procman_lcm::deputy_info_t to_message(const DeputyInfo& info) {
  procman_lcm::deputy_info_t message{};
  message.utime = time::to_utime(info.stamp);
  message.deputy_id = info.deputy_id;
  message.cpu_load = info.cpu_load;
  message.phys_mem_total_bytes = info.memory.total_bytes;
  message.phys_mem_free_bytes = info.memory.free_bytes;
  message.swap_total_bytes = info.memory.swap_total_bytes;
  message.swap_free_bytes = info.memory.swap_free_bytes;
  for (const CommandStatus& command : info.commands) {
    procman_lcm::cmd_status_t status{};
    status.cmd = message_of(command.spec);
    status.pid = command.pid;
    status.actual_runid = command.actual_run;
    status.exit_code = command.wait_status;
    status.cpu_usage = command.cpu_share;
    status.mem_vsize_bytes = command.vsize_bytes;
    status.mem_rss_bytes = command.rss_bytes;
    message.cmds.push_back(status);
  }
  message.ncmds = static_cast<std::int32_t>(message.cmds.size());
  return message;
}

procman_lcm::orders_t to_message(const Orders& orders) {
  procman_lcm::orders_t message{};
  message.utime = time::to_utime(orders.stamp);
  message.deputy_id = orders.deputy_id;
  message.sheriff_id = orders.sheriff_id;
  for (const CommandOrder& command : orders.commands) {
    procman_lcm::cmd_desired_t desired{};
    desired.cmd = message_of(command.spec);
    desired.desired_runid = command.desired_run;
    desired.force_quit = static_cast<std::int8_t>(command.force_quit ? 1 : 0);
    message.cmds.push_back(desired);
  }
  message.ncmds = static_cast<std::int32_t>(message.cmds.size());
  return message;
}

procman_lcm::output_t to_message(const Output& output) {
  procman_lcm::output_t message{};
  message.utime = time::to_utime(output.stamp);
  message.deputy_id = output.deputy_id;
  for (const CommandOutput& part : output.outputs) {
    message.command_ids.push_back(part.command_id);
    message.text.push_back(part.text);
  }
  message.num_commands = static_cast<std::int16_t>(message.command_ids.size());
  return message;
}

Runs from_message(const nodmap::runs_t& message) {
  Runs runs{time::from_utime(message.utime), message.deputy_id, {}};
  for (std::size_t i = 0; i < message.command_id.size(); ++i) {
    if (message.pid[i] > 0 && message.uptime_us[i] >= 0 && message.num_restarts[i] >= 0) {
      runs.runs.push_back({message.command_id[i], message.pid[i],
                           time::from_us(message.uptime_us[i]), message.num_restarts[i]});
    }
  }
  return runs;
}

nodmap::runs_t to_message(const Runs& runs) {
  nodmap::runs_t message{};
  message.utime = time::to_utime(runs.stamp);
  message.deputy_id = runs.deputy_id;
  for (const CommandRun& run : runs.runs) {
    message.command_id.push_back(run.command_id);
    message.pid.push_back(run.pid);
    message.uptime_us.push_back(time::to_us(run.uptime));
    message.num_restarts.push_back(run.num_restarts);
  }
  message.num_commands = static_cast<std::int32_t>(message.command_id.size());
  return message;
}

}  // namespace nodmap::procman
