#include <bit>
#include <cmath>
#include <random>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/uniform.hpp"

// With every compiler, set of flags, processor and C library, sin, exp, log, … return exactly the
// bits below (docs/decisions/0014).

namespace {

/// FNV-1a hash of the bits of doubles.
class Digest {
 public:
  void add(double value) {
    for (auto bits = std::bit_cast<std::uint64_t>(value), i = std::uint64_t{8}; i-- > 0;
         bits >>= 8U) {
      digest_ = (digest_ ^ (bits & 0xFFU)) * 1'099'511'628'211U;
    }
  }
  [[nodiscard]] std::uint64_t value() const { return digest_; }

 private:
  std::uint64_t digest_ = 14'695'981'039'346'656'037U;
};

struct Function {
  std::string name;
  double (*of)(double);
  long double (*exactly)(long double);  ///< long double function of the C library
  double min;
  double max;
  double ulp;  ///< largest error, measured here and rounded up
  std::uint64_t digest;
};

struct Function2 {
  std::string name;
  double (*of)(double, double);
  long double (*exactly)(long double, long double);
  double min;
  double max;
  double ulp;
  std::uint64_t digest;
};

constexpr int kArguments = 20'000;

double ulp_between(double value, long double exactly) {
  const double nearest = std::abs(static_cast<double>(exactly));
  const long double ulp = static_cast<long double>(std::nextafter(nearest, HUGE_VAL)) -
                          static_cast<long double>(nearest);
  return static_cast<double>(std::abs(static_cast<long double>(value) - exactly) / ulp);
}

#define VANTAGE_FUNCTION(name) \
#name, [](double x) { return std::name(x); }, [](long double x) { return std::name(x); }
#define VANTAGE_FUNCTION2(name)                                      \
#name, [](double x,                                                \
            double y) { return std::name(x, y); }, [](long double x, \
                                                      long double y) { return std::name(x, y); }

const Function kFunctions[] = {
    {VANTAGE_FUNCTION(sin), -10, 10, 1.0, 9568898146922644910U},
    {VANTAGE_FUNCTION(sin), -1e9, 1e9, 1.0, 16579564061364543326U},
    {VANTAGE_FUNCTION(cos), -10, 10, 1.0, 5451038503381544436U},
    {VANTAGE_FUNCTION(cos), -1e9, 1e9, 1.0, 13438230631477354723U},
    {VANTAGE_FUNCTION(tan), -10, 10, 1.0, 7270790857174486753U},
    {VANTAGE_FUNCTION(asin), -1, 1, 1.0, 4430497940458766503U},
    {VANTAGE_FUNCTION(acos), -1, 1, 1.0, 2573379082945642957U},
    {VANTAGE_FUNCTION(atan), -20, 20, 1.0, 10535732334155221437U},
    {VANTAGE_FUNCTION(exp), -700, 700, 1.0, 697524755175246722U},
    {VANTAGE_FUNCTION(exp2), -1000, 1000, 1.0, 16821060683639917088U},
    {VANTAGE_FUNCTION(expm1), -2, 2, 1.0, 13223490389814046335U},
    {VANTAGE_FUNCTION(log), 1e-6, 20, 1.0, 16289179203447049991U},
    {VANTAGE_FUNCTION(log10), 1e-6, 20, 1.0, 11168935009434329536U},
    {VANTAGE_FUNCTION(log1p), -0.99, 20, 1.0, 15597485158151171464U},
    {VANTAGE_FUNCTION(erf), -3, 3, 1.0, 6300775271183389352U},
    {VANTAGE_FUNCTION(erfc), -3, 10, 2.2, 4057121933312279050U},
};

const Function2 kFunctions2[] = {
    {VANTAGE_FUNCTION2(atan2), -10, 10, 1.5, 3490917986210223642U},
    {VANTAGE_FUNCTION2(hypot), -10, 10, 1.0, 5080126860866788486U},
    {VANTAGE_FUNCTION2(pow), 0.01, 30, 1.0, 1585699178893781785U},
};

#undef VANTAGE_FUNCTION
#undef VANTAGE_FUNCTION2

TEST(Libm, ReturnsTheReferenceBits) {
  for (const Function& function : kFunctions) {
    std::mt19937_64 random(1);
    Digest digest;
    for (int i = 0; i < kArguments; ++i) {
      digest.add(function.of(vantage::uniform(random, function.min, function.max)));
    }
    EXPECT_EQ(digest.value(), function.digest) << function.name << " up to " << function.max;
  }
  for (const Function2& function : kFunctions2) {
    std::mt19937_64 random(1);
    Digest digest;
    for (int i = 0; i < kArguments; ++i) {
      const double x = vantage::uniform(random, function.min, function.max);
      const double y = vantage::uniform(random, function.min, function.max);
      digest.add(function.of(x, y));
    }
    EXPECT_EQ(digest.value(), function.digest) << function.name;
  }
}

TEST(Libm, ErrorIsWithinTheStatedNumberOfUlps) {
  for (const Function& function : kFunctions) {
    std::mt19937_64 random(2);
    double worst_ulp = 0.0;
    for (int i = 0; i < kArguments; ++i) {
      const double x = vantage::uniform(random, function.min, function.max);
      worst_ulp = std::max(
          worst_ulp, ulp_between(function.of(x), function.exactly(static_cast<long double>(x))));
    }
    EXPECT_LE(worst_ulp, function.ulp) << function.name << " up to " << function.max;
  }
  for (const Function2& function : kFunctions2) {
    std::mt19937_64 random(2);
    double worst_ulp = 0.0;
    for (int i = 0; i < kArguments; ++i) {
      const double x = vantage::uniform(random, function.min, function.max);
      const double y = vantage::uniform(random, function.min, function.max);
      worst_ulp = std::max(
          worst_ulp, ulp_between(function.of(x, y), function.exactly(static_cast<long double>(x),
                                                                     static_cast<long double>(y))));
    }
    EXPECT_LE(worst_ulp, function.ulp) << function.name;
  }
}

