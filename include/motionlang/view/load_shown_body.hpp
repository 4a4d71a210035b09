// SPDX-License-Identifier: MIT
/// Bodies that show motions: the user's own of the SMPL family, or the free one of capsules. A body is read once, for
/// all motions.
///
///     const auto body = load_shown_body<B>({.file = "SMPLH_NEUTRAL.npz"});
///     const BodyClip clip = body->read("amass/walk.npz");
///     body->write("walk.glb", {clip.motion}, clip.betas);
#pragma once

#include <algorithm>  // find_if
#include <memory>     // the body
#include <span>       // motions
#include <utility>    // move

#include <motionlang/formats/amass_body.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/figure_body.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/view/body_view.hpp>
#include <motionlang/view/shown_body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Capsules along the bones of any joints.
template <Backend B>
class FreeShownBody final : public ShownBody {
  using S = typename B::scalar;

 public:
  explicit FreeShownBody(const ShownBodyOptions& o) {
    for (const double b : o.betas) betas_.push_back(static_cast<S>(b));
  }
  bool has_joints_of(const Motion&) const override { return true; }
  bool takes_any_joints() const override { return true; }
  BodyClip read(const std::filesystem::path& npz, double fps) const override {
    return {read_amass(npz, {}, fps).motion, {}, {}};
  }
  BodyFiles write(const std::filesystem::path& path, std::vector<Motion> motions,
                  const std::vector<float>&) const override {
    if (motions.empty()) raise<config_error>(101, path.string(), ": no motion");
    auto body = figure_body<B>(motions.front().skeleton);
    prepare(body.model);
    const Index files = write_on_body(path, body, std::span<const Motion>(motions), std::span<const S>(betas_));
    return {"the free body", body.model.vertices(), files};
  }

 private:
  std::vector<S> betas_;  // refused: the free body has no shapes
};

template <Backend B>
class OwnShownBody final : public ShownBody {
  using S = typename B::scalar;

 public:
  explicit OwnShownBody(const ShownBodyOptions& o)
      : body_(read_body<B>(o.file, {.betas = std::ssize(o.betas), .most_betas = amass_betas, .expressions = 0})),
        joints_(body_skeleton(body_).names) {
    prepare(body_.model);
    for (const double b : o.betas) betas_.push_back(static_cast<S>(b));
    if (!betas_.empty()) betas_.resize(static_cast<std::size_t>(body_.model.shapedirs.size(1)));
  }
  bool has_joints_of(const Motion& m) const override { return m.skeleton.names == joints_; }

  BodyClip read(const std::filesystem::path& npz, double fps) const override {
    const auto sequence = read_amass_sequence(npz, fps);
    const std::string name = npz.stem().string();
    if (body_.kind == BodyKind::other)
      return {amass_motion(sequence, name),
              {},
              npz.string() + ": left out: hands and betas: the body is not one of SMPL's\n"};
    auto clip = amass_on_body(sequence, name, body_);
    const bool has_more = !clip.parts.empty();
    if (betas_.empty()) {
      const auto last = std::find_if(sequence.betas.rbegin(), sequence.betas.rend(), [](double b) { return b != 0; });
      const bool fit = has_shapes_of(sequence, body_.kind);
      const auto has = sequence.betas.rend() - last, common = fit ? std::min(has, std::ssize(clip.betas)) : 0;
      if (has > 0 && !fit) clip.left_out.push_back("betas, which are of other shapes");
      if (common > 0) clip.parts.push_back(concat_text("betas 1 to ", common, " (", sequence.gender, ")"));
      if (fit && has > common) clip.left_out.push_back(concat_text("betas ", common + 1, " to ", has));
    }
    std::string notes = join_text(clip.parts);
    if (!clip.left_out.empty()) notes += (notes.empty() ? "left out: " : "; left out: ") + join_text(clip.left_out);
    if (!notes.empty()) notes = npz.string() + " on " + to_string(body_.kind) + ": " + notes + "\n";
    return {std::move(clip.motion), {clip.betas.begin(), clip.betas.end()}, std::move(notes), has_more};
  }
  BodyFiles write(const std::filesystem::path& path, std::vector<Motion> motions,
                  const std::vector<float>& betas) const override {
    for (Motion& m : motions) {
      if (!has_joints_of(m)) m = on_smpl(m);
    }
    const std::vector<S> shape = betas_.empty() ? std::vector<S>(betas.begin(), betas.end()) : betas_;
    const Index files = write_on_body(path, body_, std::span<const Motion>(motions), std::span<const S>(shape));
    return {to_string(body_.kind), body_.model.vertices(), files};
  }

 private:
  static constexpr Index amass_betas = 16;
  std::vector<S> betas_;  // the user's, or none
  Body<B> body_;
  std::vector<std::string> joints_;
};

}  // namespace detail

/// Throws what read_body throws.
template <Backend B>
std::unique_ptr<const ShownBody> load_shown_body(const ShownBodyOptions& options) {
  if (options.file == "free") return std::make_unique<detail::FreeShownBody<B>>(options);
  return std::make_unique<detail::OwnShownBody<B>>(options);
}

MOTIONLANG_NAMESPACE_END
