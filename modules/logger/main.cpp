// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <string>
#include <utility>

#include "common/formats/folder.hpp"
#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "common/params/params.hpp"
#include "modules/logger/logger.hpp"
#include "modules/logger/params.hpp"

namespace nodmap::logger {
namespace {

struct Options {
  std::string out;
  std::string file;
  std::string channel;
  std::string exclude;
};

std::int64_t to_bytes(double megabytes) {
  return std::llround(megabytes * 1e6);
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("--out", options.out, "Folder of the logs; created if it is missing");
  app.add_option(
      "--file", options.file,
      "Name of the log (then NAME.01, ...); default: lcmlog-YYYY-MM-DD.NN with the UTC date");
  app.add_option("--channel", options.channel, "Record only channels that match this expression");
  app.add_option("--exclude", options.exclude, "Do not record channels that match this expression");
}

// Options that set a parameter are applied after --set.
void assign_options(const Options& options, params::Table& table) {
  const auto assign = [&table](const char* option, const char* name, const std::string& value) {
    if (!value.empty()) {
      table.set(name, value, option);
    }
  };
  assign("--out", "out_dir", options.out);
  assign("--channel", "channel_regex", options.channel);
  assign("--exclude", "exclude_regex", options.exclude);
}

// Throws node::UsageError if the parameters and --file contradict each other.
RecorderSettings recorder_settings(const LoggerParams& params, const std::string& file) {
  LogFolderSettings folder{.dir = params.out_dir,
                           .quota_bytes = to_bytes(params.quota_mb),
                           .reserve_bytes = to_bytes(params.reserve_mb)};
  const std::int64_t split_bytes = to_bytes(params.split_mb);
  if (folder.quota_bytes > 0 && split_bytes == 0) {
    throw node::UsageError("quota_mb needs split_mb: only completed files can be deleted");
  }
  if (folder.quota_bytes > 0 && folder.quota_bytes < 2 * split_bytes) {
    throw node::UsageError(
        "quota_mb must be at least twice split_mb: whole files are deleted, and with a smaller "
        "quota each new file would delete all that was recorded before it");
  }
  if (file == "." || file == "..") {
    throw node::UsageError("--file '" + file + "' must be the name of a file");
  }
  if (std::filesystem::path(file).has_parent_path()) {
    throw node::UsageError("--file '" + file +
                           "' must be a name without folder; --out gives the folder");
  }
  if (!file.empty()) {
    folder.names = LogNames::fixed(file);
  }
  return {std::move(folder), split_bytes};
}

// With --file the first log must have exactly this name; fails if it already exists.
void refuse_to_mix(const LogFolderSettings& folder, const std::string& file) {
  if (file.empty() || !std::filesystem::is_directory(folder.dir)) {
    return;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder.dir)) {
    if (folder.names.order_of(entry.path().filename().string())) {
      throw node::UsageError(entry.path().string() +
                             " exists, and logs are never overwritten; name another --file");
    }
  }
}

// Returns the exit code: 0 no message was dropped for lack of disk space or with its file, 1 some
// were.
int record_until_stopped(const Options& options, const LoggerParams& params,
                         const std::string& lcm_url) {
  ChannelFilter filter(params.channel_regex, params.exclude_regex);
  const RecorderSettings settings = recorder_settings(params, options.file);
  formats::make_folder(settings.folder.dir);
  refuse_to_mix(settings.folder, options.file);
  Logger logger(lcm_url, params.queue_messages, std::move(filter), settings);
  logger.run();
  const RecorderCounts& counts = logger.counts();
  log::get().info(
      "{} events in {} files; {} dropped for lack of disk space or with a deleted file, {} lost "
      "before they were received; {} old logs deleted",
      counts.written, counts.files, counts.dropped, logger.lost(), logger.num_deleted_files());
  return counts.dropped == 0 ? 0 : 1;
}

int run(int argc, char** argv) {
  Options options;
  LoggerParams params;
  params::Table table(params);
  return node::run_program(
      argc, argv,
      {.name = kProgram,
       .summary = "Records every LCM channel into event logs that lcm-logplayer plays.",
       .params = &table,
       .uses_lcm = true,
       .outlives_its_readers = true,
       .add_options = [&options](CLI::App& app) { add_options(app, options); },
       .check = [&] { assign_options(options, table); },
       .run =
           [&](const std::string& lcm_url) {
             // Exceeding a file size limit is treated like a full disk and must not end the
             // process.
             std::signal(SIGXFSZ, SIG_IGN);
             return record_until_stopped(options, params, lcm_url);
           }});
}

}  // namespace
}  // namespace nodmap::logger

int main(int argc, char** argv) {
  return nodmap::logger::run(argc, argv);
}
