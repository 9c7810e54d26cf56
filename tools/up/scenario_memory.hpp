#pragma once

#include <string>

namespace vantage::tools {

/// Scenario file in memory (memfd) for the processes of a trial. They inherit its descriptor and
/// open it by path(). It cannot be changed, and it disappears when the last process closes it.
class ScenarioMemory {
 public:
  /// @throws StartupError if the system provides no memory for it.
  explicit ScenarioMemory(const std::string& yaml);
  ~ScenarioMemory();
  ScenarioMemory(const ScenarioMemory&) = delete;
  ScenarioMemory& operator=(const ScenarioMemory&) = delete;
  ScenarioMemory(ScenarioMemory&&) = delete;
  ScenarioMemory& operator=(ScenarioMemory&&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Returns the path by which a process that has the descriptor opens the file.
  [[nodiscard]] std::string path() const;

 private:
  int descriptor_;
};

}  // namespace vantage::tools
