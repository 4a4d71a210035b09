// SPDX-License-Identifier: MIT
// Bodies of glb_rig.hpp.
#pragma once

#include <algorithm>  // min
#include <optional>   // tables
#include <set>        // names of animations

#include <motionlang/file/file.hpp>
#include <motionlang/formats/detail/drop_animations.hpp>
#include <motionlang/formats/detail/gltf_document.hpp>
#include <motionlang/formats/glb_rig.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GlbRig GlbRig::open(const FilePath& path, const FindTable& find_table) {
  return GlbRig(MappedFile::open(path)->bytes(), path.string(), find_table);
}

MOTIONLANG_BODY GlbRig::GlbRig(std::span<const std::byte> bytes, std::string name, const FindTable& find_table)
    : bytes_(std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end())),
      document_(std::make_shared<const detail::GltfDocument>(*bytes_, std::move(name))) {
  const auto find = [&](const Skeleton& s) {
    std::optional<SkeletonTable> table;
    const auto not_it = [](const config_error& e) { return e.id() == 103; };
    detail::guard<config_error>([&] { table = find_table(s); }, not_it);
    return table;
  };
  std::vector<detail::GltfAnimation> animations;
  detail::SharedAccessors keys(*document_);
  if (document_->count("skins") == 0) {  // then joints may be what moves
    for (Index i = 0; i < document_->count("animations"); ++i) animations.emplace_back(keys, i);
  }
  const detail::GltfSkeleton figure = detail::GltfFigures(*document_, animations, {}, find).figures.front();
  if (!figure.table) refuse(find_table);
  table_ = *figure.table;
  skeleton_ = figure.skeleton;
  nodes_ = figure.nodes;
  std::vector<detail::GltfPlace> rest;
  above_ = figure.place([&](int n) { return document_->node(n).rest; }, rest);
  for (std::size_t j = 0; j < rest.size(); ++j) axes_.push_back(to_matrix(figure.lean[j]) * rest[j].axes());
  if (!detail::nearest_orthogonal(above_.linear))
    raise<io_error>(404, file(), ": a scale above '", skeleton_.name(0), "' is 0");
}

MOTIONLANG_BODY void GlbRig::refuse(const FindTable& find_table) const {
  const Index skins = document_->count("skins");
  std::vector<detail::GltfAnimation> animations;
  detail::SharedAccessors keys(*document_);
  for (Index i = 0; skins == 0 && i < document_->count("animations"); ++i) animations.emplace_back(keys, i);
  const auto joints_of = [&](std::optional<Index> skin) {
    const detail::GltfFigures all(*document_, animations, skin, [](const Skeleton&) { return std::nullopt; });
    return all.figures.front().skeleton;
  };
  constexpr Index most_reasons = 8;
  std::string reasons;
  for (Index skin = 0; skin < std::min(skins, most_reasons); ++skin) {
    const auto why = [&](const config_error& e) {
      const std::string_view what = e.what();
      reasons += concat_text("; skin ", skin, ": ", what.substr(what.find("] ") + 2));
      return skins > 1 && e.id() == 103;
    };
    detail::guard<config_error>([&] { find_table(joints_of(skin)); }, why);
  }
  if (skins == 0) find_table(joints_of({}));
  if (reasons.empty()) raise<config_error>(103, file(), ": no node is the root of all joints of the body");
  raise<config_error>(103, file(), ": none of ", counted(skins, "skin"), " is a body that is known", reasons);
}

MOTIONLANG_BODY const std::string& GlbRig::file() const { return document_->file(); }

MOTIONLANG_BODY SkeletonMap GlbRig::map_from(const Skeleton& source) const {
  return SkeletonMap(source, detect_skeleton_table(source), skeleton_, table_);
}

MOTIONLANG_BODY std::vector<std::byte> GlbRig::with(std::span<const Motion> motions,
                                                    const GlbRigOptions& options) const {
  if (motions.empty()) raise<config_error>(101, file(), ": no motion to add");
  for (const char* grows : {"accessors", "bufferViews", "animations"}) document_->count(grows);  // must be an array
  const detail::GlbChunks chunks = detail::parse_glb_chunks(*bytes_, file());
  detail::GlbBuilder glb(nlohmann::ordered_json::parse(chunks.text),
                         document_->count("buffers") > 0 ? document_->buffer(0) : std::span<const std::byte>());
  if (document_->count("buffers") > 0) glb.document["buffers"][0].erase("uri");
  if (!options.keep_animations) detail::drop_animations(glb);
  std::set<std::string> taken;
  for (Index i = 0; options.keep_animations && i < document_->count("animations"); ++i) {
    taken.insert(document_->element("animations", i).value_or("name", ""));
  }
  for (const Motion& motion : motions) {
    motion.validate();
    if (motion.frames() == 0) raise<config_error>(101, "GLB: motion '", motion.name, "' has no frames");
    Motion added = in_nodes(motion.skeleton == skeleton_ ? motion : retarget(motion, map_from(motion.skeleton)));
    const std::string name = motion.name.empty() ? "motion" : motion.name;
    added.name = name;
    for (int k = 2; !taken.insert(added.name).second; ++k) added.name = concat_text(name, "_", k);
    detail::add_animation(glb, added, moved_nodes(added));
  }
  return glb.finish();
}

MOTIONLANG_BODY Motion GlbRig::in_nodes(Motion motion) const {
  const Matrix3<double> up = above_.axes(), undo = transpose(detail::inverse_transposed(above_.linear));
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto local = motion.rotations(f);
    for (std::size_t j = 0; j < local.size(); ++j) {
      const int parent = skeleton_.parents[j];
      const Matrix3<double>& before = parent < 0 ? up : axes_[static_cast<std::size_t>(parent)];
      local[j] = normalized(to_quaternion(transpose(before) * to_matrix(local[j]) * axes_[j]));
    }
    Vec3<double>& root = motion.root[static_cast<std::size_t>(f)];
    root = undo * (root - above_.place);
  }
  return motion;
}

MOTIONLANG_BODY std::vector<int> GlbRig::moved_nodes(const Motion& motion) const {
  std::vector<int> nodes = nodes_;
  for (std::size_t j = 1; j < nodes.size(); ++j) {
    const auto& rest = document_->node(nodes_[j]).rest.rotation;
    bool moves = false;
    for (Index f = 0; f < motion.frames() && !moves; ++f) moves = distance(motion.rotations(f)[j], rest) > 1e-6;
    if (!moves) nodes[j] = -1;
  }
  return nodes;
}

MOTIONLANG_BODY void write_glb(const FilePath& path, const GlbRig& rig, std::span<const Motion> motions,
                               const GlbRigOptions& options) {
  write_file(path, rig.with(motions, options));
}

MOTIONLANG_BODY MotionsOnRig motions_on_rig(const GlbRig& rig, std::span<const Motion> motions) {
  MotionsOnRig out;
  std::optional<SkeletonMap> map;  // from the first motion's skeleton, unless it is the character's own
  if (!motions.empty() && motions.front().skeleton != rig.skeleton()) {
    map.emplace(rig.map_from(motions.front().skeleton));
    out.report = map->report();
  }
  for (const Motion& m : motions) {
    out.motions.push_back(m.skeleton == rig.skeleton()         ? m
                          : map && m.skeleton == map->source() ? retarget(m, *map)
                                                               : retarget(m, rig.map_from(m.skeleton)));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
