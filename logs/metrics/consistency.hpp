#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace vantage::logs {

/// Consistency of an estimator, from normalised estimation errors squared (NEES) e = εᵀ Σ⁻¹ ε of
/// positions with n coordinates. If the estimator is consistent, e is χ² distributed: mean n,
/// median 1.39 (n = 2) or 2.37 (n = 3), and 95 % of the positions lie inside their 95 % ellipse.
/// Rare gross errors change the mean; the median describes the majority of the estimates.
struct Consistency {
  std::int64_t samples = 0;
  std::optional<double> mean_nees;
  std::optional<double> median_nees;  ///< median of e, accurate to 1 %
  std::optional<double> coverage_95;  ///< share inside the 95 % ellipse, in [0, 1]
};

/// Accumulator of a Consistency. Its memory does not grow with the number of samples.
class NeesSums {
 public:
  /// @param position_dim  number of coordinates n, 2 or 3
  explicit NeesSums(int position_dim) : position_dim_(position_dim) {}

  void add(double nees);
  [[nodiscard]] Consistency result() const;

 private:
  // The median comes from a histogram of log₁₀ e: 100 bins per decade, from 1e−4 to 1e6.
  static constexpr int kBinsPerDecade = 100;
  static constexpr int kLeastExponent = -4;
  static constexpr int kBins = 10 * kBinsPerDecade;

  int position_dim_;
  std::int64_t samples_ = 0;
  std::int64_t inside_ = 0;
  double sum_ = 0.0;
  std::array<std::int64_t, kBins> bins_{};
};

/// Classes of the time since any robot last saw a target. The belief states this time; class i
/// contains the ages kAgeEdges_s[i] ≤ age < kAgeEdges_s[i + 1].
inline constexpr std::array<double, 6> kAgeEdges_s = {
    0.0, 1.0, 2.0, 4.0, 8.0, std::numeric_limits<double>::infinity()};
inline constexpr std::size_t kAgeClasses = kAgeEdges_s.size() - 1;
/// Returns the index of the class; an age below 0 counts as 0.
std::size_t age_class(double age_s);
/// Returns the name of a class: "2-4" for class 2, "8+" for the last one.
std::string age_name(std::size_t age_class);

}  // namespace vantage::logs
