#include "bus/convert/wire_walk.hpp"

#include <array>
#include <random>

#include "test/bus/convert/flat_message.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"

namespace vantage::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::size_t kFingerprintBytes = 8;

/// Changes `bytes` as networks, other versions and attackers may do. The fingerprint is never
/// changed, because its check is tested separately.
void mutate(Bytes& bytes, std::mt19937_64& rng) {
  const auto pick = [&](std::size_t below) {
    return std::uniform_int_distribution<std::size_t>(0, below - 1)(rng);
  };
  constexpr std::array<std::uint32_t, 10> kNasty{
      0, 1, 0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, 0x80000001, 0x10000, 0x00FFFFFF, 2, 0xFFFFFFFE};
  const std::size_t body = bytes.size() - kFingerprintBytes;
  switch (pick(6)) {
    case 0:  // one bit flips
      bytes[kFingerprintBytes + pick(body)] ^= static_cast<std::uint8_t>(1U << pick(8));
      break;
    case 1:  // one byte changes
      bytes[kFingerprintBytes + pick(body)] = static_cast<std::uint8_t>(pick(256));
      break;
    case 2:
    case 3: {  // 32 bits change: lengths and counts have this size
      const std::uint32_t value = kNasty[pick(kNasty.size())];
      const std::size_t at = kFingerprintBytes + pick(body - 3);
      for (std::size_t i = 0; i < 4; ++i) {
        bytes[at + i] = static_cast<std::uint8_t>(value >> (24U - 8U * i));
      }
      break;
    }
    case 4:  // the end is cut off
      bytes.resize(kFingerprintBytes + pick(body));
      break;
    default:  // random bytes are appended
      bytes.resize(bytes.size() + 1 + pick(64), static_cast<std::uint8_t>(pick(256)));
  }
}

template <class Message>
class Decoding : public ::testing::Test {};
TYPED_TEST_SUITE(Decoding, test::MessageTypes);

// Decodes 3 000 mutations of each of 11 types. The walk must accept exactly the messages that
// lcm-gen's decoder consumes completely. from_wire must handle all of them; sanitizers detect
// errors.
TYPED_TEST(Decoding, AgreesWithTheGeneratedDecoderOnMutatedMessages) {
  using Wire = WireOf<TypeParam>;
  const WireSchema* schema = find_wire_schema(Wire::getTypeName());
  ASSERT_NE(schema, nullptr);
  std::mt19937_64 rng(20'260'101);
  test::Sampler sampler(4);
  int passed = 0;
  int stopped = 0;
  for (int i = 0; i < 3'000; ++i) {
    Bytes bytes = test::encoded(test::sample<TypeParam>(sampler));
    for (std::size_t n = 1 + rng() % 3; n > 0 && bytes.size() > kFingerprintBytes + 4; --n) {
      mutate(bytes, rng);
    }
    const bool is_sound =
        is_well_formed(*schema, std::span<const std::uint8_t>(bytes).subspan(kFingerprintBytes));
    const auto wire = decode_wire<Wire>(bytes);
    ASSERT_EQ(wire.has_value(), is_sound);
    ++(is_sound ? passed : stopped);
    if (wire) {
      ASSERT_EQ(static_cast<std::size_t>(wire->getEncodedSize()), bytes.size());
      const auto message = from_wire(*wire);
      if (message) {
        // An accepted message, once encoded, is accepted again and does not change.
        const auto again = from_wire(to_wire(*message));
        ASSERT_TRUE(again.has_value());
        ASSERT_EQ(test::Flat::of(*again), test::Flat::of(*message));
      }
    }
  }
  EXPECT_GT(passed, 100);
  EXPECT_GT(stopped, 100);
}

TYPED_TEST(Decoding, RefusesEveryTruncationAndEveryExtension) {
  test::Sampler sampler(5);
  for (int i = 0; i < 3; ++i) {
    const Bytes whole = test::encoded(test::sample<TypeParam>(sampler));
    for (std::size_t size = 0; size < whole.size(); ++size) {
      ASSERT_FALSE(decode_wire<WireOf<TypeParam>>(std::span(whole).first(size)).has_value());
    }
    Bytes longer = whole;
    longer.push_back(0);
    EXPECT_FALSE(decode_wire<WireOf<TypeParam>>(longer).has_value());
  }
}

