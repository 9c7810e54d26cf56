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

/// What is known of one target in the plane that no Gaussian tells: weighted samples of its
/// position and velocity. Walls turn each back, and looks that did not report it take weight from
/// those that they would have seen, with nothing smeared by being made a Gaussian again. Where
/// there is a detection, moments do (docs/decisions/0023).
///
/// Nothing is drawn: samples and noise come from one table of points whose moments are those of
/// N(0, I) exactly, and whoever does the same things at the same instants has the same samples. A
/// copy costs what is in it. Nothing allocates.
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

  /// Whether there are none: the belief is the Gaussian that stands beside it.
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }
  /// Samples of N(mean, covariance), with these moments. Precondition: 4 components; a covariance
  /// that is not positive definite leaves none.
  void spread(const models::Gaussian& belief);

  // The others need samples.

  /// Mean and covariance, 4 components.
  [[nodiscard]] models::Gaussian moments() const;
  /// The same in Gaussians: beginning with all in one, that whose weight times spread is largest is
  /// split through its middle along its widest direction, until none has more than `sigma_m` along
  /// any or there are kPartsMax. Their weights add up to 1, and their moments are moments() but for
  /// the grain. Allocates.
  [[nodiscard]] models::Mixture parts(double sigma_m) const;
  static constexpr int kPartsMax = 8;
  /// Added to each part's covariance, m² and m²/s²: of few samples it may have none of its own.
  static constexpr double kGrain_m2 = 0.01;
  static constexpr double kGrain_m2ps2 = 1e-4;
  /// By dt_s of a model with a velocity; `key` chooses which sample meets which noise.
  void predict(const models::TargetModel& model, double dt_s, std::uint64_t key);
  /// Who is outside of `bounds` has turned back there: mirrored, as often as needed.
  void turn_back(const models::Rectangle& bounds);
  /// Nobody is in an obstacle. False, and nothing changes, where nothing would be left.
  bool keep_out_of(const std::vector<models::Obstacle>& obstacles);
  /// A look from there that did not report the target: each weighs 1 − p_D of what it did where it
  /// is in view and in line of sight. False when none of them is.
  bool miss(const models::SensorModel& sensor, const models::Viewpoint& from,
            const models::World& world, double detection_probability);
  /// A measurement of the target. False, and nothing changes, where fewer than kExplainMin samples
  /// are left to speak of, or all are farther than gate_sigma (> 0) from it by its own noise: then
  /// only the moments can be used.
  bool measure(const models::SensorModel& sensor, const models::Viewpoint& from,
               const models::Measurement& measurement, double gate_sigma);
  /// Another target, whose middle comes no nearer than `distance_m`. To each sample belongs one of
  /// the others, of each more often the more it weighs; `key` says which. A sample that walks into
  /// its partner within the dt_s from now on turns back there, by the component of its velocity
  /// that takes it away; who is walked into goes on. It is put to where it has to be now for a
  /// prediction by dt_s to find it where it is then. False, and nothing changes, where none does.
  bool walk_into(const Samples& others, double distance_m, double dt_s, std::uint64_t key);
  /// As many as are needed to explain a measurement by samples, of equal weight.
  static constexpr double kExplainMin = 32.0;

 private:
  template <class Likelihood>
  std::array<double, kCount> weighed(const Likelihood& likelihood) const;
  /// Takes these weights, whatever their sum, unless they speak as fewer than `least` samples of
  /// equal weight would. Where they speak as fewer than half of all, heavy ones are doubled in the
  /// place of light ones.
  bool take(std::array<double, kCount> weights, double least);
  /// Moves doubles apart. Source: Musso, Oudjane, Le Gland, Improving regularised particle filters
  /// (2001).
  void smear();

  int size_ = 0;  ///< 0 or kCount; of none the others mean nothing
  std::array<double, kCount> weights_{};
  std::array<State, kCount> states_;
};

}  // namespace vantage::estimator
