// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/step.hpp"

namespace nodmap::laser3d {

SickConfig wanted_config(const SickConfig& config, const SickParams& params) {
  return with_measuring(config, params.unit, params.reach);
}

Bytes request_of(SickStep step, const SickParams& params, const std::optional<SickConfig>& config) {
  switch (step) {
    case SickStep::kSearch:
    case SickStep::kConfirmBaud:
    case SickStep::kLeaveInstall:
    case SickStep::kStop:
      return sick_command::set_mode(SickMode::kOnRequest);
    case SickStep::kSetBaud:
      return sick_command::set_baud(params.baud);
    case SickStep::kReadConfig:
      return sick_command::request_config();
    case SickStep::kInstall:
      return sick_command::set_mode(SickMode::kInstallation);
    case SickStep::kWriteConfig:
      return config ? sick_command::write_config(wanted_config(*config, params)) : Bytes{};
    case SickStep::kSetVariant:
      return sick_command::set_variant(params.variant);
    case SickStep::kStartStream:
      return sick_command::set_mode(params.interlaced ? SickMode::kStreamInterlaced
                                                      : SickMode::kStreamAll);
    case SickStep::kSlowDown:
      return sick_command::set_baud(9600);
    default:
      return {};
  }
}

SickAnswer classify_answer(SickStep step, const SickTelegram& telegram) {
  const auto accepted = [&telegram](std::uint8_t good) {
    return !telegram.data.empty() && telegram.data.front() == good ? SickAnswer::kDone
                                                                   : SickAnswer::kRefused;
  };
  if (telegram.reply == SickReply::kNotAccepted) {
    return SickAnswer::kRefused;
  }
  switch (step) {
    case SickStep::kReadConfig:
      return telegram.reply == SickReply::kConfig ? SickAnswer::kDone : SickAnswer::kOther;
    case SickStep::kWriteConfig:
      return telegram.reply == SickReply::kConfigWritten ? accepted(1) : SickAnswer::kOther;
    case SickStep::kSetVariant:
      return telegram.reply == SickReply::kVariant ? accepted(1) : SickAnswer::kOther;
    case SickStep::kStream:
    case SickStep::kSettle:
    case SickStep::kWait:
      return SickAnswer::kOther;
    default:
      return telegram.reply == SickReply::kMode ? accepted(0) : SickAnswer::kOther;
  }
}

const char* purpose_of(SickStep step) {
  switch (step) {
    case SickStep::kSearch:
      return "answer at any baud rate";
    case SickStep::kSetBaud:
    case SickStep::kConfirmBaud:
      return "change the baud rate";
    case SickStep::kReadConfig:
      return "send its configuration";
    case SickStep::kInstall:
    case SickStep::kWriteConfig:
    case SickStep::kLeaveInstall:
      return "accept a new configuration";
    case SickStep::kSetVariant:
      return "accept the angle and resolution";
    case SickStep::kStartStream:
      return "stream";
    default:
      return "stop";
  }
}

}  // namespace nodmap::laser3d
