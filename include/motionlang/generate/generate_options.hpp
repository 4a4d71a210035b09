// SPDX-License-Identifier: MIT
/// Options for generating a motion from a timeline, in one struct for every model.
///
///     const Motion a = generate_motion(stmc, timeline, {.seed = 7});
///     const Motion b = generate_motion(stmc, timeline, {.seed = 7, .steps = 10, .smooth = false});
///
/// The defaults are those of the program `motionlang generate`.
#pragma once

#include <cstdint>   // seeds
#include <optional>  // what the caller leaves to the model
#include <span>      // timelines of a list
#include <string>    // names
#include <utility>   // pairs of times
#include <vector>    // motions

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/option_error.hpp>
#include <motionlang/diffusion/sampler.hpp>
#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/systems/stmc_reuse.hpp>
#include <motionlang/train/communicator.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A motion of which a part is kept. The model makes the rest. Its frame 0 is that of the timeline.
struct KeptClip {
  Motion motion{};                                   // on any skeleton that can be put on SMPL's joints, at any rate
  std::vector<std::pair<double, double>> seconds{};  // from and to, of the kept parts; none: all of it
  BodyParts parts = BodyParts::all();                // the kept parts; the path over the floor belongs to the legs
};

/// The report of a run besides its motions. Only models that go through STMC fill it.
struct GenerateNotes {
  std::string layout{};                         // of the features
  std::vector<std::vector<double>> features{};  // of each motion, before smoothing and foot fixing
  std::optional<StmcReuse> reuse{};             // how much was reused
  std::optional<std::uint64_t> seed{};          // of the run that is reused
  double kept_moved = 0;  // the largest distance of a kept frame from its old place, metres on the floor
};

struct GenerateOptions {
  std::uint64_t seed = 0;                             // same seed, same motion, on any number of threads
  std::optional<Index> steps{};                       // of denoising, 0: all; the default is the model's
  std::optional<SamplingOptions::Sampler> sampler{};  // the default is the model's
  std::optional<NoiseScale> noise_scale{};            // of ddpm; the default is the model's
  std::optional<double> guidance{};                   // weight of the text, 1: none; the default is the model's
  std::optional<double> recall{};  // share of motions that the model remembers, 0 ... 1; the default is 0.9
  std::optional<double> fact{};    // scales the latent noise: 0 gives the mean motion; the default is 1
  StmcMode mode = StmcMode::stmc;  // or a baseline, which never cuts texts
  double overlap = 0.5;            // seconds that neighbouring texts share around a cut
  bool cut_texts = true;           // where they lend body parts or regain them, and where they are too long
  bool smooth = true;              // removes jitter, and jerks where texts meet
  bool fix_feet = true;            // keeps standing feet from sliding
  bool fix_floor = true;           // the floor carries the body: no hovering, no sinking, flights are arcs
  bool overlay_arms = false;       // an arm that loses its text moves as the text alone moves it; a second pass
  FilePath noise = "";             // file with noise/000 (initial), noise/001, ... instead of the seed
  FilePath record = "";            // file to write, which a later run can reuse
  FilePath reuse = "";  // such a file; seed, steps, sampler, guidance, overlap and cut_texts are those of its run
  std::optional<double> keep_beyond{};  // with reuse: keep frames that are further from the edit than this, in seconds
  std::optional<KeptClip> keep{};       // for every timeline
  Progress progress{};                  // called after every step, or after every motion; may cancel
  GenerateNotes* notes = nullptr;       // filled if given
  /// The timelines before these in a longer list, of which these are a part. Their motions have the bits that they have
  /// in the whole list. Without noise, record and reuse.
  std::span<const Timeline> before{};
  /// The processes that share the timelines: all call the function, and get the motions of one process.
  AnyCommunicator communicator{};
};

/// True if a text that ends may be divided into its action and what follows (compose/text_timeline.hpp).
inline bool ends_actions(const GenerateOptions& o) { return o.cut_texts && o.mode == StmcMode::stmc; }

/// A small number of steps that does as many prompts as all steps, measured by `motionlang judge --compare`.
inline constexpr Index fast_steps = 10;
inline void use_fast_preset(GenerateOptions& o) { o.sampler = SamplingOptions::Sampler::ddim, o.steps = fast_steps; }
inline void use_full_preset(GenerateOptions& o) { o.sampler = SamplingOptions::Sampler::ddpm, o.steps = 0; }

MOTIONLANG_NAMESPACE_END
