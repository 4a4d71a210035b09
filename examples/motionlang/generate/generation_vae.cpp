// ACTOR and TEMOS, as their repositories leave them, behind the Generator: one text, or one action, for each motion.
#include <charconv>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/io/vae_run.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../files/feature_motion.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

class ActorGenerator final : public EachAlone {
 public:
  explicit ActorGenerator(ml::ActorRun<B> run) : run_(std::move(run)) {}

  double fps() const override { return 20; }  // the viewer's, of the repository; data have none

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise) const override {
    const ml::Interval& wanted = only_text(timeline);
    const ml::Index action = action_of(wanted.text), frames = wanted.end - wanted.start;
    return motion_of(ml::generate(run_.model, std::span(&action, 1), std::span(&frames, 1), noise).rows.span());
  }
  /// Throws config_error 103 for what is no class.
  ml::Index action_of(const std::string& text) const {
    const ml::Index classes = run_.model.config.num_classes;
    const auto found = std::find(run_.labels.begin(), run_.labels.end(), text);
    if (found != run_.labels.end()) return found - run_.labels.begin();
    ml::Index number = -1;
    const char* const end = text.data() + text.size();
    if (std::from_chars(text.data(), end, number).ptr == end && number >= 0 && number < classes) return number;
    std::string known;
    for (const std::string& label : run_.labels) known += (known.empty() ? "; they are called " : ", ") + label;
    ml::raise<ml::config_error>(103, "action '", text, "' is none of 0 ... ", classes - 1, known);
  }

  /// Rows of rotations and the way of the root, on the floor. The figure of a camera's world is turned by 180 degrees about x.
  ml::Motion motion_of(std::span<const float> rows) const {
    const auto form = run_.features.rotations;
    const auto numbers = static_cast<std::size_t>(ml::size(form));
    const std::size_t width = static_cast<std::size_t>(run_.model.config.njoints) * numbers, given = run_.features.global ? 24 : 23;
    const auto upright = ml::from_axis_angle(ml::Vec3<double>{1, 0, 0}, std::numbers::pi);
    ml::Motion out{ml::smpl24_skeleton(), fps(), {}, {}, {}};
    for (std::size_t at = 0; at < rows.size(); at += width) {
      if (!run_.features.global) out.local.push_back(ml::Quaternion<double>::identity());
      for (std::size_t j = 0; j < given; ++j) {
        const auto own = rows.subspan(at + j * numbers, numbers);
        const auto q = ml::to_quaternion(ml::matrix_cast<double>(ml::rotation_from(form, own)));
        out.local.push_back(run_.features.global && j == 0 ? upright * q : q);
      }
      const float* way = rows.data() + at + given * numbers;
      out.root.push_back(run_.features.translation ? ml::Vec3<double>{way[0], -way[1], -way[2]} : ml::Vec3<double>{});
    }
    ml::place_on_floor(out);
    return out;
  }

  ml::ActorRun<B> run_;
};

class TemosGenerator final : public EachAlone {
 public:
  explicit TemosGenerator(ml::TemosRun<B> run) : run_(std::move(run)) {}

  double fps() const override { return run_.fps; }

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise) const override {
    const ml::Interval& wanted = only_text(timeline);
    const auto tokens = run_.text_encoder.encode<B>(std::span(&wanted.text, 1)).tokens;
    const auto x = ml::text_to_motion(run_.model, tokens, ml::Offsets{wanted.end - wanted.start}, noise);
    const auto rows = run_.normalizer.denormalize(x.front().rows);
    const std::vector<double> numbers(rows.span().begin(), rows.span().end());
    return motion_of_features(run_.width() == 64 ? "rifke" : "smplvelp", numbers, run_.width(), run_.fps);
  }

  ml::TemosRun<B> run_;
};

}  // namespace

std::unique_ptr<Generator> load_actor(const std::filesystem::path& run) {
  return std::make_unique<ActorGenerator>(ml::load_actor_run<B>(ml::FilePath(run)));
}
std::unique_ptr<Generator> load_temos(const std::filesystem::path& run, const ModelSources& sources) {
  const ml::RunFolder folder = ml::find_run(run);
  if (!folder.weights.empty()) {
    const std::string system = ml::lightning_system(ml::open_weights(folder.weights));
    if (system == "teach") return load_teach(run, sources);
    if (system == "sinc") return load_sinc(run, sources);
  }
  return std::make_unique<TemosGenerator>(
      ml::load_temos_run<B>(folder, {.text_encoder = sources.text_encoder, .statistics = sources.statistics}));
}

}  // namespace program
