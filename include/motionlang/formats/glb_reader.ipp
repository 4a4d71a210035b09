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
#include <motionlang/kinematics/skeleton_tables.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The built-in table that fits a skeleton, if there is one.
inline std::optional<SkeletonTable> known_table(const Skeleton& skeleton) {
  const SkeletonTable* table = find_skeleton_table(skeleton);
  return table == nullptr ? std::nullopt : std::optional(*table);
}

/// Takes the frames of one motion, and measures which movement it lacks.
class GltfSampler {
 public:
  GltfSampler(const GltfSkeleton& figure, const std::vector<GltfNode>& nodes, const GltfAnimation& animation)
      : figure_(figure), nodes_(nodes), animation_(animation) {
    figure.place([&](int n) { return animation.rest(n, rest_of(n)); }, rest_);
    offsets_ = figure.skeleton.offsets;
    const auto scaled = [&](int n) { return has_other_scale(n); };
    const auto moved = [&](int n) { return has_other_place(n); };
    const bool other = std::any_of(figure.above.begin(), figure.above.end(), scaled) ||
                       std::any_of(figure.nodes.begin(), figure.nodes.end(), scaled) ||
                       std::any_of(figure.nodes.begin() + 1, figure.nodes.end(), moved);  // not the root itself
    if (other) offsets_ = leaning_offsets(figure, rest_);
    for (const GltfPlace& joint : rest_) size_ = std::max(size_, 2 * norm(joint.place - rest_.front().place));
  }

  Skeleton skeleton() const {
    Skeleton out = figure_.skeleton;
    out.offsets = offsets_;
    return out;
  }
  void append(Motion& motion, double time) {
    figure_.place([&](int n) { return animation_.at(n, rest_of(n), time); }, now_);
    turns_.resize(now_.size());
    places_.resize(now_.size());
    Vec3<double> sum{};
    for (std::size_t j = 0; j < now_.size(); ++j) {
      turns_[j] = turn_between(rest_[j], figure_.lean[j], now_[j]);
      if (j == 0) {
        places_[0] = now_[0].place;
        motion.root.push_back(places_[0]);
        motion.local.push_back(turns_[0]);
        continue;
      }
      const auto parent = static_cast<std::size_t>(figure_.skeleton.parents[j]);
      places_[j] = places_[parent] + rotate(turns_[parent], offsets_[j]);
      motion.local.push_back(normalized(inverse(turns_[parent]) * turns_[j]));
      const Vec3<double> lacks = now_[j].place - places_[j];
      sum = sum + lacks;
      if (norm(lacks) > loss_.distance)
        loss_.distance = norm(lacks), loss_.joint = figure_.skeleton.names[j], loss_.seconds = time;
    }
    sum = (1 / static_cast<double>(now_.size())) * sum;
    loss_.path = std::max(loss_.path, std::hypot(sum.x, sum.z));
  }
  GlbLoss loss() const {
    GlbLoss out = loss_;
    out.walk_lost = out.path > 0.1 * size_;
    return out;
  }

 private:
  const GltfTransform& rest_of(int n) const { return nodes_[static_cast<std::size_t>(n)].rest; }
  bool has_other_scale(int n) const {
    return n >= 0 && animation_.animates(n) && animation_.rest(n, rest_of(n)).scale != rest_of(n).scale;
  }
  bool has_other_place(int n) const {
    return n >= 0 && animation_.animates(n) && animation_.rest(n, rest_of(n)).translation != rest_of(n).translation;
  }

  const GltfSkeleton& figure_;
  const std::vector<GltfNode>& nodes_;
  const GltfAnimation& animation_;
  std::vector<GltfPlace> rest_, now_;
  std::vector<Vec3<double>> offsets_, places_;
  std::vector<Quaternion<double>> turns_;
  GlbLoss loss_;
  double size_ = 0;
};

}  // namespace detail

MOTIONLANG_BODY GlbFile GlbFile::open(const FilePath& path, std::optional<Index> skin, const FindTable& find_table) {
  return GlbFile(MappedFile::open(path)->bytes(), path.string(), skin, find_table);
}

MOTIONLANG_BODY GlbFile::GlbFile(std::span<const std::byte> bytes, std::string name, std::optional<Index> skin,
                                 const FindTable& find_table)
    : GlbFile(detail::GltfDocument(bytes, std::move(name)), skin, find_table ? find_table : detail::known_table) {}

MOTIONLANG_BODY GlbFile::GlbFile(const detail::GltfDocument& document, std::optional<Index> skin,
                                 const FindTable& find_table)
    : file_(document.file()),
      repairs_(document.repairs()),
      nodes_(document.nodes()),
      animations_(load(document)),
      figures_(detail::GltfFigures(document, animations_, skin, find_table).figures) {
  for (const detail::GltfSkeleton& figure : figures_) {
    moving_of_.push_back(figure.moving_nodes());
    moving_.insert(moving_.end(), moving_of_.back().begin(), moving_of_.back().end());
  }
  std::sort(moving_.begin(), moving_.end());
  moving_.erase(std::unique(moving_.begin(), moving_.end()), moving_.end());
}

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

