// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/ply.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "common/formats/input_file.hpp"

namespace nodmap::formats {
namespace {

enum class Type : std::uint8_t { kI8, kU8, kI16, kU16, kI32, kU32, kF32, kF64 };

struct Property {
  Type type = Type::kF32;
  std::string name;
  bool is_list = false;
  Type count_type = Type::kU8;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool binary = false;
  std::vector<Element> elements;
};

Type type_of(const std::string& name) {
  static const std::map<std::string, Type> kTypes{
      {"char", Type::kI8},    {"int8", Type::kI8},     {"uchar", Type::kU8},
      {"uint8", Type::kU8},   {"short", Type::kI16},   {"int16", Type::kI16},
      {"ushort", Type::kU16}, {"uint16", Type::kU16},  {"int", Type::kI32},
      {"int32", Type::kI32},  {"uint", Type::kU32},    {"uint32", Type::kU32},
      {"float", Type::kF32},  {"float32", Type::kF32}, {"double", Type::kF64},
      {"float64", Type::kF64}};
  const auto found = kTypes.find(name);
  if (found == kTypes.end()) {
    throw std::runtime_error("property type '" + name + "' is not supported");
  }
  return found->second;
}

Property read_property(std::istringstream& words) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    property.is_list = true;
    std::string count_type;
    words >> count_type >> type;
    property.count_type = type_of(count_type);
  }
  property.type = type_of(type);
  words >> property.name;
  return property;
}

void read_header_line(const std::string& line, Header& header) {
  std::istringstream words(line);
  std::string key;
  words >> key;
  if (key == "format") {
    std::string format;
    words >> format;
    if (format != "ascii" && format != "binary_little_endian") {
      throw std::runtime_error("format '" + format + "' is not supported");
    }
    header.binary = format != "ascii";
  } else if (key == "element") {
    Element element;
    if (!(words >> element.name >> element.count)) {
      throw std::runtime_error("element without name or count");
    }
    header.elements.push_back(element);
  } else if (key == "property") {
    if (header.elements.empty()) {
      throw std::runtime_error("property before the first element");
    }
    header.elements.back().properties.push_back(read_property(words));
  }
}

Header read_header(std::istream& in) {
  // A header's lines are short; a file of another kind may be one line as large as the memory.
  std::array<char, 4096> bytes{};
  const auto next_line = [&] { return static_cast<bool>(in.getline(bytes.data(), bytes.size())); };
  const auto line = [&] { return std::string(bytes.data()); };
  if (!next_line() || (line() != "ply" && line() != "ply\r")) {
    throw std::runtime_error("not a PLY file");
  }
  Header header;
  while (next_line()) {
    if (line().starts_with("end_header")) {
      for (const Element& element : header.elements) {
        if (element.count > 0 && element.properties.empty()) {
          throw std::runtime_error("element without properties");  // its count could be any number
        }
      }
      return header;
    }
    read_header_line(line(), header);
  }
  throw std::runtime_error("the header has no end");
}

bool is_coordinate(const Element& element, const Property& property) {
  const std::string& name = property.name;
  return element.name == "vertex" && !property.is_list && name.size() == 1 && name[0] >= 'x' &&
         name[0] <= 'z';
}

// Throws unless the file has vertices with all three coordinates, each once.
void require_coordinates(const Header& header) {
  std::string found;
  for (const Element& element : header.elements) {
    for (const Property& property : element.properties) {
      found += is_coordinate(element, property) ? property.name : "";
    }
  }
  std::ranges::sort(found);
  if (found != "xyz") {
    throw std::runtime_error("no element 'vertex' with the properties x, y and z");
  }
}

template <class Value>
double read_binary(std::istream& in) {
  std::array<char, sizeof(Value)> bytes{};
  in.read(bytes.data(), bytes.size());
  Value value{};
  std::memcpy(&value, bytes.data(), sizeof value);
  return static_cast<double>(value);
}

