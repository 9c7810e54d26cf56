#pragma once

#include <cmath>

#include "planner/problem/block_kernels.hpp"

namespace vantage::planner {

/// Bound of the information M of one measurement over all reachable positions, m⁻². M is at most a
/// sum of two parts. The part about the position is `all_round` I plus `pointed_count` rank-one
/// terms with total strength `pointed`. The part about a moving target's state is `of_state` I.
struct LookBound {
  double all_round = 0.0;
  double pointed = 0.0;
  int pointed_count = 0;
  double of_state = 0.0;

  /// Returns the largest information about the position, without `of_state`.
  [[nodiscard]] double strongest() const { return all_round + pointed; }
  /// Returns a bound of ½ tr M of a planar target.
  [[nodiscard]] double average() const { return all_round + 0.5 * pointed; }
};

/// Greatest information that measurements in the best directions can give about a static planar
/// target. Let a ≤ b be the eigenvalues of the present information plus the direction-independent
/// measurements, and E the sum of the non-zero eigenvalues of the rank-one measurements. Then det Ω
/// ≤ (a + E) b after one measurement or while a + E ≤ b, else ((a + b + E)/2)²; tr Ω = a + b + E.
/// The bound is attained: two or more rank-one measurements of equal strength can produce it.
/// Source: Fiedler 1971 (determinant of a sum), Schur–Horn (directions that attain it).
class PointedInformation {
 public:
  PointedInformation() = default;
  /// Starts with a planar block [Pxx Pxy Pyy], positive definite.
  explicit PointedInformation(const double* planar_block) {
    const double half = 0.5 * (planar_block[0] + planar_block[2]);
    const double difference = 0.5 * (planar_block[0] - planar_block[2]);
    const double largest = half + std::hypot(difference, planar_block[1]);
    least_ = 1.0 / largest;
    greatest_ = largest / det2(planar_block);
  }

  void add(const LookBound& look) {
    least_ += look.all_round;
    greatest_ += look.all_round;
    pointed_ += look.pointed;
    pointed_count_ += look.pointed_count;
  }

  /// Returns the greatest det Ω.
  [[nodiscard]] double determinant() const {
    const double tilted = least_ + pointed_;
    if (pointed_count_ <= 1 || tilted <= greatest_) {
      return tilted * greatest_;
    }
    const double mean = 0.5 * (tilted + greatest_);
    return mean * mean;
  }
  /// Returns the least tr Ω⁻¹.
  [[nodiscard]] double covariance_trace() const {
    return (least_ + greatest_ + pointed_) / determinant();
  }

 private:
  double least_ = 1.0;
  double greatest_ = 1.0;
  double pointed_ = 0.0;
  int pointed_count_ = 0;
};

}  // namespace vantage::planner
