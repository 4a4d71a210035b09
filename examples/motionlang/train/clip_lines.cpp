#include "clip_lines.hpp"

#include <algorithm>

#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/features/amass_releases.hpp>
#include <motionlang/io/amass.hpp>
#include <motionlang/io/amc.hpp>
#include <motionlang/io/bvh.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../files/motion_files.hpp"

namespace program {

namespace {

std::vector<std::string> split(std::string_view line, std::string_view separator) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    std::string_view field = line.substr(at, end - at);
    while (!field.empty() && field.front() == ' ') field.remove_prefix(1);
    while (!field.empty() && (field.back() == ' ' || field.back() == '\r')) field.remove_suffix(1);
    out.emplace_back(field);
    at = end + separator.size();
  }
  return out;
}

[[noreturn]] void wrong(const ClipLine& line, const std::string& what) {
  ml::raise<ml::io_error>(403, line.place, ": ", what);
}

/// The rows of a table of `columns`; `fill` reads the columns behind the times.
template <class Fill>
std::vector<ClipLine> read_table(const std::filesystem::path& path, std::size_t columns, const char* expected,
                                 Fill fill) {
  std::vector<ClipLine> lines;
  const std::string text = ml::read_file(path);
  std::size_t number = 0;
  for (const std::string& row : split(text, "\n")) {
    ++number;
    if (row.empty() || row[0] == '#') continue;
    ClipLine line{ml::concat_text(path.string(), ":", number), {}, 0, 0, {}, {}};
    const auto fields = split(row, "\t");
    if (fields.size() != columns) wrong(line, ml::concat_text("expected ", expected, ", separated by tabs"));
    line.clip = fields[0];
    const auto seconds = [&](const std::string& field) {
      const auto value = ml::detail::parse_seconds(field);
      if (!value) wrong(line, "'" + field + "' is not a time");
      return *value;
    };
    line.start = seconds(fields[1]);
    line.end = seconds(fields[2]);
    if (!(line.end > line.start)) wrong(line, "the segment is empty");
    fill(line, fields);
    for (const std::string& t : line.texts) {
      if (t.empty()) wrong(line, "an empty text");
    }
    lines.push_back(std::move(line));
  }
  if (lines.empty()) ml::raise<ml::io_error>(403, path.string(), ": no line with ", expected);
  return lines;
}

}  // namespace

std::vector<ClipLine> read_captions(const std::filesystem::path& path) {
  return read_table(path, 5, "clip, start, end, parts, captions",
                    [](ClipLine& line, const std::vector<std::string>& fields) {
                      line.texts = split(fields[4], "|");
                      for (const std::string& name : split(fields[3], ",")) {
                        const auto part = ml::parse_body_part(name);
                        if (!part) wrong(line, "'" + name + "' is no body part");
                        line.parts = line.parts.with(*part);
                      }
                    });
}

std::vector<ClipLine> read_labels(const std::filesystem::path& path) {
  return read_table(path, 4, "clip, start, end, label",
                    [](ClipLine& line, const std::vector<std::string>& fields) { line.texts = {fields[3]}; });
}

ml::Motion read_clip(const std::filesystem::path& data, const ClipLine& line) {
  const auto bvh = data / (line.clip + ".bvh"), amc = data / (line.clip + ".amc");
  if (std::filesystem::exists(bvh)) return ml::retarget(ml::read_bvh_motion(bvh));
  for (const std::string& clip : ml::amass_paths(line.clip)) {
    const auto npz = data / (clip + ".npz");
    if (std::filesystem::exists(npz)) return on_smpl(ml::read_amass(npz).motion);
  }
  if (std::filesystem::exists(amc)) {
    auto asf = asf_beside(amc);
    if (!std::filesystem::exists(asf))
      asf = data / "cmu-asf-amc" / "01.asf";  // angles of another figure of the same hierarchy
    return ml::retarget(ml::read_amc(amc, ml::read_asf(asf)));
  }
  ml::raise<ml::io_error>(401, line.place, ": no ", bvh.string(), ", no .npz and no .amc");
}

ml::Motion segment_of(const ml::Motion& clip, const ClipLine& line, ml::Index least) {
  const auto first = std::clamp<ml::Index>(static_cast<ml::Index>(line.start * clip.fps + 0.5), 0, clip.frames());
  const auto last = std::clamp<ml::Index>(static_cast<ml::Index>(line.end * clip.fps + 0.5), first, clip.frames());
  if (last - first < least)
    wrong(line, ml::concat_text(line.clip, " ", line.start, " to ", line.end, " s holds ", last - first, " frames"));
  return ml::crop(clip, first, last);
}

}  // namespace program