// At special arguments (zeros, infinities, NaN), the results are those that the C standard
// requires.
TEST(Libm, HandlesSpecialValues) {
  const double infinity = HUGE_VAL;
  EXPECT_TRUE(std::isnan(std::sin(infinity)));
  EXPECT_TRUE(std::isnan(std::log(-1.0)));
  EXPECT_EQ(std::log(0.0), -infinity);
  EXPECT_EQ(std::log1p(-1.0), -infinity);
  EXPECT_EQ(std::exp(1000.0), infinity);
  EXPECT_EQ(std::exp(-1000.0), 0.0);
  EXPECT_TRUE(std::isnan(std::acos(1.0 + 1e-15)));
  EXPECT_EQ(std::hypot(infinity, std::nan("")), infinity);
  EXPECT_DOUBLE_EQ(std::hypot(3e200, 4e200), 5e200);
  EXPECT_EQ(std::pow(0.0, 0.0), 1.0);
  EXPECT_EQ(std::pow(-2.0, 3.0), -8.0);
  EXPECT_TRUE(std::signbit(std::sin(-0.0)));
  EXPECT_EQ(std::atan2(0.0, -1.0), std::atan2(0.0, -2.0));
  EXPECT_EQ(std::sin(std::numeric_limits<double>::denorm_min()),
            std::numeric_limits<double>::denorm_min());
}

// Tests results at the limits of the range, and the special cases of pow in IEEE 754.
TEST(Libm, ReturnsExactValuesOfLogAndPow) {
  const double infinity = HUGE_VAL;
  const double nan = std::nan("");
  const double smallest = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(std::log(1.0), 0.0);
  EXPECT_EQ(std::log(infinity), infinity);
  EXPECT_EQ(std::log(smallest), -0x1.74385446d71c3p+9);
  const struct {
    double x, y, power;
  } rows[] = {
      {2.0, -1074.0, smallest},
      {2.0, -1076.0, 0.0},
      {2.0, 1023.0, 0x1p1023},
      {2.0, 1024.0, infinity},
      {-2.0, 1025.0, -infinity},
      {-2.0, -1073.0, -2.0 * smallest},
      {smallest, 0.5, 0x1p-537},
      {0x1p-1030, -0.5, 0x1p515},
      {0.0, -2.0, infinity},
      {-0.0, -3.0, -infinity},
      {infinity, -1.0, 0.0},
      {-infinity, 3.0, -infinity},
      {-infinity, 0.5, infinity},
      {-1.0, infinity, 1.0},
      {0.5, -infinity, infinity},
      {2.0, -infinity, 0.0},
      {nan, 0.0, 1.0},
      {1.0, nan, 1.0},
      {-3.0, 0x1p60, infinity},
      {-1.0, 0x1p53 - 1.0, -1.0},
      {3.0, 1e-30, 1.0},
      {1.0 + 0x1p-52, 0x1p63, infinity},
  };
  for (const auto& row : rows) {
    EXPECT_EQ(std::pow(row.x, row.y), row.power) << row.x << " to the power " << row.y;
  }
  EXPECT_TRUE(std::isnan(std::pow(-8.0, 1.0 / 3.0)));
  EXPECT_TRUE(std::isnan(std::pow(2.0, nan)));
}

// A compiler that folds constants would round correctly; the library's results may differ in the
// last bit. Constant arguments must therefore also use the library.
TEST(Libm, IsUsedForConstantArguments) {
  Digest folded;
  Digest computed;
  for (volatile double x : {0.1, 0.7, 2.5}) {
    computed.add(std::sin(x) + std::tan(x));
    computed.add(std::exp(x) + std::log(x));
    computed.add(std::pow(x, 1.7) + std::hypot(x, 0.3));
  }
  const auto add = [&folded](double a, double b, double c) {
    folded.add(a);
    folded.add(b);
    folded.add(c);
  };
  add(std::sin(0.1) + std::tan(0.1), std::exp(0.1) + std::log(0.1),
      std::pow(0.1, 1.7) + std::hypot(0.1, 0.3));
  add(std::sin(0.7) + std::tan(0.7), std::exp(0.7) + std::log(0.7),
      std::pow(0.7, 1.7) + std::hypot(0.7, 0.3));
  add(std::sin(2.5) + std::tan(2.5), std::exp(2.5) + std::log(2.5),
      std::pow(2.5, 1.7) + std::hypot(2.5, 0.3));
  EXPECT_EQ(folded.value(), computed.value());
}

// Templates of libraries (Eigen, <random>) call the same functions, without fused multiply-add.
TEST(Libm, IsUsedInLibraryTemplates) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Digest digest;
  for (int i = 0; i < 1000; ++i) {
    const double angle_rad = 3.0 * uniform(random);
    const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 0.5 * angle_rad, -0.3).normalized();
    const Eigen::Quaterniond q(Eigen::AngleAxisd(angle_rad, axis));
    digest.add(normal(random));
    digest.add((q * Eigen::Vector3d(0.1, 0.2, 0.3)).sum());
    digest.add(q.angularDistance(Eigen::Quaterniond::Identity()));
    digest.add(Eigen::Array3d(0.1, 0.2, 2.0 + angle_rad / 3.0).log().sum());
    digest.add(0.1 * angle_rad + 0.3 * axis.y() - axis.squaredNorm());
  }
  EXPECT_EQ(digest.value(), 13869564233415538209U);
}

}  // namespace
