#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace vantage::sim {

/// Printed pattern of a tag: square cells, black or white, with a white margin.
struct TagPattern {
  int cells_per_side = 0;   ///< with the margin
  int border_per_side = 0;  ///< cells of the black square, whose side is the size of the tag
  std::vector<std::uint8_t> is_white;  ///< by row from the top, 0 or 1
};

/// Returns the pattern of a tag; an error for an unknown family or id, or if the program was built
/// without the AprilTag library.
Result<TagPattern> tag_pattern(const std::string& family, int id);

}  // namespace vantage::sim
