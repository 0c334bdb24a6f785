// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
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

/// All files that are served, by path. Requests never reach the file system: only files in this map
/// exist.
class Site {
 public:
  /// Loads the page itself (built into the program) and the files that it uses from Debian's
  /// libjs-three and libjs-dygraphs. Throws std::runtime_error with the package's name if a file is
  /// missing.
  explicit Site(const std::string& javascript_dir = "/usr/share/javascript");

  /// The file for the target of a request, with or without a query; null if there is none.
  [[nodiscard]] const SiteFile* find(std::string_view target) const;

  /// Adds a file that was generated at the start.
  void add(const std::string& path, SiteFile file) { files_[path] = std::move(file); }

  [[nodiscard]] std::size_t size() const { return files_.size(); }

 private:
  std::map<std::string, SiteFile, std::less<>> files_;
};

}  // namespace nodmap::viewer
