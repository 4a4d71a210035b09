// Motions on a body: the user's own of the SMPL family, or the free one. Apart from motion_files.cpp, for its backend
// takes time to compile.
#include <algorithm>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/formats/amass_body.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/figure_body.hpp>
#include <motionlang/view/body_view.hpp>

#include "../formatted.hpp"
#include "../usage_error.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

namespace fs = std::filesystem;
using B = ml::EigenBackend<float>;

std::string write(const fs::path& path, const ml::Body<B>& body, const std::string& name,
                  std::span<const ml::Motion> motions, const std::vector<float>& betas) {
  if (!ml::is_body_view(path, motions.size()))
    ml::raise<usage_error>(103, path.string(),
                           ": motions on a body are written to .glb and .html, one alone also to .obj, not '",
                           kind_of(path), "'");
  const ml::Index count = ml::write_on_body(path, body, motions, std::span<const float>(betas));
  const std::string files =
      kind_of(path) == ".obj" ? ml::concat_text(" in ", counted(count, "file"), ", one for each frame") : "";
  return ml::concat_text(path.string(), files, ": ", counted(motions.size(), "motion"), " on ", name, " of ",
                         body.model.vertices(), " vertices\n");
}

/// Capsules along the bones of whatever joints there are.
class FreeBody : public ShownBody {
 public:
  explicit FreeBody(const BodyOptions& o) : betas_(o.betas.begin(), o.betas.end()) {}
  bool has_joints_of(const ml::Motion&) const override { return true; }
  BodyClip read(const fs::path& npz, double fps) const override {
    return {ml::read_amass(npz, {}, fps).motion, {}, {}};
  }
  std::string write(const fs::path& path, std::vector<ml::Motion> motions, const std::vector<float>&) const override {
    if (motions.empty()) ml::raise<ml::config_error>(101, path.string(), ": no motion");
    auto body = ml::figure_body<B>(motions.front().skeleton);
    ml::prepare(body.model);
    return program::write(path, body, "the free body", motions, betas_);
  }

 private:
  std::vector<float> betas_;  // refused: it has no shapes
};

class OwnBody : public ShownBody {
 public:
  explicit OwnBody(const BodyOptions& o)
      : betas_(o.betas.begin(), o.betas.end()),
        body_(ml::read_body<B>(o.file, {.betas = std::ssize(betas_), .most_betas = amass_betas, .expressions = 0})),
        joints_(ml::body_skeleton(body_).names) {
    ml::prepare(body_.model);
    if (!betas_.empty()) betas_.resize(static_cast<std::size_t>(body_.model.shapedirs.size(1)));
  }
  bool has_joints_of(const ml::Motion& m) const override { return m.skeleton.names == joints_; }

  BodyClip read(const fs::path& npz, double fps) const override {
    const auto sequence = ml::read_amass_sequence(npz, fps);
    const std::string name = npz.stem().string();
    if (body_.kind == ml::BodyKind::other)
      return {ml::amass_motion(sequence, name),
              {},
              npz.string() + ": left out are hands and betas: the body is not one of SMPL's\n"};
    auto clip = ml::amass_on_body(sequence, name, body_);
    const bool has_more = !clip.parts.empty();
    if (betas_.empty()) {
      const auto last = std::find_if(sequence.betas.rbegin(), sequence.betas.rend(), [](double b) { return b != 0; });
      const bool fit = ml::has_shapes_of(sequence, body_.kind);
      const auto has = sequence.betas.rend() - last, common = fit ? std::min(has, std::ssize(clip.betas)) : 0;
      if (has > 0 && !fit) clip.left_out.push_back("betas, which are of other shapes");
      if (common > 0) clip.parts.push_back(ml::concat_text("betas 1 to ", common, " (", sequence.gender, ")"));
      if (fit && has > common) clip.left_out.push_back(ml::concat_text("betas ", common + 1, " to ", has));
    }
    std::string told = ml::join_text(clip.parts);
    if (!clip.left_out.empty())
      told += (told.empty() ? "left out are " : "; left out are ") + ml::join_text(clip.left_out);
    if (!told.empty()) told = npz.string() + " on " + to_string(body_.kind) + ": " + told + "\n";
    return {std::move(clip.motion), std::move(clip.betas), std::move(told), has_more};
  }
  std::string write(const fs::path& path, std::vector<ml::Motion> motions,
                    const std::vector<float>& betas) const override {
    for (ml::Motion& m : motions) {
      if (!has_joints_of(m)) m = on_smpl(m);
    }
    return program::write(path, body_, to_string(body_.kind), motions, betas_.empty() ? betas : betas_);
  }

 private:
  static constexpr ml::Index amass_betas = 16;
  std::vector<float> betas_;  // the user's, or none
  ml::Body<B> body_;
  std::vector<std::string> joints_;
};

}  // namespace

std::unique_ptr<const ShownBody> shown_body(const BodyOptions& options) {
  if (options.file.empty()) return nullptr;
  if (options.file == "free") return std::make_unique<FreeBody>(options);
  return std::make_unique<OwnBody>(options);
}

}  // namespace program
