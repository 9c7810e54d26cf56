// Numbers and names of the parameter messages, as the two autopilots write them.

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "test/support/random.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/mavlink/parameter.hpp"

namespace vantage::wire::mavlink {
namespace {

using enum ParameterEncoding;

TEST(ParameterMessages, HaveTheChecksumsOfTheMessageDefinitions) {
  EXPECT_EQ(find_message(20)->crc_extra, 214);
  EXPECT_EQ(find_message(22)->crc_extra, 220);
  EXPECT_EQ(find_message(23)->crc_extra, 168);
}

TEST(ParameterValue, OfPx4IsTheBytesOfAnInteger) {
  EXPECT_EQ(std::bit_cast<std::uint32_t>(encode_parameter(15, 6, kBytewise)), 15U);
  EXPECT_EQ(decode_parameter(std::bit_cast<float>(15U), 6, kBytewise), 15.0);
  EXPECT_EQ(decode_parameter(std::bit_cast<float>(0xFFFF'FFFFU), 6, kBytewise), -1.0);
  EXPECT_EQ(decode_parameter(std::bit_cast<float>(0xFFU), 2, kBytewise), -1.0);
  EXPECT_EQ(decode_parameter(std::bit_cast<float>(0xFFU), 1, kBytewise), 255.0);
  EXPECT_FLOAT_EQ(static_cast<float>(decode_parameter(0.5F, 9, kBytewise)), 0.5F);
}

TEST(ParameterValue, OfArdupilotIsTheFloatOfAnInteger) {
  EXPECT_EQ(encode_parameter(16, 6, kCast), 16.0F);
  EXPECT_EQ(decode_parameter(16.0F, 6, kCast), 16.0);
  EXPECT_EQ(encode_parameter(18000, 9, kCast), 18000.0F);
}

TEST(ParameterValue, ComesBackAsItWasForEveryTypeThatFits) {
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    for (const ParameterEncoding encoding : {kCast, kBytewise}) {
      for (std::uint8_t type = 1; type <= 6; ++type) {
        const bool is_signed = type % 2 == 0;
        const double whole = std::round(random.uniform(is_signed ? -128.0 : 0.0, 127.0));
        EXPECT_EQ(decode_parameter(encode_parameter(whole, type, encoding), type, encoding), whole);
      }
      const auto real = static_cast<float>(random.uniform(-1e6, 1e6));
      EXPECT_EQ(
          decode_parameter(encode_parameter(static_cast<double>(real), 9, encoding), 9, encoding),
          static_cast<double>(real));
    }
  }
}

TEST(ParameterValue, StaysInTheRangeOfItsType) {
  EXPECT_EQ(decode_parameter(encode_parameter(300, 2, kBytewise), 2, kBytewise), 127.0);
  EXPECT_EQ(decode_parameter(encode_parameter(-4, 1, kCast), 1, kCast), 0.0);
  EXPECT_TRUE(std::isnan(decode_parameter(1.0F, 8, kBytewise))) << "eight bytes do not fit";
}

TEST(ParameterName, FillsItsFieldWithoutAnEnd) {
  EXPECT_EQ(parameter_name(parameter_id("GUID_TIMEOUT")), "GUID_TIMEOUT");
  EXPECT_EQ(parameter_name(parameter_id("SIXTEEN_LETTERS_")), "SIXTEEN_LETTERS_");
  EXPECT_EQ(parameter_name(parameter_id("SIXTEEN_LETTERS_AND_MORE")), "SIXTEEN_LETTERS_");
}

}  // namespace
}  // namespace vantage::wire::mavlink
