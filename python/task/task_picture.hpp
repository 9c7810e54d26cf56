#pragma once

#include <optional>
#include <string>

#include "logs/picture/scene.hpp"
#include "python/task/mapping_task.hpp"
#include "python/task/tracking_task.hpp"

namespace vantage::python {

/// Drawer of a task as the picture that `vantage demo` draws of a trial. The tracks in the picture
/// consist of the steps of the current episode at which draw() was called.
class TaskPicture {
 public:
  /// Returns the present state of `task` as SVG text, titled `title`. Precondition: the task was
  /// reset.
  std::string draw(const TeamTask& task, const std::string& title);

 private:
  /// Starts new tracks if the episode differs from the last one drawn.
  void follow_episode(const TeamTask& task);
  std::string draw_tracking(const TrackingTask& task, const std::string& title);
  std::string draw_mapping(const MappingTask& task, const std::string& title);
  void add_robots(scenario::Scenario& scenario, const TeamTask& task,
                  const std::vector<Pose2>& poses, const models::SensorModel& sensor);
  void add_track_point(std::vector<logs::TrackPoint>& track,
                       const Eigen::Vector2d& position_m) const;

  logs::Scene scene_;
  std::optional<std::uint64_t> seed_;
  int steps_ = 0;
};

}  // namespace vantage::python
