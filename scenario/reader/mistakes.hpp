#pragma once

#include <functional>
#include <string>
#include <vector>

namespace vantage::scenario {

/// Collects the mistakes of a file instead of stopping at the first. While an object exists, a
/// reader of this thread that finds a mistake stores it, keeps the variable's value and continues.
/// At most one object per thread.
class MistakeCollector {
 public:
  MistakeCollector();
  ~MistakeCollector();
  MistakeCollector(const MistakeCollector&) = delete;
  MistakeCollector& operator=(const MistakeCollector&) = delete;
  MistakeCollector(MistakeCollector&&) = delete;
  MistakeCollector& operator=(MistakeCollector&&) = delete;

  /// Returns the mistakes in the order in which they were found, each once.
  [[nodiscard]] const std::vector<std::string>& mistakes() const { return mistakes_; }
  void add(const std::string& mistake);

 private:
  std::vector<std::string> mistakes_;
};

/// Calls `read`. If it throws StartupError and a MistakeCollector exists, stores the error;
/// otherwise the error is passed on.
void tolerate(const std::function<void()>& read);

/// Returns all mistakes of the scenario file at `path`, each "file:line: key: rule", by line; empty
/// if load_scenario() accepts it. Mistakes that follow from others may be among them.
std::vector<std::string> mistakes_of_scenario(const std::string& path);

}  // namespace vantage::scenario
