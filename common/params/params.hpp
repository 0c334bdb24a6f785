// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/formats/user_error.hpp"

namespace nodmap::params {

/// Thrown for an invalid configuration; what() is one line with source, key, value and allowed
/// values.
class ParamError : public formats::UserError {
 public:
  using formats::UserError::UserError;
};

/// The closed interval of values a parameter may take.
struct Range {
  double min = 0.0;
  double max = 0.0;
};

enum class Kind : std::uint8_t { kValue, kFlag, kText };

/// One described parameter, bound to the member of a struct that holds it.
struct Entry {
  std::string name;     ///< with its sections and its unit as suffix: matcher.max_range_m
  std::string help;     ///< one sentence
  std::string allowed;  ///< "a number from 0.01 to 5"
  Kind kind = Kind::kValue;
  std::function<std::string()> get;
  /// Sets the value. Returns false and changes nothing if the value is not allowed.
  std::function<bool(std::string_view)> set;
};

/// The parameters of one struct. The struct describes its parameters once; loading, checks, --help,
/// --dump-params and the table in the module's README are generated from this description:
///
///     struct MatcherParams {
///       double max_range_m = 20.0;
///       template <class Visitor> void describe(Visitor& v) {
///         v.number("max_range_m", max_range_m, {1.0, 80.0}, "Readings beyond are not used.");
///       }
///     };
class Table {
 public:
  /// Binds the table to `params`, which must outlive it. The present values are the defaults.
  template <class Params>
  explicit Table(Params& params) {
    params.describe(*this);
  }

  void number(const std::string& name, double& value, Range range, std::string help);
  void integer(const std::string& name, int& value, Range range, std::string help);
  /// An angle: degrees in configuration, name and range, radians in the struct.
  void angle(const std::string& name_deg, double& value_rad, Range range_deg, std::string help);
  /// If it is false by default, it is also the command-line flag --name-with-dashes; the others are
  /// set to false by --set.
  void flag(const std::string& name, bool& value, std::string help);
  void text(const std::string& name, std::string& value, std::string help);

  /// Adds the parameters of a nested struct, which describes itself. Their keys become `name.key`,
  /// in YAML a map called `name`.
  template <class Params>
  void section(const std::string& name, Params& params) {
    const std::string outer = prefix_;
    prefix_ += name + ".";
    params.describe(*this);
    prefix_ = outer;
  }

  /// Declares a renamed key, both names with their sections: setting the old key gives an error
  /// that names the new one.
  void renamed(std::string old_name, std::string new_name) {
    renamed_.emplace_back(std::move(old_name), std::move(new_name));
  }

  template <class Enum>
  void choice(const std::string& name, Enum& value,
              std::initializer_list<std::pair<const char*, Enum>> options, std::string help) {
    const std::vector<std::pair<std::string, Enum>> table(options.begin(), options.end());
    std::string allowed = "one of";
    for (const auto& [option, unused] : table) {
      allowed += " " + option;
    }
    entries_.push_back({prefix_ + name, std::move(help), std::move(allowed), Kind::kValue,
                        [&value, table] {
                          for (const auto& [option, meaning] : table) {
                            if (meaning == value) {
                              return option;
                            }
                          }
                          return std::string();
                        },
                        [&value, table](std::string_view given) {
                          for (const auto& [option, meaning] : table) {
                            if (option == given) {
                              value = meaning;
                              return true;
                            }
                          }
                          return false;
                        }});
  }

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  /// Sets one parameter. `source` names where the value comes from. Throws ParamError.
  void set(std::string_view name, std::string_view value, const std::string& source);

  /// Sets one parameter from "key=value", as given to --set. Throws ParamError.
  void set_assignment(std::string_view assignment);

  /// Whether this table, or an older version of it, has a section of this name ("a.b").
  [[nodiscard]] bool has_section(std::string_view name) const;

  /// Loads a YAML map of parameters; sections are nested maps or dotted keys. Missing keys keep
  /// their defaults. Throws ParamError, or formats::InputFileError if the file cannot be read or is
  /// not YAML.
  void load_yaml(const std::filesystem::path& file);

  /// The effective parameters as YAML, sections as nested maps, with sentence and range as
  /// comments.
  [[nodiscard]] std::string to_yaml() const;

  /// The parameters as a Markdown table, for a README.
  [[nodiscard]] std::string to_markdown() const;

 private:
  [[noreturn]] void throw_unknown(std::string_view name, std::string_view value,
                                  const std::string& source) const;

  std::string prefix_;  // of the section being described, with its dot
  std::vector<Entry> entries_;
  std::vector<std::pair<std::string, std::string>> renamed_;  // old key, new key
};

}  // namespace nodmap::params
