// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/ply.hpp"

#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/formats/input_file.hpp"

namespace nodmap::formats {
namespace {

struct Property {
  std::string type;
  std::string name;
};

struct Header {
  bool binary = false;
  std::size_t num_vertices = 0;
  std::vector<Property> properties;
};

std::size_t size_of(const std::string& type) {
  static const std::map<std::string, std::size_t> kSizes{
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = kSizes.find(type);
  if (found == kSizes.end()) {
    throw std::runtime_error("property type '" + type + "' is not supported");
  }
  return found->second;
}

void read_header_line(std::istringstream& words, const std::string& key, bool& in_vertices,
                      Header& header) {
  std::string value;
  if (key == "format" && words >> value) {
    if (value != "ascii" && value != "binary_little_endian") {
      throw std::runtime_error("format '" + value + "' is not supported");
    }
    header.binary = value == "binary_little_endian";
  } else if (key == "element" && words >> value) {
    in_vertices = value == "vertex";
    if (in_vertices) {
      words >> header.num_vertices;
    }
  } else if (key == "property" && in_vertices) {
    Property property;
    words >> property.type >> property.name;
    static_cast<void>(size_of(property.type));
    header.properties.push_back(property);
  }
}

Header read_header(std::istream& in) {
  std::string line;
  std::getline(in, line);
  if (line.rfind("ply", 0) != 0) {
    throw std::runtime_error("no PLY file");
  }
  Header header;
  bool in_vertices = false;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "end_header") {
      if (header.num_vertices > 0 && header.properties.empty()) {
        throw std::runtime_error("vertices without properties");  // as many as the header likes
      }
      return header;
    }
    read_header_line(words, key, in_vertices, header);
  }
  throw std::runtime_error("the header has no end");
}

float read_value(std::istream& in, const Property& property, bool binary) {
  if (!binary) {
    double value = 0.0;
    in >> value;
    return static_cast<float>(value);
  }
  char bytes[8] = {};
  in.read(bytes, static_cast<std::streamsize>(size_of(property.type)));
  if (property.type == "double" || property.type == "float64") {
    double value = 0.0;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<float>(value);
  }
  float value = 0.0F;  // only x, y, z are used, and those are never integers in practice
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

std::vector<Eigen::Vector3f> read_vertices(std::istream& in) {
  const Header header = read_header(in);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < header.num_vertices; ++i) {
    Eigen::Vector3f p = Eigen::Vector3f::Zero();
    for (const Property& property : header.properties) {
      const float value = read_value(in, property, header.binary);
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
        p[property.name[0] - 'x'] = value;
      }
    }
    if (!in) {
      throw std::runtime_error("ends after " + std::to_string(i) + " of " +
                               std::to_string(header.num_vertices) + " vertices");
    }
    points.push_back(p);
  }
  return points;
}

}  // namespace

void write_ply(const std::filesystem::path& file, const std::vector<ColouredPoint>& points) {
  std::ofstream out(file, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
      << "\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (const ColouredPoint& point : points) {
    char bytes[15];
    std::memcpy(bytes, point.p_map.data(), 12);
    std::memcpy(bytes + 12, point.rgb.data(), 3);
    out.write(bytes, sizeof bytes);
  }
  out.flush();
  if (!out) {
    throw std::runtime_error(file.string() + ": cannot write");
  }
}

std::vector<Eigen::Vector3f> read_ply(const std::filesystem::path& file) {
  std::ifstream in = open_input(file);
  try {
    return read_vertices(in);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

}  // namespace nodmap::formats
