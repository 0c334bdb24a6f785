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

  template <class Visitor>
  void describe(Visitor& v) {
    v.text("out_dir", out_dir, "Folder of the logs, created if it is missing; also --out.");
    v.text("channel_regex", channel_regex,
           "Channels to record: the expression must match the whole name; also --channel.");
    v.text("exclude_regex", exclude_regex,
           "Channels to leave out although channel_regex matches; empty: none; also --exclude.");
    v.number("split_mb", split_mb, {0.0, 1e6},
             "Size limit of a file (10^6 bytes), at which the next file begins; 0: no limit.");
    v.number(
        "quota_mb", quota_mb, {0.0, 1e9},
        "Limit for all logs of this name in the folder together (10^6 bytes), including "
        "those of earlier runs; the oldest are deleted; 0: no limit. At least twice split_mb.");
    v.number("reserve_mb", reserve_mb, {0.0, 1e9},
             "Space to keep free on the disk (10^6 bytes): the oldest logs of this name are "
             "deleted, and if that does not suffice, recording pauses; 0: none.");
    v.integer("queue_messages", queue_messages, {100, 1'000'000},
              "Messages that may wait while the disk is slow; beyond this the oldest is dropped.");
  }
};

}  // namespace nodmap::logger
