// What `generate` and `judge` share: a model over one of the backends, behind one interface.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/progress.hpp>
#include <motionlang/kinematics/motion.hpp>

#include "../usage_error.hpp"

namespace program {

namespace ml = motionlang;

/// What a diffusion model can tell besides its motions.
struct GenerationNotes {
  std::string layout{};                         // of the features
  std::vector<std::vector<double>> features{};  // of each motion before it was smoothed and put on its feet
  std::string reuse{};                          // what was taken over, in words
  std::optional<std::uint64_t> seed{};          // of the run that was reused
  double kept_moved = 0;                        // metres over the floor that any kept frame is from where it was
};

/// A motion of which something is kept: the model makes the rest.
struct KeptClip {
  ml::Motion motion;
  std::vector<std::pair<double, double>> seconds{};  // from, to; none: all of it
  ml::BodyParts parts = ml::BodyParts::all();        // the way over the ground belongs to the legs
};

struct GenerationSettings {
  std::uint64_t seed = 0;
  std::optional<ml::Index> steps{};  // 0: all; the model's own unless given
  std::string sampler{};             // ddpm or ddim; the model's own unless given
  std::optional<double> guidance{};  // the model's own unless given
  std::optional<double> fact{};      // scales the deviation of a latent from its mean; 1 unless given
  double overlap = 0.5;              // seconds around a cut
  bool cut_texts = true;             // where they lend body parts or get them back, and where they are too long
  bool smooth = true;                // no trembling, no jerk where texts meet
  bool fix_feet = true;              // feet that stand do not slide
  std::string noise_file{};          // noise/000, noise/001, ... instead of the seed
  std::string record_file{};         // where to write what a later run needs to reuse this one
  std::string reuse_file{};  // such a file; seed, steps, sampler, guidance, overlap and cut_texts are those of its run
  std::optional<double> keep_beyond{};     // seconds; what is further from the edit stays as it was
  std::shared_ptr<const KeptClip> keep{};  // of every timeline
  GenerationNotes* notes = nullptr;        // written if given
};

/// Few steps that still do as many prompts as all of them, as `motionlang judge --compare` measures it (README).
inline constexpr ml::Index fast_steps = 10;
inline void use_fast_preset(GenerationSettings& s) { s.sampler = "ddim", s.steps = fast_steps; }
inline void use_full_preset(GenerationSettings& s) { s.sampler = "ddpm", s.steps = 0; }

inline constexpr const char* diffusion_model = "a diffusion model";

/// A loaded model. Motions come back in the order of the timelines.
class Generator {
 public:
  virtual ~Generator() = default;
  virtual std::vector<ml::Motion> run(const std::vector<ml::Timeline>& timelines, const GenerationSettings& settings,
                                      ml::Progress progress) const = 0;
  virtual double fps() const = 0;
  /// What it is, for messages.
  virtual std::string system() const = 0;
  /// Steps of its diffusion; 0: it has none.
  virtual ml::Index steps() const { return 0; }
  /// Whether its texts are names of actions.
  virtual bool takes_actions() const { return false; }
  /// Whether its motions come from latents with noise in them.
  virtual bool draws_latents() const { return false; }
  /// The words of the texts that it learned from; none where its weights do not list them.
  virtual std::vector<std::string> words() const { return {}; }
  /// The word pieces of a text, and how many of them the model reads; none where it has others.
  struct TextLength {
    ml::Index pieces = 0, read = 0;
  };
  virtual TextLength length_of(const std::string&) const { return {}; }
};

/// What published models need from elsewhere; "": it is looked for beside them.
struct ModelSources {
  std::string text_encoder{};  // a folder or a file
  std::string statistics{};    // a folder with mean and std
  std::string tokenizer{};     // TM2T's folder of its motion tokenizer
};

/// model: a file of ours, a folder with one, a folder of train-actor, train-temos, train-sinc, train-teach or
/// train-tmr, or the folder of a published model: STMC, MDM, MotionDiffuse, ACTOR, TEMOS, TMR, TEACH, SINC, TM2T.
/// backend: eigen, xtensor or reference; throws usage_error 103 for another, and for another than eigen where texts or
/// actions do not go through STMC.
std::unique_ptr<Generator> load_generator(const std::string& backend, const std::filesystem::path& model,
                                          const ModelSources& sources = {});

// Two per backend, each in its own translation unit: models of ours, and published ones.
std::unique_ptr<Generator> load_eigen(const std::filesystem::path& model);
std::unique_ptr<Generator> load_xtensor(const std::filesystem::path& model);
std::unique_ptr<Generator> load_reference(const std::filesystem::path& model);
std::unique_ptr<Generator> load_published_eigen(const std::filesystem::path& run, const ModelSources& sources);
std::unique_ptr<Generator> load_published_xtensor(const std::filesystem::path& run, const ModelSources& sources);
std::unique_ptr<Generator> load_published_reference(const std::filesystem::path& run, const ModelSources& sources);
/// ACTOR takes the name or the number of an action as its text; ACTOR and TEMOS take one text for the whole body, TEACH
/// texts one after the other, SINC texts at the same time. load_temos looks which of the last three it is, as
/// system_of_run says it.
std::unique_ptr<Generator> load_actor(const std::filesystem::path& run);
std::unique_ptr<Generator> load_temos(const std::filesystem::path& run, const ModelSources& sources);
std::unique_ptr<Generator> load_teach(const std::filesystem::path& run, const ModelSources& sources);
std::unique_ptr<Generator> load_sinc(const std::filesystem::path& run, const ModelSources& sources);
/// The system of a folder as weights/run_folder.hpp finds it, where runs of TEACH and SINC look like those of TEMOS.
std::string system_of_run(const std::filesystem::path& run);
/// MDM's models of actions: the name or the number of an action. TM2T: one text; it decides itself how long the motion
/// is.
std::unique_ptr<Generator> load_mdm_actions(const std::filesystem::path& run);
std::unique_ptr<Generator> load_tm2t(const std::filesystem::path& run, const ModelSources& sources);
/// Folders of train-temos, train-sinc, train-teach and train-tmr, and of a published TMR; of train-actor.
std::unique_ptr<Generator> load_trained_text_motion(const std::filesystem::path& folder, const ModelSources& sources);
std::unique_ptr<Generator> load_trained_actor(const std::filesystem::path& folder);

/// The only text of a timeline. Throws timeline_error 509.
const ml::Interval& only_text(const ml::Timeline& timeline);
/// The number of an action that is given by its name or its number. Throws config_error 103 for what is no class.
ml::Index action_of(const std::string& text, std::span<const std::string> labels, ml::Index classes);
/// Throws usage_error 102 if there is a file of noise, a record or a motion to keep, which only models that go through
/// STMC take.
void require_no_noise(const GenerationSettings& settings);
/// Throws usage_error 102 if steps, sampler or guidance are given, for models without diffusion.
void require_no_sampling(const GenerationSettings& settings);
/// The same of a model without diffusion; of others 105 if more steps are wanted than it has.
void require_steps(const GenerationSettings& settings, const Generator& model);

}  // namespace program
