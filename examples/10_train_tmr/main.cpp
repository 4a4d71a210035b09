// Trains TMR on a folder of BVH files with a table of captions, then finds clips by texts.
//     10_train_tmr [FOLDER]     with FOLDER/captions.tsv; the default is twelve generated clips
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <string>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/search/unit_rows.hpp>
#include <motionlang/train/tmr_training.hpp>
#include <motionlang/weights/tmr_checkpoint.hpp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;  // the same with a tape

/// Three seconds of a person who walks ahead, or who stands and raises both arms; `i` makes clips differ.
ml::Motion clip(bool walks, int i) {
  ml::Motion m{ml::smpl24_skeleton(), 20, {}, {}, walks ? "walk" : "arms"};
  for (int f = 0; f < 60; ++f) {
    const double t = f / 20.0, swing = std::sin((5 + 0.3 * i) * t);
    std::vector<ml::Quaternion<double>> pose(24, ml::Quaternion<double>::identity());
    pose[1] = ml::from_axis_angle(ml::Vec3<double>{1, 0, 0}, walks ? 0.5 * swing : 0);         // left hip
    pose[2] = ml::from_axis_angle(ml::Vec3<double>{1, 0, 0}, walks ? -0.5 * swing : 0);        // right hip
    pose[16] = ml::from_axis_angle(ml::Vec3<double>{0, 0, 1}, walks ? -1.3 : -1.3 + 0.9 * t);  // left shoulder
    pose[17] = ml::from_axis_angle(ml::Vec3<double>{0, 0, 1}, walks ? 1.3 : 1.3 - 0.9 * t);    // right shoulder
    m.root.push_back({0, 0.95, walks ? (1 + 0.05 * i) * t : 0});
    m.local.insert(m.local.end(), pose.begin(), pose.end());
  }
  return m;
}
std::filesystem::path made_up_clips() {
  std::filesystem::create_directories("clips");
  std::string table;  // clip, captions: of the whole clip
  for (int i = 0; i < 12; ++i) {
    const bool walks = i % 2 == 0;
    const std::string name = (walks ? "walk" : "arms") + std::to_string(i);
    ml::write_bvh("clips/" + name + ".bvh", clip(walks, i));
    table += name + (walks ? "\ta person walks ahead | someone walks\n" : "\ta person raises both arms | arms go up\n");
  }
  ml::write_file("clips/captions.tsv", table);
  return "clips";
}

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? std::filesystem::path(argv[1]) : made_up_clips();
  ml::TextMotionConfig config = ml::tmr_preset("small");
  config.network = {.latent_dim = 32, .ff_size = 32, .num_layers = 1, .num_heads = 2};
  config.text.width = 32, config.text.vocabulary = 60;
  config.optimiser.lr = 2e-3, config.optimiser.warmup = 5, config.optimiser.epochs = 40, config.optimiser.batch = 8;
  config.validation.keep_best = false;  // one validation clip is too few to choose weights
  const auto data = ml::read_described_motions({.data = folder, .captions = folder / "captions.tsv"}, config.data,
                                               ml::row_maker(config.features));
  double first = 0, last = 0;
  const auto watch = [&](const ml::TrainingProgress& p) {
    (p.step == 1 ? first : last) = p.loss;
    return true;  // false: saves and stops; a run without .fresh continues from there
  };
  ml::train(ml::TmrTraining<A>(config, data), {.out = "run", .fresh = true},
            {{"license", "as the clips"}, {"provenance", "example 10"}}, {.progress = watch});
  std::printf("the loss fell to less than half: %s\n", last < first / 2 ? "yes" : "no");
  const auto tmr = ml::load_tmr<B>("run");
  for (const std::string text : {"someone walks", "arms go up"}) {
    const auto wanted = ml::unit_rows(tmr.encode_text(text).to_vector(), config.network.latent_dim);
    std::string found;
    float best = -2;
    for (const auto& file : ml::motion_files_below(folder)) {
      const auto motion = ml::read_motion(file);
      const auto latent = ml::unit_rows(tmr.encode_motion(motion).to_vector(), config.network.latent_dim);
      const float alike = std::inner_product(wanted.begin(), wanted.end(), latent.begin(), 0.0f);
      if (alike > best) best = alike, found = file.stem().string();
    }
    std::printf("'%s' finds a clip of '%s'\n", text.c_str(), found.substr(0, 4).c_str());
  }
}
