#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "wire/crtp/tables.hpp"

namespace vantage::wire::crtp {
namespace {

using ByteList = std::vector<std::uint8_t>;

ByteList payload_of(const Packet& packet) {
  return {packet.payload().begin(), packet.payload().end()};
}

TEST(CrtpTables, MatchTheReferenceBytes) {
  EXPECT_EQ(payload_of(toc_info_request(Port::kLog)), ByteList({3}));
  EXPECT_EQ(payload_of(toc_item_request(Port::kParameter, 0x0102)), ByteList({2, 2, 1}));
  EXPECT_EQ(payload_of(parameter_read(0x0102)), ByteList({2, 1}));
  EXPECT_EQ(payload_of(*parameter_write(5, ValueType::kF32, 1.0)),
            ByteList({5, 0, 0, 0, 0x80, 0x3f}));
  EXPECT_EQ(payload_of(*parameter_write(5, ValueType::kU8, 2.0)), ByteList({5, 0, 2}));
  const std::array<LogVariable, 2> variables{{{7, ValueType::kF32}, {0x0108, ValueType::kF16}}};
  EXPECT_EQ(payload_of(*log_create(1, variables)), ByteList({6, 1, 7, 7, 0, 8, 8, 1}));
  EXPECT_EQ(payload_of(log_start(1, 50)), ByteList({8, 1, 50, 0}));
  EXPECT_EQ(payload_of(log_stop(1)), ByteList({4, 1}));
  EXPECT_EQ(payload_of(log_delete(1)), ByteList({2, 1}));
}

TEST(CrtpTables, TableRoundTrips) {
  for (const Port port : {Port::kParameter, Port::kLog}) {
    const TocInfo info{380, 0xDEADBEEF};
    EXPECT_EQ(decode_toc_info(port, toc_info_reply(port, info)), info);
    TocItem item{300, ValueType::kI16, port == Port::kParameter, "stabilizer", "estimator"};
    EXPECT_EQ(decode_toc_item(port, *toc_item_reply(port, item)), item);
    const Packet reply = *toc_item_reply(port, item);
    EXPECT_EQ(reply.size, 4 + 11 + 10) << "both names end with a 0";
    EXPECT_EQ(reply.data[reply.size - 1U], 0);
    item.group = "a_group_name_that_is_long";
    EXPECT_FALSE(toc_item_reply(port, item));
  }
}

TEST(CrtpTables, ReadsTheAnswersOfTheFirmware) {
  Packet answer = parameter_read(9);
  answer.data = {9, 0, 0, 2};
  answer.size = 4;
  EXPECT_EQ(decode_parameter_reply(answer, ValueType::kU8)->value, 2.0);
  answer.data = {9, 0, 2};
  answer.size = 3;
  EXPECT_FALSE(decode_parameter_reply(answer, ValueType::kU8)->value) << "unknown parameter";
  answer.channel = 2;
  EXPECT_EQ(decode_parameter_reply(answer, ValueType::kU8)->value, 2.0) << "the written value";
  EXPECT_FALSE(decode_parameter_reply(answer, ValueType::kF32)->value) << "unknown parameter";
  answer.size = 2;
  EXPECT_FALSE(decode_parameter_reply(answer, ValueType::kU8));
  EXPECT_FALSE(decode_toc_item(Port::kLog, toc_item_request(Port::kLog, 1)));
}

TEST(CrtpTables, RefusesValuesOutsideTheRangeOfTheType) {
  EXPECT_TRUE(parameter_write(1, ValueType::kU8, 255.0));
  for (const double bad :
       {256.0, -1.0, 0.5, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(parameter_write(1, ValueType::kU8, bad)) << bad;
  }
  EXPECT_FALSE(parameter_write(1, ValueType::kF32, std::nan("")));
  EXPECT_FALSE(parameter_write(1, ValueType::kF32, 1e39));
  EXPECT_FALSE(parameter_write(1, ValueType::kF16, 1e6));
  EXPECT_TRUE(parameter_write(1, ValueType::kI16, -32768.0));
}

TEST(CrtpTables, LogBlockContainsAtMost26Bytes) {
  std::vector<LogVariable> variables(13, {1, ValueType::kF16});
  EXPECT_FALSE(log_create(1, variables)) << "13 variables need 41 bytes of request";
  variables.assign(6, {1, ValueType::kF32});
  EXPECT_TRUE(log_create(1, variables));
  variables.push_back({1, ValueType::kF32});
  EXPECT_FALSE(log_create(1, variables)) << "28 bytes of values";
}

TEST(CrtpTables, ValuesRoundTrip) {
  const std::array<std::pair<ValueType, double>, 8> values{{{ValueType::kU8, 200.0},
                                                            {ValueType::kU16, 60000.0},
                                                            {ValueType::kU32, 4e9},
                                                            {ValueType::kI8, -100.0},
                                                            {ValueType::kI16, -30000.0},
                                                            {ValueType::kI32, -2e9},
                                                            {ValueType::kF32, -0.125},
                                                            {ValueType::kF16, 0.5}}};
  ByteList bytes;
  for (const auto& [type, value] : values) {
    append_value(bytes, type, value);
  }
  Bytes rest(bytes);
  for (const auto& [type, value] : values) {
    EXPECT_EQ(take_value(rest, type), value);
  }
  EXPECT_TRUE(rest.empty());
  EXPECT_FALSE(take_value(rest, ValueType::kU8));
}

TEST(CrtpTables, ReadsLogData) {
  Packet packet = log_stop(1);
  packet.channel = 2;
  packet.data = {3, 0x01, 0x02, 0x03, 9};
  packet.size = 5;
  const auto data = decode_log_data(packet);
  ASSERT_TRUE(data);
  EXPECT_EQ(data->block, 3);
  EXPECT_EQ(data->since_boot_ms, 0x030201U);
  EXPECT_EQ(data->values.size(), 1U);
  packet.size = 3;
  EXPECT_FALSE(decode_log_data(packet));
}

}  // namespace
}  // namespace vantage::wire::crtp