double read_number(std::istream& in, Type type, bool binary) {
  double value = 0.0;
  if (!binary) {
    in >> value;
  } else {
    switch (type) {
      case Type::kI8:
        value = read_binary<std::int8_t>(in);
        break;
      case Type::kU8:
        value = read_binary<std::uint8_t>(in);
        break;
      case Type::kI16:
        value = read_binary<std::int16_t>(in);
        break;
      case Type::kU16:
        value = read_binary<std::uint16_t>(in);
        break;
      case Type::kI32:
        value = read_binary<std::int32_t>(in);
        break;
      case Type::kU32:
        value = read_binary<std::uint32_t>(in);
        break;
      case Type::kF32:
        value = read_binary<float>(in);
        break;
      case Type::kF64:
        value = read_binary<double>(in);
        break;
    }
  }
  if (!in) {
    throw std::runtime_error("ends too early, or contains something that is not a number");
  }
  return value;
}

// Reads the values of a property (one, or those of a list) into `values`, reusing its memory.
void read_values(std::istream& in, const Property& property, bool binary,
                 std::vector<double>& values) {
  constexpr double kMaxListSize =
      1000.0;  // a face has a few corners; the file may claim any number
  const double size = property.is_list ? read_number(in, property.count_type, binary) : 1.0;
  if (!(size >= 0.0 && size <= kMaxListSize)) {
    throw std::runtime_error("a list of " + std::to_string(size) + " values");
  }
  values.resize(static_cast<std::size_t>(size));
  for (double& value : values) {
    value = read_number(in, property.type, binary);
  }
}

// Reads every item up to the last of element `last`. Calls `on_value(element, property, values)`
// for each of its properties, then `on_item(element)`.
template <class OnValue, class OnItem>
void read_items(std::istream& in, const std::string& last, OnValue&& on_value, OnItem&& on_item) {
  const Header header = read_header(in);
  require_coordinates(header);
  std::vector<double> values;
  for (const Element& element : header.elements) {
    for (std::size_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        read_values(in, property, header.binary, values);
        on_value(element, property, values);
      }
      on_item(element);
    }
    if (element.name == last) {
      return;
    }
  }
}

void require_finite(const Eigen::Vector3d& vertex) {
  if (!vertex.allFinite()) {
    throw std::runtime_error("a vertex that is not finite");
  }
}

std::vector<Eigen::Vector3f> read_points(std::istream& in) {
  std::vector<Eigen::Vector3f> points;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  read_items(
      in, "vertex",
      [&](const Element& element, const Property& property, const std::vector<double>& values) {
        if (is_coordinate(element, property)) {
          p[property.name[0] - 'x'] = values[0];
        }
      },
      [&](const Element& element) {
        if (element.name == "vertex") {
          require_finite(p);
          points.emplace_back(p.cast<float>());
        }
      });
  return points;
}

void add_face(const std::vector<double>& corners, TriangleMesh& mesh) {
  if (corners.size() < 3) {
    throw std::runtime_error("a face of fewer than three corners");
  }
  for (const double corner : corners) {
    if (!(corner >= 0.0 && corner < static_cast<double>(mesh.vertices.size()))) {
      throw std::runtime_error("a face with a corner that does not exist");
    }
  }
  const auto index = [&](std::size_t i) { return static_cast<int>(corners[i]); };
  for (std::size_t i = 2; i < corners.size(); ++i) {
    mesh.triangles.emplace_back(index(0), index(i - 1), index(i));
  }
}

TriangleMesh read_mesh(std::istream& in) {
  TriangleMesh mesh;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  read_items(
      in, "face",
      [&](const Element& element, const Property& property, const std::vector<double>& values) {
        if (is_coordinate(element, property)) {
          p[property.name[0] - 'x'] = values[0];
        } else if (element.name == "face" &&
                   (property.name == "vertex_indices" || property.name == "vertex_index")) {
          add_face(values, mesh);
        }
      },
      [&](const Element& element) {
        if (element.name == "vertex") {
          require_finite(p);
          mesh.vertices.push_back(p);
        }
      });
  if (mesh.triangles.empty()) {
    throw std::runtime_error("no faces");
  }
  return mesh;
}

// Returns the result of `read` for the file; puts the file's name in front of every error.
template <class Read>
auto read_file(const std::filesystem::path& file, Read&& read) {
  std::ifstream in = open_input(file);
  try {
    return read(in);
  } catch (const std::runtime_error& error) {
    throw InputFileError(file.string() + ": " + error.what());
  }
}

}  // namespace

std::vector<Eigen::Vector3f> read_ply(const std::filesystem::path& file) {
  return read_file(file, read_points);
}

TriangleMesh read_ply_mesh(const std::filesystem::path& file) {
  return read_file(file, read_mesh);
}

}  // namespace nodmap::formats
