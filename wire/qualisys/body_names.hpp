#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vantage::wire::qualisys {

/// Body in the 6D parameters of QTM. A data packet contains the poses in the same order.
struct BodyName {
  std::string name;
  bool is_enabled = true;  ///< protocol 1.24 and later: a disabled body is not tracked
};

/// Returns the bodies in an XML document with the 6D parameters: each element `Body` in `The_6D`,
/// with the children `Name` and `Enabled`. Returns nullopt if the text is not well-formed XML
/// (elements, attributes, text, entities, comments, declaration), is nested too deeply, or if a
/// body has no name.
std::optional<std::vector<BodyName>> decode_body_names(std::string_view xml);

/// Returns an XML document with the 6D parameters of `bodies`, as QTM sends it for protocol 1.25.
std::string encode_body_names(const std::vector<std::string>& bodies);

}  // namespace vantage::wire::qualisys
