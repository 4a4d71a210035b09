// Annotation JSON: any text is read or refused with an error of the library; members are what nlohmann finds in the
// whole file; what was read survives writing.
#include <cstdint>

#include <motionlang/datasets/annotations.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

void check_members(const std::string& text) {
  const auto members = ml::JsonMembers::from_text(text);
  nlohmann::json all = nlohmann::json::object();
  for (const std::string& key : members.keys()) all[key] = members.load(key);
  check(ml::parse_json(text) == all, "the members make up the file");
}

void check_annotations(const std::string& text) {
  const auto file = ml::AnnotationFile::from_text(text);
  std::vector<ml::AnnotatedMotion> motions;
  for (const std::string& id : file.ids()) {
    motions.push_back(file.load(id));
    for (const ml::Annotation& a : motions.back().annotations) {
      const ml::FrameSlice frames = ml::annotated_frames(a, 20, 100);
      check(frames.length == 0 || (frames.first >= 0 && frames.first + frames.length <= 100), "frames of the motion");
    }
    ml::mirrored(motions.back());
  }
  const auto again = ml::AnnotationFile::from_text(ml::annotations_json(motions));
  check(again.ids() == file.ids(), "ids survive");
  for (const ml::AnnotatedMotion& m : motions) check(again.load(m.id) == m, "entries survive");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  refusing([&] { check_members(text); });
  refusing([&] { check_annotations(text); });
  return 0;
}
