#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace vantage::python {

/// Simulated attack: temporary loss of some robots' sensors.
struct JammerSpec {
  int attacks = 0;        ///< α: number of robots jammed simultaneously
  int period_steps = 25;  ///< steps; time after which the attacker chooses the robots again
  /// true: jam the robots that observed most in the last period; false: random
  bool is_greedy = true;
};

/// Contiguous part of an observation.
struct ObservationPart {
  std::string name;
  std::vector<int> shape;  ///< row-major; the product is the number of entries
};

/// Cooperative task in discrete steps: each robot chooses one of its controls, all robots move and
/// observe, and the team receives a reward for its information. Base of the Python environments. An
/// episode depends only on the seed and the actions. Not thread-safe.
class TeamTask {
 public:
  TeamTask(int robots, int steps_max, const JammerSpec& jammer);
  virtual ~TeamTask() = default;
  TeamTask(const TeamTask&) = delete;
  TeamTask& operator=(const TeamTask&) = delete;
  TeamTask(TeamTask&&) = delete;
  TeamTask& operator=(TeamTask&&) = delete;

  /// Starts a new episode. All random numbers depend only on `seed`.
  void reset(std::uint64_t seed);
  /// Performs one step and returns the team's reward. Precondition: one action per robot, each in
  /// [0, actions()).
  double step(std::span<const std::int64_t> actions);

  [[nodiscard]] int robots() const { return robots_; }
  /// Returns the seed of the current episode.
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] int steps_max() const { return steps_max_; }
  /// True after the last step of an episode, until reset().
  [[nodiscard]] bool is_over() const { return steps_ >= steps_max_; }
  /// Returns one entry per robot; non-zero: the sensor is jammed at present.
  [[nodiscard]] const std::vector<char>& jammed() const { return jammed_; }

  [[nodiscard]] virtual int actions() const = 0;
  /// Returns the parts of one robot's observation, in order.
  [[nodiscard]] virtual std::vector<ObservationPart> observation_parts() const = 0;
  [[nodiscard]] virtual int observation_size() const = 0;
  /// Writes the observation of `robot`, entries in [−1, 1]; `out` has observation_size() entries.
  virtual void observe(int robot, std::span<float> out) const = 0;
  /// Writes the observations of all robots in order. Precondition: `out` has robots() ·
  /// observation_size() entries.
  void observe(std::span<float> out) const;
  /// Returns the entropy, nats: in tracking, the mean over the targets; in mapping, the map's
  /// entropy.
  [[nodiscard]] virtual double entropy_nats() const = 0;

 protected:
  virtual void on_reset(std::uint64_t seed) = 0;
  /// Moves the robots and simulates their observations. Adds the amount that each robot observed to
  /// seen(). Returns the reward.
  virtual double on_step(std::span<const std::int64_t> actions) = 0;
  [[nodiscard]] std::vector<double>& seen() { return seen_; }

 private:
  void choose_jammed();

  int robots_;
  int steps_max_;
  JammerSpec jammer_;
  std::uint64_t seed_ = 0;
  int steps_ = 0;
  std::vector<char> jammed_;
  std::vector<double> seen_;  ///< amount observed in the current period, by robot
  std::mt19937_64 attacker_;
};

/// @throws UsageError unless there is one valid action for each robot of `tasks` tasks like `task`.
void require_actions(std::span<const std::int64_t> actions, std::size_t tasks,
                     const TeamTask& task);

}  // namespace vantage::python