TYPED_TEST(Decoding, RefusesAnotherFingerprint) {
  test::Sampler sampler(6);
  Bytes bytes = test::encoded(test::sample<TypeParam>(sampler));
  for (std::size_t i = 0; i < kFingerprintBytes; ++i) {
    bytes[i] ^= 1U;
    EXPECT_FALSE(decode_wire<WireOf<TypeParam>>(bytes).has_value());
    bytes[i] ^= 1U;
  }
  EXPECT_TRUE(decode_wire<WireOf<TypeParam>>(bytes).has_value());
}

/// True if an attack_t with the count `num_jammed`, followed by `rest`, is well-formed.
bool is_attack_well_formed(std::uint32_t num_jammed, const Bytes& rest) {
  Bytes body(24, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    body.push_back(static_cast<std::uint8_t>(num_jammed >> (24U - 8U * i)));
  }
  body.insert(body.end(), rest.begin(), rest.end());
  return is_well_formed(*find_wire_schema("attack_t"), body);
}

TEST(IsWellFormed, RefusesLengthsThatCrashTheGeneratedDecoder) {
  const Bytes one_name{0, 0, 0, 2, 'Q', 0};
  EXPECT_TRUE(is_attack_well_formed(0, {}));
  EXPECT_TRUE(is_attack_well_formed(1, one_name));
  EXPECT_FALSE(is_attack_well_formed(0xFFFFFFFF, one_name)) << "count -1";
  EXPECT_FALSE(is_attack_well_formed(0x7FFFFFFF, one_name)) << "count 2^31-1";
  EXPECT_FALSE(is_attack_well_formed(2, one_name)) << "one too many";
  EXPECT_FALSE(is_attack_well_formed(0, one_name)) << "bytes are left over";
  EXPECT_FALSE(is_attack_well_formed(1, {0, 0, 0, 0})) << "string length 0";
  EXPECT_FALSE(is_attack_well_formed(1, {0x80, 0, 0, 0, 0})) << "string length INT_MIN";
  EXPECT_FALSE(is_attack_well_formed(1, {0xFF, 0xFF, 0xFF, 0xFF, 0})) << "string length -1";
  EXPECT_FALSE(is_attack_well_formed(1, {0, 0, 0, 9, 'Q', 0})) << "string beyond the end";
  EXPECT_FALSE(is_attack_well_formed(1, {0, 0, 0, 2, 'Q', 'R'})) << "string without NUL";
}

constexpr WireDim kNoDim{1, -1};
constexpr std::array<WireDim, kWireDims> kScalar{kNoDim, kNoDim, kNoDim, kNoDim};

constexpr WireField whole_number(std::int32_t bytes) {
  return {WireKind::kInteger, bytes, nullptr, kScalar, "n", WireNumber::kNone, 0};
}
/// Returns a field of byte elements: `bytes` per element, the number of elements given by the
/// dimensions.
constexpr WireField elements_of(std::int32_t bytes, WireDim first, WireDim second = kNoDim) {
  return {WireKind::kBytes,  bytes, nullptr, {first, second, kNoDim, kNoDim}, "e",
          WireNumber::kNone, 1};
}

bool fits(const std::vector<WireField>& fields, const Bytes& body) {
  return is_well_formed({"made up", fields}, body);
}

// An integer of any width and either sign can be a count; the schema states which integer is the
// count.
TEST(IsWellFormed, AcceptsCountsOfEachIntegerWidth) {
  for (const std::int32_t width : {1, 2, 4, 8}) {
    const std::vector<WireField> fields{whole_number(1), whole_number(width),
                                        elements_of(3, {0, 1})};
    for (const int count : {-2, -1, 0, 1, 2, 30}) {
      for (int elements = 0; elements < 40; ++elements) {
        Bytes body{77};
        for (std::int32_t i = width; i > 0; --i) {
          body.push_back(static_cast<std::uint8_t>(std::int64_t{count} >> (8 * (i - 1))));
        }
        body.resize(body.size() + static_cast<std::size_t>(3 * elements), 0xFF);
        EXPECT_EQ(fits(fields, body), count == elements) << width << ' ' << count;
      }
    }
  }
}

