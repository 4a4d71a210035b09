// motionlang evaluate: what a trained STMC, ACTOR, TEMOS, TMR, SINC, TEACH or TM2T is worth.
#pragma once

#include <filesystem>
#include <optional>

#include <motionlang/compose/teach_join.hpp>
#include <motionlang/text/joined_labels.hpp>

#include <motionlang/backend/eigen.hpp>

#include "../machine_options.hpp"

namespace program {

namespace ml = motionlang;

/// The backend of all evaluations.
using EvaluationBackend = ml::EigenBackend<float>;

struct EvaluationOptions {
  std::filesystem::path model, data, captions, labels, annotations, splits, text_encoder, sentence_encoder, nsim,
      strips, classifier, generator, statistics, tokenizer, body, regressor, babel, validation, spelling, body_parts,
      temos, independent, joint, keys, tags, evaluator, evaluator_words, evaluator_statistics, bert, texts, timelines,
      made, recorded, tmr, tmr_text_encoder, generator_text_encoder, generator_statistics, html;
  bool synthesis = false;  // TMR: also motions that are made for the texts, by itself or by the generator
  std::string part = "test";
  std::string dataset;                 // of actions, in its own files
  double threshold = 0.95;             // texts more similar than that count as the same
  ml::Index samples = 10;              // of TEMOS, SINC and TEACH, for each text
  ml::Index count = 20;                // film strips
  ml::Index seeds = 20;                // of ACTOR, and TM2T's motions
  std::vector<ml::Index> durations{};  // frames of motions of ACTOR; none: those of recorded motions
  ml::Index repeats = 30;              // motions of a text that multimodality compares
  ml::Index time = 0;                  // motions whose generation is timed, with an evaluator
  ml::Index moments = 0;               // long motions in which TMR searches texts; 0: it searches whole clips
  ml::Index joined = 5;                // clips in each
  std::vector<double> windows{};       // seconds of the stretches to compare; none: as --moments says
  double stride = 0;                   // seconds between their starts; 0: as --moments says
  bool filtered = false;               // the share of negatives that TMR's training leaves out
  std::string items = "pairs";         // of SINC: pairs, unseen, single or all
  ml::Index longest = 0;               // frames of its items; 0: as --items says
  ml::Conjunction conjunction = ml::Conjunction::same_time;  // of the labels, of SINC
  ml::Alignment alignment = ml::Alignment::full;             // for the second action of TEACH
  ml::Index slerp_window = 8;                                // interpolated frames between both actions
  double rate = 0;                     // of the joints that TEMOS compares; 0: 100, or the rate of the data
  double made_rate = 0;                // of arrays of joints in `made`; 0: as published
  std::string joints;                  // of TEMOS: mmm, mmmns; "": those of its features
  std::string bert_baseline = "none";  // none, tm2t or random
  ml::Index bert_layer = 0;            // of BERTScore; 0: the last one
  // These belong to STMC:
  std::optional<ml::Index> first{};  // timelines that are measured, from the first on
  std::vector<std::string> modes{};  // rows of methods; none: all
  double overlap = 0.5;              // of these, seconds
  std::vector<double> overlaps{};    // rows of overlaps
  ml::Index batch = 50;              // timelines that are sampled together
  std::optional<ml::Index> steps{};  // the model's own
  std::optional<double> guidance{};  // the model's own
  std::string noise_factor;          // "": the model's own
  std::string table = "text";
  std::uint64_t seed = 0;
  MachineOptions machine;
};

/// Retrieval in both directions by the four protocols, for recorded motions and for motions generated from the texts;
/// or evaluate_moments, if motions for it are asked for.
void evaluate_tmr(const EvaluationOptions& o);
/// Errors of generated motions, and those of the mean pose and of random clips, for a model trained here or published.
void evaluate_temos(const EvaluationOptions& o);

/// Errors of motions for several simultaneous labels, or for single ones; the TEMOS score. For a model trained here or
/// published.
void evaluate_sinc(const EvaluationOptions& o);
/// Errors of two actions in sequence, and the jump between them, compared with baselines. For a model trained here or
/// published.
void evaluate_teach(const EvaluationOptions& o);

/// Accuracy, FID, diversity and multimodality over seeds, for recorded, generated, denoised and interpolated motions.
void evaluate_actor(const EvaluationOptions& o);
/// Accuracy on recorded motions over seeds.
void evaluate_classifier(const EvaluationOptions& o);
/// Compares descriptions of a TM2T from motions to texts with those of the data: BLEU, ROUGE-L, CIDEr and BERTScore.
/// With an evaluator it measures motions from texts: R-precision, FID, distance from the texts, diversity and
/// multimodality.
void evaluate_tm2t(const EvaluationOptions& o);
/// The five metrics of Guo et al. for any other model that makes motions of texts.
void evaluate_by_guo(const EvaluationOptions& o);
/// Retrieval by the networks of Guo et al. themselves.
void evaluate_evaluator(const EvaluationOptions& o);
/// Motions of timelines by STMC and its baselines, over any diffusion model of texts, judged by TMR.
void evaluate_stmc(const EvaluationOptions& o);
/// Where in long motions, made of several clips one after the other, a text happens: the share of stretches that TMR
/// finds.
void evaluate_moments(const EvaluationOptions& o);

}  // namespace program
