// SPDX-License-Identifier: BSD-3-Clause
#include "common/params/params.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>

#include "common/formats/number.hpp"
#include "common/formats/yaml_file.hpp"
#include "common/params/suggestion.hpp"

namespace nodmap::params {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

// The shortest text that reads back as the same number.
std::string format(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

// A finite number within the range.
std::optional<double> parse_within(std::string_view text, Range range) {
  const std::optional<double> value = formats::parse_number<double>(text);
  if (!value || !(*value >= range.min && *value <= range.max)) {
    return std::nullopt;
  }
  return value;
}

// Formats a text as a double-quoted YAML scalar.
std::string quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

std::string interval(Range range) {
  return "a number from " + format(range.min) + " to " + format(range.max);
}

// Without exponents, which a whole number must not have either.
std::string whole_interval(Range range) {
  return "a whole number from " + std::to_string(std::llround(range.min)) + " to " +
         std::to_string(std::llround(range.max));
}

// Splits a name at its dots: "matcher.max_range_m" gives {"matcher", "max_range_m"}.
std::vector<std::string> split(std::string_view name) {
  std::vector<std::string> parts;
  for (std::size_t dot = name.find('.'); dot != std::string_view::npos; dot = name.find('.')) {
    parts.emplace_back(name.substr(0, dot));
    name.remove_prefix(dot + 1);
  }
  parts.emplace_back(name);
  return parts;
}

// "; did you mean 'X'?", or the known names if none is similar.
std::string help_for_unknown(std::string_view name, const std::vector<Entry>& entries) {
  std::vector<std::string> known;
  std::string list;
  for (const Entry& entry : entries) {
    known.push_back(entry.name);
    list.append(list.empty() ? "; known are: " : ", ").append(entry.name);
  }
  const std::string suggestion = did_you_mean(name, known);
  return !suggestion.empty() ? suggestion : !list.empty() ? list : "; there are none";
}

// The value as a line of YAML, after comments with its sentence and range.
std::string yaml_lines(const Entry& entry, const std::string& key, const std::string& indent) {
  return indent + "# " + entry.help + "\n" + indent + "# " + entry.allowed + "\n" + indent + key +
         ": " + (entry.kind == Kind::kText ? quoted(entry.get()) : entry.get()) + "\n";
}

std::string markdown_row(const Entry& entry) {
  return "| `" + entry.name + "` | " + entry.get() + " | " + entry.allowed + " | " + entry.help +
         " |\n";
}

// Sets the parameters that a YAML file contains.
class YamlLoader {
 public:
  YamlLoader(std::string file, Table& table) : file_(std::move(file)), table_(table) {}

  // Sets the values of a map and of the maps nested in it; `prefix` is the key of this map with
  // its dot.
  void load(const YAML::Node& map, const std::string& prefix) {
    for (const auto& item : map) {
      const std::string where = file_ + ":" + std::to_string(item.first.Mark().line + 1);
      if (item.first.IsScalar() && item.second.IsMap()) {
        const std::string section = prefix + item.first.Scalar();
        if (!table_.has_section(section)) {
          throw ParamError(
              std::string(where).append(": unknown section '").append(section).append("'"));
        }
        load(item.second, section + ".");
      } else if (item.first.IsScalar() && item.second.IsScalar()) {
        const std::string key = prefix + item.first.Scalar();
        // Of two values that contradict each other, neither is known to be the one that is meant.
        if (!keys_.insert(key).second) {
          throw ParamError(std::string(where).append(": key '").append(key).append(
              "' is already set in this file"));
        }
        table_.set(key, item.second.Scalar(), where);
      } else {
        throw ParamError(where + ": expected 'key: value' with a single value");
      }
    }
  }

 private:
  std::string file_;
  Table& table_;
  std::set<std::string> keys_;  // set so far
};

}  // namespace

void Table::number(const std::string& name, double& value, Range range, std::string help) {
  entries_.push_back({prefix_ + name, std::move(help), interval(range), Kind::kValue,
                      [&value] { return format(value); },
                      [&value, range](std::string_view text) {
                        const auto given = parse_within(text, range);
                        value = given.value_or(value);
                        return given.has_value();
                      }});
}

void Table::integer(const std::string& name, int& value, Range range, std::string help) {
  entries_.push_back({prefix_ + name, std::move(help), whole_interval(range), Kind::kValue,
                      [&value] { return std::to_string(value); },
                      [&value, range](std::string_view text) {
                        const auto given = formats::parse_number<int>(text);
                        if (!given || *given < range.min || *given > range.max) {
                          return false;
                        }
                        value = *given;
                        return true;
                      }});
}

void Table::angle(const std::string& name_deg, double& value_rad, Range range_deg,
                  std::string help) {
  entries_.push_back(
      {prefix_ + name_deg, std::move(help), interval(range_deg), Kind::kValue,
       // Rounded, so that a default given in degrees is printed as it was written.
       [&value_rad] { return format(std::round(value_rad * kDegreesPerRadian * 1e9) / 1e9); },
       [&value_rad, range_deg](std::string_view text) {
         const auto given = parse_within(text, range_deg);
         value_rad = given ? *given / kDegreesPerRadian : value_rad;
         return given.has_value();
       }});
}

void Table::flag(const std::string& name, bool& value, std::string help) {
  entries_.push_back({prefix_ + name, std::move(help), "true or false", Kind::kFlag,
                      [&value] { return std::string(value ? "true" : "false"); },
                      [&value](std::string_view text) {
                        if (text != "true" && text != "false") {
                          return false;
                        }
                        value = text == "true";
                        return true;
                      }});
}

void Table::text(const std::string& name, std::string& value, std::string help) {
  entries_.push_back({prefix_ + name, std::move(help), "any text", Kind::kText,
                      [&value] { return value; },
                      [&value](std::string_view text) {
                        value = text;
                        return true;
                      }});
}

void Table::set(std::string_view name, std::string_view value, const std::string& source) {
  const auto entry = std::ranges::find(entries_, name, &Entry::name);
  if (entry == entries_.end()) {
    throw_unknown(name, value, source);
  }
  if (!entry->set(value)) {
    throw ParamError(source + ": key '" + std::string(name) + "': '" + std::string(value) +
                     "' is not allowed; it takes " + entry->allowed);
  }
}

void Table::throw_unknown(std::string_view name, std::string_view value,
                          const std::string& source) const {
  const auto renamed = std::ranges::find(
      renamed_, name, [](const auto& names) { return std::string_view(names.first); });
  if (renamed != renamed_.end()) {
    throw ParamError(source + ": key '" + renamed->first + "' is now called '" + renamed->second +
                     "'");
  }
  throw ParamError(source + ": unknown key '" + std::string(name) + "' with value '" +
                   std::string(value) + "'" + help_for_unknown(name, entries_));
}

bool Table::has_section(std::string_view name) const {
  const std::string prefix = std::string(name) + ".";
  return std::ranges::any_of(entries_,
                             [&](const Entry& e) { return e.name.starts_with(prefix); }) ||
         std::ranges::any_of(renamed_, [&](const auto& r) { return r.first.starts_with(prefix); });
}

void Table::set_assignment(std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    throw ParamError("--set: '" + std::string(assignment) + "' is not of the form key=value");
  }
  set(assignment.substr(0, equals), assignment.substr(equals + 1), "--set");
}

void Table::load_yaml(const std::filesystem::path& file) {
  const YAML::Node root = formats::read_yaml(file);
  if (root.IsNull()) {
    return;
  }
  if (!root.IsMap()) {
    throw ParamError(file.string() + ": expected lines of the form 'key: value'");
  }
  YamlLoader(file.string(), *this).load(root, "");
}

std::string Table::to_yaml() const {
  std::string yaml;
  std::vector<std::string> open;  // the sections of the previous line
  for (const Entry& entry : entries_) {
    const std::vector<std::string> path = split(entry.name);
    std::size_t common = 0;
    while (common < open.size() && common + 1 < path.size() && open[common] == path[common]) {
      ++common;
    }
    open.assign(path.begin(), path.end() - 1);
    for (; common < open.size(); ++common) {
      yaml += std::string(2 * common, ' ') + open[common] + ":\n";
    }
    yaml += yaml_lines(entry, path.back(), std::string(2 * open.size(), ' '));
  }
  return yaml;
}

std::string Table::to_markdown() const {
  std::string table = "| parameter | default | allowed | meaning |\n|---|---|---|---|\n";
  for (const Entry& entry : entries_) {
    table += markdown_row(entry);
  }
  return table;
}

}  // namespace nodmap::params
