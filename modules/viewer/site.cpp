// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/site.hpp"

#include <array>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "modules/viewer/page_files.hpp"

namespace nodmap::viewer {
namespace {

// A file of a Debian package. It is served under its own path, by which the modules import each
// other.
struct SystemFile {
  const char* path;
  const char* package;
};

constexpr std::array kSystemFiles{
    SystemFile{"/three/build/three.module.js", "libjs-three"},
    SystemFile{"/three/examples/jsm/controls/OrbitControls.js", "libjs-three"},
    SystemFile{"/dygraphs/dygraph.min.js", "libjs-dygraphs"},
    SystemFile{"/dygraphs/dygraph.min.css", "libjs-dygraphs"}};

std::string content_type(std::string_view path) {
  const auto ends_with = [path](std::string_view ending) { return path.ends_with(ending); };
  return ends_with(".html")  ? "text/html; charset=utf-8"
         : ends_with(".css") ? "text/css; charset=utf-8"
         : ends_with(".svg") ? "image/svg+xml"
                             : "text/javascript; charset=utf-8";
}

std::string read_file(const std::string& path, const char* package) {
  std::ifstream in(path, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(in), {}};
  if (!in || content.empty()) {
    throw std::runtime_error(path + ": cannot read; is the Debian package " + package +
                             " installed?");
  }
  return content;
}

}  // namespace

Site::Site(const std::string& javascript_dir) {
  for (const PageFile& file : kPageFiles) {
    files_[std::string(1, '/').append(file.name)] = {content_type(file.name),
                                                     std::string(file.content)};
  }
  files_["/"] = files_.at("/index.html");
  for (const SystemFile& file : kSystemFiles) {
    files_[file.path] = {content_type(file.path),
                         read_file(javascript_dir + file.path, file.package)};
  }
}

const SiteFile* Site::find(std::string_view target) const {
  const auto found = files_.find(target.substr(0, target.find('?')));
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace nodmap::viewer
