// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/yaml_file.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <sstream>
#include <string>

#include "common/formats/input_file.hpp"
#include "common/formats/text_lines.hpp"

namespace nodmap::formats {
namespace {

// Remembers where a document begins, and nothing of what it contains.
class DocumentStart final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { mark_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

  [[nodiscard]] const YAML::Mark& mark() const { return mark_; }

 private:
  YAML::Mark mark_;
};

std::string error_at(const std::filesystem::path& file, const YAML::Mark& mark,
                     const std::string& reason) {
  return file.string() + ":" + std::to_string(mark.line + 1) + ": " + printable(reason);
}

// Asks the parser for two documents and no more: before a comma that belongs to nothing,
// yaml-cpp's LoadAll() finds document after document without end.
void expect_one_document(const std::filesystem::path& file, const std::string& text) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  DocumentStart start;
  if (parser.HandleNextDocument(start) && parser.HandleNextDocument(start)) {
    throw InputFileError(
        error_at(file, start.mark(),
                 "begins another YAML document, by '---' or because it does not belong to what "
                 "is above"));
  }
}

}  // namespace

YAML::Node read_yaml(const std::filesystem::path& file) {
  const std::string text = read_input(file);
  try {
    expect_one_document(file, text);
    return YAML::Load(text);
  } catch (const YAML::ParserException& error) {
    throw InputFileError(error_at(file, error.mark, error.msg));
  }
}

}  // namespace nodmap::formats
