// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace nodmap::viewer {

/// A file of the page, in memory.
struct SiteFile {
  std::string content_type;
  std::string content;
};

/// Everything that is served, by its path. There is no way from a request to the file system: what
/// is not in this map does not exist.
class Site {
 public:
  /// The page itself (built into the program), and what it uses of Debian's libjs-three and
  /// libjs-dygraphs. Throws std::runtime_error naming the package when a file is missing.
  explicit Site(const std::string& javascript_dir = "/usr/share/javascript");

  /// Null when there is no such file. `target` is the target of a request, with or without a query.
  [[nodiscard]] const SiteFile* find(std::string_view target) const;

  /// Adds a file that was made up at the start.
  void add(const std::string& path, SiteFile file) { files_[path] = std::move(file); }

  [[nodiscard]] std::size_t size() const { return files_.size(); }

 private:
  std::map<std::string, SiteFile, std::less<>> files_;
};

}  // namespace nodmap::viewer
