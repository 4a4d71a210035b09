// SPDX-License-Identifier: MIT
// Bodies of temos_evaluation.hpp.
#pragma once

#include <algorithm>  // find_if
#include <cmath>      // remainder

#include <motionlang/train/temos_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TemosJoints::TemosJoints(const MotionFeatures& f)
    : features(f),
      mmm(f.joints == kit21_skeleton().size()),
      variant(mmm ? temos_rifke()
                  : RifkeVariant{.joints = 22, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .floor = {7, 10, 8, 11}}),
      unit(mmm ? 0.001 : 1) {}

MOTIONLANG_BODY JointFrames TemosJoints::operator()(std::span<const float> rows) const {
  if (selected) return selected(rows);
  const std::vector<double> values(rows.begin(), rows.end());
  if (!mmm) return detail::turned_up(features.joints_of(values), true);
  JointFrames joints = features.joints_of(values);
  for (auto& p : joints) p = detail::mmm_units_per_metre * Vec3<double>{-p.x, p.y, p.z};
  return joints;
}

namespace detail {

inline std::span<const float> rows_between(const DescribedMotion& motion, const FrameSlice& frames, Index width) {
  return std::span(motion.rows)
      .subspan(static_cast<std::size_t>(frames.first * width), static_cast<std::size_t>(frames.length * width));
}

inline bool is_multiple(double rate, double of) {
  return of > 0 && rate >= of && std::abs(std::remainder(rate, of)) < 1e-9 * rate;
}

MOTIONLANG_BODY TemosJoints joints_as_mmm(const MotionFeatures& features, const std::string& set) {
  if (!features.name.starts_with("smplvelp"))
    raise<config_error>(102, "MMM's joints of SMPL need a model of smplvelp, this one has '", features.name, "'");
  if (set != "mmm" && set != "mmmns") raise<config_error>(103, "joints '", set, "' are not mmm or mmmns");
  TemosJoints out(features);
  out.mmm = true;
  out.variant = temos_rifke();
  out.unit = set == "mmm" ? 0.001 : 1;
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::span<const float> first_text_rows(const DescribedMotion& motion, Index width) {
  return detail::rows_between(motion, motion.texts.front().frames, width);
}

MOTIONLANG_BODY std::span<const float> rows_of_text(const DescribedMotion& motion, const std::string& text,
                                                    Index width) {
  const auto found =
      std::find_if(motion.texts.begin(), motion.texts.end(), [&](const DescribedText& t) { return t.text == text; });
  if (found == motion.texts.end()) raise<config_error>(102, motion.id, " has no text '", text, "'");
  return detail::rows_between(motion, found->frames, width);
}

MOTIONLANG_BODY double rate_of_errors(double fps) { return detail::is_multiple(temos_rate, fps) ? temos_rate : fps; }

MOTIONLANG_BODY JointFrames joints_at_rate(const JointFrames& joints, Index per_frame, double from, double to) {
  if (from == to) return joints;
  if (!detail::is_multiple(to, from))
    raise<config_error>(101, "joints of ", from, " frames per second cannot be interpolated to ", to,
                        ", which is not a multiple");
  std::vector<double> values;
  values.reserve(3 * joints.size());
  for (const auto& p : joints) values.insert(values.end(), {p.x, p.y, p.z});
  const auto dense = upsample_linearly(std::span<const double>(values), 3 * per_frame, from, to);
  JointFrames out;
  out.reserve(dense.size() / 3);
  for (std::size_t i = 0; i < dense.size(); i += 3) out.push_back({dense[i], dense[i + 1], dense[i + 2]});
  return out;
}

MOTIONLANG_BODY std::vector<DescribedMotion> recorded_at(DataSources sources, const DataConfig& config,
                                                         const MotionFeatures& features, const std::string& part,
                                                         double rate, Progress progress) {
  if (!ready_made_features(sources).empty()) return {};
  RowMaker rows = row_maker(std::string(features.name));
  rows.fps = rate;
  const auto data = read_described_motions(sources, config, rows, progress);
  return data.part(part);
}

MOTIONLANG_NAMESPACE_END