TEST(IsWellFormed, MultipliesDimensions) {
  const std::vector<WireField> fields{whole_number(1), whole_number(1),
                                      elements_of(2, {0, 0}, {0, 1})};
  for (std::uint8_t rows = 0; rows < 5; ++rows) {
    for (std::uint8_t columns = 0; columns < 5; ++columns) {
      for (std::size_t bytes = 0; bytes < 40; ++bytes) {
        Bytes body{rows, columns};
        body.resize(2 + bytes, 0);
        // A matrix with zero rows must also have zero columns, and conversely.
        const bool is_whole = rows * columns > 0 || rows + columns == 0;
        EXPECT_EQ(fits(fields, body), is_whole && bytes == 2U * rows * columns);
      }
    }
  }
  const std::vector<WireField> constant{whole_number(1), elements_of(2, {3, -1}, {0, 0})};
  EXPECT_TRUE(fits(constant, Bytes(1 + 3 * 2 * 1, 1)));
  EXPECT_FALSE(fits(constant, Bytes(1 + 3 * 2 * 2, 1)));
}

// 2¹⁶ · 2¹⁶ · 2¹⁶ · 2¹⁶ is 2⁶⁴, which is 0 in 64 bits; so is 2³³ · 2³¹.
TEST(IsWellFormed, RefusesOverflowingProducts) {
  WireField huge = elements_of(1, {65'536, -1}, {65'536, -1});
  huge.dims[2] = huge.dims[3] = {65'536, -1};
  EXPECT_FALSE(fits({huge}, {}));
  EXPECT_FALSE(fits({elements_of(1, {1 << 30, -1}, {1 << 30, -1})}, Bytes(16, 0)));
  EXPECT_TRUE(fits({elements_of(1, {0, -1}, {1 << 30, -1})}, {}));
}

// Without a limit, a short message could request any number of empty rows. The limit is the number
// of bytes of the message.
TEST(IsWellFormed, RefusesMoreEmptyRowsThanBytes) {
  const std::vector<WireField> fields{whole_number(2), whole_number(1),
                                      elements_of(8, {0, 0}, {0, 1}), elements_of(1, {5, -1})};
  for (std::uint8_t rows = 0; rows < 10; ++rows) {
    EXPECT_EQ(fits(fields, {0, rows, 0, 1, 2, 3, 4, 5}), rows <= 5) << int{rows};
  }
}

TEST(IsWellFormed, LimitsNestingToEightStructs) {
  for (const std::size_t depth : {1U, 8U, 9U}) {
    std::vector<std::vector<WireField>> fields(depth + 1);
    std::vector<WireSchema> schemas(depth + 1);
    fields[depth] = {whole_number(1)};
    schemas[depth] = {"inmost", fields[depth]};
    for (std::size_t i = depth; i > 0; --i) {
      fields[i - 1] = {{WireKind::kStruct, 1, &schemas[i], kScalar, "in", WireNumber::kNone, 0}};
      schemas[i - 1] = {"outer", fields[i - 1]};
    }
    EXPECT_EQ(is_well_formed(schemas[0], Bytes{5}), depth <= 8) << depth;
  }
}

TEST(IsWellFormed, AcceptsTheMaximumNumberOfFields) {
  EXPECT_TRUE(fits(std::vector<WireField>(256, whole_number(1)), Bytes(256, 0)));
  EXPECT_FALSE(fits(std::vector<WireField>(257, whole_number(1)), Bytes(257, 0)));
}

TEST(SignedValue, ExtendsTheSign) {
  constexpr std::uint64_t kBits = 0x8182'8384'8586'8788;
  EXPECT_EQ(signed_value(WireNumber::kInt8, kBits), std::int64_t{0x88} - (1 << 8));
  EXPECT_EQ(signed_value(WireNumber::kInt16, kBits), std::int64_t{0x8788} - (1 << 16));
  EXPECT_EQ(signed_value(WireNumber::kInt32, kBits),
            std::int64_t{0x8586'8788} - (std::int64_t{1} << 32));
  EXPECT_LT(signed_value(WireNumber::kInt64, kBits), 0);
  EXPECT_EQ(signed_value(WireNumber::kInt64, 1), 1);
  EXPECT_EQ(signed_value(WireNumber::kInt8, 0x7F), 127);
  EXPECT_EQ(signed_value(WireNumber::kInt16, 0x7FFF), 32'767);
}

TEST(FindWireSchema, FindsOnlyTypesOfVantage) {
  EXPECT_NE(find_wire_schema("target_belief_t"), nullptr);
  EXPECT_EQ(find_wire_schema("pose_t"), nullptr);
}

}  // namespace
}  // namespace vantage::bus
