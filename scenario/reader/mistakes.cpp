#include "scenario/reader/mistakes.hpp"

#include <algorithm>
#include <charconv>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::scenario {
namespace {

// Mistakes found so far; null outside mistakes_of_scenario().
thread_local std::vector<std::string>* t_mistakes = nullptr;

/// Scope in which tolerate() stores errors in `mistakes`.
struct Collection {
  explicit Collection(std::vector<std::string>& mistakes) { t_mistakes = &mistakes; }
  ~Collection() { t_mistakes = nullptr; }
  Collection(const Collection&) = delete;
  Collection& operator=(const Collection&) = delete;
};

// Returns the line of "file:line: …"; 0 if there is none.
int line_of(const std::string& mistake, const std::string& path) {
  int line = 0;
  if (mistake.size() > path.size() && mistake.starts_with(path)) {
    std::from_chars(mistake.data() + path.size() + 1, mistake.data() + mistake.size(), line);
  }
  return line;
}

}  // namespace

void tolerate(const std::function<void()>& read) {
  if (t_mistakes == nullptr) {
    read();
    return;
  }
  try {
    read();
  } catch (const StartupError& error) {
    if (std::ranges::find(*t_mistakes, error.what()) == t_mistakes->end()) {
      t_mistakes->emplace_back(error.what());
    }
  }
}

std::vector<std::string> mistakes_of_scenario(const std::string& path) {
  std::vector<std::string> mistakes;
  {
    const Collection scope(mistakes);
    tolerate([&] { load_scenario(path); });
  }
  std::ranges::stable_sort(mistakes, {},
                           [&](const std::string& mistake) { return line_of(mistake, path); });
  return mistakes;
}

}  // namespace vantage::scenario
