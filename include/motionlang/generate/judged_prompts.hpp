// SPDX-License-Identifier: MIT
/// Prompts, and a judgement of motions for them: what a model can do, as tables of percentages. They can be compared
/// between models, numbers of steps and options.
///
///     const Judgement j = judge(*model, own_prompts(), {}, 10);             // ten seeds of each prompt
///     std::printf("%zu of %zu motions\n", j.done(), j.motions());
#pragma once

#include <functional>   // benches, rows of tables
#include <span>         // numbers of steps
#include <string>       // prompts
#include <string_view>  // files
#include <vector>       // motions

#include <motionlang/generate/judged_verbs.hpp>
#include <motionlang/generate/motion_model.hpp>
#include <motionlang/train/communicator.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A text of a prompt, the verb that judges it, its time and its body parts.
struct JudgedText {
  std::string text{};
  std::string verb{};
  BodyParts parts = BodyParts::all();
  double from = 0, to = 1;  // shares of the duration
};

/// A prompt: one text, or a base movement with a second text over it.
struct JudgedPrompt {
  std::vector<JudgedText> texts{};
  double seconds = 0;

  std::string name() const;  // "sit down + raise both arms"
  std::string rule() const;
  Timeline timeline(double fps) const;
  /// As `generate` makes it: one text for the whole body may be divided into its action and what follows.
  Timeline timeline(const MotionModel& model, const GenerateOptions& options) const;
};

/// Twelve prompts that the bundled model was trained for, each with the time that it takes.
std::vector<JudgedPrompt> own_prompts();
/// 56 short prompts that newcomers type.
std::vector<JudgedPrompt> newcomers_prompts(double seconds);
/// The right arm, the left arm and both arms over ten base movements.
std::vector<JudgedPrompt> arm_prompts(double seconds);
/// The head and the spine over the same movements.
std::vector<JudgedPrompt> trunk_prompts(double seconds);
/// Paraphrases of the prompts that the bundled model was trained for.
std::vector<JudgedPrompt> paraphrase_prompts(double seconds);

/// Prompts of a file with lines "text # verb" or "text # verb # seconds", such as "take a seat # sit down # 4".
/// The verbs are those of judged_verbs.hpp.
/// seconds  of the lines that name none; 0: 4
/// name     of the file, for messages
/// Throws   timeline_error 501, 502, 507 with the line, also for an unknown verb
std::vector<JudgedPrompt> parse_judged_prompts(std::string_view file, double seconds,
                                               std::string_view name = "prompts");

/// Prompts with a name and what they are about.
struct JudgedBench {
  std::string name{}, about{};
  std::function<std::vector<JudgedPrompt>(double seconds)> prompts{};  // of each prompt; 0: its own, which `own` has
  double seconds = 4;                                                  // that are judged unless others are asked for
};
/// All of them: own, newcomers, arms, trunk, paraphrases.
const std::vector<JudgedBench>& judged_benches();

/// The judgement of one motion.
struct Verdict {
  std::string why_not{};  // "" if it does what the prompt says
  bool hovers = false, sinks = false, still = false;
  double speed = 0, air = 0, turned = 0;  // m/s along the first heading; s, the longest flight; degrees
};
/// Judges a motion. `still` is never set for prompts that may stand still.
Verdict verdict(const JudgedPrompt& prompt, const Motion& motion);

/// The measurements of all prompts with all seeds. Means are taken over the motions.
struct Judgement {
  std::vector<JudgedPrompt> prompts{};
  std::vector<std::vector<Verdict>> verdicts{};        // of each prompt, seed by seed
  std::vector<std::vector<Vec3<double>>> positions{};  // of each motion (frames, joints), seed by seed
  std::vector<Motion> made{};                          // the same motions, if they are kept
  double skate = 0, jitter = 0;                        // m/s, m/s^3
  double bones = 0;    // largest change of the length of a bone between predicted positions, as a share of it
  double seconds = 0;  // of processor time for a second of motion

  /// The number of motions that do what a prompt says, for one prompt and for all.
  std::size_t done(std::size_t prompt) const;
  std::size_t done() const;
  std::size_t motions() const { return positions.size(); }
  /// Shares of all motions.
  double hovering() const;
  double sinking() const;
  double statues() const;
};

/// Makes all prompts with several seeds, from that of the options on, and judges them. The notes of the options have no
/// effect.
/// Their progress counts the steps of all seeds. Throws option_error 101 unless seeds is 1 or more, and what
/// generate_motions throws.
/// all  processes that share the seeds: each calls this function, and gets the same judgement as one process alone. The
///      communicator of the options counts only if this is one process; then it shares the motions of a seed
Judgement judge(const MotionModel& model, std::vector<JudgedPrompt> prompts, const GenerateOptions& options, int seeds,
                bool keep_motions = false, const AnyCommunicator& all = AnyCommunicator());

/// The captions with the texts of the judgements as tried texts, instead of those that they had. Only prompts of one
/// text for the whole body count.
KnownCaptions with_judged(const KnownCaptions& captions, std::span<const Judgement> judgements);

/// How well warnings about the meaning of texts (meaning_warnings) tell which motions fail.
struct WarningShares {
  std::size_t failures = 0, successes = 0;
  double silent_failures = 0;   // the share of the failures without a warning
  double warned_successes = 0;  // the share of the successes with one
};
/// Those of a model with its captions; all is 0 without them.
WarningShares warning_shares(const MotionModel& model, const Judgement& judgement);

/// Mean distance in metres between the joints of two judgements. In the second, motions are shifted by `shift`.
double mean_distance(const Judgement& a, const Judgement& b, std::size_t shift = 0);

/// The cost of fewer steps: a row of a table for one number of steps.
struct StepsCost {
  Index steps = 0;
  double done = 0, skate = 0, jitter = 0, bones = 0;  // a share of the motions; as in Judgement
  double away = 0;                                    // mean distance to the motions of the first row, metres
  double seconds = 0;                                 // of the processor for a second of motion
  double seeds_apart = 0;  // of the first row: mean distance between the motions of two seeds, if there are several
};
/// Judges the prompts with each number of steps. on_row receives each row when it is known. Throws what judge throws.
std::vector<StepsCost> steps_costs(const MotionModel& model, const std::vector<JudgedPrompt>& prompts,
                                   const GenerateOptions& options, std::span<const Index> steps, int seeds,
                                   const std::function<void(const StepsCost&)>& on_row = {});

/// True if a caption reports a verb, by the texts that the verb lists.
bool says(const JudgedVerb& verb, const std::string& caption);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/judged_prompts.ipp>
#endif
