#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace vantage::estimator::test {

/// Returns the rows of a CSV file of numbers with one header line; empty if the file does not
/// exist.
inline std::vector<std::vector<double>> read_csv(const std::string& path) {
  std::vector<std::vector<double>> rows;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<double>& row = rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      row.push_back(std::stod(cell));
    }
  }
  return rows;
}

}  // namespace vantage::estimator::test
