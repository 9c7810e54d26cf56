// Tests values and names in parameter messages, as encoded by each of the two autopilots.

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

TEST(ParameterMessages, HaveTheChecksumsOfTheirDefinitions) {
  EXPECT_EQ(find_message(20)->crc_extra, 214);
  EXPECT_EQ(find_message(22)->crc_extra, 220);
  EXPECT_EQ(find_message(23)->crc_extra, 168);
}

TEST(ParameterValue, Px4SendsTheBytesOfAnInteger) {
  EXPECT_EQ(std::bit_cast<std::uint32_t>(encode_parameter(15, 6, kBytewise)), 15U);
  EXPECT_EQ(decode_parameter(std::bit_cast<float>(15U), 6, kBytewise), 15.0);
  EXPECT_EQ(decode_parameter(std::bit_cast<float>(0xFFFF'FFFFU), 6, kBytewise), -1.0);
  EXPECT_EQ(decode_parameter(std::bit_cast<float>(0xFFU), 2, kBytewise), -1.0);
  EXPECT_EQ(decode_parameter(std::bit_cast<float>(0xFFU), 1, kBytewise), 255.0);
  EXPECT_FLOAT_EQ(static_cast<float>(decode_parameter(0.5F, 9, kBytewise)), 0.5F);
}

TEST(ParameterValue, ArdupilotSendsAnIntegerAsFloat) {
  EXPECT_EQ(encode_parameter(16, 6, kCast), 16.0F);
  EXPECT_EQ(decode_parameter(16.0F, 6, kCast), 16.0);
  EXPECT_EQ(encode_parameter(18000, 9, kCast), 18000.0F);
}

TEST(ParameterValue, RoundTripsForEveryType) {
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

TEST(ParameterValue, CoversTheRangeOfEachIntegerType) {
  struct Row {
    std::uint8_t type;
    double min;
    double max;
  };
  for (const Row& row : {Row{1, 0.0, 255.0}, Row{2, -128.0, 127.0}, Row{3, 0.0, 65'535.0},
                         Row{4, -32'768.0, 32'767.0}, Row{5, 0.0, 4'294'967'295.0},
                         Row{6, -2'147'483'648.0, 2'147'483'647.0}}) {
    const auto bytewise = [&row](double value) {
      return decode_parameter(encode_parameter(value, row.type, kBytewise), row.type, kBytewise);
    };
    EXPECT_EQ(bytewise(row.min), row.min) << int{row.type};
    EXPECT_EQ(bytewise(row.max), row.max) << int{row.type};
    EXPECT_EQ(bytewise(row.min - 1.0), row.min) << int{row.type};
    EXPECT_EQ(bytewise(row.max + 1.0), row.max) << int{row.type};
    EXPECT_EQ(bytewise(41.6), 42.0) << "rounded";
    EXPECT_EQ(encode_parameter(row.min - 1e3, row.type, kCast), static_cast<float>(row.min));
    EXPECT_EQ(encode_parameter(row.max + 1e3, row.type, kCast), static_cast<float>(row.max));
    EXPECT_EQ(encode_parameter(41.6, row.type, kCast), 42.0F);
  }
  for (const int number : {0, 7, 8, 10}) {
    const auto type = static_cast<std::uint8_t>(number);
    EXPECT_TRUE(std::isnan(decode_parameter(1.0F, type, kBytewise))) << int{type};
    EXPECT_EQ(decode_parameter(1.5F, type, kCast), 1.5) << int{type};
  }
}

TEST(ParameterName, MayFillItsFieldWithoutATerminator) {
  EXPECT_EQ(parameter_name(parameter_id("GUID_TIMEOUT")), "GUID_TIMEOUT");
  EXPECT_EQ(parameter_name(parameter_id("SIXTEEN_LETTERS_")), "SIXTEEN_LETTERS_");
  EXPECT_EQ(parameter_name(parameter_id("SIXTEEN_LETTERS_AND_MORE")), "SIXTEEN_LETTERS_");
}

}  // namespace
}  // namespace vantage::wire::mavlink
