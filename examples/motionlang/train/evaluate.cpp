#include "evaluate.hpp"

#include <chrono>
#include <cstdio>
#include <map>

#include <motionlang/weights/run_folder.hpp>
#include <motionlang/weights/vae_run.hpp>

#include "../commands.hpp"
#include "../generate/generation.hpp"
#include "../option_checks.hpp"

namespace program {

namespace {

void run(const EvaluationOptions& o) {
  const auto begin = std::chrono::steady_clock::now();
  o.machine.apply();
  const std::string found = ml::system_of_run(o.model);
  const bool ours = found.empty() || found == "motionlang";
  const std::string system = ours ? ml::read_model_folder(o.model).system : found;
  if (system != "tmr" && o.synthesis)
    ml::raise<usage_error>(102, o.model.string(), ": --synthesis measures tmr, not ", system);
  if (system == "tmr" && o.moments > 0)
    evaluate_moments(o);
  else if (system == "tmr")
    evaluate_tmr(o, ml::read_text_motion_config(o.model));
  else if (system == "temos" && !ours)
    evaluate_published_temos(o);
  else if (system == "temos")
    evaluate_temos(o, ml::read_text_motion_config(o.model));
  else if (system == "actor")
    evaluate_actor(o);
  else if (system == "classifier")
    evaluate_classifier(o);
  else if (system == "sinc")
    evaluate_sinc(o);
  else if (system == "teach")
    evaluate_teach(o);
  else if (system == "tm2t")
    evaluate_tm2t(o);
  else
    ml::raise<ml::config_error>(103, o.model.string(), ": a model of '", system,
                                "'; measured are tmr, temos, actor, sinc, teach and tm2t, also as published, and "
                                "classifier");
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  std::printf("%.1f s\n", time.count());
}

}  // namespace

void add_evaluate(CLI::App& app) {
  const auto o = std::make_shared<EvaluationOptions>();
  CLI::App* c = app.add_subcommand(
      "evaluate",
      "Measures a trained TMR, TEMOS, ACTOR, SINC, TEACH, TM2T or classifier of actions by the tables of its paper");
  c->add_option("model", o->model,
                "Folder of the model: of our training, or TMR, TEMOS, ACTOR, SINC, TEACH or TM2T (M2T_..., or T2M_... "
                "with --evaluator) as published")
      ->required()
      ->check(CLI::ExistingDirectory);
  c->add_option("--data", o->data, "Folder of the motions, as for training")->required()->check(CLI::ExistingDirectory);
  c->add_option("--captions", o->captions, "Table of captions, as for training")->check(CLI::ExistingFile);
  c->add_option("--labels", o->labels,
                "ACTOR, classifier: table of labels, as for training, unless --annotations has them")
      ->check(CLI::ExistingFile);
  c->add_option("--classifier", o->classifier,
                "ACTOR: folder of the classifier that judges, or the file of a published one (humanact12_gru.tar, "
                "uestc_rot6d_stgcn.tar)")
      ->check(CLI::ExistingPath);
  c->add_option(
       "--body", o->body,
       "ACTOR: SMPL, whose points a published GRU is given: ntu13_gru.tar needs it, humanact12_gru.tar takes the "
       "joints of our own skeleton without it; SINC, TEACH: SMPL-H, whose joints are compared in place of those of "
       "our own skeleton")
      ->check(CLI::ExistingFile);
  c->add_option("--joint-regressor", o->regressor, "J_regressor_extra.npy of SPIN or VIBE, for ntu13_gru.tar")
      ->check(CLI::ExistingFile);
  c->add_option(
       "--evaluator", o->evaluator,
       "TM2T from texts to motions: finest.tar of the networks of Guo et al., or its folder (text_mot_match), which "
       "judge its motions; glove/our_vab_data.npy is in a folder above, or where --text-encoder says")
      ->check(CLI::ExistingPath);
  CLI::Option* bert = c->add_option("--bert", o->bert,
                                    "TM2T from motions to texts: folder of a DistilBERT, BERT or MPNet (Hugging Face) "
                                    "whose states compare descriptions: BERTScore")
                          ->check(CLI::ExistingDirectory);
  c->add_option("--bert-layer", o->bert_layer, "The layer whose states these are; 0: the last one")
      ->needs(bert)
      ->check(in_range(0, 1000))
      ->capture_default_str();
  c->add_option("--seeds", o->seeds, "ACTOR, classifier, TM2T with --evaluator: how often everything is drawn anew")
      ->check(in_range(1, 1000))
      ->capture_default_str();
  c->add_option("--annotations", o->annotations, "Unified annotation file, as for training")->check(CLI::ExistingFile);
  c->add_option("--splits", o->splits, "Folder with train.txt, val.txt, test.txt, as for training")
      ->check(CLI::ExistingDirectory);
  c->add_option("--babel", o->babel, "SINC, TEACH: BABEL's JSON, as for training; or val.json, with --part all")
      ->check(CLI::ExistingFile);
  c->add_option("--babel-validation", o->validation,
                "SINC, TEACH: as for training; it is then what --part validation measures")
      ->check(CLI::ExistingFile);
  c->add_option("--spelling", o->spelling, "SINC, TEACH: as for training")->check(CLI::ExistingFile);
  c->add_option("--part", o->part, "What is measured; all is of SINC and TEACH: all of --babel")
      ->check(CLI::IsMember({"training", "validation", "test", "all"}))
      ->capture_default_str();
  c->add_option("--text-encoder", o->text_encoder,
                "As for training; of a published TEMOS, SINC or TEACH the folder of its tokenizer "
                "(distilbert-base-uncased), of TM2T "
                "that of its words")
      ->check(CLI::ExistingPath);
  c->add_option(
       "--statistics", o->statistics,
       "Of a published TEMOS, SINC or TEACH: folder with mean and std of the features, if they are not in its own; "
       "of --evaluator: those that it was trained with, if they are not those of TM2T")
      ->check(CLI::ExistingDirectory);
  c->add_option("--tokenizer", o->tokenizer,
                "Of a published TM2T: folder of its motion tokenizer, if it is not beside it")
      ->check(CLI::ExistingDirectory);
  c->add_option("--sentence-encoder", o->sentence_encoder, "As for training")->check(CLI::ExistingPath);
  c->add_option("--threshold", o->threshold, "TMR: from this score on texts mean the same")
      ->check(in_range(0, 1))
      ->capture_default_str();
  c->add_option("--nsim", o->nsim,
                "TMR: list of ids of dissimilar texts, which of a table are clip@start-end; chosen unless given")
      ->check(CLI::ExistingFile);
  CLI::Option* synthesis =
      c->add_flag("--synthesis", o->synthesis,
                  "TMR: also whether motions are found that were made for the texts, as long as the recorded ones");
  c->add_option(
       "--generator", o->generator,
       "Model that makes these motions, as for generate (--text-encoder is its one too); TMR itself unless given")
      ->needs(synthesis)
      ->check(CLI::ExistingPath);
  c->add_option(
       "--moments", o->moments,
       "TMR: makes so many long motions of several clips each, and measures whether the stretch of each text is found")
      ->excludes(synthesis)
      ->check(in_range(1, 1000000));
  c->add_option("--joined", o->joined, "Clips in each of them, all of different texts")
      ->check(in_range(2, 100))
      ->capture_default_str();
  c->add_option("--windows", o->windows, "Seconds of the stretches that are compared with a text")
      ->delimiter(',')
      ->check(in_range(0.1, 10))
      ->capture_default_str();
  c->add_option("--stride", o->stride, "Seconds from one stretch to the next")
      ->check(in_range(0.01, 10))
      ->capture_default_str();
  c->add_option("--samples", o->samples, "TEMOS, SINC, TEACH: motions for each text")
      ->check(in_range(1, 1000))
      ->capture_default_str();
  c->add_option(
       "--items", o->items,
       "SINC: two actions at the same time, those of them that the training part lacks and without 'stand' (the "
       "published evaluation), single actions, or all")
      ->check(CLI::IsMember({"pairs", "unseen", "single", "all"}))
      ->capture_default_str();
  c->add_option("--keys", o->keys, "SINC, TEACH: list of the items to be measured, spatial_pairs-4242-0 on a line")
      ->check(CLI::ExistingFile);
  const std::map<std::string, ml::Conjunction> conjunctions{{"while", ml::Conjunction::while_},
                                                            {"simultaneously", ml::Conjunction::simultaneously},
                                                            {"comma", ml::Conjunction::comma},
                                                            {"same_time", ml::Conjunction::same_time},
                                                            {"during", ml::Conjunction::during}};
  c->add_option("--conjunction", o->conjunction,
                "SINC: how two labels become a sentence: same_time unless given, as its program has it; while is what "
                "its paper says")
      ->transform(
          CLI::CheckedTransformer(conjunctions).description("while, simultaneously, comma, same_time or during"));
  c->add_option("--tags", o->tags,
                "SINC: sentences with their words as spaCy tags them, 'walk while wave#walk/VERB while/SCONJ "
                "wave/VERB#0.0#0.0' on a line, of which while and during take the -ing form of the second verb")
      ->check(CLI::ExistingFile);
  c->add_option(
       "--body-parts", o->body_parts,
       "SINC: table as for training; also makes a motion for each label alone, and combines them by their body parts")
      ->check(CLI::ExistingFile);
  c->add_option(
       "--temos", o->temos,
       "SINC: model whose motion encoder compares motions, the TEMOS score: a SINC (of single actions) or a TEACH, of "
       "our training or as published, or a TEMOS as published, of the same features at 30 frames a second")
      ->check(CLI::ExistingDirectory);
  const std::map<std::string, ml::Alignment> alignments{{"full", ml::Alignment::full},
                                                        {"translation", ml::Alignment::translation}};
  c->add_option(
       "--alignment", o->alignment,
       "TEACH: the second action is turned and moved to the end of the first, full, unless it is to be moved only")
      ->transform(CLI::CheckedTransformer(alignments).description("full or translation"));
  c->add_option("--slerp-window", o->slerp_window, "TEACH: frames between two actions that are interpolated; 0: none")
      ->check(in_range(0, 1000))
      ->capture_default_str();
  c->add_option(
       "--independent", o->independent,
       "TEACH: model of single actions, which makes both actions, each alone, to be joined in the same way: a SINC "
       "or a TEACH (without its past), of our training or as published, or a TEMOS as published, of the same "
       "features at 30 frames a second")
      ->check(CLI::ExistingDirectory);
  c->add_option("--joint", o->joint,
                "TEACH: such a model of pairs of actions, which makes one motion of the text 'a, b'")
      ->check(CLI::ExistingDirectory);
  c->add_option(
      "--strips", o->strips,
      "Folder for film strips: of TEMOS, SINC and TEACH of what is generated of different texts (the mean of the "
      "latent) next to what was recorded, of ACTOR of an action each");
  c->add_option("--count", o->count, "Film strips")->capture_default_str();
  c->add_option("--seed", o->seed, "Seed of what is generated")->check(seed_number())->capture_default_str();
  o->machine.add_to(*c);
  c->callback([o] {
    o->model = ml::found_model_folder(o->model);
    run(*o);
  });
}

}  // namespace program
