#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// The language of .lcm files, as lcm-gen reads it. Pure.
// Source: LCM's type specification; the grammar of lcm-gen 1.3.1, and constants as array sizes as
// 1.4 has them.

namespace vantage::logs {

/// One dimension of an array: of constant size, or as long as an earlier member says.
struct LcmDimension {
  std::string size;  ///< as it is written; of a named constant its value as it is written
  std::int32_t constant = 0;
  std::int32_t member = -1;  ///< index of the member that says how long; −1: constant
};

struct LcmMember {
  std::string type;  ///< a basic one, or the whole name of a struct: "package.name_t"
  std::string name;
  std::vector<LcmDimension> dimensions;
};

struct LcmStruct {
  std::string name;  ///< with its package
  std::vector<LcmMember> members;
  std::size_t line = 0;  ///< where it begins, from 1
};

/// True for a type that the language has itself: "double", "string", …
bool is_basic_lcm_type(std::string_view type);

/// The structs of a .lcm file, in its order. `path` is for messages only.
/// @throws StartupError "PATH:LINE: what" where lcm-gen would refuse it, too.
std::vector<LcmStruct> parse_lcm(std::string_view text, const std::string& path);

}  // namespace vantage::logs
