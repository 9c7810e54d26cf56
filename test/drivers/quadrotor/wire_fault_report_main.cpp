#include <cstdio>
#include <string>

#include "test/drivers/quadrotor/wire_fault_report.hpp"

// Usage: wire_fault_report [--only NAME]. Prints every fault that docs/results/faults47.md
// summarises. With NAME, prints only the rows of faults with a name that contains NAME, with the
// reasons and counters of Q1.
int main(int argc, char** argv) {
  const bool is_part = argc == 3 && std::string(argv[1]) == "--only";
  if (argc > 1 && !is_part) {
    std::fputs("usage: wire_fault_report [--only NAME]\n", stderr);
    return 2;
  }
  const std::string page =
      is_part ? vantage::test::wire_fault_rows(argv[2]) : vantage::test::wire_fault_report();
  std::fwrite(page.data(), 1, page.size(), stdout);
  return 0;
}
