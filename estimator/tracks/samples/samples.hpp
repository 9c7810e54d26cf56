#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "models/belief/mixture.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// Weighted samples of the position and velocity of one planar target with a belief that is not
/// Gaussian. Walls reflect each sample. An observation that did not report the target reduces the
/// weight of the samples in its view. Because no Gaussian approximation is made between steps, the
/// shape of the belief is preserved. After a detection, moments are sufficient
/// (docs/decisions/0023).
///
/// The samples are deterministic: samples and noise come from one table of points with exactly the
/// moments of N(0, I). The same operations at the same instants give the same samples. Copying an
/// empty object is cheap. Only parts() allocates.
/// Source: Gordon, Salmond, Smith, Novel approach to nonlinear/non-Gaussian Bayesian state
/// estimation (1993); systematic resampling: Kitagawa (1996).
class Samples {
 public:
  static constexpr int kCount = 256;
  using State = Eigen::Matrix<double, 4, 1, kUnaligned>;  ///< position [m], velocity [m/s]

  Samples() = default;
  Samples(const Samples& other) { *this = other; }
  Samples& operator=(const Samples& other);
  ~Samples() = default;

  /// True if the set is empty. The belief is then the Gaussian that the track stores.
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }
  /// Sets samples of N(mean, covariance), with exactly these moments. If the covariance is not
  /// positive definite, the set is empty afterwards.
  /// Precondition: 4 components.
  void spread(const models::Gaussian& belief);

  // The functions below require !empty().

  /// Returns mean and covariance, 4 components.
  [[nodiscard]] models::Gaussian moments() const;
  /// Returns the samples as a mixture of Gaussians. Starting with one part, the part with the
  /// largest weight times variance is split at its mean, across its widest direction. This ends
  /// when every part has at most `sigma_m` in every direction, or at kPartsMax parts. The weights
  /// sum to 1; the moments are moments(), apart from the kGrain terms. Allocates.
  [[nodiscard]] models::Mixture parts(double sigma_m) const;
  static constexpr int kPartsMax = 8;
  /// m² and m²/s²; added to each part's covariance, which is singular for few samples.
  static constexpr double kGrain_m2 = 0.01;
  static constexpr double kGrain_m2ps2 = 1e-4;
  /// Predicts the samples by dt_s with a model that has a velocity. `key` determines which noise
  /// each sample receives.
  void predict(const models::TargetModel& model, double dt_s, std::uint64_t key);
  /// Reflects samples outside of `bounds` at the walls, as often as needed.
  void turn_back(const models::Rectangle& bounds);
  /// Removes samples inside obstacles. Returns false and changes nothing if no sample would remain.
  bool keep_out_of(const std::vector<models::Obstacle>& obstacles);
  /// Uses an observation from `from` that did not report the target: multiplies the weight of each
  /// sample in view and in line of sight by 1 − p_D. Returns false if no such sample exists.
  bool miss(const models::SensorModel& sensor, const models::Viewpoint& from,
            const models::World& world, double detection_probability);
  /// Uses a measurement of the target. Returns false and changes nothing in two cases: the
  /// effective number of samples would be below kExplainMin, or all samples are farther than
  /// gate_sigma (> 0), in σ of the noise, from the measurement. The caller must then use the
  /// moments.
  bool measure(const models::SensorModel& sensor, const models::Viewpoint& from,
               const models::Measurement& measurement, double gate_sigma);
  /// Applies collisions with another target, whose centre stays at least `distance_m` away. Each
  /// sample is paired with a sample of `others`, drawn in proportion to its weight; `key`
  /// determines the pairs. A sample that reaches its partner within the next dt_s is reflected: the
  /// x or y component of its velocity is reversed, whichever makes it move away. The partner's
  /// velocity is unchanged. The sample is moved such that a prediction by dt_s gives its position
  /// after the collision. Returns false and changes nothing if no sample collides.
  bool collide_with(const Samples& others, double distance_m, double dt_s, std::uint64_t key);
  /// Smallest effective sample size for which measure() succeeds.
  static constexpr double kExplainMin = 32.0;

 private:
  template <class Likelihood>
  std::array<double, kCount> weighed(const Likelihood& likelihood) const;
  /// Normalises and sets the weights. Returns false if the effective number of samples is below
  /// `least`. If this number is below half of kCount, the samples are resampled.
  bool take(std::array<double, kCount> weights, double least);
  /// Separates the duplicates made by resampling.
  /// Source: Musso, Oudjane, Le Gland, Improving regularised particle filters (2001).
  void regularise();

  int size_ = 0;  ///< number of samples, 0 or kCount; if 0, the other members are undefined
  std::array<double, kCount> weights_{};
  std::array<State, kCount> states_;
};

}  // namespace vantage::estimator
