#include "scenario/reader/mistakes.hpp"

#include <algorithm>
#include <charconv>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::scenario {
namespace {

thread_local MistakeCollector* t_collector = nullptr;

// Returns the line of "file:line: …"; 0 if there is none.
int line_of(const std::string& mistake, const std::string& path) {
  int line = 0;
  if (mistake.size() > path.size() && mistake.starts_with(path)) {
    std::from_chars(mistake.data() + path.size() + 1, mistake.data() + mistake.size(), line);
  }
  return line;
}

}  // namespace

MistakeCollector::MistakeCollector() {
  require(t_collector == nullptr, "mistakes: another collector exists");
  t_collector = this;
}

MistakeCollector::~MistakeCollector() { t_collector = nullptr; }

void MistakeCollector::add(const std::string& mistake) {
  if (std::ranges::find(mistakes_, mistake) == mistakes_.end()) {
    mistakes_.push_back(mistake);
  }
}

void tolerate(const std::function<void()>& read) {
  if (t_collector == nullptr) {
    read();
    return;
  }
  try {
    read();
  } catch (const StartupError& error) {
    t_collector->add(error.what());
  }
}

std::vector<std::string> mistakes_of_scenario(const std::string& path) {
  MistakeCollector collector;
  tolerate([&] { load_scenario(path); });
  std::vector<std::string> mistakes = collector.mistakes();
  std::ranges::stable_sort(mistakes, {},
                           [&](const std::string& mistake) { return line_of(mistake, path); });
  return mistakes;
}

}  // namespace vantage::scenario