MOTIONLANG_BODY const detail::GltfSkeleton& GlbFile::of(Index figure) const {
  if (figure < 0 || figure >= figures()) raise<config_error>(103, file_, ": figure ", figure, " of ", figures());
  return figures_[static_cast<std::size_t>(figure)];
}

MOTIONLANG_BODY const std::vector<int>& GlbFile::moving_of(Index figure) const {
  of(figure);
  return moving_of_[static_cast<std::size_t>(figure)];
}

MOTIONLANG_BODY std::string GlbFile::figure_name(Index figure) const {
  const detail::GltfSkeleton& s = of(figure);
  for (const int n : s.above) {
    bool shared = false;
    for (Index other = 0; other < figures(); ++other)
      shared = shared || (other != figure && std::binary_search(moving_of(other).begin(), moving_of(other).end(), n));
    if (!shared) return nodes_[static_cast<std::size_t>(n)].name;
  }
  return s.skeleton.names.front();
}

MOTIONLANG_BODY std::vector<std::string> GlbFile::animation_names() const {
  std::vector<std::string> out;
  for (const auto& a : animations_) out.push_back(a.name());
  return out;
}

MOTIONLANG_BODY bool GlbFile::moves(Index animation, Index figure) const {
  return at(animation).timing(moving_of(figure)).keys > 0;
}

MOTIONLANG_BODY double GlbFile::duration(Index animation) const { return at(animation).timing(moving_).last; }

MOTIONLANG_BODY std::vector<std::string> GlbFile::stretched_joints(Index animation, Index figure) const {
  const detail::GltfAnimation& a = at(animation);
  const detail::GltfSkeleton& s = of(figure);
  std::vector<std::string> names;
  for (std::size_t j = 1; j < s.nodes.size(); ++j) {
    const int node = s.nodes[j], before = s.nodes[static_cast<std::size_t>(s.skeleton.parents[j])];
    const bool stretched = before >= 0 && a.grows(before, a.rest(before, rest_of(before)).scale);
    if (stretched || a.moves_away(node, a.rest(node, rest_of(node)).translation)) names.push_back(s.skeleton.names[j]);
  }
  return names;
}

MOTIONLANG_BODY std::vector<std::string> GlbFile::moving_others() const {
  std::vector<std::string> names;
  for (int n = 0; n < static_cast<int>(nodes_.size()); ++n) {
    if (std::binary_search(moving_.begin(), moving_.end(), n)) continue;
    if (std::any_of(animations_.begin(), animations_.end(), [&](const auto& a) { return a.moves(n, rest_of(n)); }))
      names.push_back(nodes_[static_cast<std::size_t>(n)].name);
  }
  return names;
}

MOTIONLANG_BODY std::vector<std::string> GlbFile::repairs() const {
  std::vector<std::string> out = repairs_;
  for (const detail::GltfAnimation& a : animations_) {
    for (const std::string& repair : a.repairs()) out.push_back(concat_text("animation '", a.name(), "' ", repair));
  }
  return out;
}

MOTIONLANG_BODY double GlbFile::rate(Index animation, Index figure) const {
  const detail::GltfTiming timing = at(animation).timing(moving_of(figure));
  constexpr double slowest = 10, fastest = 1000, usual = 30, smooth = 20, closest = 240;
  if (!timing.rate) return timing.usual > 0 ? std::clamp(std::round(1 / timing.usual), usual, closest) : usual;
  const double own = *timing.rate;
  if (!(own >= 1 && own <= fastest)) return usual;
  const bool each = timing.dense && own >= slowest;
  const double least = timing.cubic ? usual : each ? own : own < slowest ? usual : smooth;
  const double times = std::ceil(least / own - 1e-9);
  return times <= 1 ? own : times * own;
}

MOTIONLANG_BODY double GlbFile::begin_of(Index animation, Index figure, double fps) const {
  const detail::GltfTiming timing = at(animation).timing(moving_of(figure));
  constexpr double same = 0.01;  // of a frame
  const double frames = timing.rate ? fps / *timing.rate : 0, frame = timing.first * fps;
  if (!(frames > 0.5) || std::abs(frames - std::round(frames)) > same) return 0;  // keys are not at whole frames
  const double part = frame - std::floor(frame + same);
  return part < same ? 0 : part / fps;
}

MOTIONLANG_BODY double GlbFile::frames_of(Index animation, Index figure, double fps) const {
  if (!(fps > 0 && fps < 1e6)) raise<config_error>(101, file_, ": ", fps, " frames per second");
  if (!moves(animation, figure)) return 1;
  const double last = std::max(0.0, duration(animation) - begin_of(animation, figure, fps)) * fps;
  // The time of the last key is a float.
  return std::floor(last + std::max(1e-4, std::numeric_limits<float>::epsilon() * last)) + 1;
}

