// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid/map_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "common/formats/atomic_file.hpp"
#include "common/formats/input_file.hpp"
#include "common/formats/yaml_file.hpp"

namespace nodmap::slam2d {
namespace {

// The first line of map.yaml; the second while the image is being replaced.
constexpr std::string_view kImageLine = "image: map.pgm\n";
constexpr std::string_view kPreviousImageLine = "image: map.previous.pgm\n";

constexpr std::int64_t kMaxImageCells = 64'000'000;
// A finer map would take hours to read; what is coarser, or larger, is a mistake in the unit.
constexpr double kMinResolutionM = 0.005;
constexpr double kMaxResolutionM = 1.0;
constexpr double kMaxAreaM2 = 640e3;
constexpr double kMaxSideM = 6000.0;  // a search for a place counts 0.1 m in 16 bits
constexpr double kMaxOriginM = 1e6;   // cells beyond would not fit into 32 bits

std::string pgm_of(const OccupancyGrid& grid) {
  std::string bytes =
      "P5\n" + std::to_string(grid.width()) + " " + std::to_string(grid.height()) + "\n255\n";
  for (int y = grid.height() - 1; y >= 0; --y) {  // the first row of an image is its top
    for (int x = 0; x < grid.width(); ++x) {
      bytes.push_back(static_cast<char>(grey_of(grid, x, y)));
    }
  }
  return bytes;
}

std::string yaml_of(const OccupancyGrid& grid) {
  std::ostringstream text;
  text.precision(12);  // micrometres, also a thousand kilometres away
  text << kImageLine << "mode: trinary\n"
       << "resolution: " << grid.cell_size_m() << "\n"
       << "origin: [" << grid.origin().x() << ", " << grid.origin().y() << ", 0]\n"
       << "negate: 0\n"
       << "occupied_thresh: 0.65\n"
       << "free_thresh: 0.196\n";
  return text.str();
}

std::string contents_of(const std::filesystem::path& file) {
  std::ostringstream contents;
  contents << std::ifstream(file, std::ios::binary).rdbuf();
  return contents.str();
}

// Lets an existing map.yaml name a copy of its image, so that map.pgm can be replaced before
// map.yaml is. Needs to do nothing if map.yaml stays as it is, or names another image already.
std::error_code keep_previous_image(const std::filesystem::path& dir, std::string_view new_yaml) {
  std::string yaml = contents_of(dir / "map.yaml");
  std::error_code unknown;  // no error that matters: then the image cannot be read either
  if (yaml == new_yaml || !yaml.starts_with(kImageLine) ||
      !std::filesystem::exists(dir / "map.pgm", unknown)) {
    return {};
  }
  const auto error = formats::replace_file(dir / "map.previous.pgm", contents_of(dir / "map.pgm"));
  yaml.replace(0, kImageLine.size(), kPreviousImageLine);
  return error ? error : formats::replace_file(dir / "map.yaml", yaml);
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw formats::InputFileError(file.string() + ": " + reason);
}

// `negate` of map.yaml: a number, as ROS writes it, or a boolean.
bool read_negate(const YAML::Node& negate) {
  int number = 0;
  return YAML::convert<int>::decode(negate, number) ? number != 0 : negate.as<bool>();
}

// A number that must be in a range; `fallback`: if it is not there.
double read_number(const std::filesystem::path& file, const YAML::Node& yaml, const char* key,
                   double min, double max, std::optional<double> fallback = std::nullopt) {
  const YAML::Node node = yaml[key];
  if (!node && fallback) {
    return *fallback;
  }
  const auto value = node.as<double>(std::numeric_limits<double>::quiet_NaN());
  if (!(value >= min && value <= max)) {
    std::ostringstream reason;
    reason << key << ": ";
    if (node && node.IsScalar()) {
      reason << '"' << node.Scalar() << "\" is not ";
    }
    reason << "a number from " << min << " to " << max;
    refuse(file, reason.str());
  }
  return value;
}

// Throws if a key is missing without which there is no map.
void require_keys(const std::filesystem::path& file, const YAML::Node& yaml) {
  for (const char* key : {"image", "resolution", "origin"}) {
    if (!yaml[key]) {
      refuse(file, std::string("'") + key + "' is missing");
    }
  }
}

// X and y in m, and the yaw; infinite if it is something else.
geometry::SE2 read_origin(const YAML::Node& origin) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (!origin.IsSequence() || origin.size() != 3) {
    return {kNone, kNone, kNone};
  }
  return {origin[0].as<double>(kNone), origin[1].as<double>(kNone), origin[2].as<double>(kNone)};
}

// What map.yaml says.
struct MapHeader {
  std::filesystem::path image;
  double cell_size_m = 0.0;
  geometry::SE2 T_map_grid;
  bool negate = false;
  double occupied_threshold = 0.65;
  double free_threshold = 0.196;
};

MapHeader read_header(const std::filesystem::path& file) {
  MapHeader header;
  try {
    const YAML::Node yaml = formats::read_yaml(file);
    require_keys(file, yaml);
    if (yaml["mode"].as<std::string>("trinary") == "raw") {
      refuse(file, "mode raw is not supported, only trinary and scale");
    }
    header.image = file.parent_path() / yaml["image"].as<std::string>();
    header.cell_size_m = read_number(file, yaml, "resolution", kMinResolutionM, kMaxResolutionM);
    header.T_map_grid = read_origin(yaml["origin"]);
    header.negate = yaml["negate"] && read_negate(yaml["negate"]);
    header.occupied_threshold =
        read_number(file, yaml, "occupied_thresh", 0.0, 1.0, header.occupied_threshold);
    header.free_threshold = read_number(file, yaml, "free_thresh", 0.0, header.occupied_threshold,
                                        header.free_threshold);
  } catch (const YAML::Exception& error) {
    refuse(file, error.what());
  }
  const geometry::SE2& T = header.T_map_grid;
  if (!(std::max(std::abs(T.x), std::abs(T.y)) <= kMaxOriginM && std::isfinite(T.yaw))) {
    refuse(file, "origin: three numbers are needed, x and y from -1e6 to 1e6 m, and the yaw");
  }
  return header;
}

// The next number of a PGM file's header, past comments.
int read_pgm_number(std::istream& in, const std::filesystem::path& file) {
  while ((in >> std::ws) && in.peek() == '#') {
    in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  int value = 0;
  if (!(in >> value) || value < 0) {
    refuse(file, "an incomplete PGM image");
  }
  return value;
}

// A grey image, 0 black to 1 white, first row on top.
struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<float> values;

  [[nodiscard]] double at(int x, int y) const {
    return static_cast<double>(
        values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x)]);
  }
};

