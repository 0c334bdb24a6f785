// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/cloud_file.hpp"

#include <system_error>
#include <utility>

namespace nodmap::formats {
namespace {

std::string header_of(CloudFormat format, std::size_t num_points) {
  const std::string n = std::to_string(num_points);
  if (format == CloudFormat::kPly) {
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + n +
           "\nproperty float x\nproperty float y\nproperty float z\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\n"
           "property double time\nproperty float sigma\nend_header\n";
  }
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
         "FIELDS x y z rgb time sigma\nSIZE 4 4 4 4 8 4\nTYPE F F F U F F\nCOUNT 1 1 1 1 1 1\n"
         "WIDTH " +
         n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA binary\n";
}

template <class Number>
void append_bytes(std::string& bytes, const Number& number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

CloudWriter::CloudWriter(std::filesystem::path file, CloudFormat format, std::size_t num_points)
    : file_(std::move(file)), format_(format), replacement_(file_) {
  replacement_.write(header_of(format, num_points));
}

void CloudWriter::append(const CloudPoint& point) {
  for (const float coordinate_m : point.p) {
    append_bytes(bytes_, coordinate_m);
  }
  const auto [red, green, blue] = point.rgb;
  if (format_ == CloudFormat::kPly) {
    append_bytes(bytes_, point.rgb);
  } else {
    append_bytes(bytes_, static_cast<std::uint32_t>(red << 16U | green << 8U | blue));
  }
  append_bytes(bytes_, point.time_s);
  append_bytes(bytes_, point.sigma_m);
}

void CloudWriter::write(std::span<const CloudPoint> points) {
  bytes_.clear();
  for (const CloudPoint& point : points) {
    append(point);
  }
  replacement_.write(bytes_);
}

void CloudWriter::finish() {
  if (const std::error_code error = replacement_.replace()) {
    throw std::system_error(error, file_.string() + ": cannot write");
  }
}

void write_cloud(const std::filesystem::path& file, CloudFormat format,
                 std::span<const CloudPoint> points) {
  CloudWriter writer(file, format, points.size());
  writer.write(points);
  writer.finish();
}

}  // namespace nodmap::formats
