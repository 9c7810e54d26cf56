// log and pow without fused multiply-add, identical on every processor. musl selects other formulas
// for both at compile time where the processor has this instruction (aarch64), so its functions
// differ between processors in the last bit. The other functions of core/libm do not.
//
// The tables are musl's: sub-interval i of [0.69, 1.38) has a point c_i with table entries for
// 1 / c_i and log c_i. With x = 2^k z and z in sub-interval i,
//   log x = k log 2 + log c_i + log(1 + r),  r = z / c_i - 1,
// where a polynomial approximates log(1 + r). The order of operations decides the last bit; it is
// the order of musl on processors without the instruction. Source: S. Nagy, "Arm optimized
// routines", 2018; errors are below 0.52 (log) and 0.53 (pow) units in the last place.

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

extern "C" {
struct LogTables {
  double log2_high;
  double log2_low;
  std::array<double, 5> polynomial;
  std::array<double, 11> near_one;  // polynomial for |x - 1| < 1/16
  struct Entry {
    double inverse;  // 1 / c
    double log;      // log c
  };
  std::array<Entry, 128> entries;
};
struct PowTables {
  double log2_high;
  double log2_low;
  std::array<double, 7> polynomial;
  struct Entry {
    double inverse;
    double unused;
    double log;
    double log_rest;  // log c minus its rounded value
  };
  std::array<Entry, 128> entries;
};
struct ExpTables {
  double parts_per_log2;  // 128 / log 2
  double shift;           // 1.5 · 2^52: adding and subtracting it rounds to an integer
  double minus_log2_high;
  double minus_log2_low;
  std::array<double, 4> polynomial;
  double exp2_shift;
  std::array<double, 5> exp2_polynomial;
  struct Entry {
    std::uint64_t rest_bits;   // 2^(i/128) / (its rounded value) - 1
    std::uint64_t power_bits;  // rounded 2^(i/128), minus i · 2^45
  };
  std::array<Entry, 128> entries;
};
extern const LogTables vantage_log_tables;
extern const PowTables vantage_pow_tables;
extern const ExpTables vantage_exp_tables;
double vantage_log(double x) noexcept;
double vantage_pow(double x, double y) noexcept;
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kSignBit = 1ULL << 63U;
constexpr std::uint64_t kInfinityBits = 0x7FFULL << 52U;
constexpr std::uint64_t kOneBits = 0x3FFULL << 52U;
constexpr std::uint64_t kExponentField = 0xFFFULL << 52U;

std::uint64_t to_bits(double value) { return std::bit_cast<std::uint64_t>(value); }
double from_bits(std::uint64_t bits) { return std::bit_cast<double>(bits); }
double invalid() { return std::numeric_limits<double>::quiet_NaN(); }

/// c_i as a sum of two doubles, computed from the table's 1 / c_i.
struct Center {
  double high;
  double low;
};

Center center_of(double inverse) {
  const double high = 1.0 / inverse;
  // Factors are split into halves of 26 bits with exact products, so 1 - high * inverse is exact.
  constexpr double kSplit = 134'217'729.0;  // 2^27 + 1
  const double a = kSplit * high - (kSplit * high - high);
  const double b = kSplit * inverse - (kSplit * inverse - inverse);
  const double a_low = high - a;
  const double b_low = inverse - b;
  const double product = high * inverse;
  const double error = ((a * b - product) + a * b_low + a_low * b) + a_low * b_low;
  return {high, ((1.0 - product) - error) / inverse};
}

std::array<Center, 128> centers;

// Runs before the constructors of static objects, which may call log.
[[gnu::constructor(101)]] void compute_centers() {
  for (std::size_t i = 0; i < centers.size(); ++i) {
    centers[i] = center_of(vantage_log_tables.entries[i].inverse);
  }
}

/// x = 2^exponent * z, where z is in sub-interval `index`.
struct Reduced {
  std::uint64_t z_bits;
  std::size_t index;
  double exponent;
};

Reduced reduce(std::uint64_t x_bits, std::uint64_t first_bits) {
  const std::uint64_t offset = x_bits - first_bits;
  return {x_bits - (offset & kExponentField), (offset >> 45U) % 128,
          static_cast<double>(static_cast<std::int64_t>(offset) >> 52)};
}

/// Returns the bits of a subnormal x with an exponent below the normal range.
std::uint64_t normalized_bits(double x) {
  return (to_bits(x * 0x1p52) & ~kSignBit) - (52ULL << 52U);
}

double log_near_one(double x) {
  const auto& p = vantage_log_tables.near_one;
  const double r = x - 1.0;
  const double r2 = r * r;
  const double r3 = r * r2;
  const double tail =
      r3 * (p[1] + r * p[2] + r2 * p[3] +
            r3 * (p[4] + r * p[5] + r2 * p[6] + r3 * (p[7] + r * p[8] + r2 * p[9] + r3 * p[10])));
  // Compute r + p[0] r² as high + low; the square of r_high is exact.
  const double shifted = r * 0x1p27;
  const double r_high = r + shifted - shifted;
  const double r_low = r - r_high;
  const double square = r_high * r_high * p[0];
  const double high = r + square;
  double low = r - high + square;
  low += p[0] * r_low * (r_high + r);
  return (tail + low) + high;
}

/// A logarithm as a sum of two doubles.
struct LongLog {
  double high;
  double low;
};

LongLog long_log(std::uint64_t x_bits) {
  const PowTables& t = vantage_pow_tables;
  const Reduced x = reduce(x_bits, 0x3FE6955500000000ULL);
  const PowTables::Entry& entry = t.entries[x.index];
  // 1 / c has few bits: both products are exact, and so is r.
  const double z = from_bits(x.z_bits);
  const double z_high = from_bits((x.z_bits + (1ULL << 31U)) & ~0xFFFFFFFFULL);
  const double r_high = z_high * entry.inverse - 1.0;
  const double r_low = (z - z_high) * entry.inverse;
  const double r = r_high + r_low;

  const double constant = x.exponent * t.log2_high + entry.log;
  const double sum = constant + r;
  const double low1 = x.exponent * t.log2_low + entry.log_rest;
  const double low2 = constant - sum + r;
  const double half = t.polynomial[0] * r;
  const double half2 = r * half;
  const double half3 = r * half2;
  const double half_high = t.polynomial[0] * r_high;
  const double square = r_high * half_high;
  const double high = sum + square;
  const double low3 = r_low * (half + half_high);
  const double low4 = sum - high + square;
  const auto& p = t.polynomial;
  const double tail =
      half3 * (p[1] + r * p[2] + half2 * (p[3] + r * p[4] + half2 * (p[5] + r * p[6])));
  const double low = low1 + low2 + low3 + low4 + tail;
  const double result = high + low;
  return {result, high - result + low};
}

/// Returns power * (1 + rest) for results next to overflow and in the subnormal range, where the
/// exponent in `power_bits` has overflowed.
double scaled_near_limits(double rest, std::uint64_t power_bits, std::uint64_t steps) {
  if ((steps & 0x80000000U) == 0) {
    const double power = from_bits(power_bits - (1009ULL << 52U));
    return 0x1p1009 * (power + power * rest);
  }
  const std::uint64_t raised_bits = power_bits + (1022ULL << 52U);
  const double power = from_bits(raised_bits);
  double y = power + power * rest;
  if (y > -1.0 && y < 1.0) {
    // Rounds once, to the precision of the subnormal result.
    const double one = y < 0.0 ? -1.0 : 1.0;
    double low = power - y + power * rest;
    const double high = one + y;
    low = one - high + y + low;
    y = (high + low) - one;
    if (y == 0.0) {
      y = from_bits(raised_bits & kSignBit);
    }
  }
  return 0x1p-1022 * y;
}

/// Returns exp(x.high + x.low), with the sign bit set if `is_negative`.
double exp_of(const LongLog& x, bool is_negative) {
  const ExpTables& t = vantage_exp_tables;
  const std::uint64_t exponent = (to_bits(x.high) >> 52U) & 0x7FFU;
  constexpr std::uint64_t kTiny = 0x3C9;   // exponent of 2^-54
  constexpr std::uint64_t kLarge = 0x408;  // exponent of 512
  constexpr std::uint64_t kHuge = 0x409;   // exponent of 1024
  if (exponent < kTiny) {
    return is_negative ? -(1.0 + x.high) : 1.0 + x.high;
  }
  if (exponent >= kHuge) {
    const double limit = x.high < 0.0 ? 0.0 : kInfinity;
    return is_negative ? -limit : limit;
  }
  const double shifted = t.parts_per_log2 * x.high + t.shift;
  const std::uint64_t steps = to_bits(shifted);
  const double rounded = shifted - t.shift;
  double r = x.high + rounded * t.minus_log2_high + rounded * t.minus_log2_low;
  r += x.low;
  const ExpTables::Entry& entry = t.entries[steps % 128];
  const std::uint64_t sign_steps = is_negative ? 0x800ULL << 7U : 0;
  const std::uint64_t power_bits = entry.power_bits + ((steps + sign_steps) << 45U);
  const auto& p = t.polynomial;
  const double r2 = r * r;
  const double rest =
      from_bits(entry.rest_bits) + r + r2 * (p[0] + r * p[1]) + r2 * r2 * (p[2] + r * p[3]);
  if (exponent >= kLarge) {
    return scaled_near_limits(rest, power_bits, steps);
  }
  const double power = from_bits(power_bits);
  return power + power * rest;
}

enum class Parity { kNoInteger, kOdd, kEven };

Parity parity_of(std::uint64_t y_bits) {
  const auto exponent = static_cast<unsigned>((y_bits >> 52U) & 0x7FFU);
  if (exponent < 0x3FF) {
    return Parity::kNoInteger;
  }
  if (exponent > 0x3FF + 52) {
    return Parity::kEven;
  }
  const std::uint64_t unit = 1ULL << (0x3FF + 52 - exponent);
  if ((y_bits & (unit - 1)) != 0) {
    return Parity::kNoInteger;
  }
  return (y_bits & unit) != 0 ? Parity::kOdd : Parity::kEven;
}

bool is_zero_infinite_or_nan(std::uint64_t bits) { return 2 * bits - 1 >= 2 * kInfinityBits - 1; }

/// pow for y that is 0, infinite or NaN (IEEE 754, 9.2.1).
double pow_of_special_y(double x, double y) {
  const std::uint64_t x_bits = to_bits(x);
  const std::uint64_t y_bits = to_bits(y);
  if (2 * y_bits == 0 || x_bits == kOneBits) {
    return 1.0;
  }
  if (2 * x_bits > 2 * kInfinityBits || 2 * y_bits > 2 * kInfinityBits) {
    return x + y;
  }
  if (2 * x_bits == 2 * kOneBits) {
    return 1.0;
  }
  const bool is_small = 2 * x_bits < 2 * kOneBits;
  return is_small == (y < 0.0) ? kInfinity : 0.0;
}

/// pow for x that is 0, infinite or NaN, and ordinary y.
double pow_of_special_x(double x, double y) {
  double square = x * x;
  if ((to_bits(x) & kSignBit) != 0 && parity_of(to_bits(y)) == Parity::kOdd) {
    square = -square;
  }
  return y < 0.0 ? 1.0 / square : square;
}

}  // namespace

