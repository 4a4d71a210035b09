// The commands of the motionlang program. Each fills a CLI11 subcommand with its options and a function to run.
#pragma once

#include <CLI/CLI.hpp>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "interrupt.hpp"
#include "usage_error.hpp"

namespace program {

/// Exit codes, as --help lists them.
enum Exit : int { ok = 0, failed = 1, usage = 2, bad_timeline = 3, stopped = 130 };

/// The command line as typed. It goes into the metadata of the files that the command writes.
inline std::string command_line;

void add_generate(CLI::App& app);
void add_info(CLI::App& app);
void add_check(CLI::App& app);
void add_mtt(CLI::App& app);
void add_train(CLI::App& app);
void add_train_tmr(CLI::App& app);
void add_train_temos(CLI::App& app);
void add_train_sinc(CLI::App& app);
void add_train_teach(CLI::App& app);
void add_train_actor(CLI::App& app);
void add_train_classifier(CLI::App& app);
void add_train_tm2t(CLI::App& app);
void add_train_evaluator(CLI::App& app);
void add_train_mdm_smpl(CLI::App& app);
void add_train_mdm(CLI::App& app);
void add_train_motiondiffuse(CLI::App& app);
void add_train_mdm_actions(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_judge(CLI::App& app);
void add_gallery(CLI::App& app);
void add_remember(CLI::App& app);
void add_studio(CLI::App& app);
void add_convert(CLI::App& app);  // and strip, view
void add_body_parts(CLI::App& app);
void add_compose(CLI::App& app);
void add_join(CLI::App& app);
void add_doctor(CLI::App& app);
void add_index(CLI::App& app);
void add_search(CLI::App& app);
void add_embed(CLI::App& app);
void add_describe(CLI::App& app);
void add_tokens(CLI::App& app);
void add_pack(CLI::App& app);
void add_word_vectors(CLI::App& app);
void add_humanml3d(CLI::App& app);
void add_study(CLI::App& app);
void add_study_count(CLI::App& app);
void add_figure(CLI::App& app);

/// The weights that come with the repository, unless MOTIONLANG_MODEL names others.
inline std::filesystem::path default_model() {
  if (const char* named = std::getenv("MOTIONLANG_MODEL")) return named;
  return MOTIONLANG_DEFAULT_MODEL;
}
/// The search model that comes with the repository.
inline std::filesystem::path default_search_model() {
  return std::filesystem::path(MOTIONLANG_DEFAULT_MODEL).parent_path() / "tmr_free";
}
/// The model of captions that comes with the repository. Its motion tokenizer is beside it.
inline std::filesystem::path default_describing_model() {
  return std::filesystem::path(MOTIONLANG_DEFAULT_MODEL).parent_path() / "tm2t_free" / "motion_to_text";
}

/// The prompts of the gallery, which come with the weights.
inline std::filesystem::path default_gallery_prompts() {
  return std::filesystem::path(MOTIONLANG_DEFAULT_MODEL).parent_path() / "gallery.txt";
}

}  // namespace program
