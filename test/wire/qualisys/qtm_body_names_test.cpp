#include <gtest/gtest.h>

#include "wire/qualisys/body_names.hpp"

namespace vantage::wire::qualisys {
namespace {

/// Returns the names, each followed by '!' if the body is disabled; "refused" if the text is
/// refused.
std::string names_of(std::string_view xml) {
  const auto bodies = decode_body_names(xml);
  if (!bodies) {
    return "refused";
  }
  std::string out;
  for (const BodyName& body : *bodies) {
    out += (out.empty() ? "" : ",") + body.name + (body.is_enabled ? "" : "!");
  }
  return out;
}

TEST(QtmBodyNames, ReadsTheNamesOfBodiesOnly) {
  EXPECT_EQ(names_of(R"(<?xml version="1.0"?>
<!-- the form of protocol 1.25 -->
<QTM_Parameters_Ver_1.25>
  <The_6D>
    <Body><Name>QUAD</Name><Enabled>true</Enabled><Color R="0" G='1' B="2" />
      <Mesh><Name>drone.obj</Name></Mesh><Points><Point X="1.5" Name="no"/></Points></Body>
    <Body><Enabled>false</Enabled><Name> R &amp; D &lt;1&gt; </Name></Body>
    <Euler><First>Roll</First></Euler>
  </The_6D>
  <Body><Name>elsewhere</Name></Body>
</QTM_Parameters_Ver_1.25>)"),
            "QUAD,R & D <1>!");
  EXPECT_EQ(names_of("<P><The_6D><Bodies>1</Bodies><Body><Name>old</Name><RGBColor>1</RGBColor>"
                     "</Body></The_6D></P>"),
            "old")
      << "the form before protocol 1.21";
  EXPECT_EQ(names_of("<P><The_6D/></P>"), "");
}

TEST(QtmBodyNames, RefusesTextThatIsNotWellFormed) {
  for (const char* text : {"",
                           "   ",
                           "text",
                           "<a>",
                           "</a>",
                           "<a></b>",
                           "<a><b></a></b>",
                           "<a/><b/>",
                           "<a/>text",
                           "<a x></a>",
                           "<a x=1></a>",
                           "<a x=\"1></a>",
                           "<a>&unknown;</a>",
                           "<a>&</a>",
                           "<!-- <a/>",
                           "<?xml <a/>",
                           "<>",
                           "< a/>",
                           "<a",
                           "<P><The_6D><Body/></The_6D></P>",
                           "<P><The_6D><Body><Name></Name></Body></The_6D></P>"}) {
    EXPECT_EQ(names_of(text), "refused") << text;
  }
  std::string deep;
  for (int i = 0; i < 100'000; ++i) {
    deep += "<a>";
  }
  EXPECT_EQ(names_of(deep), "refused");
}

TEST(QtmBodyNames, ReadsWhatItWrites) {
  EXPECT_EQ(names_of(encode_body_names({})), "");
  EXPECT_EQ(names_of(encode_body_names({"A", "<&>\"'", "Bö"})), "A,<&>\"',Bö");
  const std::string whole = encode_body_names({"A"});
  for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
    EXPECT_EQ(names_of(std::string_view(whole).substr(0, size)), "refused") << size;
  }
}

}  // namespace
}  // namespace vantage::wire::qualisys
