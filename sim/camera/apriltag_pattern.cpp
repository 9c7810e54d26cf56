#include <cstdlib>

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagStandard41h12.h>

#include "sim/camera/tag_pattern.hpp"

namespace vantage::sim {
namespace {

struct FamilyRow {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr FamilyRow kFamilies[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy}};

constexpr int kWhite = 128;

TagPattern pattern_of(apriltag_family_t& family, int id) {
  image_u8_t* const image = apriltag_to_image(&family, id);
  TagPattern out;
  out.cells_per_side = image->width;
  out.border_per_side = family.width_at_border;
  for (int row = 0; row < image->height; ++row) {
    for (int column = 0; column < image->width; ++column) {
      out.is_white.push_back(image->buf[row * image->stride + column] >= kWhite ? 1 : 0);
    }
  }
  // Frees the image like image_u8_destroy(), which is in another library in Debian.
  std::free(image->buf);
  std::free(image);
  return out;
}

}  // namespace

Result<TagPattern> tag_pattern(const std::string& family, int id) {
  for (const FamilyRow& row : kFamilies) {
    if (family != row.name) {
      continue;
    }
    apriltag_family_t* const made = row.create();
    const bool is_known = id >= 0 && id < static_cast<int>(made->ncodes);
    Result<TagPattern> out =
        is_known
            ? Result<TagPattern>(pattern_of(*made, id))
            : Result<TagPattern>(Error{"tag " + std::to_string(id) + " is not in family " + family +
                                       ", whose ids are 0 to " + std::to_string(made->ncodes - 1)});
    row.destroy(made);
    return out;
  }
  return Error{"unknown tag family '" + family + "'"};
}

}  // namespace vantage::sim
