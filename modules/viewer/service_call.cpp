// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/service_call.hpp"

namespace nodmap::viewer {
namespace {

constexpr std::byte kRequest{2};
constexpr char kAnswer = 3;
// Operation, service, call, length of the encoding.
constexpr std::size_t kHeadBytes = 13;

// Reads the number at `at`; there must be four bytes.
std::uint32_t read_number(std::span<const std::byte> bytes, std::size_t at) {
  return boost::endian::load_little_u32(reinterpret_cast<const unsigned char*>(&bytes[at]));
}

Json message(const char* name, Json properties) {
  const Json schema = {{"title", name}, {"type", "object"}, {"properties", std::move(properties)}};
  return {{"encoding", "json"},
          {"schemaName", name},
          {"schemaEncoding", "jsonschema"},
          {"schema", foxglove::to_text(schema)}};
}

}  // namespace

Json control_service() {
  const Json text = {{"type", "string"}};
  const Json number = {{"type", "number"}};
  Json request = message(
      "nodmap.control_request",
      {{"do", text}, {"x_m", number}, {"y_m", number}, {"tolerance_m", number}, {"command", text}});
  Json response =
      message("nodmap.control_response", {{"ok", {{"type", "boolean"}}}, {"text", text}});
  // The schemas twice: at their present place in the protocol, and where older clients expect them.
  return {{"id", kControlService},
          {"name", "control"},
          {"type", "nodmap.control"},
          {"requestSchema", request["schema"]},
          {"responseSchema", response["schema"]},
          {"request", std::move(request)},
          {"response", std::move(response)}};
}

std::optional<ServiceCall> read_service_call(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeadBytes || bytes[0] != kRequest) {
    return std::nullopt;
  }
  const std::size_t encoding_bytes = read_number(bytes, 9);
  const auto rest = bytes.subspan(kHeadBytes);
  if (encoding_bytes > rest.size()) {
    return std::nullopt;
  }
  const std::string_view text(reinterpret_cast<const char*>(rest.data()), rest.size());
  return ServiceCall{.service_id = read_number(bytes, 1),
                     .call_id = read_number(bytes, 5),
                     .encoding = text.substr(0, encoding_bytes),
                     .payload = text.substr(encoding_bytes)};
}

std::string service_answer(const ServiceCall& call, const Json& payload) {
  constexpr std::string_view kEncoding = "json";
  std::string frame(1, kAnswer);
  append_little_endian(frame, call.service_id);
  append_little_endian(frame, call.call_id);
  append_little_endian(frame, static_cast<std::uint32_t>(kEncoding.size()));
  frame += kEncoding;
  return frame + foxglove::to_text(payload);
}

Json service_failure(const ServiceCall& call, const std::string& reason) {
  return {{"op", "serviceCallFailure"},
          {"serviceId", call.service_id},
          {"callId", call.call_id},
          {"message", reason}};
}

}  // namespace nodmap::viewer
