// SPDX-License-Identifier: MIT
// Bodies of glb_reader.hpp.
#pragma once

#include <algorithm>  // max
#include <cmath>      // ceil, floor
#include <limits>     // precision of a float
#include <utility>    // move

#include <motionlang/file/file.hpp>
#include <motionlang/formats/detail/gltf_document.hpp>
#include <motionlang/formats/glb_reader.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GlbFile GlbFile::open(const FilePath& path, Index skin) {
  return GlbFile(MappedFile::open(path)->bytes(), path.string(), skin);
}

MOTIONLANG_BODY GlbFile::GlbFile(std::span<const std::byte> bytes, std::string name, Index skin)
    : GlbFile(detail::GltfDocument(bytes, std::move(name)), skin) {}

MOTIONLANG_BODY std::vector<std::string> GlbFile::animation_names() const {
  std::vector<std::string> out;
  for (const auto& a : animations_) out.push_back(a.name());
  return out;
}

MOTIONLANG_BODY double GlbFile::duration(Index animation) const { return at(animation).duration(); }

MOTIONLANG_BODY std::vector<std::string> GlbFile::stretched_joints(Index animation) const {
  const detail::GltfAnimation& a = at(animation);
  std::vector<std::string> names;
  for (std::size_t j = 1; j < joints_.nodes.size(); ++j) {
    const int node = joints_.nodes[j], before = joints_.nodes[static_cast<std::size_t>(skeleton().parents[j])];
    const bool stretched = before >= 0 && a.grows(before, nodes_[static_cast<std::size_t>(before)].rest.scale);
    if (stretched || a.moves_away(node, nodes_[static_cast<std::size_t>(node)].rest.translation)) {
      names.push_back(skeleton().names[j]);
    }
  }
  return names;
}

MOTIONLANG_BODY double GlbFile::rate(Index animation) const {
  const double own = at(animation).rate().value_or(0);
  return own >= 10 && own <= 1000 ? own : 30;
}

MOTIONLANG_BODY Motion GlbFile::motion(Index animation, std::optional<double> wanted) const {
  const detail::GltfAnimation& a = at(animation);
  const double fps = wanted ? *wanted : rate(animation), frames = frames_of(a, fps);
  const double rotations = frames * skeleton().size(), most = most_rotations(a.keys());
  if (rotations > most)
    raise<io_error>(405, file_, ": animation '", a.name(), "' of ", a.duration(), " s at ", fps,
                    " per second: ", rotations, " rotations (frames x joints), at most ", most, " of ",
                    counted(a.keys(), "key"));
  Motion motion{skeleton(), fps, {}, {}, a.name()};
  motion.root.reserve(static_cast<std::size_t>(frames));
  motion.local.reserve(static_cast<std::size_t>(frames) * joints_.nodes.size());
  for (double frame = 0; frame < frames; ++frame) append_pose(motion, a, frame / fps);
  return motion;
}

MOTIONLANG_BODY std::vector<Motion> GlbFile::motions(std::optional<double> wanted) const {
  double frames = 0;
  std::size_t keys = 0;
  for (std::size_t i = 0; i < animations_.size(); ++i) {
    frames += frames_of(animations_[i], wanted ? *wanted : rate(static_cast<Index>(i)));
    keys += animations_[i].keys();
  }
  const double rotations = frames * skeleton().size(), most = most_rotations(keys),
               skeletons = std::ceil(static_cast<double>(animations_.size()) * skeleton_rotations());
  if (rotations + skeletons > most)
    raise<io_error>(405, file_, ": ", counted(animations_.size(), "animation"), ": ", rotations,
                    " rotations (frames x joints) and skeletons that take the memory of ", skeletons, ", at most ",
                    most, " of ", counted(keys, "key"));
  std::vector<Motion> out;
  for (std::size_t i = 0; i < animations_.size(); ++i) out.push_back(motion(static_cast<Index>(i), wanted));
  return out;
}

