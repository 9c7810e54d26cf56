// replay_check ORIGINAL.lcmlog REPLAYED.lcmlog ROBOT MIN_COUNT
//
// Compares the output of one robot's estimator and planner in a trial with the output of fresh
// processes for the same inputs (published under REPLAY_): beliefs by step, plans by round, bit for
// bit. Exit code 0 when at least MIN_COUNT of each were compared and none differs.

#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/process.hpp"
#include "logs/file/log_index.hpp"
#include "trial/replay/output_comparison.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): only in this main file

bool is_same(const logs::IndexedLog& original, const logs::IndexedLog& replayed,
             const std::string& channel, int least) {
  trial::OutputComparison comparison;
  const auto for_each_on = [](const logs::IndexedLog& log, const std::string& name,
                              const auto& visit) {
    logs::LogScan scan = log.scan();
    while (const auto event = scan.next()) {
      if (event->channel == name) {
        visit(event->data);
      }
    }
  };
  for_each_on(original, channel, [&](const auto& data) { comparison.add_logged(data); });
  for_each_on(replayed, "REPLAY_" + channel,
              [&](const auto& data) { comparison.add_replayed(data); });
  std::printf("%s: %ld of %ld replayed, %ld different, %ld unexpected\n", channel.c_str(),
              comparison.replayed(), comparison.logged(), comparison.different(),
              comparison.unexpected());
  if (comparison.first_difference()) {
    for (const std::string& line : trial::describe(*comparison.first_difference())) {
      std::printf("  %s\n", line.c_str());
    }
  }
  return comparison.is_exact() && comparison.replayed() >= least;
}

}  // namespace

int main(int argc, char** argv) {
  return run_process("replay_check", [&]() -> int {
    if (argc != 5) {
      std::printf("usage: replay_check ORIGINAL REPLAYED ROBOT MIN_COUNT\n");
      return 2;
    }
    const logs::IndexedLog original(argv[1]);
    const logs::IndexedLog replayed(argv[2]);
    const std::string robot = argv[3];
    const int least = std::atoi(argv[4]);
    const bool beliefs = is_same(original, replayed, "BELIEF_" + robot, least);
    const bool plans = is_same(original, replayed, "PLAN_" + robot, least);
    return beliefs && plans ? 0 : 1;
  });
}
