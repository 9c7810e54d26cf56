#include "trial/robot_processes.hpp"

#include <algorithm>
#include <cctype>

namespace vantage::trial {

std::string process_name(const std::string& word, const std::string& robot) {
  return word + " " + robot;
}

std::string node_name(std::string process) {
  std::transform(process.begin(), process.end(), process.begin(), [](unsigned char c) {
    return c == ' ' ? '_' : static_cast<char>(std::toupper(c));
  });
  return process;
}

}  // namespace vantage::trial