MOTIONLANG_BODY double GlbFile::most_rotations(std::size_t keys) {
  constexpr double most_of_any = 1e7, most_of_key = 16;
  return std::max(most_of_any, most_of_key * static_cast<double>(keys));
}

MOTIONLANG_BODY double GlbFile::skeleton_rotations(const Skeleton& skeleton) {
  std::size_t bytes = 0;
  for (const std::string& name : skeleton.names)
    bytes += sizeof(std::string) + name.size() + sizeof(int) + sizeof(Vec3<double>);
  return static_cast<double>(bytes) / sizeof(Quaternion<double>);
}

MOTIONLANG_BODY Motion GlbFile::motion(Index animation, std::optional<double> wanted, Index figure,
                                       GlbLoss* loss) const {
  const detail::GltfAnimation& a = at(animation);
  const double fps = wanted ? *wanted : rate(animation, figure), frames = frames_of(animation, figure, fps);
  const std::size_t keys = a.timing(moving_).keys;
  const double rotations = frames * skeleton(figure).size(), most = most_rotations(keys);
  const double most_frames = std::max(1e6, static_cast<double>(keys));
  if (rotations > most || frames > most_frames)
    raise<io_error>(405, file_, ": animation '", a.name(), "' of ", duration(animation), " s at ", fps,
                    " per second: ", rotations > most ? rotations : frames,
                    rotations > most ? " rotations (frames x joints), at most " : " frames, at most ",
                    rotations > most ? most : most_frames, " of ", counted(keys, "key"));
  detail::GltfSampler sampler(of(figure), nodes_, a);
  Motion motion{sampler.skeleton(), fps, {}, {}, a.name()};
  motion.root.reserve(static_cast<std::size_t>(frames));
  motion.local.reserve(static_cast<std::size_t>(frames) * of(figure).nodes.size());
  const double begin = begin_of(animation, figure, fps);
  for (double frame = 0; frame < frames; ++frame) sampler.append(motion, begin + frame / fps);
  if (loss != nullptr) *loss = sampler.loss();
  return motion;
}

MOTIONLANG_BODY std::vector<std::pair<Index, Index>> GlbFile::pairs() const {
  std::vector<std::pair<Index, Index>> out;
  for (Index a = 0; a < std::ssize(animations_); ++a) {
    for (Index f = 0; f < figures(); ++f) {
      if (moves(a, f)) out.emplace_back(a, f);
    }
  }
  if (!out.empty()) return out;
  for (Index a = 0; a < std::ssize(animations_); ++a) out.emplace_back(a, 0);
  return out;
}

MOTIONLANG_BODY std::vector<Motion> GlbFile::motions(std::optional<double> wanted, std::vector<GlbLoss>* losses) const {
  double rotations = 0, skeletons = 0;
  std::size_t keys = 0;
  const auto all = pairs();
  for (const auto& [a, f] : all) {
    rotations += frames_of(a, f, wanted ? *wanted : rate(a, f)) * skeleton(f).size();
    skeletons += skeleton_rotations(skeleton(f));
    keys += at(a).timing(moving_of(f)).keys;
  }
  const double most = most_rotations(keys);
  skeletons = std::ceil(skeletons);
  if (rotations + skeletons > most)
    raise<io_error>(405, file_, ": ", counted(animations_.size(), "animation"), ": ", rotations,
                    " rotations (frames x joints) and skeletons that take the memory of ", skeletons, ", at most ",
                    most, " of ", counted(keys, "key"));
  std::vector<Motion> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [a, f] = all[i];
    GlbLoss loss;
    out.push_back(motion(a, wanted, f, &loss));
    const bool shared = (i > 0 && all[i - 1].first == a) || (i + 1 < all.size() && all[i + 1].first == a);
    if (shared) out.back().name += " " + figure_name(f);
    if (losses != nullptr) losses->push_back(std::move(loss));
  }
  return out;
}

MOTIONLANG_BODY Motion GlbFile::motion(std::string_view animation, std::optional<double> fps) const {
  for (std::size_t i = 0; i < animations_.size(); ++i) {
    if (animations_[i].name() == animation) return motion(static_cast<Index>(i), fps);
  }
  raise<config_error>(103, file_, ": no animation '", animation, "' among ", animations_.size());
}

MOTIONLANG_BODY Motion read_glb(const FilePath& path, const GlbReadOptions& options) {
  const GlbFile file = GlbFile::open(path, options.skin);
  return options.animation.empty() ? file.motion(0, options.fps) : file.motion(options.animation, options.fps);
}

MOTIONLANG_NAMESPACE_END