double vantage_log(double x) noexcept {
  const LogTables& t = vantage_log_tables;
  std::uint64_t x_bits = to_bits(x);
  constexpr std::uint64_t kNearLow = std::bit_cast<std::uint64_t>(1.0 - 0x1p-4);
  constexpr std::uint64_t kNearHigh = std::bit_cast<std::uint64_t>(1.0 + 0x1.09p-4);
  if (x_bits - kNearLow < kNearHigh - kNearLow) {
    return x_bits == kOneBits ? 0.0 : log_near_one(x);
  }
  constexpr std::uint64_t kSmallestNormal = 1ULL << 52U;
  if (x_bits - kSmallestNormal >= kInfinityBits - kSmallestNormal) {
    if (2 * x_bits == 0) {
      return -kInfinity;
    }
    if (x_bits == kInfinityBits || x != x) {
      return x;
    }
    if ((x_bits & kSignBit) != 0) {
      return invalid();
    }
    x_bits = normalized_bits(x);
  }
  const Reduced reduced = reduce(x_bits, 0x3FE6000000000000ULL);
  const LogTables::Entry& entry = t.entries[reduced.index];
  const Center& center = centers[reduced.index];
  const double r = (from_bits(reduced.z_bits) - center.high - center.low) * entry.inverse;
  const double constant = reduced.exponent * t.log2_high + entry.log;
  const double high = constant + r;
  const double low = constant - high + r + reduced.exponent * t.log2_low;
  const auto& p = t.polynomial;
  const double r2 = r * r;
  return low + r2 * p[0] + r * r2 * (p[1] + r * p[2] + r2 * (p[3] + r * p[4])) + high;
}

