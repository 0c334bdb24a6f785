// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/results.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "common/formats/atomic_file.hpp"
#include "common/formats/folder.hpp"
#include "common/formats/user_error.hpp"

namespace nodmap::node {

void make_result_dir(const std::filesystem::path& dir) {
  formats::make_folder(dir);
  std::error_code error;
  const bool is_empty = std::filesystem::is_empty(dir, error);
  if (error) {
    throw formats::UserError(dir.string() + ": cannot read this folder: " + error.message());
  }
  if (!is_empty) {
    throw formats::UserError(
        dir.string() + " is not empty, and results are never overwritten; name another --out");
  }
}

LiveResultDir make_next_result_dir(const std::filesystem::path& dir) {
  namespace fs = std::filesystem;
  if (dir.empty()) {
    return {};
  }
  const fs::path first = dir.has_filename() ? dir : dir.parent_path();  // "DIR/" is DIR
  LiveResultDir next{.path = first};
  for (int number = 2;; ++number) {
    if (!fs::exists(next.path) || fs::is_empty(next.path)) {
      make_result_dir(next.path);
      next.lock =
          formats::FileDescriptor(::open(next.path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
      // Where the file system has no locks, an empty folder is free.
      if (::flock(next.lock.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) {
        return next;
      }
    }
    next.path = first.string() + "." + std::to_string(number);
  }
}

nlohmann::json messages_json(const bus::Bus& bus, const MessageCounts& counts) {
  nlohmann::json rejected = nlohmann::json::object();
  for (const auto& [cause, count] : counts.rejected()) {
    rejected[cause] = count;
  }
  return {{"read", bus.counts().received},
          {"used", counts.used()},
          {"rejected", rejected},
          {"corrupt", bus.counts().corrupt},
          {"lost", counts.lost()},
          {"overrun", bus.counts().overrun},
          {"published", bus.counts().published},
          {"not_published", bus.counts().not_published}};
}

void write_each(std::initializer_list<std::function<void()>> writers) {
  std::exception_ptr first;
  for (const std::function<void()>& write : writers) {
    try {
      write();
    } catch (const std::exception&) {
      first = first ? first : std::current_exception();
    }
  }
  if (first) {
    std::rethrow_exception(first);
  }
}

void write_result_json(const std::filesystem::path& dir, const nlohmann::json& result) {
  const std::filesystem::path file = dir / "result.json";
  // Names of files and processes may be any bytes, but JSON is UTF-8.
  const std::string text = result.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
  formats::write_file(file, text + "\n");
}

}  // namespace nodmap::node