GreyImage read_pgm(const std::filesystem::path& file) {
  std::ifstream in = formats::open_input(file);
  std::string magic(2, ' ');
  if (!in.read(magic.data(), 2) || (magic != "P5" && magic != "P2")) {
    refuse(file, "not a PGM image (P2 or P5)");
  }
  GreyImage image;
  image.width = read_pgm_number(in, file);
  image.height = read_pgm_number(in, file);
  const int white = read_pgm_number(in, file);
  const auto size = static_cast<std::int64_t>(image.width) * image.height;
  if (size == 0 || size > kMaxImageCells || white == 0 || white > 255) {
    refuse(file, "an image of 1 to 64 million pixels with at most 255 grey values is needed");
  }
  in.ignore(1);
  std::string bytes(magic == "P5" ? static_cast<std::size_t>(size) : 0, '\0');
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    refuse(file, "an incomplete PGM image");
  }
  image.values.reserve(static_cast<std::size_t>(size));
  for (std::int64_t i = 0; i < size; ++i) {
    const int value = bytes.empty()
                          ? read_pgm_number(in, file)
                          : static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
    image.values.push_back(static_cast<float>(value) / static_cast<float>(white));
  }
  return image;
}

// The state of a cell whose image value is 0 (black) to 1 (white).
CellState state_of(double value, const MapHeader& header) {
  const double occupied = header.negate ? value : 1.0 - value;
  if (occupied > header.occupied_threshold) {
    return CellState::kOccupied;
  }
  return occupied < header.free_threshold ? CellState::kFree : CellState::kUnknown;
}

}  // namespace

std::uint8_t grey_of(const OccupancyGrid& grid, int x, int y) {
  const std::int8_t occupancy = grid.occupancy(x, y);
  if (occupancy == OccupancyGrid::kUnknown) {
    return kUnknownGrey;
  }
  return OccupancyGrid::is_occupied(occupancy) ? kOccupiedGrey : kFreeGrey;
}

std::error_code write_ros_map(const std::filesystem::path& dir, const OccupancyGrid& grid) {
  const std::string yaml = yaml_of(grid);
  if (const auto error = keep_previous_image(dir, yaml)) {
    return error;
  }
  if (const auto error = formats::replace_file(dir / "map.pgm", pgm_of(grid))) {
    return error;
  }
  if (const auto error = formats::replace_file(dir / "map.yaml", yaml)) {
    return error;
  }
  std::error_code ignored;  // nothing reads it any more
  std::filesystem::remove(dir / "map.previous.pgm", ignored);
  return {};
}

TrinaryGrid read_ros_map(const std::filesystem::path& path) {
  if (path.extension() == ".pgm") {
    refuse(path, "is only the image of a map; its map.yaml is needed");
  }
  if (path.extension() == ".lcmlog") {
    refuse(path, "is an event log; a map.yaml is needed");
  }
  std::error_code unknown;  // opening the file will report it
  const MapHeader header =
      read_header(std::filesystem::is_directory(path, unknown) ? path / "map.yaml" : path);
  const GreyImage image = read_pgm(header.image);
  if (static_cast<double>(image.values.size()) * header.cell_size_m * header.cell_size_m >
      kMaxAreaM2) {
    refuse(header.image, "covers more than 640000 m^2 at the resolution of the map");
  }
  if (std::max(image.width, image.height) * header.cell_size_m > kMaxSideM) {
    refuse(header.image, "is longer than 6000 m at the resolution of the map");
  }
  TrinaryGrid grid;
  grid.cell_size_m = header.cell_size_m;
  grid.T_map_grid = header.T_map_grid;
  grid.width = image.width;
  grid.height = image.height;
  grid.cells.reserve(image.values.size());
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      grid.cells.push_back(state_of(image.at(x, y), header));
    }
  }
  return grid;
}

}  // namespace nodmap::slam2d
