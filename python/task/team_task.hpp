#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace vantage::python {

/// Who loses its sensor for a while.
struct JammerSpec {
  int attacks = 0;        ///< α: so many robots at once
  int period_steps = 25;  ///< then they are chosen anew
  bool is_greedy = true;  ///< those that saw most over the last period; else any
};

/// A stretch of an observation that belongs together.
struct ObservationPart {
  std::string name;
  std::vector<int> shape;  ///< row-major; its product is the number of entries
};

/// A cooperative task in steps: each robot chooses one of its controls, all move, all look, and the
/// team is rewarded for what it knows. What the environments of Python are made of; a pure function
/// of the seed and the actions. Not thread-safe.
class TeamTask {
 public:
  TeamTask(int robots, int steps_max, const JammerSpec& jammer);
  virtual ~TeamTask() = default;
  TeamTask(const TeamTask&) = delete;
  TeamTask& operator=(const TeamTask&) = delete;
  TeamTask(TeamTask&&) = delete;
  TeamTask& operator=(TeamTask&&) = delete;

  /// Begins again: everything random depends on `seed` alone.
  void reset(std::uint64_t seed);
  /// One step; the team's reward. Precondition: one action a robot, each in [0, actions()).
  double step(std::span<const std::int64_t> actions);

  [[nodiscard]] int robots() const { return robots_; }
  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] int steps_max() const { return steps_max_; }
  /// After the last step of an episode, until reset().
  [[nodiscard]] bool is_over() const { return steps_ >= steps_max_; }
  /// One entry a robot; not 0: it sees nothing now.
  [[nodiscard]] const std::vector<char>& jammed() const { return jammed_; }

  [[nodiscard]] virtual int actions() const = 0;
  /// Parts of one robot's observation, in order.
  [[nodiscard]] virtual std::vector<ObservationPart> observation_parts() const = 0;
  [[nodiscard]] virtual int observation_size() const = 0;
  /// What `robot` is told, each entry in [−1, 1]; `out` has observation_size() entries.
  virtual void observe(int robot, std::span<float> out) const = 0;
  /// All robots one after the other. Precondition: robots() · observation_size() entries.
  void observe(std::span<float> out) const;
  /// What is not known, nats: of tracking the mean over the targets, of mapping all of the map.
  [[nodiscard]] virtual double entropy_nats() const = 0;

 protected:
  virtual void on_reset(std::uint64_t seed) = 0;
  /// Moves the robots, lets them look; fills seen() by robot with how much each saw.
  virtual double on_step(std::span<const std::int64_t> actions) = 0;
  [[nodiscard]] std::vector<double>& seen() { return seen_; }

 private:
  void choose_jammed();

  int robots_;
  int steps_max_;
  JammerSpec jammer_;
  int steps_ = 0;
  std::vector<char> jammed_;
  std::vector<double> seen_;  ///< in the present period, by robot
  std::mt19937_64 attacker_;
};

/// @throws UsageError unless there is one action for each robot of `tasks` tasks like `task`, each
/// one that it has.
void require_actions(std::span<const std::int64_t> actions, std::size_t tasks,
                     const TeamTask& task);

}  // namespace vantage::python
