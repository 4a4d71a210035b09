#include "evaluate.hpp"

#include <chrono>
#include <cstdio>
#include <map>

#include <motionlang/weights/guo_evaluator_file.hpp>
#include <motionlang/weights/model_system.hpp>
#include <motionlang/weights/run_folder.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../commands.hpp"
#include "../conjunctions.hpp"
#include "../generate/generation.hpp"
#include "../option_checks.hpp"
#include "action_options.hpp"
#include "processes.hpp"

namespace program {

namespace {

/// Throws usage_error 102 for options that the evaluation of this system would not read.
void require_read(const EvaluationOptions& o, const std::string& system, bool by_guo) {
  const bool tmr = system == "tmr" && !by_guo, judge = system == "evaluator";
  const auto refuse = [&](const auto&... why) { ml::raise<usage_error>(102, o.model.string(), ": ", why...); };
  const std::string measured = by_guo ? "what --evaluator judges" : system;
  const ml::RunFolder run = system == "tm2t" ? ml::find_run(o.model) : ml::RunFolder();
  const bool describes =
      system == "tm2t" && ml::is_tm2t_describer(run) && (o.evaluator.empty() || !ml::is_tm2t_generator(run));
  const bool takes =
      ((system == "temos" || system == "actor") && !by_guo) || judge || (tmr && o.synthesis) || describes;
  if (!takes && !o.made.empty())
    refuse(
        "--made is for TEMOS, ACTOR, the evaluator of Guo et al., TMR with --synthesis, all without --evaluator, and "
        "for TM2T's descriptions");
  if (describes && o.made_rate > 0) refuse("--made-rate is for motions, and --made has descriptions");
  if (o.time > 0 && (o.evaluator.empty() || describes || judge))
    refuse("--time measures how a model generates the motions that --evaluator judges");
  if (!tmr && !o.html.empty()) refuse("--html shows what tmr finds, not ", measured);
  if (!tmr && !judge && o.synthesis) refuse("--synthesis measures tmr, not ", measured);
  const char* moments = o.moments > 0 ? "--moments" : "--babel";
  if (tmr && (o.moments > 0 || !o.babel.empty()) && (o.synthesis || !o.html.empty()))
    refuse(o.synthesis ? "--synthesis" : "--html", " is about whole motions, ", moments, " about moments in them");
  if (!o.made.empty() && !o.generator.empty()) refuse("--made are the motions, so there is no --generator");
  if (!o.made.empty() && !o.durations.empty()) refuse("--durations measures motions of the model, not of --made");
  if (o.dataset.empty()) return;
  if ((system != "actor" && system != "classifier") || by_guo)
    refuse("--dataset is for ACTOR and the classifier, not ", measured);
  if (!o.labels.empty() || !o.annotations.empty())
    refuse("--dataset has labels of its own: no ", o.labels.empty() ? "--annotations" : "--labels", " with it");
}

void run(const EvaluationOptions& o) {
  const auto begin = std::chrono::steady_clock::now();
  processes();  // from here on, the first one alone prints
  o.machine.apply();
  const bool judge = ml::is_guo_evaluator(o.model);
  const ml::ModelSystem model = judge ? ml::ModelSystem{"evaluator"} : ml::model_system(ml::FilePath(o.model));
  const std::string& system = model.name;
  if ((!model.is_diffusion() || !o.evaluator.empty()) && o.data.empty())
    ml::raise<usage_error>(102, o.model.string(), ": --data is needed to measure ", system);
  const bool by_guo = !o.evaluator.empty() && system != "tm2t" && !judge;
  require_read(o, system, by_guo);
  const std::map<std::string_view, void (*)(const EvaluationOptions&)> evaluations{{"actor", evaluate_actor},
                                                                                   {"classifier", evaluate_classifier},
                                                                                   {"sinc", evaluate_sinc},
                                                                                   {"teach", evaluate_teach},
                                                                                   {"tm2t", evaluate_tm2t},
                                                                                   {"temos", evaluate_temos},
                                                                                   {"tmr", evaluate_tmr},
                                                                                   {"stmc", evaluate_stmc},
                                                                                   {"mdm", evaluate_stmc},
                                                                                   {"motiondiffuse", evaluate_stmc},
                                                                                   {"evaluator", evaluate_evaluator}};
  const auto found = evaluations.find(system);
  if (found == evaluations.end())
    ml::raise<ml::config_error>(103, o.model.string(), ": a model of '", system,
                                "'; evaluate measures stmc, mdm, motiondiffuse, tmr, temos, actor, sinc, teach and "
                                "tm2t, also as published, and classifier");
  if (by_guo)
    evaluate_by_guo(o);
  else
    found->second(o);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  std::fflush(stdout);
  if (processes().rank() == 0)
    std::fprintf(stderr, "%.1f s\n", time.count());  // apart from the table, which other commands read
}

}  // namespace

void add_evaluate(CLI::App& app) {
  const auto o = std::make_shared<EvaluationOptions>();
  CLI::App* c = app.add_subcommand("evaluate",
                                   "Measures a STMC (MDM, MotionDiffuse), TMR, TEMOS, ACTOR, SINC, TEACH, TM2T, "
                                   "classifier of actions or evaluator of "
                                   "Guo et al., and prints the tables of its paper");
  path_option(
      *c, "model", o->model,
      "Folder of the model: trained here, or published (STMC, MDM, MotionDiffuse, TMR, TEMOS, ACTOR, SINC, "
      "TEACH, M2T_..., or T2M_... with --evaluator; text_mot_match itself). STMC of ours: its .safetensors file, too")
      ->required();
  folder_option(*c, "--data", o->data,
                "Folder of the motions, as for training. STMC: folder of the motions that --recorded names");
  file_option(*c, "--captions", o->captions, "Table of captions, as for training");
  file_option(*c, "--labels", o->labels,
              "ACTOR, classifier: table of labels, as for training. Not needed if --annotations has labels");
  add_dataset_option(*c, o->dataset);
  path_option(
      *c, "--classifier", o->classifier,
      "ACTOR: folder of the classifier that judges, or a published file (humanact12_gru.tar, uestc_rot6d_stgcn.tar)");
  c->add_option("--durations", o->durations,
                "ACTOR: only measure motions of these lengths, in frames (figure 3.4: 40,45,...,120)")
      ->delimiter(',')
      ->check(in_range(2, 100000));
  file_option(
      *c, "--body", o->body,
      "ACTOR: SMPL file, whose joints a published GRU reads. ntu13_gru.tar needs it; humanact12_gru.tar "
      "otherwise reads our own joints. SINC, TEACH, TEMOS with --joints: SMPL-H file, whose joints are compared "
      "instead of ours");
  file_option(*c, "--joint-regressor", o->regressor, "File J_regressor_extra.npy of SPIN or VIBE, for ntu13_gru.tar");
  path_option(
      *c, "--evaluator", o->evaluator,
      "Any model of texts: finest.tar of the networks of Guo et al. (text_mot_match, or of train-evaluator), or its "
      "folder, which judges the motions by R-precision, FID, distance, diversity and multimodality. TM2T "
      "motion-to-text: R-precision and distance of the descriptions");
  folder_option(
      *c, "--evaluator-words", o->evaluator_words,
      "Folder of the evaluator's words, our_vab_data.npy. The default is glove in a folder above it, for TM2T "
      "also --text-encoder");
  folder_option(*c, "--evaluator-statistics", o->evaluator_statistics,
                "Folder with mean and std of the evaluator's training. The default is meta beside it, for TM2T also "
                "--statistics, else those of TM2T");
  checked_option(*c, "--repeats", o->repeats, in_range(0, 1000),
                 "With --evaluator: number of motions of a text for multimodality, above 10; 0 leaves it out");
  checked_option(*c, "--time", o->time, in_range(0, 1'000'000),
                 "With --evaluator: also measure how long the model takes to generate this many motions");
  CLI::Option* bert = folder_option(
      *c, "--bert", o->bert,
      "TM2T motion-to-text: folder of a DistilBERT, BERT, RoBERTa or MPNet (Hugging Face), for BERTScore");
  c->add_option("--bert-layer", o->bert_layer, "Layer whose states BERTScore compares; 0 is the last one")
      ->needs(bert)
      ->check(in_range(0, 1000))
      ->capture_default_str();
  c->add_option("--bert-baseline", o->bert_baseline,
                "Value of BERTScore that counts as 0. random: that of random texts of the training part; tm2t: the "
                "published one, which fits layer 17 of roberta-large alone")
      ->needs(bert)
      ->check(CLI::IsMember({"none", "tm2t", "random"}))
      ->capture_default_str();
  checked_option(*c, "--seeds", o->seeds, in_range(1, 1000),
                 "ACTOR, classifier, with --evaluator: number of repetitions with new random numbers");
  file_option(*c, "--annotations", o->annotations, "Unified annotation file, as for training");
  folder_option(*c, "--splits", o->splits, "Folder with train.txt, val.txt and test.txt, as for training");
  file_option(
      *c, "--babel", o->babel,
      "SINC, TEACH: BABEL's JSON, as for training; or val.json with --part all. TMR: its sequences, in which each of "
      "their texts is searched");
  file_option(*c, "--babel-validation", o->validation,
              "SINC, TEACH: as for training. --part validation then measures this file");
  file_option(*c, "--spelling", o->spelling, "SINC, TEACH: as for training");
  checked_option(*c, "--part", o->part, CLI::IsMember({"training", "validation", "test", "all"}),
                 "Part of the data to measure. 'all' is for SINC, TEACH and moments of TMR: all of --babel");
  path_option(*c, "--text-encoder", o->text_encoder,
              "Text encoder, as for training. Published TEMOS, SINC, TEACH: folder of the tokenizer "
              "(distilbert-base-uncased). Published TM2T: folder of the words");
  folder_option(*c, "--statistics", o->statistics,
                "Folder with mean and std of the features, if the folder of a published TEMOS, SINC or TEACH lacks "
                "them. With --evaluator: the statistics of its training, if they differ from those of TM2T");
  folder_option(*c, "--tokenizer", o->tokenizer,
                "Folder of the motion tokenizer of a published TM2T, if it is not beside the model");
  path_option(*c, "--sentence-encoder", o->sentence_encoder, "Sentence encoder, as for training");
  checked_option(*c, "--threshold", o->threshold, in_range(0, 1),
                 "TMR: similarity from which two texts count as equal");
  file_option(
      *c, "--nsim", o->nsim,
      "TMR: list of ids of dissimilar texts; for a table they are clip@start-end. The default is to choose them");
  CLI::Option* synthesis = c->add_flag(
      "--synthesis", o->synthesis,
      "TMR, evaluator: also search motions that were generated for the texts, with the lengths of the recorded "
      "ones");
  CLI::Option* generator =
      c->add_option("--generator", o->generator,
                    "Model that generates these motions, as for generate. The default is the TMR itself")
          ->needs(synthesis)
          ->check(CLI::ExistingPath);
  path_option(*c, "--generator-text-encoder", o->generator_text_encoder,
              "Text encoder of --generator, as --text-encoder of generate. For TMR the default is --text-encoder")
      ->needs(generator);
  folder_option(*c, "--generator-statistics", o->generator_statistics,
                "Folder with mean and std of the features of a published --generator, if its folder lacks them")
      ->needs(generator);
  CLI::Option* made = folder_option(
      *c, "--made", o->made,
      "Folder of motions that another program generated, which are measured beside those of the model. TEMOS, TMR with "
      "--synthesis, evaluator of Guo et al.: a file for each motion of the part, by its id (00017.npy), or several "
      "(00017_0.npy, ...). ACTOR: a folder for each action. TM2T's descriptions: a text for each (00017.txt)");
  c->add_option("--made-rate", o->made_rate,
                "Frames per second of arrays of joints (.npy) in --made. The default is 20, for MMM's joints 12.5")
      ->needs(made)
      ->check(in_range(1, 1000));
  c->add_option(
       "--moments", o->moments,
       "TMR: build this many long motions of several clips, and measure how well the segment of each text is found. "
       "With --babel the motions are BABEL's sequences instead, which needs no --moments")
      ->excludes(synthesis)
      ->check(in_range(1, 1000000));
  checked_option(*c, "--joined", o->joined, in_range(2, 100),
                 "Number of clips in each long motion, with different texts");
  c->add_option(
       "--windows", o->windows,
       "Lengths in seconds of the windows that are compared with a text. The default is 1,2,3,4,6, and for BABEL "
       "1,2,3 (20, 40 and 60 frames), as in the thesis")
      ->delimiter(',')
      ->check(in_range(0.1, 10));
  c->add_option("--stride", o->stride,
                "Seconds from one window to the next. The default is 0.2, and for BABEL one frame (0.05)")
      ->check(in_range(0.01, 10));
  c->add_option("--html", o->html,
                "TMR: page of ranked galleries: for --count texts the five nearest motions, with their similarity and "
                "that of their texts (figures 5.3 to 5.7)");
  c->add_flag(
      "--filtered", o->filtered,
      "TMR: also print the share of negatives that the contrastive loss leaves out, by threshold and by size of "
      "the batch (table 5.5)");
  checked_option(*c, "--samples", o->samples, in_range(1, 1000), "TEMOS, SINC, TEACH: number of motions for each text");
  c->add_option("--rate", o->rate,
                "TEMOS: frames per second at which joints are compared, a multiple of the model's. Joints that it "
                "generates are interpolated linearly; recorded ones, too, if the data are ready-made features. The "
                "default is 100, or the model's rate if 100 is not a multiple of that")
      ->check(in_range(1, 1000));
  c->add_option("--joints", o->joints,
                "TEMOS of SMPL's features: compare MMM's 21 joints (table 4.11). mmm: scaled by 0.64, in the units of "
                "KIT; mmmns: in metres. The default is SMPL's 22 joints")
      ->check(CLI::IsMember({"mmm", "mmmns"}));
  checked_option(*c, "--items", o->items, CLI::IsMember({"pairs", "unseen", "single", "all"}),
                 "SINC: items to measure. pairs: two actions at the same time; unseen: pairs that the training part "
                 "lacks, without 'stand' (the published evaluation); single: single actions; all");
  c->add_option(
       "--longest", o->longest,
       "SINC: the most frames of an item. The default is 600 for unseen, as in the thesis, and 800 for others, "
       "as in the released program")
      ->check(in_range(15, 100000));
  file_option(*c, "--keys", o->keys,
              "SINC, TEACH: list of items to measure, one per line, such as spatial_pairs-4242-0");
  c->add_option("--conjunction", o->conjunction,
                "SINC: how two labels become a sentence. The default is same_time, as in the published program; the "
                "paper says while")
      ->transform(conjunction_names());
  file_option(*c, "--tags", o->tags, about_tags);
  file_option(*c, "--body-parts", o->body_parts,
              "SINC: table as for training. Adds a motion for each single label, combined by body parts");
  folder_option(*c, "--temos", o->temos,
                "SINC: model whose motion encoder computes the TEMOS score: a SINC of single actions or a TEACH, "
                "trained here or published, or a published TEMOS. It has the same features at 30 frames per second");
  const std::map<std::string, ml::Alignment> alignments{{"full", ml::Alignment::full},
                                                        {"translation", ml::Alignment::translation}};
  c->add_option("--alignment", o->alignment,
                "TEACH: how the second action joins the end of the first. full turns and moves it (the default); "
                "translation only moves it")
      ->transform(CLI::CheckedTransformer(alignments).description("full or translation"));
  checked_option(*c, "--slerp-window", o->slerp_window, in_range(0, 1000),
                 "TEACH: number of interpolated frames between two actions; 0 means none");
  folder_option(*c, "--independent", o->independent,
                "TEACH: model of single actions, which makes each action alone: a SINC or a TEACH without its past, "
                "trained here or published, or a published TEMOS. It has the same features at 30 frames per second");
  folder_option(*c, "--joint", o->joint,
                "TEACH: such a model of action pairs, which makes one motion from the text 'a, b'");
  c->add_option("--strips", o->strips,
                "Folder for film strips. TEMOS, SINC, TEACH: generated motions (mean of the latent) beside recorded "
                "ones, for different texts. ACTOR: one for each action");
  c->add_option("--count", o->count, "Number of film strips, or of texts of --html")->capture_default_str();
  file_option(*c, "--texts", o->texts,
              "STMC: file with a line for each text: 'text # body part # ...', as for mtt. Timelines are drawn from "
              "it, and crops are ranked among its texts");
  file_option(*c, "--timelines", o->timelines, "STMC: file of timelines instead, such as MTT.txt");
  c->add_option("--first", o->first, "STMC: number of timelines to measure, from the first on. The default is all 500")
      ->check(in_range(1, 1000000));
  file_option(*c, "--recorded", o->recorded,
              "STMC: file with a line 'path # start # end' for each text: the motion below --data that shows it, and "
              "from when to when, in seconds. Without it M2M, FID+ and the row of recorded motions are left out");
  folder_option(*c, "--tmr", o->tmr,
                "STMC: folder of the TMR that judges, with HumanML3D's features: trained here or published. The "
                "default is the bundled one");
  path_option(*c, "--tmr-text-encoder", o->tmr_text_encoder,
              "STMC: text encoder of that TMR, if it has none of its own");
  c->add_option("--modes", o->modes,
                "STMC: methods to measure, as --mode of generate names them. The default is all five (table 6.1)")
      ->delimiter(',')
      ->check(CLI::IsMember({"stmc", "sinc", "sinc-lerp", "single-track", "one-text"}));
  checked_option(*c, "--overlap", o->overlap, not_negative(),
                 "STMC: seconds that neighbouring texts share around a cut, of these methods");
  c->add_option(
       "--overlaps", o->overlaps,
       "STMC: also measure it with these overlaps (table 6.2: 0.25,0.4,0.5,0.6,0.75,1,1.25). 0 is without extension "
       "and transitions")
      ->delimiter(',')
      ->check(not_negative());
  c->add_option("--steps", o->steps, "STMC: number of denoising steps, as for generate")->check(not_negative());
  c->add_option("--guidance", o->guidance, "STMC: weight of the text, as for generate")->check(in_range(0, 100));
  c->add_option("--noise-factor", o->noise_factor, "STMC: factor of the noise, as for generate")
      ->check(CLI::IsMember({"paper", "published"}));
  checked_option(*c, "--batch", o->batch, in_range(1, 100000), "STMC: number of timelines that are sampled together");
  checked_option(*c, "--table", o->table, CLI::IsMember({"text", "markdown", "latex", "csv"}),
                 "STMC: form of the tables");
  checked_option(*c, "--seed", o->seed, seed_number(), "Seed of the generated motions");
  o->machine.add_to(*c);
  c->callback([o] {
    if (std::filesystem::is_directory(o->model)) o->model = ml::found_model_folder(o->model);
    run(*o);
  });
}

}  // namespace program
