// motionlang: timelines of texts to 3D human motion, and related tools. See README.md.
#include <csignal>
#include <cstdio>
#include <new>
#include <string>

#include <motionlang/core/error.hpp>
#include <motionlang/version.hpp>

#include "commands.hpp"
#include "help_formatter.hpp"
#include "train/processes.hpp"
#include "training_commands.hpp"

namespace {

void on_interrupt(int) {
  if (program::interrupted.exchange(true)) std::_Exit(program::stopped);  // the second time: at once
}

/// For an unknown subcommand, CLI11 itself only says that one is required.
void require_known_subcommand(const CLI::App& app, int argc, char** argv) {
  const auto meant = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(meant).empty())
    throw CLI::ValidationError(program::no_subcommand(argv[1]));
}

/// All commands, in the order of --help.
void add_commands(CLI::App& app) {
  using namespace program;
  for (const auto add : {add_generate, add_check, add_mtt, add_info, add_train}) add(app);
#ifdef MOTIONLANG_TRAINING
  for (const auto add : {add_train_tmr, add_train_temos, add_train_sinc, add_train_teach, add_train_actor,
                         add_train_classifier, add_train_tm2t, add_train_evaluator, add_train_mdm_smpl, add_train_mdm,
                         add_train_motiondiffuse, add_train_mdm_actions, add_evaluate})
    add(app);
#endif
  for (const auto add :
       {add_studio, add_judge,        add_gallery,   add_remember, add_convert,     add_body_parts, add_compose,
        add_join,   add_doctor,       add_index,     add_search,   add_embed,       add_describe,   add_tokens,
        add_pack,   add_word_vectors, add_humanml3d, add_study,    add_study_count, add_figure})
    add(app);
}

/// Returns the exit code.
int run(int argc, char** argv) {
  for (int i = 0; i < argc; ++i) program::command_line += (i == 0 ? "motionlang" : std::string(" ") + argv[i]);
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);

  CLI::App app{"motionlang " MOTIONLANG_VERSION ": 3D human motion from language", "motionlang"};
  app.allow_windows_style_options(false);  // the same command line everywhere: /name is a file
  app.formatter(std::make_shared<program::HelpFormatter>());
  app.require_subcommand(1);
  app.set_version_flag("--version", MOTIONLANG_VERSION);
  std::string footer =
      "Exit codes: 0 done; 1 a file, a model or the computation failed; 2 the command line is wrong\n"
      "or asks for something that the model or the motion lacks; 3 the timeline is wrong;\n"
      "130 stopped by Ctrl-C (finished files are kept).";
#ifndef MOTIONLANG_TRAINING
  footer += "\nBuilt without " + motionlang::join_text(program::training_commands) +
            ". To have them, in the folder of motionlang:\n" + program::build_with_training;
#endif
  app.footer(footer);
  add_commands(app);
  try {
    require_known_subcommand(app, argc, argv);
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      motionlang::raise<motionlang::io_error>(401, "standard output cannot be written");
    return program::ok;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? program::ok : program::usage;
  } catch (const program::usage_error& e) {
    std::fprintf(stderr, "%s\n", program::with_options(e.what()).c_str());
    return program::usage;
  } catch (const motionlang::timeline_error& e) {
    std::fprintf(stderr, "%s\n", program::with_options(e.what()).c_str());
    return program::bad_timeline;
  } catch (const motionlang::cancelled&) {
    std::fprintf(stderr, "\nstopped\n");
    return program::stopped;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "there is not enough memory for this\n");
    return program::failed;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", program::with_options(e.what()).c_str());
    return program::failed;
  }
}

}  // namespace

int main(int argc, char** argv) { return program::end_processes(run(argc, argv)); }
