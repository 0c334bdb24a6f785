// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick_step.hpp"

#include <gtest/gtest.h>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace {

SickTelegram telegram_of(const Bytes& bytes) {
  SickParser parser;
  parser.feed(bytes, 0);
  const auto event = parser.next();
  return event ? std::get<SickTelegram>(*event) : SickTelegram{};
}

TEST(SickStep, AnswersAreJudgedByTheStepThatAsked) {
  const SickTelegram mode = telegram_of(test::kModeOk);
  EXPECT_EQ(judge_answer(SickStep::kSearch, mode), SickAnswer::kDone);
  EXPECT_EQ(judge_answer(SickStep::kReadConfig, mode), SickAnswer::kOther);
  EXPECT_EQ(judge_answer(SickStep::kStream, mode), SickAnswer::kOther);
  EXPECT_EQ(judge_answer(SickStep::kInstall, telegram_of(test::kWrongPassword)),
            SickAnswer::kRefused);
  EXPECT_EQ(judge_answer(SickStep::kSetVariant, telegram_of(test::kVariant180x100)),
            SickAnswer::kDone);
  EXPECT_EQ(judge_answer(SickStep::kSetVariant, telegram_of(test::kVariantRefused)),
            SickAnswer::kRefused);
  EXPECT_EQ(judge_answer(SickStep::kReadConfig, telegram_of(test::kConfig)), SickAnswer::kDone);
  EXPECT_EQ(judge_answer(SickStep::kWriteConfig, telegram_of(test::kConfigWritten)),
            SickAnswer::kDone);
  EXPECT_EQ(judge_answer(SickStep::kSearch, telegram_of(test::kNotAccepted)), SickAnswer::kRefused);
}

TEST(SickStep, NothingIsWrittenThatWasNotRead) {
  EXPECT_TRUE(request_of(SickStep::kWriteConfig, {}, std::nullopt).empty());
  EXPECT_TRUE(request_of(SickStep::kStream, {}, std::nullopt).empty());
}

}  // namespace
}  // namespace nodmap::laser3d
