// ASF and AMC: any text is read or refused with an error of the library. An input is an ASF text and, behind a line
// "====", an AMC text; without that line both readers get all of it.
#include <cmath>
#include <cstdint>

#include <motionlang/formats/amc.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

constexpr std::string_view two_bones =
    ":bonedata begin name a direction 1 0 0 length 1 axis 0 0 90 XYZ dof rx ry rz\nend "
    "begin name b direction 0 1 0 length 2 axis 0 0 0 XYZ dof ty l\nend :hierarchy begin root a\na b\nend";

void check_motion(std::string_view text, const ml::AsfSkeleton& asf) {
  std::vector<std::string> notes;
  const ml::Motion motion = ml::parse_amc(text, asf, {}, "text", &notes);
  check(notes.size() <= 1 + 2 * asf.bones.size(), "notes");
  check(motion.skeleton.size() == static_cast<int>(asf.bones.size()), "one joint for each bone");
  for (const auto& q : motion.local) check(std::abs(dot(q, q) - 1) < 1e-9, "unit quaternions");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto line = text.find("\n====\n");
  const std::string_view skeleton = text.substr(0, line), motion = line == text.npos ? text : text.substr(line + 6);
  refusing([&] { check_motion(motion, ml::parse_asf(skeleton)); });
  refusing([&] { check_motion(motion, ml::parse_asf(two_bones)); });
  return 0;
}
