// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace nodmap::logger {

struct LoggerParams {
  std::string out_dir = "logs";
  std::string channel_regex = ".*";
  std::string exclude_regex;
  double split_mb = 1000.0;
  double quota_mb = 20'000.0;
  double reserve_mb = 1000.0;
  int queue_messages = 10'000;
  int receive_buffer_kb = 4096;

  template <class Visitor>
  void describe(Visitor& v) {
    v.text("out_dir", out_dir, "Folder of the logs, made where it is missing; also --out.");
    v.text("channel_regex", channel_regex,
           "Channels to record: the expression must match the whole name; also --channel.");
    v.text("exclude_regex", exclude_regex,
           "Channels not to record, though channel_regex matches; empty: none; also --exclude.");
    v.number("split_mb", split_mb, {0.0, 1e6},
             "A file that would grow beyond this (10^6 bytes) is ended and the next begun; 0: "
             "never.");
    v.number("quota_mb", quota_mb, {0.0, 1e9},
             "When the logs of this name in the folder, those of earlier runs among them, exceed "
             "this together (10^6 bytes), the oldest are deleted; 0: never. Needs split_mb.");
    v.number(
        "reserve_mb", reserve_mb, {0.0, 1e9},
        "When less than this (10^6 bytes) is free on the disk, the oldest logs of this name are "
        "deleted, and where that does not suffice recording pauses; 0: never.");
    v.integer("queue_messages", queue_messages, {100, 1'000'000},
              "Messages that may wait while the disk is slow; more are dropped.");
    v.integer("receive_buffer_kb", receive_buffer_kb, {0, 1'000'000},
              "Socket buffer (1024 bytes) asked of the system, unless the URL names one; "
              "net.core.rmem_max limits it; 0: leave it to the system.");
  }
};

}  // namespace nodmap::logger
