// SPDX-License-Identifier: MIT
// Bodies of motion_memory_file.hpp.
#pragma once

#include <algorithm>  // any_of
#include <cmath>      // abs, lround
#include <limits>     // numbers of captions
#include <utility>    // move

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/weights/metadata_number.hpp>
#include <motionlang/weights/motion_memory_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr double radians_per_step = 1e-4;  // of the stored rotation vectors
inline constexpr std::size_t stored_rotations = 22, all_rotations = 24;

}  // namespace detail

MOTIONLANG_BODY bool remembers_motions(const SafetensorsFile& file) {
  const auto& tensors = file.tensors();
  return std::any_of(tensors.begin(), tensors.end(),
                     [](const TensorView& t) { return t.name.starts_with(memory_tensors); });
}

MOTIONLANG_BODY std::shared_ptr<const MotionMemory> stored_motion_memory(const SafetensorsFile& file,
                                                                         KnownCaptions captions, double fps) {
  const std::string prefix = memory_tensors;
  if (!remembers_motions(file)) return nullptr;
  const TensorView &poses = file.tensor(prefix + "poses"), &root = file.tensor(prefix + "root"),
                   &ends = file.tensor(prefix + "ends"), &of = file.tensor(prefix + "captions");
  const auto require = [&](const TensorView& view, DType dtype, const FileShape& shape) {
    if (view.dtype != dtype || view.shape != shape)
      raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.dtype, " ", view.shape, ", not ", dtype,
                      " ", shape);
  };
  const auto first_size = [](const TensorView& view) { return view.shape.rank() == 0 ? 0 : view.shape[0]; };
  const Index frames = first_size(root);
  require(poses, DType::I16, {3 * Index{detail::stored_rotations}, frames});
  require(root, DType::F32, {frames, 3});
  require(ends, DType::I32, {first_size(ends)});
  require(of, DType::I16, {first_size(of), 2});
  for (const TensorView& t : file.tensors()) {
    if (t.name.starts_with(prefix) && t.name != poses.name && t.name != root.name && t.name != ends.name &&
        t.name != of.name)
      raise<io_error>(406, file.name(), ": tensor '", t.name, "' is unknown");
  }
  constexpr double farthest = 1e4;  // metres
  for (const double x : values_of<double>(root)) {
    if (!(std::abs(x) <= farthest))
      raise<config_error>(107, file.name(), ": tensor '", root.name, "' has a ", x, "; -", farthest, " ... ", farthest,
                          " are allowed");
  }
  const auto angles = values_of<std::int16_t>(poses);
  const auto places = values_of<float>(root);
  std::vector<Motion> motions;
  std::size_t first = 0;
  for (const std::int32_t end : values_of<std::int32_t>(ends)) {
    if (end <= static_cast<Index>(first) || end > frames)
      raise<io_error>(407, file.name(), ": tensor '", ends.name, "': a motion ends before frame ", end,
                      " and begins with frame ", first, " of ", frames);
    Motion& m = motions.emplace_back(Motion{smpl24_skeleton(), fps, {}, {}, {}});
    for (; first < static_cast<std::size_t>(end); ++first) {
      const float* p = places.data() + 3 * first;
      m.root.push_back({p[0], p[1], p[2]});
      for (std::size_t j = 0; j < detail::stored_rotations; ++j) {
        const auto angle = [&](std::size_t i) {
          return detail::radians_per_step * angles[(3 * j + i) * static_cast<std::size_t>(frames) + first];
        };
        m.local.push_back(to_quaternion(AxisAngle<double>{{angle(0), angle(1), angle(2)}}));
      }
      m.local.resize(m.root.size() * detail::all_rotations, Quaternion<double>::identity());
    }
  }
  if (static_cast<Index>(first) != frames)
    raise<io_error>(407, file.name(), ": tensor '", ends.name, "': the motions have ", counted(first, "frame"), ", '",
                    poses.name, "' has ", frames);
  std::vector<RememberedMotion> remembered;
  const auto pairs = values_of<std::int16_t>(of);
  for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) remembered.push_back({pairs[i], pairs[i + 1]});
  return std::make_shared<const MotionMemory>(std::move(captions), std::move(motions), std::move(remembered),
                                              file.name());
}

MOTIONLANG_BODY void write_motion_memory(const FilePath& from, const FilePath& to, const MotionMemory& memory) {
  constexpr Index most = std::numeric_limits<std::int16_t>::max();
  if (memory.captions().table().size() > most || std::ssize(memory.motions()) > most)
    raise<config_error>(101, to.string(), ": ", counted(memory.motions().size(), "motion"), " and ",
                        counted(memory.captions().table().size(), "text"), " to remember; ", most, " are possible");
  std::vector<std::int16_t> of;
  std::vector<float> root;
  std::vector<std::int32_t> ends;
  for (const Motion& m : memory.motions()) {
    for (const auto& p : m.root) root.insert(root.end(), {float(p.x), float(p.y), float(p.z)});
    ends.push_back(static_cast<std::int32_t>(root.size() / 3));
  }
  const std::size_t all = root.size() / 3;
  std::vector<std::int16_t> poses(3 * detail::stored_rotations * all);
  std::size_t frame = 0;
  for (const Motion& m : memory.motions()) {
    for (Index f = 0; f < m.frames(); ++f, ++frame) {
      for (std::size_t j = 0; j < detail::stored_rotations; ++j) {
        const auto v = log_so3(m.rotations(f)[j]);
        for (std::size_t i = 0; const double x : {v.x, v.y, v.z})
          poses[(3 * j + i++) * all + frame] = static_cast<std::int16_t>(std::lround(x / detail::radians_per_step));
      }
    }
  }
  for (const RememberedMotion& r : memory.remembered()) {
    of.push_back(static_cast<std::int16_t>(r.caption));
    of.push_back(static_cast<std::int16_t>(r.motion));
  }
  const auto file = SafetensorsFile::open(from);
  if (!memory.motions().empty() && file.metadata().contains("fps")) {
    const double own = memory.motions().front().fps;
    if (const auto fps = detail::metadata_number<double>(file.metadata(), "fps", file.name()); fps != own)
      raise<config_error>(102, file.name(), ": the model has ", fps, " frames per second, the motions to remember ",
                          own);
  }
  const std::string prefix = memory_tensors;
  detail::FileWithoutCaptions rest(file);
  auto& tensors = rest.tensors;
  std::erase_if(tensors, [&](const TensorView& t) { return t.name.starts_with(prefix); });
  const StoredCaptions captions(memory.captions());
  captions.add_to(tensors, rest.metadata);
  if (!ends.empty()) {
    const Index frames = std::ssize(root) / 3;
    tensors.push_back(
        tensor_view(prefix + "poses", {std::ssize(poses) / frames, frames}, std::span<const std::int16_t>(poses)));
    tensors.push_back(tensor_view(prefix + "root", {frames, 3}, std::span<const float>(root)));
    tensors.push_back(tensor_view(prefix + "ends", {std::ssize(ends)}, std::span<const std::int32_t>(ends)));
    tensors.push_back(tensor_view(prefix + "captions", {std::ssize(of) / 2, 2}, std::span<const std::int16_t>(of)));
  }
  write_safetensors(to, tensors, rest.metadata);
}

MOTIONLANG_NAMESPACE_END
