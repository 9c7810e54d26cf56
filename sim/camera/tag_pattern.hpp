#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace vantage::sim {

/// Printed pattern of a tag: square cells, black or white, with a white margin.
struct TagPattern {
  int cells_per_side = 0;   ///< including the margin
  int border_per_side = 0;  ///< cells of the black square, whose side is the size of the tag
  std::vector<std::uint8_t> is_white;  ///< 1: white, 0: black; row by row from the top
};

/// Returns the pattern of a tag; an error for an unknown family or id, or if the program was built
/// without the AprilTag library.
Result<TagPattern> tag_pattern(const std::string& family, int id);

}  // namespace vantage::sim
