// SPDX-License-Identifier: MIT
// Bodies of mdm_results.hpp.
#pragma once

#include <algorithm>  // min

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/pickle_arrays.hpp>
#include <motionlang/formats/mdm_results.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A dictionary or another object that numpy.save wrote: an array of objects without sizes.
inline bool is_single_object(const NpyHeader& header) { return header.descr == "|O" && header.shape.empty(); }

inline bool is_mdm_shape(std::span<const Index> shape) {
  return shape.size() == 4 && shape[2] == 3 && is_joint_count(shape[1]);
}

/// lengths  frames of each motion; none: all frames. A length beyond the frames cuts nothing, as in MDM's own pictures
inline std::vector<Motion> mdm_motions(const NpyArray& array, std::span<const std::int64_t> lengths,
                                       MotionArrayOptions options, const std::string& name) {
  const auto& shape = array.shape;
  if (!is_mdm_shape(shape) || array.count() == 0 || array.is_text())
    raise<io_error>(407, name, ": motions ", shape_text(shape), " of type ", array.type(),
                    ", expected numbers (motions, 21, 22 or 24 joints, 3, frames)");
  if (options.up == UpAxis::found) options.up = UpAxis::y;
  const Index rows = 3 * shape[1], frames = shape[3];
  const std::vector<double> values = array.to<double>();
  std::vector<Motion> out;
  for (Index i = 0; i < shape[0]; ++i) {
    const Index length = lengths.empty() ? frames : std::min<Index>(lengths[static_cast<std::size_t>(i)], frames);
    if (length < 1) raise<io_error>(407, name, ": motion ", i, " has ", length, " of ", counted(frames, "frame"));
    std::vector<double> positions;  // (length, joints, 3)
    for (Index f = 0; f < length; ++f) {
      for (Index row = 0; row < rows; ++row)
        positions.push_back(values[static_cast<std::size_t>((i * rows + row) * frames + f)]);
    }
    out.push_back(motion_from_array(NpyArray::of(std::span<const double>(positions), {length, shape[1], 3}), options,
                                    concat_text(name, ": motion ", i)));
    out.back().name = std::to_string(i);
  }
  return out;
}

/// The text of a motion, or its texts if they change within it, cut after a whole character.
inline std::string mdm_name(const PickleValue& text) {
  constexpr std::size_t longest = 160;
  std::string all;
  if (text.is(PickleKind::list)) {
    for (std::size_t i = 0; i < text.size() && all.size() <= longest; ++i)
      all += concat_text(i == 0 ? "" : ", ", text[i].text().substr(0, longest + 1));
  } else {
    all = text.text().substr(0, longest + 1);
  }
  std::size_t end = 0;
  for (std::size_t next = 0; next < all.size(); end = next <= longest ? next : end) decode_utf8(all, next);
  return all.substr(0, end);
}

inline std::vector<Motion> mdm_motions(const PickleValue& object, const MotionArrayOptions& options) {
  if (!is_numpy_array(object) || object.state()[4].size() != 1) object.fail(407, "not one object");
  const PickleValue results = object.state()[4][0];  // version, shape, element type, order, elements
  const PickleValue texts = results["text"];
  const NpyArray array = to_array(results["motion"]);
  const auto lengths = to_array(results["lengths"]).to<std::int64_t>();
  const Index motions = array.shape.empty() ? 0 : array.shape[0];
  if (std::ssize(lengths) != motions || static_cast<Index>(texts.size()) != motions)
    results.fail(407, counted(motions, "motion"), ", ", counted(lengths.size(), "length"), " and ",
                 counted(texts.size(), "text"));
  std::vector<Motion> out = mdm_motions(array, lengths, options, object.file());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (std::string text = mdm_name(texts[i]); !text.empty()) out[i].name = std::move(text);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY bool may_be_mdm_motions(const FilePath& path) {
  const auto file = MappedFile::open(path);
  const auto header = detail::npy_parts(file->bytes(), path.string()).header;
  return detail::is_single_object(header) || detail::is_mdm_shape(header.shape);
}

MOTIONLANG_BODY std::vector<Motion> read_motions_npy(const FilePath& path, const MotionArrayOptions& options) {
  return motions_of_npy(MappedFile::open(path)->bytes(), path.string(), options);
}

MOTIONLANG_BODY std::vector<Motion> motions_of_npy(std::span<const std::byte> bytes, const std::string& name,
                                                   const MotionArrayOptions& options) {
  const detail::NpyParts npy = detail::npy_parts(bytes, name);
  if (detail::is_single_object(npy.header)) {
    const std::uint64_t start = bytes.size() - npy.raw.size();
    const Pickle pickle(bytes, name, {}, nullptr, start);
    if (const auto behind = bytes.size() - pickle.end(); behind > 0)
      raise<io_error>(403, name, ": ", counted(behind, "byte"), " behind the object, which ends at byte ",
                      pickle.end());
    return detail::mdm_motions(pickle.root(), options);
  }
  const NpyArray array = parse_npy(bytes, name);
  if (array.shape.size() == 4) return detail::mdm_motions(array, {}, options, name);
  return {motion_from_array(array, options, name)};
}

MOTIONLANG_NAMESPACE_END