double vantage_pow(double x, double y) noexcept {
  std::uint64_t x_bits = to_bits(x);
  const std::uint64_t y_bits = to_bits(y);
  if (is_zero_infinite_or_nan(y_bits)) {
    return pow_of_special_y(x, y);
  }
  if (is_zero_infinite_or_nan(x_bits)) {
    return pow_of_special_x(x, y);
  }
  bool is_negative = false;
  if ((x_bits & kSignBit) != 0) {
    const Parity parity = parity_of(y_bits);
    if (parity == Parity::kNoInteger) {
      return invalid();
    }
    is_negative = parity == Parity::kOdd;
    x_bits &= ~kSignBit;
  }
  const std::uint64_t y_exponent = (y_bits >> 52U) & 0x7FFU;
  constexpr std::uint64_t kTinyY = 0x3BE;  // exponent of 2^-65; smaller y give 1
  constexpr std::uint64_t kHugeY = 0x43E;  // exponent of 2^63; larger y give 0, 1 or infinite
  if (y_exponent < kTinyY) {
    return 1.0;
  }
  if (y_exponent >= kHugeY) {
    if (x_bits == kOneBits) {
      return 1.0;
    }
    return (x_bits > kOneBits) == (y > 0.0) ? kInfinity : 0.0;
  }
  if (x_bits < (1ULL << 52U)) {
    x_bits = normalized_bits(x);
  }
  // Compute y * log x as a sum of two doubles. The first product is exact, because its factors have
  // 26 bits.
  constexpr std::uint64_t kUpperHalf = ~0ULL << 27U;
  const LongLog log = long_log(x_bits);
  const double y_high = from_bits(y_bits & kUpperHalf);
  const double y_low = y - y_high;
  const double log_high = from_bits(to_bits(log.high) & kUpperHalf);
  const double log_low = log.high - log_high + log.low;
  return exp_of({y_high * log_high, y_low * log_high + y * log_low}, is_negative);
}
