#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Parser of .lcm files that follows lcm-gen. Free of side effects.
// Source: LCM's type specification; the grammar of lcm-gen 1.3.1 with the extension of 1.4 that
// constants may be array sizes.

namespace vantage::logs {

/// One dimension of an array: its size is constant or the value of an earlier member.
struct LcmDimension {
  /// Text of the size in the source; a named constant is replaced by the text of its value.
  std::string size;
  std::int32_t constant = 0;
  std::int32_t member = -1;  ///< index of the member that contains the size; −1: constant
};

struct LcmMember {
  std::string type;  ///< basic type, or full name of a struct: "package.name_t"
  std::string name;
  std::vector<LcmDimension> dimensions;
};

struct LcmStruct {
  std::string name;  ///< full name: "package.name_t"
  std::vector<LcmMember> members;
  std::size_t line = 0;  ///< first line in the file, from 1
};

/// True for a built-in type of the language: "double", "string", …
bool is_basic_lcm_type(std::string_view type);

/// Returns the structs of a .lcm file in file order. `path` is used in messages only.
/// @throws StartupError "PATH:LINE: reason" for files that lcm-gen also refuses.
std::vector<LcmStruct> parse_lcm(std::string_view text, const std::string& path);

}  // namespace vantage::logs
