// SPDX-License-Identifier: MIT
// Bodies of glb_rig.hpp.
#pragma once

#include <algorithm>  // min
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
  const Index skins = document_->count("skins");
  if (skins < 2) {
    find_joints(0, find_table);
    return;
  }
  constexpr Index most_visits = 10'000'000, most_reasons = 8;  // each skin is looked for among all nodes
  const Index tried = std::min(skins, 1 + most_visits / (1 + std::ssize(document_->nodes())));
  std::string reasons;
  for (Index skin = 0; skin < tried; ++skin) {
    const auto find = [&] { find_joints(skin, find_table); };
    const auto not_it = [&](const config_error& e) {
      const std::string_view what = e.what();
      if (skin < most_reasons) reasons += concat_text("; skin ", skin, ": ", what.substr(what.find("] ") + 2));
      return e.id() == 103;
    };
    if (detail::guard<config_error>(find, not_it)) return;
  }
  raise<config_error>(103, file(), ": none of ", tried < skins ? concat_text("the first ", tried, " of ") : "",
                      counted(skins, "skin"), " is a body that is known", reasons);
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

MOTIONLANG_BODY void GlbRig::find_joints(Index skin, const FindTable& find_table) {
  std::vector<detail::GltfAnimation> animations;
  detail::SharedAccessors keys(*document_);
  if (document_->count("skins") == 0) {  // then joints are what moves
    for (Index i = 0; i < document_->count("animations"); ++i) animations.emplace_back(keys, i);
  }
  const detail::GltfSkeleton all(*document_, animations, skin);
  table_ = find_table(all.skeleton);
  const int pelvis = find_joint(all.skeleton, table_.find("pelvis")->source);
  if (all.nodes[static_cast<std::size_t>(pelvis)] < 0) {  // "root", which was made up over several trees
    raise<config_error>(103, file(), ": no node is the joint '", all.skeleton.name(pelvis), "'");
  }

  std::vector<int> number(all.nodes.size(), -1);  // of a joint of `all` in the skeleton from the pelvis down
  for (std::size_t j = 0; j < all.nodes.size(); ++j) {
    const int parent = all.skeleton.parents[j];
    const bool root = static_cast<int>(j) == pelvis;
    if (!root && (parent < 0 || number[static_cast<std::size_t>(parent)] < 0)) continue;
    number[j] = static_cast<int>(nodes_.size());
    nodes_.push_back(all.nodes[j]);
    rest_rotations_.push_back(all.rest_rotations[j]);
    skeleton_.names.push_back(all.skeleton.names[j]);
    skeleton_.parents.push_back(root ? -1 : number[static_cast<std::size_t>(parent)]);
    skeleton_.offsets.push_back(root ? all.skeleton.rest_positions()[j] : all.skeleton.offsets[j]);
  }
  skeleton_.validate();
  const std::vector<detail::GltfTransform> world = detail::world_at_rest(*document_);
  const int above = document_->node(nodes_.front()).parent;
  if (above >= 0) above_ = world[static_cast<std::size_t>(above)];
  if (const auto& s = above_.scale; !(s.x > 0 && s.y > 0 && s.z > 0)) {
    raise<io_error>(404, file(), ": the scale above '", skeleton_.name(0), "' is not positive");
  }
}

MOTIONLANG_BODY Motion GlbRig::in_nodes(Motion motion) const {
  const auto undo = inverse(above_.rotation);
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto local = motion.rotations(f);
    for (std::size_t j = 0; j < local.size(); ++j) {
      const int parent = skeleton_.parents[j];
      const auto up = parent < 0 ? above_.rotation : rest_rotations_[static_cast<std::size_t>(parent)];
      local[j] = inverse(up) * local[j] * rest_rotations_[j];
    }
    Vec3<double>& root = motion.root[static_cast<std::size_t>(f)];
    const Vec3<double> seen = rotate(undo, root - above_.translation);
    root = {seen.x / above_.scale.x, seen.y / above_.scale.y, seen.z / above_.scale.z};
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
