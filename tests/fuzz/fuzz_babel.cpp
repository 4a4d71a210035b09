// BABEL: any text is read or refused with an error of the library; the stretches of what was read lie inside of the
// motion, in order, with texts. All texts of a sequence survive as annotations.
#include <cstdint>

#include <motionlang/datasets/babel.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

void check_segments(const ml::BabelAnnotation& annotation) {
  constexpr ml::Index frames = 100;
  const auto segments = ml::babel_segments(annotation.labels, 30, frames, {{"walk", "run"}, {"t-pose", ""}});
  check(segments.size() <= annotation.labels.size(), "at most one stretch for each label");
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const ml::BabelSegment& s = segments[i];
    check(0 <= s.start && s.start < s.end && s.end <= frames, "a stretch lies inside of the motion");
    check(!s.text.empty() && !ml::is_babel_excluded(s.text), "its text is one to train on");
    check(i == 0 || segments[i - 1].start <= s.start, "in order");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto file = ml::BabelFile::from_text(std::string(reinterpret_cast<const char*>(data), size));
    for (const std::string& id : file.ids()) {
      try {
        const ml::BabelSequence sequence = file.load(id);
        for (const auto& a : sequence.sequence_annotations) check_segments(a);
        for (const auto& a : sequence.frame_annotations) check_segments(a);
        const ml::AnnotatedMotion motion = ml::annotated_motion(sequence);
        const auto written = ml::AnnotationFile::from_text(ml::annotations_json(std::span(&motion, 1)));
        check(written.load(motion.id) == motion, "the annotations that were written");
      } catch (const ml::error&) {}
    }
  } catch (const ml::error&) {}
  return 0;
}
