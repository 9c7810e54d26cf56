#include <cstdio>

#include "test/drivers/safety/fault_report.hpp"

// Prints docs/reference/faults.md.
int main() {
  const std::string page = vantage::test::fault_report();
  std::fwrite(page.data(), 1, page.size(), stdout);
  return 0;
}
