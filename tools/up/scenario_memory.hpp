#pragma once

#include <string>

namespace vantage::tools {

/// A scenario file without a name on any disk, for the processes of a trial: they inherit its
/// descriptor and open it by path(). It is gone with the last of them and cannot be changed.
class ScenarioMemory {
 public:
  /// @throws StartupError when the system gives no memory for it.
  explicit ScenarioMemory(const std::string& yaml);
  ~ScenarioMemory();
  ScenarioMemory(const ScenarioMemory&) = delete;
  ScenarioMemory& operator=(const ScenarioMemory&) = delete;
  ScenarioMemory(ScenarioMemory&&) = delete;
  ScenarioMemory& operator=(ScenarioMemory&&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Where a process that has the descriptor finds it.
  [[nodiscard]] std::string path() const;

 private:
  int descriptor_;
};

}  // namespace vantage::tools
