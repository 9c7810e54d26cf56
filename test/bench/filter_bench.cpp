// filter_bench: measures the CPU time of one step of a robot's filter, and of the mixture message,
// for each case of the filter family.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "test/bench/filter_family.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): a program

constexpr int kSteps = 400;

double cpu_us() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

void measure(const bench::FilterCase& filter_case) {
  bench::FilterRun run(filter_case);
  std::vector<double> step_us;
  std::vector<double> mixture_us;
  for (int k = 0; k < kSteps; ++k) {
    run.prepare_step();
    const double before_us = cpu_us();
    run.step();
    step_us.push_back(cpu_us() - before_us);
    const double stepped_us = cpu_us();
    static_cast<void>(run.filter().mixture());
    mixture_us.push_back(cpu_us() - stepped_us);
  }
  std::sort(step_us.begin(), step_us.end());
  std::sort(mixture_us.begin(), mixture_us.end());
  std::printf(
      "%s, %3d targets: median %.0f us, 99 of 100 below %.0f us, worst %.0f us; "
      "mixture %.0f, %.0f, %.0f us\n",
      filter_case.name, filter_case.targets, step_us[kSteps / 2], step_us[kSteps * 99 / 100],
      step_us.back(), mixture_us[kSteps / 2], mixture_us[kSteps * 99 / 100], mixture_us.back());
}

}  // namespace

int main() {
  for (const bench::FilterCase& filter_case : bench::filter_cases()) {
    measure(filter_case);
  }
}
