#pragma once

#include <cmath>

#include "planner/problem/block_kernels.hpp"

namespace vantage::planner {

/// What one look can tell at most, over everything within reach: M ⪯ `all_round` I + Σ rank-one
/// terms, `pointed_count` of them, whose strengths add up to `pointed`. In m⁻².
struct LookBound {
  double all_round = 0.0;
  double pointed = 0.0;
  int pointed_count = 0;

  [[nodiscard]] double strongest() const { return all_round + pointed; }
  /// ½ tr M of a planar target.
  [[nodiscard]] double average() const { return all_round + 0.5 * pointed; }
};

/// The most that looks in the best of directions can make of a planar target that stays: with
/// a ≤ b the eigenvalues of the information at hand (all-round looks added to both) and E the sum
/// of the pointed looks, det Ω ≤ (a + E) b after one look or while a + E ≤ b, and ((a + b + E)/2)²
/// else; tr Ω = a + b + E. The bound is met: any such Ω is a sum of two or more equal looks.
/// Source: Fiedler 1971 (determinant of a sum), Schur–Horn (directions that attain it).
class PointedInformation {
 public:
  PointedInformation() = default;
  /// Of a planar block [Pxx Pxy Pyy], definite.
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

  /// Greatest det Ω.
  [[nodiscard]] double determinant() const {
    const double tilted = least_ + pointed_;
    if (pointed_count_ <= 1 || tilted <= greatest_) {
      return tilted * greatest_;
    }
    const double mean = 0.5 * (tilted + greatest_);
    return mean * mean;
  }
  /// Least tr Ω⁻¹.
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
