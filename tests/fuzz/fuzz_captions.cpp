// The text files of data sets: captions of HumanML3D, index.csv, lists of ids, joints of raw KIT-ML. Any text is read
// or refused with an error of the library; captions that may be written survive it.
#include <cstdint>

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/datasets/kit_recordings.hpp>
#include <motionlang/file/id_list.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

void check_captions(std::string_view text) {
  const auto captions = ml::parse_captions(text);
  for (const ml::HumanMl3dItem& item : ml::humanml3d_items(captions, 100)) {
    check(item.frames.first >= 0 && item.frames.first + item.frames.length <= 100, "items lie inside of the clip");
    for (const std::size_t i : item.captions) check(i < captions.size(), "items have captions of the clip");
  }
  for (const ml::MotionCaption& c : captions) {
    ml::mirrored(c);
    if (c.text.starts_with("\xEF\xBB\xBF")) return;  // would be taken for a byte order mark
  }
  check(ml::parse_captions(ml::format_captions(captions)) == captions, "captions survive");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  refusing([&] { check_captions(text); });
  refusing([&] { ml::parse_ids(text); });
  refusing([&] {
    for (const ml::HumanMl3dSource& row : ml::parse_humanml3d_index(text)) {
      for (const ml::Index f : ml::humanml3d_source_frames(row, 100, 60))
        check(f >= 0 && f < 100, "frames of the source");
    }
  });
  refusing(
      [&] { check(ml::parse_kit_joints(text).size() % ml::KitRecording::joint_count == 0, "whole frames of joints"); });
  return 0;
}