MOTIONLANG_BODY Motion GlbFile::motion(std::string_view animation, std::optional<double> fps) const {
  for (std::size_t i = 0; i < animations_.size(); ++i) {
    if (animations_[i].name() == animation) return motion(static_cast<Index>(i), fps);
  }
  raise<config_error>(103, file_, ": no animation '", animation, "' among ", animations_.size());
}

MOTIONLANG_BODY GlbFile::GlbFile(const detail::GltfDocument& document, Index skin)
    : file_(document.file()),
      nodes_(document.nodes()),
      animations_(load(document)),
      joints_(document, animations_, skin) {}

MOTIONLANG_BODY std::vector<detail::GltfAnimation> GlbFile::load(const detail::GltfDocument& document) {
  detail::SharedAccessors keys(document);
  std::vector<detail::GltfAnimation> out;
  for (Index i = 0; i < document.count("animations"); ++i) out.emplace_back(keys, i);
  return out;
}

MOTIONLANG_BODY const detail::GltfAnimation& GlbFile::at(Index animation) const {
  if (animation < 0 || animation >= static_cast<Index>(animations_.size())) {
    raise<config_error>(103, file_, ": animation ", animation, " of ", animations_.size());
  }
  return animations_[static_cast<std::size_t>(animation)];
}

MOTIONLANG_BODY double GlbFile::frames_of(const detail::GltfAnimation& a, double fps) const {
  if (!(fps > 0 && fps < 1e6)) raise<config_error>(101, file_, ": ", fps, " frames per second");
  const double last = a.duration() * fps;  // the time of the last key is a float
  return std::floor(last + std::max(1e-4, std::numeric_limits<float>::epsilon() * last)) + 1;
}

MOTIONLANG_BODY double GlbFile::most_rotations(std::size_t keys) {
  constexpr double most_of_any = 1e7, most_of_key = 16;
  return std::max(most_of_any, most_of_key * static_cast<double>(keys));
}

MOTIONLANG_BODY double GlbFile::skeleton_rotations() const {
  std::size_t bytes = 0;
  for (const std::string& name : skeleton().names)
    bytes += sizeof(std::string) + name.size() + sizeof(int) + sizeof(Vec3<double>);
  return static_cast<double>(bytes) / sizeof(Quaternion<double>);
}

MOTIONLANG_BODY detail::GltfTransform GlbFile::transform(const detail::GltfAnimation& a, int node, double time) const {
  return a.at(node, nodes_[static_cast<std::size_t>(node)].rest, time);
}

MOTIONLANG_BODY detail::GltfTransform GlbFile::root_in_world(const detail::GltfAnimation& a, double time) const {
  detail::GltfTransform world;
  for (int n = joints_.nodes.front(); n >= 0; n = nodes_[static_cast<std::size_t>(n)].parent) {
    const detail::GltfTransform t = transform(a, n, time);
    world.translation = t.translation + rotate(t.rotation, detail::scaled(t.scale, world.translation));
    world.rotation = normalized(t.rotation * world.rotation);
  }
  return world;
}

MOTIONLANG_BODY void GlbFile::append_pose(Motion& motion, const detail::GltfAnimation& a, double time) const {
  const detail::GltfTransform root = root_in_world(a, time);
  motion.root.push_back(root.translation);
  motion.local.push_back(normalized(root.rotation * inverse(joints_.rest_rotations.front())));
  for (std::size_t j = 1; j < joints_.nodes.size(); ++j) {
    const auto parent = static_cast<std::size_t>(skeleton().parents[j]);
    const Quaternion<double> r = transform(a, joints_.nodes[j], time).rotation;
    motion.local.push_back(normalized(joints_.rest_rotations[parent] * r * inverse(joints_.rest_rotations[j])));
  }
}

MOTIONLANG_BODY Motion read_glb(const FilePath& path, const GlbReadOptions& options) {
  const GlbFile file = GlbFile::open(path, options.skin);
  return options.animation.empty() ? file.motion(0, options.fps) : file.motion(options.animation, options.fps);
}

MOTIONLANG_NAMESPACE_END
